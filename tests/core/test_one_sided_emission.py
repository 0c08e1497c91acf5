# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Faces that emit from their front alone."""

from dataclasses import replace

import numpy as np
import pytest
from radiosity_bake.core.bake import bake
from radiosity_bake.core.scene import Scene
from radiosity_bake.core.settings import BakeSettings

from tests.core.building import DARK
from tests.scenes import exact

COARSE = BakeSettings(quality="DRAFT", minimum_size=0.5)


def sheets(front_only):
    """A lamp that faces down between a floor and a sheet above it, which reflect nothing."""
    lamp = exact.rectangle("lamp", (0.8, 0.8, 1), (0, 0.4, 0), (0.4, 0, 0), emission=5.0)
    floor = exact.rectangle("floor", (0, 0, 0), (2, 0, 0), (0, 2, 0))
    ceiling = exact.rectangle("ceiling", (0, 0, 2), (0, 2, 0), (2, 0, 0))
    return Scene((floor, ceiling, replace(lamp, front_only=np.full(2, front_only))), DARK)


def test_only_the_front_lights_what_it_faces():
    floor, ceiling, lamp = bake(sheets(True), COARSE).meshes
    both = bake(sheets(False), COARSE).meshes
    assert floor.irradiance == pytest.approx(both[0].irradiance, rel=1e-6)
    assert ceiling.irradiance.max() == 0.0
    assert both[1].irradiance.max() == pytest.approx(floor.irradiance.max(), rel=0.05)
    assert lamp.radiosity.min() == pytest.approx(5.0)


def test_the_back_shows_no_emission_and_counts_for_no_power():
    one, two = bake(sheets(True), COARSE), bake(sheets(False), COARSE)
    assert one.report["energy"]["emitted"] == pytest.approx(two.report["energy"]["emitted"] / 2, rel=1e-6)
    behind = one.meshes[2].radiosity_back
    assert behind is None or behind.max() == 0.0
    assert two.meshes[2].radiosity_back is None or two.meshes[2].radiosity_back.max() == pytest.approx(5.0)
