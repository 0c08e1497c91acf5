# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The output mesh: the leaves of a patch tree made to fit together without T-junctions."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

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
    triangle : (s,) int
        The surfaces' triangle each lies in.
    weights : (s, 3, 3) float
        Barycentric coordinates of the corners in it.
    """

    points: Floats
    places: Ints
    mesh_of_point: Ints
    corners: Ints
    triangle: Ints
    weights: Floats

    def corner_normals(self, surfaces: Surfaces) -> Floats:
        """Shading normals at the corners, interpolated and of length 1, (s, 3, 3)."""
        return normalized(self.weights @ surfaces.corner_normals[self.triangle])


def input_faces(surfaces: Surfaces) -> Faces:
    """The surfaces' own triangles of the meshes that are baked, unsplit."""
    triangle = np.flatnonzero(surfaces.baked)
    weights = np.broadcast_to(np.eye(3), (len(triangle), 3, 3)).copy()
    tree = PatchTree(surfaces)
    return Faces(tree.points, tree.place_of_point, tree.mesh_of_point, surfaces.triangles[triangle], triangle, weights)


def conforming_faces(surfaces: Surfaces, tree: PatchTree) -> Faces:
    """Faces of the baked meshes in which every vertex on an edge is a corner of the faces on both sides.

    Leaves next to leaves two levels finer are split first; what is left has at most one vertex on an edge, and is cut
    into two, three or four triangles from there (red-green closure; Bank, Sherman & Weiser 1983). The tree given is not
    changed.
    """
    tree = tree.copy()
    while True:
        leaves = tree.leaves()
        leaves = leaves[surfaces.baked[tree.triangle[leaves]]]
        middles = _edge_middles(tree, tree.corners[leaves])
        uneven = _twice_halved(tree, tree.corners[leaves], middles)
        if not uneven.any():
            return _closed_by_templates(tree, leaves, middles)
        tree.split(leaves[uneven])


def _edge_middles(tree: PatchTree, corners: Ints) -> Ints:
    """Midpoints of the edges 0-1, 1-2, 2-0, -1 where there is none, (m, 3)."""
    return tree.midpoints(corners, np.roll(corners, -1, axis=1))


def _twice_halved(tree: PatchTree, corners: Ints, middles: Ints) -> np.ndarray:
    """Whether half of an edge has a midpoint of its own, (m,) bool."""
    present = middles >= 0
    middle = np.where(present, middles, corners)
    first = tree.midpoints(corners, middle) >= 0
    second = tree.midpoints(middle, np.roll(corners, -1, axis=1)) >= 0
    return (present & (first | second)).any(axis=1)


# Triangles of a leaf by the edges that have a midpoint (bit 0: 0-1, bit 1: 1-2, bit 2: 2-0). Points 0 to 2 are the
# corners, 3 to 5 the midpoints of 0-1, 1-2, 2-0. Two midpoints leave a quadrilateral, cut along either diagonal.
_M01, _M12, _M20 = 3, 4, 5
TEMPLATES: dict[int, tuple[tuple[int, int, int], ...]] = {
    0: ((0, 1, 2),),
    1: ((0, _M01, 2), (_M01, 1, 2)),
    2: ((1, _M12, 0), (_M12, 2, 0)),
    4: ((2, _M20, 1), (_M20, 0, 1)),
    3: ((_M01, 1, _M12), (0, _M01, _M12), (0, _M12, 2)),
    6: ((_M12, 2, _M20), (1, _M12, _M20), (1, _M20, 0)),
    5: ((_M20, 0, _M01), (2, _M20, _M01), (2, _M01, 1)),
    7: ((0, _M01, _M20), (_M01, 1, _M12), (_M20, _M12, 2), (_M12, _M20, _M01)),
}
OTHER_DIAGONAL: dict[int, tuple[tuple[int, int, int], ...]] = {
    3: ((_M01, 1, _M12), (0, _M01, 2), (_M01, _M12, 2)),
    6: ((_M12, 2, _M20), (1, _M12, 0), (_M12, _M20, 0)),
    5: ((_M20, 0, _M01), (2, _M20, 1), (_M20, _M01, 1)),
}
DIAGONALS = {3: ((0, _M12), (_M01, 2)), 6: ((1, _M20), (_M12, 0)), 5: ((2, _M01), (_M20, 1))}


def _closed_by_templates(tree: PatchTree, leaves: Ints, middles: Ints) -> Faces:
    points = np.concatenate([tree.corners[leaves], middles], axis=1)
    w = tree.weights[leaves]
    weights = np.concatenate([w, (w + np.roll(w, -1, axis=1)) / 2.0], axis=1)
    code = ((middles >= 0) * np.array([1, 2, 4])).sum(axis=1)
    corners_out, triangle_out, weights_out, order = [], [], [], []
    for bits, template in TEMPLATES.items():
        chosen = np.flatnonzero(code == bits)
        groups = [(chosen, template)]
        if bits in OTHER_DIAGONAL:
            (a, b), (c, d) = DIAGONALS[bits]
            first = _distance(tree, points[chosen, a], points[chosen, b])
            shorter = _distance(tree, points[chosen, c], points[chosen, d]) < first
            groups = [(chosen[~shorter], template), (chosen[shorter], OTHER_DIAGONAL[bits])]
        for members, pieces in groups:
            for piece in pieces:
                corners_out.append(points[members][:, piece])
                triangle_out.append(tree.triangle[leaves[members]])
                weights_out.append(weights[members][:, piece])
                order.append(members)
    rank = np.argsort(np.concatenate(order), kind="stable")
    return Faces(
        tree.points,
        tree.place_of_point,
        tree.mesh_of_point,
        np.concatenate(corners_out)[rank],
        np.concatenate(triangle_out)[rank],
        np.concatenate(weights_out)[rank],
    )


def _distance(tree: PatchTree, a: Ints, b: Ints) -> Floats:
    return np.linalg.norm(tree.points[a] - tree.points[b], axis=1)
