# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Where light is gathered: one receiver for all face corners that share a place, a shading normal and a side."""

from __future__ import annotations

from dataclasses import dataclass, fields
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .geometry import largest_edges, lengths, normalized, side_normals
from .lit_points import LitPoints
from .scene import Floats, Ints
from .subdivision import Faces
from .surfaces import Surfaces
from .terminator import rises
from .visibility import OFFSET

NORMAL_CELLS = 1024
"""Shading normals closer than about 1/1024 count as one: corners of a smooth or flat surface share a value, corners on
the two sides of a hard edge do not."""

NORMALS = (2 * NORMAL_CELLS + 1) ** 3
"""Normals that are told apart at one vertex."""

CODES_OF_VERTEX = 2 * NORMALS
"""Of the shading normals that faces share, and of the faces' own in a steep fold."""

STEEP = 0.5
"""Cosine between the shading normal and a face's own below which the faces around a vertex get light each by itself: in
such a fold, what stands upright on the mean of all faces is behind some of them."""

BORDER = 0.05
"""A vertex surely lies inside its surface when the mean way to the middles of its faces is less than this share of
their mean distance; on a straight border of even faces it is about 0.5, and still 0.1 where two slender ones meet."""

INWARD = 0.02
"""Share of the way from a vertex towards the middle of its faces at which light is gathered: a vertex on the border of
a face may lie in the plane of the next wall, where no ray can tell the two sides apart."""

LEAST_WAY = 16.0 * OFFSET
"""The least way in a steep fold, in extents of the scene: rays, which start off the face, shall not start behind the
face across, for folds that open by 4 degrees or more."""


@dataclass(frozen=True, eq=False)
class Receivers:
    """Points that light is gathered at.

    Attributes
    ----------
    points, normals, lift : (n, 3) float
        Position, shading normal (the axis of the hemisphere) and unit normal of the surface itself.
    rise : (n, 3) float, scene units
        How far the curved surface that smooth faces stand for lies above them, and
    grazing : (n,) float
        cosine below which light is grazing there, see `core.terminator`.
    codes : (n,) int, ascending
        Numbers that tell the place, normal and side: equal for the same receiver of another subdivision.
    inward : (n, 3) float, scene units
        How far the position is off the vertex.
    sizes : (n,) float, scene units
        Mean longest edge of the faces around.
    mesh, shell : (n,) int
        That each lies on.
    of_corner : (f, 3) int
        The receiver of each face corner, for the face sides given.
    """

    points: Floats
    normals: Floats
    lift: Floats
    rise: Floats
    grazing: Floats
    codes: Ints
    inward: Floats
    sizes: Floats
    mesh: Ints
    shell: Ints
    of_corner: Ints

    def vertices(self) -> Ints:
        """The vertex of the faces that each is at, (n,)."""
        return self.codes // CODES_OF_VERTEX

    def lit_points(self, which: Ints | slice) -> LitPoints:
        """Some of the receivers as points that get light, all with the same sampling pattern."""
        mesh = self.mesh[which]
        of_face = self.normals[which], self.lift[which], self.rise[which], self.grazing[which]
        return LitPoints(self.points[which], *of_face, np.zeros(len(mesh), dtype=np.int64), mesh)

    def taken(self, which: Ints) -> Receivers:
        """Some of the receivers, without faces."""
        values = {field.name: getattr(self, field.name)[which] for field in fields(self) if field.name != "of_corner"}
        return Receivers(**values, of_corner=np.zeros((0, 3), dtype=np.int64))

    def joined(self, others: Receivers, which: Ints) -> Receivers:
        """Some of these receivers and of others, which are counted on from these; without faces."""
        values = {
            field.name: taken_of_two(getattr(self, field.name), getattr(others, field.name), which)
            for field in fields(self)
            if field.name != "of_corner"
        }
        return Receivers(**values, of_corner=np.zeros((0, 3), dtype=np.int64))


def taken_of_two(one: Any, other: Any, which: Ints) -> Any:
    """Rows of two arrays, those of the other counted on from those of the one."""
    if len(one) == 0:
        return other[which]
    rows = np.take(one, np.minimum(which, len(one) - 1), axis=0)
    behind = np.flatnonzero(which >= len(one))
    rows[behind] = other[which[behind] - len(one)]
    return rows


