# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Walls between a bright room and a dark one, and the feet of blocks: no light gets through, and none is lost.

At three scales, as all lengths in the core are shares of the scene's.
"""

import numpy as np
import pytest
from radiosity_bake.core.bake import bake
from radiosity_bake.core.scene import Scene
from radiosity_bake.core.settings import BakeSettings

from tests.core.building import DARK, areas, block, moved
from tests.scenes import exact, oracle

SCALES = [0.01, 1.0, 100.0]
GAPS = pytest.mark.parametrize("gap", [0.0, 1e-4, -0.03], ids=["touching", "apart", "overlapping"])
DRAFT = BakeSettings(quality="DRAFT")


def mean_light(result, wanted):
    """Mean irradiance of the faces whose middle and normal are wanted, by area."""
    light = area = 0.0
    for mesh in result.meshes:
        corners = mesh.vertices[mesh.triangles]
        normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        chosen = wanted(corners.mean(axis=1), normal)
        size = areas(corners)[chosen]
        light += size @ mesh.irradiance.mean(axis=(1, 2))[chosen]
        area += size.sum()
    return light / area


@GAPS
@pytest.mark.parametrize("scale", SCALES)
def test_a_wall_between_a_bright_room_and_a_dark_one_lets_nothing_through(scale, gap):
    lamp = exact.rectangle("lamp", (0.3, 0.3, 0.9), (0, 0.4, 0), (0.4, 0, 0), emission=5.0)
    wall = block("wall", (1.0, gap, gap), (1.06, 1 - gap, 1 - gap))
    scene = Scene((exact.closed_room((2, 1, 1), reflectance=0.5), lamp, wall), DARK)
    result = bake(moved(scene, scale), DRAFT)
    bright = mean_light(result, lambda at, normal: at[:, 0] < 0.98 * scale)
    dark = mean_light(result, lambda at, normal: (at[:, 0] > 1.08 * scale) & (at[:, 0] < 2.01 * scale))
    assert dark < 1e-3 * bright


@GAPS
@pytest.mark.parametrize("thickness", [0.0, 0.002, 0.06, 0.3])
@pytest.mark.parametrize("place", [1.17])
def test_nothing_gets_through_a_wall_that_stands_where_no_edge_of_the_room_is(place, thickness, gap):
    lamp = exact.rectangle("lamp", (0.15, 0.3, 0.9), (0, 0.4, 0), (0.3, 0, 0), emission=5.0)
    high = 1.0 - gap
    if thickness == 0.0:
        wall = exact.rectangle("wall", (place, gap, gap), (0, high - gap, 0), (0, 0, high - gap), reflectance=0.8)
    else:
        wall = block("wall", (place, gap, gap), (place + thickness, high, high), reflectance=0.8)
    # Walls of two triangles reach through to the other side, unless they are cut.
    result = bake(Scene((*exact.box_walls((2, 1, 1), reflectance=0.8), lamp, wall), DARK), DRAFT)
    bright = mean_light(result, lambda at, normal: at[:, 0] < place - 1e-3)
    dark = mean_light(result, lambda at, normal: at[:, 0] > place + thickness + 1e-3)
    assert dark < 1e-3 * bright


@GAPS
@pytest.mark.parametrize("lean", [0.0, 0.3], ids=["straight", "slanted"])
def test_the_dark_side_of_a_wall_without_thickness_asks_for_no_faces(gap, lean):
    lamp = exact.rectangle("lamp", (0.3, 0.3, 0.9), (0, 0.4, 0), (0.4, 0, 0), emission=5.0)
    along = (2 * lean, 1 - 2 * gap, 0)
    wall = exact.rectangle("wall", (1.03 - lean, gap, gap), along, (0, 0, 1 - 2 * gap), reflectance=0.5)
    result = bake(Scene((exact.closed_room((2, 1, 1), reflectance=0.5), lamp, wall), DARK), DRAFT)
    # Places in the dark turn from hidden to seen where rays no longer meet the wall, and are black on both sides.
    assert result.report["vertices"] < 4_000


def test_beside_a_wall_without_thickness_a_dim_room_keeps_its_own_light():
    # The same room alone, with the wall as one of its sides, is baked without any leak.
    def lamp(x, emission):
        return exact.rectangle("lamp", (x, 0.3, 0.9), (0, 0.4, 0), (0.4, 0, 0), emission=emission)

    wall = exact.rectangle("wall", (1.03, -0.05, -0.05), (0, 1.1, 0), (0, 0, 1.1), reflectance=0.5)
    room = exact.closed_room((2, 1, 1), reflectance=0.5)
    both = bake(Scene((room, lamp(0.3, 5.0), lamp(1.4, 0.05), wall), DARK), DRAFT)
    alone = bake(Scene((exact.closed_room((0.97, 1, 1), reflectance=0.5), lamp(0.37, 0.05)), DARK), DRAFT)
    bright = mean_light(both, lambda at, normal: (at[:, 0] < 1.0) & (at[:, 2] < 0.89))

    def dim(start):
        return lambda at, normal: (at[:, 0] > start + 0.02) & (at[:, 0] < start + 0.96) & (at[:, 2] < 0.89)

    assert abs(mean_light(both, dim(1.03)) - mean_light(alone, dim(0.0))) < 1e-3 * bright


@GAPS
def test_boards_that_make_a_closed_box_keep_the_sky_out(gap):
    t = 0.05
    boards = [
        block("bottom", (0, 0, -t), (1, 1, -gap)),
        block("top", (0, 0, 1 + gap), (1, 1, 1 + t)),
        block("west", (-t, -t, -t), (-gap, 1 + t, 1 + t)),
        block("east", (1 + gap, -t, -t), (1 + t, 1 + t, 1 + t)),
        block("south", (0, -t, -t), (1, -gap, 1 + t)),
        block("north", (0, 1 + gap, -t), (1, 1 + t, 1 + t)),
    ]
    result = bake(Scene(tuple(boards), np.ones(3)), DRAFT)

    def inside(at, normal):
        within = np.abs(at - 0.5).max(axis=1) < 0.5 + 2e-4
        return within & (np.einsum("fx,fx->f", normal, 0.5 - at) > 0.0)

    def outside(at, normal):
        return np.abs(at - 0.5).max(axis=1) > 0.5 + 0.9 * t

    assert mean_light(result, inside) < 1e-3 * mean_light(result, outside)


@pytest.mark.parametrize("bottom", [-0.05, 0.0, 1e-4], ids=["in the floor", "on the floor", "just above the floor"])
@pytest.mark.parametrize("turned", [0.0, 27.0])
@pytest.mark.parametrize("scale", SCALES)
def test_the_floor_at_the_foot_of_a_block_has_no_rim(scale, turned, bottom):
    # A black block under a white sky: at each point of the black floor it takes its form factor from the sky.
    floor = exact.rectangle("floor", (-1, -1, 0), (2, 0, 0), (0, 2, 0), reflectance=0.0)
    solid = block("block", (-0.5, -0.5, bottom), (0.5, 0.5, 0.3), reflectance=0.0, turned=turned)
    size = 0.1
    settings = BakeSettings(quality="DRAFT", minimum_size=size * scale, method="UNIFORM")
    mesh = bake(moved(Scene((floor, solid), np.ones(3)), scale), settings).meshes[0]
    corners = mesh.vertices[mesh.triangles] / scale
    angle = np.radians(turned)
    turn = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
    beyond = np.abs(corners[..., :2] @ turn) - 0.5
    middle = np.abs(corners[..., :2].mean(axis=1) @ turn) - 0.5
    outside = (beyond.max(axis=2) > -1e-3).all(axis=1) & (middle.max(axis=1) > 0.0)
    # Beside the block, where a face's edge along it is straight; the corners of a foot are rounded by straight cuts.
    beside = outside & (middle.min(axis=1) < -size) & (middle.max(axis=1) < size)
    at = (corners + 0.05 * (corners.mean(axis=1, keepdims=True) - corners))[beside].reshape(-1, 3)
    free = np.abs(at[:, :2] @ turn).max(axis=1) > 0.5
    at, light = at[free], mesh.irradiance[beside][..., 0].ravel()[free]
    assert len(at) > 50
    sides = solid.vertices[solid.triangles]
    expected = np.array([1.0 - sum(oracle.point_to_polygon(p, (0.0, 0.0, 1.0), s) for s in sides) for p in at])
    error = light - expected
    # 64 even rays know a half of the sky to within 0.02, and beside the block light falls by 0.1 over a face.
    assert abs(error.mean()) < 0.02
    assert np.abs(error).max() < 0.15
    under = (beyond.max(axis=2) < 1e-3).all(axis=1) & (middle.max(axis=1) < -size)
    assert mesh.irradiance[under].max() == 0.0
