# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The foot of what stands on a floor: it sees the floor before it, and not what of the floor is hidden under it."""

import numpy as np
import pytest
from radiosity_bake.core import cells
from radiosity_bake.core.bake import bake
from radiosity_bake.core.scene import PointLamp, Scene, surface_mesh
from radiosity_bake.core.settings import BakeSettings

from tests.core.building import block

RADIUS, MIDDLE = 0.35, np.array([0.13, 0.21])

LAMPS = tuple(
    PointLamp("lamp", np.array([1.2 * np.cos(angle), 1.2 * np.sin(angle), 2.0]), 0.0, np.ones(3))
    for angle in (0.0, 2.1, 4.2)
)


def pillar(sides=16):
    """A pillar that stands askew to the triangles of the floor, with a bottom in its plane."""
    angle = 2.0 * np.pi * np.arange(sides) / sides
    ring = MIDDLE + RADIUS * np.stack([np.cos(angle), np.sin(angle)], axis=1)
    points = [(*MIDDLE, 0.0), *((x, y, 0.0) for x, y in ring), *((x, y, 0.6) for x, y in ring), (*MIDDLE, 0.6)]
    triangles = []
    for low in range(1, sides + 1):
        following = low % sides + 1
        high, high_following, top = low + sides, following + sides, 2 * sides + 1
        triangles += [(low, following, high_following), (low, high_following, high)]
        triangles += [(0, following, low), (top, high, high_following)]
    return surface_mesh("pillar", points, triangles, reflectance=0.5)


@pytest.mark.parametrize(
    ("half_size", "world", "lamps", "most_cells"),
    [((4, 3), 1.0, (), cells.MOST_CELLS), ((2, 2), 0.5, LAMPS, 2**12)],
    ids=["faces that are hidden in part", "cells that are"],
)
def test_the_foot_of_a_pillar_is_lit_evenly_all_around(half_size, world, lamps, most_cells, monkeypatch):
    # In a larger scene cells are as coarse as this.
    monkeypatch.setattr(cells, "MOST_CELLS", most_cells)
    floor = block("floor", (*np.negative(half_size), -0.5), (*half_size, 0.0), reflectance=0.6)
    scene = Scene((floor, pillar()), world * np.ones(3), lamps=lamps)
    mesh = bake(scene, BakeSettings(quality="DRAFT")).meshes[1]
    corners = mesh.vertices[mesh.triangles]
    upright = np.ptp(corners[:, :, 2], axis=1) > 0.0
    light = mesh.irradiance[upright[:, None] & (corners[:, :, 2] < 1e-6)].mean(axis=1)
    # The darkest side has 3% less than the median under the sky and 6% less in the light of the lamps. Where rays saw
    # what is hidden for what is before it, the foot had 20 to 30% less there.
    assert light.min() > 0.9 * np.median(light)
