# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Lamps that hang close under a ceiling: what its patches get of them is neither missed nor counted too often."""

from dataclasses import replace

import numpy as np
import pytest
from radiosity_bake.core.bake import bake
from radiosity_bake.core.lamp_shapes import unoccluded
from radiosity_bake.core.near_lamps import mean_unoccluded, near_shares
from radiosity_bake.core.scene import PointLamp, Scene
from radiosity_bake.core.settings import BakeSettings

from tests.core.building import DARK
from tests.scenes import exact

CORNERS = np.array([[(0.0, 0.0, 0.0), (0.3, 0.0, 0.0), (0.0, 0.2, 0.0)]])
UP = np.array([[0.0, 0.0, 1.0]])
# One watt in each channel.
LAMP = PointLamp("lamp", np.array([0.1, 0.05, 0.01]), 0.0, np.ones(3) / (4.0 * np.pi))


def solid_angle(corners, centre):
    """Of a triangle (van Oosterom & Strackee 1983)."""
    a, b, c = corners - centre
    x, y, z = (np.linalg.norm(v) for v in (a, b, c))
    return 2.0 * np.arctan2(abs(np.dot(a, np.cross(b, c))), x * y * z + (a @ b) * z + (a @ c) * y + (b @ c) * x)


@pytest.mark.parametrize("height", [0.001, 0.01, 0.1, 1.0])
def test_the_mean_over_a_triangle_is_its_solid_angle(height):
    centre = np.array([0.1, 0.05, height])
    mean = mean_unoccluded(replace(LAMP, centre=centre), CORNERS, UP)[0]
    # `NEAR_SIZE`: the rule of three points leaves less than 0.1% where the triangle is as large as is allowed.
    assert mean * np.pi * 0.03 == pytest.approx(solid_angle(CORNERS[0], centre), rel=0.001)


def test_a_mile_long_sliver_beside_a_lamp_has_few_parts_near_it(monkeypatch):
    asked = []

    def counted(lamp, points, normals):
        asked.append(len(points))
        return unoccluded(lamp, points, normals)

    monkeypatch.setattr("radiosity_bake.core.near_lamps.unoccluded", counted)
    sliver = np.array([[(-1000.0, 0.0, 0.0), (1000.0, 0.0, 0.0), (0.0, 0.001, 0.0)]])
    mean = mean_unoccluded(replace(LAMP, centre=np.array([0.0, 0.0, 20.0])), sliver, UP)[0]
    assert mean * np.pi == pytest.approx(solid_angle(sliver[0], np.array([0.0, 0.0, 20.0])), rel=0.001)
    # Each halving leaves a few dozen parts, of three points; of quarters there would be twice as many with each cut.
    assert sum(asked) < 3000


def test_a_lamp_that_gives_no_light_takes_no_time():
    dark = replace(LAMP, strength=np.zeros(3))
    assert near_shares((dark,), CORNERS, CORNERS, np.repeat(UP[:, None], 3, axis=1)) == {}


@pytest.mark.parametrize("gap", [0.005, 0.02, 0.05])
def test_a_closed_room_gets_all_the_light_of_a_lamp_close_under_its_ceiling(gap):
    walls = exact.box_walls((3.0, 3.0, 2.4), reflectance=0.5)
    lamp = replace(LAMP, centre=np.array([1.3, 1.37, 2.4 - gap]))
    room = Scene(walls, DARK, (lamp,))
    settings = BakeSettings(quality="DRAFT", threads=2, output="ORIGINAL")
    energy = bake(room, settings).report["energy"]
    # Patches that are far from the lamp are sampled at 16 points of uneven light: less than 0.1% of all of it.
    assert energy["from_lamps"] == pytest.approx(3.0, rel=0.001)
