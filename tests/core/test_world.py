# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Worlds that are not even: the map, the suns taken out of it, and what they light."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from radiosity_bake.core.bake import bake
from radiosity_bake.core.relight import ChangedSceneError, relight
from radiosity_bake.core.sampling import hemisphere_lattice
from radiosity_bake.core.scene import Scene, surface_mesh
from radiosity_bake.core.settings import BakeSettings
from radiosity_bake.core.world import (
    MAP_CELLS,
    MOST_SUNS,
    MOST_WINDOWS,
    WHOLE_FACES,
    SkyCube,
    map_cells,
    sky_map,
    split_sky,
    window_corners,
    window_samples,
)

FACE = 128

SQUARE = [(-1.0, -1.0, 0.0), (1.0, -1.0, 0.0), (1.0, 1.0, 0.0), (-1.0, 1.0, 0.0)]
HALVES = [(0, 1, 2), (0, 2, 3)]


def sky_of(radiance):
    """The sky whose radiance is a function of unit directions (n, 3), in grey."""
    samples = window_samples(WHOLE_FACES, np.zeros((6, FACE, FACE, 3)))
    return replace(samples, radiance=np.repeat(radiance(samples.directions)[:, None], 3, axis=1).astype(float))


def sun_at(direction, degrees, radiance, around=1.0):
    """A function of directions: a disc of so many degrees across in an even sky."""
    toward = np.array(direction) / np.linalg.norm(direction)
    return lambda d: np.where(d @ toward > np.cos(np.radians(degrees / 2.0)), radiance, around)


def irradiance(sky, normal):
    """Irradiance over pi of an open surface."""
    return np.maximum(sky.directions @ normal, 0.0) * sky.solid_angles @ sky.radiance[:, 0] / np.pi


def seen_by_rays(sky, suns, normal):
    """The same by 384 rays that look up the map, and by the suns."""
    other = np.cross(normal, [0.3, 0.5, 0.8])
    other /= np.linalg.norm(other)
    directions = hemisphere_lattice(384, 1) @ np.stack([other, np.cross(normal, other), normal])
    light = sum(max(0.0, float(-sun.direction @ normal)) * sun.strength[0] for sun in suns) / np.pi
    return sky[map_cells(directions), 0].mean() + light


def floor_under(world, lamps=(), more=()):
    mesh = surface_mesh("floor", SQUARE, HALVES, reflectance=0.5)
    return Scene((mesh, *more), np.asarray(world, dtype=float), tuple(lamps))


def settings(**values):
    return BakeSettings(quality="DRAFT", threads=1, **values)


def test_the_texels_of_the_cube_make_up_the_sphere():
    sky = window_samples(WHOLE_FACES, np.zeros((6, FACE, FACE, 3)))
    # The middle rule: an error of the order of the square of a texel's size.
    assert sky.solid_angles.sum() == pytest.approx(4.0 * np.pi, rel=(2.0 / FACE) ** 2)
    np.testing.assert_allclose(np.linalg.norm(sky.directions, axis=1), 1.0, rtol=1e-12)
    np.testing.assert_allclose(sky.solid_angles @ sky.directions, 0.0, atol=1e-9)


def test_windows_lie_where_their_texels_look():
    windows = np.array([(0, -1.0, -1.0, 2.0), (3, 0.25, -0.5, 0.125)])
    corners = window_corners(windows)
    sky = window_samples(windows, np.zeros((2, 4, 4, 3)))
    middles = sky.directions.reshape(2, 16, 3).mean(axis=1)
    for middle, window in zip(middles, corners, strict=True):
        centre = window.mean(axis=0)
        np.testing.assert_allclose(middle / np.linalg.norm(middle), centre / np.linalg.norm(centre), atol=2e-3)


def test_every_cell_of_the_map_is_met_and_neighbours_in_it_are_neighbours_in_the_sky():
    sky = window_samples(WHOLE_FACES, np.zeros((6, FACE, FACE, 3)))
    cells = map_cells(sky.directions)
    count = np.bincount(cells, minlength=MAP_CELLS)
    assert count.min() > 0
    middle = np.stack([np.bincount(cells, weights=c, minlength=MAP_CELLS) for c in sky.directions.T], axis=1)
    middle /= np.linalg.norm(middle, axis=1)[:, None]
    # 4 pi over 4,096 cells is 3.2 degrees across; the widest are twice as wide as that along their diagonal.
    assert np.arccos(np.einsum("nx,nx->n", sky.directions, middle[cells])).max() < np.radians(4.5)


def test_an_even_sky_stays_even_and_has_no_sun():
    radiance, suns = split_sky(sky_of(lambda d: np.full(len(d), 0.7)), "Sky")
    assert suns == ()
    np.testing.assert_allclose(radiance, 0.7, rtol=1e-12)


