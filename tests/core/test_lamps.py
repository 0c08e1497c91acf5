# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Lamps: their closed forms over a floor, their shadows, and what a bake, a relight and the report make of them."""

from dataclasses import replace

import numpy as np
import pytest
from radiosity_bake.core import lamps as core_lamps
from radiosity_bake.core.bake import bake
from radiosity_bake.core.direct import all_emitters, direct_light
from radiosity_bake.core.errors import NoLightError
from radiosity_bake.core.lamp_shapes import FEW_LAMPS, PLACES, unoccluded, unoccluded_of_all
from radiosity_bake.core.lit_points import LitPoints
from radiosity_bake.core.reachability import lit_sides
from radiosity_bake.core.relight import ChangedSceneError, relight
from radiosity_bake.core.sampling import LATTICE_ERROR
from radiosity_bake.core.scene import AreaLamp, Cone, Falloff, PointLamp, Profile, Scene, SunLamp
from radiosity_bake.core.settings import BakeSettings
from radiosity_bake.core.surfaces import join
from radiosity_bake.core.visibility import RayScene

from tests.core.building import DARK, block
from tests.scenes import exact

UP, DOWN = np.array([0.0, 0.0, 1.0]), np.array([0.0, 0.0, -1.0])
WHITE = np.ones(3)
FLOOR = exact.rectangle("floor", (-3, -3, 0), (6, 0, 0), (0, 6, 0), reflectance=0.5)
ABOVE = np.array([0.0, 0.0, 1.5])
POINT = PointLamp("point", ABOVE, 0.0, np.array([3.0, 2.0, 1.0]))
DISK = AreaLamp("disk", ABOVE, np.array([[0.4, 0, 0], [0, 0.4, 0]]), DOWN, WHITE, elliptic=True)
SQUARE = replace(DISK, name="square", elliptic=False)
SUN = SunLamp("sun", np.array([0.6, 0.0, -0.8]), 0.0, WHITE)
COARSE = {"quality": "DRAFT", "threads": 2}

CUT_OFF = LATTICE_ERROR / 2.0 * PLACES**-0.75
"""Standard error of the share of a lamp that its `PLACES` find where a straight edge cuts it in two."""


def spread(count, seed=0):
    return np.append(np.random.default_rng(seed).uniform(-1, 1, (count, 2)), np.zeros((count, 1)), axis=1)


def from_above(lamp, points):
    """What the lamp gives points of a floor, unoccluded, for a strength of 1."""
    points = np.atleast_2d(np.asarray(points, dtype=float))
    return unoccluded(lamp, points, np.broadcast_to(UP, points.shape))


def direct(meshes, lamps, points, rays=64, normal=UP, seed=0):
    """Direct irradiance over pi at points of a scene, and how sure it is."""
    surfaces = join(Scene(tuple(meshes), DARK, tuple(lamps)))
    ray_scene = RayScene(surfaces.traced_points(), surfaces.triangles, 2)
    emitters = all_emitters(surfaces, lit_sides(surfaces, ray_scene, 0), ray_scene, 0)
    points = np.atleast_2d(np.asarray(points, dtype=float))
    normals = np.broadcast_to(np.asarray(normal, dtype=float), points.shape)
    light, doubt = direct_light(emitters, ray_scene, LitPoints.of(points, normals), rays, seed)
    return light.irradiance(emitters.strengths), doubt


@pytest.mark.parametrize("radius", [0.0, 0.3])
def test_a_point_lamp_gives_its_intensity_times_the_cosine_over_the_distance_squared(radius):
    points = spread(100)
    found, doubt = direct([FLOOR], [replace(POINT, radius=radius)], points)
    square = ((points - ABOVE) ** 2).sum(axis=1)
    truth = 1.5 / square**1.5 / np.pi
    np.testing.assert_allclose(found, truth[:, None] * [3.0, 2.0, 1.0], rtol=1e-6)
    assert not doubt.any()


def test_a_soft_point_lamp_is_a_disk_that_faces_the_receiver():
    points = spread(100)
    square = ((points - ABOVE) ** 2).sum(axis=1)
    truth = 1.5 / np.sqrt(square) / (square + 0.3**2) / np.pi
    np.testing.assert_allclose(from_above(replace(POINT, radius=0.3, soft=True), points), truth, rtol=1e-6)


