# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Adaptive against uniform subdivision at the same minimum size and threshold: `python -m bench.compare`.

The table of Kulyasov & Nikulin (2010), ours: its three scenes, four minimum sizes each, every one half of the last.
The time is that of the whole picture, as there: both methods light the fragments that they end with in the same way,
and neither makes a face finer than the minimum size.
Writes `out/compare.txt` and `out/compare.json`, and pictures of both subdivisions and of the baked scenes to
`out/images` and, of a whole run, to `docs/images`.
"""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

from radiosity_bake.core.bake import bake
from radiosity_bake.core.settings import QUALITIES, BakeSettings

from .machine import OUT, machine, write_json
from .measure import Judged, Measured, judged, measure
from .paper_table import lines_of, stage_lines
from .picture import CAMERAS_OF_SCENES, render, side_by_side
from .publish import DOCS
from .results import title
from .scenes import SCENES

# Minimum sizes in metres. The paper's are in units of its own; these give uniform subdivision about as many fragments
# as it had at the finest size: 25,584, 38,032 and 41,424.
SIZES = {
    "paper_scene_1": (0.68, 0.34, 0.17, 0.085),
    "paper_scene_2": (0.8, 0.4, 0.2, 0.1),
    "paper_scene_3": (0.8, 0.4, 0.2, 0.1),
}
OTHER_SIZES = (0.2, 0.1, 0.05, 0.025)

THRESHOLD = 0.02
"""The largest with no visible loss, by the paper."""

# Width of each picture in pixels, two and three of them side by side.
WIDTHS = {2: 620, 3: 420}

Row = dict[str, Any]


def pair(case: Judged, size: float, threshold: float, quality: str) -> dict[str, Measured]:
    """Return what each method gives at one minimum size: uniform, adaptive."""
    return {
        method.lower(): measure(
            case, BakeSettings(threshold=threshold, minimum_size=size, method=method, quality=quality)
        )
        for method in ("UNIFORM", "ADAPTIVE")
    }


def row_of(scene: str, size: float, measured: dict[str, Measured]) -> Row:
    """Return a row of the table as JSON holds it."""
    return {"scene": scene, "minimum_size": size, **{method: columns_of(m) for method, m in measured.items()}}


def columns_of(measured: Measured) -> dict[str, Any]:
    """Return what the table shows of one bake."""
    report = measured.report
    return {
        "fragments": report["patches"],
        **{key: report[key] for key in ("vertices", "triangles", "rays", "ended")},
        **{key: round(value, 4) for key, value in measured.cost.as_json().items()},
        "rms": round(measured.accuracy.rms, 6),
        "stages": {stage: round(seconds, 4) for stage, seconds in report["seconds"].items()},
    }


def measure_rows(names: Sequence[str], asked: argparse.Namespace, folders: Sequence[Path]) -> list[Row]:
    """Measure all rows, each printed as it comes, and draw the finest subdivision of each scene into folders."""
    rows: list[Row] = []
    print("\n".join(lines_of(rows)), flush=True)
    for name in names:
        case = judged(name, asked.probes, asked.parts)
        measure(case, BakeSettings(quality="DRAFT"))  # the first bake of a process also pays for loading libraries
        for size in asked.size or SIZES.get(name, OTHER_SIZES):
            measured = pair(case, size, asked.threshold, asked.quality)
            rows.append(row_of(name, size, measured))
            print(lines_of(rows)[-1], flush=True)
        draw_subdivisions(name, measured, folders)
    return rows


def draw_subdivisions(name: str, measured: dict[str, Measured], folders: Sequence[Path]) -> None:
    """Draw both methods' meshes over their light, side by side, as the paper's Figure 1 does."""
    camera = CAMERAS_OF_SCENES.get(name)
    if camera is None:
        return
    order = ("adaptive", "uniform")
    pictures = [render(measured[method].result, camera, WIDTHS[2], edges=True) for method in order]
    captions = [f"{method}, {measured[method].report['patches']:,} fragments" for method in order]
    for folder in folders:
        side_by_side(pictures, captions, folder / f"subdivision-{name.replace('_', '-')}.png")


def draw_scenes(names: Sequence[str], folders: Sequence[Path]) -> None:
    """Draw the scenes as a user bakes them, side by side, as the paper's Figure 3 does."""
    drawn = [name for name in names if name in CAMERAS_OF_SCENES]
    results = [bake(SCENES[name](), BakeSettings()) for name in drawn]
    pictures = [render(result, CAMERAS_OF_SCENES[name], WIDTHS[3]) for name, result in zip(drawn, results, strict=True)]
    captions = [
        f"{title(name)}, {result.report['vertices']:,} vertices" for name, result in zip(drawn, results, strict=True)
    ]
    for folder in folders:
        side_by_side(pictures, captions, folder / "paper-scenes.png")


def arguments() -> argparse.Namespace:
    """Return what the command line asks for."""
    parser = argparse.ArgumentParser(prog="python -m bench.compare", description=__doc__.splitlines()[0])
    parser.add_argument("--scene", action="append", choices=sorted(SCENES), help="default: the paper's three")
    parser.add_argument("--size", action="append", type=float, help="minimum size in metres, repeatable")
    parser.add_argument("--threshold", type=float, default=THRESHOLD)
    parser.add_argument("--quality", choices=QUALITIES, default="GOOD")
    parser.add_argument("--probes", type=int, default=4000)
    parser.add_argument("--parts", type=int, default=0, help="of the reference, for a quick one: 0 takes what is due")
    parser.add_argument("--publish", action="store_true", help="write the pictures of docs too, though not all was run")
    return parser.parse_args()


def main() -> None:
    """Measure, print and write the table."""
    asked = arguments()
    about = machine()
    head = [
        f"Threshold {asked.threshold:g}, quality {asked.quality}, {about['cores']} cores, {about['processor']}.",
        f"Error: relative RMS of irradiance at {asked.probes:,} area-uniform points against Mitsuba 3 path tracing.",
        "",
    ]
    print("\n".join(head), flush=True)
    whole = not (asked.scene or asked.size or asked.parts) and asked.threshold == THRESHOLD
    folders = [OUT / "images", *([DOCS / "images"] if whole or asked.publish else [])]
    names = asked.scene or tuple(SIZES)
    rows = measure_rows(names, asked, folders)
    stages = ["", *stage_lines(rows)]
    print("\n".join(stages))
    run = datetime.now(UTC).isoformat(timespec="seconds")
    whole = {"run": run, "threshold": asked.threshold, "quality": asked.quality, "rows": rows}
    write_json(OUT / "compare.json", whole)
    (OUT / "compare.txt").write_text("\n".join([*head, *lines_of(rows), *stages]) + "\n", encoding="utf-8")
    draw_scenes(names, folders)


if __name__ == "__main__":
    main()
