# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Gloss: surfaces that send on more of the light, or less, than their own colours show."""

from dataclasses import replace

import numpy as np
import pytest
from radiosity_bake.core.bake import bake
from radiosity_bake.core.relight import relight
from radiosity_bake.core.scene import Texture
from radiosity_bake.core.settings import BakeSettings

from tests.scenes import exact

SETTINGS = BakeSettings(quality="DRAFT", minimum_size=0.5, keep_transport=True)


def glossy_furnace(own, sent_on=0.5, **options):
    """A closed box that glows, and what arrives in it where all of it sends on a share of the light."""
    scene, expected = exact.furnace(sent_on)
    meshes = tuple(
        replace(mesh, own_reflectance=np.broadcast_to(np.asarray(own, dtype=float), mesh.reflectance.shape), **options)
        for mesh in scene.meshes
    )
    return replace(scene, meshes=meshes), float(np.mean(expected["irradiance"]))


@pytest.mark.parametrize("output", ["ORIGINAL", "REFINED"])
def test_a_room_is_lit_by_what_gloss_sends_on_and_shows_what_is_diffuse(output):
    scene, arrives = glossy_furnace((0.2, 0.1, 0.0))
    for mesh, given in zip(bake(scene, replace(SETTINGS, output=output)).meshes, scene.meshes, strict=True):
        # As in any furnace of few patches.
        assert mesh.irradiance.mean() == pytest.approx(arrives, rel=2e-3)
        np.testing.assert_allclose(mesh.radiosity, given.emission[0] + [0.2, 0.1, 0.0] * mesh.irradiance, rtol=1e-6)


def test_own_colours_may_vary():
    scene, arrives = glossy_furnace(0.0)
    checks = np.array([(0.4, 0.4, 0.4), (0.0, 0.0, 0.0), (0.0, 0.0, 0.0), (0.0, 0.0, 0.0)], dtype=np.float32)
    varied = tuple(
        replace(
            mesh,
            own_reflectance_texture=Texture(
                np.arange(len(mesh.triangles)),
                np.zeros(len(mesh.triangles), dtype=int),
                np.full(len(mesh.triangles), 2),
                np.tile(checks, (len(mesh.triangles), 1)),
            ),
        )
        for mesh in scene.meshes
    )
    result = bake(replace(scene, meshes=varied), replace(SETTINGS, output="ORIGINAL"))
    for mesh, given in zip(result.meshes, scene.meshes, strict=True):
        assert mesh.irradiance.mean() == pytest.approx(arrives, rel=2e-3)
        shown = mesh.radiosity - given.emission[0]
        assert shown.max() > 0.01 and shown.max() < 0.41 * arrives


def test_relighting_takes_other_gloss():
    scene, _ = glossy_furnace(0.2, 0.3)
    kept = bake(scene, replace(SETTINGS, output="ORIGINAL")).kept
    brighter, arrives = glossy_furnace(0.1, 0.6)
    (mesh, *_) = relight(kept, brighter).meshes
    assert mesh.irradiance.mean() == pytest.approx(arrives, rel=2e-3)
    np.testing.assert_allclose(mesh.radiosity, brighter.meshes[0].emission[0] + 0.1 * mesh.irradiance, rtol=1e-6)


def test_direct_light_leaves_by_what_is_diffuse():
    scene, _ = glossy_furnace(0.2)
    result = bake(scene, replace(SETTINGS, output="ORIGINAL", light="DIRECT"))
    for mesh, given in zip(result.meshes, scene.meshes, strict=True):
        np.testing.assert_allclose(mesh.radiosity, given.emission[0] + 0.2 * mesh.irradiance, rtol=1e-6)
