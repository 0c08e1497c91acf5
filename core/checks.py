# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Places between the vertices where light is gathered, too, to be compared with what the baked mesh shows."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from .gather import Gathered
from .geometry import largest_edges, normalized, side_normals
from .receivers import Receivers
from .sampling import sequence, triangle_weights
from .scene import Floats, Ints
from .subdivision import Faces
from .surfaces import Surfaces
from .terminator import rises

VERTICES_FOR_A_CHECK = 32
"""Vertices for which there is one place: what checking costs of the gather, at most."""

FEWEST, MOST = 64, 4096
"""Places there are at least and at most."""

BY_AREA = 0.5
"""Share of the places that are spread evenly over the area; the others are over the faces, of which there are more
where light changes: by area alone a shadow's border would seldom be asked."""


@dataclass(frozen=True, eq=False)
class Checks:
    """Light gathered at places on faces.

    Attributes
    ----------
    row : (k,) int
        The face sides they lie on.
    weights : (k, 3) float
        Barycentric coordinates on them.
    areas : (k,) float, scene units squared
        What each stands for.
    gathered : Gathered
    """

    row: Ints
    weights: Floats
    areas: Floats
    gathered: Gathered

    def missed(self, irradiance: Floats) -> Floats:
        """Difference between light shown and light gathered, (k, 3); none where something hides the place.

        Parameters
        ----------
        irradiance : (f, 3, 3) float, W m^-2 sr^-1
            At the corners of face sides.
        """
        shown = np.einsum("kc,kcx->kx", self.weights, irradiance[self.row])
        missed: Floats = np.where(self.gathered.hidden[:, None], 0.0, shown - self.gathered.irradiance)
        return missed


def check_places(areas: Floats, vertices: int) -> Checks:
    """Choose the places, at which no light has been gathered yet.

    Parameters
    ----------
    areas : (f,) float
        Of face sides, as far as they count.
    vertices : int
        Places where light was gathered.
    """
    count = int(np.clip(vertices // VERTICES_FOR_A_CHECK, FEWEST, MOST)) if areas.any() else 0
    chance = BY_AREA * areas / max(float(areas.sum()), np.finfo(np.float64).tiny)
    chance += (1.0 - BY_AREA) * (areas > 0.0) / max(int(np.count_nonzero(areas)), 1)
    up_to = np.cumsum(chance)
    row = np.searchsorted(up_to, (np.arange(count) + 0.5) / max(count, 1) * up_to[-1:], side="right")
    row = np.minimum(row, len(areas) - 1)
    two = triangle_weights(sequence(0, count, 2))
    weights = np.concatenate([1.0 - two.sum(axis=1, keepdims=True), two], axis=1)
    return Checks(row, weights, areas[row] / (chance[row] * max(count, 1)), Gathered.none(0))


def receivers_of_checks(surfaces: Surfaces, faces: Faces, face: Ints, checks: Checks) -> Receivers:
    """Where light is gathered for checks on sides of faces, `face` (f,): all fronts in order, then some backs."""
    chosen = faces.taken(face[checks.row])
    side = (checks.row >= len(faces.triangle)).astype(np.int64)
    lift = side_normals(surfaces.normals[chosen.triangle], side)
    shading = np.einsum("kc,kcx->kx", checks.weights, chosen.corner_normals(surfaces))
    mesh = surfaces.mesh_of_triangle[chosen.triangle]
    weights = np.einsum("kc,kcx->kx", checks.weights, chosen.weights)
    return Receivers(
        points=np.einsum("kc,kcx->kx", checks.weights, chosen.points[chosen.corners]),
        normals=normalized(side_normals(shading, side)),
        lift=lift,
        rise=rises(surfaces, chosen.triangle, side, weights),
        grazing=surfaces.grazing[mesh],
        codes=np.arange(len(side)),
        inward=np.zeros((len(side), 3)),
        sizes=largest_edges(chosen.points, chosen.corners),
        mesh=mesh,
        shell=surfaces.shell_of_triangle[chosen.triangle],
        of_corner=np.zeros((0, 3), dtype=np.int64),
    )
