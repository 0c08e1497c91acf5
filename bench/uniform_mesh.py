# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""A scene's uniform subdivision, with vertices at which other programs compute what the probes interpolate."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cache

import numpy as np
from radiosity_bake.core.bake import bake
from radiosity_bake.core.result import BakedMesh, BakeResult
from radiosity_bake.core.scene import Floats, Ints
from radiosity_bake.core.settings import BakeSettings

from .accuracy import irradiance_at_probes
from .measure import Judged
from .scenes import SCENES, even_size

# A vertex is moved by this share of the way towards the middle of its triangles: on a border, in the plane of the next
# wall, rays would pass behind that wall, and at a cut it must lie on its own side. A tenth of it is too little there.
INWARD = 1e-2


@dataclass(frozen=True, eq=False)
class SplitMesh:
    """A baked mesh's triangles with a vertex for each place, normal and light: one for each side of an edge or a cut.

    Attributes
    ----------
    vertices, inner_vertices, normals : (v, 3) float
        As they are, moved in by `INWARD`, and the shading normals.
    triangles : (t, 3) int
    parent : (t,) int
        The input's triangle of each.
    smooth : bool
    """

    vertices: Floats
    inner_vertices: Floats
    normals: Floats
    triangles: Ints
    parent: Ints
    smooth: bool


@dataclass(frozen=True, eq=False)
class UniformMesh:
    """A scene's uniform subdivision by index of the mesh, as we store it and with split vertices."""

    baked: dict[int, BakedMesh]
    split: dict[int, SplitMesh]

    @property
    def points(self) -> int:
        """Vertices of all split meshes."""
        return sum(len(part.vertices) for part in self.split.values())

    def at_probes(self, case: Judged, values: dict[int, Floats]) -> Floats:
        """Return values at the split vertices of each mesh interpolated at the probes, (n, 3)."""
        meshes = []
        for k, baked in self.baked.items():
            corners = values[k][self.split[k].triangles]
            meshes.append(replace(baked, radiosity=corners, irradiance=corners))
        return irradiance_at_probes(BakeResult(tuple(meshes), {}), case.probes)


@cache
def uniform_mesh(name: str, patches: int) -> UniformMesh:
    """Return the uniform subdivision of a scene of `SCENES` into about so many patches, meshes that only emit left out.

    As ours, it is cut where an object stands on it, which a plain grid is not: that favours those who use it.
    """
    scene = SCENES[name]()
    settings = BakeSettings(method="UNIFORM", minimum_size=even_size(scene, patches), quality="DRAFT")
    baked, split = {}, {}
    for mesh in bake(scene, settings).meshes:
        original = scene.meshes[mesh.mesh]
        if np.all(np.any(original.emission > 0.0, axis=1)):
            continue
        baked[mesh.mesh], split[mesh.mesh] = mesh, split_mesh(mesh)
    return UniformMesh(baked, split)


def split_mesh(mesh: BakedMesh) -> SplitMesh:
    """Return the mesh with a vertex for each place, normal and light.

    Corners that are one receiver of ours have the very same light; those before and behind a block's foot have not.
    """
    corners = mesh.triangles.ravel()
    key = np.column_stack([corners, np.round(mesh.corner_normals.reshape(-1, 3) * 1e3), mesh.irradiance.reshape(-1, 3)])
    _, first, index = np.unique(key, axis=0, return_index=True, return_inverse=True)
    triangles = index.reshape(-1, 3)
    vertices = mesh.vertices[corners[first]]
    middles = np.repeat(mesh.vertices[mesh.triangles].mean(axis=1), 3, axis=0)
    around = np.bincount(index.ravel(), minlength=len(first))[:, None]
    middle = np.stack([np.bincount(index.ravel(), weights=middles[:, k]) for k in range(3)], axis=1) / around
    return SplitMesh(
        vertices=vertices,
        inner_vertices=vertices + INWARD * (middle - vertices),
        normals=mesh.corner_normals.reshape(-1, 3)[first],
        triangles=triangles,
        parent=mesh.parent_triangle,
        smooth=not np.allclose(mesh.corner_normals, mesh.corner_normals[:, :1], atol=1e-6),
    )
