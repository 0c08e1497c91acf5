# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Adaptive against uniform subdivision at the same minimum size and threshold: `python -m bench.compare`.

The table of Kulyasov & Nikulin (2010), ours: its three scenes, four minimum sizes each, every one half of the last.
Both methods do the same with the fragments that they end with, so the time is that of the whole picture, as there.
Writes `out/compare.txt` and `out/compare.json`, and pictures of both subdivisions and of the baked scenes.
"""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from datetime import UTC, datetime
from typing import Any

from radiosity_bake.core.settings import QUALITIES, BakeSettings

from .machine import OUT, machine, write_json
from .measure import Judged, Measured, judged, measure
from .paper_table import lines_of, stage_lines
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


def measure_rows(names: Sequence[str], asked: argparse.Namespace) -> list[Row]:
    """Measure all rows, each printed as it comes."""
    rows: list[Row] = []
    print("\n".join(lines_of(rows)), flush=True)
    for name in names:
        case = judged(name, asked.probes, asked.parts)
        measure(case, BakeSettings(quality="DRAFT"))  # the first bake of a process also pays for loading libraries
        for size in asked.size or SIZES.get(name, OTHER_SIZES):
            rows.append(row_of(name, size, pair(case, size, asked.threshold, asked.quality)))
            print(lines_of(rows)[-1], flush=True)
    return rows


def arguments() -> argparse.Namespace:
    """Return what the command line asks for."""
    parser = argparse.ArgumentParser(prog="python -m bench.compare", description=__doc__.splitlines()[0])
    parser.add_argument("--scene", action="append", choices=sorted(SCENES), help="default: the paper's three")
    parser.add_argument("--size", action="append", type=float, help="minimum size in metres, repeatable")
    parser.add_argument("--threshold", type=float, default=THRESHOLD)
    parser.add_argument("--quality", choices=QUALITIES, default="GOOD")
    parser.add_argument("--probes", type=int, default=4000)
    parser.add_argument("--parts", type=int, default=0, help="of the reference, for a quick one: 0 takes what is due")
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
    rows = measure_rows(asked.scene or tuple(SIZES), asked)
    stages = ["", *stage_lines(rows)]
    print("\n".join(stages))
    run = datetime.now(UTC).isoformat(timespec="seconds")
    whole = {"run": run, "threshold": asked.threshold, "quality": asked.quality, "rows": rows}
    write_json(OUT / "compare.json", whole)
    (OUT / "compare.txt").write_text("\n".join([*head, *lines_of(rows), *stages]) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
