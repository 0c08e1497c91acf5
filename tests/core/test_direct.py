# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Light from emitters: exact where they are seen whole, right in the mean where in part, nothing where hidden."""

from dataclasses import replace

import numpy as np
import pytest
from radiosity_bake.core.bake import bake
from radiosity_bake.core.direct import all_emitters, direct_light
from radiosity_bake.core.lit_points import LitPoints
from radiosity_bake.core.reachability import lit_sides
from radiosity_bake.core.sampling import LATTICE_ERROR, triangle_lattice
from radiosity_bake.core.scene import Scene, surface_mesh
from radiosity_bake.core.settings import BakeSettings
from radiosity_bake.core.surfaces import join
from radiosity_bake.core.visibility import RayScene

from tests.core.building import DARK, block, grid, moved
from tests.scenes import exact, oracle

UP = np.array([0.0, 0.0, 1.0])
FLOOR = exact.rectangle("floor", (-3, -3, 0), (6, 0, 0), (0, 6, 0))
LAMP = exact.rectangle("lamp", (0.1, -0.2, 1.0), (0, 0.3, 0), (0.5, 0, 0), emission=(3.0, 2.0, 1.0))


def direct(meshes, points, normals=UP, rays=16, seed=0, lift=None):
    """Direct irradiance over pi at points of a scene, and whether each saw some emitter in part."""
    surfaces = join(Scene(tuple(meshes), DARK))
    ray_scene = RayScene(surfaces.points, surfaces.triangles, 2)
    emitters = all_emitters(surfaces, lit_sides(surfaces, ray_scene, 0), ray_scene, 0)
    points = np.atleast_2d(np.asarray(points, dtype=float))
    normals = np.broadcast_to(np.asarray(normals, dtype=float), points.shape)
    lift = normals if lift is None else np.broadcast_to(np.asarray(lift, dtype=float), points.shape)
    at = replace(LitPoints.of(points, normals), lift=lift)
    light, uncertainty = direct_light(emitters, ray_scene, at, rays, seed)
    return light.irradiance(emitters.radiance), uncertainty


def spread(count, seed=0):
    return np.append(np.random.default_rng(seed).uniform(-1, 1, (count, 2)), np.zeros((count, 1)), axis=1)


def test_an_emitter_seen_whole_gives_its_exact_light():
    points = spread(200)
    found, uncertainty = direct([FLOOR, LAMP], points)
    truth = exact.rectangle_seen_from_below(points, (0.1, -0.2, 1.0), 0.5, 0.3)[:, None] * [3.0, 2.0, 1.0]
    # Visibility is 1 whatever rays are drawn, so nothing is left to chance.
    np.testing.assert_allclose(found, truth, rtol=1e-9)
    assert not uncertainty.any()


@pytest.mark.parametrize("rays", [1, 2, 3, 16])
def test_few_shadow_rays_are_right_in_the_mean(rays):
    # The lamp's two triangles share the rays; one of them may get none and is then weighted by its probability.
    points = np.broadcast_to([0.3, 0.1, 0.0], (4000, 3))
    found, _ = direct([FLOOR, LAMP], points, rays=rays)
    truth = exact.rectangle_seen_from_below(points[:1], (0.1, -0.2, 1.0), 0.5, 0.3)[0] * 3.0
    error = found[:, 0].std() / np.sqrt(4000)
    assert found[:, 0].mean() == pytest.approx(truth, abs=4 * error + 1e-9 * truth)


def test_an_emitter_seen_edge_on_gives_nothing():
    lamp = exact.rectangle("lamp", (1, -1, 0), (0, 2, 0), (1, 0, 0), emission=1.0)
    found, _ = direct([lamp, LAMP], [(0, 0, 0.0)])
    alone, _ = direct([LAMP], [(0, 0, 0.0)])
    np.testing.assert_allclose(found, alone, rtol=1e-6, atol=1e-12)