def test_half_a_sphere_above_the_horizon_gives_half_a_disk():
    # The middle in the horizon: E = L (alpha - sin alpha cos alpha) over the half-angle alpha, with L = I / (pi r^2).
    lamp = PointLamp("ball", np.array([1.0, 0.0, 0.0]), 0.5, WHITE)
    alpha = np.arcsin(0.5)
    truth = (alpha - np.sin(alpha) * np.cos(alpha)) / (np.pi * 0.5**2) / np.pi
    # Places are weighted by their height, which halves what an edge costs.
    assert from_above(lamp, [0, 0, 0])[0] == pytest.approx(truth, rel=4 * CUT_OFF)


@pytest.mark.parametrize("height", [0.2, 1.0, 3.0])
def test_a_disk_gives_its_closed_form_on_its_axis(height):
    lamp = replace(DISK, centre=np.array([0.0, 0.0, height]))
    # 256 places of a smooth function, of which the lattice misses less than what an edge would cost.
    assert from_above(lamp, [0, 0, 0])[0] == pytest.approx(0.4**2 / (0.4**2 + height**2), rel=CUT_OFF)


def test_a_square_gives_its_exact_form_factor_and_nothing_behind_it():
    points = spread(100)
    truth = exact.rectangle_seen_from_below(points, (-0.4, -0.4, 1.5), 0.8, 0.8)
    np.testing.assert_allclose(from_above(SQUARE, points), truth, rtol=1e-9)
    assert not from_above(replace(SQUARE, normal=UP), points).any()
    assert not from_above(replace(DISK, normal=UP), points).any()


@pytest.mark.parametrize("spread_angle", [0.3, 1.5, 3.0])
@pytest.mark.parametrize("lamp", [DISK, SQUARE])
def test_the_power_of_an_area_lamp_does_not_depend_on_its_spread(lamp, spread_angle):
    # A small lamp, and a floor in rings that are even in the angle: power = sum of E times area = pi A L.
    small = replace(lamp, half_axes=lamp.half_axes * 0.01, spread=spread_angle)
    angle = (np.arange(4000) + 0.5) / 4000 * np.pi / 2
    radius = 1.5 * np.tan(angle)
    ring = 2 * np.pi * radius * 1.5 / np.cos(angle) ** 2 * (np.pi / 2 / 4000)
    power = (np.pi * from_above(small, np.stack([radius, 0 * radius, 0 * radius], axis=1)) * ring).sum()
    area = (np.pi if lamp.elliptic else 4.0) * 0.004**2
    # The lamp seen at 0.3 degrees rounds the rim of the narrowest cone off: 1% at most.
    assert power == pytest.approx(np.pi * area, rel=0.01)


def test_a_spot_is_full_in_its_middle_half_at_half_its_blend_and_dark_outside():
    cone = Cone(np.eye(3), np.cos(0.6), 0.5)
    spot, bare = replace(POINT, cone=cone), POINT
    cosines = 1.0 - (1.0 - np.cos(0.6)) * np.array([0.0, 0.49, 0.75, 0.999, 1.001])
    points = np.stack([1.5 * np.tan(np.arccos(cosines)), 0 * cosines, 0 * cosines], axis=1)
    share = from_above(spot, points) / from_above(bare, points)
    # Smooth steps from 0 to 1 over the outer half of the cone.
    np.testing.assert_allclose(share, [1.0, 1.0, 0.5, 3 * 0.002**2, 0.0], atol=1e-5)


def test_a_spot_that_is_turned_and_scaled_lights_an_ellipse():
    # Twice as wide along y, and turned to shine along +x.
    matrix = np.array([[0.0, 0, -1], [0, 2, 0], [1, 0, 0]])
    spot = PointLamp("spot", np.zeros(3), 0.0, WHITE, cone=Cone(np.linalg.inv(matrix), np.cos(0.3), 0.0))
    tangent = np.tan(0.3)
    points = np.array([[1, 1.98 * tangent, 0], [1, 2.02 * tangent, 0], [1, 0, 0.98 * tangent], [1, 0, 1.02 * tangent]])
    lit = unoccluded(spot, points, np.broadcast_to([-1.0, 0, 0], (4, 3))) > 0
    assert lit.tolist() == [True, False, True, False]


