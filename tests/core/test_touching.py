# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Solids that touch walls, floors and each other in one plane, and objects thinner than the faces they stand on."""

from dataclasses import replace

import numpy as np
import pytest
from radiosity_bake.core.bake import bake
from radiosity_bake.core.receivers import receivers
from radiosity_bake.core.scene import Scene, surface_mesh
from radiosity_bake.core.settings import BakeSettings
from radiosity_bake.core.subdivision import input_faces
from radiosity_bake.core.surfaces import HAIR, join
from radiosity_bake.core.visibility import OFFSET, RayScene

from tests.core.building import DARK, areas, block, flipped, fronts, transport_of
from tests.scenes import exact

ROOM = exact.closed_room((2, 2, 2), reflectance=0.5)
LAMP = exact.rectangle("lamp", (0.7, 0.7, 1.9), (0, 0.6, 0), (0.6, 0, 0), emission=5.0)
DRAFT = BakeSettings(quality="DRAFT")


@pytest.mark.parametrize("offset", [0.0, 100.0])
def test_a_ray_from_inside_a_solid_meets_the_solid_and_not_the_wall_behind(offset):
    solid = block("cupboard", (0.0, 0.5, 0.0), (0.6, 1.5, 1.2))
    surfaces = join(Scene((ROOM, solid, LAMP), DARK))
    surfaces.points[:] += offset
    rng = np.random.default_rng(0)
    origins = rng.uniform((0.1, 0.6, 0.1), (0.5, 1.4, 1.1), (4000, 3)) + offset
    ways = rng.normal(size=(4000, 3)).astype(np.float32)
    own = surfaces.mesh_of_triangle == 1

    def met_own(points):
        rays = RayScene(points, surfaces.triangles, 1)
        hits = rays.first_hits(rays.local(origins), ways)
        rays.close()
        return own[hits.triangle] & hits.back

    assert met_own(surfaces.traced_points()).all()
    # A quarter of the rays or more meet faces that touch the room's, and would be left to chance.
    assert not met_own(surfaces.points).all()


def test_only_solids_are_smaller_and_by_less_than_rays_start_off_their_surface():
    solid = block("block", (0.5, 0.5, 0.0), (1.0, 1.0, 0.8))
    surfaces = join(Scene((ROOM, flipped(ROOM), solid, LAMP), DARK))
    moved = np.linalg.norm(surfaces.traced_points() - surfaces.points, axis=1)
    of_mesh = np.split(moved, surfaces.first_point_of_mesh[1:-1])
    assert of_mesh[0].max() == of_mesh[3].max() == 0.0
    for part in of_mesh[1:3]:
        assert part == pytest.approx(HAIR * surfaces.extent)
    assert HAIR < OFFSET


def test_all_faces_of_a_solid_recede_however_many_triangles_meet_in_its_corners():
    # The top is a fan of forty triangles about one of its corners.
    solid = block("block", (0.0, 0.0, 0.0), (1.0, 1.0, 1.0))
    rim = [(1.0, k / 20, 1.0) for k in range(21)] + [(1.0 - k / 20, 1.0, 1.0) for k in range(1, 21)]
    corners = solid.vertices[solid.triangles]
    kept = solid.triangles[(corners == 0.0).all(axis=1).any(axis=1)]
    top = [(4, 8 + k, 9 + k) for k in range(40)]
    east = [(1, 3, 28), *((1, 9 + k, 8 + k) for k in range(20))]
    north = [(2, 28, 3), *((2, 9 + k, 8 + k) for k in range(20, 40))]
    fan = surface_mesh("fan", [*solid.vertices, *rim], [*kept, *top, *east, *north], reflectance=0.5)
    surfaces = join(Scene((ROOM, fan, LAMP), DARK))
    first = surfaces.first_point_of_mesh[1]
    moved = (surfaces.traced_points() - surfaces.points)[first + 4]
    # Those of a cube's corner by the same: a hair along the diagonal.
    assert moved == pytest.approx(HAIR * surfaces.extent / np.sqrt(3) * np.array([1.0, 1.0, -1.0]), rel=1e-3)


