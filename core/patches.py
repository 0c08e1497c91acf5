# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The hierarchy of patches: triangles that split at their edge midpoints."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from .geometry import edge_lengths
from .scene import Floats, Ints
from .surfaces import Surfaces

FOUR = 3
"""Kind of a split into four by the edge midpoints; kinds 0 to 2 halve the edge from that corner to the next."""

LARGEST_ASPECT = 4.0
"""Longest edge over lowest altitude above which the coarse triangulation halves a triangle (right isosceles: 2)."""


class PatchTree:
    """Triangles, each either a leaf or split into two or four children.

    Vertices are shared: an edge has one midpoint, whichever triangles of its mesh meet there, so leaves of equal level
    fit together. A node's children follow each other.

    Attributes
    ----------
    points : (v, 3) float, scene units
        The surfaces' own points, then the midpoints.
    place_of_point : (v,) int
    mesh_of_point : (v,) int
    corners : (n, 3) int
        Points of each node, wound as its triangle.
    triangle : (n,) int
        Index into the surfaces' triangles.
    weights : (n, 3, 3) float
        Barycentric coordinates of the node's corners in that triangle.
    first_child : (n,) int
        -1 for a leaf.
    kind : (n,) int
        How the node is split (`FOUR` or the halved edge).
    root : (n,) int
        The coarse patch each node was split from by midpoints; -1 for triangles that were halved into coarse patches.
    level : (n,) int
        Splits by midpoints below its coarse patch.
    """

    def __init__(self, surfaces: Surfaces) -> None:
        count = len(surfaces.triangles)
        self.points: Floats = surfaces.points
        self.place_of_point: Ints = surfaces.place_of_point
        points_of_mesh = np.diff(surfaces.first_point_of_mesh)
        self.mesh_of_point: Ints = np.repeat(np.arange(len(points_of_mesh)), points_of_mesh)
        self.corners: Ints = surfaces.triangles
        self.triangle: Ints = np.arange(count, dtype=np.int64)
        self.weights: Floats = np.broadcast_to(np.eye(3), (count, 3, 3)).copy()
        self.first_child: Ints = np.full(count, -1, dtype=np.int64)
        self.kind: NDArray[np.int8] = np.full(count, FOUR, dtype=np.int8)
        self.root: Ints = np.arange(count, dtype=np.int64)
        self.level: Ints = np.zeros(count, dtype=np.int64)
        self._edge_keys: Ints = np.zeros(0, dtype=np.int64)
        self._edge_midpoints: Ints = np.zeros(0, dtype=np.int64)

    def __len__(self) -> int:
        return len(self.triangle)

    def copy(self) -> PatchTree:
        """A tree that can be split further without changing this one (arrays are replaced, never written to)."""
        other = object.__new__(PatchTree)
        other.__dict__.update(self.__dict__)
        other.first_child = self.first_child.copy()
        other.kind = self.kind.copy()
        other.root = self.root.copy()
        return other

    def leaves(self) -> Ints:
        """Indices of the nodes that are not split, (m,)."""
        return np.flatnonzero(self.first_child < 0)

    def sizes(self, nodes: Ints) -> Floats:
        """Longest edge of each node, (m,), scene units."""
        return edge_lengths(self.points, self.corners[nodes]).max(axis=1, initial=0.0)

    def midpoints(self, starts: Ints, ends: Ints) -> Ints:
        """The midpoint of each edge as a point index, -1 where the edge was never halved; same shape as `starts`."""
        key = self._keys(starts, ends)
        if len(self._edge_keys) == 0:
            return np.full(key.shape, -1, dtype=np.int64)
        place = np.minimum(np.searchsorted(self._edge_keys, key), len(self._edge_keys) - 1)
        return np.where(self._edge_keys[place] == key, self._edge_midpoints[place], -1)

    def split(self, nodes: Ints) -> Ints:
        """Split leaves into four by their edge midpoints; returns the children, four after four, (4 m,)."""
        c0, c1, c2 = self.corners[nodes].T
        m01, m12, m20 = self._halve(np.stack([c0, c1, c2]), np.stack([c1, c2, c0]))
        corners = np.stack([c0, m01, m20, m01, c1, m12, m20, m12, c2, m12, m20, m01], axis=1).reshape(-1, 3)
        w = self.weights[nodes]
        w0, w1, w2 = w[:, 0], w[:, 1], w[:, 2]
        h01, h12, h20 = (w0 + w1) / 2, (w1 + w2) / 2, (w2 + w0) / 2
        weights = np.stack([w0, h01, h20, h01, w1, h12, h20, h12, w2, h12, h20, h01], axis=1)
        return self._add(nodes, np.full(len(nodes), FOUR, np.int8), corners, weights.reshape(-1, 3, 3), 4)

    def bisect(self, nodes: Ints, edges: Ints) -> Ints:
        """Halve one edge (0: 0-1, 1: 1-2, 2: 2-0) of each leaf; returns the children, two after two, (2 m,)."""
        row = np.arange(len(nodes))
        order = np.stack([edges, (edges + 1) % 3, (edges + 2) % 3], axis=1)
        a, b, c = self.corners[nodes[:, None], order].T
        middle = self._halve(a, b)
        corners = np.stack([a, middle, c, middle, b, c], axis=1).reshape(-1, 3)
        w = self.weights[nodes][row[:, None], order]
        half = (w[:, 0] + w[:, 1]) / 2
        weights = np.stack([w[:, 0], half, w[:, 2], half, w[:, 1], w[:, 2]], axis=1).reshape(-1, 3, 3)
        return self._add(nodes, edges.astype(np.int8), corners, weights, 2)

    def descend(self, nodes: Ints, weights: NDArray[np.float32]) -> tuple[Ints, NDArray[np.float32]]:
        """Walk points down to the leaves they lie in.

        Parameters
        ----------
        nodes : (m,) int
            Where to start.
        weights : (m, 2) float
            Barycentric weights of corners 1 and 2 of that node.

        Returns
        -------
        The leaf of each point, and the weights in it, of the same shapes.
        """
        nodes, weights = nodes.astype(np.int64), weights.copy()
        moving = np.flatnonzero(self.first_child[nodes] >= 0)
        while len(moving):
            node, w = nodes[moving], weights[moving]
            child, inside = _child_of_four(w)
            halved = np.flatnonzero(self.kind[node] != FOUR)
            if len(halved):
                child[halved], inside[halved] = _child_of_two(w[halved], self.kind[node[halved]])
            nodes[moving] = self.first_child[node] + child
            weights[moving] = inside
            moving = moving[self.first_child[nodes[moving]] >= 0]
        return nodes, weights

    def descend_halves(self, nodes: Ints, weights: NDArray[np.float32]) -> tuple[Ints, NDArray[np.float32]]:
        """As `descend`, but only through triangles that were halved, to the coarse patches."""
        nodes, weights = nodes.copy(), weights.copy()
        moving = np.flatnonzero(self.root[nodes] < 0)
        while len(moving):
            node = nodes[moving]
            child, weights[moving] = _child_of_two(weights[moving], self.kind[node])
            nodes[moving] = self.first_child[node] + child
            moving = moving[self.root[nodes[moving]] < 0]
        return nodes, weights

    @staticmethod
    def _ordered(starts: Ints, ends: Ints) -> tuple[Ints, Ints]:
        return np.minimum(starts, ends), np.maximum(starts, ends)

    def _keys(self, starts: Ints, ends: Ints) -> Ints:
        low, high = self._ordered(self.place_of_point[starts], self.place_of_point[ends])
        return (low << 32) | high

    def _halve(self, starts: Ints, ends: Ints) -> Ints:
        """Midpoints of edges, made where they do not exist."""
        keys = self._keys(starts, ends)
        new, first = np.unique(keys, return_index=True)
        missing = self.midpoints(starts.ravel()[first], ends.ravel()[first]) < 0
        new, first = new[missing], first[missing]
        a, b = starts.ravel()[first], ends.ravel()[first]
        made = np.arange(len(self.points), len(self.points) + len(new))
        self.points = np.concatenate([self.points, (self.points[a] + self.points[b]) / 2.0])
        self.place_of_point = np.concatenate([self.place_of_point, made])
        self.mesh_of_point = np.concatenate([self.mesh_of_point, self.mesh_of_point[a]])
        joined = np.concatenate([self._edge_keys, new])
        order = np.argsort(joined, kind="stable")
        self._edge_keys = joined[order]
        self._edge_midpoints = np.concatenate([self._edge_midpoints, made])[order]
        return self.midpoints(starts, ends)

    def _add(self, nodes: Ints, kind: NDArray[np.int8], corners: Ints, weights: Floats, each: int) -> Ints:
        count = len(self)
        children = np.arange(count, count + each * len(nodes))
        self.first_child[nodes] = children[::each]
        self.kind[nodes] = kind
        self.corners = np.concatenate([self.corners, corners])
        self.triangle = np.concatenate([self.triangle, np.repeat(self.triangle[nodes], each)])
        self.weights = np.concatenate([self.weights, weights])
        self.first_child = np.concatenate([self.first_child, np.full(len(children), -1, dtype=np.int64)])
        self.kind = np.concatenate([self.kind, np.full(len(children), FOUR, dtype=np.int8)])
        if each == 4:
            root, level = np.repeat(self.root[nodes], each), np.repeat(self.level[nodes] + 1, each)
        else:
            self.root[nodes] = -1
            root, level = children, np.zeros(len(children), dtype=np.int64)
        self.root, self.level = np.concatenate([self.root, root]), np.concatenate([self.level, level])
        return children


