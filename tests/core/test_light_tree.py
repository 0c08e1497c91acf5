# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Many emitters: what is put together is right to a fraction of a percent, and costs no more for more of them."""

from dataclasses import replace

import numpy as np
import pytest
from radiosity_bake.core import many_lights
from radiosity_bake.core.direct import LUMINANCE, all_emitters, direct_light
from radiosity_bake.core.form_factors import point_to_triangle
from radiosity_bake.core.light_cut import cut
from radiosity_bake.core.light_tree import halved, light_tree
from radiosity_bake.core.lit_points import LitPoints
from radiosity_bake.core.reachability import lit_sides
from radiosity_bake.core.scene import Scene, surface_mesh
from radiosity_bake.core.surfaces import join
from radiosity_bake.core.visibility import RayScene

from tests.core.building import DARK, dense
from tests.scenes import exact

FLOOR = exact.rectangle("floor", (-3, -3, 0), (6, 0, 0), (0, 6, 0))


def bulbs(count: int, levels: int, seed: int = 0):
    """Spheres of 20 * 4^levels triangles that glow in several colours over the floor."""
    rng = np.random.default_rng(seed)
    vertices, triangles = exact.icosphere(levels)
    return [
        surface_mesh(
            f"bulb {k}",
            rng.uniform(0.04, 0.12) * vertices + rng.uniform([-2.5, -2.5, 0.7], [2.5, 2.5, 2.5]),
            triangles,
            emission=rng.uniform(1, 10, 3),
        )
        for k in range(count)
    ]


