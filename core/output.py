# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The baked meshes: values sorted back to the meshes and corners that they belong to."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .geometry import triangle_areas
from .result import BakedMesh
from .scene import Floats, Ints, Scene, Texture
from .subdivision import Faces
from .surfaces import Surfaces
from .textures import corner_colours

FACES_AT_ONCE = 2**16
"""Faces that are sorted back together: of a dense mesh, what is made of all at once on the way would be several times
what is handed back."""


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
    light = _SideLight.of(len(faces.triangle), face, irradiance)
    turned = (~lit[:, 0] & lit[:, 1])[surfaces.shell_of_triangle[faces.triangle]]
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
        if output == "ORIGINAL":
            meshes.append(_original(scene, surfaces, faces, number, chosen, light))
        else:
            meshes.append(_refined(surfaces, faces, number, chosen, light, turned))
    return tuple(meshes), warnings


@dataclass(frozen=True, eq=False)
class _SideLight:
    """Irradiance at the corners of face sides, found by their faces.

    Attributes
    ----------
    irradiance : (f, 3, 3) float, W m^-2 sr^-1
        All fronts in order, then some backs.
    row_of_back : (faces,) int
        -1 for a face whose back has no values.
    """

    irradiance: Floats
    row_of_back: Ints

    @staticmethod
    def of(faces: int, face: Ints, irradiance: Floats) -> _SideLight:
        row_of_back = np.full(faces, -1, dtype=np.int64)
        row_of_back[face[faces:]] = np.arange(faces, len(face))
        return _SideLight(irradiance, row_of_back)

    def fronts(self, chosen: Ints) -> Floats:
        """Of the fronts of some faces (n,), (n, 3, 3)."""
        return self.irradiance[chosen]

    def have_backs(self, chosen: Ints) -> bool:
        """Whether the back of any of these faces has values."""
        return bool((self.row_of_back[chosen] >= 0).any())

    def backs(self, chosen: Ints) -> Floats:
        """Of the backs of some faces, (n, 3, 3), black where they have none."""
        row = self.row_of_back[chosen]
        values = self.irradiance[row]
        values[row < 0] = 0.0
        return values


def _colours_at_corners(surfaces: Surfaces, faces: Faces, chosen: Ints) -> tuple[Floats, Floats, Floats | None]:
    """Reflectance, emission and translucence at the corners of all faces of a mesh, (f, 3, 3); not to be written to."""
    triangle = faces.triangle[chosen]

    def of_corners(colours: Floats, texture: Texture | None) -> Floats:
        if texture is None:
            return np.broadcast_to(colours[triangle, None], (len(chosen), 3, 3))
        corners = faces.corners[chosen]
        areas = triangle_areas(faces.points[corners])
        return corner_colours(colours, texture, corners, triangle, faces.weights[chosen], areas)

    return (
        of_corners(*surfaces.own_colours()),
        of_corners(surfaces.emission, surfaces.emission_texture),
        None if surfaces.translucence is None else of_corners(surfaces.translucence, surfaces.translucence_texture),
    )


def _sent(
    reflectance: Floats, translucence: Floats | None, front: Floats, back: Floats | None
) -> tuple[Floats, Floats]:
    """What both sides of faces reflect and send on of each other's light, (f, 3, 3) each."""
    behind = np.zeros_like(front) if back is None else back
    if translucence is None:
        return reflectance * front, reflectance * behind
    return reflectance * front + translucence * behind, reflectance * behind + translucence * front


