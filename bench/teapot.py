# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The Utah teapot: Martin Newell's bicubic patches of 1975, tessellated.

The 32 patches (306 control points; four of the patches, the bottom, were added later) repeat a few numbers: rim, body,
bottom and lid are profiles turned about the axis, whose quarter circles have the handles 0.56; handle and spout are
mirrored. So only the profiles and one half of handle and spout are written down.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from radiosity_bake.core.scene import Floats

# Length of a quarter circle's Bezier handle as Newell took it (a circle wants 0.5523).
HANDLE = 0.56

# (radius, height) of four control points each, from the outside in or from the top down.
PROFILES = (
    ((1.4, 2.4), (1.3375, 2.53125), (1.4375, 2.53125), (1.5, 2.4)),  # rim
    ((1.5, 2.4), (1.75, 1.875), (2.0, 1.35), (2.0, 0.9)),  # body, upper
    ((2.0, 0.9), (2.0, 0.45), (1.5, 0.225), (1.5, 0.15)),  # body, lower
    ((1.5, 0.15), (1.5, 0.075), (1.425, 0.0), (0.0, 0.0)),  # bottom
    ((0.0, 3.15), (0.8, 3.15), (0.0, 2.85), (0.2, 2.7)),  # lid, knob
    ((0.2, 2.7), (0.4, 2.55), (1.3, 2.55), (1.3, 2.4)),  # lid
)

# (x, half width, z) of the inner and the outer line of control points, along handle and spout; then the other half.
TUBES = (
    # handle, upper and lower: from the body out and down
    (
        ((-1.6, 0.3, 2.025), (-2.3, 0.3, 2.025), (-2.7, 0.3, 2.025), (-2.7, 0.3, 1.8)),
        ((-1.5, 0.3, 2.25), (-2.5, 0.3, 2.25), (-3.0, 0.3, 2.25), (-3.0, 0.3, 1.8)),
    ),
    (
        ((-2.7, 0.3, 1.8), (-2.7, 0.3, 1.575), (-2.5, 0.3, 1.125), (-2.0, 0.3, 0.9)),
        ((-3.0, 0.3, 1.8), (-3.0, 0.3, 1.35), (-2.65, 0.3, 0.9375), (-1.9, 0.3, 0.6)),
    ),
    # spout, lower and upper: from the body up; its mouth turns inward
    (
        ((1.7, 0.66, 1.425), (2.6, 0.66, 1.425), (2.3, 0.25, 2.1), (2.7, 0.25, 2.4)),
        ((1.7, 0.66, 0.6), (3.1, 0.66, 0.825), (2.4, 0.25, 2.025), (3.3, 0.25, 2.4)),
    ),
    (
        ((2.7, 0.25, 2.4), (2.8, 0.25, 2.475), (2.9, 0.15, 2.475), (2.8, 0.15, 2.4)),
        ((3.3, 0.25, 2.4), (3.525, 0.25, 2.49375), (3.45, 0.15, 2.5125), (3.2, 0.15, 2.4)),
    ),
)


@dataclass(frozen=True, eq=False)
class Tessellation:
    """Triangles of a smooth surface.

    Attributes
    ----------
    vertices : (v, 3) float
        Newell's units: 6.4 wide, 3.15 high, standing on z = 0.
    triangles : (t, 3) int
        Fronts outward.
    normals : (v, 3) float, unit
    """

    vertices: Floats
    triangles: NDArray[np.int64]
    normals: Floats


def control_points() -> Floats:
    """Return the 32 patches' control points: (32, 4, 4, 3), wound so that the front is outward."""
    return np.array([*_turned(), *_mirrored()])


