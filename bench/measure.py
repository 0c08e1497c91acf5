# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""One bake, timed and compared with the reference."""

from __future__ import annotations

import json
import math
import subprocess
import sys
import tempfile
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, replace
from functools import cache
from inspect import signature
from pathlib import Path
from typing import Any
from unittest.mock import patch

import numpy as np
from radiosity_bake.core import bake as bake_module
from radiosity_bake.core.bake import bake
from radiosity_bake.core.detail import light_up_in_detail
from radiosity_bake.core.diagonals import turned_diagonals
from radiosity_bake.core.result import BakeResult
from radiosity_bake.core.scene import Scene
from radiosity_bake.core.settings import BakeSettings

from .accuracy import Accuracy, compare, irradiance_at_probes
from .probes import Probes, area_uniform_probes
from .reference import Reference, converged
from .scenes import SCENES
from .stopwatch import Cost, timed
from .varied_scenes import VARIED_SCENES

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

FLAT = 1e-6
"""Corner normals of a triangle that differ by no more than this are those of a flat one."""

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
    """Return a scene of `SCENES` or `VARIED_SCENES` with its reference, computed once and then read from disk.

    Parameters
    ----------
    parts : int
        Of the reference, for a noisier one than is due; 0 takes `REFERENCE_PARTS`.
    """
    scene = (SCENES | VARIED_SCENES)[name]()
    points = area_uniform_probes(scene, probes)
    wanted = parts or REFERENCE_PARTS.get(name, 1)
    bright = 0 if parts else BRIGHT_PARTS.get(name, 0)
    truth = converged(scene, points.position, points.normal, points.shading_normal, wanted, bright)
    return Judged(name, scene, points, truth)


def operator_costs(case: Judged, qualities: Sequence[str]) -> dict[str, dict[str, Any]]:
    """Return what Blender's operator took for each quality, from mesh to mesh, and what it counted."""
    with tempfile.TemporaryDirectory() as folder:
        return run_operator(case.scene, qualities, Path(folder))


def run_operator(scene: Scene, qualities: Sequence[str], folder: Path, warm: bool = True) -> dict[str, dict[str, Any]]:
    """Bake a scene by Blender's operator in a process of its own: what each quality took, what it counted.

    Parameters
    ----------
    folder : Path
        For the scene's file.
    warm : bool
        Whether a bake that does not count comes first, as it also pays for loading libraries.
    """
    arrays: dict[str, np.ndarray] = {"world": scene.world}
    for k, mesh in enumerate(scene.meshes):
        arrays[f"vertices_{k}"], arrays[f"triangles_{k}"] = mesh.vertices, mesh.triangles
        arrays[f"reflectance_{k}"], arrays[f"emission_{k}"] = mesh.reflectance, mesh.emission
        normals = mesh.corner_normals
        arrays[f"smooth_{k}"] = np.any(np.abs(normals - normals[:, :1]) > FLAT, axis=(1, 2))
    given = folder / "scene.npz"
    np.savez(given, **arrays)
    script = Path(__file__).with_name("operator_bake.py")
    command = [sys.executable, str(script), *([] if warm else ["--cold"]), str(given), *qualities]
    done = subprocess.run(command, check=True, stdout=subprocess.PIPE, text=True)
    return {found["quality"]: found for found in json.loads(done.stdout.splitlines()[-1])}


@contextmanager
def by_form_factors_alone() -> Iterator[None]:
    """Let adaptive bakes at a minimum size refine as the paper does: by form factors down to it, not by the light."""

    def same_sizes(surfaces: Any, settings: BakeSettings, effort: Any, area: float) -> tuple[float, float]:
        return settings.minimum_size, settings.minimum_size

    def never_split(*arguments: Any) -> Any:
        bound = signature(light_up_in_detail).bind(*arguments)
        bound.arguments["tolerance"] = math.inf
        return light_up_in_detail(*bound.args)

    def never_turned(surfaces: Any, shown: Any, tolerance: float) -> Any:
        return turned_diagonals(surfaces, shown, math.inf)

    with (
        patch.object(bake_module, "minimum_sizes", same_sizes),
        patch.object(bake_module, "light_up_in_detail", never_split),
        patch.object(bake_module, "turned_diagonals", never_turned),
    ):
        yield


def measure(case: Judged, settings: BakeSettings) -> Measured:
    """Bake, and compare."""
    result, cost = timed(lambda: bake(case.scene, settings))
    # What is kept for relighting would fill the memory with every measurement.
    return judge(case, replace(result, kept=None), cost)


def judge(case: Judged, result: BakeResult, cost: Cost) -> Measured:
    """Compare a bake with the reference."""
    values = irradiance_at_probes(result, case.probes)
    return Measured(cost, result.report, compare(case.scene, case.probes, values, case.reference), result)
