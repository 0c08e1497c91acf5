# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Triangles that emit, cut into pieces of about even radiance where a texture makes them uneven."""

from __future__ import annotations

import numpy as np

from .scene import Floats, Ints
from .surfaces import Surfaces
from .textures import cell_centres, cell_corners

MISPLACED = 1e-3
"""Share of the power of all textured emitters that a piece may show in the wrong places, as it is of one colour."""

MOST_PIECES = 2048
"""Pieces of all textured triangles: many emitters cost a receiver hardly more than a few hundred do."""

PROBES = 4
"""Parts along the edge of a piece whose means are compared."""


def emitting_pieces(surfaces: Surfaces) -> tuple[Ints, Floats]:
    """What emits, in pieces of one radiance.

    Returns
    -------
    triangle : (k,) int
        The surfaces' triangle each lies in, ascending.
    corners : (k, 3, 3) float
        Barycentric coordinates of its corners there.
    """
    emits = surfaces.emission.any(axis=1)
    varies = np.zeros(len(emits), dtype=bool)
    if surfaces.emission_texture is not None:
        varies[surfaces.emission_texture.triangle] = True
    even = np.flatnonzero(emits & ~varies)
    triangle = np.flatnonzero(emits & varies)
    corners = np.broadcast_to(np.eye(3), (len(triangle), 3, 3)).copy()
    limit = MISPLACED * float(surfaces.areas[triangle] @ surfaces.emission[triangle].sum(axis=1))
    done: list[tuple[Ints, Floats]] = [(even, np.broadcast_to(np.eye(3), (len(even), 3, 3)))]
    pieces = 0
    while len(triangle):
        uneven = _misplaced(surfaces, triangle, corners) > limit
        if pieces + len(triangle) + 3 * int(uneven.sum()) > MOST_PIECES:
            uneven[:] = False
        done.append((triangle[~uneven], corners[~uneven]))
        pieces += int((~uneven).sum())
        triangle, corners = np.repeat(triangle[uneven], 4), _quartered(corners[uneven])
    triangle, corners = (np.concatenate([part[k] for part in done]) for k in (0, 1))
    shines = surfaces.emission_over(triangle, corners).any(axis=1)
    order = np.argsort(triangle[shines], kind="stable")
    return triangle[shines][order], corners[shines][order]


def piece_areas(corners: Floats) -> Floats:
    """Share of their triangle's area that pieces (k, 3, 3) have, (k,)."""
    shares: Floats = np.abs(np.linalg.det(corners))
    return shares


def _misplaced(surfaces: Surfaces, triangle: Ints, corners: Floats) -> Floats:
    """Power of each piece that its mean shows in the wrong place, (k,), W over pi, summed over the channels."""
    centres = cell_centres(PROBES)
    probes = cell_corners(centres, np.full(len(centres), PROBES)) @ corners[:, None]
    each = len(centres)
    parts = surfaces.emission_over(np.repeat(triangle, each), probes.reshape(-1, 3, 3))
    parts = parts.sum(axis=1).reshape(-1, each)
    spread = np.abs(parts - parts.mean(axis=1, keepdims=True)).mean(axis=1)
    misplaced: Floats = spread * surfaces.areas[triangle] * piece_areas(corners)
    return misplaced


def _quartered(corners: Floats) -> Floats:
    """Pieces cut into four by their edges' midpoints, four after four, (4 k, 3, 3)."""
    a, b, c = corners[:, 0], corners[:, 1], corners[:, 2]
    ab, bc, ca = (a + b) / 2.0, (b + c) / 2.0, (c + a) / 2.0
    four = np.stack([a, ab, ca, ab, b, bc, ca, bc, c, bc, ca, ab], axis=1)
    return four.reshape(-1, 3, 3)