def profile_of(share, reach=np.pi, inverse=None, rows=180, columns=240):
    """A profile that is a function of the cosine to the axis and of the turn around it."""
    away = (np.arange(rows)[:, None] + 0.5) * reach / rows
    turn = np.arange(columns) * 2.0 * np.pi / columns
    return Profile(np.eye(3) if inverse is None else inverse, reach, share(np.cos(away), turn))


@pytest.mark.parametrize("radius", [0.0, 0.05])
def test_a_lamp_with_a_profile_gives_each_direction_its_share(radius):
    matrix = np.array([[0.0, 0, -1], [0, 2, 0], [1, 0, 0]])  # to shine along +x, and half as far apart along y
    profile = profile_of(lambda z, turn: 0.5 + 0.3 * z + 0.2 * z * np.sin(turn), inverse=np.linalg.inv(matrix))
    points = np.random.default_rng(2).normal(size=(200, 3)) * 4.0
    lamp = PointLamp("measured", np.zeros(3), radius, WHITE, profile=profile)
    toward = -points / np.linalg.norm(points, axis=1, keepdims=True)
    local = points @ np.linalg.inv(matrix).T
    z = -local[:, 2] / np.linalg.norm(local, axis=1)
    expected = 0.5 + 0.3 * z + 0.2 * z * local[:, 1] / np.hypot(local[:, 0], local[:, 1])
    found = unoccluded(lamp, points, toward) / unoccluded(replace(lamp, profile=None), points, toward)
    # Linear between 1 degree and 1.5: an eighth of the square of the step times the curvature, at the axis half a step.
    # A lamp that is seen as up to 1.4 degrees more is a mean over as much.
    seen = np.linalg.norm(points, axis=1) > 2.0
    np.testing.assert_allclose(found[seen], expected[seen], atol=0.01)


def test_a_profile_counts_where_a_lamp_is_cut_by_the_horizon_and_among_many_lamps():
    profile = profile_of(lambda z, turn: np.broadcast_to(0.25, (len(z), len(turn))))
    low = PointLamp("low", np.array([0.0, 0.0, 0.1]), 0.3, WHITE)
    points = np.array([[1.0, 0.0, 0.0], [0.0, 0.7, 0.0]])
    shaded = replace(low, profile=profile)
    np.testing.assert_allclose(from_above(shaded, points), 0.25 * from_above(low, points), rtol=1e-9)
    lamps = tuple(replace(POINT, centre=np.array([0.1 * k, 0.0, 1.5])) for k in range(40))
    all_shaded = tuple(replace(lamp, profile=profile) for lamp in lamps)
    (whole, _), (quarter, _) = (direct([FLOOR], some, spread(20)) for some in (lamps, all_shaded))
    np.testing.assert_allclose(quarter, 0.25 * whole, rtol=1e-6)


@pytest.mark.parametrize(("radius", "soft"), [(0.0, False), (0.4, True)])
@pytest.mark.parametrize("cone", [None, Cone(np.eye(3), np.cos(1.2), 0.1)])
def test_a_lamp_falls_off_as_it_is_told(radius, soft, cone):
    lamp = replace(POINT, radius=radius, soft=soft, cone=cone)
    points = np.array([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [2.0, 1.0, 0.0]])
    square = (points**2).sum(axis=1) + 1.5**2
    found = from_above(replace(lamp, falloff=Falloff(1, 0.5)), points) / from_above(lamp, points)
    # Of a lamp of some size, the middle counts where there is a closed form: its rim is 4% farther away at most, d^1.
    np.testing.assert_allclose(found, square**0.5 * square / (0.5 + square), rtol=0.05 if radius else 1e-9)


@pytest.mark.parametrize("angle", [0.0, 0.01, 0.5])
def test_a_sun_gives_its_strength_times_the_cosine(angle):
    found, _ = direct([FLOOR], [replace(SUN, angle=angle)], spread(20))
    np.testing.assert_allclose(found, 0.8 / np.pi, rtol=1e-6)


def test_a_block_throws_a_shadow_with_a_sharp_edge_where_the_lamp_is_a_point():
    # The top's edge at x = 0.5, z = 0.5 is seen from the lamp 1.5 above the middle at x = 0.75 on the floor.
    box = block("block", (-0.5, -0.5, 0.2), (0.5, 0.5, 0.5))
    found, doubt = direct([FLOOR, box], [POINT], [(0.749, 0, 0), (0.751, 0, 0)])
    assert found[0].max() == 0.0 and found[1].min() > 0.0 and not doubt.any()


