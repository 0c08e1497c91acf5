# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Error against time and vertices, ours and the peers', on several scenes: `python -m bench`.

Writes `out/bench/SCENE.json` after every measurement, so that scenes can be measured one by one, and then, from all
that are there, the charts in `out/images` and the page `out/performance.md`; of a whole run also those in `docs`. What
peers answered is remembered in `.cache`; for a page that is published it should be measured in the same run, with
`--answers fresh`.
"""

from __future__ import annotations

import argparse
from collections.abc import Iterator
from contextlib import nullcontext
from datetime import UTC, datetime
from typing import Any

from radiosity_bake.core.settings import QUALITIES, BakeSettings

from . import form_factors, profile, publish, scaling
from .accuracy import compare
from .machine import OUT, write_json
from .measure import Judged, Measured, by_form_factors_alone, judged, measure, operator_costs
from .methods import BENCH_SCENES, OURS, RULE, UNIFORM
from .peers import Run, runs_of
from .remembered import Remembered, answered, known_answer
from .scenes import SCENES, even_size

PEERS = ("mitsuba", "radiance", "cycles")

# Patches that a scene, cut evenly, has about at the minimum sizes of the two methods that take one.
PATCHES = (1_000, 4_000, 16_000, 64_000)

# A peer that took longer is not asked for its dearer settings on that scene.
MOST_PROCESSOR_SECONDS = 60.0

Entry = dict[str, Any]


def ours(case: Judged, qualities: tuple[str, ...]) -> Iterator[Entry]:
    """Yield our bakes: each quality as a user has it; uniform, and by the paper's rule, at several sizes.

    By the paper's rule, form factors alone decide what is split; the light on the faces does not.
    """
    measure(case, BakeSettings(quality="DRAFT"))  # the first bake of a process also pays for loading libraries
    whole = operator_costs(case, qualities)
    for quality in qualities:
        entry = baked(OURS, quality, measure(case, BakeSettings(quality=quality)))
        clocks = ("seconds", "processor_seconds")
        yield {**entry, **{f"operator_{clock}": round(whole[quality][clock], 4) for clock in clocks}}
    for name, method, how in ((UNIFORM, "UNIFORM", nullcontext), (RULE, "ADAPTIVE", by_form_factors_alone)):
        for patches in PATCHES:
            size = even_size(case.scene, patches)
            with how():
                measured = measure(case, BakeSettings(method=method, minimum_size=size))
            yield baked(name, f"n = {size:.3g} m", measured)


def baked(method: str, setting: str, measured: Measured) -> Entry:
    """Return one of our bakes as JSON holds it."""
    report = measured.report
    return {
        "method": method,
        "setting": setting,
        **measured.cost.as_json(),
        "points": report["vertices"],
        "patches": report["patches"],
        "rays": report["rays"],
        "accuracy": measured.accuracy.as_json(),
        "report": report,
    }


def theirs(case: Judged, peers: tuple[str, ...], run: str, which: str) -> Iterator[Entry]:
    """Yield what the peers give at each of their settings; `which` of them are measured is as on the command line."""
    for asked, known in affordable(case, peers, run, which):
        answer = known.answer
        yield {
            "method": asked.method,
            "setting": asked.setting,
            **answer.cost.as_json(),
            "points": answer.points,
            "accuracy": compare(case.scene, case.probes, answer.irradiance, case.reference).as_json(),
            "run": known.run,
        }


def affordable(case: Judged, peers: tuple[str, ...], run: str, which: str) -> Iterator[tuple[Run, Remembered]]:
    """Yield the answers of the peers, each cheapest setting first, until one was too dear."""
    dear = set()
    for asked in runs_of(case, peers.__contains__):
        if asked.method in dear:
            continue
        known = known_answer(case, asked) if which == "known" else answered(case, asked, run, which == "fresh")
        if known is None:
            continue
        yield asked, known
        if known.answer.cost.processor_seconds > MOST_PROCESSOR_SECONDS:
            dear.add(asked.method)


def measure_scene(name: str, asked: argparse.Namespace, run: str) -> None:
    """Measure everything on one scene, print it and write it as it comes."""
    case = judged(name, asked.probes, asked.parts)
    about = {
        "scene": name,
        "run": run,
        "triangles": sum(len(mesh.triangles) for mesh in case.scene.meshes),
        "probes": len(case.probes),
        "reference_samples": case.reference.samples,
        "reference_noise": case.reference.noise,
    }
    entries: list[Entry] = []
    qualities, peers = tuple(asked.quality or QUALITIES), tuple(asked.peer or PEERS)
    for each in (ours(case, qualities), theirs(case, peers, run, asked.answers)):
        for entry in each:
            entries.append({"run": run, **entry})
            print(line_of(name, entry), flush=True)
            write_json(OUT / "bench" / f"{name}.json", {**about, "results": entries})


HEADER = f"{'scene':<15}{'method':<38}{'setting':<32}{'points':>8}{'seconds':>9}{'cpu':>8}{'others':>7}{'error':>8}"


def line_of(scene: str, entry: Entry) -> str:
    """Return one measurement as a line of the printed table."""
    accuracy = entry["accuracy"]
    line = f"{scene:<15}{entry['method']:<38}{entry['setting']:<32}{entry['points']:>8,}{entry['seconds']:>9.2f}"
    return f"{line}{entry['processor_seconds']:>8.2f}{entry['others']:>7.0%}{accuracy['rms']:>8.2%}"


def arguments() -> argparse.Namespace:
    """Return what the command line asks for."""
    parser = argparse.ArgumentParser(prog="python -m bench", description=__doc__.splitlines()[0])
    parser.add_argument("--scene", action="append", choices=sorted(SCENES), help="default: the five of the page")
    parser.add_argument("--quality", action="append", choices=QUALITIES)
    parser.add_argument("--peer", action="append", choices=(*PEERS, "none"), help="default: all")
    parser.add_argument(
        "--answers",
        choices=("missing", "fresh", "known"),
        default="missing",
        help="of the peers: measure what is missing (the default), everything afresh, or nothing",
    )
    parser.add_argument("--publish", action="store_true", help="write docs/performance.md though not all was run")
    parser.add_argument("--probes", type=int, default=4000)
    parser.add_argument("--parts", type=int, default=0, help="of the reference, for a quick one: 0 takes what is due")
    parser.add_argument("--page-only", action="store_true", help="measure nothing; draw what was measured")
    return parser.parse_args()


def main() -> None:
    """Measure, print, and draw."""
    asked = arguments()
    run = datetime.now(UTC).isoformat(timespec="seconds")
    if not asked.page_only:
        print(HEADER, flush=True)
        for name in asked.scene or BENCH_SCENES:
            measure_scene(name, asked, run)
        if not asked.scene:
            form_factors.write()
            profile.write()
            scaling.write()
    whole = not (asked.scene or asked.quality or asked.peer or asked.parts or asked.page_only)
    for path in publish.write_all(OUT, docs=whole or asked.publish):
        print(path)


if __name__ == "__main__":
    main()