def test_a_cupboard_against_a_wall_costs_no_more_than_one_a_step_off():
    def vertices(gap):
        cupboard = block("cupboard", (gap, 0.4, 0.0), (gap + 0.5, 1.6, 1.4))
        steps = [
            block(f"step {k}", (1.2, 1.8 - 0.2 * k, 0.0), (2.0 - gap, 2.0 - 0.2 * k - gap / 2, 0.15 * k))
            for k in (2, 3, 4)
        ]
        return bake(Scene((ROOM, LAMP, cupboard, *steps), DARK), DRAFT).report["vertices"]

    # When it stands off, the wall behind it and its own back are seen, and take some.
    assert vertices(0.0) <= 1.1 * vertices(0.1)


def test_a_wall_thinner_than_the_faces_it_stands_on_hides_what_is_under_it():
    ground = exact.rectangle("ground", (-4, -4, 0), (8, 0, 0), (0, 8, 0), reflectance=0.3)
    wall = block("wall", (0.04, -1.53, 0.0), (0.11, 1.47, 1.0), reflectance=0.3)
    # Without it little would see anything, and the sizes would be made for the wall alone.
    screen = block("screen", (-3.9, -3.9, 0.0), (-3.8, 3.9, 4.0), reflectance=0.3)
    result = bake(Scene((ground, wall, screen), np.ones(3)), BakeSettings(quality="GOOD"))
    mesh = result.meshes[0]
    middle = mesh.vertices[mesh.triangles].mean(axis=1)
    under = (middle[:, 0] > 0.05) & (middle[:, 0] < 0.10) & (np.abs(middle[:, 1]) < 1.4)
    assert under.sum() > 10
    assert mesh.irradiance[under].max() == 0.0
    # It is narrower than the first faces, so that without a search some of these would span it.
    assert result.report["minimum_size"] > 0.11 - 0.04


@pytest.mark.parametrize("overlap", [0.0, 0.05], ids=["flush", "through the ceiling"])
def test_a_lamp_in_the_ceiling_does_not_light_what_is_behind_it(overlap):
    housing = block("housing", (0.7, 0.7, 1.9), (1.3, 1.3, 2.0 + overlap), reflectance=0.5)
    glows = housing.corner_normals[:, 0, 2] < -0.5
    housing.emission[glows] = 5.0
    result = bake(Scene((ROOM, housing), DARK), DRAFT)
    mesh = result.meshes[0]
    middle = mesh.vertices[mesh.triangles].mean(axis=1)
    behind = (middle[:, 2] > 1.99) & (np.abs(middle[:, :2] - 1.0).max(axis=1) < 0.27)
    assert behind.sum() > 5
    assert mesh.irradiance[behind].max() == 0.0


@pytest.mark.parametrize("height", [1.9, 1.99])
def test_a_lamp_close_below_a_ceiling_of_two_patches_lights_the_room_by_what_it_emits(height):
    lamp = exact.rectangle("lamp", (0.7, 0.7, height), (0, 0.6, 0), (0.6, 0, 0), emission=5.0)
    coarse = BakeSettings(quality="DRAFT", method="UNIFORM", minimum_size=10.0, output="ORIGINAL")
    energy = bake(Scene((ROOM, lamp), DARK), coarse).report["energy"]
    # 32 rays from each of 14 patches leave a few hundredths; with parts that had other areas as receivers than as
    # senders of light, a fifth of it was there twice.
    assert abs(energy["imbalance"]) < 0.1


def test_nothing_is_covered_in_the_corners_of_an_empty_room():
    # A corner sees its walls so close in three quarters of all directions. Taken for covered, the patches of one
    # corner saw nothing but each other: at reflectance 0.999 they shone 25 times as bright as the room, and at 1 the
    # bake was refused, though the room had a black lamp in it.
    for seed in range(4):
        transport = transport_of(Scene(exact.box_walls((4, 4, 4)), DARK), rays=32, seed=seed)
        for _ in range(4):
            transport.tree.split(transport.tree.leaves())
        transport.trace(fronts(transport.tree))
        assert len(transport.separate_cover().element) == 0


def test_a_ceiling_is_covered_by_a_lamp_whose_gap_shows_a_sixth_of_the_directions():
    # Asked for seven eighths of short rays it was not, and what is in the gap lit the room.
    lamp = block("lamp", (1.5, 1.5, 3.53), (2.5, 2.5, 3.93))
    for seed in range(3):
        transport = transport_of(Scene((*exact.box_walls((4, 4, 4)), lamp), DARK), rays=32, seed=seed)
        for _ in range(3):
            transport.tree.split(transport.tree.leaves())
        transport.trace(fronts(transport.tree))
        assert len(transport.separate_cover().element) >= 6