def test_a_sun_throws_the_shadow_that_its_direction_asks_for():
    box = block("block", (-0.5, -0.5, 0.0), (0.5, 0.5, 0.8))
    found, _ = direct([FLOOR, box], [SUN], [(1.099, 0, 0), (1.101, 0, 0), (-0.6, 0, 0)])
    assert (found[:, 0] > 0.0).tolist() == [False, True, True]


def test_a_lamp_without_shadow_shines_through():
    box = block("block", (-0.5, -0.5, 0.2), (0.5, 0.5, 0.5))
    found, _ = direct([FLOOR, box], [replace(POINT, shadow=False)], [(0, 0, 0)])
    assert found[0, 0] == pytest.approx(3.0 / 1.5**2 / np.pi, rel=1e-6)


@pytest.mark.parametrize("lamp", [DISK, SQUARE, replace(POINT, radius=0.3), replace(POINT, radius=0.3, soft=True)])
def test_a_screen_that_hides_half_of_a_lamp_takes_half_of_its_light(lamp):
    # One edge passes below the lamp's middle, askew to the lamp's own edges; the others are far away.
    along, across = np.array([0.8, 0.6, 0.0]), np.array([-0.6, 0.8, 0.0])
    screen = exact.rectangle("screen", [0, 0, 0.75] - 2 * along, 4 * along, 2 * across)
    found, doubt = direct([FLOOR, screen], [lamp], np.zeros((400, 3)), rays=64)
    alone, _ = direct([FLOOR], [lamp], (0, 0, 0))
    share = found[:, 0] / alone[0, 0]
    # The receivers differ in their patterns alone: right in the mean, and each about as sure as it says.
    assert share.mean() == pytest.approx(0.5, abs=4 * share.std() / 20)
    assert 0.3 < share.std() / (doubt.mean() / (alone[0] @ [0.2126, 0.7152, 0.0722])) < 1.5


def test_a_lamp_in_the_plane_of_a_ceiling_shines_out_of_it():
    ceiling = exact.rectangle("ceiling", (-3, -3, 1.5), (0, 6, 0), (6, 0, 0), reflectance=0.5)
    points = spread(50)
    found, _ = direct([FLOOR, ceiling], [SQUARE], points)
    np.testing.assert_allclose(found[:, 0], from_above(SQUARE, points), rtol=1e-9)


@pytest.mark.parametrize("lamp", [POINT, replace(POINT, radius=0.2), DISK, SQUARE])
def test_light_does_not_depend_on_where_the_scene_is_and_how_large(lamp):
    box = block("block", (-0.5, -0.5, 0.2), (0.5, 0.5, 0.5))
    points = spread(200)
    at_home, _ = direct([FLOOR, box], [lamp], points)
    for by, times in ((1e3, 1.0), (0.0, 1e-3), (0.0, 1e3)):
        moved = [replace(mesh, vertices=mesh.vertices * times + by) for mesh in (FLOOR, box)]
        far = replace(lamp, centre=lamp.centre * times + by)
        if isinstance(lamp, PointLamp):
            far = replace(far, radius=lamp.radius * times, strength=lamp.strength * times**2)
        else:
            far = replace(far, half_axes=lamp.half_axes * times)
        found, _ = direct(moved, [far], points * times + by)
        # A ray at the very edge of the block may end on its other side: one of 64 of a few receivers.
        assert (np.abs(found - at_home).max(axis=1) > 1e-5 * at_home.max()).mean() < 0.02


def closed_room(*lamps, reflectance=0.5):
    return Scene((exact.closed_room((2, 2, 2), reflectance=reflectance),), DARK, lamps)


IN_ROOM = np.array([1.0, 1.0, 1.4])


def test_all_of_a_lamps_power_is_absorbed_in_a_closed_room():
    lamp = PointLamp("ball", IN_ROOM, 0.1, np.array([3.0, 2.0, 1.0]))
    energy = bake(closed_room(lamp), BakeSettings(**COARSE)).report["energy"]
    # 4 pi I over the channels; the patches' points are 16 each, spread evenly.
    assert energy["from_lamps"] == pytest.approx(4 * np.pi * 6.0, rel=0.005)
    assert energy["absorbed"] == pytest.approx(energy["from_lamps"], rel=0.01)
    assert energy["emitted"] == 0.0


