# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Adaptive against uniform subdivision at the same minimum size and threshold: `python -m bench.compare`.

Prints fragments, vertices, rays, time and error as a table, in the manner of Kulyasov & Nikulin's Table 1, and writes
`out/compare.txt` and `out/compare.json`.
"""

from __future__ import annotations

import argparse
from collections.abc import Iterable
from typing import Any

from radiosity_bake.core.settings import METHODS, QUALITIES, BakeSettings

from .machine import OUT, machine, write_json
from .measure import Judged, Measured, judged, measure
from .scenes import SCENES

# Minimum sizes n in metres: each a half of the last, the coarsest about a third of the room's height.
SIZES = {
    "cornell_box": (0.2, 0.1, 0.05, 0.025),
    "cornell_box_hung": (0.2, 0.1, 0.05, 0.025),
    "paper_scene_1": (1.0, 0.5, 0.25, 0.125),
    "paper_scene_2": (1.0, 0.5, 0.25, 0.125),
    "paper_scene_3": (1.0, 0.5, 0.25, 0.125),
}

HEADER = (
    f"{'scene':<18}{'n':>7}{'method':>10}{'fragments':>11}{'vertices':>10}{'rays':>13}{'seconds':>9}{'error':>8}"
    f"{'fewer':>8}{'gain':>8}"
)


def pair(case: Judged, size: float, threshold: float, quality: str, repeat: int) -> dict[str, Measured]:
    """Return what each method gives at one minimum size."""
    return {
        method: measure(
            case, BakeSettings(threshold=threshold, minimum_size=size, method=method, quality=quality), repeat
        )
        for method in sorted(METHODS, reverse=True)
    }


def lines_of(scene: str, size: float, measured: dict[str, Measured]) -> Iterable[str]:
    """Return a line of the table for each method; the adaptive one says how much it saves on the uniform one."""
    uniform = measured["UNIFORM"]
    for method, m in measured.items():
        line = f"{scene:<18}{size:>7g}{method.lower():>10}{m.report['patches']:>11,}{m.report['vertices']:>10,}"
        line += f"{m.report['rays']:>13,}{m.seconds:>9.2f}{m.accuracy.rms:>8.2%}"
        if method != "UNIFORM":
            line += f"{1.0 - m.report['patches'] / uniform.report['patches']:>8.1%}"
            line += f"{1.0 - m.seconds / uniform.seconds:>8.1%}"
        yield line


def entries_of(scene: str, size: float, measured: dict[str, Measured]) -> Iterable[dict[str, Any]]:
    """Return the same for JSON, with everything that was measured."""
    for method, m in measured.items():
        yield {"scene": scene, "minimum_size": size, "method": method, **m.as_json()}


def arguments() -> argparse.Namespace:
    """Return what the command line asks for."""
    parser = argparse.ArgumentParser(prog="python -m bench.compare", description=__doc__.splitlines()[0])
    parser.add_argument(
        "--scene", action="append", choices=sorted(SCENES), help="default: Cornell box and the paper's 1"
    )
    parser.add_argument("--size", action="append", type=float, help="minimum size in metres, repeatable")
    parser.add_argument("--threshold", type=float, default=0.02)
    parser.add_argument("--quality", choices=QUALITIES, default="GOOD")
    parser.add_argument("--probes", type=int, default=4000)
    parser.add_argument("--parts", type=int, default=0, help="of the reference, for a quick one: 0 takes what is due")
    parser.add_argument("--repeat", type=int, default=1, help="bakes of each kind; the shortest time counts")
    return parser.parse_args()


def main() -> None:
    """Measure, print and write the table."""
    asked = arguments()
    about = machine()
    lines = [
        f"Threshold {asked.threshold:g}, quality {asked.quality}, {about['cores']} cores, {about['processor']}.",
        f"Error: relative RMS of irradiance at {asked.probes:,} area-uniform points against Mitsuba 3 path tracing.",
        "Fewer and gain: fragments and time that adaptive saves on uniform.",
        "",
        HEADER,
    ]
    print("\n".join(lines), flush=True)
    entries: list[dict[str, Any]] = []
    for name in asked.scene or ("cornell_box", "paper_scene_1"):
        case = judged(name, asked.probes, asked.parts)
        measure(case, BakeSettings(quality="DRAFT"))  # the first bake of a process also pays for loading libraries
        for size in asked.size or SIZES.get(name, (1.0, 0.5, 0.25)):
            measured = pair(case, size, asked.threshold, asked.quality, asked.repeat)
            entries += entries_of(name, size, measured)
            for line in lines_of(name, size, measured):
                print(line, flush=True)
                lines.append(line)
    write_json("compare", entries)
    (OUT / "compare.txt").write_text("\n".join(lines) + "\n")


if __name__ == "__main__":
    main()
