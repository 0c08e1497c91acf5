# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Sheets that pass through others: the lines where they do, and what is cut along these."""

from contextlib import closing

import numpy as np
import pytest
from radiosity_bake.core.bake import bake
from radiosity_bake.core.coarse_patches import coarse_patches
from radiosity_bake.core.crossings import find_crossings
from radiosity_bake.core.scene import Scene, surface_mesh
from radiosity_bake.core.settings import BakeSettings
from radiosity_bake.core.subdivision import conforming_faces
from radiosity_bake.core.surfaces import join
from radiosity_bake.core.visibility import RayScene

from tests.core.building import DARK, areas, block, grid, node_triangles
from tests.scenes import exact

SIZE = 0.2
FLOOR = exact.rectangle("floor", (0, 0, 0), (1, 0, 0), (0, 1, 0), reflectance=0.5)


def wall(start, end, low=-0.5, high=0.5):
    """A wall of one sheet over the line from start to end."""
    (x0, y0), (x1, y1) = start, end
    return exact.rectangle("wall", (x0, y0, low), (x1 - x0, y1 - y0, 0), (0, 0, high - low), reflectance=0.5)


def cut_patches(*meshes, two_sided=True):
    """The coarse patches of meshes both sides of which are lit, and their surfaces."""
    surfaces = join(Scene(meshes, DARK))
    lit = np.ones((len(surfaces.closed), 2), dtype=bool)
    lit[:, 1] = two_sided
    with closing(RayScene(surfaces.points, surfaces.triangles, 1)) as rays:
        return coarse_patches(surfaces, SIZE, find_crossings(surfaces, rays, lit, SIZE)), surfaces


def floor_pieces(tree, surfaces):
    """Corners of the leaves on the floor, which is the first mesh."""
    leaves = tree.leaves()
    return node_triangles(tree, leaves[surfaces.mesh_of_triangle[tree.triangle[leaves]] == 0])


@pytest.mark.parametrize("low", [-0.5, -1e-4, 0.0, 1e-4], ids=["through", "just through", "on", "just above"])
@pytest.mark.parametrize("across", [((0.3, -1.0), (0.3, 2.0)), ((-0.2, 0.4), (1.3, 0.9))], ids=["straight", "slanted"])
def test_no_patch_of_a_floor_lies_on_both_sides_of_a_wall(low, across):
    tree, surfaces = cut_patches(FLOOR, wall(*across, low=low))
    (x0, y0), (x1, y1) = across
    normal = np.array([y0 - y1, x1 - x0]) / np.hypot(x1 - x0, y1 - y0)
    pieces = floor_pieces(tree, surfaces)
    beside = (pieces[..., :2] - (x0, y0)) @ normal
    # Lines go through corners within a ten thousandth of a triangle's size.
    assert not ((beside.min(axis=1) < -2e-4) & (beside.max(axis=1) > 2e-4)).any()
    assert areas(pieces).sum() == pytest.approx(1.0)


def test_a_wall_that_ends_above_a_floor_does_not_cut_it():
    assert len(floor_pieces(*cut_patches(FLOOR, wall((0.3, -1.0), (0.3, 2.0), low=0.1)))) == 2


def test_a_wall_that_is_dark_behind_cuts_a_floor_that_goes_on_there():
    assert len(floor_pieces(*cut_patches(FLOOR, wall((0.3, -1.0), (0.3, 2.0)), two_sided=False))) > 2


def test_solids_cut_a_floor_where_they_are_thin_or_divide_it():
    def pieces(thickness, first, last):
        solid = block("solid", (0.3, first, 0.0), (0.3 + thickness, last, 0.5))
        return len(floor_pieces(*cut_patches(FLOOR, solid, two_sided=False)))

    assert pieces(0.1, 0.1, 0.9) > 2
    assert pieces(0.5, 0.1, 0.9) == 2
    assert pieces(0.5, -1.0, 2.0) > 2


def test_the_walls_of_a_room_that_meet_along_their_edges_are_not_cut():
    walls = exact.box_walls((2, 3, 2.5), reflectance=0.5)
    tree, _ = cut_patches(*walls)
    assert len(tree) == 12
    assert tree.seams.sides == 1


def test_a_hit_on_a_cut_triangle_finds_the_piece_that_it_lies_in():
    tree, surfaces = cut_patches(FLOOR, wall((0.3, -1.0), (0.3, 2.0)), wall((-1.0, 0.65), (2.0, 0.45)))
    shares = np.random.default_rng(4).dirichlet(np.ones(3), 400)
    triangle = np.repeat([0, 1], 200)
    weights = shares[:, 1:].astype(np.float32)
    leaf, inside = tree.descend(triangle, weights)
    at = np.einsum("mk,mkx->mx", shares, surfaces.points[surfaces.triangles[triangle]])
    own = np.concatenate([1.0 - inside.sum(axis=1, keepdims=True), inside], axis=1)
    # Single precision, over pieces a tenth as wide as the triangle.
    assert own.min() > -1e-5
    assert np.einsum("mk,mkx->mx", own, node_triangles(tree, leaf)) == pytest.approx(at, abs=1e-5)


