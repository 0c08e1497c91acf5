# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Which sides light reaches: rooms from inside, solids, sheets, whatever way their normals point."""

from dataclasses import replace

import numpy as np
import pytest
from radiosity_bake.core.reachability import lit_sides
from radiosity_bake.core.scene import Scene, SunLamp, surface_mesh
from radiosity_bake.core.surfaces import join
from radiosity_bake.core.visibility import RayScene

from tests.core.building import DARK, block, flipped
from tests.scenes import exact

LAMP = exact.rectangle("lamp", (0.7, 0.7, 1.9), (0, 0.6, 0), (0.6, 0, 0), emission=5.0)
ROOM = exact.closed_room((2, 2, 2), reflectance=0.5)
SHEET = exact.rectangle("sheet", (0.5, 0.5, 1.0), (1, 0, 0), (0, 1, 0), reflectance=0.5)


def lit(*meshes, world=DARK, lamps=(), seed=0):
    """Front and back of each mesh's first shell, by name."""
    surfaces = join(Scene(meshes, np.asarray(world, dtype=float), lamps))
    sides = lit_sides(surfaces, RayScene(surfaces.points, surfaces.triangles, 2), seed)
    first = [np.flatnonzero(surfaces.mesh_of_triangle == k)[0] for k in range(len(meshes))]
    return {m.name: tuple(sides[surfaces.shell_of_triangle[f]].tolist()) for m, f in zip(meshes, first, strict=True)}


def test_a_room_is_lit_on_the_inside():
    assert lit(ROOM, LAMP)["room"] == (True, False)


def test_a_room_whose_normals_look_outward_is_lit_on_its_back():
    assert lit(flipped(ROOM), LAMP)["room"] == (False, True)


def test_a_solid_is_lit_on_the_outside():
    assert lit(ROOM, LAMP, block("block", (0.5, 0.5, 0.2), (1, 1, 0.8)))["block"] == (True, False)


def test_a_solid_with_flipped_normals_is_lit_on_its_back():
    assert lit(ROOM, LAMP, flipped(block("block", (0.5, 0.5, 0.2), (1, 1, 0.8))))["block"] == (False, True)


@pytest.mark.parametrize("bottom", [True, False])
def test_a_box_on_the_floor_is_dark_inside_with_or_without_a_bottom(bottom):
    assert lit(ROOM, LAMP, block("block", (0.5, 0.5, 0.0), (1, 1, 0.8), bottom=bottom))["block"] == (True, False)


def test_a_box_without_a_bottom_in_the_air_is_lit_inside_too():
    assert lit(ROOM, LAMP, block("block", (0.5, 0.5, 0.6), (1, 1, 1.4), bottom=False))["block"] == (True, True)


def test_an_open_sheet_in_a_room_is_lit_on_both_sides():
    assert lit(ROOM, LAMP, SHEET)["sheet"] == (True, True)


def test_a_ceiling_above_a_closed_room_is_lit_from_within_alone():
    walls = exact.box_walls((2, 2, 2), reflectance=0.5)
    sides = lit(*walls, LAMP)
    assert set(sides.values()) == {(True, False), (True, True)}
    assert sides["floor"] == sides["ceiling"] == sides["north"] == (True, False)


def test_a_sheet_whose_front_looks_away_from_the_only_lamp_is_lit_on_its_back():
    black = exact.closed_room((2, 2, 2), reflectance=0.0)
    wide = exact.rectangle("sheet", (0, 0, 1.0), (0, 2, 0), (2, 0, 0), reflectance=0.5)
    assert lit(black, LAMP, wide)["sheet"] == (False, True)


def test_a_bulb_emits_outward_alone():
    bulb = block("bulb", (0.9, 0.9, 1.2), (1.1, 1.1, 1.4), emission=5.0)
    sides = lit(ROOM, bulb)
    assert sides["bulb"] == (True, False)
    assert sides["room"] == (True, False)


@pytest.mark.parametrize("turned_over", [False, True])
def test_a_lamp_in_a_housing_is_dark_inside_even_where_it_cuts_the_ceiling(turned_over):
    housing = block("housing", (0.7, 0.7, 1.9), (1.3, 1.3, 2.1), reflectance=0.5)
    emission = np.where(housing.corner_normals[:, 0, 2:] < -0.5, 5.0, 0.0).repeat(3, axis=1)
    housing = surface_mesh("housing", housing.vertices, housing.triangles, reflectance=0.5, emission=emission)
    sides = lit(ROOM, flipped(housing) if turned_over else housing)
    assert sides["housing"] == ((False, True) if turned_over else (True, False))
    assert sides["room"] == (True, False)


