# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Adaptive against uniform subdivision at the same minimum size and threshold: `python -m bench.compare`.

The table of Kulyasov & Nikulin (2010), ours: its three scenes, four minimum sizes each, at which uniform subdivision
has about as many fragments as it had there. The time is that of the whole picture, as there, and neither method makes a
face finer than the minimum size. Adaptive begins coarser: form factors split the patches that exchange light, down to
the minimum size or the automatic one, and then the light splits the faces.
Writes `out/compare.txt` and `out/compare.json`, in which the rows of scenes that were not asked for stay as they were,
and pictures of both subdivisions and of the baked scenes to `out/images` and, of a whole run, to `docs/images`.
"""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from dataclasses import replace
from datetime import UTC, datetime
from functools import partial
from pathlib import Path
from typing import Any

from radiosity_bake.core.bake import bake
from radiosity_bake.core.result import BakeResult
from radiosity_bake.core.settings import QUALITIES, BakeSettings

from .machine import OUT, machine, write_json
from .measure import Judged, Measured, judge, judged, measure
from .paper_table import lines_of, stage_lines
from .picture import CAMERAS_OF_SCENES, render, side_by_side
from .publish import DOCS
from .results import read, title
from .scenes import SCENES
from .stopwatch import Cost, timed_once

# Minimum sizes in metres; the paper's are in units of its own. Uniform subdivision has about as many fragments at them
# as it had there: 456, 1788, 6396 and 25,584; 4504, 6568, 12,484 and 38,032; 8316, 10,008, 14,940 and 41,424. Walls of
# one size are split together, so there is nothing between 5,100 and 8,300, 8,700 and 13,700, or 35,000 and 57,000.
SIZES = {
    "paper_scene_1": (0.68, 0.34, 0.17, 0.085),
    "paper_scene_2": (0.2, 0.175, 0.15, 0.08),
    "paper_scene_3": (0.175, 0.16, 0.13, 0.08),
}
OTHER_SIZES = (0.2, 0.1, 0.05, 0.025)

THRESHOLD = 0.02
"""The largest with no visible loss, by the paper."""

TURNS, MOST_TURNS, ENOUGH_SECONDS = 3, 12, 6.0
"""Bakes of each method at each size: more of short ones, which whatever else runs disturbs most, until all together
took so many processor seconds."""

# Width of each picture in pixels, two and three of them side by side.
WIDTHS = {2: 620, 3: 420}

Row = dict[str, Any]


def pair(case: Judged, size: float, threshold: float, quality: str) -> dict[str, Measured]:
    """Return what each method gives at one minimum size: uniform, adaptive.

    They take turns, so that what else the machine does meets both alike; of each clock the best turn counts.
    """
    bakes = {
        method.lower(): BakeSettings(
            threshold=threshold, minimum_size=size, method=method, quality=quality, keep_transport=False
        )
        for method in ("UNIFORM", "ADAPTIVE")
    }
    turns: list[dict[str, tuple[BakeResult, Cost]]] = []
    while len(turns) < TURNS or (len(turns) < MOST_TURNS and processor_seconds(turns) < ENOUGH_SECONDS):
        turns.append({method: timed_once(partial(bake, case.scene, asked)) for method, asked in bakes.items()})
    return {method: best(case, [turn[method] for turn in turns]) for method in bakes}


def processor_seconds(turns: Sequence[dict[str, tuple[BakeResult, Cost]]]) -> float:
    """Return what all turns took."""
    return sum(cost.processor_seconds for turn in turns for _, cost in turn.values())


def best(case: Judged, turns: Sequence[tuple[BakeResult, Cost]]) -> Measured:
    """Return the fastest of some bakes that are alike, with the least of each clock, and its error."""
    result, fastest = min(turns, key=lambda turn: turn[1].processor_seconds)
    cost = replace(fastest, seconds=min(cost.seconds for _, cost in turns))
    return judge(case, result, cost)


def row_of(case: Judged, size: float, measured: dict[str, Measured]) -> Row:
    """Return a row of the table as JSON holds it."""
    return {
        "scene": case.name,
        "minimum_size": size,
        "probes": len(case.probes),
        "reference_samples": case.reference.samples,
        **{method: columns_of(m) for method, m in measured.items()},
    }


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
            rows.append(row_of(case, size, measured))
            print(lines_of(rows)[-1], flush=True)
        draw_subdivisions(name, measured, folders)
    return rows


def rows_of_others(table: Row, names: Sequence[str]) -> list[Row]:
    """Return the rows of other scenes that were written last, if threshold and quality were the same."""
    known = read(OUT / "compare.json") or {}
    same = all(known.get(key) == table[key] for key in ("threshold", "quality"))
    return [row for row in known["rows"] if row["scene"] not in names and "probes" in row] if same else []


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


def draw_scenes(folders: Sequence[Path]) -> None:
    """Draw the paper's scenes as a user bakes them, side by side, as its Figure 3 does."""
    results = {name: bake(SCENES[name](), BakeSettings(keep_transport=False)) for name in SIZES}
    pictures = [render(result, CAMERAS_OF_SCENES[name], WIDTHS[3]) for name, result in results.items()]
    captions = [f"{title(name)}, {result.report['vertices']:,} vertices" for name, result in results.items()]
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
    table = {"run": run, "threshold": asked.threshold, "quality": asked.quality, "turns": (TURNS, MOST_TURNS)}
    together = sorted([*rows_of_others(table, names), *rows], key=lambda row: str(row["scene"]))
    write_json(OUT / "compare.json", {**table, "rows": together})
    (OUT / "compare.txt").write_text("\n".join([*head, *lines_of(rows), *stages]) + "\n", encoding="utf-8")
    draw_scenes(folders)


if __name__ == "__main__":
    main()