def _child_of_four(w: NDArray[np.float32]) -> tuple[Ints, NDArray[np.float32]]:
    """Which of four children a point lies in, and its weights there."""
    w1, w2 = w[:, 0], w[:, 1]
    w0 = 1.0 - w1 - w2
    child = np.where(w0 >= 0.5, 0, np.where(w1 >= 0.5, 1, np.where(w2 >= 0.5, 2, 3)))
    inside = 2.0 * w
    inside[child == 1, 0] -= 1.0
    inside[child == 2, 1] -= 1.0
    middle = child == 3
    inside[middle] = 1.0 - inside[middle]
    return child, inside


def _child_of_two(w: NDArray[np.float32], kind: NDArray[np.int8]) -> tuple[Ints, NDArray[np.float32]]:
    """Which of two children a point lies in, and its weights there; `kind` is the first corner of the halved edge."""
    full = np.stack([1.0 - w[:, 0] - w[:, 1], w[:, 0], w[:, 1]], axis=1)
    row, edge = np.arange(len(w)), kind.astype(np.int64)
    a, b, c = full[row, edge], full[row, (edge + 1) % 3], full[row, (edge + 2) % 3]
    second = b > a
    # Children are (a, middle, c) and (middle, b, c); the weights kept are those of corners 1 and 2.
    inside = np.stack([np.where(second, b - a, 2.0 * b), c], axis=1)
    return second.astype(np.int64), inside.astype(w.dtype)


def coarse_patches(surfaces: Surfaces, smallest: float) -> PatchTree:
    """The controlled triangulation: the surfaces' triangles, the slender ones halved along their longest edge.

    Halving the longest edge never lowers the smallest angle by more than half (Rivara 1984). It ends where the pieces
    are no longer than a few times the width of the triangle they come from, so that a strip becomes a row of them, and
    where an edge is shorter than four times `smallest`, so that refinement below still has room.
    """
    tree = PatchTree(surfaces)
    nodes = tree.leaves()
    longest = tree.sizes(nodes)
    width = 2.0 * surfaces.areas / np.maximum(longest, np.finfo(np.float64).tiny)
    limit = np.maximum(LARGEST_ASPECT * width, 4.0 * smallest)
    while len(nodes):
        lengths = edge_lengths(tree.points, tree.corners[nodes])
        slender = lengths.max(axis=1, initial=0.0) > limit[tree.triangle[nodes]]
        nodes, lengths = nodes[slender], lengths[slender]
        nodes = tree.bisect(nodes, lengths.argmax(axis=1))
    return tree
