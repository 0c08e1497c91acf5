# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Clusters of triangles: the coarse patches of a dense mesh, above what the input gives.

Kulyasov & Nikulin (2010) begin with few large triangles, which an object of many polygons does not have. Here
neighbours are joined, the pair of least extent first, as long as the piece stays small, connected, about flat and of
one colour (face clusters: Garland, Willmott & Heckbert 2001; radiosity over them: Willmott, Heckbert & Garland 1999).
All pairs that are the best of both of their pieces are joined at once, so a million triangles take some twenty rounds
of array operations.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .geometry import along_curve, normalized, triangle_areas
from .sampling import Singles, hashed
from .scene import Floats, Ints
from .surfaces import Surfaces

LEVELS = (0.5, 1.0, 2.0, 4.0)
"""Diagonals of clusters, level by level, in minimum sizes n. A square of the diagonal n is half of a right isosceles
triangle of the size 2n, from which on patches are split: the first two levels are not opened."""

LEAST_FLATNESS = (0.75, 0.93, 0.93, 0.93)
"""Length of the mean normal of a cluster, at least, by level: that of caps of 60 and 31 degrees about their middle.
What is more bent takes more and smaller clusters."""

LEAST_COSINE = 0.5
"""Between the mean normals of two pieces that are joined: 60 degrees. Neither the two sides of a sheet nor the two
sides of a right-angled edge come together."""

LARGEST_SPREAD = 0.1
"""Of the reflectance within a cluster, in each channel."""

LEAST_AREA = 1e-12
"""Of a triangle that is joined, as a share of that of all: areas of clusters are differences of sums over all, in which
single ones are known to 1e-16 of the whole or a little worse. The smaller ones stay as they are."""

BENT = 4.0
"""How much a bent pair is put off: one as bent as the finest level allows counts as flat and of twice the area."""

MATCHINGS = 3
"""Times that pairs are matched before costs are computed anew; each finds about a third of what is left."""


@dataclass(frozen=True, eq=False)
class Clusters:
    """Nested groups of triangles.

    Attributes
    ----------
    members : (m,) int
        Triangles, those of a cluster one after the other, along a curve that fills it: equal steps of their area are
        spread over the cluster.
    first, count : (c,) int
        Where each cluster's members begin, and how many there are: two or more.
    parent : (c,) int
        The cluster that contains this one, -1 for the coarsest.
    area_before : (m + 1,) float, scene units squared
        Area of all members before each.
    """

    members: Ints
    first: Ints
    count: Ints
    parent: Ints
    area_before: Floats

    def __len__(self) -> int:
        return len(self.first)

    @staticmethod
    def none() -> Clusters:
        """No cluster at all."""
        nothing = np.zeros(0, dtype=np.int64)
        return Clusters(nothing, nothing, nothing, nothing, np.zeros(1))

    def parts(self) -> Ints:
        """How many clusters and single members take the place of each cluster when it is opened, (c,)."""
        inner = np.flatnonzero(self.parent >= 0)
        # Each cluster in it takes the place of its members.
        saved = np.bincount(self.parent[inner], weights=self.count[inner] - 1, minlength=len(self))
        return self.count - saved.astype(np.int64)

    def areas(self) -> Floats:
        """Area of each cluster, (c,), scene units squared."""
        areas: Floats = self.area_before[self.first + self.count] - self.area_before[self.first]
        return areas

    def sums(self, values: Floats) -> Floats:
        """Sums over clusters, (c, k), of values (m, k) of their members."""
        before = np.concatenate([np.zeros((1, values.shape[1])), np.cumsum(values, axis=0)])
        total: Floats = before[self.first + self.count] - before[self.first]
        return total

    def means(self, values: Floats) -> Floats:
        """Means over clusters by area, (c, k), of values (m, k) of their members."""
        return self.sums(values * np.diff(self.area_before)[:, None]) / self.areas()[:, None]

    def members_of(self, clusters: Ints) -> Ints:
        """Members of clusters, one cluster after the other."""
        members: Ints = self.members[self._places_of(clusters)]
        return members

    def typical(self, normals: Floats) -> Ints:
        """Place in `members` of one of each cluster (c,), that whose normal (m, 3) is closest to the mean of all."""
        every = np.arange(len(self))
        place = self._places_of(every)
        if len(place) == 0:
            return place
        mean = normalized(self.means(normals))
        along = np.einsum("px,px->p", normals[place], np.repeat(mean, self.count, axis=0))
        begin = np.cumsum(self.count) - self.count
        highest = np.flatnonzero(along == np.repeat(np.maximum.reduceat(along, begin), self.count))
        cluster = np.repeat(every, self.count)[highest]
        typical: Ints = place[highest[np.flatnonzero(np.diff(cluster, prepend=-1))]]
        return typical

    def _places_of(self, clusters: Ints) -> Ints:
        """Places in `members`, one cluster after the other."""
        count = self.count[clusters]
        begin = np.cumsum(count) - count
        places: Ints = np.arange(int(count.sum())) + np.repeat(self.first[clusters] - begin, count)
        return places

    def drawn(self, clusters: Ints, share: Floats) -> tuple[Ints, Floats]:
        """Members of clusters (m,) at shares (m, r), 0 to 1, of their area laid end to end.

        Returns
        -------
        members : (m, r) int
        remainder : (m, r) float
            The share of the member that lies before the point: uniform when `share` is.
        """
        begin, end = self.first[clusters][:, None], (self.first + self.count)[clusters][:, None]
        low, high = self.area_before[begin], self.area_before[end]
        area = low + share * (high - low)
        place = np.clip(np.searchsorted(self.area_before, area, side="right") - 1, begin, end - 1)
        before = self.area_before[place]
        remainder = (area - before) / (self.area_before[place + 1] - before)
        return self.members[place], np.clip(remainder, 0.0, 1.0)


