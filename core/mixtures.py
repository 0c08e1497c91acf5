# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Where indirect light need not be gathered, as what was gathered around tells it.

Indirect light changes slowly, direct light does not: most vertices that the border of a shadow asks for would gather
what their neighbours have. This is the thought of irradiance caching (Ward, Rubinstein & Clear 1988) on the mesh, where
what is around is known: between the two ends of an edge light is interpolated, as it will be shown anyhow, unless what
was gathered says that this misses too much, or something is so near that it may not have been met.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from .error_estimate import interpolation_error
from .gather import Mixture
from .geometry import lengths, normalized, triangle_areas
from .lit import Lit
from .patches import PatchTree
from .receivers import Receivers
from .scene import Floats, Ints

NEAR = 0.5
"""Lengths of an edge within which nothing may be met from its ends: it might stand in between."""

SHARE_OF_TOLERANCE = 0.125
"""Share of the tolerance of all interpolation that one round may miss of the indirect light, over the surface, and"""

LARGEST_SHARE = 1.0
"""on any face."""

NOISE_OF_DIFFERENCE = 0.5
"""Share of the values' own noise that they seem to miss on a face by it alone."""

SAME_NORMAL = 0.01
"""Difference of two normals up to which they count as one."""

SAME_WAY_UP = 0.05
"""The same of the surface's own, by which a ray in the plane of the surface is met or not."""

MOST_ROWS = 8
"""Receivers that a mean is of at most, when all that it was interpolated from were themselves."""


def middles_in_between(
    known: Lit, strict: Floats, tree: PatchTree, places: Receivers, goal: tuple[float, float]
) -> Mixture:
    """Choose among the middles of edges those that get the mean of its ends.

    Parameters
    ----------
    known : Lit
        The faces before they were split.
    strict : (f,) float
        How many times more errors count on their sides.
    tree : PatchTree
        After.
    places : Receivers
        New ones, some of which are middles of known edges.
    goal : (float, float)
        Light that all interpolation may miss, RMS over the channels, W m^-2 sr^-1, and the area over which.
    """
    vertex, ends, missed, area = _halved_edges(known, strict, tree)
    order = np.argsort(vertex, kind="stable")
    wanted = places.vertices()
    first, last = (np.searchsorted(vertex[order], wanted, side=side) for side in ("left", "right"))
    place = np.repeat(np.arange(len(wanted)), last - first)
    among = np.arange(len(place)) - np.repeat(np.cumsum(last - first) - (last - first), last - first)
    edge = order[first[place] + among]
    fits = _fits(known.places, places, ends[edge], place)
    place, edge = place[fits], edge[fits]
    which, at = np.unique(place, return_index=True)
    parents = ends[edge[at]]
    kept = _is_free(known, parents) & (_named_rows(known, parents) <= MOST_ROWS)
    # Of the faces beside an edge, none may miss more.
    most = np.zeros(len(wanted))
    np.maximum.at(most, place, missed[edge])
    kept &= most[which] <= LARGEST_SHARE * goal[0]
    square = np.bincount(place, weights=missed[edge] ** 2 * area[edge], minlength=len(wanted))[which]
    which, parents, square = which[kept], parents[kept], square[kept]
    least_first = np.argsort(square, kind="stable")
    allowed = (SHARE_OF_TOLERANCE * goal[0]) ** 2 * goal[1]
    few = np.sort(least_first[np.cumsum(square[least_first]) <= allowed])
    which, parents = which[few], parents[few]
    return Mixture(which, known.gathered, parents, np.full(parents.shape, 0.5))


def _halved_edges(known: Lit, strict: Floats, tree: PatchTree) -> tuple[Ints, Ints, Floats, Floats]:
    """Edges of face sides that have a middle now: its vertex (e,), the receivers at its ends (e, 2), what
    interpolation of the indirect light misses on the face, (e,), and a third of the area of that, (e,)."""
    faces, face, gathered = known.faces, known.face, known.gathered
    of_face = tree.midpoints(faces.corners, np.roll(faces.corners, -1, axis=1))
    halved = (of_face >= 0).any(axis=1)[face]
    some = np.flatnonzero(halved)
    middles, of_corner = of_face[face[some]], known.places.of_corner
    indirect = gathered.irradiance - gathered.direct_irradiance
    corners = faces.points[faces.corners[face]]
    missed = interpolation_error(corners, known.neighbours.beside(halved), indirect[of_corner])[some]
    of_corner = of_corner[some]
    # Noise makes values differ, too, but what is gathered anew has as much of it.
    noise = (gathered.noise[of_corner] ** 2).mean(axis=1)
    missed = strict[some] * np.sqrt(np.maximum(missed**2 - NOISE_OF_DIFFERENCE**2 * noise, 0.0))
    vertices = tree.vertices(np.maximum(middles, 0), faces.node[face[some]])
    row, edge = np.nonzero(middles >= 0)
    ends = np.stack([of_corner[row, edge], of_corner[row, (edge + 1) % 3]], axis=1)
    area = triangle_areas(corners[some]) * known.share[face[some]] / 3.0
    return vertices[row, edge], ends, missed[row], area[row]


def _fits(known: Receivers, places: Receivers, ends: Ints, place: Ints) -> NDArray[np.bool_]:
    """Whether receivers `place` (e,) look as the surface does between two known ones (e, 2)."""
    result = np.ones(len(place), dtype=bool)
    for there, here, most in (
        (known.normals, places.normals, SAME_NORMAL),
        (known.lift, places.lift, SAME_WAY_UP),
    ):
        between = normalized(there[ends[:, 0]] + there[ends[:, 1]])
        result &= lengths(between - here[place]) <= most
    return result


def _is_free(known: Lit, ends: Ints) -> NDArray[np.bool_]:
    """Whether nothing is near either end of edges (e, 2)."""
    gathered = known.gathered
    apart = lengths(known.places.points[ends[:, 0]] - known.places.points[ends[:, 1]])
    free: NDArray[np.bool_] = gathered.free[ends].min(axis=1, initial=np.inf) > NEAR * apart
    return free & ~(gathered.hidden[ends] | gathered.touching[ends]).any(axis=1)


def _named_rows(known: Lit, parents: Ints) -> Ints:
    """Receivers that means of `parents` (m, 2) were gathered at, counted twice where both name them, (m,)."""
    named: Ints = np.count_nonzero(known.gathered.places.weights, axis=1)[parents].sum(axis=1)
    return named
