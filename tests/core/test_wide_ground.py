# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""A room is baked as well on a wide ground as alone."""

from dataclasses import replace

import numpy as np
import pytest
from radiosity_bake.core.bake import bake
from radiosity_bake.core.error_estimate import DIM, lit_area
from radiosity_bake.core.patches import PatchTree
from radiosity_bake.core.scene import Scene, SunLamp, surface_mesh
from radiosity_bake.core.settings import BakeSettings
from radiosity_bake.core.surfaces import join

from tests.core.building import block, mean_over, room_with_block
from tests.scenes import exact

DRAFT = BakeSettings(quality="DRAFT", keep_transport=False)


def on_ground(scene, side, baked):
    """The scene a hand's breadth above a square of two triangles."""
    corner = (-side / 2.0, -side / 2.0, -0.1)
    ground = exact.rectangle("ground", corner, (side, 0, 0), (0, side, 0), reflectance=0.3)
    return Scene((*scene.meshes, replace(ground, baked=baked)), scene.world)


@pytest.fixture(scope="module")
def alone():
    return bake(room_with_block(), DRAFT)


@pytest.mark.parametrize("baked", [False, True])
@pytest.mark.parametrize("side", [20.0, 2000.0])
def test_a_room_on_a_wide_ground_has_the_light_that_it_has_alone(alone, side, baked):
    result = bake(on_ground(room_with_block(), side, baked), DRAFT)
    # A draft's own noise is 2% of a mesh's mean, and both have it; on one patch a wall the light is off by half.
    for mesh, same in zip(alone.meshes, result.meshes, strict=False):
        np.testing.assert_allclose(mean_over([same]), mean_over([mesh]), rtol=0.05, atol=1e-3)
    assert 0.5 < result.report["patches"] / alone.report["patches"] < 3.0
    room = sum(len(mesh.triangles) for mesh in result.meshes[: len(alone.meshes)])
    assert 0.5 < room / alone.report["triangles"] < 2.0
    assert 0.5 < result.report["estimated_error"] / alone.report["estimated_error"] < 2.0


def test_what_is_black_does_not_count_in_the_lit_area():
    area, light = np.array([1.0, 3.0, 1e6]), np.array([2.0, 3.0, 0.0])
    assert lit_area(area, light) == pytest.approx((4.0, 1.25))


def test_what_is_dim_counts_in_proportion_to_its_light():
    area, light = np.array([1.0, 10.0]), np.array([1.0, 0.01])
    counted, mean = lit_area(area, light)
    # The dim part counts for its light over DIM of the mean, to the step at which the search ends.
    assert counted == pytest.approx(1.0 + 0.01 / (DIM * mean), rel=2e-3)
    assert counted * mean == pytest.approx(1.01)


def test_nothing_is_lit_in_the_dark():
    assert lit_area(np.ones(3), np.zeros(3)) == (0.0, 0.0)


def test_every_node_knows_the_patch_it_was_split_from():
    tree = PatchTree(join(room_with_block()))
    count = len(tree)
    first = tree.split(np.array([3, 5]))
    second = tree.bisect(first[5:6], np.array([1]))
    ancestors = tree.ancestors(count)
    np.testing.assert_array_equal(ancestors[:count], np.arange(count))
    np.testing.assert_array_equal(ancestors[first], np.repeat([3, 5], 4))
    np.testing.assert_array_equal(ancestors[second], [5, 5])


def test_slivers_that_seem_to_see_something_do_not_make_a_lone_ball_fine():
    # As Blender makes a sphere of NURBS: its poles are holes of hardly any width, around which there are slivers.
    around = 32
    height = np.concatenate([[3e-7], np.linspace(0.0, np.pi, 17)[1:-1], [np.pi - 3e-7]])
    turn = 2.0 * np.pi * np.arange(around) / around
    rings = np.stack([np.outer(np.sin(height), np.cos(turn)), np.outer(np.sin(height), np.sin(turn))], axis=2)
    points = np.concatenate([rings, np.repeat(np.cos(height)[:, None, None], around, axis=1)], axis=2)
    points += np.random.default_rng(0).uniform(-1e-7, 1e-7, points.shape)
    a = np.add.outer(around * np.arange(len(height) - 1), np.arange(around))
    b = np.roll(a, -1, axis=1)
    triangles = np.concatenate([np.stack(k, axis=2) for k in ((a, a + around, b), (b, a + around, b + around))])
    ball = surface_mesh("ball", points.reshape(-1, 3), triangles.reshape(-1, 3), reflectance=0.5)
    sun = SunLamp("sun", np.array([0.3, 0.1, -0.95]), 0.01, np.ones(3))
    result = bake(Scene((ball,), np.zeros(3), (sun,)), DRAFT)
    assert result.report["patches"] < len(ball.triangles)
    assert result.report["minimum_size"] > 0.01


def test_a_gap_above_a_lamp_is_no_outline_however_wide_the_ground_is():
    meshes = (
        block("floor", (-3.2, -2.7, -0.1), (3.2, 2.7, 0.0)),
        block("roof", (-3.2, -2.7, 2.8), (3.2, 2.7, 3.0)),
        block("lamp", (-0.5, -0.5, 2.75), (0.5, 0.5, 2.77), reflectance=0.0),
    )
    meshes[2].emission[meshes[2].corner_normals[:, 0, 2] < -0.5] = 5.0
    scene = Scene(meshes, np.zeros(3))
    small, wide = (bake(on_ground(scene, side, False), DRAFT).report["vertices"] for side in (8.0, 6000.0))
    # By a hair of the ground's width, all vertices in the gap of 30 mm were taken for such: three times as many.
    assert wide <= 2.0 * small
