# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Form factors in closed form: from a point to a triangle, cut at the point's horizon."""

from __future__ import annotations

import numpy as np

from .scene import Floats


def point_to_triangle(points: Floats, normals: Floats, triangles: Floats) -> Floats:
    """Form factor from a surface element to a triangle, without occlusion.

    Lambert's formula, F = 1/(2 pi) sum over edges of the angle an edge subtends times the cosine between the normal and
    the plane through the edge (Lambert 1760; Baum, Rushmeier & Winget 1989, eq. 8), summed over the part of the
    triangle above the horizon.

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
    corners = triangles - points[..., None, :]
    height = np.einsum("...kx,...x->...k", corners, normals)
    ends = np.roll(corners, -1, axis=-2)
    end_height = np.roll(height, -1, axis=-1)
    crossing = (height >= 0.0) != (end_height >= 0.0)
    span = np.where(crossing, height - end_height, 1.0)
    cut = corners + (ends - corners) * np.where(crossing, height / span, 0.0)[..., None]
    below, end_below = height < 0.0, end_height < 0.0
    start = np.where((below & ~end_below)[..., None], cut, corners)
    end = np.where((~below & end_below)[..., None], cut, ends)
    total = np.where(below & end_below, 0.0, _edge_term(start, end, normals[..., None, :])).sum(axis=-1)
    # What is left of a cut triangle is closed by a piece of the horizon, from where its edge goes down to where one
    # comes up again.
    down = np.where((~below & end_below)[..., None], cut, 0.0).sum(axis=-2)
    up = np.where((below & ~end_below)[..., None], cut, 0.0).sum(axis=-2)
    total = total + np.where(crossing.any(axis=-1), _edge_term(down, up, normals), 0.0)
    return np.clip(np.abs(total) / (2.0 * np.pi), 0.0, 1.0)


def _edge_term(start: Floats, end: Floats, normal: Floats) -> Floats:
    """Angle between two vectors times the normal's component along their cross product's direction, (...)."""
    across = np.cross(start, end)
    length = np.sqrt(np.einsum("...x,...x->...", across, across))
    angle = np.arctan2(length, np.einsum("...x,...x->...", start, end))
    along = np.einsum("...x,...x->...", across, normal)
    result: Floats = np.divide(angle * along, length, out=np.zeros_like(length), where=length > 0.0)
    return result
