# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Triangles that light goes through."""

from dataclasses import replace

import numpy as np
import pytest
from radiosity_bake.core.bake import bake
from radiosity_bake.core.direct import all_emitters, direct_light
from radiosity_bake.core.lit_points import LitPoints
from radiosity_bake.core.relight import ChangedSceneError, relight, shape_of
from radiosity_bake.core.scene import PointLamp, Scene, Texture, surface_mesh
from radiosity_bake.core.settings import BakeSettings
from radiosity_bake.core.surfaces import join
from radiosity_bake.core.textures import cell_centres
from radiosity_bake.core.transmittance import fresnel
from radiosity_bake.core.visibility import RayScene

from tests.core.building import DARK, grid, mean_over
from tests.scenes import exact

COARSE = BakeSettings(quality="GOOD", minimum_size=0.5, output="ORIGINAL", keep_transport=True)


def room(*boards):
    """A room with a lamp below its ceiling, and boards across it."""
    lamp = exact.rectangle("lamp", (0.7, 0.7, 1.9), (0, 0.6, 0), (0.6, 0, 0), emission=5.0)
    return Scene((*exact.box_walls((2, 2, 2), reflectance=0.5), lamp, *boards), DARK)


def board(clear):
    """A dark board from wall to wall at half the height, of two triangles."""
    made = exact.rectangle("board", (0, 0, 1), (2, 0, 0), (0, 2, 0), reflectance=0.0)
    return replace(made, baked=False, clear=None if clear is None else np.array(clear))


def floor_light(scene):
    return mean_over(bake(scene, COARSE).meshes[:1])[0]


def test_light_goes_through_clear_faces_as_if_they_were_not_there():
    # Patches and rays of the walls are the same with the board and without, and so is nearly all that they meet.
    assert floor_light(room(board([True, True]))) == pytest.approx(floor_light(room()), rel=0.01)


def test_a_face_of_a_mesh_may_be_clear_and_the_next_one_not():
    half, none = floor_light(room(board([True, False]))), floor_light(room(board([True, True])))
    assert 0.1 * none < half < 0.9 * none
    assert floor_light(room(board(None))) < 0.01 * none


def test_relighting_refuses_what_became_clear():
    kept = bake(room(board(None)), COARSE).kept
    with pytest.raises(ChangedSceneError, match="board"):
        relight(kept, room(board([True, False])))
    assert shape_of(board([False, False])) == shape_of(board(None))


# ------------------------------------------------------------------------------------------------------ let through


def sheet(share, height=1.0, size=2.0, **options):
    """A dark board that lets so much of the light through."""
    corner = (1.0 - size / 2.0, 1.0 - size / 2.0, height)
    made = exact.rectangle("board", corner, (size, 0, 0), (0, size, 0), reflectance=0.0)
    return replace(made, baked=False, transmittance=np.tile(np.array(share, float).reshape(-1, 1), (2, 3)), **options)


def lamp_at(height, strength=10.0, radius=0.0):
    return PointLamp("Lamp", np.array([1.03, 0.98, height]), radius, np.full(3, strength))


def open_floor(*others, radius=0.0, scale=1.0):
    """The bake of a dark floor of eight by eight cells under a point lamp, with nothing else around but `others`."""
    floor = grid("floor", 8, reflectance=0.0)
    floor = replace(floor, vertices=floor.vertices * scale + 1.0 - scale / 2.0 - [0, 0, 1.0 - scale / 2.0])
    return bake(Scene((floor, *others), DARK, (lamp_at(1.8, radius=radius),)), COARSE)


def light_on(result):
    return mean_over(result.meshes[:1])[0]


def test_of_a_lamps_light_a_curtain_lets_its_share_through_without_noise():
    free = light_on(open_floor())
    # Shadow rays carry what is left of the light, so nothing is drawn.
    assert light_on(open_floor(sheet(0.4))) == pytest.approx(0.4 * free, rel=1e-6)
    assert light_on(open_floor(sheet(0.4), sheet(0.5, height=1.2))) == pytest.approx(0.2 * free, rel=1e-6)


def test_behind_a_curtain_nothing_is_in_doubt_that_asks_for_more_shadow_rays():
    def doubt(*others):
        lamp = exact.rectangle("lamp", (0.7, 0.7, 1.9), (0, 0.6, 0), (0.6, 0, 0), emission=5.0)
        surfaces = join(Scene((lamp, *others), DARK, (lamp_at(1.8, radius=0.2),)))
        rays = RayScene(surfaces.points, surfaces.triangles, 1, transmittance=surfaces.transmittance)
        emitters = all_emitters(surfaces, np.ones((len(surfaces.closed), 2), bool), rays, 0)
        points, up = np.array([[1.0, 1.0, 0.0], [-0.12, 1.0, 0.0]]), np.array([[0.0, 0.0, 1.0]] * 2)
        return direct_light(emitters, rays, LitPoints.of(points, up), 64, 0)[1]

    np.testing.assert_allclose(doubt(sheet(0.5)), 0.0, atol=1e-12)
    assert (doubt(replace(sheet(0.0, size=1.0), transmittance=None)) > 0.01).any()


