# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The traced transport: for each side of each patch, where its rays ended.

An *element* is one side of a patch: twice the patch's node, plus 1 for the back. A *row* is a block of rays that leave
one element with cosine distribution from points spread over it; the share of them that ends on another element is the
form factor to it.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .patches import PatchTree
from .reachability import side_normals
from .sampling import cosine_directions, hashed, sequence, shifted, triangle_weights
from .scene import Floats, Ints
from .surfaces import Surfaces
from .visibility import RayScene

ESCAPED = -1
"""Hit of a ray that left the scene."""

BURIED = -2
"""Hit of a ray that started inside a solid: it met the inside of a closed mesh that no light enters."""

BYTES_PER_RAY = 12
"""Kept for every ray: element (int32) and two barycentric weights (float32)."""


def element_normals(surfaces: Surfaces, tree: PatchTree, elements: Ints) -> Floats:
    """Unit normals of elements, turned to their side, (m, 3)."""
    return side_normals(surfaces.normals[tree.triangle[elements >> 1]], elements & 1)


def points_in(tree: PatchTree, nodes: Ints, weights: Floats) -> Floats:
    """Positions of barycentric weights (m, r, 2) of corners 1 and 2 in nodes (m,): (m, r, 3)."""
    a, b, c = (tree.points[tree.corners[nodes, k]][:, None] for k in range(3))
    u, v = weights[..., :1], weights[..., 1:]
    return a + (b - a) * u + (c - a) * v


@dataclass(frozen=True, eq=False)
class Shares:
    """Form factors as counts of rays, one entry for each pair that exchanges any.

    Attributes
    ----------
    receiver, source : (p,) int
        Elements; `source` may be `ESCAPED`.
    share : (p,) float
        Form factor from receiver to source: share of the receiver's valid rays.
    rays : (p,) int
        Valid rays of the receiver.
    """

    receiver: Ints
    source: Ints
    share: Floats
    rays: Ints

    def standard_error(self) -> Floats:
        """Binomial standard error of each share, with one hit added so that a share of 0 or 1 keeps one, (p,)."""
        count = self.rays
        padded = (self.share * count + 1.0) / (count + 2.0)
        return np.sqrt(padded * (1.0 - padded) / count)