def test_a_room_that_glows_itself_is_lit_inside():
    ceiling = ROOM.vertices[ROOM.triangles][..., 2].min(axis=1) == 2.0
    glowing = replace(ROOM, emission=np.ones_like(ROOM.emission) * ceiling[:, None])
    assert lit(glowing)["room"] == (True, False)
    outward = flipped(glowing)
    assert lit(outward, block("block", (0.5, 0.5, 0.2), (1, 1, 0.8)))["room"][1]
    # The floor around the house is larger, but the house holds something, or stands in the open.
    floor = exact.rectangle("ground", (-5, -5, -1), (10, 0, 0), (0, 10, 0), reflectance=0.5)
    assert lit(outward, block("block", (0.5, 0.5, 0.2), (1, 1, 0.8)), floor)["room"][1]
    assert lit(outward, block("block", (0.5, 0.5, 0.0), (1, 1, 0.8)), floor)["room"][1]
    assert lit(outward, block("block", (0.0, 0.0, 0.0), (1, 1, 0.8)), floor)["room"][1]
    assert lit(outward, floor)["room"][1]
    assert lit(glowing, block("block", (0.5, 0.5, 0.0), (1, 1, 0.8)), floor, world=(0.1, 0.1, 0.1))["room"][0]


DOME = exact.closed_room((40, 40, 40), reflectance=0.5, name="dome")
DOME = replace(DOME, vertices=DOME.vertices - 20.0)


def test_an_empty_room_that_glows_is_lit_inside_under_a_dome_where_its_normals_look_inward():
    ceiling = ROOM.vertices[ROOM.triangles][..., 2].min(axis=1) == 2.0
    glowing = replace(ROOM, emission=np.ones_like(ROOM.emission) * ceiling[:, None])
    assert lit(glowing, DOME)["room"] == (True, True)


def test_an_empty_house_that_glows_downward_onto_the_ground_is_lit_inside():
    # All light outward meets the ground, but from there most of it gets into the open.
    bottom = ROOM.vertices[ROOM.triangles][..., 2].max(axis=1) == 0.0
    glowing = flipped(replace(ROOM, emission=np.ones_like(ROOM.emission) * bottom[:, None]))
    wide = exact.rectangle("ground", (-100, -100, -0.5), (200, 0, 0), (0, 200, 0), reflectance=0.5)
    assert lit(glowing, wide)["room"] == (True, True)


def test_a_ring_that_glows_does_not_hold_the_lamp_in_its_middle():
    # A square ring, closed: four bars around a hole.
    outer, inner = [(0, 0), (1, 0), (1, 1), (0, 1)], [(0.3, 0.3), (0.7, 0.3), (0.7, 0.7), (0.3, 0.7)]
    corners = [(x + 0.5, y + 0.5, z) for z in (1.4, 1.5) for x, y in outer + inner]
    triangles = []
    for k in range(4):
        j = (k + 1) % 4
        for a, b, c, d in ((k, j, 8 + j, 8 + k), (4 + j, 4 + k, 12 + k, 12 + j), (8 + k, 8 + j, 12 + j, 12 + k)):
            triangles += [(a, b, c), (a, c, d)]
        triangles += [(j, k, 4 + k), (j, 4 + k, 4 + j)]
    ring = surface_mesh("ring", corners, triangles, reflectance=0.5, emission=(5.0, 5.0, 5.0))
    spot = block("spot", (0.95, 0.95, 1.42), (1.05, 1.05, 1.48), emission=5.0)
    sides = lit(ROOM, ring, spot)
    assert sides["ring"] == sides["spot"] == (True, False)
    assert sides["room"] == (True, False)


def test_the_world_lights_a_solid_outside_and_an_open_plane_on_both_sides():
    plane = exact.rectangle("plane", (-2, -2, -1), (4, 0, 0), (0, 4, 0), reflectance=0.5)
    sides = lit(block("block", (0, 0, 0), (1, 1, 1)), plane, world=(1, 1, 1))
    assert sides == {"block": (True, False), "plane": (True, True)}


def test_the_world_reaches_a_closed_room_on_its_outside_alone():
    assert lit(ROOM, world=(1, 1, 1))["room"] == (False, True)


def test_the_world_enters_through_a_window():
    walls = exact.box_walls((2, 2, 2), reflectance=0.5)
    assert lit(*walls[:5], world=(1, 1, 1))["floor"] == (True, True)


def pierced_room(window):
    """Return a room of 2 x 2 x 2 of one sheet, its front inward, with a window in the middle of the wall x = 2."""
    room = exact.closed_room((2, 2, 2), reflectance=0.5)
    kept = room.triangles[(room.vertices[room.triangles][..., 0] < 2.0).any(axis=1)]
    ring = (0.0, 1.0 - window / 2, 1.0 + window / 2, 2.0)
    corners = [(2.0, y, z) for z in ring for y in ring]
    first = [len(room.vertices) + 4 * j + i for j in range(3) for i in range(3) if (i, j) != (1, 1)]
    around = [t for a in first for t in ((a, a + 5, a + 1), (a, a + 4, a + 5))]
    return surface_mesh("room", [*room.vertices, *corners], [*kept, *around], reflectance=0.5)


