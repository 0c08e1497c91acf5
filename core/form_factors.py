# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Form factors in closed form: from a point to a triangle, cut at the point's horizon."""

from __future__ import annotations

import numpy as np

from .scene import Floats, Ints

PAIRS_AT_ONCE = 2**14
"""Pairs whose working arrays stay in a core's second cache."""


def point_to_triangle(points: Floats, normals: Floats, triangles: Floats) -> Floats:
    """Form factor from a surface element to a triangle, without occlusion.

    Parameters
    ----------
    points : (..., 3) float
    normals : (..., 3) float, unit
    triangles : (..., 3, 3) float
        Corner positions; either winding.

    Returns
    -------
    (...) float, 0 to 1
    """
    shape = np.broadcast_shapes(points.shape[:-1], normals.shape[:-1], triangles.shape[:-2])
    corners = np.broadcast_to(triangles - points[..., None, :], (*shape, 3, 3)).reshape(-1, 3, 3)
    axes = np.broadcast_to(normals, (*shape, 3)).reshape(-1, 3)
    factor = np.empty(len(corners))
    for first in range(0, len(corners), PAIRS_AT_ONCE):
        part = slice(first, first + PAIRS_AT_ONCE)
        corner, axis = np.ascontiguousarray(corners[part].transpose(1, 2, 0)), np.ascontiguousarray(axes[part].T)
        owner, pieces = above_horizon(corner, heights_of(corner, axis))
        factor[part] = np.bincount(owner, weights=piece_factor(pieces, axis[:, owner]), minlength=corner.shape[2])
    return np.minimum(factor, 1.0).reshape(shape)


def heights_of(corners: Floats, normals: Floats) -> Floats:
    """Heights of triangles' corners (3, 3, m), as seen from points with normals (3, m), over the horizon, (3, m)."""
    height: Floats = corners[:, 0] * normals[0] + corners[:, 1] * normals[1] + corners[:, 2] * normals[2]
    return height


def above_horizon(corners: Floats, height: Floats) -> tuple[Ints, Floats]:
    """Cut triangles at the horizon: what is above it, as triangles.

    Parameters
    ----------
    corners : (3, 3, m) float
        Corner, coordinate, triangle: as seen from the point.
    height : (3, m) float
        Of the corners over the horizon.

    Returns
    -------
    owner : (p,) int, ascending
        The triangle that each piece is of: one, two or none of each.
    pieces : (3, 3, p) float
        Of the winding of their triangles.
    """
    below = height < 0.0
    count = below[0].astype(np.int8) + below[1] + below[2]
    if not count.any():
        return np.arange(corners.shape[2]), corners
    whole, most, least = np.flatnonzero(count == 0), np.flatnonzero(count == 1), np.flatnonzero(count == 2)
    # Turn the triangle so that the corner that is alone on its side comes first.
    alone, b, c = _turned(corners, height, most, np.argmax(below[:, most], axis=0))
    ab, ac = _where_it_crosses(alone, b), _where_it_crosses(alone, c)
    one, other = np.stack([ab, b[:3], c[:3]]), np.stack([ab, c[:3], ac])
    tip, b, c = _turned(corners, height, least, np.argmin(below[:, least], axis=0))
    last = np.stack([tip[:3], _where_it_crosses(tip, b), _where_it_crosses(tip, c)])
    owner = np.concatenate([whole, most, most, least])
    pieces = np.concatenate([corners.take(whole, axis=2), one, other, last], axis=2)
    order = np.argsort(owner, kind="stable")
    return owner[order], pieces.take(order, axis=2)


def _turned(corners: Floats, height: Floats, which: Ints, first: Ints) -> list[Floats]:
    """The corners of some triangles from `first` (k,) on, each with its height as a fourth coordinate, (4, k)."""
    turned = []
    for step in range(3):
        k = (first + step) % 3
        turned.append(np.concatenate([corners[k, :, which].T, height[k, which][None]]))
    return turned


def _where_it_crosses(start: Floats, end: Floats) -> Floats:
    crossing: Floats = start[:3] + (end[:3] - start[:3]) * (start[3] / (start[3] - end[3]))
    return crossing


def piece_factor(pieces: Floats, normals: Floats) -> Floats:
    """Form factor from points to triangles wholly above their horizons.

    Lambert's formula, F = 1/(2 pi) sum over edges of the angle an edge subtends times the cosine between the normal and
    the plane through the edge (Lambert 1760; Baum, Rushmeier & Winget 1989, eq. 8).

    Parameters
    ----------
    pieces : (3, 3, m) float
        Corner, coordinate, triangle: as seen from the point; either winding.
    normals : (3, m) float, unit

    Returns
    -------
    (m,) float, 0 to 1
    """
    total = np.zeros(pieces.shape[2])
    for (ax, ay, az), (bx, by, bz) in zip(pieces, pieces[[1, 2, 0]], strict=True):
        x, y, z = ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx
        length = np.sqrt(x * x + y * y + z * z)
        along = x * normals[0] + y * normals[1] + z * normals[2]
        along *= np.arctan2(length, ax * bx + ay * by + az * bz)
        # Where the corners are in line with the point there is no plane, and nothing to add.
        total += along / np.maximum(length, np.finfo(np.float64).tiny)
    return np.minimum(np.abs(total) / (2.0 * np.pi), 1.0)