def receivers(surfaces: Surfaces, faces: Faces, face_of_side: Ints, side: Ints) -> Receivers:
    """Group the corners of face sides into receivers.

    Parameters
    ----------
    face_of_side : (f,) int
    side : (f,) int
        The faces and their sides (1: the back) that want values.
    """
    corners, points = faces.corners[face_of_side], faces.points
    triangle, weights = faces.triangle[face_of_side], faces.weights[face_of_side]
    shading = side_normals(faces.corner_normals(surfaces)[face_of_side].reshape(-1, 3), np.repeat(side, 3))
    geometric = np.repeat(side_normals(surfaces.normals[triangle], side), 3, axis=0)
    at = points[corners]
    toward = (((at[:, 0] + at[:, 1] + at[:, 2]) / 3.0)[:, None] - at).reshape(-1, 3)

    vertex = faces.vertices[face_of_side].ravel()
    codes = vertex * CODES_OF_VERTEX + _normal_codes(shading)
    groups = np.unique(codes, return_index=True, return_inverse=True)
    aside = _on_border(toward, groups[2], len(groups[0]))[groups[2]]
    steep = np.einsum("cx,cx->c", shading, geometric) < STEEP
    if steep.any():
        steep = np.isin(codes, codes[steep])
        codes[steep] = vertex[steep] * CODES_OF_VERTEX + NORMALS + _normal_codes(geometric[steep])
        aside |= steep
        groups = np.unique(codes, return_index=True, return_inverse=True)
    codes, first, group = groups
    count = len(first)

    def mean(values: Floats) -> Floats:
        return _means(values, group, count)

    normals, lift = normalized(mean(shading)), normalized(mean(geometric))
    # Of a dense mesh these are large, and what follows takes as much again.
    del shading, geometric
    share = np.where(aside, INWARD, 0.0)
    share[steep] = np.clip(LEAST_WAY * surfaces.extent / lengths(toward[steep]), INWARD, 1.0)
    asked = weights + share.reshape(-1, 3, 1) * (weights.mean(axis=1, keepdims=True) - weights)
    rise = mean(rises(surfaces, np.repeat(triangle, 3), np.repeat(side, 3), asked.reshape(-1, 3)))
    mesh, shell = (of[triangle][first // 3] for of in (surfaces.mesh_of_triangle, surfaces.shell_of_triangle))
    position = points[corners.ravel()[first]]
    inward = (share[:, None] * toward)[_most_in_the_middle(toward, mean(toward), group, count)]
    size = largest_edges(points, corners)
    return Receivers(
        position + inward,
        normals,
        lift,
        rise,
        surfaces.grazing[mesh],
        codes,
        inward,
        np.bincount(group, weights=np.repeat(size, 3), minlength=count) / np.bincount(group, minlength=count),
        mesh,
        shell,
        group.reshape(-1, 3),
    )


def _means(values: Floats, group: Ints, count: int) -> Floats:
    """Mean of values (c, 3) over each group, (count, 3)."""
    total = np.stack([np.bincount(group, weights=values[:, k], minlength=count) for k in range(3)], axis=1)
    return total / np.bincount(group, minlength=count)[:, None]


def _on_border(toward: Floats, group: Ints, count: int) -> NDArray[np.bool_]:
    """Which vertices lie on a border, (count,) bool.

    That is not in the middle of their faces, and, as uneven faces may surround a vertex, at the end of an edge that one
    face alone has.

    Parameters
    ----------
    toward : (c, 3) float
        From the vertex of each face corner to the middle of the face.
    group : (c,) int
    """
    length = np.bincount(group, weights=lengths(toward), minlength=count) / np.bincount(group, minlength=count)
    candidates = lengths(_means(toward, group, count)) > BORDER * length
    of_corner = group.reshape(-1, 3)
    following = np.roll(of_corner, -1, axis=1)
    both = candidates[of_corner] & candidates[following]
    key = (np.minimum(of_corner, following)[both] << 32) | np.maximum(of_corner, following)[both]
    edges, faces_beside = np.unique(key, return_counts=True)
    alone = edges[faces_beside == 1]
    result = np.zeros(count, dtype=bool)
    result[alone >> 32] = True
    result[alone & 0xFFFFFFFF] = True
    return result


def _normal_codes(normals: Floats) -> Ints:
    """Numbers below `NORMALS` that are equal for about the same normal, (c,)."""
    codes = np.zeros(len(normals), dtype=np.int64)
    for coordinate in normals.T:
        codes = codes * (2 * NORMAL_CELLS + 1) + (np.rint(coordinate * NORMAL_CELLS).astype(np.int64) + NORMAL_CELLS)
    return codes


def _most_in_the_middle(toward: Floats, mean: Floats, group: Ints, count: int) -> Ints:
    """The corner of each vertex whose face lies most in the middle of its faces, (count,).

    The mean of the ways into several faces would end below a hollow or a bulge.

    Parameters
    ----------
    toward : (c, 3) float
        From the vertex of each face corner to the middle of the face.
    mean : (count, 3) float
        Its mean over each group.
    group : (c,) int
    """
    along = np.einsum("cx,cx->c", toward, mean[group])
    best = np.full(count, -np.inf)
    np.maximum.at(best, group, along)
    chosen = np.flatnonzero(along == best[group])
    corner = np.zeros(count, dtype=np.int64)
    corner[group[chosen[::-1]]] = chosen[::-1]
    return corner