GROUND = exact.rectangle("ground", (-10, -10, -0.5), (20, 0, 0), (0, 20, 0), reflectance=0.5)


@pytest.mark.parametrize("window", [0.2, 0.5, 1.9])
@pytest.mark.parametrize("turned_over", [False, True])
def test_the_sky_gets_into_a_room_of_one_sheet_through_a_window_of_any_size(window, turned_over):
    room = pierced_room(window)
    assert lit(flipped(room) if turned_over else room, GROUND, world=(1, 1, 1))["room"] == (True, True)


@pytest.mark.parametrize("window", [0.2, 0.5, 1.9])
@pytest.mark.parametrize("turned_over", [False, True])
def test_light_from_within_gets_out_to_a_wall_and_back_to_the_outside(window, turned_over):
    room, wall = pierced_room(window), exact.rectangle("wall", (3, -1, 0), (0, 0, 3), (0, 4, 0), reflectance=0.5)
    assert lit(flipped(room) if turned_over else room, LAMP, wall)["room"] == (True, True)


def test_the_sun_gets_into_a_room_of_one_sheet_on_a_wide_ground():
    wide = exact.rectangle("ground", (-100, -100, -0.5), (200, 0, 0), (0, 200, 0), reflectance=0.5)
    sun = SunLamp("sun", np.array([-0.8, 0.0, -0.6]), 0.0, np.ones(3))
    assert lit(pierced_room(0.5), wide, lamps=(sun,))["room"] == (True, True)


@pytest.mark.parametrize("gap", [1e-4, 1e-3])
def test_a_box_without_a_bottom_a_little_above_the_floor_is_dark_inside(gap):
    box = block("block", (0.5, 0.5, gap), (1, 1, 0.8), bottom=False)
    assert lit(ROOM, LAMP, box)["block"] == (True, False)
    assert lit(GROUND, replace(box, vertices=box.vertices - [0, 0, 0.5]), world=(1, 1, 1))["block"] == (True, False)


def test_what_no_light_reaches_counts_as_lit_in_front():
    sealed = exact.box_walls((1, 1, 1), reflectance=0.5, origin=(5, 5, 5))
    sides = lit(ROOM, LAMP, exact.closed_room((0.5, 0.5, 0.5), reflectance=0.5, name="inner"), *sealed)
    assert sides["floor"][0]


@pytest.mark.parametrize("seed", range(5))
def test_the_answer_does_not_depend_on_the_seed(seed):
    sides = lit(ROOM, LAMP, SHEET, block("block", (0.5, 0.5, 0.0), (1, 1, 0.4), bottom=False), seed=seed)
    assert sides == {"room": (True, False), "lamp": (True, True), "sheet": (True, True), "block": (True, False)}


@pytest.mark.parametrize("offset", [0.0, 1e5])
@pytest.mark.parametrize("scale", [1e-3, 1.0, 1e3])
def test_the_answer_does_not_depend_on_size_or_place(scale, offset):
    meshes = (ROOM, LAMP, block("block", (0.5, 0.5, 0.0), (1, 1, 0.8), bottom=False))
    placed = [
        surface_mesh(m.name, m.vertices * scale + offset * scale, m.triangles, reflectance=0.5, emission=m.emission)
        for m in meshes
    ]
    assert lit(*placed) == {"room": (True, False), "lamp": (True, True), "block": (True, False)}


def test_solids_too_small_for_walks_to_meet_are_solids():
    corners = [np.array([0.1 + 0.1 * (i % 15), 0.1 + 0.1 * (i // 15), 0.0]) for i in range(30)]
    small = [block(f"block {i}", low, low + 0.02) for i, low in enumerate(corners)]
    sides = lit(ROOM, LAMP, *small)
    assert all(sides[m.name] == (True, False) for m in small)


@pytest.mark.parametrize("height", [-0.5, -0.9, -0.99])
def test_a_lamp_of_which_little_stands_above_a_floor_lights_it_from_above_too(height):
    floor = exact.rectangle("floor", (0, 0, 0), (1, 0, 0), (0, 1, 0))
    lamp = exact.rectangle("lamp", (-0.25, 0, height), (0, 1, 0), (0, 0, 1), emission=1.0)
    # The lowest gives the back two thousand times as much, and one walk in sixteen thousand the front.
    assert lit(floor, lamp)["floor"] == (True, True)
