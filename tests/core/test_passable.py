# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Meshes that some light goes through: what they take from others, what they receive, and the balance."""

from dataclasses import replace

import numpy as np
import pytest
from radiosity_bake.core.bake import bake
from radiosity_bake.core.relight import shapes_of
from radiosity_bake.core.scene import PointLamp, Scene, surface_mesh
from radiosity_bake.core.settings import BakeSettings
from radiosity_bake.core.visibility import RayScene

from tests.scenes import exact

SETTINGS = BakeSettings(quality="DRAFT", output="ORIGINAL")
SQUARE = [(-1, -1, 0), (1, -1, 0), (1, 1, 0), (-1, 1, 0)]
TWO = [(0, 1, 2), (0, 2, 3)]


def square(name, height, size=1.0, turned=False, **options):
    corners = [(size * x, size * y, height) for x, y, _ in SQUARE]
    return surface_mesh(name, corners, [t[::-1] for t in TWO] if turned else TWO, **options)


def grid(name, height, cells=8, **options):
    side = np.linspace(-1.0, 1.0, cells + 1)
    points = [(x, y, height) for y in side for x in side]
    row = cells + 1
    corners = [a for j in range(cells) for a in range(j * row, j * row + cells)]
    triangles = [t for a in corners for t in ((a, a + 1, a + row + 1), (a, a + row + 1, a + row))]
    return surface_mesh(name, points, triangles, **options)


def lamp(height=2.0):
    return PointLamp("Lamp", np.array([0.0, 0.0, height]), 0.0, np.full(3, 10.0))


def mean_irradiance(result, mesh=0):
    (baked,) = (baked for baked in result.meshes if baked.mesh == mesh)
    return baked.irradiance.mean()


def lit_floor(*others, light=lamp, settings=SETTINGS):
    """Return the mean irradiance of a floor under a lamp, with other meshes around."""
    floor = grid("Floor", 0.0, reflectance=0.5)
    return mean_irradiance(bake(Scene((floor, *others), np.zeros(3), (light(),)), settings))


def test_what_casts_no_shadow_hides_no_lamp():
    free = lit_floor()
    assert lit_floor(square("Board", 1.0, reflectance=0.0)) < 0.5 * free
    # Point lamp without a radius: its shadow rays are all or nothing, and nothing else lights the floor.
    assert lit_floor(square("Board", 1.0, shadow=False)) == pytest.approx(free, rel=1e-6)


def test_what_casts_no_shadow_reflects_all_the_same():
    side = [(-1.2, -2, 0), (-1.2, 2, 0), (-1.2, 2, 2), (-1.2, -2, 2)]
    wall = surface_mesh("Wall", side, TWO, reflectance=0.9, baked=False)
    with_wall = lit_floor(wall)
    assert with_wall > 1.05 * lit_floor()
    # The wall hides nothing from the floor, so that its shadow makes no difference; rays of DRAFT agree to a percent.
    assert lit_floor(replace(wall, shadow=False)) == pytest.approx(with_wall, rel=0.01)


def test_what_is_not_seen_reflects_nothing_and_casts_its_shadow():
    board = square("Board", 1.0, reflectance=0.9, seen=False)
    black = square("Board", 1.0, reflectance=0.0)
    assert lit_floor(board) == pytest.approx(lit_floor(black), rel=1e-6)


def test_what_is_neither_seen_nor_casts_a_shadow_changes_nothing_for_others():
    globe, _ = exact.furnace(0.5, emission=0.0, size=(0.2, 0.2, 0.2))
    ghost = replace(
        globe.meshes[0], vertices=globe.meshes[0].vertices + [-0.1, -0.1, 1.9], baked=False, seen=False, shadow=False
    )
    # The lamp is inside of it, as in the glass of a bulb. It adds a patch or two, so that the pattern of rays is
    # another; the lamp's own light is the same.
    assert lit_floor(ghost) == pytest.approx(lit_floor(), rel=1e-6)


