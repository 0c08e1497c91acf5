# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Seams: edges of the coarse patches along which sheets pass through a surface, or stand on it.

Light does not cross them. Faces on their two sides share points, but no light at them.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from .crossings import Crossings
from .geometry import connected_components
from .scene import Floats, Ints

if TYPE_CHECKING:
    from .patches import PatchTree

SNAP = 1e-4
"""Share of a triangle's size within which a line goes through its corners: what would be cut off is no wider."""

LEAST_END = 1e-2
"""Share of an edge within which a line that runs along it ends at its end."""

MOST_PIECES = 2**15
"""Pieces that are made of triangles at most."""

ON_EDGE = 1e-6
"""Barycentric coordinate below which a point lies on an edge; points within have more, by splits at midpoints."""


@dataclass(frozen=True, eq=False)
class Seams:
    """The sides of seams that pieces of the surface lie on.

    Around a point on seams the pieces are in as many *sides* as the seams leave, numbered from 0; elsewhere on one.

    Attributes
    ----------
    of_edge : (pieces, 3) int8
        The side of the edges 0-1, 1-2, 2-0 of each piece that it lies on; 0 where an edge is no seam.
    of_corner : (pieces, 3) int8
        The side at its corners.
    sides : int
        Most sides that there are anywhere.
    """

    of_edge: NDArray[np.int8]
    of_corner: NDArray[np.int8]
    sides: int

    @staticmethod
    def none() -> Seams:
        """No seam at all."""
        nothing = np.zeros((0, 3), dtype=np.int8)
        return Seams(nothing, nothing, 1)

    @staticmethod
    def between(places: Ints, pieces: Ints, is_seam: NDArray[np.bool_], count: int) -> Seams:
        """Find the sides of pieces.

        Parameters
        ----------
        places : (p, 3) int
            Of their corners.
        pieces : (p,) int
            Their numbers among all pieces.
        is_seam : (p, 3) bool
            Edges that are seams.
        count : int
            Of all pieces.
        """
        edge = _edges(places)
        on_seam = np.zeros(int(edge.max(initial=-1)) + 1, dtype=bool)
        on_seam[edge[is_seam]] = True
        at_seam = np.unique(np.concatenate([places[on_seam[edge]], np.roll(places, -1, axis=1)[on_seam[edge]]]))
        # Pieces around a point are on one side where they share an edge to it that is no seam.
        corner = np.flatnonzero(np.isin(places, at_seam))
        place = places.ravel()[corner]
        beside = np.concatenate([edge.ravel()[corner], np.roll(edge, 1, axis=1).ravel()[corner]])
        free = np.flatnonzero(~on_seam[beside])
        _, link = np.unique((np.tile(place, 2)[free] << 32) | beside[free], return_inverse=True)
        links = np.column_stack([free % max(len(corner), 1), len(corner) + link])
        side = connected_components(links, len(corner) + int(link.max(initial=-1)) + 1)[: len(corner)]
        of_corner, of_edge = np.zeros((count, 3), dtype=np.int8), np.zeros((count, 3), dtype=np.int8)
        of_corner[pieces[corner // 3], corner % 3] = _ranks(place, side)
        at = np.flatnonzero(on_seam[edge])
        of_edge[pieces[at // 3], at % 3] = _ranks(edge.ravel()[at], at)
        return Seams(of_edge, of_corner, 1 + int(max(of_corner.max(initial=0), of_edge.max(initial=0))))

    def sides_at(self, piece: Ints, weights: Floats) -> Ints:
        """The sides that corners of faces are on, (f, 3), 0 where no seam is.

        Parameters
        ----------
        piece : (f,) int
            That each face lies in.
        weights : (f, 3, 3) float
            Barycentric coordinates of the corners in it.
        """
        side = np.zeros(weights.shape[:2], dtype=np.int64)
        for edge in range(3):
            on_edge = weights[:, :, (edge + 2) % 3] < ON_EDGE
            side = np.where(on_edge, np.maximum(side, self.of_edge[piece, edge, None]), side)
        for corner in range(3):
            side = np.where(weights[:, :, corner] > 1.0 - ON_EDGE, self.of_corner[piece, corner, None], side)
        return side


def _edges(places: Ints) -> Ints:
    """Numbers of the edges 0-1, 1-2, 2-0 of pieces, equal for the same edge, (p, 3)."""
    following = np.roll(places, -1, axis=1)
    keys = (np.minimum(places, following) << 32) | np.maximum(places, following)
    _, edges = np.unique(keys, return_inverse=True)
    result: Ints = edges.reshape(-1, 3)
    return result


def _ranks(group: Ints, member: Ints) -> Ints:
    """Which of the members of its group each is, in ascending order, from 0; equal ones have the same number, (n,)."""
    pairs, number = np.unique(np.column_stack([group, member]), axis=0, return_inverse=True)
    first = np.searchsorted(pairs[:, 0], pairs[:, 0])
    ranks: Ints = (np.arange(len(pairs)) - first)[number.ravel()]
    return ranks


def cut_along(tree: PatchTree, lines: Crossings, around: NDArray[np.bool_]) -> None:
    """Cut the triangles of a tree along lines, and where these end, and tell it the seams that this makes.

    What lies beside them is cut where they are, so that all triangles still fit together.

    Parameters
    ----------
    around : (triangles,) bool
        Those that may lie beside triangles with lines.
    """
    line, leaf = np.arange(len(lines.triangle)), lines.triangle
    most = len(tree) + MOST_PIECES
    while len(line) and len(tree) < most:
        found = _on_leaves(tree, lines, line, leaf)
        line, leaf = line[found.meets], leaf[found.meets]
        edge, share, length = found.cut[found.meets], found.share[found.meets], found.length[found.meets]
        # Of the lines in a leaf the longest goes first.
        wanted = np.flatnonzero(edge >= 0)
        wanted = wanted[np.lexsort([-length[wanted], leaf[wanted]])]
        wanted = wanted[np.flatnonzero(np.diff(leaf[wanted], prepend=-1))]
        if len(wanted) == 0:
            break
        tree.bisect(leaf[wanted], edge[wanted], share[wanted])
        line, leaf = _in_children(tree, line, leaf)
    while True:
        leaves = tree.leaves()
        leaves = leaves[around[tree.triangle[leaves]]]
        corners = tree.corners[leaves]
        points = tree.midpoints(corners, np.roll(corners, -1, axis=1))
        beside = np.flatnonzero((points >= 0).any(axis=1))
        if len(beside) == 0:
            break
        edge = np.argmax(points[beside] >= 0, axis=1)
        tree.bisect(leaves[beside], edge, np.full(len(beside), 0.5))
    line, leaf = _in_children(tree, line, leaf)
    is_seam = np.zeros((len(tree), 3), dtype=bool)
    np.logical_or.at(is_seam, leaf, _on_leaves(tree, lines, line, leaf).seam)
    tree.seams = Seams.between(tree.place_of_point[corners], leaves, is_seam[leaves], len(tree))


def _in_children(tree: PatchTree, line: Ints, leaf: Ints) -> tuple[Ints, Ints]:
    """Lines and the leaves they may lie in, for leaves that may have been cut since."""
    while True:
        cut = tree.first_child[leaf] >= 0
        if not cut.any():
            return line, leaf
        child = tree.first_child[leaf[cut]]
        line = np.concatenate([line[~cut], line[cut], line[cut]])
        leaf = np.concatenate([leaf[~cut], child, child + 1])


@dataclass(frozen=True, eq=False)
class _OnLeaves:
    """How lines lie on leaves, pair by pair.

    Attributes
    ----------
    meets : (p,) bool
        Whether the line passes through the leaf, or along an edge of it.
    length : (p,) float, scene units
        For how far.
    cut : (p,) int
        The edge to be cut next, -1 where none is.
    share : (p,) float
        Where, from its first corner.
    seam : (p, 3) bool
        Edges that the line runs along.
    """

    meets: NDArray[np.bool_]
    length: Floats
    cut: Ints
    share: Floats
    seam: NDArray[np.bool_]


def _on_leaves(tree: PatchTree, lines: Crossings, line: Ints, leaf: Ints) -> _OnLeaves:
    of = lines.taken(line)
    corners = tree.points[tree.corners[leaf]] - tree.points[tree.corners[of.triangle, 0]][:, None]
    slack = SNAP * tree.sizes(leaf)
    beside = np.einsum("px,pkx->pk", of.across, corners) - of.offset[:, None]
    beside[np.abs(beside) <= slack[:, None]] = 0.0
    start = np.einsum("px,pkx->pk", of.along, corners)
    end, other = np.roll(start, -1, axis=1), np.roll(beside, -1, axis=1)
    passes = beside * other < 0.0
    share = beside / np.where(passes, beside - other, 1.0)
    at = np.concatenate(
        [np.where(beside == 0.0, start, np.nan), np.where(passes, start + share * (end - start), np.nan)], axis=1
    )
    low, high = np.fmax(np.fmin.reduce(at, axis=1), of.low), np.fmin(np.fmax.reduce(at, axis=1), of.high)
    length = np.nan_to_num(high - low)
    meets = ((beside == 0.0) | passes).any(axis=1) & (length > slack)
    # A line that runs along an edge and ends there cuts it there.
    on_edge = (beside == 0.0) & (other == 0.0)
    for bound in (of.low, of.high):
        ends = (bound[:, None] - start) / np.where(on_edge & (end != start), end - start, 1.0)
        inside = on_edge & (ends > LEAST_END) & (ends < 1.0 - LEAST_END)
        share, passes = np.where(inside, ends, share), passes | inside
    middle = (start + end) / 2.0
    seam = on_edge & (middle > of.low[:, None] - slack[:, None]) & (middle < of.high[:, None] + slack[:, None])
    cut = np.where(passes.any(axis=1), passes.argmax(axis=1), -1)
    row = np.arange(len(line))
    return _OnLeaves(meets, length, cut, share[row, cut], seam)
