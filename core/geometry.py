# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Triangles, edges and connected pieces of meshes, as array operations."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from .scene import Floats, Ints

WELD_CELLS = 2**20
"""Vertices that fall into the same cell of a grid this fine over a mesh count as one (1e-6 of its size)."""

FARTHEST = 512.0
"""Reaches of the nearer half of all points from their median, up to which others count for the size of the whole: what
one stray face that goes farther leaves of single precision is not enough for a room."""

MOST = 7.0 / 8.0
"""Share of all points that count for it, however far they reach: what is far and of many faces is no stray one."""

ENOUGH_POINTS = 100_000
"""Points that tell as well as all of them how far they reach."""


def cross(a: Floats, b: Floats) -> Floats:
    """Cross products of vectors (n, 3), (n, 3)."""
    result = np.empty_like(a)
    for i, j, k in ((0, 1, 2), (1, 2, 0), (2, 0, 1)):
        result[:, i] = a[:, j] * b[:, k] - a[:, k] * b[:, j]
    return result


def lengths(vectors: Floats) -> Floats:
    """Lengths of vectors along the last axis."""
    result: Floats = np.sqrt(np.einsum("...x,...x->...", vectors, vectors))
    return result


def triangle_cross(points: Floats, triangles: Ints) -> Floats:
    """Cross product of the first two edges of each triangle, (t, 3): the normal times twice the area."""
    a, b, c = (points[triangles[:, k]] for k in range(3))
    return cross(b - a, c - a)


def triangle_areas(corners: Floats) -> Floats:
    """Areas of triangles from their corners (t, 3, 3), (t,)."""
    return lengths(cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])) / 2.0


def frame(points: Floats, share: float = MOST) -> tuple[Floats, float]:
    """Centre (3,) and extent of the cube around points (n, 3) for which single precision is to do.

    That of all, unless all but a `share` lie so far away that the others would be a speck in it (`FARTHEST`).
    """
    if len(points) == 0:
        return np.zeros(3), 0.0
    low, high = points.min(axis=0), points.max(axis=0)
    extent = float((high - low).max())
    some = points[:: 1 + len(points) // ENOUGH_POINTS]
    middle = np.median(some, axis=0)
    half, most = (len(some) - 1) // 2, int(share * (len(some) - 1))
    reach = np.partition(np.abs(some - middle).max(axis=1), [half, most])
    wanted = 2.0 * max(FARTHEST * float(reach[half]), float(reach[most]))
    return (middle, wanted) if 0.0 < wanted < extent else ((low + high) / 2.0, extent)


def weights_in(triangles: Floats, points: Floats) -> Floats:
    """Barycentric coordinates of points (n, k, 3) in triangles (n, 3, 3), (n, k, 3)."""
    corner, e1, e2 = triangles[:, 0], triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0]
    normal = cross(e1, e2)
    square = np.einsum("nx,nx->n", normal, normal)[:, None]
    way = points - corner[:, None]
    b = np.einsum("nkx,nx->nk", way, cross(e2, normal)) / square
    c = np.einsum("nkx,nx->nk", way, cross(normal, e1)) / square
    return np.stack([1.0 - b - c, b, c], axis=-1)


def normalized(vectors: Floats) -> Floats:
    """Vectors of length 1 along the last axis; the zero vector stays zero."""
    length = lengths(vectors)
    length[length == 0.0] = 1.0
    result: Floats = vectors / length[..., None]
    return result


def corner_angles(corners: Floats) -> Floats:
    """Angles at the corners of triangles (t, 3, 3), (t, 3), radians."""
    along = np.roll(corners, -1, axis=1) - corners
    back = -np.roll(along, 1, axis=1)
    across = lengths(np.cross(along, back))
    result: Floats = np.arctan2(across, np.einsum("tkx,tkx->tk", along, back))
    return result


def edge_lengths(points: Floats, triangles: Ints) -> Floats:
    """Lengths of the edges 0-1, 1-2 and 2-0 of each triangle, (t, 3)."""
    start = np.ascontiguousarray(triangles.T)
    square = np.zeros(start.shape)
    for coordinate in points.T:
        at = np.ascontiguousarray(coordinate)[start]
        for k in range(3):
            square[k] += (at[(k + 1) % 3] - at[k]) ** 2
    return np.sqrt(square).T


def largest_edges(points: Floats, triangles: Ints) -> Floats:
    """Length of the longest edge of each triangle, (t,)."""
    a, b, c = edge_lengths(points, triangles).T
    longest: Floats = np.maximum(np.maximum(a, b), c)
    return longest