def test_the_wall_before_an_open_box_of_one_sheet_is_lit():
    box = exact.closed_room((2, 2, 2), reflectance=0.5, name="box")
    open_side = (box.vertices[box.triangles][..., 0] == 2.0).all(axis=1)
    box = surface_mesh("box", box.vertices, box.triangles[~open_side], reflectance=0.5)
    wall = exact.rectangle("wall", (3, -1, 0), (0, 0, 3), (0, 4, 0), reflectance=0.5)
    mesh = bake(Scene((box, LAMP, wall), DARK), DRAFT).meshes[2]
    # Its darkest corner is lit by the wall's own light, back from the outside of the box: a twentieth of the mean.
    assert mesh.irradiance.min() > 0.0


def standing_balls(along, height):
    """A ground with balls in rows, their middles at a height, under a sky."""
    side = 3.0 * along
    ground = exact.rectangle("ground", (-side / 2, -side / 2, 0), (side, 0, 0), (0, side, 0), reflectance=0.3)
    unit, triangles = exact.icosphere(2)
    row = 3.0 * (np.arange(along) - (along - 1) / 2)
    balls = [surface_mesh("ball", unit + [x, y, height], triangles, reflectance=0.5) for x in row for y in row]
    return Scene((ground, *balls), np.ones(3))


def test_balls_whose_edges_lie_in_the_plane_of_the_ground_cost_no_more_than_higher_ones():
    through_edges, higher = (bake(standing_balls(2, height), DRAFT).report for height in (0.0, 0.1))
    # None of the balls' vertices is covered by the ground in whose plane they are; taken for it, these made both counts
    # twenty times as large.
    assert through_edges["vertices"] <= 1.25 * higher["vertices"]
    assert through_edges["rays_by_kind"]["gather"] <= 1.25 * higher["rays_by_kind"]["gather"]


def test_more_things_on_a_ground_take_no_more_rays_for_each_vertex():
    few, many = (bake(standing_balls(along, 0.1), DRAFT).report for along in (2, 4))
    assert many["vertices"] > 3 * few["vertices"]
    assert many["rays"] / many["vertices"] <= 1.1 * few["rays"] / few["vertices"]


def twice(mesh):
    """The mesh with each of its triangles there twice."""
    names = ("triangles", "corner_normals", "reflectance", "emission")
    return replace(mesh, **{name: np.concatenate([getattr(mesh, name)] * 2) for name in names})


FLOOR = exact.rectangle("floor", (0, 0, 0), (2, 0, 0), (0, 2, 0), reflectance=0.5)
BLOCK = block("block", (0.5, 0.5, 0.0), (1.1, 1.1, 0.8))


@pytest.mark.parametrize(
    "meshes",
    [
        (twice(ROOM), LAMP, BLOCK),
        (ROOM, ROOM, LAMP, BLOCK),
        (*exact.box_walls((2, 2, 2), reflectance=0.5), FLOOR, LAMP, BLOCK),
        (*exact.box_walls((2, 2, 2), reflectance=0.5), flipped(FLOOR), LAMP, BLOCK),
        (ROOM, LAMP, BLOCK, block("other", (0.9, 0.6, 0.0), (1.5, 0.9, 0.8))),
        (ROOM, LAMP, BLOCK, flipped(BLOCK)),
        (ROOM, LAMP, LAMP, BLOCK),
        (ROOM, LAMP, replace(LAMP, emission=0.0 * LAMP.emission), BLOCK),
        (replace(ROOM, emission=ROOM.reflectance), replace(ROOM, emission=ROOM.reflectance)),
    ],
    ids=[
        "faces",
        "room",
        "floor",
        "floor turned over",
        "blocks as high as each other",
        "block and the same inside out",
        "lamp",
        "lamp that does not glow",
        "room that glows",
    ],
)
def test_what_is_there_twice_is_no_light_unaccounted_for(meshes):
    report = bake(Scene(tuple(meshes), DARK), DRAFT).report
    assert abs(report["energy"]["imbalance"]) < 0.02
    assert not any("unaccounted" in sentence for sentence in report["warnings"])


