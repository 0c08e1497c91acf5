# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Sides of emitters that look at little but other emitters, as the inside of a glowing pot does.

Most of their light stays where it is, but they face receivers as other emitters do. Among those they would take half of
the shadow rays and bring nothing but noise.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from .sampling import frames, hemisphere_lattice
from .scene import Ints
from .surfaces import Surfaces
from .visibility import RayScene

ENCLOSED = 0.9
"""Share of a side's rays that meet emitters from which on it is enclosed."""

RAYS_PER_SIDE = 64
"""Enough to tell a tenth from nothing."""

MOST_RAYS = 2**22
"""Of a hundred thousand emitters, each gets fewer rays: it is a matter of many of them."""


def enclosed_sides(surfaces: Surfaces, emitting: Ints, rays: RayScene, seed: int) -> NDArray[np.bool_]:
    """Whether nearly all that the front and the back of emitting triangles see is emitters, (k, 2) bool."""
    count = min(RAYS_PER_SIDE, max(8, MOST_RAYS // (2 * len(emitting))))
    emits = np.zeros(len(surfaces.triangles) + 1, dtype=bool)
    # The last stands for the rays that meet nothing, which have the number -1.
    emits[emitting] = True
    pattern = hemisphere_lattice(count, seed)
    centres = surfaces.points[surfaces.triangles[emitting]].mean(axis=1)

    def work(first: int, last: int) -> NDArray[np.bool_]:
        number = np.arange(first, last)
        normals = surfaces.normals[emitting[number >> 1]] * np.where(number & 1, -1.0, 1.0)[:, None]
        origins, _ = rays.lifted(centres[number >> 1], normals)
        directions = (pattern @ frames(normals, np.zeros(len(normals)))).reshape(-1, 3)
        hits = rays.first_hits(np.repeat(origins, count, axis=0), directions)
        share: NDArray[np.bool_] = emits[hits.triangle].reshape(-1, count).mean(axis=1) > ENCLOSED
        return share

    parts = rays.workers.map(work, 2 * len(emitting), count)
    return np.concatenate([np.zeros(0, dtype=bool), *parts]).reshape(-1, 2)