def welded(points: Floats) -> Ints:
    """For each vertex the lowest index of a vertex at the same place, (v,).

    Positions are compared on a grid of `WELD_CELLS` over the extent of their `frame`, so seams that were split in the
    data are one place here.
    """
    if len(points) == 0:
        return np.zeros(0, dtype=np.int64)
    low = points.min(axis=0)
    # Of a small mesh, the three corners of a stray face are many.
    _, extent = frame(points, 0.5)
    # Numbers of cells stay whole as float64, however far away some are.
    cells = np.rint((points - low) * (WELD_CELLS / extent if extent > 0.0 else 0.0))
    if cells.max() > WELD_CELLS:
        _, first, inverse = np.unique(cells, axis=0, return_index=True, return_inverse=True)
        inverse = inverse.ravel()
    else:
        number = cells.astype(np.int64)
        key = (number[:, 0] * (WELD_CELLS + 1) + number[:, 1]) * (WELD_CELLS + 1) + number[:, 2]
        _, first, inverse = np.unique(key, return_index=True, return_inverse=True)
    result: Ints = first[inverse].astype(np.int64)
    return result


def connected_components(pairs: Ints, count: int) -> Ints:
    """Label each of `count` things joined by `pairs` (m, 2) with the lowest member of its component, (count,)."""
    label = np.arange(count, dtype=np.int64)
    while True:
        ends = label[pairs]
        low, high = ends.min(axis=1), ends.max(axis=1)
        differ = low != high
        if not differ.any():
            return label
        np.minimum.at(label, high[differ], low[differ])
        while True:
            jumped = label[label]
            if np.array_equal(jumped, label):
                break
            label = jumped


def triangle_shells(triangles: Ints, vertex_count: int) -> tuple[Ints, NDArray[np.bool_]]:
    """Split triangles into shells: pieces connected by vertices.

    Parameters
    ----------
    triangles : (t, 3) int
        Welded vertex indices.

    Returns
    -------
    shell_of_triangle : (t,) int
        Numbered from 0 in order of first appearance of their lowest vertex.
    closed : (shells,) bool
        Whether every edge of the shell joins exactly two triangles that run through it in opposite directions: then
        the shell has an inside.
    """
    pairs = np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]]])
    label = connected_components(pairs, vertex_count)[triangles[:, 0]]
    _, shell = np.unique(label, return_inverse=True)
    shell = shell.astype(np.int64)
    start, end = triangles.ravel(), np.roll(triangles, -1, axis=1).ravel()
    directed, count = np.unique(start * vertex_count + end, return_counts=True)
    place = np.searchsorted(directed, end * vertex_count + start)
    place = np.minimum(place, len(directed) - 1)
    own = np.searchsorted(directed, start * vertex_count + end)
    matched = (directed[place] == end * vertex_count + start) & (count[place] == 1) & (count[own] == 1)
    shells = int(shell.max()) + 1 if len(shell) else 0
    open_edges = np.bincount(np.repeat(shell, 3), weights=~matched, minlength=shells)
    return shell, open_edges == 0


def along_curve(points: Floats) -> Ints:
    """Numbers by which points (n, 3) lie along a curve that fills their bounding box (Morton 1966), (n,)."""
    if len(points) == 0:
        return np.zeros(0, dtype=np.int64)
    low = points.min(axis=0)
    extent = max(float((points.max(axis=0) - low).max()), np.finfo(np.float64).tiny)
    code = np.zeros(len(points), dtype=np.int64)
    for axis in range(3):
        bits = np.minimum((points[:, axis] - low[axis]) / extent * 2**21, 2**21 - 1).astype(np.int64)
        # Each step doubles the gaps between groups of bits, until two zeros follow each bit.
        for shift, mask in (
            (32, 0x1F00000000FFFF),
            (16, 0x1F0000FF0000FF),
            (8, 0x100F00F00F00F00F),
            (4, 0x10C30C30C30C30C3),
            (2, 0x1249249249249249),
        ):
            bits = (bits | bits << shift) & mask
        code |= bits << axis
    return code


def order_along_curve(points: Floats) -> Ints:
    """Order of points in which neighbours mostly lie close together, (n,)."""
    return np.argsort(along_curve(points), kind="stable")


def side_normals(normals: Floats, sides: Ints | NDArray[np.bool_]) -> Floats:
    """Normals turned over where the side is the back (1)."""
    return normals * np.where(sides == 1, -1.0, 1.0)[:, None]
