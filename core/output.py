# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The baked meshes: values sorted back to the meshes and corners that they belong to."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from .geometry import triangle_areas
from .result import BakedMesh
from .scene import Floats, Ints, Scene
from .subdivision import Faces
from .surfaces import Surfaces
from .textures import corner_colours


def baked_meshes(
    scene: Scene,
    surfaces: Surfaces,
    lit: NDArray[np.bool_],
    faces: Faces,
    face: Ints,
    irradiance: Floats,
    output: str,
) -> tuple[tuple[BakedMesh, ...], list[str]]:
    """Make the meshes of the result, and warnings about those whose lit side is their back.

    Parameters
    ----------
    lit : (shells, 2) bool
        Whether light reaches the front and the back of each shell.
    face : (f,) int
        Face of each face side with values: all fronts in order, then some backs.
    irradiance : (f, 3, 3) float, W m^-2 sr^-1
        At their corners.
    """
    count = len(faces.triangle)
    front = irradiance[:count]
    back, has_back = np.zeros_like(front), np.zeros(count, dtype=bool)
    back[face[count:]], has_back[face[count:]] = irradiance[count:], True
    turned = (~lit[:, 0] & lit[:, 1])[surfaces.shell_of_triangle[faces.triangle]]
    reflectance, emission = _colours_at_corners(surfaces, faces)
    warnings, meshes = [], []
    mesh_of_face = surfaces.mesh_of_triangle[faces.triangle]
    for number, mesh in enumerate(scene.meshes):
        if not mesh.baked:
            continue
        chosen = np.flatnonzero(mesh_of_face == number)
        if turned[chosen].any():
            warnings.append(
                f"{mesh.name}: light reaches only the back of its faces; "
                + ("the refined mesh is turned over" if output == "REFINED" else "flip its normals to see it lit")
            )
        behind = back[chosen] if has_back[chosen].any() else None
        if output == "ORIGINAL":
            colours = reflectance[chosen], emission[chosen]
            meshes.append(_original(scene, surfaces, faces, number, chosen, front[chosen], behind, *colours))
        else:
            values = front[chosen], behind, turned[chosen], reflectance, emission
            meshes.append(_refined(surfaces, faces, number, chosen, *values))
    return tuple(meshes), warnings


def _colours_at_corners(surfaces: Surfaces, faces: Faces) -> tuple[Floats, Floats]:
    """Reflectance and emission at the corners of faces, (f, 3, 3) each."""
    where = faces.corners, faces.triangle, faces.weights
    areas = triangle_areas(faces.points[faces.corners])
    return (
        corner_colours(surfaces.reflectance, surfaces.reflectance_texture, *where, areas),
        corner_colours(surfaces.emission, surfaces.emission_texture, *where, areas),
    )


def _original(
    scene: Scene,
    surfaces: Surfaces,
    faces: Faces,
    number: int,
    chosen: Ints,
    front: Floats,
    back: Floats | None,
    reflectance: Floats,
    emission: Floats,
) -> BakedMesh:
    """Values at the corners of the input's triangles, in their order; triangles that were left out stay black."""
    mesh = scene.meshes[number]
    place = surfaces.input_triangle[faces.triangle[chosen]]
    count = len(mesh.triangles)

    def spread(values: Floats) -> Floats:
        full = np.zeros((count, 3, 3))
        full[place] = values
        return full

    irradiance, radiosity = spread(front), spread(emission + reflectance * front)
    behind = None if back is None else spread(back)
    emission_behind = np.where(surfaces.front_only[faces.triangle[chosen], None, None], 0.0, emission)
    radiosity_behind = None if back is None else spread(emission_behind + reflectance * back)
    return BakedMesh(
        mesh=number,
        vertices=mesh.vertices,
        triangles=mesh.triangles,
        parent_triangle=np.arange(count),
        barycentric=np.broadcast_to(np.eye(3), (count, 3, 3)).copy(),
        corner_normals=mesh.corner_normals,
        radiosity=radiosity,
        irradiance=irradiance,
        radiosity_back=radiosity_behind,
        irradiance_back=behind,
    )


def _without_collapsed(
    faces: Faces, chosen: Ints, front: Floats, back: Floats | None, turned: NDArray[np.bool_]
) -> tuple[Ints, Floats, Floats | None, NDArray[np.bool_]]:
    """Leave out faces that have a corner twice; Blender crashes when it computes normals of such."""
    a, b, c = faces.corners[chosen].T
    sound = (a != b) & (b != c) & (c != a)
    return chosen[sound], front[sound], None if back is None else back[sound], turned[sound]


def _refined(
    surfaces: Surfaces,
    faces: Faces,
    number: int,
    chosen: Ints,
    front: Floats,
    back: Floats | None,
    turned: NDArray[np.bool_],
    reflectance: Floats,
    emission: Floats,
) -> BakedMesh:
    """The conforming subdivision of one mesh, shells that are lit from behind turned over.

    Parameters
    ----------
    chosen : (f,) int
        Its faces, which all but the colours are of.
    reflectance, emission : (faces, 3, 3) float
        At the corners of all faces.
    """
    chosen, front, back, turned = _without_collapsed(faces, chosen, front, back, turned)
    reflectance, emission = reflectance[chosen], emission[chosen]
    emission_behind = np.where(surfaces.front_only[faces.triangle[chosen], None, None], 0.0, emission)
    emission, emission_behind = (
        np.where(turned[:, None, None], own, other)
        for own, other in ((emission_behind, emission), (emission, emission_behind))
    )
    first, last = surfaces.first_point_of_mesh[number : number + 2]
    made = np.flatnonzero(faces.mesh_of_point == number)
    made = np.intersect1d(made[made >= surfaces.first_point_of_mesh[-1]], faces.corners[chosen])
    index = np.full(len(faces.points), -1, dtype=np.int64)
    kept = np.concatenate([np.arange(first, last), made])
    index[kept] = np.arange(len(kept))
    triangle = faces.triangle[chosen]
    normals = faces.corner_normals(surfaces)[chosen]
    irradiance, behind = front, back
    if back is not None and turned.any():
        irradiance = np.where(turned[:, None, None], back, front)
        behind = np.where(turned[:, None, None], front, back)
        normals = np.where(turned[:, None, None], -normals, normals)
    if behind is not None and not behind.any():
        behind = None
    order = np.where(turned[:, None], [0, 2, 1], [0, 1, 2])

    def ordered(values: Floats) -> Floats:
        return np.take_along_axis(values, order[:, :, None], axis=1)

    return BakedMesh(
        mesh=number,
        vertices=faces.points[kept],
        triangles=index[np.take_along_axis(faces.corners[chosen], order, axis=1)],
        parent_triangle=surfaces.input_triangle[triangle],
        barycentric=ordered(faces.weights[chosen]),
        corner_normals=ordered(normals),
        radiosity=ordered(emission + reflectance * irradiance),
        irradiance=ordered(irradiance),
        radiosity_back=None if behind is None else ordered(emission_behind + reflectance * behind),
        irradiance_back=None if behind is None else ordered(behind),
    )