def test_the_mean_light_of_a_room_follows_from_the_lamps_power():
    # Absorbed = power: (1 - rho) E A = 4 pi I, whatever the shape, as all walls reflect alike.
    lamp = PointLamp("ball", IN_ROOM, 0.1, WHITE)
    (mesh,) = bake(closed_room(lamp), BakeSettings(**COARSE)).meshes
    corners = mesh.vertices[mesh.triangles]
    area = np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1) / 2
    mean = (mesh.irradiance[:, :, 0].mean(axis=1) * area).sum() / area.sum()
    assert mean == pytest.approx(4 * np.pi / (0.5 * 24) / np.pi, rel=0.02)


@pytest.mark.parametrize("lamp", [replace(POINT, centre=IN_ROOM), replace(SQUARE, centre=IN_ROOM), SUN])
def test_a_scene_that_a_lamp_alone_lights_can_be_baked_with_any_number_of_threads(lamp):
    scene = closed_room(lamp) if lamp is not SUN else Scene((FLOOR,), DARK, (SUN,))
    one, two = (bake(scene, BakeSettings(quality="DRAFT", threads=threads)).meshes[0] for threads in (1, 2))
    assert one.irradiance.max() > 0.0
    assert one.irradiance.tobytes() == two.irradiance.tobytes()


def test_a_room_that_its_lamp_lights_from_within_is_lit_on_its_inner_side_only():
    surfaces = join(closed_room(replace(POINT, centre=IN_ROOM)))
    sides = lit_sides(surfaces, RayScene(surfaces.points, surfaces.triangles, 1), 0)
    assert sides.sum() == 1
    outside = join(closed_room(replace(POINT, centre=np.array([1.0, 1.0, 5.0]))))
    assert (lit_sides(outside, RayScene(outside.points, outside.triangles, 1), 0) != sides).all()


def test_lamps_that_are_all_dark_are_no_light():
    with pytest.raises(NoLightError):
        bake(closed_room(replace(POINT, strength=np.zeros(3))), BakeSettings(**COARSE))


def test_relighting_gives_what_a_bake_with_the_lamps_new_colour_gives():
    lamp = PointLamp("ball", IN_ROOM, 0.1, np.array([3.0, 2.0, 1.0]))
    scene, other = closed_room(lamp), closed_room(replace(lamp, strength=np.array([6.0, 4.0, 2.0])))
    settings = BakeSettings(**COARSE, keep_transport=True)
    relit = relight(bake(scene, settings).kept, other).meshes[0]
    np.testing.assert_allclose(relit.irradiance, bake(other, settings).meshes[0].irradiance, rtol=1e-6)


@pytest.mark.parametrize(
    ("changed", "sentence"),
    [
        (lambda lamp: (replace(lamp, centre=lamp.centre + 0.1),), '"ball" was changed or moved'),
        (lambda lamp: (replace(lamp, cone=Cone(np.eye(3), 0.5, 0.1)),), '"ball" was changed or moved'),
        (lambda lamp: (replace(lamp, profile=Profile(np.eye(3), 3.0, np.eye(4))),), '"ball" was changed or moved'),
        (lambda lamp: (replace(lamp, falloff=Falloff(1, 0.0)),), '"ball" was changed or moved'),
        (lambda lamp: (), "Lamps, or bright parts of the World, were added, removed or hidden"),
        (lambda lamp: (lamp, lamp), "Lamps, or bright parts of the World, were added, removed or hidden"),
    ],
)
def test_a_lamp_that_is_not_the_one_that_was_baked_is_refused(changed, sentence):
    lamp = PointLamp("ball", IN_ROOM, 0.1, WHITE)
    kept = bake(closed_room(lamp), BakeSettings(**COARSE, keep_transport=True)).kept
    with pytest.raises(ChangedSceneError, match=sentence):
        relight(kept, closed_room(*changed(lamp)))


def test_a_lamp_that_was_dark_in_the_bake_is_refused():
    lit, dark = PointLamp("ball", IN_ROOM, 0.1, WHITE), PointLamp("other", IN_ROOM, 0.0, np.zeros(3))
    kept = bake(closed_room(lit, dark), BakeSettings(**COARSE, keep_transport=True)).kept
    with pytest.raises(ChangedSceneError, match='"other" gave no light'):
        relight(kept, closed_room(lit, replace(dark, strength=WHITE)))


