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

NORMAL_CELLS = 1024
"""Shading normals closer than about 1/1024 count as one: corners of a smooth or flat surface share a value, corners on
the two sides of a hard edge do not."""

CODES_OF_VERTEX = (2 * NORMAL_CELLS + 1) ** 3
"""Normals that are told apart at one vertex."""

BORDER = 0.05
"""A vertex surely lies inside its surface when the mean way to the middles of its faces is less than this share of
their mean distance; on a straight border of even faces it is about 0.5, and still 0.1 where two slender ones meet."""

INWARD = 0.02
"""Share of the way from a vertex towards the middle of its faces at which light is gathered: a vertex on the border of
a face may lie in the plane of the next wall, where no ray can tell the two sides apart."""


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
    mesh : (n,) int
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
    shading = side_normals(faces.corner_normals(surfaces)[face_of_side].reshape(-1, 3), np.repeat(side, 3))
    codes, first, group = np.unique(
        _codes(faces.vertices[face_of_side].ravel(), shading), return_index=True, return_inverse=True
    )
    count = len(first)

    def mean(values: Floats) -> Floats:
        total = np.stack([np.bincount(group, weights=values[:, k], minlength=count) for k in range(3)], axis=1)
        return total / np.bincount(group, minlength=count)[:, None]

    normals = normalized(mean(shading))
    # Of a dense mesh these are large, and what follows takes as much again.
    del shading
    geometric = side_normals(surfaces.normals[faces.triangle[face_of_side]], side)
    lift = normalized(mean(np.repeat(geometric, 3, axis=0)))
    triangle = faces.triangle[face_of_side]
    corner_sides, of_corner = np.repeat(side, 3), np.repeat(triangle, 3)
    rise = mean(rises(surfaces, of_corner, corner_sides, faces.weights[face_of_side].reshape(-1, 3)))
    mesh = surfaces.mesh_of_triangle[triangle][first // 3]
    position = points[corners.ravel()[first]]
    at = points[corners]
    toward = (((at[:, 0] + at[:, 1] + at[:, 2]) / 3.0)[:, None] - at).reshape(-1, 3)
    inward = _into_a_face(toward, mean(toward), group, count)
    inward[~_on_border(group.reshape(-1, 3), inward.any(axis=1))] = 0.0
    size = largest_edges(points, corners)
    return Receivers(
        position + INWARD * inward,
        normals,
        lift,
        rise,
        surfaces.grazing[mesh],
        codes,
        INWARD * inward,
        np.bincount(group, weights=np.repeat(size, 3), minlength=count) / np.bincount(group, minlength=count),
        mesh,
        group.reshape(-1, 3),
    )


def _on_border(of_corner: Ints, candidates: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Which candidates (n,) end an edge that one face alone has: uneven faces may surround a vertex, too."""
    following = np.roll(of_corner, -1, axis=1)
    both = candidates[of_corner] & candidates[following]
    key = (np.minimum(of_corner, following)[both] << 32) | np.maximum(of_corner, following)[both]
    edges, faces_beside = np.unique(key, return_counts=True)
    alone = edges[faces_beside == 1]
    result = np.zeros(len(candidates), dtype=bool)
    result[alone >> 32] = True
    result[alone & 0xFFFFFFFF] = True
    return result


def _codes(vertices: Ints, shading: Floats) -> Ints:
    """Numbers that are equal for the same vertex and about the same shading normal, (c,)."""
    span = 2 * NORMAL_CELLS + 1
    codes = vertices
    for coordinate in shading.T:
        codes = codes * span + (np.rint(coordinate * NORMAL_CELLS).astype(np.int64) + NORMAL_CELLS)
    return codes


def _into_a_face(toward: Floats, mean: Floats, group: Ints, count: int) -> Floats:
    """Way from each vertex into the face that lies most in the middle of its faces, (count, 3).

    It ends on that face itself: the mean of several would lie below a hollow or a bulge. Zero where the faces surround
    the vertex, which is then no border.

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
    face = np.zeros(count, dtype=np.int64)
    face[group[chosen[::-1]]] = chosen[::-1]
    length = np.bincount(group, weights=lengths(toward), minlength=count) / np.bincount(group, minlength=count)
    border = lengths(mean) > BORDER * length
    return np.where(border[:, None], toward[face], 0.0)