def test_of_reflected_light_a_curtain_lets_its_share_through():
    ceiling = exact.rectangle("ceiling", (0, 0, 2), (0, 2, 0), (2, 0, 0), reflectance=0.8)
    shade = exact.rectangle("shade", (-2, -2, 1.1), (6, 0, 0), (0, 6, 0), reflectance=0.0)
    shade = replace(shade, shadow=True, seen=False)

    def lit(*others):
        floor = grid("floor", 8, reflectance=0.0)
        meshes = (floor, replace(ceiling, baked=False), replace(shade, baked=False), *others)
        return light_on(bake(Scene(meshes, DARK, (lamp_at(1.2),)), COARSE))

    # A ray goes through or ends, and those that do are even: of the 384 hardly one more or less than half.
    assert lit(sheet(0.5, size=6.0)) == pytest.approx(0.5 * lit(), rel=0.01)
    clear = replace(sheet(0.0, size=6.0), transmittance=None, clear=np.array([True, True]))
    assert lit(sheet(1.0, size=6.0)) == pytest.approx(lit(clear), rel=1e-9)


def test_of_a_textured_sheet_the_holes_let_light_through_and_the_rest_does_not():
    along, whole = 16, sheet(0.0)
    holes = np.repeat((cell_centres(along)[:, :1] < 0.5).astype(np.float32), 3, axis=1)
    texture = Texture(np.arange(2), np.zeros(2, int), np.full(2, along), np.concatenate([holes, holes]))
    # What the texture leaves is the corner of each triangle that the weight belongs to.
    first, own, last = (whole.vertices[whole.triangles[:, k]] for k in range(3))
    corners = np.stack([(first + own) / 2.0, own, (own + last) / 2.0], axis=1).reshape(-1, 3)
    cut = surface_mesh("cut", corners, [(0, 1, 2), (3, 4, 5)], baked=False)
    holed, twin = (open_floor(made, scale=3.0) for made in (replace(whole, transmittance_texture=texture), cut))
    assert light_on(holed) == pytest.approx(light_on(twin), rel=1e-6)
    assert light_on(twin) < 0.95 * light_on(open_floor(scale=3.0))


def test_a_furnace_with_a_curtain_in_it_glows_evenly_and_loses_nothing():
    scene, expected = exact.furnace(0.5)
    furnace = float(np.mean(expected["radiosity"]))
    # It reflects all that does not go through, so nobody could tell it from air.
    curtain = exact.rectangle("curtain", (0.1, 0.1, 0.3), (0.8, 0, 0), (0, 0.8, 0), reflectance=0.7)
    curtain = replace(curtain, transmittance=np.full((2, 3), 0.3))
    result = bake(Scene((*scene.meshes, curtain), scene.world), BakeSettings(quality="GOOD", output="ORIGINAL"))
    walls, hung = result.meshes
    # What few patches leave where a board hangs in a furnace: of an opaque one 0.7 and 1.3%.
    assert walls.irradiance.mean() == pytest.approx(furnace, rel=5e-3)
    assert hung.irradiance.mean() == pytest.approx(furnace, rel=5e-3)
    np.testing.assert_allclose(hung.radiosity, 0.7 * hung.irradiance)
    assert abs(result.report["energy"]["imbalance"]) < 0.013


def test_a_closed_box_of_curtains_is_lit_inside():
    box = [replace(wall, transmittance=np.full((2, 3), 0.5)) for wall in exact.box_walls((2, 2, 2), reflectance=0.4)]
    ball = exact.rectangle("floor", (0.5, 0.5, 1), (1, 0, 0), (0, 1, 0), reflectance=0.5)
    inside = mean_over(bake(Scene((ball, *box), np.ones(3)), COARSE).meshes[:1])[0]
    # Half of the sky comes straight through, and what the walls reflect comes after it.
    assert 0.5 < inside < 0.9


def test_threads_make_no_difference_behind_curtains():
    scene = room(sheet(0.5))
    first, second = (bake(scene, replace(COARSE, threads=count)).meshes[0].irradiance for count in (1, 2))
    assert first.tobytes() == second.tobytes()


def test_relighting_refuses_another_share():
    kept = bake(room(sheet(0.5)), COARSE).kept
    with pytest.raises(ChangedSceneError, match="board"):
        relight(kept, room(sheet(0.6)))
    assert shape_of(sheet(0.0)) == shape_of(board(None))