@pytest.mark.parametrize("angle", [0, 17, 45, 73])
@pytest.mark.parametrize("by", [0.0, 1e3])
def test_a_lamp_does_not_light_itself(angle, by):
    a = np.radians(angle)
    u, v = np.array([np.cos(a), np.sin(a), 0.3]), np.array([-np.sin(a), np.cos(a), 0.7])
    lamp = exact.rectangle("lamp", (by, 0.3 * by, 0.1), u, v, emission=1.0, reflectance=0.5)
    result = bake(Scene((lamp,), DARK), BakeSettings(quality="DRAFT"))
    assert np.abs(result.meshes[0].irradiance).max() == 0.0
    np.testing.assert_allclose(result.meshes[0].radiosity, 1.0)


def test_of_an_emitter_partly_below_the_horizon_the_part_above_counts():
    # A lamp that stands upright through the floor's plane; there is no floor that would hide its lower part.
    lamp = exact.rectangle("lamp", (1, -1, -1), (0, 0, 3), (0, 2, 0), emission=1.0)
    points = spread(50) * [0.5, 1, 1]
    found, _ = direct([lamp, exact.rectangle("far", (9, 9, 9), (1, 0, 0), (0, 1, 0))], points)
    above = [(1, -1, 0), (1, -1, 2), (1, 1, 2), (1, 1, 0)]
    truth = [max(oracle.point_to_polygon(p, UP, above), oracle.point_to_polygon(p, UP, above[::-1])) for p in points]
    np.testing.assert_allclose(found[:, 0], truth, rtol=1e-9)


def test_a_floor_that_hides_the_lower_part_of_a_lamp_changes_nothing():
    lamp = exact.rectangle("lamp", (1, -1, -1), (0, 0, 3), (0, 2, 0), emission=1.0)
    points = spread(50) * [0.5, 1, 1]
    without, _ = direct([lamp], points)
    found, _ = direct([lamp, FLOOR], points)
    # What lies below the horizon has no share in the sampling, so no ray to it is counted as blocked.
    np.testing.assert_allclose(found, without, rtol=1e-6)


def test_the_light_of_two_emitters_adds_up():
    other = exact.rectangle("other", (-1, 0.5, 0.7), (0, 0.2, 0), (0.2, 0, 0), emission=(0.0, 5.0, 20.0))
    points = spread(100)
    both, _ = direct([FLOOR, LAMP, other], points, rays=32)
    first, _ = direct([FLOOR, LAMP], points)
    second, _ = direct([FLOOR, other], points)
    # Where each is due a ray at least, both are seen whole; elsewhere the weaker is drawn by chance, right in the mean.
    np.testing.assert_allclose(both.mean(axis=0), (first + second).mean(axis=0), rtol=0.02)
    assert np.isclose(both, first + second).mean() > 0.5


def test_an_emitter_behind_a_blocker_gives_nothing():
    sheet = exact.rectangle("sheet", (-4, -4, 0.5), (8, 0, 0), (0, 8, 0))
    found, uncertainty = direct([FLOOR, LAMP, sheet], spread(100))
    assert not found.any() and not uncertainty.any()


def test_an_emitter_below_the_surface_gives_nothing_to_a_leaning_normal():
    leaning = np.array([0.8, 0.0, 0.6])
    lamp = exact.rectangle("lamp", (1, -0.5, -1), (0, 0, 0.9), (0, 1, 0), emission=1.0)
    found, _ = direct([lamp, exact.rectangle("far", (9, 9, 9), (1, 0, 0), (0, 1, 0))], [(0, 0, 0)], leaning, lift=UP)
    assert not found.any()


