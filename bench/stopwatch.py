# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""What a computation took: wall clock, processor time, and how much of the machine others took meanwhile.

Wall clock is what a user waits, and what is compared; on a machine that is busy with something else it means little. So
every measurement also says what its processes used of the processors, and what others did.
"""

from __future__ import annotations

import os
import resource
import time
from collections.abc import Callable
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any, TypeVar

Result = TypeVar("Result")

# Short runs are repeated, and the shortest counts: anything longer is the machine's doing. The same for all programs.
MOST_RUNS = 3
ENOUGH_SECONDS = 4.0

# States of `/proc/stat`'s first line in which a processor works: user, nice, system, irq, softirq, steal.
WORKING_STATES = (0, 1, 2, 5, 6, 7)


@dataclass(frozen=True)
class Cost:
    """What a run took.

    Attributes
    ----------
    seconds : float
        Wall clock.
    processor_seconds : float
        Of all processors, this process and those it started, in user and system mode.
    others : float
        Share of all processors that other processes kept busy meanwhile, 0..1; 0 where the system does not tell.
    """

    seconds: float
    processor_seconds: float
    others: float

    def as_json(self) -> dict[str, Any]:
        """Return what JSON can hold."""
        return asdict(self)


@dataclass(frozen=True)
class Instant:
    """Clocks read at one moment, in seconds."""

    wall: float
    own: float
    machine: float

    @staticmethod
    def now() -> Instant:
        """Read the clocks."""
        # `os.times` counts hundredths of seconds, of which a coarse bake takes few.
        own = [resource.getrusage(whose) for whose in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN)]
        own_seconds = sum(used.ru_utime + used.ru_stime for used in own)
        return Instant(time.perf_counter(), own_seconds, working_seconds())

    def cost_until(self, end: Instant) -> Cost:
        """Return what was spent between this moment and a later one."""
        wall, own = end.wall - self.wall, end.own - self.own
        capacity = wall * (os.cpu_count() or 1)
        others = (end.machine - self.machine - own) / capacity if capacity > 0.0 else 0.0
        return Cost(wall, own, min(max(others, 0.0), 1.0))


def working_seconds() -> float:
    """Return for how long the processors have worked since the machine started, summed over them; 0 if unknown."""
    counts = Path("/proc/stat")
    if not counts.exists():
        return 0.0
    ticks = [int(word) for word in counts.read_text().splitlines()[0].split()[1:]]
    return sum(ticks[k] for k in WORKING_STATES) / os.sysconf("SC_CLK_TCK")


def timed_once(run: Callable[[], Result]) -> tuple[Result, Cost]:
    """Return what `run` returns and what it took."""
    start = Instant.now()
    result = run()
    return result, start.cost_until(Instant.now())


def timed(run: Callable[[], Result]) -> tuple[Result, Cost]:
    """Return what `run` returns and what it took, the shortest of a few runs where it is short."""
    costs: list[Cost] = []
    while len(costs) < MOST_RUNS and sum(cost.seconds for cost in costs) < ENOUGH_SECONDS:
        result, cost = timed_once(run)
        costs.append(cost)
    return result, min(costs, key=lambda cost: cost.seconds)
