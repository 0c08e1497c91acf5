# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Values carried from a mesh with modifiers to the face corners of the mesh without."""

from collections.abc import Mapping

import numpy as np
from mathutils.bvhtree import BVHTree

from ..core.scene import Floats, Ints
from .local_mesh import LocalMesh

_INWARDS = 1e-3
"""Share of the way from a corner to its triangle's centre at which it is looked up: at the corner itself the triangles
of all the faces that meet there are equally near."""
_SAME_SIDE = 0.5
"""Cosine above which two surfaces count as facing the same way (60 degrees)."""
_WIDER = 1.5
"""How much farther than the nearest surface one that faces the right way may lie, as a factor ..."""
_SOME_WAY = 0.02
"""... and as a share of the mesh's extent."""


def nearest_corners(base: LocalMesh, evaluated: LocalMesh, values: Mapping[str, Floats]) -> dict[str, Floats]:
    """Return values for each face corner of `base`, from the nearest point of `evaluated` that faces the same way.

    Parameters
    ----------
    values : mapping of str to (t, 3, 3) float
        Values at the corners of the triangles of `evaluated`.

    Returns
    -------
    mapping of str to (c, 3) float
    """
    count = len(base.vertex_of_corner)
    corners = base.corners.reshape(-1)
    corner, first = np.unique(corners, return_index=True)
    positions = base.vertices[base.triangles]
    with np.errstate(invalid="ignore"):  # of corners that lie nowhere
        inside = positions + _INWARDS * (positions.mean(axis=1, keepdims=True) - positions)
    triangle, weights = _look_up(inside.reshape(-1, 3)[first], base.normals.reshape(-1, 3)[first], evaluated)
    carried = {}
    for name, colours in values.items():
        carried[name] = np.zeros((count, 3))
        carried[name][corner] = np.einsum("nk,nkc->nc", weights, colours[triangle])
    return carried


def _look_up(points: Floats, normals: Floats, mesh: LocalMesh) -> tuple[Ints, Floats]:
    """Return the triangle (n,) nearest to each point on the side of its normal, and barycentric weights (n, 3).

    The weights are 0 where there is none, as of points that are no numbers.
    """
    # A corner that is no number would be no farther from any point than all others.
    sound = np.flatnonzero(np.isfinite(mesh.vertices[mesh.triangles]).all(axis=(1, 2)))
    corners = mesh.vertices[mesh.triangles[sound]]
    tree = BVHTree.FromPolygons(
        corners.reshape(-1, 3).tolist(), np.arange(3 * len(sound)).reshape(-1, 3).tolist(), all_triangles=True
    )
    some_way = _SOME_WAY * float(np.linalg.norm(np.ptp(corners.reshape(-1, 3), axis=0))) if len(sound) else 0.0
    facing = mesh.normals[sound].mean(axis=1, dtype=np.float64)
    triangle, weights = np.zeros(len(points), dtype=np.int64), np.zeros((len(points), 3))
    location = np.empty((len(points), 3))
    near = []
    for index in np.flatnonzero(np.isfinite(points).all(axis=1)).tolist():
        point, normal = points[index].tolist(), normals[index]
        found = tree.find_nearest(point)
        if found[2] is None:
            continue
        if facing[found[2]] @ normal < _SAME_SIDE:
            others = tree.find_nearest_range(point, _WIDER * found[3] + some_way)
            same_side = [other for other in others if facing[other[2]] @ normal >= _SAME_SIDE]
            found = min(same_side, key=lambda other: other[3], default=found)
        location[index], triangle[index] = found[0], found[2]
        near.append(index)
    weights[near] = _barycentric(location[near], corners[triangle[near]])
    return sound[triangle] if len(sound) else triangle, weights


def _barycentric(points: Floats, triangles: Floats) -> Floats:
    """Return the weights (n, 3) of the corners at points on their triangles; thirds on a triangle without area."""
    a, b, c = triangles[:, 0], triangles[:, 1], triangles[:, 2]
    normal = np.cross(b - a, c - a)
    area = np.einsum("ij,ij->i", normal, normal)
    weights = np.stack(
        [
            np.einsum("ij,ij->i", np.cross(c - b, points - b), normal),
            np.einsum("ij,ij->i", np.cross(a - c, points - c), normal),
            np.einsum("ij,ij->i", np.cross(b - a, points - a), normal),
        ],
        axis=1,
    )
    weights = np.divide(weights, area[:, None], out=np.full_like(weights, 1.0 / 3.0), where=area[:, None] > 0.0)
    weights = np.clip(weights, 0.0, 1.0)
    return weights / weights.sum(axis=1, keepdims=True)