def test_the_map_keeps_a_smooth_sky():
    sky = sky_of(lambda d: 1.0 + d[:, 2] + 0.5 * d[:, 0] * d[:, 1])
    radiance = sky_map(sky)
    for normal in np.eye(3):
        # Rays see the middles of cells of 3 degrees, 0.02 off where the gradient is 1, and 384 rays 0.001: 4 sigma.
        assert seen_by_rays(radiance, (), normal) == pytest.approx(irradiance(sky, normal), rel=4e-3)


@pytest.mark.parametrize("degrees", [2.0, 5.0, 12.0])
def test_a_disc_becomes_one_sun_of_its_size_place_and_light(degrees):
    direction = np.array([0.3, -0.5, 0.7]) / np.linalg.norm([0.3, -0.5, 0.7])
    sky = sky_of(sun_at(direction, degrees, 5000.0))
    radiance, (sun,) = split_sky(sky, "Sky")
    assert sun.of_world and sun.name == "Sky"
    texel = 90.0 / FACE
    assert np.degrees(np.arccos(-sun.direction @ direction)) < 0.1 * texel
    assert np.degrees(sun.angle) == pytest.approx(degrees, abs=0.5 * texel)
    # What is left of the disc is the limit above which it was taken out.
    assert radiance.max() < 40.0
    for normal in (np.array([0.0, 0.0, 1.0]), direction):
        assert seen_by_rays(radiance, (sun,), normal) == pytest.approx(irradiance(sky, normal), rel=2e-3)


def test_a_sun_with_a_glow_keeps_its_size():
    direction = np.array([0.0, 0.6, 0.8])

    def shine(d):
        away = np.arccos(np.clip(d @ direction, -1.0, 1.0))
        return 1.0 + 200.0 * np.exp(-away / np.radians(4.0)) + np.where(away < np.radians(1.0), 1e5, 0.0)

    _, suns = split_sky(sky_of(shine), "Sky")
    assert np.degrees(suns[0].angle) == pytest.approx(2.0, abs=0.4)
    assert suns[0].strength[0] > sum(sun.strength[0] for sun in suns[1:])


def test_two_lamps_become_two_suns_and_a_bar_becomes_several():
    def two(d):
        return sum(sun_at(at, 4.0, 500.0, 0.5)(d) for at in ([1, 0, 1], [-1, 0.3, 1]))

    def bar(d):
        return np.where((np.abs(d[:, 0]) < 0.03) & (np.abs(d[:, 1]) < 0.5) & (d[:, 2] > 0), 500.0, 0.5)

    assert len(split_sky(sky_of(two), "Sky")[1]) == 2
    suns = split_sky(sky_of(bar), "Sky")[1]
    assert 3 <= len(suns) <= MOST_SUNS
    assert max(np.degrees(sun.angle) for sun in suns) < 25.0


@pytest.mark.parametrize("turned", [0.0, 30.0, 90.0])
def test_a_tube_that_is_no_wider_than_a_spot_becomes_a_row_of_suns(turned):
    # 16 by 2 degrees: as wide as a disc of 9 degrees, which alone would not be split.
    turn = np.radians(turned)
    along, across = np.array([np.cos(turn), np.sin(turn)]), np.array([-np.sin(turn), np.cos(turn)])

    def tube(d):
        here = (np.abs(d[:, :2] @ along) < np.sin(np.radians(8.0))) & (np.abs(d[:, :2] @ across) < np.radians(1.0))
        return np.where(here & (d[:, 2] > 0), 500.0, 0.5)

    suns = split_sky(sky_of(tube), "Sky")[1]
    assert len(suns) >= 3
    places = np.array([-sun.direction for sun in suns])
    assert np.ptp(places[:, :2] @ along) > np.sin(np.radians(8.0))
    # Half of a texel of 0.7 degrees.
    assert np.abs(places[:, :2] @ across).max() < np.radians(0.35)


def test_another_seed_turns_the_rays_that_look_for_light_at_vertices():
    # An open floor sees nothing but the sky: what its vertices gather is all that can differ.
    world = sky_map(sky_of(lambda d: 1.0 + d[:, 2] + 0.5 * d[:, 0]))
    one, other = (bake(floor_under(world), settings(seed=seed)).meshes[0].irradiance for seed in (0, 1))
    assert not np.array_equal(one, other)
    np.testing.assert_allclose(one, other, rtol=0.02)