def test_a_half_covered_lamp_gives_the_light_of_its_visible_half():
    # A black sheet at half height hides from the point what of the lamp lies beyond x = 0.35, half of it.
    sheet = exact.rectangle("sheet", (0.175, -5, 0.5), (9, 0, 0), (0, 10, 0))
    points = np.zeros((2000, 3))
    found, uncertainty = direct([LAMP, sheet, FLOOR], points, rays=32)
    truth = float(exact.rectangle_seen_from_below(points[:1], (0.1, -0.2, 1.0), 0.25, 0.3)[0]) * 3.0
    assert (uncertainty > 0).all()
    # 2,000 patterns of 32 rays: the standard error of their mean; shadow rays are drawn over area, not over the factor,
    # and weighted by it.
    error = found[:, 0].std() / np.sqrt(2000)
    assert error < 0.01 * truth
    assert found[:, 0].mean() == pytest.approx(truth, abs=4 * error)
    assert found[:, 0].std() < 0.2 * truth


def test_more_shadow_rays_narrow_the_penumbra():
    sheet = exact.rectangle("sheet", (0.175, -5, 0.5), (9, 0, 0), (0, 10, 0))
    noise = [direct([LAMP, sheet, FLOOR], np.zeros((500, 3)), rays=n)[0][:, 0].std() for n in (8, 32, 128)]
    # Independent rays would halve it each time.
    assert noise[1] < 0.6 * noise[0] and noise[2] < 0.6 * noise[1]


@pytest.mark.parametrize("rays", [8, 32, 128, 512])
def test_a_lattice_finds_the_share_behind_a_straight_edge_to_its_stated_error(rays):
    rng = np.random.default_rng(rays)
    # Lines in random directions and places over an equilateral triangle, given by the heights of its corners over them.
    angle = rng.uniform(0, 2 * np.pi, 4000)[:, None] + [0.0, 2 * np.pi / 3, 4 * np.pi / 3]
    height = np.cos(angle)
    height -= rng.uniform(height.min(axis=1), height.max(axis=1))[:, None]
    low, middle, high = np.sort(height, axis=1).T
    below = np.where(
        middle > 0, low**2 / ((middle - low) * (high - low)), 1 - high**2 / ((high - middle) * (high - low))
    )
    error = [
        np.mean((height @ triangle_lattice(rays, shift).T < 0.0), axis=1) - below for shift in rng.uniform(size=(16, 2))
    ]
    stated = LATTICE_ERROR * np.sqrt(np.mean(below * (1 - below))) * rays**-0.75
    # 64,000 lines; what is uncertain is the law itself, and how it goes on to more points.
    assert np.sqrt(np.mean(np.square(error))) == pytest.approx(stated, rel=0.15)


@pytest.mark.parametrize("angle", [0.0, 0.3, 1.1])
def test_a_wall_is_seen_whole_from_places_close_beside_it(angle):
    # Rays that graze a wall must not slip through it, or stop at it, whatever way the room is turned.
    c, s = np.cos(angle), np.sin(angle)
    turn = np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]]) @ np.array([[1, 0, 0], [0, c, -s], [0, s, c]])
    walls = [
        surface_mesh(w.name, w.vertices @ turn.T, w.triangles, emission=1.0)
        for w in exact.box_walls((1, 2, 0.5), emission=1.0)
    ]
    points = np.array([[0.5 + 0.01 * k, 10.0**-d, 0.0] for k in range(20) for d in (1, 2, 3, 4)])
    found, uncertainty = direct(walls, points @ turn.T, turn[:, 2], rays=64)
    # In a closed room that glows everywhere the hemisphere is full.
    np.testing.assert_allclose(found, 1.0, rtol=1e-9)
    assert not uncertainty.any()


def test_the_inside_of_a_glowing_solid_is_no_emitter():
    surfaces = join(Scene((FLOOR, block("bulb", (0, 0, 1), (0.2, 0.2, 1.2), emission=1.0)), DARK))
    ray_scene = RayScene(surfaces.points, surfaces.triangles, 1)
    emitters = all_emitters(surfaces, lit_sides(surfaces, ray_scene, 0), ray_scene, 0)
    assert len(emitters.triangle) == 12 and emitters.one_sided.all()


