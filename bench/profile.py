# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Where the processor time of a bake goes, by module: `python -m bench.profile`.

Batches that threads would share out are done in turn, under Python's profiler by the clock of the process: what numpy
does counts for the module that asked for it, and what others do on the machine not at all. Writes `out/profile.json`.
"""

from __future__ import annotations

import argparse
import cProfile
import pstats
import time
from collections import defaultdict
from collections.abc import Callable, Sequence
from concurrent.futures import Future
from datetime import UTC, datetime
from pathlib import Path
from typing import Any
from unittest.mock import patch

from radiosity_bake.core import workers
from radiosity_bake.core.bake import bake
from radiosity_bake.core.settings import QUALITIES, BakeSettings

from .machine import OUT, write_json
from .methods import BENCH_SCENES
from .scenes import SCENES

RAY_LIBRARY = "ray library"

CALLS_OF_LIBRARY = ("ray_library", "run")
"""Module and function whose own time is that of the ray library."""

Function = tuple[str, int, str]


class InTurn:
    """Takes the place of a pool of threads, and does what it is given at once."""

    def __init__(self, threads: int) -> None:
        self.threads = threads

    def submit(self, work: Callable[..., Any], *arguments: Any) -> Future[Any]:
        """Do it."""
        done: Future[Any] = Future()
        done.set_result(work(*arguments))
        return done

    def shutdown(self) -> None:
        """Nothing is left to do."""


def profiled(name: str, quality: str) -> dict[str, Any]:
    """Return the processor time of a bake, its rays, and the share of the time in each module, largest first."""
    scene, asked = SCENES[name](), BakeSettings(quality=quality, threads=1, keep_transport=False)
    with patch.object(workers, "ThreadPoolExecutor", InTurn):
        bake(scene, asked)  # the first bake of a process also pays for loading libraries
        profile = cProfile.Profile(time.process_time)
        result = profile.runcall(bake, scene, asked)
    spent = by_module(pstats.Stats(profile).stats)  # type: ignore[attr-defined]
    total = sum(spent.values())
    largest_first = sorted(spent, key=spent.__getitem__, reverse=True)
    return {
        "scene": name,
        "rays": result.report["rays"],
        "processor_seconds": round(total, 4),
        "shares": {module: round(spent[module] / total, 4) for module in largest_first},
    }


def by_module(stats: dict[Function, Any]) -> dict[str, float]:
    """Return the seconds in each module of the core; functions elsewhere count for the modules that call them."""
    own: dict[Function, dict[str, float]] = {}

    def shares_of(function: Function, above: frozenset[Function]) -> dict[str, float]:
        """By module, the share of a function's own time."""
        if function in own:
            return own[function]
        path, _, called = function
        if "/core/" in path:
            module = Path(path).stem
            return {RAY_LIBRARY if (module, called) == CALLS_OF_LIBRARY else module: 1.0}
        callers = {c: entry[2] for c, entry in stats[function][4].items() if c not in above}
        total, found = sum(callers.values()), defaultdict[str, float](float)
        for caller, seconds in callers.items():
            for module, share in shares_of(caller, above | {function}).items():
                found[module] += share * (seconds / total if total > 0.0 else 1.0 / len(callers))
        if not above:
            own[function] = dict(found)
        return dict(found)

    spent = defaultdict[str, float](float)
    for function, (_, _, seconds, _, _) in stats.items():
        for module, share in shares_of(function, frozenset()).items():
            spent[module] += share * seconds
    return dict(spent)


def write(scenes: Sequence[str] = BENCH_SCENES, quality: str = "GOOD") -> None:
    """Profile, print and write."""
    rows = []
    for name in scenes:
        rows.append(profiled(name, quality))
        shares = rows[-1]["shares"].items()
        print(name, ", ".join(f"{module} {share:.1%}" for module, share in shares if share >= 0.01), flush=True)
    run = datetime.now(UTC).isoformat(timespec="seconds")
    write_json(OUT / "profile.json", {"run": run, "quality": quality, "scenes": rows})


def main() -> None:
    """Read what is asked for, and do it."""
    parser = argparse.ArgumentParser(prog="python -m bench.profile", description=__doc__.splitlines()[0])
    parser.add_argument(
        "--scene", action="append", choices=sorted(SCENES), help="default: those of the performance page"
    )
    parser.add_argument("--quality", choices=QUALITIES, default="GOOD")
    asked = parser.parse_args()
    write(asked.scene or BENCH_SCENES, asked.quality)


if __name__ == "__main__":
    main()
