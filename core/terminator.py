# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Where a smooth mesh begins to shade itself: not at the edges of faces, but as the curved surface that it stands for.

A face that is shaded smooth stands for a curved surface above it. Grazing light reaches this surface where it does not
reach the face, which is turned away, so that shadow rays start above the face there, as in Cycles.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from .geometry import lengths, side_normals
from .lit_points import LitPoints
from .sampling import Singles
from .scene import Floats, Ints
from .surfaces import Surfaces
from .visibility import OFFSET, RayScene

Arrived = NDArray[np.bool_] | Singles

EDGES = ((0, 1), (1, 2), (2, 0))


def rises(surfaces: Surfaces, triangle: Ints, side: Ints, weights: Floats) -> Floats:
    """How far the surface that is meant lies above places on sides of triangles, (n, 3), scene units.

    Zero on flat faces, and at the corners of smooth ones that bulge.

    Parameters
    ----------
    triangle, side : (n,) int
    weights : (n, 3) float
        Barycentric coordinates.
    """
    bent = np.flatnonzero(surfaces.stands_for_curved[triangle])
    result = np.zeros((len(triangle), 3))
    normals = surfaces.corner_normals[triangle[bent]].reshape(-1, 3)
    turned = side_normals(normals, np.repeat(side[bent], 3)).reshape(-1, 3, 3)
    corners = surfaces.points[surfaces.triangles[triangle[bent]]]
    mean = np.einsum("nk,nkx->nx", weights[bent], turned)
    result[bent] = mean * _heights(corners, turned, weights[bent])[:, None]
    return result


def _heights(corners: Floats, normals: Floats, weights: Floats) -> Floats:
    """Distance of places from the surface that is meant, (n,): as Cycles takes it.

    That is half of the bulge by which normals turn along the edges, or up to the lowest of the corners' tangent planes,
    each moved out until the whole triangle is below it.

    Parameters
    ----------
    corners, normals : (n, 3, 3) float
    weights : (n, 3) float
    """
    place = np.einsum("nk,nkx->nx", weights, corners)
    # Row k: how far each corner is above the tangent plane of corner k.
    above = np.einsum("nkx,njx->nkj", normals, corners) - np.einsum("nkx,nkx->nk", normals, corners)[:, :, None]
    planes = above.max(axis=2) - np.einsum("nkx,nkx->nk", normals, place[:, None] - corners)
    bulge = np.zeros(len(corners))
    for j, k in EDGES:
        turning = np.einsum("nx,nx->n", normals[:, k] - normals[:, j], corners[:, k] - corners[:, j])
        bulge += weights[:, j] * weights[:, k] * turning
    height: Floats = np.maximum(np.maximum(planes, 0.0).min(axis=1), bulge / 2.0)
    return height


def arriving(
    rays: RayScene, at: LitPoints, row: Ints, origins: Singles, toward: Singles, distant: bool = False
) -> Arrived:
    """What arrives along rays at lit points, (p, r), as `RayScene.visible`: nothing from below a face without a rise.

    Parameters
    ----------
    row : (p,) int
        The point that each bundle of rays is for.
    origins : (n, 3) float32, local units
        Where the points' rays start.
    toward : (p, r, 3) float32, local units
    distant : bool
        Whether the rays tell a direction, to something endlessly far away, and no place.
    """
    # What a smooth shading normal sees below its face is dark.
    above = np.einsum("prx,px->pr", toward, at.lift[row]) > -OFFSET
    bulges = at.bulges[row]
    if not bulges.any():
        whole: Arrived = rays.visible(origins.take(row, axis=0), toward) * above
        return whole
    plain, raised = np.flatnonzero(~bulges), np.flatnonzero(bulges)
    which, count = row[raised], toward.shape[1]
    share = raised_shares(at.taken(which), toward[raised])
    moved = share[:, :, None] * (at.rise[which] * rays.scale)[:, None]
    starts = origins.take(which, axis=0)[:, None] + moved.astype(np.float32)
    ways = toward[raised] if distant else (toward[raised] - moved).astype(np.float32)
    found = rays.visible(starts.reshape(-1, 3), ways.reshape(-1, 1, 3)).reshape(-1, count)
    others: Arrived = rays.visible(origins.take(row[plain], axis=0), toward[plain]) * above[plain]
    order = np.argsort(np.concatenate([raised, plain]))
    seen: Arrived = np.concatenate([found, others])[order]
    return seen


def raised_shares(at: LitPoints, ways: Singles) -> Floats:
    """How much of the rise the rays of each point start at, (n, r), 0..1: all of it where they leave below the face.

    Where both cosines, to the shading normal and to the face's own, are above the point's grazing one it is nothing.

    Parameters
    ----------
    ways : (n, r, 3) float32
    """
    exact = ways.astype(np.float64)
    unit = exact / np.maximum(lengths(exact), np.finfo(np.float32).tiny)[..., None]
    shading = np.einsum("nrx,nx->nr", unit, at.normals) / at.grazing[:, None]
    face = np.einsum("nrx,nx->nr", unit, at.lift) / at.grazing[:, None]
    shares: Floats = np.clip(1.0 + np.maximum(1.0 - shading, 0.0) - face, 0.0, 1.0)
    return shares
