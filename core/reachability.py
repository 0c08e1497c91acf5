# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Which sides of which shells light can reach: a few thousand random walks from the emitters.

A closed mesh may be a solid, whose inside no light enters, or a room seen from within; only the light can tell. Rays
that start inside a solid (a floor that runs on under a block) are recognised by it and dropped.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from .direct import LUMINANCE
from .sampling import cosine_directions, hashed, triangle_weights
from .scene import Floats, Ints
from .surfaces import Surfaces
from .visibility import OFFSET, RayScene

WALKS = 16384
"""Random walks started; a side that takes part in the lighting of a room meets hundreds of them."""

LONGEST_WALK = 16

LEAST_VISITS = 3
"""Visits that make the inside of a closed mesh lit: one or two may be rays that slipped through an edge."""


def lit_sides(surfaces: Surfaces, rays: RayScene, seed: int) -> NDArray[np.bool_]:
    """Whether light reaches the front and the back of each shell, (shells, 2) bool."""
    visits = np.zeros((len(surfaces.closed), 2))
    triangle, back = _start(surfaces, seed)
    square = hashed(np.arange(len(triangle)), 2, seed + 1)
    weights = triangle_weights(square)
    inward = _self_lit(surfaces)[surfaces.shell_of_triangle[triangle]] & back
    for bounce in range(LONGEST_WALK):
        if len(triangle) == 0:
            break
        normal = surfaces.normals[triangle] * np.where(back, -1.0, 1.0)[:, None]
        a, b, c = (surfaces.points[surfaces.triangles[triangle, k]] for k in range(3))
        origin = a + (b - a) * weights[:, :1] + (c - a) * weights[:, 1:]
        turn = hashed(np.arange(len(triangle)) + WALKS * (bounce + 1), 2, seed)
        direction = cosine_directions(turn, normal)
        start = rays.local(origin) + (normal * OFFSET).astype(np.float32)
        hits = rays.first_hits(start, direction.astype(np.float32))
        met = hits.triangle >= 0
        if bounce == 0:
            shell_before = surfaces.shell_of_triangle[triangle]
            met &= ~(inward & (surfaces.shell_of_triangle[hits.triangle] == shell_before))
        triangle, weights = hits.triangle[met].astype(np.int64), hits.weights[met].astype(np.float64)
        back = hits.back[met]
        np.add.at(visits, (surfaces.shell_of_triangle[triangle], back.astype(np.int64)), 1.0)
        reflecting = surfaces.reflectance[triangle].any(axis=1)
        triangle, weights, back = triangle[reflecting], weights[reflecting], back[reflecting]
    lit = visits >= np.where(surfaces.closed, LEAST_VISITS, 1)[:, None]
    if surfaces.world.any():
        lit[:, 0] = True
        lit[~surfaces.closed, 1] = True
    return lit


def _start(surfaces: Surfaces, seed: int) -> tuple[Ints, NDArray[np.bool_]]:
    """Emitting triangles in proportion to their power, and the side that each walk leaves from."""
    power = np.cumsum(surfaces.areas * (surfaces.emission @ LUMINANCE))
    if len(power) == 0 or power[-1] <= 0.0:
        return np.zeros(0, dtype=np.int64), np.zeros(0, dtype=bool)
    step = (np.arange(WALKS) + 0.5) / WALKS * power[-1]
    triangle = np.minimum(np.searchsorted(power, step, side="right"), len(power) - 1)
    return triangle, hashed(np.arange(WALKS), 1, seed + 2)[:, 0] < 0.5


def _self_lit(surfaces: Surfaces) -> NDArray[np.bool_]:
    """Closed shells that emit all over, such as a bulb: light inside that only meets the shell itself is of no use."""
    emits = surfaces.emission.any(axis=1)
    dark = np.bincount(surfaces.shell_of_triangle, weights=~emits, minlength=len(surfaces.closed))
    return surfaces.closed & (dark == 0)


def side_normals(normals: Floats, sides: Ints) -> Floats:
    """Normals turned over where the side is the back (1)."""
    return normals * np.where(sides == 1, -1.0, 1.0)[:, None]
