# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The hierarchy of patches: triangles that split at their edge midpoints, and clusters of triangles above them."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from .clusters import Clusters
from .geometry import edge_lengths, largest_edges, normalized, triangle_areas, triangle_cross, weights_in
from .sampling import frames, mixed
from .scene import Floats, Ints
from .seams import Seams
from .slices import Slices, numbered, sliced, vertices_on_edges
from .surfaces import Surfaces

FOUR, SLICED = 3, 4
"""Kinds of splits: into four by the edge midpoints, and into a row; kinds 0 to 2 cut the edge from that corner to the
next."""


class PatchTree:
    """Triangles, each either a leaf, cut into two, split into four, or sliced into a row of pieces.

    Vertices are shared: an edge has one midpoint, whichever triangles of its mesh meet there, so leaves of equal level
    fit together. A node's children follow each other. What light is exchanged between are the `patches`: leaves, or the
    clusters that they are members of.

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
    parent : (n,) int
        -1 where there is none.
    first_child : (n,) int
        -1 for a leaf.
    kind : (n,) int
        How the node is split (`FOUR`, `SLICED` or the edge that is cut).
    share : (n,) float
        Where that edge is cut, from its first corner.
    root : (n,) int
        The coarse patch each node was split from by midpoints; -1 for triangles that were cut into coarse patches, and
        a member for clusters, which are none.
    level : (n,) int
        Splits by midpoints below its coarse patch.
    key : (n,) int
        A number that depends on the input triangle and on how the node was split from it, and not on what else was
        split.
    by_key : bool
        Whether elements are sampled by these keys, and not by their numbers: so the rays of each stay what they were
        in the frame before, whatever was split elsewhere.
    patch : (n,) int
        The patch that stands for each leaf: itself, or the cluster it is in. -1 for a cluster that is no patch.
    clusters : Clusters
        Their members are nodes; they are nodes themselves, from `first_cluster` on. Their corners are those of a right
        isosceles triangle that is as large, at the same place, and their triangle is a typical one of theirs.
    seams : Seams
        Edges that sheets pass through or stand on.
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
        self.parent: Ints = np.full(count, -1, dtype=np.int64)
        self.first_child: Ints = np.full(count, -1, dtype=np.int64)
        self.kind: NDArray[np.int8] = np.full(count, FOUR, dtype=np.int8)
        self.share: Floats = np.full(count, 0.5)
        self.root: Ints = np.arange(count, dtype=np.int64)
        self.level: Ints = np.zeros(count, dtype=np.int64)
        self.key: Ints = np.arange(count, dtype=np.int64)
        self.by_key = False
        self.patch: Ints = np.arange(count, dtype=np.int64)
        self.clusters = Clusters.none()
        self.first_cluster = 0
        self.seams = Seams.none()
        self._slices, self._first_slice = Slices.none(), 0
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
        other.share = self.share.copy()
        other.root = self.root.copy()
        other.patch = self.patch.copy()
        return other

    def leaves(self) -> Ints:
        """Indices of the triangles that are not split, (m,)."""
        leaf = self.first_child < 0
        leaf[self.first_cluster : self.first_cluster + len(self.clusters)] = False
        return np.flatnonzero(leaf)

    def patches(self) -> Ints:
        """Indices of the leaves and clusters that exchange light, (m,): together they are the whole surface."""
        return np.flatnonzero(self.is_patch())

    def is_patch(self) -> NDArray[np.bool_]:
        """Whether each node is one of `patches`, (n,)."""
        result: NDArray[np.bool_] = (self.patch == np.arange(len(self))) & (self.first_child < 0)
        return result

    def is_cluster(self, nodes: Ints) -> NDArray[np.bool_]:
        """Whether nodes are clusters, of the same shape."""
        result: NDArray[np.bool_] = (nodes >= self.first_cluster) & (nodes < self.first_cluster + len(self.clusters))
        return result

    def sizes(self, nodes: Ints) -> Floats:
        """Longest edge of each node, (m,), scene units."""
        return largest_edges(self.points, self.corners[nodes])

    def areas(self, nodes: Ints) -> Floats:
        """Area of each node, (m,), scene units squared."""
        return triangle_areas(self.points[self.corners[nodes]])

    def expanded(self, nodes: Ints) -> tuple[Ints, Ints, Floats]:
        """The nodes with a triangle of their own that nodes (m,) consist of.

        Returns
        -------
        row : (p,) int
            Places in `nodes`.
        inside : (p,) int
            Nodes that are no clusters: those themselves, and the members of clusters.
        share : (p,) float
            Of the node's area.
        """
        clustered, single = np.flatnonzero(self.is_cluster(nodes)), np.flatnonzero(~self.is_cluster(nodes))
        number = nodes[clustered] - self.first_cluster
        row = np.repeat(clustered, self.clusters.count[number])
        inside = self.clusters.members_of(number)
        share = self.areas(inside) / self.clusters.areas()[nodes[row] - self.first_cluster]
        return (
            np.concatenate([single, row]),
            np.concatenate([nodes[single], inside]),
            np.concatenate([np.ones(len(single)), share]),
        )

    def carriers(self, nodes: Ints, share: Floats) -> tuple[Ints, Floats]:
        """Triangles at shares (m, r) of the area of nodes (m,).

        Returns
        -------
        carriers : (m, r) int
            Nodes: members of clusters, and triangles themselves.
        remainder : (m, r) float
            Share of the carrier's own area.
        """
        carriers, remainder = np.repeat(nodes[:, None], share.shape[1], axis=1), share.copy()
        clustered = np.flatnonzero(self.is_cluster(nodes))
        number = nodes[clustered] - self.first_cluster
        carriers[clustered], remainder[clustered] = self.clusters.drawn(number, share[clustered])
        return carriers, remainder

    def keys(self, elements: Ints) -> Ints:
        """What elements (m,), which are twice a node and 1 more for its back, are sampled by, (m,)."""
        if not self.by_key:
            return elements
        keys: Ints = 2 * self.key[elements >> 1] + (elements & 1)
        return keys

    def add_clusters(self, clusters: Clusters) -> None:
        """Let clusters of leaves, the coarsest of them, take the place of their members; once, before any split."""
        self.clusters, self.first_cluster = clusters, len(self)
        count, corners = len(clusters), self.corners[clusters.members]
        normals = normalized(triangle_cross(self.points, corners))
        example = clusters.members[clusters.typical(normals)]
        stand_ins = _isosceles(
            clusters.means(self.points[corners].mean(axis=1)), normalized(clusters.means(normals)), clusters.areas()
        )
        made = len(self.points) + np.arange(3 * count)
        self.points = np.concatenate([self.points, stand_ins.reshape(-1, 3)])
        self.place_of_point = np.concatenate([self.place_of_point, made])
        self.mesh_of_point = np.concatenate([self.mesh_of_point, np.full(3 * count, -1)])
        self.corners = np.concatenate([self.corners, made.reshape(-1, 3)])
        self.triangle = np.concatenate([self.triangle, self.triangle[example]])
        self.weights = np.concatenate([self.weights, self.weights[example]])
        self.parent = np.concatenate([self.parent, np.full(count, -1, dtype=np.int64)])
        self.first_child = np.concatenate([self.first_child, np.full(count, -1, dtype=np.int64)])
        self.kind = np.concatenate([self.kind, np.full(count, FOUR, dtype=np.int8)])
        self.share = np.concatenate([self.share, np.full(count, 0.5)])
        self.root = np.concatenate([self.root, self.root[example]])
        self.level = np.concatenate([self.level, np.zeros(count, dtype=np.int64)])
        first = clusters.members[clusters.first]
        # Numbers that no parts of these members have.
        self.key = np.concatenate([self.key, key_below(self.key[first], -clusters.count)])
        self.patch = np.concatenate([self.patch, np.full(count, -1, dtype=np.int64)])
        self._stand(np.flatnonzero(clusters.parent < 0))

    def divide(self, patches: Ints) -> None:
        """Split the triangles among patches, and open the clusters: what they consist of takes their place."""
        clustered = self.is_cluster(patches)
        opened = patches[clustered] - self.first_cluster
        members = self.clusters.members_of(opened)
        self.patch[members] = members
        self.patch[patches[clustered]] = -1
        self._stand(np.flatnonzero(np.isin(self.clusters.parent, opened)))
        self.split(patches[~clustered])

    def parts(self, patches: Ints) -> Ints:
        """How many patches take the place of each when it is divided, (m,)."""
        parts, clustered = np.full(len(patches), 4), self.is_cluster(patches)
        parts[clustered] = self.clusters.parts()[patches[clustered] - self.first_cluster]
        return parts

    def _stand(self, clusters: Ints) -> None:
        """Make clusters the patches of their members."""
        node = self.first_cluster + clusters
        self.patch[node] = node
        self.patch[self.clusters.members_of(clusters)] = np.repeat(node, self.clusters.count[clusters])

    def ancestors(self, count: int) -> Ints:
        """The one of the first `count` nodes that each node is, or was split from, (n,); later clusters: themselves."""
        above = np.where(self.parent < 0, np.arange(len(self)), self.parent)
        above[:count] = np.arange(count)
        while True:
            farther = above[above]
            if np.array_equal(farther, above):
                return above
            above = farther

    def vertices(self, corners: Ints, nodes: Ints) -> Ints:
        """Numbers of the corners (f, 3) of faces, equal where they are at one place and on one side of all seams.

        Parameters
        ----------
        nodes : (f,) int
            Where the faces lie.
        """
        places, sides = self.place_of_point[corners], self.seams.sides
        if sides == 1:
            return places
        piece = self.ancestors(len(self.seams.of_edge))[nodes]
        near = np.flatnonzero((self.seams.of_edge[piece] | self.seams.of_corner[piece]).any(axis=1))
        weights = weights_in(self.points[self.corners[piece[near]]], self.points[corners[near]])
        vertices: Ints = places * sides
        vertices[near] += self.seams.sides_at(piece[near], weights)
        return vertices

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
        root, level = np.repeat(self.root[nodes], 4), np.repeat(self.level[nodes] + 1, 4)
        return self._add(np.repeat(nodes, 4), corners, weights.reshape(-1, 3, 3), root, level)

    def bisect(self, nodes: Ints, edges: Ints, shares: Floats | None = None) -> Ints:
        """Cut one edge (0: 0-1, 1: 1-2, 2: 2-0) of each leaf; returns the children, two after two, (2 m,).

        Parameters
        ----------
        shares : (m,) float or None
            Where, from the edge's first corner; None for the middle. An edge that has been cut is cut there again.
        """
        row = np.arange(len(nodes))
        order = np.stack([edges, (edges + 1) % 3, (edges + 2) % 3], axis=1)
        a, b, c = self.corners[nodes[:, None], order].T
        middle = self._halve(a, b, shares)
        corners = np.stack([a, middle, c, middle, b, c], axis=1).reshape(-1, 3)
        w = self.weights[nodes][row[:, None], order]
        if shares is not None:
            edge = self.points[b] - self.points[a]
            found = np.einsum("mx,mx->m", self.points[middle] - self.points[a], edge)
            self.share[nodes] = found / np.einsum("mx,mx->m", edge, edge)
        t = self.share[nodes, None]
        cut = w[:, 0] * (1.0 - t) + w[:, 1] * t
        weights = np.stack([w[:, 0], cut, w[:, 2], cut, w[:, 1], w[:, 2]], axis=1).reshape(-1, 3, 3)
        self.kind[nodes] = edges
        return self._add_coarse(np.repeat(nodes, 2), corners, weights)

    def slice(self, nodes: Ints, parts: Ints) -> Ints:
        """Slice leaves (m,), ascending, whose edges have so many parts each (m, 3); once, before any split into four.

        Returns their pieces, (p,).
        """
        corners = self.corners[nodes]
        made = sliced(edge_lengths(self.points, corners), parts)
        on_edges = self._points_on_edges(corners, parts)
        self.kind[nodes] = SLICED
        self._slices, self._first_slice = made, len(self)
        parents = nodes[made.of]
        return self._add_coarse(parents, on_edges[made.corners], made.weights @ self.weights[parents])

    def _points_on_edges(self, corners: Ints, parts: Ints) -> Ints:
        """Points of the parts of all edges, as `vertices_on_edges` counts them, made where there is none."""
        first, parts = vertices_on_edges(parts).ravel(), parts.ravel()
        on_edges = np.zeros(int((parts + 1).sum()), dtype=np.int64)
        on_edges[first] = corners.ravel()
        on_edges[first + parts] = np.roll(corners, -1, axis=1).ravel()
        step = parts
        while (halved := step > 1).any():
            first, parts, step = first[halved], parts[halved], step[halved]
            edge, number = numbered(parts // step)
            start, length = first[edge] + number * step[edge], step[edge]
            on_edges[start + length // 2] = self._halve(on_edges[start], on_edges[start + length])
            step = step // 2
        return on_edges

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
            child += self.first_child[node]
            cut = np.flatnonzero(self.kind[node] != FOUR)
            if len(cut):
                child[cut], inside[cut] = self._child_of_coarse(node[cut], w[cut])
            nodes[moving], weights[moving] = child, inside
            moving = moving[self.first_child[child] >= 0]
        # Each step doubles by how much rounding had a point outside: after twenty it would lie in another leaf.
        np.clip(weights, 0.0, 1.0, out=weights)
        np.minimum(weights[:, 1], 1.0 - weights[:, 0], out=weights[:, 1])
        return nodes, weights

    def descend_to_coarse(self, nodes: Ints, weights: NDArray[np.float32]) -> tuple[Ints, NDArray[np.float32]]:
        """As `descend`, but only through triangles that were cut or sliced, to the coarse patches."""
        nodes, weights = nodes.copy(), weights.copy()
        moving = np.flatnonzero(self.root[nodes] < 0)
        while len(moving):
            nodes[moving], weights[moving] = self._child_of_coarse(nodes[moving], weights[moving])
            moving = moving[self.root[nodes[moving]] < 0]
        return nodes, weights

    def _child_of_coarse(self, nodes: Ints, weights: NDArray[np.float32]) -> tuple[Ints, NDArray[np.float32]]:
        """The child that points lie in, of nodes (m,) that were cut or sliced, and their weights (m, 2) there."""
        child, is_sliced = self.first_child.take(nodes), self.kind.take(nodes) == SLICED
        if is_sliced.all():
            piece, inside = self._slices.found(child - self._first_slice, weights)
            return piece + self._first_slice, inside
        inside = weights.copy()
        one, two = np.flatnonzero(is_sliced), np.flatnonzero(~is_sliced)
        piece, inside[one] = self._slices.found(child[one] - self._first_slice, weights[one])
        child[one] = piece + self._first_slice
        half, inside[two] = _child_of_two(weights[two], self.kind[nodes[two]], self.share[nodes[two]])
        child[two] += half
        return child, inside

    @staticmethod
    def _ordered(starts: Ints, ends: Ints) -> tuple[Ints, Ints]:
        return np.minimum(starts, ends), np.maximum(starts, ends)

    def _keys(self, starts: Ints, ends: Ints) -> Ints:
        low, high = self._ordered(self.place_of_point[starts], self.place_of_point[ends])
        return (low << 32) | high

    def _halve(self, starts: Ints, ends: Ints, shares: Floats | None = None) -> Ints:
        """Midpoints of edges, or points at other shares of them, made where there is none."""
        keys = self._keys(starts, ends)
        new, first = np.unique(keys, return_index=True)
        missing = self.midpoints(starts.ravel()[first], ends.ravel()[first]) < 0
        new, first = new[missing], first[missing]
        a, b = starts.ravel()[first], ends.ravel()[first]
        made = np.arange(len(self.points), len(self.points) + len(new))
        if shares is None:
            middles = (self.points[a] + self.points[b]) / 2.0
        else:
            t = shares.ravel()[first, None]
            middles = self.points[a] * (1.0 - t) + self.points[b] * t
        self.points = np.concatenate([self.points, middles])
        self.place_of_point = np.concatenate([self.place_of_point, made])
        self.mesh_of_point = np.concatenate([self.mesh_of_point, self.mesh_of_point[a]])
        joined = np.concatenate([self._edge_keys, new])
        order = np.argsort(joined, kind="stable")
        self._edge_keys = joined[order]
        self._edge_midpoints = np.concatenate([self._edge_midpoints, made])[order]
        return self.midpoints(starts, ends)

    def _add_coarse(self, parents: Ints, corners: Ints, weights: Floats) -> Ints:
        """Add coarse patches that `parents` were cut or sliced into."""
        self.root[parents] = -1
        children = len(self) + np.arange(len(parents))
        return self._add(parents, corners, weights, children, np.zeros(len(parents), dtype=np.int64))

    def _add(self, parents: Ints, corners: Ints, weights: Floats, root: Ints, level: Ints) -> Ints:
        """Add children, those of a parent one after the other."""
        children = len(self) + np.arange(len(parents))
        begin = np.flatnonzero(np.diff(parents, prepend=-1))
        self.first_child[parents[begin]] = children[begin]
        number = children - self.first_child[parents]
        self.key = np.concatenate([self.key, key_below(self.key[parents], number)])
        self.corners = np.concatenate([self.corners, corners])
        self.triangle = np.concatenate([self.triangle, self.triangle[parents]])
        self.weights = np.concatenate([self.weights, weights])
        self.parent = np.concatenate([self.parent, parents])
        self.first_child = np.concatenate([self.first_child, np.full(len(children), -1, dtype=np.int64)])
        self.kind = np.concatenate([self.kind, np.full(len(children), FOUR, dtype=np.int8)])
        self.share = np.concatenate([self.share, np.full(len(children), 0.5)])
        self.root, self.level = np.concatenate([self.root, root]), np.concatenate([self.level, level])
        self.patch = np.concatenate([self.patch, children])
        return children


def key_below(keys: Ints, numbers: Ints) -> Ints:
    """Keys of what has a number below what has a key, both (n,): as good as random, and told by these alone."""
    return mixed(mixed(keys.view(np.uint64) + np.uint64(1)) + numbers.astype(np.uint64)).view(np.int64)


def _isosceles(middles: Floats, normals: Floats, areas: Floats) -> Floats:
    """Corners of right isosceles triangles about `middles` (m, 3), facing along `normals`, of areas (m,): (m, 3, 3)."""
    tangent, bitangent = frames(normals, np.zeros(len(normals))).astype(np.float64)[:, :2].transpose(1, 0, 2)
    side = np.sqrt(2.0 * areas)[:, None]
    corner = middles - side * (tangent + bitangent) / 3.0
    return np.stack([corner, corner + side * tangent, corner + side * bitangent], axis=1)


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


def _child_of_two(w: NDArray[np.float32], kind: NDArray[np.int8], share: Floats) -> tuple[Ints, NDArray[np.float32]]:
    """Which of two children a point lies in, and its weights there.

    Parameters
    ----------
    kind : (m,) int
        The first corner of the edge that is cut, and
    share : (m,) float
        where, from there.
    """
    full = np.stack([1.0 - w[:, 0] - w[:, 1], w[:, 0], w[:, 1]], axis=1)
    row, edge = np.arange(len(w)), kind.astype(np.int64)
    a, b, c = full[row, edge], full[row, (edge + 1) % 3], full[row, (edge + 2) % 3]
    t = share.astype(w.dtype)
    second = (1.0 - t) * b > t * a
    # Children are (a, cut, c) and (cut, b, c); the weights kept are those of corners 1 and 2.
    inside = np.stack([np.where(second, b - a * (t / (1.0 - t)), b / t), c], axis=1)
    return second.astype(np.int64), inside.astype(w.dtype)