def test_pieces_beside_a_cut_fit_together_and_share_vertices_on_their_own_side_alone():
    floor = grid("floor", 4, reflectance=0.5)
    tree, surfaces = cut_patches(floor, wall((0.3, -1.0), (0.3, 2.0)))
    tree.split(tree.leaves())
    faces = conforming_faces(surfaces, tree, np.ones(len(surfaces.closed), dtype=bool))
    on_floor = surfaces.mesh_of_triangle[faces.triangle] == 0
    corners, vertices = faces.corners[on_floor], faces.vertices[on_floor]
    at = faces.points[corners]
    west = at[..., 0].mean(axis=1) < 0.3
    on_line = np.abs(at[..., 0] - 0.3) < 1e-9
    assert on_line.any()
    for side in (west, ~west):
        # As many vertices as places: none of one side is apart from the others.
        assert len(np.unique(vertices[side])) == len(np.unique(faces.places[corners[side]]))
    on_both_sides = np.intersect1d(vertices[west], vertices[~west])
    assert len(on_both_sides) == 0
    # Every inner edge has two faces, so no vertex lies on the middle of another's edge.
    following = np.roll(corners, -1, axis=1)
    key = (np.minimum(corners, following) << 32 | np.maximum(corners, following)).ravel()
    middle = ((at + np.roll(at, -1, axis=1)) / 2.0).reshape(-1, 3)[:, :2]
    _, first, count = np.unique(key, return_index=True, return_counts=True)
    border = (np.abs(middle[first] - 0.5) > 0.5 - 1e-9).any(axis=1)
    assert (count == np.where(border, 1, 2)).all()


def test_around_the_end_of_a_wall_vertices_are_shared():
    tree, surfaces = cut_patches(grid("floor", 4, reflectance=0.5), wall((0.3, -1.0), (0.3, 0.6)))
    faces = conforming_faces(surfaces, tree, np.ones(len(surfaces.closed), dtype=bool))
    on_floor = surfaces.mesh_of_triangle[faces.triangle] == 0
    at, vertices = faces.points[faces.corners[on_floor]].reshape(-1, 3), faces.vertices[on_floor].ravel()

    def sides(y):
        here = np.abs(at[:, :2] - (0.3, y)).max(axis=1) < 1e-9
        return len(np.unique(vertices[here]))

    assert sides(0.25) == sides(0.0) == 2
    assert sides(0.6) == 1


def sheet_room(beyond, cells):
    """A room of 2 x 2 x 2 without its south wall, of sheets whose walls go on beyond floor and ceiling."""

    def sheet(name, corner, u, v):
        corner, u, v = (np.asarray(x, dtype=np.float64) for x in (corner, u, v))
        flat = grid(name, cells, reflectance=0.5)
        flat.vertices[:] = corner + flat.vertices[:, :1] * u + flat.vertices[:, 1:2] * v
        flat.corner_normals[:] = np.cross(u, v) / np.linalg.norm(np.cross(u, v))
        return flat

    foot, height = -beyond, 2.0 + 2.0 * beyond
    return (
        sheet("floor", (0, 0, 0), (2, 0, 0), (0, 2, 0)),
        sheet("ceiling", (0, 0, 2), (0, 2, 0), (2, 0, 0)),
        sheet("west", (0, 0, foot), (0, 2, 0), (0, 0, height)),
        sheet("east", (2, 0, foot), (0, 0, height), (0, 2, 0)),
        sheet("north", (-beyond, 2, foot), (2 + 2 * beyond, 0, 0), (0, 0, height)),
        sheet("south", (0, 0, foot), (0, 0, 1.2 + beyond), (2, 0, 0)),
    )


@pytest.mark.parametrize("cells", [1, 5], ids=["walls of two triangles", "walls of fifty"])
def test_a_room_is_as_bright_whether_or_not_its_walls_go_on_beyond_each_other(cells):
    def floor_of(beyond):
        result = bake(Scene(sheet_room(beyond, cells), np.ones(3)), BakeSettings(quality="DRAFT"))
        mesh = result.meshes[0]
        corners = mesh.vertices[mesh.triangles]
        inner = np.abs(corners.mean(axis=1)[:, :2] - 1.0).max(axis=1) < 0.8
        size = areas(corners)[inner]
        return size @ mesh.irradiance[inner].mean(axis=(1, 2)) / size.sum(), result.report["vertices"]

    (alone, fewest), (crossed, vertices) = floor_of(0.0), floor_of(0.3)
    # The noise of 64 rays, at a hundred vertices.
    assert crossed == pytest.approx(alone, rel=0.02)
    assert vertices < 3 * fewest


def test_leaves_that_cross_each_other_everywhere_are_cut_into_few_pieces():
    rng = np.random.default_rng(1)
    corners = rng.normal(size=(400, 1, 3)) + 0.8 * rng.normal(size=(400, 3, 3))
    crown = surface_mesh("crown", corners.reshape(-1, 3), np.arange(1200).reshape(-1, 3), reflectance=0.5)
    tree, surfaces = cut_patches(crown)
    patches = surfaces.areas.sum() / SIZE**2
    assert 400 < len(tree.leaves()) < 400 + 4 * patches
