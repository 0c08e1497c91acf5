# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The output mesh: the leaves of a patch tree made to fit together without T-junctions."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from . import templates
from .geometry import normalized
from .patches import PatchTree
from .scene import Floats, Ints
from .surfaces import Surfaces


@dataclass(frozen=True, eq=False)
class Faces:
    """Triangles of the output mesh.

    Attributes
    ----------
    points : (v, 3) float, scene units
    places : (v,) int
        Points of the same mesh at the same place share a number.
    mesh_of_point : (v,) int
    corners : (s, 3) int
        Indices of points.
    vertices : (s, 3) int
        Numbers that corners share at one place of a mesh, unless a sheet stands between them.
    triangle : (s,) int
        The surfaces' triangle each lies in.
    weights : (s, 3, 3) float
        Barycentric coordinates of the corners in it.
    node : (s,) int
        The leaf of the patch tree each lies in.
    """

    points: Floats
    places: Ints
    mesh_of_point: Ints
    corners: Ints
    vertices: Ints
    triangle: Ints
    weights: Floats
    node: Ints

    def taken(self, which: Ints) -> Faces:
        """Some of the faces."""
        corners, triangle = self.corners[which], self.triangle[which]
        return replace(
            self,
            corners=corners,
            vertices=self.vertices[which],
            triangle=triangle,
            weights=self.weights[which],
            node=self.node[which],
        )

    def joined(self, others: Faces, tree: PatchTree) -> Faces:
        """These faces and others behind them, of the same tree."""
        return Faces(
            tree.points,
            tree.place_of_point,
            tree.mesh_of_point,
            np.concatenate([self.corners, others.corners]),
            np.concatenate([self.vertices, others.vertices]),
            np.concatenate([self.triangle, others.triangle]),
            np.concatenate([self.weights, others.weights]),
            np.concatenate([self.node, others.node]),
        )

    def corner_normals(self, surfaces: Surfaces) -> Floats:
        """Shading normals at the corners, interpolated and of length 1, (s, 3, 3)."""
        return normalized(self.weights @ surfaces.corner_normals[self.triangle])


def input_faces(surfaces: Surfaces) -> Faces:
    """The surfaces' own triangles of the meshes that are baked, unsplit."""
    triangle = np.flatnonzero(surfaces.baked)
    weights = np.broadcast_to(np.eye(3), (len(triangle), 3, 3)).copy()
    tree = PatchTree(surfaces)
    return Faces(
        tree.points,
        tree.place_of_point,
        tree.mesh_of_point,
        surfaces.triangles[triangle],
        tree.place_of_point[surfaces.triangles[triangle]],
        triangle,
        weights,
        triangle,
    )


def conforming_faces(surfaces: Surfaces, tree: PatchTree, shells: NDArray[np.bool_]) -> Faces:
    """Faces of the baked meshes in which every vertex on an edge is a corner of the faces on both sides.

    Leaves next to leaves two levels finer are split first; what is left has at most one vertex on an edge, and is cut
    into two, three or four triangles from there (red-green closure; Bank, Sherman & Weiser 1983). The tree is split
    in place.

    Parameters
    ----------
    shells : (shells,) bool
        Those whose faces are wanted: no vertex of another lies on their edges.
    """
    wanted = surfaces.baked & shells[surfaces.shell_of_triangle]
    while True:
        leaves = tree.leaves()
        leaves = leaves[wanted[tree.triangle[leaves]]]
        middles = _edge_middles(tree, tree.corners[leaves])
        uneven = _twice_halved(tree, tree.corners[leaves], middles)
        if not uneven.any():
            return _closed_by_templates(tree, leaves, middles)
        tree.split(leaves[uneven])


def _edge_middles(tree: PatchTree, corners: Ints) -> Ints:
    """Midpoints of the edges 0-1, 1-2, 2-0, -1 where there is none, (m, 3)."""
    return tree.midpoints(corners, np.roll(corners, -1, axis=1))


def _twice_halved(tree: PatchTree, corners: Ints, middles: Ints) -> NDArray[np.bool_]:
    """Whether half of an edge has a midpoint of its own, (m,) bool."""
    leaf, edge = np.nonzero(middles >= 0)
    start, middle, end = corners[leaf, edge], middles[leaf, edge], corners[leaf, (edge + 1) % 3]
    again = (tree.midpoints(start, middle) >= 0) | (tree.midpoints(middle, end) >= 0)
    twice = np.zeros(len(corners), dtype=bool)
    twice[leaf[again]] = True
    return twice


def _closed_by_templates(tree: PatchTree, leaves: Ints, middles: Ints) -> Faces:
    six = np.concatenate([tree.corners[leaves], middles], axis=1)
    w = tree.weights[leaves]
    weights = np.concatenate([w, (w + np.roll(w, -1, axis=1)) / 2.0], axis=1)
    member, piece = templates.cut(tree.points, six, middles >= 0)
    corners = six[member[:, None], piece]
    return Faces(
        tree.points,
        tree.place_of_point,
        tree.mesh_of_point,
        corners,
        tree.vertices(corners, leaves[member]),
        tree.triangle[leaves[member]],
        weights[member[:, None], piece],
        leaves[member],
    )
