# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Scenes without light that are no mistake, and which of a scene's parts give light."""

from dataclasses import replace

import numpy as np
import pytest
from radiosity_bake.core.bake import bake
from radiosity_bake.core.darkness import darkness
from radiosity_bake.core.errors import NoLightError
from radiosity_bake.core.relight import sources_of
from radiosity_bake.core.scene import LightGroup, PointLamp, Scene, Texture
from radiosity_bake.core.settings import BakeSettings

from tests.core.building import DARK, block, grid

SETTINGS = BakeSettings(quality="DRAFT", minimum_size=0.5, light_groups=True, keep_transport=False)
WHY = NoLightError("all is off")


def scene(strength=1.0, emission=0.0):
    """Return a floor below a box and a lamp, the only one of its light group."""
    lamp = PointLamp("Lamp", np.array([0.3, 0.3, 2.0]), 0.1, np.full(3, strength))
    meshes = (
        grid("Floor", 2, reflectance=(0.5,) * 3),
        block("Box", (0.6, 0.6, 0.0), (0.8, 0.8, 0.3), emission=(emission,) * 3),
    )
    return Scene(meshes, DARK, (lamp,), (LightGroup("Key", lamps=frozenset({0})),))


@pytest.mark.parametrize("output", ["ORIGINAL", "REFINED"])
def test_black_meshes_are_those_of_the_scene_in_light(output):
    settings = replace(SETTINGS, output=output)
    lit = bake(scene(), settings)
    dark = darkness(scene(0.0), settings, WHY, lit.meshes)
    for one, other in zip(lit.meshes, dark.meshes, strict=True):
        assert one.triangles is other.triangles and one.vertices is other.vertices
        assert one.radiosity.shape == other.radiosity.shape and not (other.radiosity.any() or other.irradiance.any())
        assert (one.radiosity_back is None) == (other.radiosity_back is None)
        assert one.groups and not other.groups, "groups without light have no values in any bake"
    assert dark.report["dark"] and dark.report["ended"] == "all is off"
    assert dark.report["triangles"] == lit.report["triangles"]


def test_without_others_to_take_after_black_meshes_are_those_of_the_scene():
    lit = bake(scene(), replace(SETTINGS, output="ORIGINAL"))
    dark = darkness(scene(0.0), SETTINGS, WHY)
    for one, other in zip(lit.meshes, dark.meshes, strict=True):
        np.testing.assert_array_equal(one.triangles, other.triangles)
        np.testing.assert_array_equal(one.parent_triangle, other.parent_triangle)
        np.testing.assert_array_equal(one.barycentric, other.barycentric)
        assert not other.radiosity.any() and other.radiosity.shape == one.radiosity.shape


def test_sources_are_lamps_glowing_triangles_and_the_world():
    counts = [int(sources_of(made).sum()) for made in (scene(0.0), scene(), scene(1.0, 2.0))]
    assert counts == [0, 1, 1 + 12]
    assert sources_of(replace(scene(0.0), world=np.ones(3)))[-2:].tolist() == [True, False]
    assert sources_of(replace(scene(0.0), world=np.ones((6, 3))))[-2:].tolist() == [True, True]


def test_of_textured_triangles_those_are_sources_that_shine_somewhere():
    floor, box = scene(0.0).meshes
    colours = np.zeros((4 + 1 + 4, 3), dtype=np.float32)
    colours[7] = 1.0
    texture = Texture(np.array([0, 2, 3]), np.zeros(3, dtype=np.int64), np.array([2, 1, 2]), colours)
    found = sources_of(Scene((replace(floor, emission_texture=texture), box), DARK))
    assert np.flatnonzero(found).tolist() == [3]