@pytest.mark.parametrize("beyond", [0.0, 0.3], ids=["as large", "larger"])
def test_rooms_of_sheets_with_walls_in_one_plane_keep_their_own_light(beyond):
    bright = (
        *exact.box_walls((1, 1, 1), reflectance=0.8),
        exact.rectangle("lamp", (0.3, 0.3, 0.95), (0, 0.4, 0), (0.4, 0, 0), emission=5.0),
    )
    size = np.array((1.0, 1.0 + 2 * beyond, 1.0 + 2 * beyond))
    beside = exact.box_walls(size, reflectance=0.1, origin=(1.0, -beyond, -beyond))
    sizes = BakeSettings(quality="DRAFT", minimum_size=0.1)

    def light(*meshes):
        found = bake(Scene(meshes, DARK), sizes).meshes[:6]
        corners = np.concatenate([mesh.vertices[mesh.triangles] for mesh in found])
        return areas(corners) @ np.concatenate([mesh.irradiance for mesh in found]).mean(axis=(1, 2)) / 6.0

    # A wall that reflects an eighth as much makes the room a sixth darker where rays meet it.
    assert light(*bright, *beside) == pytest.approx(light(*bright), rel=0.02)


def smooth_trough(opening):
    """A long trough of two walls that open by so many degrees, shaded smooth: its bottom looks straight up."""
    leaning = np.radians(opening / 2)
    across = np.sin(leaning) * np.array([-1.0, 0.0, 1.0])
    along = np.linspace(-16.0, 16.0, 9)
    vertices = [(x, y, np.cos(leaning) * abs(k - 1)) for y in along for k, x in enumerate(across)]
    wall = np.array(
        [(np.cos(leaning), 0.0, np.sin(leaning)), (0.0, 0.0, 1.0), (-np.cos(leaning), 0.0, np.sin(leaning))]
    )
    starts = [3 * row + side for row in range(len(along) - 1) for side in (0, 1)]
    triangles = np.array([t for a in starts for t in ((a, a + 1, a + 4), (a, a + 4, a + 3))])
    return surface_mesh("trough", vertices, triangles, corner_normals=wall[triangles % 3])


@pytest.mark.parametrize("output", ["REFINED", "ORIGINAL"])
@pytest.mark.parametrize("opening", [90, 60, 30])
def test_in_the_fold_of_a_smooth_mesh_there_is_the_light_of_the_fold(opening, output):
    trough = smooth_trough(opening)
    (mesh,) = bake(Scene((trough,), np.ones(3)), BakeSettings(quality="DRAFT", output=output)).meshes
    corners = mesh.vertices[mesh.triangles]
    bottom = (np.abs(corners[:, :, 0]) < 1e-9) & (np.abs(corners[:, :, 1]) < 9.0)
    # The sky between the rims of an endless trough. Taken for the foot of something that stands there, the bottom had
    # the light of the rims, one and a half times as much and more. 64 even rays tell a share to
    # about 0.03.
    assert bottom.any()
    assert mesh.irradiance[bottom] == pytest.approx(np.sin(np.radians(opening / 2)), abs=0.05)


@pytest.mark.parametrize(("opening", "each"), [(90, 1), (30, 2)])
def test_in_a_steep_fold_each_face_gets_light_by_itself_and_on_itself(opening, each):
    trough = smooth_trough(opening)
    surfaces = join(Scene((trough,), DARK))
    faces = input_faces(surfaces)
    count = len(faces.triangle)
    places = receivers(surfaces, faces, np.arange(count), np.zeros(count, dtype=int))
    at = trough.vertices[places.vertices()]
    bottom = (at[:, 0] == 0.0) & (np.abs(at[:, 1]) < 16.0)
    assert len(np.unique(places.vertices()[bottom])) == 7
    assert np.count_nonzero(bottom) == 7 * each
    # All corners there are on the plane of their face, and look along its normal where it is theirs alone.
    face, corner = np.nonzero(bottom[places.of_corner])
    at = places.of_corner[face, corner]
    off = places.points[at] - trough.vertices[trough.triangles[face, corner]]
    assert np.einsum("kx,kx->k", off, surfaces.normals[face]) == pytest.approx(0.0, abs=1e-12)
    facing = np.einsum("kx,kx->k", places.lift[at], surfaces.normals[face])
    assert facing == pytest.approx(1.0 if each == 2 else np.sin(np.radians(45)))