def receivers(count: int, seed: int = 1):
    """Places on the floor and, facing about, above it."""
    rng = np.random.default_rng(seed)
    points = np.append(rng.uniform(-2.5, 2.5, (count, 2)), np.zeros((count, 1)), axis=1)
    normals = np.tile([0.0, 0.0, 1.0], (count, 1))
    points[count // 2 :, 2] = rng.uniform(0.1, 2.0, count - count // 2)
    normals[count // 2 :] = rng.normal(size=(count - count // 2, 3))
    return points, normals / np.linalg.norm(normals, axis=1, keepdims=True)


def emitters_and_rays(meshes):
    surfaces = join(Scene((FLOOR, *meshes), DARK))
    rays = RayScene(surfaces.points, surfaces.triangles, 2)
    return all_emitters(surfaces, lit_sides(surfaces, rays, 0), rays, 0), rays


def exact_light(emitters, points, normals):
    """Unoccluded luminance of one-sided emitters, one by one."""
    total = np.zeros(len(points))
    for corners, normal, radiance in zip(emitters.corners, emitters.normals, emitters.radiance, strict=True):
        seen = (points - corners[0]) @ normal > 0.0
        total[seen] += point_to_triangle(points[seen], normals[seen], corners) * (radiance @ LUMINANCE)
    return total


def cut_light(emitters, points, normals, size=8):
    """The same by cuts for groups of so many receivers, and the mean number of nodes of a cut."""
    (tree, _), *others = emitters.trees
    assert not others
    order = halved(points, len(points) // size).reshape(-1, size)
    places = many_lights._Places(points[order], normals[order], normals[order], np.zeros((*order.shape, 2)))
    found = many_lights._cut_lights(tree, places)
    total = np.zeros(len(points))
    for k in range(size):
        total[order[:, k]] = np.bincount(found.group, found.light[k], len(order))
    return total, len(found.node) / len(order)


def test_halving_makes_parts_of_equal_size_that_lie_apart():
    points = np.random.default_rng(0).uniform(size=(1000, 2))
    order = halved(points, 4)
    assert np.array_equal(np.sort(order), np.arange(1000))
    boxes = [np.ptp(points[order[250 * k : 250 * (k + 1)]], axis=0).prod() for k in range(4)]
    # Four quarters of the square, as nearly as a thousand random points fill it.
    assert sum(boxes) < 1.02


@pytest.mark.parametrize("levels", [1, 2, 3])
def test_a_cut_of_the_tree_holds_the_light_of_all_to_a_fraction_of_a_percent(levels):
    emitters, _ = emitters_and_rays(bulbs(4, levels))
    points, normals = receivers(512)
    truth = exact_light(emitters, points, normals)
    found, _ = cut_light(emitters, points, normals)
    error = (found - truth) / truth.mean()
    # Far below what rays leave: a bake at HIGH may be off by 1%.
    assert np.sqrt(np.mean(error**2)) < 4e-3
    assert abs(error.mean()) < 2e-3


def test_the_walls_of_a_glowing_room_get_the_light_of_all_walls():
    # What a formula of points is off by has one sign in a closed room, and bounces add it up.
    surfaces = join(dense(exact.furnace(0.5, size=(1.0, 1.5, 0.8))[0], 4))
    rays = RayScene(surfaces.points, surfaces.triangles, 2)
    emitters = all_emitters(surfaces, lit_sides(surfaces, rays, 0), rays, 0)
    emitters = replace(emitters, enclosed=np.zeros_like(emitters.enclosed))
    chosen = np.arange(0, len(surfaces.triangles), 6)
    points = surfaces.points[surfaces.triangles[chosen]].mean(axis=1)
    found, _ = cut_light(emitters, points, surfaces.normals[chosen])
    error = found / (surfaces.emission[0] @ LUMINANCE) - 1.0
    assert abs(error.mean()) < 5e-4
    assert np.sqrt(np.mean(error**2)) < 1e-3


def test_what_a_receiver_costs_hardly_grows_with_the_number_of_lights():
    points, normals = receivers(256)
    nodes = []
    for levels in (2, 3, 4):
        emitters, _ = emitters_and_rays(bulbs(4, levels))
        nodes.append(cut_light(emitters, points, normals, 1)[1])
    # 1,280, 5,120 and 20,480 lights: sixteen times as many cost less than twice as much.
    assert nodes[2] < 2.0 * nodes[0]


@pytest.mark.parametrize("most", [0, 10**9])
def test_many_lights_give_the_light_of_each_where_nothing_hides_them(most, monkeypatch):
    monkeypatch.setattr("radiosity_bake.core.many_lights.MOST_EACH", most)
    emitters, rays = emitters_and_rays(bulbs(1, 2))
    points, normals = receivers(400)
    inside = np.linalg.norm(points - emitters.corners.mean(axis=(0, 1)), axis=1) < 0.2
    points, normals = points[~inside], normals[~inside]
    # Above the floor nothing but the bulb itself is there to hide it; what is below the floor's plane is not asked for.
    up = np.tile([0.0, 0.0, 1.0], (len(points), 1))
    light, uncertainty = direct_light(emitters, rays, LitPoints.of(points, up), 16, 0)
    found = light.irradiance(emitters.radiance) @ LUMINANCE
    truth = exact_light(emitters, points, up)
    # A convex bulb is seen whole: no ray decides anything, and what is left is the formula of distant lights.
    assert not uncertainty.any()
    np.testing.assert_allclose(found, truth, rtol=0.02, atol=2e-3 * truth.mean())
    assert found.mean() == pytest.approx(truth.mean(), rel=2e-3)


@pytest.mark.parametrize("most", [0, 10**9])
def test_many_lights_behind_a_sheet_are_right_in_the_mean(most, monkeypatch):
    monkeypatch.setattr("radiosity_bake.core.many_lights.MOST_EACH", most)
    vertices, triangles = exact.icosphere(2)
    bulb = surface_mesh("bulb", 0.15 * vertices + [0.35, 0.3, 1.0], triangles, emission=1.0)
    # Its edge hides from the point what of the bulb lies beyond x = 0.35 or so.
    sheet = exact.rectangle("sheet", (0.23, -3, 0.5), (2.8, 0, 0), (0, 6, 0))
    emitters, rays = emitters_and_rays([bulb, sheet])
    points = np.tile([0.1, 0.3, 0.0], (1000, 1))
    up = np.tile([0.0, 0.0, 1.0], (1000, 1))

    def found(shadow_rays):
        light, uncertainty = direct_light(emitters, rays, LitPoints.of(points, up), shadow_rays, 0)
        return light.irradiance(emitters.radiance) @ LUMINANCE, uncertainty

    few, stated = found(24)
    many, _ = found(768)
    # The share of a part is a ratio of sums over a few rays, which is off by a fraction of their noise.
    assert few.mean() == pytest.approx(many.mean(), rel=0.02)
    assert few.std() > 4 * many.std()
    # Four rays that all see the bulb, or do not, say nothing of the edge between them and the next four.
    assert 0.6 * few.std() < np.sqrt(np.mean(stated**2)) < 2 * few.std()


def test_the_inside_of_a_glowing_pot_is_enclosed_and_its_outside_is_not():
    vertices, triangles = exact.icosphere(2)
    # The top is cut off: a ninth of the sphere's directions get out.
    body = triangles[vertices[triangles].mean(axis=1)[:, 2] < 0.9]
    pot = surface_mesh("pot", 0.2 * vertices + [0, 0, 1], body, emission=1.0)
    emitters, _ = emitters_and_rays([pot])
    outside, inside = emitters.enclosed.mean(axis=0)
    assert outside == 0.0 and inside > 0.7
    assert len(emitters.trees) == 2


def test_a_hundred_thousand_lights_take_little_time_and_memory_to_sort():
    rng = np.random.default_rng(3)
    count = 100_000
    centre = rng.uniform(-5, 5, (count, 1, 3))
    corners = centre + rng.uniform(-0.01, 0.01, (count, 3, 3))
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    area = np.linalg.norm(normals, axis=1) / 2.0
    tree = light_tree(
        corners,
        normals / (2.0 * area[:, None]),
        area,
        np.ones(count),
        np.arange(count),
        np.zeros(count, dtype=np.int64),
    )
    assert np.array_equal(np.sort(tree.emitter), np.arange(count))
    assert tree.shape[1, 1] == pytest.approx(area.sum(), rel=1e-6)
    points, axes = np.zeros((1, 8, 3)) + [0, 0, 20.0], np.zeros((1, 8, 3)) + [0, 0, -1.0]
    found = cut(tree, points, axes)
    # A cloud of lights that face all ways, seen at an angle of a radian, is told by some hundred nodes.
    assert len(found.node) < 500
    facing = np.einsum("kx,kx->k", points[0, 0] - corners[:, 0], normals / (2.0 * area[:, None])) > 0.0
    truth = point_to_triangle(points[0, :1], axes[0, :1], corners[facing]).sum()
    assert found.light[0].sum() == pytest.approx(truth, rel=0.01)