def test_a_convex_solid_lamp_gives_the_light_of_the_sides_that_face_a_point():
    bulb = block("bulb", (-0.2, -0.3, 1.0), (0.3, 0.2, 1.4), emission=1.0, turned=30)
    points = spread(60)
    found, _ = direct([FLOOR, bulb], points, rays=64)
    corners = bulb.vertices[bulb.triangles]
    truth = np.array([sum(oracle.point_to_polygon(p, UP, t) for t in corners) for p in points])
    # Sides that are seen are seen whole; only those due less than a ray are drawn by chance.
    np.testing.assert_allclose(found[:, 0], truth, rtol=0.05)
    assert found[:, 0].mean() == pytest.approx(truth.mean(), rel=2e-3)


def many_lamps(cells: int):
    """The lamp cut into cells x cells squares of two triangles."""
    small = grid("lamp", cells)
    vertices = small.vertices[:, [1, 0, 2]] * [0.5, 0.3, 0] + [0.1, -0.2, 1.0]
    return surface_mesh("lamp", vertices, small.triangles, emission=(3.0, 2.0, 1.0))


def test_thousands_of_tiny_emitters_give_the_light_of_one_as_large():
    lamp = many_lamps(45)
    assert len(lamp.triangles) > 4000
    points = spread(300)
    found, _ = direct([FLOOR, lamp], points, rays=16)
    truth = exact.rectangle_seen_from_below(points, (0.1, -0.2, 1.0), 0.5, 0.3) * 3.0
    # 16 rays stand for 4,050 emitters, drawn nearly in proportion to what each sends: little is left to chance.
    np.testing.assert_allclose(found[:, 0], truth, rtol=0.05)
    assert found[:, 0].mean() == pytest.approx(truth.mean(), rel=2e-3)


def test_lights_of_many_colours_do_not_speckle_where_nothing_hides_them():
    # A screen of 36 squares, 72 triangles: more than get a ray each.
    colours = np.random.default_rng(1).uniform(0.0, 4.0, (36, 3))
    corners = [(x / 2, y / 2, 1.0) for x in range(-3, 3) for y in range(-3, 3)]
    screen = [
        exact.rectangle("square", corner, (0, 0.5, 0), (0.5, 0, 0), emission=colour)
        for corner, colour in zip(corners, colours, strict=True)
    ]
    points = spread(500)
    found, _ = direct([FLOOR, *screen], points)
    factors = np.array([exact.rectangle_seen_from_below(points, corner, 0.5, 0.5) for corner in corners])
    # What is left is the formula of distant lights, off by a hundredth at most for any of them.
    np.testing.assert_allclose(found, factors.T @ colours, rtol=0.01)


def test_emitters_of_a_colour_without_weight_in_luminance_still_shine():
    # Blue counts 7% only, and next to a bright green lamp less.
    blue = exact.rectangle("blue", (-1, 0.5, 0.7), (0, 0.2, 0), (0.2, 0, 0), emission=(0.0, 0.0, 1.0))
    green = exact.rectangle("green", (1, 0.5, 0.7), (0, 0.2, 0), (0.2, 0, 0), emission=(0.0, 100.0, 0.0))
    points = np.zeros((4000, 3))
    alone, _ = direct([FLOOR, blue], points[:1])
    found, _ = direct([FLOOR, blue, green], points, rays=16)
    error = found[:, 2].std() / np.sqrt(len(points))
    assert found[:, 2].mean() == pytest.approx(alone[0, 2], abs=4 * error)


@pytest.mark.parametrize("scale", [1e-3, 1e3])
def test_direct_light_does_not_change_with_size(scale):
    scene = moved(Scene((FLOOR, LAMP), DARK), scale)
    points = spread(20)
    found, _ = direct(scene.meshes, points * scale)
    truth, _ = direct([FLOOR, LAMP], points)
    np.testing.assert_allclose(found, truth, rtol=1e-9)
