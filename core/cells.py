# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""What gather rays look up: the coarse patches cut evenly into small cells, found from a hit by rounding.

A *place* is one side of a cell: twice the cell's number, plus 1 for the back. Where an element is covered in part, rays
from close by see other places: the twin of the element if they come from closer than any vertex can tell, and else a
second copy of the cell's side, which shows the twin's light only until vertices show their own. All these are numbered
on from there, and what is no place of the scene counts from the end, so one table holds whatever a ray can see.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .location import Locator
from .patches import PatchTree
from .rows import ESCAPED, Cover
from .sampling import Singles
from .scene import Floats, Ints
from .textures import cell_centres, cell_corners
from .visibility import Hits

MOST_CELLS = 2**20
"""Cells of all patches together: 32 MB for what is seen on their two sides. The default memory limit holds them."""

MOST_CELLS_ALONG_EDGE = 512
"""Of a coarse patch; of a wider one, such as a ground that reaches far beyond all else, the leaves are cut instead."""

MOST_CELLS_ALONG_LEAF = 64

INSIDE = np.float32(1.0 - 1e-6)
"""Keeps weights that are rounded up, or that add up to a little more than 1, in the last cell."""

BELOW = -3
"""Stands for what a ray meets that would leave below its surface; -2 for nothing, and `ESCAPED` is -1."""

SPECIAL = 3


