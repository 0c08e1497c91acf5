# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""One bake, timed and compared with the reference."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from typing import Any

from radiosity_bake.core.bake import bake
from radiosity_bake.core.result import BakeResult
from radiosity_bake.core.scene import Scene
from radiosity_bake.core.settings import BakeSettings

from .accuracy import Accuracy, compare, irradiance_at_probes
from .probes import Probes, area_uniform_probes
from .reference import Reference, converged
from .scenes import SCENES
from .stopwatch import Cost, timed

REFERENCE_PARTS = {
    "cornell_box": 2,
    "cornell_box_hung": 3,
    "paper_scene_1": 4,
    "paper_scene_2": 5,
    "paper_scene_3": 5,
    "corridor": 4,
    "furnished_room": 4,
    "pillar_hall": 7,
}
"""Parts of the reference that bring its noise below 0.5% RMS; `python -m bench.references` prints it."""

BRIGHT_PARTS = {"cornell_box_hung": 512}
"""The same for points far brighter than the mean."""


@dataclass(frozen=True, eq=False)
class Judged:
    """A scene with its probes and reference: what every method is compared on."""

    name: str
    scene: Scene
    probes: Probes
    reference: Reference


@dataclass(frozen=True, eq=False)
class Measured:
    """What a bake cost and how good it is.

    Attributes
    ----------
    cost : Cost
        Of `core.bake.bake`, everything included.
    report : dict
        The bake's own.
    result : BakeResult
    """

    cost: Cost
    report: dict[str, Any]
    accuracy: Accuracy
    result: BakeResult


@cache
def judged(name: str, probes: int = 4000, parts: int = 0) -> Judged:
    """Return a scene of `SCENES` with its reference, computed once and then read from disk.

    Parameters
    ----------
    parts : int
        Of the reference, for a noisier one than is due; 0 takes `REFERENCE_PARTS`.
    """
    scene = SCENES[name]()
    points = area_uniform_probes(scene, probes)
    wanted = parts or REFERENCE_PARTS.get(name, 1)
    bright = 0 if parts else BRIGHT_PARTS.get(name, 0)
    truth = converged(scene, points.position, points.normal, points.shading_normal, wanted, bright)
    return Judged(name, scene, points, truth)


def measure(case: Judged, settings: BakeSettings) -> Measured:
    """Bake, and compare."""
    result, cost = timed(lambda: bake(case.scene, settings))
    values = irradiance_at_probes(result, case.probes)
    return Measured(cost, result.report, compare(case.scene, case.probes, values, case.reference), result)
