# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Triangles that something standing on them divides: a wall without thickness on a floor that runs on under it.

Both sides of such a wall may be lit, so that no corner is hidden; but light does not go from corner to corner. A ray
along each edge, a little above it, tells whether something stands on it, and where.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .receivers import Receivers
from .rows import COVER_GAP
from .sampling import Singles
from .scene import Floats, Ints
from .visibility import RayScene

BESIDE_END = 1e-3
"""Share of an edge from its ends at which nothing divides it: what a ray meets there, it met where it began."""


def ways_along(
    rays: RayScene, places: Receivers, start: Ints, end: Ints, finest: float, walls: NDArray[np.bool_]
) -> Floats:
    """How far rays get from some receivers to others, as shares of the way, (k,); 1 where nothing stands in between.

    They run at the height up to which a gap counts as closed, as `gather` has it.

    Parameters
    ----------
    start, end : (k,) int
        Receivers.
    finest : float, scene units
        Size that faces may be split down to.
    walls : (triangles,) bool
        Those that count.
    """

    def work(first: int, last: int) -> Floats:
        part = slice(first, last)
        origins, ends = (_above(rays, places, which[part], finest) for which in (start, end))
        found = rays.first_hits(origins, ends - origins)
        met = (found.triangle >= 0) & walls[found.triangle]
        share: Floats = np.where(met, np.minimum(found.distance.astype(np.float64), 1.0), 1.0)
        return share

    parts = rays.workers.map(work, len(start), 1)
    return np.concatenate([np.zeros(0), *parts])


def _above(rays: RayScene, places: Receivers, which: Ints, finest: float) -> Singles:
    height = COVER_GAP * np.minimum(places.sizes[which], finest)
    return rays.local(places.points[which] + places.lift[which] * height[:, None])


THICKNESS = 0.02
"""Share of an edge up to which what stands on it is a wall, and not the corner of a block that the edge passes by."""


@dataclass(frozen=True, eq=False)
class Divisions:
    """Triangles of which something stands between one corner and the two others.

    Attributes
    ----------
    number : (k,) int, ascending
        Of the triangles.
    alone : (k,) int
        The corner that is alone on its side, 0 to 2.
    reach : (k, 2) float
        How far its side reaches on the edges to the next corner and to the one before, as shares of them.
    thin : (k,) bool
        Whether that has no thickness to speak of.
    """

    number: Ints
    alone: Ints
    reach: Floats
    thin: NDArray[np.bool_]

    @staticmethod
    def of(ways: Floats) -> Divisions:
        """Divide the triangles two of whose edges are blocked; `ways` (n, 3, 2) as `blocked_edges` has them."""
        blocked = (ways < 1.0).all(axis=2)
        number = np.flatnonzero(blocked.sum(axis=1) == 2)
        # Behind the edge that is free stand its two corners, before it the third.
        alone = (np.argmin(blocked[number], axis=1) + 2) % 3
        share = (ways[number, :, 0] + 1.0 - ways[number, :, 1]) / 2.0
        row = np.arange(len(number))
        reach = np.stack([share[row, alone], 1.0 - share[row, (alone + 2) % 3]], axis=1)
        return Divisions(
            number,
            alone,
            reach,
            (ways[number].sum(axis=2) > 1.0 - THICKNESS)[blocked[number]].reshape(-1, 2).all(axis=1),
        )

    def own_corners(self, triangle: Ints, weights: Floats) -> tuple[Ints, Floats]:
        """Barycentric coordinates of places with the corners beyond the division left out.

        Parameters
        ----------
        triangle : (m,) int
            The triangle of each place, divided or not.
        weights : (m, 3) float
            Its barycentric coordinates.

        Returns
        -------
        divided : (d,) int
            Places in triangles that are divided.
        weights : (d, 3) float
        """
        if len(self.number) == 0:
            return np.zeros(0, dtype=np.int64), np.zeros((0, 3))
        row = np.minimum(np.searchsorted(self.number, triangle), len(self.number) - 1)
        divided = np.flatnonzero(self.number[row] == triangle)
        row, weights = row[divided], weights[divided].astype(np.float64)
        at, alone = np.arange(len(divided)), self.alone[row]
        following, before = (alone + 1) % 3, (alone + 2) % 3
        beyond = weights[at, following] / self.reach[row, 0] + weights[at, before] / self.reach[row, 1] > 1.0
        own = np.where(beyond, weights[at, following] + weights[at, before], 1.0)
        weights[at, alone] = np.where(beyond, 0.0, 1.0)
        for corner in (following, before):
            weights[at, corner] = np.where(beyond, weights[at, corner] / own, 0.0)
        return divided, weights


def blocked_edges(
    rays: RayScene,
    places: Receivers,
    of_corner: Ints,
    hidden: NDArray[np.bool_],
    finest: float,
    walls: NDArray[np.bool_],
) -> Floats:
    """How far the edges 0-1, 1-2 and 2-0 of triangles are free of what stands on them, (n, 3, 2).

    From their first corner and from their second, as shares of the edge; 1 both ways where nothing stands on it, and
    where an end is hidden.

    Parameters
    ----------
    of_corner : (n, 3) int
        Receivers of the corners; -1 where there is none.
    hidden : (receivers,) bool
    finest, walls
        As of `ways_along`.
    """
    start, end = of_corner.ravel(), np.roll(of_corner, -1, axis=1).ravel()
    known = np.flatnonzero((start >= 0) & (end >= 0) & (start != end))
    start, end = start[known], end[known]
    pairs, number = np.unique((np.minimum(start, end) << 32) | np.maximum(start, end), return_inverse=True)
    ends = np.stack([pairs >> 32, pairs & 0xFFFFFFFF])
    way = np.ones((2, len(pairs)))
    looked = np.flatnonzero(~hidden[ends].any(axis=0))
    for first, second in ((0, 1), (1, 0)):
        way[first, looked] = ways_along(rays, places, ends[first, looked], ends[second, looked], finest, walls)
        # What stands between two seen ends is met from both.
        looked = looked[way[first, looked] < 1.0]
    free = ((way < BESIDE_END) | (way > 1.0 - BESIDE_END)).any(axis=0)
    way[:, free | (way.sum(axis=0) > 1.0 + BESIDE_END)] = 1.0
    result = np.ones((of_corner.size, 2))
    turned = start != ends[0, number]
    result[known] = np.where(turned[:, None], way[::-1, number].T, way[:, number].T)
    return result.reshape(-1, 3, 2)