def cluster_triangles(surfaces: Surfaces, triangle: Ints, corners: Floats, places: Ints, smallest: float) -> Clusters:
    """Join triangles that are small beside the minimum size into nested clusters.

    Parameters
    ----------
    triangle : (m,) int
        The surfaces' triangle that each of the m triangles to be joined is, or is a piece of.
    corners : (m, 3, 3) float, scene units
    places : (m, 3) int
        Numbers of the corners, equal where they lie at the same place of the same mesh.
    smallest : float, scene units
        The minimum size n.

    Returns
    -------
    Clusters whose members are numbers 0 to m - 1.
    """
    if len(triangle) == 0:
        return Clusters.none()
    neighbours = _neighbours(places, surfaces.emission[triangle])
    areas = triangle_areas(corners)
    neighbours = neighbours[(areas[neighbours] > LEAST_AREA * areas.sum()).all(axis=1)]
    pieces = _Pieces.of(corners, surfaces.normals[triangle], surfaces.reflectance[triangle])
    levels = []
    for size, flatness in zip(LEVELS, LEAST_FLATNESS, strict=True):
        pieces.join(neighbours, size * smallest, flatness)
        levels.append(pieces.label)
    return _nested(corners, levels)


def _neighbours(places: Ints, emission: Floats) -> Ints:
    """Pairs of triangles that share an edge and emit alike, (p, 2)."""
    following = np.roll(places, -1, axis=1)
    key = ((np.minimum(places, following) << 32) | np.maximum(places, following)).ravel()
    order = np.argsort(key, kind="stable")
    same = np.flatnonzero(key[order][1:] == key[order][:-1])
    pairs = np.stack([order[same], order[same + 1]], axis=1) // 3
    alike = np.all(emission[pairs[:, 0]] == emission[pairs[:, 1]], axis=1)
    return pairs[alike]