# ------------------------------------------------------------------------------------------------------------- glass


def pane(name, low, high, refraction=1.5, share=1.0):
    """A closed box of clear glass."""
    size = np.subtract(high, low)
    box = exact.closed_room(size, reflectance=0.0)
    count = len(box.triangles)
    return replace(
        box,
        name=name,
        vertices=box.vertices + low,
        triangles=box.triangles[:, ::-1],
        corner_normals=-box.corner_normals[:, ::-1],
        transmittance=np.full((count, 3), share),
        refraction=np.full(count, refraction),
        baked=False,
    )


def test_glass_reflects_what_fresnel_says():
    straight = ((1.5 - 1.0) / (1.5 + 1.0)) ** 2
    brewster = np.cos(np.arctan(1.5))
    half = 0.5 * ((1.5**2 - 1.0) / (1.5**2 + 1.0)) ** 2
    cosines, expected = np.array([1.0, 0.0, brewster], np.float32), [straight, 1.0, half]
    # In single precision.
    np.testing.assert_allclose(fresnel(cosines, np.full(3, 1.5, np.float32)), expected, rtol=1e-5)
    np.testing.assert_allclose(fresnel(np.array([0.3], np.float32), np.ones(1, np.float32)), 0.0, atol=1e-12)


def test_of_a_lamps_light_two_surfaces_of_a_pane_take_what_they_reflect():
    floor = replace(grid("floor", 2, reflectance=0.0), vertices=grid("floor", 2).vertices * 1e-3 + [1.03, 0.98, 0])
    glass = pane("pane", (0, 0, 0.5), (2, 2, 0.6), share=0.9)
    free, behind = (light_on(bake(Scene((floor, *some), DARK, (lamp_at(1.8),)), COARSE)) for some in ([], [glass]))
    # All of the floor lies under the lamp, and 4% are lost at each surface.
    assert behind == pytest.approx((0.9 * 0.96) ** 2 * free, rel=1e-4)


def test_under_an_even_sky_glass_takes_nothing_from_a_speck_on_the_ground():
    speck = replace(grid("speck", 2, reflectance=0.0), vertices=grid("speck", 2).vertices * 1e-3 + [1.0, 1.0, 0])
    glass = pane("pane", (-4, -4, 0.5), (6, 6, 0.6))
    lit = light_on(bake(Scene((speck, glass), np.ones(3)), COARSE))
    # What does not come through from above is reflected from below, so every ray ends in the sky.
    assert lit == pytest.approx(1.0, rel=1e-3)


def test_relighting_refuses_other_glass():
    with_glass, other = (shape_of(pane("pane", (0, 0, 1), (2, 2, 1.1), refraction)) for refraction in (1.5, 1.4))
    assert with_glass != other


# ------------------------------------------------------------------------------------------------------------- tints

RED = (0.9, 0.5, 0.1)


def test_of_a_lamps_light_tinted_glass_lets_its_colour_through():
    def colour_of(*others):
        return mean_over(open_floor(*others).meshes[:1])

    red = replace(sheet(0.0), transmittance=np.broadcast_to(RED, (2, 3)))
    green = replace(sheet(0.0, height=1.2), transmittance=np.broadcast_to((0.4, 0.8, 0.4), (2, 3)))
    np.testing.assert_allclose(colour_of(red), colour_of() * RED, rtol=1e-6)
    np.testing.assert_allclose(colour_of(red, green), colour_of() * RED * [0.4, 0.8, 0.4], rtol=1e-6)


@pytest.mark.parametrize("output", ["ORIGINAL", "REFINED"])
def test_of_the_sky_and_of_what_is_reflected_tinted_glass_lets_its_colour_through(output):
    red = replace(sheet(0.0, height=0.2, size=20.0), transmittance=np.broadcast_to(RED, (2, 3)))
    floor = grid("floor", 4, reflectance=0.0)
    lit = mean_over(bake(Scene((floor, red), np.ones(3)), replace(COARSE, output=output)).meshes)
    # Of 384 rays half of one may be too many; the sheet ends where one ray in two thousand passes beside it.
    np.testing.assert_allclose(lit, RED, atol=0.5 / 384 + 1 / 2000)


def test_relighting_behind_tinted_glass_is_as_baking_anew():
    red = replace(sheet(0.0), transmittance=np.broadcast_to(RED, (2, 3)))
    floor = grid("floor", 4, reflectance=0.5)
    dim, bright = (Scene((floor, red), DARK, (lamp_at(1.8, strength),)) for strength in (10.0, 30.0))
    again, anew = relight(bake(dim, COARSE).kept, bright).meshes[0], bake(bright, COARSE).meshes[0]
    # Three times the light on the same rays.
    np.testing.assert_allclose(again.irradiance, anew.irradiance, rtol=1e-5)
