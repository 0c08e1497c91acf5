# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The scene as plain arrays: all that `core` ever knows of Blender."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]


@dataclass(frozen=True, eq=False)
class SurfaceMesh:
    """One mesh as it renders: world coordinates, triangles wound so that the front is counterclockwise.

    Attributes
    ----------
    name : str
        The object's name, for warnings.
    vertices : (v, 3) float, scene units
        World coordinates, in float64 (cancel large translations in float64 before anything is rounded).
    triangles : (t, 3) int
        Vertex indices. A transform of negative determinant needs its triangles turned over by whoever makes this.
    corner_normals : (t, 3, 3) float, unit
        World shading normal at each triangle corner; equal to the triangle's own normal where shading is flat.
    reflectance : (t, 3) float, 0..1
        Diffuse albedo of each triangle, linear RGB.
    emission : (t, 3) float, W m^-2 sr^-1
        Emitted radiance of each triangle, linear RGB; both sides emit, as in Cycles.
    baked : bool
        Whether values are wanted on this mesh; it takes part in the light transport either way.
    """

    name: str
    vertices: Floats
    triangles: Ints
    corner_normals: Floats
    reflectance: Floats
    emission: Floats
    baked: bool = True


@dataclass(frozen=True, eq=False)
class Scene:
    """Everything that takes part in the light transport.

    Attributes
    ----------
    meshes : tuple of SurfaceMesh
        In a fixed order; results refer to them by index.
    world : (3,) float, W m^-2 sr^-1
        Radiance that a ray meets when it leaves the scene.
    """

    meshes: tuple[SurfaceMesh, ...]
    world: Floats


def surface_mesh(
    name: str,
    vertices: object,
    triangles: object,
    *,
    reflectance: object = (0.0, 0.0, 0.0),
    emission: object = (0.0, 0.0, 0.0),
    corner_normals: object | None = None,
    baked: bool = True,
) -> SurfaceMesh:
    """Make a `SurfaceMesh` from anything array-like, colours given once or for each triangle.

    Parameters
    ----------
    vertices : (v, 3) array_like, scene units
    triangles : (t, 3) array_like of int
    reflectance, emission : (3,) or (t, 3) array_like
    corner_normals : (t, 3, 3) array_like or None
        None shades flat: every corner takes its triangle's normal (zero for a triangle without area).
    """
    points = np.array(vertices, dtype=np.float64).reshape(-1, 3)
    corners = np.array(triangles, dtype=np.int64).reshape(-1, 3)
    if corner_normals is None:
        a, b, c = (points[corners[:, k]] for k in range(3))
        with np.errstate(invalid="ignore", over="ignore"):
            normal = np.cross(b - a, c - a)
            length = np.linalg.norm(normal, axis=1, keepdims=True)
            normal = np.divide(normal, length, out=np.zeros_like(normal), where=length > 0.0)
        normals = np.repeat(normal[:, None, :], 3, axis=1)
    else:
        normals = np.array(corner_normals, dtype=np.float64).reshape(-1, 3, 3)
    shape = (len(corners), 3)
    return SurfaceMesh(
        name,
        points,
        corners,
        normals,
        np.array(np.broadcast_to(np.asarray(reflectance, dtype=np.float64), shape)),
        np.array(np.broadcast_to(np.asarray(emission, dtype=np.float64), shape)),
        baked,
    )
