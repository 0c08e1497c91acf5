# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""From a hit to the leaf patch under it, by one look into a table for most rays."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from .patches import PatchTree
from .scene import Ints

MOST_CELLS = 2**22
"""Cells of all tables together."""

DEEPEST_TABLE = 6
"""Splits that a table resolves; deeper leaves are walked to."""


class Locator:
    """Tables that say which leaf lies under a point of a coarse patch.

    A table cuts its coarse patch by so many midpoint splits as its leaves have; the cell of a point follows from its
    weights by rounding, and names the leaf. It is made anew when the tree has changed.
    """

    def __init__(self, tree: PatchTree) -> None:
        self._tree = tree
        deepest = np.zeros(len(tree), dtype=np.int64)
        np.maximum.at(deepest, tree.root, tree.level)
        roots = np.flatnonzero(tree.root == np.arange(len(tree)))
        depth = np.minimum(deepest[roots], DEEPEST_TABLE)
        while (2 * 4**depth).sum() > MOST_CELLS and depth.any():
            depth = np.minimum(depth, depth.max() - 1)
        self._depth = np.zeros(len(tree), dtype=np.int32)
        self._depth[roots] = depth
        cells = 2 * 4**depth
        self._first = np.zeros(len(tree), dtype=np.int32)
        self._first[roots] = np.cumsum(cells) - cells
        self._leaf = np.empty(int(cells.sum()), dtype=np.int32)
        for level in np.unique(depth):
            self._fill(roots[depth == level], int(level))
        self._leaf = np.where(self._leaf < 0, -1, tree.patch[self._leaf]).astype(np.int32)
        self._scale = (2.0**self._depth).astype(np.float32)

    def _fill(self, roots: Ints, level: int) -> None:
        side = 2**level
        cell = np.arange(2 * side * side)
        upper, j, i = cell & 1, (cell >> 1) & (side - 1), cell >> (1 + level)
        third = np.where(upper == 1, 2.0 / 3.0, 1.0 / 3.0)
        centre = np.stack([(i + third) / side, (j + third) / side], axis=1).astype(np.float32)
        node = np.repeat(roots, len(cell))
        leaf, _ = self._tree.descend(node, np.tile(centre, (len(roots), 1)))
        deeper = self._tree.level[leaf] > level
        self._leaf[self._first[node] + np.tile(cell, len(roots))] = np.where(deeper, -1, leaf)

    def coarse(self, triangle: NDArray[np.int32], weights: NDArray[np.float32]) -> NDArray[np.int32]:
        """The coarse patch of each hit (n,); `weights` (n, 2) of the triangle become those in the patch, in place."""
        tree = self._tree
        root = triangle.copy()
        moving = np.flatnonzero(tree.root.take(triangle) < 0)
        if len(moving):
            node, inside = tree.descend_to_coarse(triangle[moving].astype(np.int64), weights[moving])
            root[moving], weights[moving] = node, inside
        return root

    def leaves(self, root: NDArray[np.int32], weights: NDArray[np.float32]) -> NDArray[np.int32]:
        """The leaf under each point of coarse patches, or the cluster it is in, (n,)."""
        depth, scale = self._depth[root], self._scale[root]
        u, v = weights[:, 0] * scale, weights[:, 1] * scale
        last = scale.astype(np.int32) - 1
        i = np.clip(u.astype(np.int32), 0, last)
        j = np.clip(v.astype(np.int32), 0, last)
        upper = (u - i) + (v - j) > 1.0
        leaf: NDArray[np.int32] = self._leaf[self._first[root] + (((i << depth) + j) << 1) + upper]
        deeper = np.flatnonzero(leaf < 0)
        if len(deeper):
            leaf[deeper], _ = self._tree.descend(root[deeper].astype(np.int64), weights[deeper])
        return leaf
