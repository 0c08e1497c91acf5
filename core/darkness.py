# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The bake of a scene without light, for whom darkness is no mistake: a frame at which all lamps are off."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict, replace
from typing import Any

import numpy as np

from .errors import NoLightError
from .result import BakedMesh, BakeResult
from .scene import Scene, SurfaceMesh
from .settings import BakeSettings

_LIGHT = ("radiosity", "irradiance", "radiosity_back", "irradiance_back")


def darkness(
    scene: Scene, settings: BakeSettings, why: NoLightError, like: Sequence[BakedMesh] | None = None
) -> BakeResult:
    """Give back black meshes.

    Parameters
    ----------
    scene : Scene
    settings : BakeSettings
    why : NoLightError
        That the bake of this scene raised.
    like : sequence of BakedMesh, optional
        The meshes of this scene in other light, whose subdivision they take; else they are as in the scene.

    Returns
    -------
    With `'dark'` true and the reason in `'ended'` in the report, in which all that tells of light is missing.
    """
    if like is None:
        meshes = tuple(_black(number, mesh) for number, mesh in enumerate(scene.meshes) if mesh.baked)
    else:
        meshes = tuple(_darkened(mesh) for mesh in like)
    report: dict[str, Any] = {
        "relit": False,
        "dark": True,
        "patches": 0,
        "vertices": sum(len(np.unique(mesh.triangles)) for mesh in meshes),
        "triangles": sum(len(mesh.triangles) for mesh in meshes),
        "rays": 0,
        "seconds": {"total": 0.0},
        "ended": str(why),
        "settings": asdict(settings),
        "warnings": [],
    }
    return BakeResult(meshes, report)


def _black(number: int, mesh: SurfaceMesh) -> BakedMesh:
    count = len(mesh.triangles)
    black = np.zeros((count, 3, 3))
    weights = np.broadcast_to(np.eye(3), (count, 3, 3))
    return BakedMesh(
        number, mesh.vertices, mesh.triangles, np.arange(count), weights, mesh.corner_normals, black, black
    )


def _darkened(mesh: BakedMesh) -> BakedMesh:
    """The mesh without light, nor any light groups: those without light have no values."""
    found = {name: getattr(mesh, name) for name in _LIGHT}
    black = {name: np.zeros_like(part) for name, part in found.items() if part is not None}
    return replace(mesh, groups=(), **black)