@pytest.mark.parametrize(
    "lamp",
    [
        replace(POINT, radius=0.4, cone=Cone(np.diag([1.0, 0.5, 0.7]), np.cos(0.5), 0.3)),
        replace(POINT, radius=0.4, soft=True, cone=Cone(np.eye(3), np.cos(1.2), 0.0)),
        replace(SQUARE, spread=0.8),
        replace(DISK, spread=2.5),
    ],
)
def test_receivers_outside_of_a_beam_that_are_left_out_would_get_nothing(lamp, monkeypatch):
    points = np.random.default_rng(0).uniform(-4, 1.2, (4000, 3))
    found = from_above(lamp, points)
    monkeypatch.setattr(
        "radiosity_bake.core.lamp_shapes._in_beam", lambda lamp, points: np.ones(len(points), dtype=bool)
    )
    np.testing.assert_array_equal(found, from_above(lamp, points))
    assert (found == 0.0).any() and (found > 0.0).any()


def many_lamps(count, strength=WHITE, seed=4):
    """Lamps of all kinds over the floor, most of them points, some of which are near it and some half below it."""
    drawn = np.random.default_rng(seed)
    lamps = []
    for k in range(count):
        place = np.append(drawn.uniform(-2.5, 2.5, 2), drawn.uniform(0.1, 2.0))
        kind = (SUN, DISK, replace(POINT, cone=Cone(np.eye(3), 0.7, 0.3)))[k % 20] if k % 20 < 3 else POINT
        if kind is SUN:
            lamps.append(replace(SUN, strength=0.01 * strength))
        elif isinstance(kind, AreaLamp):
            lamps.append(replace(DISK, centre=place, strength=strength))
        else:
            radius, soft = (0.0, 0.1, 0.3)[k % 3], k % 2 == 0
            lamps.append(replace(kind, centre=place, radius=radius, soft=soft, strength=strength))
    return tuple(lamps)


def test_many_lamps_at_once_send_what_each_sends():
    lamps = many_lamps(FEW_LAMPS + 50)
    points, normals = spread(40), np.random.default_rng(1).normal(size=(40, 3))
    normals /= np.linalg.norm(normals, axis=1)[:, None]
    single = np.stack([unoccluded(lamp, points, normals) for lamp in lamps])
    # One by one, a lamp's disk is turned to the receiver in single precision.
    np.testing.assert_allclose(unoccluded_of_all(lamps, points, normals), single, rtol=1e-7, atol=1e-12)


def test_many_lamps_that_nothing_hides_are_exact():
    lamps, points = many_lamps(200), spread(30)
    light, doubt = direct([FLOOR], lamps, points)
    exactly = sum(from_above(lamp, points) * lamp.strength[0] for lamp in lamps)
    np.testing.assert_allclose(light[:, 0], exactly, rtol=1e-6)
    assert not doubt.any()


def test_shadows_of_many_lamps_are_right_within_their_doubt(monkeypatch):
    lamps, points = many_lamps(200), 2.0 * spread(200, 3)
    board = block("board", (-0.8, -0.6, 0.3), (0.7, 0.9, 0.35))
    some, doubt = direct([FLOOR, board], lamps, points, 64)
    monkeypatch.setattr(core_lamps, "FEW_LAMPS", len(lamps))
    each, _ = direct([FLOOR, board], lamps, points, 4096)
    error = some[:, 0] - each[:, 0]
    # Rays at equal steps over lamps in order do better than the independent ones that the doubt is of.
    assert np.sqrt((error**2).mean()) < np.sqrt((doubt**2).mean())
    # The mean of 200 receivers that share lamps: within 3 sigma of one tenth of them.
    assert abs(error.mean()) < 3.0 * np.sqrt((doubt**2).mean() / 20.0)


def test_a_thousand_lamps_cost_no_more_rays_than_dozens():
    traced = []
    for count in (40, 1000):
        scene = Scene((FLOOR,), DARK, many_lamps(count, WHITE / count))
        traced.append(bake(scene, BakeSettings(**COARSE)).report["rays_by_kind"])
    assert traced[1]["gather"] < 1.5 * traced[0]["gather"]
    assert traced[1]["patches"] < 1.5 * traced[0]["patches"]