def test_a_bright_place_is_looked_at_closer_and_nothing_is_counted_twice():
    shine = sun_at([1.0, 0.013, 0.02], 1.0, 1e5)
    cube = SkyCube(sky_of(shine).radiance.reshape(6, FACE, FACE, 3))
    windows = cube.bright_windows()
    assert 1 <= len(windows) <= MOST_WINDOWS
    near = window_samples(windows, np.zeros((len(windows), 256, 256, 3)))
    found = np.repeat(shine(near.directions)[:, None], 3, axis=1).reshape(-1, 256, 256, 3)
    sky = cube.with_windows(windows, found)
    assert sky.solid_angles.sum() == pytest.approx(4.0 * np.pi, rel=1e-3)
    light = 2.0 * np.pi * (1.0 - np.cos(np.radians(0.5))) * (1e5 - 1.0)
    # 1,600 samples lie in the disc; where its rim falls between them makes 3 more or less, one sigma.
    assert sky.solid_angles @ (sky.radiance[:, 0] - 1.0) == pytest.approx(light, rel=8e-3)


def test_an_open_floor_has_the_light_of_its_sky():
    sky = sky_of(lambda d: 1.0 + np.maximum(d[:, 2], 0.0))
    result = bake(floor_under(sky_map(sky)), settings())
    # 1 + the mean of the cosine, weighted by the cosine: 1 + 2/3. 64 rays and cells of 3 degrees.
    np.testing.assert_allclose(result.meshes[0].irradiance, 5.0 / 3.0, rtol=5e-3)
    energy = result.report["energy"]
    assert energy["from_world"] == pytest.approx(3.0 * 2.0 * 4.0 * np.pi * (1.0 + 1.0 / 3.0), rel=0.02)
    assert energy["from_lamps"] == 0.0
    assert abs(energy["imbalance"]) < 1e-6


def test_a_wall_hides_the_bright_half_of_the_sky():
    sky = sky_of(lambda d: np.where(d[:, 0] > 0.0, 3.0, 1.0))
    wall = surface_mesh("wall", [(1.01, -90, 0), (1.01, 90, 0), (1.01, 90, 200), (1.01, -90, 200)], HALVES, baked=False)
    result = bake(floor_under(sky_map(sky), more=[wall]), settings(output="ORIGINAL"))
    right = np.array(result.meshes[0].irradiance)
    # Half a hemisphere of 1; the wall ends at 90 m, and the smooth map blurs the step over 3 degrees.
    assert right.min() == pytest.approx(0.5, abs=0.05)


def test_suns_of_the_world_count_as_world_in_the_balance():
    _, (sun,) = split_sky(sky_of(sun_at([0, 0, 1], 6.0, 5000.0)), "Sky")
    dark = np.full((MAP_CELLS, 3), 1e-6)
    energy = bake(floor_under(dark, [sun]), settings()).report["energy"]
    assert energy["from_world"] == pytest.approx(4.0 * sun.strength.sum(), rel=2e-3)
    assert energy["from_lamps"] == 0.0


def test_a_map_of_one_colour_gives_what_the_colour_gives():
    block = surface_mesh("block", np.array(SQUARE) * 0.4 + [0, 0, 0.5], HALVES, reflectance=0.5)
    even, mapped = (
        bake(floor_under(world, more=[block]), settings())
        for world in ((0.2, 0.5, 1.0), np.tile((0.2, 0.5, 1.0), (MAP_CELLS, 1)))
    )
    for one, other in zip(even.meshes, mapped.meshes, strict=True):
        np.testing.assert_allclose(one.irradiance, other.irradiance, rtol=1e-6)


def test_relighting_follows_the_map():
    sky = sky_map(sky_of(lambda d: 1.0 + d[:, 2]))
    kept = bake(floor_under(sky), settings(keep_transport=True)).kept
    again = relight(kept, floor_under(2.0 * sky)).meshes[0].irradiance
    np.testing.assert_allclose(again, 2.0 * bake(floor_under(sky), settings()).meshes[0].irradiance, rtol=1e-6)
    even = relight(kept, floor_under((0.3, 0.3, 0.3))).meshes[0].irradiance
    np.testing.assert_allclose(even, 0.3, rtol=1e-6)


def test_relighting_an_even_world_with_a_map_is_refused():
    kept = bake(floor_under((1.0, 1.0, 1.0)), settings(keep_transport=True)).kept
    with pytest.raises(ChangedSceneError, match="same to all sides"):
        relight(kept, floor_under(np.ones((MAP_CELLS, 3))))


def test_a_stronger_sky_has_the_same_suns():
    sky = sky_of(sun_at([0.3, 0.2, 0.9], 3.0, 5000.0))
    _, (sun,) = split_sky(sky, "Sky")
    _, (stronger,) = split_sky(replace(sky, radiance=sky.radiance * 1.37), "Sky")
    assert sun.angle == stronger.angle
    np.testing.assert_array_equal(sun.direction, stronger.direction)
    np.testing.assert_allclose(stronger.strength, 1.37 * sun.strength, rtol=1e-12)
