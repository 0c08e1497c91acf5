# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Slender triangles cut across into a row of pieces, all at once.

Halved again and again, a sliver becomes three times as many pieces for each time that they are to be half as long: a
cut from a corner to an edge is a new long edge, to be halved in turn. So its own edges alone are halved, and the pieces
reach from one to another.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from .geometry import cross
from .scene import Floats, Ints


@dataclass(frozen=True, eq=False)
class Slices:
    """Pieces of triangles, those of a triangle one after the other along its longest edge.

    Attributes
    ----------
    of : (p,) int
        The triangle that each is a piece of, ascending.
    corners : (p, 3) int
        Their numbers among the vertices on the triangles' edges, as `vertices_on_edges` counts them. Wound as the
        triangle.
    weights : (p, 3, 3) float
        Barycentric coordinates of the corners in the triangle.
    beyond : (p, 3) float
        Its product with the barycentric coordinates of a place is positive where that does not lie in a piece before.
    """

    of: Ints
    corners: Ints
    weights: Floats
    beyond: Floats

    @staticmethod
    def none() -> Slices:
        """No piece at all."""
        nothing = np.zeros((0, 3))
        return Slices(np.zeros(0, dtype=np.int64), np.zeros((0, 3), dtype=np.int64), nothing[:, None, :], nothing)

    @cached_property
    def _last(self) -> Ints:
        """The last piece of the same triangle, (p,): rays ask for it all the time."""
        last: Ints = np.searchsorted(self.of, self.of, side="right") - 1
        return last

    @cached_property
    def _into_piece(self) -> Floats:
        """What makes weights in the triangle those of corners 1 and 2 of each piece, (p, 3, 2)."""
        return np.linalg.inv(self.weights)[:, :, 1:].copy()

    def found(self, first: Ints, weights: NDArray[np.float32]) -> tuple[Ints, NDArray[np.float32]]:
        """The pieces that points lie in.

        Parameters
        ----------
        first : (m,) int
            The first piece of the triangle that each point lies in.
        weights : (m, 2) float
            Barycentric weights of corners 1 and 2 there.

        Returns
        -------
        piece : (m,) int
        weights : (m, 2) float
            The same in the piece.
        """
        inside = np.empty((len(weights), 3))
        inside[:, 1:] = weights
        np.subtract(1.0, inside[:, 1] + inside[:, 2], out=inside[:, 0])
        low, high = first, self._last.take(first)
        while (low < high).any():
            middle = (low + high + 1) >> 1
            beyond = np.einsum("mk,mk->m", self.beyond.take(middle, axis=0), inside) > 0.0
            low, high = np.where(beyond, middle, low), np.where(beyond, high, middle - 1)
        own = np.einsum("mk,mkj->mj", inside, self._into_piece.take(low, axis=0))
        # Single precision knows places in a long triangle to a larger share of a short piece.
        np.maximum(own, 0.0, out=own)
        own /= np.maximum(own[:, 0] + own[:, 1], 1.0)[:, None]
        return low, own.astype(weights.dtype)


def parts_of_edges(lengths: Floats, longest: Floats) -> Ints:
    """How many parts edges (t, 3) have when they are halved until none is longer than `longest` (t,), scene units."""
    halvings: Ints = np.ceil(np.log2(np.maximum(lengths / longest[:, None], 1.0))).astype(np.int64)
    parts: Ints = 2**halvings
    return parts


def vertices_on_edges(parts: Ints) -> Ints:
    """Where the vertices of edges of so many parts (t, 3) begin, (t, 3).

    All those of the first edge of the first triangle, from its start to its end, then those of its second edge, and so
    on.
    """
    count = parts.ravel() + 1
    first: Ints = (np.cumsum(count) - count).reshape(-1, 3)
    return first


def numbered(count: Ints) -> tuple[Ints, Ints]:
    """Of so many things (t,) of each of t: what each is of, and its number there, each as long as all together."""
    of: Ints = np.repeat(np.arange(len(count)), count)
    return of, np.arange(len(of)) - np.repeat(np.cumsum(count) - count, count)


def sliced(lengths: Floats, parts: Ints) -> Slices:
    """Cut triangles whose edges 0-1, 1-2 and 2-0 are so long and have so many parts each, (t, 3).

    The longest edge, of two parts or more, is the base; the others lead round from its start to its end. A piece has a
    part of the base or of the way round as one side, and its third corner on the other. Next is always the part whose
    middle comes first along the base.
    """
    row, base = np.arange(len(parts)), lengths.argmax(axis=1)
    before, behind = (base + 2) % 3, (base + 1) % 3
    along, first_round = parts[row, base], parts[row, before]
    whole_round = first_round + parts[row, behind]

    # The first piece has the first part of either as a side, and the last the last: both count as the base's.
    of_base, part = numbered(along)
    middle = (part + 0.5) / along[of_base]
    middle[part == 0] = -np.inf
    middle[part == along[of_base] - 1] = np.inf
    of_round, part = numbered(whole_round - 2)
    middle = np.append(middle, _along_base(lengths, base, first_round, whole_round, of_round, part + 1))
    of = np.append(of_base, of_round)
    order = np.lexsort([middle, of])
    of, on_base = of[order], order < len(of_base)

    # Parts of either that lie behind when a piece begins.
    past = np.cumsum(on_base) - on_base
    begin = np.searchsorted(of, of)
    past_base = past - past[begin]
    past_round = 1 + np.arange(len(of)) - begin - past_base

    first = vertices_on_edges(parts)

    def on_the_base(place: Ints) -> tuple[Ints, Floats]:
        return _vertices(first, parts, of, base[of], place)

    def on_the_way_round(place: Ints) -> tuple[Ints, Floats]:
        near = place <= first_round[of]
        edge, end = np.where(near, before[of], behind[of]), np.where(near, first_round[of], whole_round[of])
        return _vertices(first, parts, of, edge, end - place)

    low, low_weights = on_the_base(past_base)
    high, high_weights = on_the_way_round(past_round)
    right, right_weights = on_the_base(past_base + on_base)
    left, left_weights = on_the_way_round(past_round + ~on_base)
    return Slices(
        of,
        np.stack([low, np.where(on_base, right, left), high], axis=1),
        np.stack([low_weights, np.where(on_base[:, None], right_weights, left_weights), high_weights], axis=1),
        cross(high_weights, low_weights),
    )


def _along_base(lengths: Floats, base: Ints, first_round: Ints, whole_round: Ints, of: Ints, part: Ints) -> Floats:
    """Share of the base above which the middle of parts of the way round of triangles `of` stands, (n,)."""
    row = np.arange(len(base))
    square, square_before, square_behind = (lengths[row, (base + k) % 3] ** 2 for k in (0, 2, 1))
    # Where the third corner stands, by the law of cosines.
    foot = np.clip((square + square_before - square_behind) / (2.0 * square), 0.0, 1.0)[of]
    near, whole, passed = first_round[of], whole_round[of], part + 0.5
    share: Floats = np.where(
        passed < near, foot * passed / near, foot + (1.0 - foot) * (passed - near) / (whole - near)
    )
    return share


def _vertices(first: Ints, parts: Ints, of: Ints, edge: Ints, place: Ints) -> tuple[Ints, Floats]:
    """Numbers (n,) and barycentric coordinates (n, 3) of the vertices at places on edges of triangles `of`."""
    share = place / parts[of, edge]
    row, weights = np.arange(len(of)), np.zeros((len(of), 3))
    weights[row, edge] = 1.0 - share
    weights[row, (edge + 1) % 3] = share
    return first[of, edge] + place, weights
