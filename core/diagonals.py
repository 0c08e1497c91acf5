# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Which diagonal two faces meet along: the one around which light bends less.

Faces come from halving, so that their diagonals lie as the input's do, however the light runs. Across them the border
of a shadow is a saw; with the diagonals along it, the same vertices draw it straight (data dependent triangulation;
Dyn, Levin & Rippa 1990).
"""

from __future__ import annotations

from dataclasses import dataclass, fields

import numpy as np
from numpy.typing import NDArray

from .error_estimate import gradients, lit_area
from .geometry import cross, lengths, normalized
from .lit import Lit
from .scene import Floats, Ints
from .surfaces import Surfaces

LEAST_GAIN = 0.1
"""Share by which light must bend less in all, around the two faces: less is the noise of the gather."""

LEAST_PART = 0.2
"""Share of the area of two faces that each must have when their diagonal is turned: no slivers."""

STEPS_OF_GAIN = 16.0
"""Gains are told apart by so many steps in which they double."""

MOST_ROUNDS = 32
"""Rounds of turning; in each, no two pairs of faces touch."""

TRIANGLES_AT_ONCE = 2**13
"""Whose working arrays stay in a core's second cache."""

LEAST_BEND = 4.0
"""Times the tolerance, relative to the mean: a diagonal across which light bends less is left as it is. What is
missed between its ends is about an eighth of the bend."""


def turned_diagonals(surfaces: Surfaces, shown: Lit, tolerance: float) -> Ints:
    """Corners of faces when diagonals are turned, as numbers of the corners there were, (faces, 3).

    Only faces of one input triangle are turned, of which nothing hides a corner.

    Parameters
    ----------
    tolerance : float
        Error of interpolation that may be left, relative to the mean.
    """
    light, mean = _light_of_faces(surfaces, shown)
    of_corner = shown.places.of_corner[: len(light)]
    aside = (shown.gathered.hidden | shown.gathered.touching)[of_corner].any(axis=1)
    # What stays as it is is of a group of its own.
    group = np.where(aside, -1 - np.arange(len(light)), shown.faces.triangle)
    return turned(shown.faces.points[shown.faces.corners], light, of_corner, group, LEAST_BEND * tolerance * mean)


def _light_of_faces(surfaces: Surfaces, shown: Lit) -> tuple[Floats, float]:
    """Light at the corners of faces, (faces, 3, c), where any has a back with that of both sides; and the mean."""
    count = len(shown.faces.triangle)
    values, weight = shown.corner_irradiance(), shown.weights(surfaces)
    _, mean = lit_area(weight, weight * values.mean(axis=(1, 2)))
    if len(values) == count:
        return values, mean
    light = np.zeros((count, 3, 6))
    light[:, :, :3] = values[:count]
    light[shown.face[count:], :, 3:] = values[count:]
    return light, mean


def turned(corners: Floats, values: Floats, of_corner: Ints, group: Ints, least: float) -> Ints:
    """Corners of triangles when diagonals are turned, as numbers of the corners there were, (n, 3).

    Parameters
    ----------
    corners : (n, 3, 3) float, scene units
    values : (n, 3, c) float
        Light at the corners, in c channels.
    of_corner : (n, 3) int
        Numbers that corners have in common where triangles meet.
    group : (n,) int
        Only triangles of one group, which lie in one plane, are turned.
    least : float
        Bend across a diagonal, in the unit of `values`, that is worth it.
    """
    return _Net(corners, values, of_corner, group).turned(least)