class Cells:
    """The cells of all coarse patches, for a tree that is not split any more.

    A patch with s cells along each edge has s * s of them: row i of the first weight holds s - i that stand like the
    patch and between them s - i - 1 upside down.

    Parameters
    ----------
    tree : PatchTree
    locator : Locator
        Of the tree.
    unlit_side : (2 * triangles,) bool
        Sides that no light reaches: rays that meet them started inside a solid.
    size : float, scene units
        Cells are not longer than that, unless there would be too many.
    cover : Cover
    shortest_reach : float, the ray library's units
        Rays shorter than that, and than a covered element's own reach, see its twin as a whole.

    Attributes
    ----------
    node : (cells,) int
        The coarse patch of each cell, or the leaf of a wide one.
    centre : (cells, 2) float32
        Barycentric weights of corners 1 and 2 in it.
    triangle : (cells,) int
        The surfaces' triangle of each.
    areas : (cells,) float
    element : (2 * cells + twins + copies,) int
        The element, or twin, that each place lies on.
    unlit : (2 * cells + twins + copies,) bool
    reach : (2 * cells,) float32, the ray library's units
        Rays shorter than that see another place than the one that they met.
    copied : (copies,) int
        The place that each copy is one of; copies are the last places.
    are_fewer : bool
        Whether `most` made them larger.
    """

    def __init__(
        self,
        tree: PatchTree,
        locator: Locator,
        unlit_side: NDArray[np.bool_],
        size: float,
        cover: Cover,
        shortest_reach: float,
        most: int = MOST_CELLS,
    ) -> None:
        self._locator = locator
        roots = np.flatnonzero(tree.root == np.arange(len(tree)))
        wide = roots[tree.sizes(roots) > MOST_CELLS_ALONG_EDGE * size]
        self._tree = tree
        self._is_wide = np.zeros(len(tree) + 1, dtype=bool)
        self._is_wide[wide] = True
        most_along = np.full(len(tree), MOST_CELLS_ALONG_EDGE)
        if len(wide):
            leaves = tree.leaves()
            leaves = leaves[self._is_wide[tree.root[leaves]]]
            most_along[leaves] = MOST_CELLS_ALONG_LEAF
            roots = np.union1d(roots[~self._is_wide[roots]], leaves)
        along = np.clip(np.ceil(tree.sizes(roots) / size), 1, most_along[roots]).astype(np.int64)
        self.are_fewer = bool(most < (along**2).sum() and most < MOST_CELLS)
        while (along**2).sum() > min(most, MOST_CELLS) and along.max() > 1:
            along = np.minimum(along, max(1, int(0.8 * along.max())))
        cells = along**2
        self._first = np.zeros(len(tree) + 1, dtype=np.int32)
        self._first[roots] = np.cumsum(cells) - cells
        self._along = np.ones(len(tree) + 1, dtype=np.int32)
        self._along[roots] = along
        self._any_halved = bool((tree.root < 0).any())
        self.node = np.repeat(roots, cells)
        self.centre = np.empty((len(self.node), 2), dtype=np.float32)
        for side in np.unique(along):
            chosen = roots[along == side]
            index = self._first[chosen][:, None] + np.arange(side**2)
            self.centre[index] = cell_centres(int(side))
        self.triangle = tree.triangle[self.node]
        self._corners_of_node = tree.weights
        a, b, c = (tree.points[tree.corners[roots, k]] for k in range(3))
        area = np.linalg.norm(np.cross(b - a, c - a), axis=1) / 2.0
        self.areas: Floats = np.repeat(area / cells, cells)
        leaf, _ = tree.descend(self.node, self.centre)
        element = (2 * tree.patch[leaf][:, None] + np.arange(2)).ravel()
        twin = cover.twin[element]
        self.copied: Ints = np.flatnonzero(twin >= 0)
        self.reach = np.where(twin >= 0, cover.reach[element], np.float32(0.0))
        self._shortest_reach = np.float32(shortest_reach)
        self._twin = (len(element) + twin - cover.first_twin).astype(np.int32)
        self._copy = np.zeros(len(element), dtype=np.int32)
        self._copy[self.copied] = len(element) + len(cover.element) + np.arange(len(self.copied))
        unlit = unlit_side[2 * tree.triangle[element >> 1] + (element & 1)]
        self.unlit = np.concatenate([unlit, np.zeros(len(cover.element) + len(self.copied), dtype=bool)])
        twins = cover.first_twin + np.arange(len(cover.element))
        self.element: Ints = np.concatenate([element, twins, twin[self.copied]])

    def corners(self, cells: Ints) -> Floats:
        """Barycentric coordinates of the corners of cells (n,) in the surfaces' triangles, (n, 3, 3)."""
        corners: Floats = self.corners_in_nodes(cells) @ self._corners_of_node[self.node[cells]]
        return corners

    def corners_in_nodes(self, cells: Ints) -> Floats:
        """The same in their nodes."""
        return cell_corners(self.centre[cells], self._along[self.node[cells]])

    def places(self, found: Hits) -> NDArray[np.int32]:
        """The place that each ray met, or `ESCAPED`, (n,)."""
        node, u, v = found.triangle, found.u, found.v
        if self._any_halved:
            weights = np.stack([u, v], axis=1)
            node = self._locator.coarse(np.maximum(node, 0), weights)
            u, v = weights[:, 0], weights[:, 1]
        deeper = np.flatnonzero(self._is_wide[node])
        if len(deeper):
            leaf, inside = self._tree.descend(node[deeper].astype(np.int64), np.stack([u[deeper], v[deeper]], axis=1))
            node, u, v = node.copy(), u.copy(), v.copy()
            node[deeper], u[deeper], v[deeper] = leaf, inside[:, 0], inside[:, 1]
        along = self._along[node]
        inside = along * INSIDE
        u, v = u * inside, v * inside
        i, j = u.astype(np.int32), v.astype(np.int32)
        u -= i
        v -= j
        u += v
        place: NDArray[np.int32] = i * (2 * along - i)
        place += self._first[node]
        place += 2 * j
        place += u > 1.0
        place <<= 1
        place += found.back
        if found.triangle.min(initial=0) < 0:
            place[found.triangle < 0] = ESCAPED
        if len(self.copied):
            short = np.flatnonzero((found.distance < self.reach[np.maximum(place, 0)]) & (place >= 0))
            thin = found.distance[short] < self._shortest_reach
            place[short] = np.where(thin, self._twin[place[short]], self._copy[place[short]])
        return place


@dataclass(frozen=True, eq=False)
class Radiance:
    """What a ray sees at the end of its way.

    Attributes
    ----------
    values : (places + sky + 3, 4) float32, W m^-2 sr^-1
        Three channels by place, and 1 where a ray can see it: 0 for unlit sides, which rays meet that started inside
        a solid. After the places, the cells of the world's map, if there is one.
    first_of_sky : int or None
        Where these begin.
    """

    values: Singles
    first_of_sky: int | None

    @staticmethod
    def of(cells: Cells, radiance: Floats, world: Floats) -> Radiance:
        """Join the radiance of places (2 * cells and twins, 3) with that of the world, (3,) or (sky, 3)."""
        count, sky = len(radiance), len(world) if world.ndim > 1 else 0
        values = np.ones((count + sky + SPECIAL, 4), dtype=np.float32)
        values[:count, :3] = radiance
        if sky:
            values[count:-SPECIAL, :3] = world
        values[:count][cells.unlit] = 0.0
        values[-SPECIAL:] = 0.0
        values[BELOW] = (0.0, 0.0, 0.0, 1.0)
        if world.ndim == 1:
            values[ESCAPED] = (*world, 1.0)
        return Radiance(values, count if world.ndim > 1 else None)
