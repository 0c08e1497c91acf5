# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Error against time and vertices, ours and the peers', on several scenes: `python -m bench`.

Writes `out/bench.json` after every measurement, and `out/bench.svg` and `.png` at the end.
"""

from __future__ import annotations

import argparse
from collections.abc import Callable, Iterator
from typing import Any

from radiosity_bake.core.settings import METHODS, QUALITIES, BakeSettings

from . import peers
from .accuracy import Accuracy, compare
from .chart import draw
from .machine import write_json
from .measure import Judged, judged, measure
from .scenes import SCENES

DEFAULT_SCENES = ("cornell_box", "corridor", "furnished_room", "pillar_hall", "statue")

# Minimum size of the uniform mesh that Cycles bakes: fine enough that its noise, not the mesh, decides at first.
CYCLES_SIZE = {"cornell_box": 0.02, "paper_scene_1": 0.1, "corridor": 0.1, "furnished_room": 0.1}
CYCLES_SIZE |= {"pillar_hall": 0.4, "statue": 0.1}

Entry = dict[str, Any]


def entry(
    case: Judged, method: str, setting: str, seconds: float, points: int, accuracy: Accuracy, **more: Any
) -> Entry:
    """Return one point of the chart as JSON holds it."""
    return {
        "scene": case.name,
        "method": method,
        "setting": setting,
        "seconds": seconds,
        "points": points,
        "accuracy": accuracy.as_json(),
        **more,
    }


def ours(case: Judged, qualities: tuple[str, ...]) -> Iterator[Entry]:
    """Yield our bakes: both methods in each quality, the minimum size chosen by the quality."""
    measure(case, BakeSettings(quality="DRAFT"))  # the first bake of a process also pays for loading libraries
    for method in METHODS:
        for quality in qualities:
            m = measure(case, BakeSettings(method=method, quality=quality))
            name = f"Radiosity Bake {method.lower()}"
            yield entry(case, name, quality, m.seconds, m.report["vertices"], m.accuracy, report=m.report)


def theirs(case: Judged, name: str, answers: Iterator[tuple[str, Callable[[], peers.Answer]]]) -> Iterator[Entry]:
    """Yield what a peer gives at each of its settings."""
    for setting, run in answers:
        answer = run()
        accuracy = compare(case.scene, case.probes, answer.irradiance, case.reference)
        yield entry(case, name, setting, answer.seconds, answer.points, accuracy)


def everything(case: Judged, asked: argparse.Namespace) -> Iterator[Entry]:
    """Yield all measurements of one scene."""
    yield from ours(case, tuple(asked.quality or QUALITIES))
    if "mitsuba" in asked.peer:
        runs = ((f"{n} samples", lambda n=n: peers.mitsuba(case, n)) for n in (16, 64, 256, 1024))
        yield from theirs(case, "Mitsuba 3", iter(runs))
    if "radiance" in asked.peer:
        efforts = ((e.name, lambda e=e: peers.radiance(case, e)) for e in peers.RADIANCE_EFFORTS)
        yield from theirs(case, "Radiance rtrace -I", iter(efforts))
    if "cycles" in asked.peer and case.name in CYCLES_SIZE:
        size = CYCLES_SIZE[case.name]
        runs = ((f"{n} samples", lambda n=n: peers.cycles(case, n, size)) for n in (16, 64, 256))
        yield from theirs(case, "Cycles bake to vertices", iter(runs))


def arguments() -> argparse.Namespace:
    """Return what the command line asks for."""
    parser = argparse.ArgumentParser(prog="python -m bench", description=__doc__.splitlines()[0])
    parser.add_argument("--scene", action="append", choices=sorted(SCENES))
    parser.add_argument("--quality", action="append", choices=QUALITIES)
    parser.add_argument("--peer", action="append", choices=("mitsuba", "radiance", "cycles", "none"))
    parser.add_argument("--probes", type=int, default=4000)
    parser.add_argument("--parts", type=int, default=0, help="of the reference, for a quick one: 0 takes what is due")
    asked = parser.parse_args()
    asked.peer = asked.peer or ["mitsuba", "radiance", "cycles"]
    return asked


def main() -> None:
    """Measure, print, and draw."""
    asked = arguments()
    entries: list[Entry] = []
    print(f"{'scene':<16}{'method':<26}{'setting':>13}{'points':>9}{'seconds':>9}{'error':>8}{'lit':>8}{'bias':>8}")
    for name in asked.scene or DEFAULT_SCENES:
        case = judged(name, asked.probes, asked.parts)
        for e in everything(case, asked):
            entries.append(e)
            a = e["accuracy"]
            line = f"{name:<16}{e['method']:<26}{e['setting']:>13}{e['points']:>9,}{e['seconds']:>9.2f}"
            print(f"{line}{a['rms']:>8.2%}{a['lit_rms']:>8.2%}{a['bias']:>8.2%}", flush=True)
            write_json("bench", entries)
    draw(entries)


if __name__ == "__main__":
    main()