class Transport:
    """The rows of all elements that take part.

    Attributes
    ----------
    element_of_row, block_of_row : (r,) int
    hits : (r, k) int32
        Element that each ray met, `ESCAPED` or `BURIED`.
    weights : (r, k, 2) float32
        Where on the patch.
    """

    def __init__(
        self, surfaces: Surfaces, tree: PatchTree, rays: RayScene, solid: NDArray[np.bool_], rays_per_row: int, seed: int
    ) -> None:
        self.surfaces, self.tree, self.rays, self.seed = surfaces, tree, rays, seed
        self.rays_per_row = rays_per_row
        self.solid_triangle = solid[surfaces.shell_of_triangle]
        self.element_of_row: Ints = np.zeros(0, dtype=np.int64)
        self.block_of_row: Ints = np.zeros(0, dtype=np.int64)
        self.hits: NDArray[np.int32] = np.zeros((0, rays_per_row), dtype=np.int32)
        self.weights: NDArray[np.float32] = np.zeros((0, rays_per_row, 2), dtype=np.float32)

    def has_row(self) -> NDArray[np.bool_]:
        """Whether each element has been traced, (2 * nodes,)."""
        known = np.zeros(2 * len(self.tree), dtype=bool)
        known[self.element_of_row] = True
        return known

    def met_but_untraced(self) -> Ints:
        """Elements that some ray met and that have no row of their own yet, sorted."""
        met = np.zeros(2 * len(self.tree), dtype=bool)
        met[self.hits[self.hits >= 0]] = True
        return np.flatnonzero(met & ~self.has_row())

    def trace(self, elements: Ints, blocks: Ints, report: Callable[[float], None] = lambda share: None) -> None:
        """Add a row for each element; block b continues the element's sampling sequence after b rows."""

        def work(first: int, last: int) -> tuple[NDArray[np.int32], NDArray[np.float32]]:
            return self._trace_part(elements[first:last], blocks[first:last])

        parts = self.rays.map(work, len(elements), self.rays_per_row, report)
        if parts:
            self.element_of_row = np.concatenate([self.element_of_row, elements])
            self.block_of_row = np.concatenate([self.block_of_row, blocks])
            self.hits = np.concatenate([self.hits, *(hits for hits, _ in parts)])
            self.weights = np.concatenate([self.weights, *(weights for _, weights in parts)])

    def _trace_part(self, elements: Ints, blocks: Ints) -> tuple[NDArray[np.int32], NDArray[np.float32]]:
        count = self.rays_per_row
        points = np.stack([sequence(int(b) * count, count, 4) for b in range(int(blocks.max()) + 1)])[blocks]
        moved = points + hashed(elements, 4, self.seed)[:, None, :]
        moved -= moved >= 1.0
        normals = element_normals(self.surfaces, self.tree, elements)
        origins = points_in(self.tree, elements >> 1, triangle_weights(moved[..., :2]))
        directions = cosine_directions(moved[..., 2:], normals)
        hits, weights = self.look(
            origins.reshape(-1, 3), np.repeat(normals, count, axis=0), directions.reshape(-1, 3)
        )
        return hits.reshape(-1, count), weights.reshape(-1, count, 2)

    def look(self, origins: Floats, normals: Floats, directions: Floats) -> tuple[NDArray[np.int32], NDArray[np.float32]]:
        """Trace rays (n, 3) and return the leaf elements they meet (n,) and the weights there (n, 2)."""
        found = self.rays.first_hits(origins, normals, directions)
        triangle, weights = found.triangle, found.weights
        met = np.flatnonzero(triangle >= 0)
        facing = self.surfaces.normals[triangle[met]]
        back = np.einsum("nx,nx->n", directions[met], facing) > 0.0
        nodes, weights[met] = self.tree.descend(triangle[met], weights[met])
        elements = np.full(len(triangle), ESCAPED, dtype=np.int32)
        elements[met] = np.where(back & self.solid_triangle[triangle[met]], BURIED, 2 * nodes + back)
        return elements, weights

    def follow_splits(self) -> int:
        """Drop the rows of patches that were split, and move the rays that met one to the child they met.

        Returns the number of rays moved; none is traced.
        """
        keep = self.tree.first_child[self.element_of_row >> 1] < 0
        self.element_of_row, self.block_of_row = self.element_of_row[keep], self.block_of_row[keep]
        self.hits, self.weights = self.hits[keep], self.weights[keep]
        flat, weights = self.hits.reshape(-1), self.weights.reshape(-1, 2)
        valid = np.flatnonzero(flat >= 0)
        stale = valid[self.tree.first_child[flat[valid] >> 1] >= 0]
        nodes, weights[stale] = self.tree.descend(flat[stale].astype(np.int64) >> 1, weights[stale])
        flat[stale] = 2 * nodes + (flat[stale] & 1)
        return len(stale)

    def shares(self) -> Shares:
        """Form factors of all pairs from the rows as they are."""
        ordered = np.sort(self.hits, axis=1)
        change = np.ones(ordered.shape, dtype=bool)
        change[:, 1:] = ordered[:, 1:] != ordered[:, :-1]
        starts = np.flatnonzero(change)
        count = np.diff(np.append(starts, ordered.size))
        row = starts // max(1, self.rays_per_row)
        source = ordered.reshape(-1)[starts].astype(np.int64)
        receiver = self.element_of_row[row]
        # Blocks of the same element are added up.
        key, inverse = np.unique((receiver << 32) + (source + 2), return_inverse=True)
        total = np.bincount(inverse, weights=count, minlength=len(key)).astype(np.int64)
        receiver, source = key >> 32, (key & 0xFFFFFFFF) - 2
        size = 2 * len(self.tree)
        valid = np.bincount(receiver, weights=np.where(source == BURIED, 0, total), minlength=size).astype(np.int64)
        some = (source != BURIED) & (valid[receiver] > 0)
        receiver, source, total = receiver[some], source[some], total[some]
        rays = valid[receiver]
        return Shares(receiver, source, total / rays, rays)

    def buried_share(self) -> Floats:
        """Share of each element's rays that started inside a solid, (2 * nodes,); 0 for elements without a row."""
        size = 2 * len(self.tree)
        buried = np.bincount(self.element_of_row, weights=(self.hits == BURIED).sum(axis=1), minlength=size)
        traced = np.bincount(self.element_of_row, minlength=size) * self.rays_per_row
        return np.divide(buried, traced, out=np.zeros(size), where=traced > 0)


def sample_points(
    surfaces: Surfaces, tree: PatchTree, elements: Ints, count: int, seed: int
) -> tuple[Floats, Floats]:
    """Points spread over elements and the normals there, both (m * count, 3)."""
    square = shifted(sequence(0, count, 2), hashed(elements, 2, seed))
    points = points_in(tree, elements >> 1, triangle_weights(square))
    return points.reshape(-1, 3), np.repeat(element_normals(surfaces, tree, elements), count, axis=0)