def _original(
    scene: Scene, surfaces: Surfaces, faces: Faces, number: int, chosen: Ints, light: _SideLight
) -> BakedMesh:
    """Values at the corners of the input's triangles, in their order; triangles that were left out stay black."""
    mesh = scene.meshes[number]
    place = surfaces.input_triangle[faces.triangle[chosen]]
    count = len(mesh.triangles)
    reflectance, emission, translucence = _colours_at_corners(surfaces, faces, chosen)

    def spread(values: Floats) -> Floats:
        full = np.zeros((count, 3, 3))
        full[place] = values
        return full

    front, back = light.fronts(chosen), light.backs(chosen) if light.have_backs(chosen) else None
    sent, sent_behind = _sent(reflectance, translucence, front, back)
    irradiance, radiosity = spread(front), spread(emission + sent)
    behind = None if back is None else spread(back)
    emission_behind = np.where(surfaces.front_only[faces.triangle[chosen], None, None], 0.0, emission)
    radiosity_behind = None if back is None else spread(emission_behind + sent_behind)
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


def _refined(
    surfaces: Surfaces, faces: Faces, number: int, chosen: Ints, light: _SideLight, turned: NDArray[np.bool_]
) -> BakedMesh:
    """The conforming subdivision of one mesh, shells that are lit from behind turned over.

    Parameters
    ----------
    chosen : (f,) int
        Its faces.
    turned : (faces,) bool
        Faces that are lit from behind.
    """
    has_backs = light.have_backs(chosen)
    reflectance, emission, translucence = _colours_at_corners(surfaces, faces, chosen)
    # Blender crashes when it computes normals of faces that have a corner twice.
    a, b, c = faces.corners[chosen].T
    sound = np.flatnonzero((a != b) & (b != c) & (c != a))
    chosen = chosen[sound]
    first_point, last_point = surfaces.first_point_of_mesh[number : number + 2]
    made = np.flatnonzero(faces.mesh_of_point == number)
    made = np.intersect1d(made[made >= surfaces.first_point_of_mesh[-1]], faces.corners[chosen])
    index = np.full(len(faces.points), -1, dtype=np.int64)
    kept = np.concatenate([np.arange(first_point, last_point), made])
    index[kept] = np.arange(len(kept))
    triangles = np.empty((len(chosen), 3), dtype=np.int64)
    names = ["barycentric", "corner_normals", "radiosity", "irradiance"]
    names += ["radiosity_back", "irradiance_back"] if has_backs else []
    values: dict[str, Any] = {name: np.empty((len(chosen), 3, 3)) for name in names}
    for first in range(0, len(chosen), FACES_AT_ONCE):
        part = slice(first, first + FACES_AT_ONCE)
        some, pale, bright = chosen[part], reflectance[sound[part]], emission[sound[part]]
        over = turned[some]
        order = np.where(over[:, None], [0, 2, 1], [0, 1, 2])
        triangles[part] = index[np.take_along_axis(faces.corners[some], order, axis=1)]
        over = over[:, None, None]
        bright_behind = np.where(surfaces.front_only[faces.triangle[some], None, None], 0.0, bright)
        irradiance, normals = light.fronts(some), faces.taken(some).corner_normals(surfaces)
        found: dict[str, Floats] = {"barycentric": faces.weights[some]}
        behind: Floats | None = None
        if has_backs:
            back = light.backs(some)
            irradiance, behind = np.where(over, back, irradiance), np.where(over, irradiance, back)
            normals = np.where(over, -normals, normals)
            found["irradiance_back"] = behind
        silky = None if translucence is None else translucence[sound[part]]
        sent, sent_behind = _sent(pale, silky, irradiance, behind)
        if behind is not None:
            found["radiosity_back"] = np.where(over, bright, bright_behind) + sent_behind
        found["corner_normals"], found["irradiance"] = normals, irradiance
        found["radiosity"] = np.where(over, bright_behind, bright) + sent
        for name in names:
            values[name][part] = np.take_along_axis(found[name], order[:, :, None], axis=1)
    if has_backs and not values["irradiance_back"].any():
        del values["irradiance_back"], values["radiosity_back"]
    return BakedMesh(
        mesh=number,
        vertices=faces.points[kept],
        triangles=triangles,
        parent_triangle=surfaces.input_triangle[faces.triangle[chosen]],
        **values,
    )
