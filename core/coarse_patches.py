# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The controlled triangulation: the few and large patches that a bake begins with."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from .clusters import cluster_triangles
from .crossings import Crossings
from .geometry import edge_lengths
from .patches import PatchTree
from .scene import Floats
from .seams import cut_along
from .slices import parts_of_edges
from .surfaces import Surfaces

LARGEST_ASPECT = 4.0
"""Longest edge over lowest altitude above which the coarse triangulation slices a triangle (right isosceles: 2)."""

LONGEST_ROW = 256
"""Parts that the coarse triangulation cuts an edge into at most: a strip may be a million times as long as wide."""

MOST_PIECES, PIECES_OF_EACH = 2**20, 8.0
"""Pieces that the coarse triangulation may make of slender triangles: so many, and these for each triangle there is.
A sliver a mile long may be a billion times as long as the size that was asked for."""

EDGES_CUT = 2.0
"""Edges of a sliver that are about as long as the longest."""


def coarse_patches(surfaces: Surfaces, smallest: float, lines: Crossings | None = None) -> PatchTree:
    """The controlled triangulation: the surfaces' triangles, the slender ones sliced into rows of pieces.

    Before, triangles are cut along the lines on which sheets cross them.

    Pieces are no longer than a few times the width of the triangle they come from, so that a strip becomes a row of
    them. But they are longer than twice `smallest`, so that refinement below still has room, and longer still where a
    row would have more than `LONGEST_ROW` of them, or all together `MOST_PIECES`.
    """
    tree = PatchTree(surfaces)
    if lines is not None and len(lines.triangle):
        crossed = np.zeros(len(surfaces.closed), dtype=bool)
        crossed[surfaces.shell_of_triangle[lines.triangle]] = True
        cut_along(tree, lines, crossed[surfaces.shell_of_triangle])
    nodes = tree.leaves()
    corners = tree.corners[nodes]
    lengths = edge_lengths(tree.points, corners)
    longest = lengths.max(axis=1, initial=0.0)
    limit = _longest_pieces(tree.areas(nodes), longest, smallest)
    most = MOST_PIECES + PIECES_OF_EACH * len(nodes)
    if (EDGES_CUT * np.maximum(longest / limit, 1.0)).sum() > most:
        limit = np.maximum(limit, EDGES_CUT * longest.sum() / most)
    # Of what is so thin that two corners are at the same place, pieces would have no area.
    places = tree.place_of_point[corners]
    slender = np.flatnonzero((longest > limit) & (places != np.roll(places, 1, axis=1)).all(axis=1))
    tree.slice(nodes[slender], parts_of_edges(lengths[slender], limit[slender]))
    return tree


def _longest_pieces(areas: Floats, longest: Floats, smallest: float) -> Floats:
    """How long the pieces of each triangle may be, (t,), from its area and its longest edge."""
    width = 2.0 * areas / np.maximum(longest, np.finfo(np.float64).tiny)
    return np.maximum(np.maximum(LARGEST_ASPECT * width, 4.0 * smallest), longest / LONGEST_ROW)


def coarse_count(surfaces: Surfaces, smallest: float) -> float:
    """About how many coarse patches there are: pieces of slender triangles, and triangles that clusters leave out."""
    longest = edge_lengths(surfaces.points, surfaces.triangles).max(axis=1)
    pieces = longest / _longest_pieces(surfaces.areas, longest, smallest)
    return float(pieces[pieces > 1.0].sum()) + float((surfaces.areas[pieces <= 1.0] >= smallest**2).sum())


def clustered_patches(surfaces: Surfaces, smallest: float, lines: Crossings | None = None) -> PatchTree:
    """The controlled triangulation with clusters above the triangles that are too small to be split.

    Parameters
    ----------
    smallest : float, scene units
        The minimum size n. A right isosceles triangle of the size 2n, from which on patches are split, has the area
        n^2.
    lines : Crossings or None
        Along which sheets cross the triangles.
    """
    tree = coarse_patches(surfaces, smallest, lines)
    leaves = tree.leaves()
    small = leaves[tree.areas(leaves) < smallest * smallest]
    corners = tree.corners[small]
    clusters = cluster_triangles(
        surfaces, tree.triangle[small], tree.points[corners], tree.vertices(corners, small), smallest
    )
    tree.add_clusters(replace(clusters, members=small[clusters.members]))
    return tree
