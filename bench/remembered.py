# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The peers' answers on disk: they take far longer than we do, and change only when they or the scenes do.

An answer is known by the scene, the probes, the program's version and setting, and the machine, so a cached time is one
of this machine. It keeps when it was measured: the page says whether that was in the same run as ours.
"""

from __future__ import annotations

import os
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from tools.package import ROOT

from .machine import processor, versions
from .measure import Judged
from .peers import Answer, Run
from .reference import digest
from .stopwatch import Cost

CACHE = ROOT / ".cache" / "peers"

# Part of the key: to be raised whenever a change of ours changes what peers are asked.
METHOD = 3

PACKAGE_OF_PEER = {"mitsuba": "mitsuba", "radiance": "pyradiance", "cycles": "bpy"}


@dataclass(frozen=True, eq=False)
class Remembered:
    """An answer and when it was measured.

    Attributes
    ----------
    answer : Answer
    run : str
        When the command was started that measured it, ISO 8601.
    """

    answer: Answer
    run: str


def known_answer(case: Judged, asked: Run) -> Remembered | None:
    """Return a peer's answer from disk, or None."""
    path = place_of(case, asked)
    if not path.exists():
        return None
    with np.load(path) as stored:
        cost = Cost(*(float(x) for x in stored["cost"]))
        return Remembered(Answer(stored["irradiance"], cost, int(stored["points"])), str(stored["run"]))


def place_of(case: Judged, asked: Run) -> Path:
    """Return the file of an answer."""
    p = case.probes
    version = versions().get(PACKAGE_OF_PEER[asked.peer], "")
    place = f"{processor()} {os.cpu_count()}"
    key = digest(case.scene, p.position, p.shading_normal, METHOD, asked.method, asked.setting, version, place)
    return CACHE / f"{key}.npz"


def answered(case: Judged, asked: Run, run: str, fresh: bool) -> Remembered:
    """Return a peer's answer, from disk where it is known.

    Parameters
    ----------
    run : str
        The start of this command, stored with what is measured now.
    fresh : bool
        Measure even what is known.
    """
    known = None if fresh else known_answer(case, asked)
    if known is not None:
        return known
    answer = asked.answer(case)
    cost = answer.cost
    CACHE.mkdir(parents=True, exist_ok=True)
    path = place_of(case, asked)
    temporary = path.with_suffix(f".{os.getpid()}.npz")
    np.savez(
        temporary,
        irradiance=answer.irradiance,
        cost=[cost.seconds, cost.processor_seconds, cost.others],
        points=answer.points,
        run=run,
    )
    temporary.replace(path)
    return Remembered(answer, run)