@pytest.mark.parametrize(("seen", "shadow"), [(False, False), (False, True), (True, False)])
def test_a_mesh_that_light_goes_through_receives_what_a_solid_one_does(seen, shadow):
    floor = grid("Floor", 0.0, reflectance=0.5, seen=seen, shadow=shadow)
    result = bake(Scene((floor,), np.zeros(3), (lamp(),)), SETTINGS)
    assert mean_irradiance(result) == pytest.approx(lit_floor(), rel=1e-6)


def test_a_ghost_in_a_furnace_glows_as_the_furnace_does_and_is_not_counted():
    scene, expected = exact.furnace(0.8)
    centre = scene.meshes[0].vertices.mean(axis=0)
    points = np.array(SQUARE) * 0.2 + centre
    ghost = surface_mesh("Ghost", points, TWO, reflectance=0.5, seen=False, shadow=False)
    result = bake(Scene((*scene.meshes, ghost), np.zeros(3)), replace(SETTINGS, minimum_size=0.3))
    walls, sheet = result.meshes
    # Of the furnace's own test, for the same rays.
    np.testing.assert_allclose(
        walls.radiosity, np.broadcast_to(expected["radiosity"], walls.radiosity.shape), rtol=5e-3
    )
    furnace = float(np.mean(expected["radiosity"]))
    assert sheet.irradiance.mean() == pytest.approx(furnace, rel=0.01)
    assert sheet.irradiance_back.mean() == pytest.approx(furnace, rel=0.01)
    assert abs(result.report["energy"]["imbalance"]) < 5e-3
    assert result.report["warnings"] == []


def test_an_emitter_that_rays_do_not_meet_lights_as_before():
    glow = square("Glow", 2.0, 0.2, turned=True, emission=5.0, baked=False)
    floor = grid("Floor", 0.0, reflectance=0.5)
    settings = replace(SETTINGS, quality="GOOD")
    solid = mean_irradiance(bake(Scene((floor, glow), np.zeros(3)), settings))
    ghost = mean_irradiance(bake(Scene((floor, replace(glow, seen=False, shadow=False)), np.zeros(3)), settings))
    # A mean over 81 vertices with a percent of noise each.
    assert ghost == pytest.approx(solid, rel=0.005)


def test_rays_meet_only_the_triangles_that_they_shall():
    points = np.array([(x, y, z) for z in (0.0, 1.0, 2.0) for x, y, _ in SQUARE])
    triangles = np.array([(4 * k + a, 4 * k + b, 4 * k + c) for k in range(3) for a, b, c in TWO])
    seen, shadow = np.repeat([True, False, True], 2), np.repeat([False, False, True], 2)
    rays = RayScene(points, triangles, 1, seen, shadow)
    up, down = np.array([[0, 0, 1]], np.float32), np.array([[0, 0, -1]], np.float32)
    start = rays.local(np.array([[0.3, 0.2, 0.5]]))
    assert rays.first_hits(start, up).triangle[0] // 2 == 2
    assert rays.first_hits(start, down).triangle[0] // 2 == 0
    assert rays.first_hits(rays.local(np.array([[0.3, 0.2, 2.5]])), up).triangle[0] == -1
    length = np.float32(rays.scale)
    assert not rays.visible(start, 3 * length * up[:, None])[0, 0]
    assert rays.visible(start, length * up[:, None])[0, 0] and rays.visible(start, 3 * length * down[:, None])[0, 0]
    rays.close()


def test_a_scene_in_which_nothing_hides_anything_can_be_traced():
    triangles = np.array([(0, 1, 2)])
    rays = RayScene(np.eye(3), triangles, 1, np.array([False]), np.array([False]))
    start, way = np.zeros((1, 3), np.float32), np.full((1, 3), 0.5, np.float32)
    assert rays.first_hits(start, way).triangle[0] == -1 and rays.visible(start, way[:, None])[0, 0]
    rays.close()


def test_relighting_knows_a_mesh_by_what_goes_through_it():
    shapes = {shapes_of(Scene((square("A", 0.0, seen=a, shadow=b),), np.zeros(3))) for a in (0, 1) for b in (0, 1)}
    assert len(shapes) == 4