def _turned() -> list[Floats]:
    """Return the 24 patches of rim, body, bottom and lid: each profile's four quarters, (4 along, 4 around)."""
    patches = []
    for profile in PROFILES:
        radius, height = np.array(profile).T
        # The knob's second ring has the handle 0.45 / 0.8 in Newell's list, all others 0.56.
        handle = np.where(radius == 0.8, 0.5625, HANDLE) * radius
        zero = np.zeros(4)
        quarter = [(radius, zero), (radius, handle), (handle, radius), (zero, radius)]
        points = np.stack([np.stack([x, y, height], axis=1) for x, y in quarter], axis=1)
        for k in range(4):
            c, s = (1, 0, -1, 0)[k], (0, 1, 0, -1)[k]
            turn = np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]], dtype=np.float64)
            patches.append(points @ turn.T)
    return patches


def _mirrored() -> list[Floats]:
    """Return the 8 patches of handle and spout, (4 along, 4 across)."""
    patches = []
    for inner, outer in TUBES:
        (xi, w, zi), (xo, wo, zo) = np.array(inner).T, np.array(outer).T
        zero = np.zeros(4)
        across = [(xi, zero, zi), (xi, -w, zi), (xo, -wo, zo), (xo, zero, zo)]
        half = np.stack([np.stack(line, axis=1) for line in across], axis=1)
        patches += [half[:, ::-1], half * [1.0, -1.0, 1.0]]
    return patches


def bernstein(t: Floats) -> tuple[Floats, Floats]:
    """Return the four cubic Bernstein polynomials and their derivatives at t: (n, 4) each."""
    u = 1.0 - t
    value = np.stack([u**3, 3.0 * u * u * t, 3.0 * u * t * t, t**3], axis=1)
    slope = np.stack([-3.0 * u * u, 3.0 * u * (u - 2.0 * t), 3.0 * t * (2.0 * u - t), 3.0 * t * t], axis=1)
    return value, slope


def tessellate(n: int) -> Tessellation:
    """Return the teapot with n x n cells for each patch: about 64 n^2 triangles, those without area left out.

    Vertices at one place are one vertex where the normals agree, so that patches join smoothly and edges stay hard.
    """
    t = np.linspace(0.0, 1.0, n + 1)
    value, _ = bernstein(t)
    patches = control_points()
    points = np.einsum("ia,jb,pabc->pijc", value, value, patches)
    # Where a row of control points is one point, the tangent is that a little inside the patch.
    inside, inside_slope = bernstein(np.clip(t, 1e-4, 1.0 - 1e-4))
    along = np.einsum("ia,jb,pabc->pijc", inside_slope, inside, patches)
    across = np.einsum("ia,jb,pabc->pijc", inside, inside_slope, patches)
    normals = np.cross(along, across)
    normals /= np.linalg.norm(normals, axis=-1, keepdims=True)
    cells = _cells(n)
    triangles = (np.arange(len(patches))[:, None, None] * (n + 1) ** 2 + cells).reshape(-1, 3)
    return _welded(points.reshape(-1, 3), normals.reshape(-1, 3), triangles)


def _cells(n: int) -> NDArray[np.int64]:
    """Return the 2 n^2 triangles of a grid of (n + 1)^2 points, rows first."""
    i, j = (x.ravel() for x in np.meshgrid(np.arange(n), np.arange(n), indexing="ij"))
    a = i * (n + 1) + j
    b, c, d = a + n + 1, a + n + 2, a + 1
    return np.stack([a, b, c, a, c, d], axis=1).reshape(-1, 3)


def _welded(points: Floats, normals: Floats, triangles: NDArray[np.int64]) -> Tessellation:
    """Return the tessellation with equal points of nearly equal normals made one, and empty triangles dropped."""
    key = np.concatenate([np.round(points * 1e6), np.round(normals * 20.0)], axis=1) + 0.0
    _, first, index = np.unique(key, axis=0, return_index=True, return_inverse=True)
    corners = index.reshape(-1)[triangles]
    vertices = points[first]
    a, b, c = (vertices[corners[:, k]] for k in range(3))
    area = np.linalg.norm(np.cross(b - a, c - a), axis=1)
    return Tessellation(vertices, corners[area > 1e-9], normals[first])