class _Pieces:
    """Connected pieces of triangles that grow as they are joined; a piece is known by one of its triangles.

    Attributes
    ----------
    label : (t,) int
        The piece of each triangle.
    """

    def __init__(self, label: Ints, bounds: Singles, sums: Singles) -> None:
        self.label = label
        # Bounds of position and reflectance, lower ones negated, (12, t): those of a union are the greater ones.
        self._bounds = bounds
        # Area times normal, and area, (4, t): those of a union are the sums.
        self._sums = sums

    @staticmethod
    def of(corners: Floats, normals: Floats, reflectance: Floats) -> _Pieces:
        """Each triangle a piece."""
        # Of single precision, and so from the middle of all: half of the memory, and sizes to a millionth.
        a, b, c = corners.transpose(1, 0, 2)
        low, high = np.minimum(np.minimum(a, b), c), np.maximum(np.maximum(a, b), c)
        middle = (low.min(axis=0) + high.max(axis=0)) / 2.0
        # Shares of about the whole, whatever the unit: of their squares single precision holds no scene's in mm or km.
        areas = triangle_areas(corners)
        areas = np.ldexp(areas, -np.frexp(areas.sum())[1])
        bounds = np.concatenate([(middle - low).T, (high - middle).T, -reflectance.T, reflectance.T])
        sums = np.concatenate([normals.T * areas, areas[None]])
        return _Pieces(np.arange(len(corners)), bounds.astype(np.float32), sums.astype(np.float32))

    def join(self, edge_pairs: Ints, size: float, flatness: float) -> None:
        """Join pieces that touch at `edge_pairs` while the unions stay below `size` and above `flatness`."""
        pairs = _distinct(self.label[edge_pairs])
        into = np.arange(len(self.label))
        while len(pairs):
            cost, allowed = self._costs(pairs, size, flatness)
            pairs, cost = pairs[allowed], cost[allowed]
            # Even meshes have many pairs of one cost; by chance, many of them are the best of both.
            cost *= 1.0 + 0.01 * hashed((pairs[:, 0] << 32) | pairs[:, 1], 1, 0)[:, 0]
            a, b = _matched(pairs[np.argsort(cost, kind="stable")], len(self.label)).T
            self._bounds[:, a] = np.maximum(self._bounds[:, a], self._bounds[:, b])
            self._sums[:, a] += self._sums[:, b]
            into[b] = a
            pairs = _distinct(into[pairs])
        while True:
            label = into[self.label]
            if np.array_equal(label, self.label):
                break
            self.label = label

    def _costs(self, pairs: Ints, size: float, flatness: float) -> tuple[Floats, NDArray[np.bool_]]:
        """Cost of joining each pair, (p,), and whether it may be joined."""
        a, b = np.ascontiguousarray(pairs.T)

        def extent(k: int) -> Singles:
            result: Singles = sum(np.maximum(bound[a], bound[b]) for bound in self._bounds[[k, k + 3]])
            return result

        square, spread = np.zeros(len(a), np.float32), np.zeros(len(a), np.float32)
        facing, one, other, both = (np.zeros(len(a), np.float32) for _ in range(4))
        for k in range(3):
            square += extent(k) ** 2
            np.maximum(spread, extent(6 + k), out=spread)
            x, y = self._sums[k][a], self._sums[k][b]
            facing += x * y
            one += x * x
            other += y * y
            both += (x + y) ** 2
        # Two triangles so small that their area vanishes have no common plane, and are left as they are.
        area = self._sums[3][a] + self._sums[3][b]
        flat = np.divide(np.sqrt(both), area, out=np.zeros_like(area), where=area > 0.0)
        allowed = (square < size * size) & (spread <= LARGEST_SPREAD) & (flat >= flatness)
        # Their product is beyond single precision where pieces are very small.
        allowed &= facing >= LEAST_COSINE * np.sqrt(one) * np.sqrt(other)
        return square * (1.0 + BENT * (1.0 - flat.astype(np.float64))), allowed


def _matched(pairs: Ints, count: int) -> Ints:
    """Pairs, best first, of which none of `count` things is in two; those that are the best of both, then once more."""
    found = []
    best = np.empty(count, dtype=np.int64)
    free = np.ones(count, dtype=bool)
    for _ in range(MATCHINGS):
        number = np.arange(len(pairs))
        best[pairs[::-1].ravel()] = np.repeat(number[::-1], 2)
        mutual = (best[pairs[:, 0]] == number) & (best[pairs[:, 1]] == number)
        found.append(pairs[mutual])
        free[pairs[mutual]] = False
        pairs = pairs[free[pairs].all(axis=1)]
    return np.concatenate(found)


def _distinct(pairs: Ints) -> Ints:
    """Pairs of different things, each once, the lower first."""
    low, high = np.minimum(pairs[:, 0], pairs[:, 1]), np.maximum(pairs[:, 0], pairs[:, 1])
    key = ((low << 32) | high)[low != high]
    key.sort()
    key = key[np.diff(key, prepend=-1) != 0]
    return np.stack([key >> 32, key & 0xFFFFFFFF], axis=1)


def _nested(corners: Floats, levels: list[Ints]) -> Clusters:
    """Make a cluster of every piece of two triangles or more; `levels` (each (t,)) from the finest to the coarsest."""
    coarsest = levels[-1]
    joined = np.flatnonzero(np.bincount(coarsest, minlength=len(coarsest))[coarsest] > 1)
    if len(joined) == 0:
        return Clusters.none()
    corners = corners[joined]
    order = np.lexsort([along_curve(corners.mean(axis=1)), *(label[joined] for label in levels)])
    members, areas = joined[order], triangle_areas(corners[order])
    firsts, counts, parents = [], [], []
    made, above, count_above = 0, np.full(len(members), -1), np.zeros(len(members), dtype=np.int64)
    for label in reversed(levels):
        start = np.flatnonzero(np.diff(label[members], prepend=-1))
        count = np.diff(np.append(start, len(members)))
        # A piece that is the same on two levels is one cluster.
        new = (count > 1) & (count != count_above[start])
        firsts.append(start[new])
        counts.append(count[new])
        parents.append(above[start[new]])
        number = np.where(new, made + np.cumsum(new) - 1, np.where(count > 1, above[start], -1))
        made, above, count_above = made + int(new.sum()), np.repeat(number, count), np.repeat(count, count)
    area_before = np.concatenate([[0.0], np.cumsum(areas)])
    first, count, parent = (np.concatenate(x) for x in (firsts, counts, parents))
    return Clusters(members, first, count, parent, area_before)