class _Net:
    """Triangles with light at their corners, and which of them meet.

    An edge is numbered 3 f + k: of triangle f, from its corner k to the next. Across an edge light bends by how much
    faster it grows on the one side than on the other, times the edge's length: summed over all edges that is the
    variation of its gradient.
    """

    def __init__(self, corners: Floats, values: Floats, of_corner: Ints, group: Ints) -> None:
        self._at, self._light = corners.reshape(-1, 3), values.reshape(3 * len(values), -1)
        self._group, self._twin = group, _twins(of_corner)
        self._corner = np.arange(3 * len(group)).reshape(-1, 3)
        self._slope, self._length = np.empty_like(self._light), np.empty(len(self._at))
        for first in range(0, len(group), TRIANGLES_AT_ONCE):
            slope, length = self._slopes(self._corner[first : first + TRIANGLES_AT_ONCE])
            edges = slice(3 * first, 3 * first + length.size)
            self._slope[edges], self._length[edges] = slope.reshape(length.size, -1), length.ravel()

    def turned(self, least: float) -> Ints:
        """Turn diagonals until light bends no less; returns the triangles' corners, (n, 3)."""
        asked = self._worth_it(np.arange(len(self._twin)), least)
        for _ in range(MOST_ROUNDS):
            turns = self._turns(asked)
            best = np.full(len(self._corner), -1)
            np.maximum.at(best, turns.around, turns.rank[:, None])
            chosen = (best[turns.around] == turns.rank[:, None]).all(axis=1)
            if not chosen.any():
                break
            now = turns.taken(chosen)
            self._turn(now)
            # What was not chosen waits. Around what was, all is to be asked again, and numbers stand for other edges.
            near = 3 * np.unique(now.around)[:, None] + np.arange(3)
            asked = self._worth_it(np.concatenate([turns.edge[~chosen], near.ravel()]), least)
        return self._corner

    def _worth_it(self, edge: Ints, least: float) -> Ints:
        """Those of some edges that may be turned, each by one of its two numbers."""
        edge = np.unique(np.maximum(edge, self._twin[edge]))
        edge = edge[self._twin[edge] >= 0]
        edge = edge[self._group[edge // 3] == self._group[self._twin[edge] // 3]]
        return edge[self._bends(edge, self._slope[edge]) > least]

    def _slopes(self, corner: Ints) -> tuple[Floats, Floats]:
        """How fast light grows outward at the edges of triangles (n, 3), (n, 3, c), and their lengths, (n, 3)."""
        at, light = self._at[corner], self._light[corner]
        along = np.roll(at, -1, axis=1) - at
        length = lengths(along)
        normal = normalized(cross(along[:, 0], along[:, 1]))
        outward = normalized(np.cross(along, normal[:, None]))
        return np.einsum("nex,ncx->nec", outward, gradients(at, light)), length

    def _bends(self, edge: Ints, slope: Floats) -> Floats:
        """Bend of light across edges (m,), with slopes (m, c) on their own side; none where nothing is beyond."""
        twin = self._twin[edge]
        return np.where(twin < 0, 0.0, lengths(slope + self._slope[twin]) * self._length[edge])

    def _around(self, edge: Ints) -> Ints:
        """Edges a-b, b-d, d-c and c-a around the two triangles that meet at edges b-c, (m, 4)."""
        twin = self._twin[edge]
        return np.stack([_before(edge), _after(twin), _before(twin), _after(edge)], axis=1)

    def _turns(self, edge: Ints) -> _Turns:
        """Those of some edges whose turning is worth it."""
        starts = range(0, max(len(edge), 1), TRIANGLES_AT_ONCE)
        better = zip(*(self._better(edge[k : k + TRIANGLES_AT_ONCE]) for k in starts), strict=True)
        gain, edge, outer, made, slope, length = (np.concatenate(parts) for parts in better)
        beyond = self._twin[outer] // 3
        around = np.concatenate([edge[:, None] // 3, self._twin[edge][:, None] // 3, beyond], axis=1)
        around = np.where(around < 0, around[:, :1], around)
        # Of nearly equal gains the first: where a scene is symmetrical, rounding must not decide.
        rank = np.empty(len(edge), dtype=np.int64)
        rank[np.lexsort([-edge, np.rint(STEPS_OF_GAIN * np.log2(gain))])] = np.arange(len(edge))
        return _Turns(edge, outer, around, rank, made, slope, length)

    def _better(self, edge: Ints) -> tuple[Floats, Ints, Ints, Ints, Floats, Floats]:
        """Of those edges across which light then bends less, by how much, and as `_Turns` has them: the edges, those
        around, and the triangles made, with slopes and lengths."""
        outer = self._around(edge)
        a, b, d, c = self._corner.ravel()[outer].T
        made = np.stack([a, b, d, a, d, c], axis=1).reshape(-1, 2, 3)
        sound = self._sound(made)
        edge, outer, made = edge[sound], outer[sound], made[sound]
        slope, length = self._slopes(made.reshape(-1, 3))
        slope, length = slope.reshape(len(edge), 6, slope.shape[2]), length.reshape(-1, 6)
        before = self._bends(edge, self._slope[edge])
        after = lengths(slope[:, 2] + slope[:, 3]) * length[:, 2]
        for k, of_made in enumerate((0, 1, 4, 5)):
            before += self._bends(outer[:, k], self._slope[outer[:, k]])
            after += self._bends(outer[:, k], slope[:, of_made])
        better = np.flatnonzero(after < (1.0 - LEAST_GAIN) * before)
        gain = (before - after)[better]
        return gain, edge[better], outer[better], made[better], slope[better], length[better]

    def _sound(self, made: Ints) -> NDArray[np.bool_]:
        """Whether pairs of triangles (m, 2, 3) are wound alike, and none is too small for the other, (m,)."""
        at = self._at[made.reshape(-1, 3)]
        normal = cross(at[:, 1] - at[:, 0], at[:, 2] - at[:, 0]).reshape(-1, 2, 3)
        whole = normal.sum(axis=1)
        share = np.einsum("mkx,mx->mk", normal, whole)
        sound: NDArray[np.bool_] = share.min(axis=1) > LEAST_PART * np.einsum("mx,mx->m", whole, whole)
        return sound

    def _turn(self, turns: _Turns) -> None:
        first, second = turns.edge // 3, self._twin[turns.edge] // 3
        beyond = self._twin[turns.outer]
        own = 3 * np.stack([first, first, first, second, second, second], axis=1) + np.array([0, 1, 2, 0, 1, 2])
        self._corner[first], self._corner[second] = turns.made[:, 0], turns.made[:, 1]
        self._slope[own], self._length[own] = turns.slope, turns.length
        outer = own[:, [0, 1, 4, 5]]
        self._twin[outer] = beyond
        self._twin[beyond[beyond >= 0]] = outer[beyond >= 0]
        self._twin[own[:, 2]], self._twin[own[:, 3]] = own[:, 3], own[:, 2]


@dataclass(frozen=True, eq=False)
class _Turns:
    """Diagonals b-c that may be turned to a-d.

    Attributes
    ----------
    edge : (m,) int
    outer : (m, 4) int
        The edges a-b, b-d, d-c and c-a.
    around : (m, 6) int
        The two triangles and those beside them, which another turn must leave alone.
    rank : (m,) int
        Ascending with what is gained.
    made : (m, 2, 3) int
        Corners of the triangles a-b-d and a-d-c.
    slope : (m, 6, c) float
        At the edges of these.
    length : (m, 6) float
    """

    edge: Ints
    outer: Ints
    around: Ints
    rank: Ints
    made: Ints
    slope: Floats
    length: Floats

    def taken(self, which: NDArray[np.bool_]) -> _Turns:
        return _Turns(*(getattr(self, field.name)[which] for field in fields(self)))


def _before(edge: Ints) -> Ints:
    """The edge before each in its triangle."""
    return np.where(edge % 3 == 0, edge + 2, edge - 1)


def _after(edge: Ints) -> Ints:
    """The edge after each in its triangle."""
    return np.where(edge % 3 == 2, edge - 2, edge + 1)


def _twins(of_corner: Ints) -> Ints:
    """The same edge of the triangle beside, for each edge of triangles (n, 3); -1 where not just one is there."""
    start, end = of_corner.ravel(), np.roll(of_corner, -1, axis=1).ravel()
    key = (np.minimum(start, end) << 32) | np.maximum(start, end)
    order = np.argsort(key, kind="stable")
    _, first, count = np.unique(key[order], return_index=True, return_counts=True)
    pair = first[count == 2]
    one, two = order[pair], order[pair + 1]
    # Of two that run the same way, one lies upside down.
    fits = start[one] == end[two]
    twin = np.full(len(start), -1, dtype=np.int64)
    twin[one[fits]], twin[two[fits]] = two[fits], one[fits]
    return twin
