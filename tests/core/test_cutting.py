# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Faces cut where an object stands on them: the foot of a black block under a white sky, whose light is known exactly.

A point of the black floor outside of the block receives the world's radiance less the block's form factor; the floor
under the block receives nothing.
"""

import numpy as np
import pytest
from radiosity_bake.core.bake import bake
from radiosity_bake.core.cut_edges import LEAST_PIECE, SEARCHES, SECTIONS, CutEdges, find_cuts
from radiosity_bake.core.cutting import cut_faces, values_on_outlines
from radiosity_bake.core.receivers import Receivers, receivers
from radiosity_bake.core.scene import Scene, surface_mesh
from radiosity_bake.core.settings import BakeSettings
from radiosity_bake.core.subdivision import Faces
from radiosity_bake.core.surfaces import join

from tests.core.building import areas, block, crosses, t_junctions
from tests.scenes import exact, oracle

N = 0.08
LOW, HIGH, TURNED = (-0.37, -0.23), (0.31, 0.36), 27.0
UP = np.array([0.0, 0.0, 1.0])


def in_block(points):
    """Coordinates along the block's sides from its middle, and half its extents."""
    low, high = np.array(LOW), np.array(HIGH)
    angle = np.radians(TURNED)
    turn = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
    return (points[..., :2] - (low + high) / 2) @ turn, (high - low) / 2


def distance_to_foot(points):
    """Signed distance to the foot's outline, negative inside."""
    at, half = in_block(points)
    beyond = np.abs(at) - half
    return np.where((beyond > 0).any(axis=-1), np.linalg.norm(np.maximum(beyond, 0), axis=-1), beyond.max(axis=-1))


def distance_to_corner(points):
    """Distance to the nearest corner of the foot."""
    at, half = in_block(points)
    return np.linalg.norm(np.abs(at) - half, axis=-1)


def truth(points, solid):
    """Irradiance over pi of the floor outside the block, under a world of radiance 1."""
    sides = solid.vertices[solid.triangles]
    return np.array([1.0 - sum(oracle.point_to_polygon(p, UP, t) for t in sides) for p in points])


class Foot:
    def __init__(self, bottom: bool):
        self.solid = block("block", (*LOW, 0.0), (*HIGH, 0.5), reflectance=0.0, turned=TURNED, bottom=bottom)
        floor = exact.rectangle("floor", (-1, -1, 0), (2, 0, 0), (0, 2, 0), reflectance=0.0)
        settings = BakeSettings(quality="DRAFT", minimum_size=N, method="UNIFORM")
        self.result = bake(Scene((floor, self.solid), np.ones(3)), settings)
        self.floor = self.result.meshes[0]
        self.corners = self.floor.vertices[self.floor.triangles]
        # Midpoints of midpoints are whole numbers of 1/256 of the floor's triangles; what a cut adds is not.
        dyadic = self.floor.barycentric * 2.0**8
        self.is_cut = (dyadic != np.rint(dyadic)).any(axis=2)


@pytest.fixture(scope="module", params=[True, False], ids=["with a bottom", "without a bottom"])
def foot(request):
    return Foot(request.param)


def test_the_cut_follows_the_foot(foot):
    position = foot.corners[foot.is_cut]
    assert len(position) > 50
    # An edge is at most 2 n long and the search leaves 1/512 of it open; a cut keeps LEAST_PIECE of an edge
    # from its ends, so that the few that come closer are moved by up to that.
    off = np.abs(distance_to_foot(position))
    assert np.percentile(off, 90) <= 2 * N * SECTIONS**-SEARCHES
    assert off.max() <= 2 * N * LEAST_PIECE


def test_the_cut_is_unbiased(foot):
    position = foot.corners[foot.is_cut]
    assert abs(distance_to_foot(position).mean()) <= 2 * N * SECTIONS**-SEARCHES


def test_no_face_crosses_the_foot_away_from_its_corners(foot):
    middle = foot.corners.mean(axis=1)
    straight = distance_to_corner(middle) > 2 * N
    signed = distance_to_foot(foot.corners)
    slack = 2 * N * LEAST_PIECE
    crossing = (signed.min(axis=1) < -slack) & (signed.max(axis=1) > slack) & straight
    assert not crossing.any()


def test_cut_faces_fit_together(foot):
    assert t_junctions(foot.floor.vertices, foot.floor.triangles) == 0


def test_cutting_neither_loses_nor_turns_the_floor(foot):
    normal = crosses(foot.floor.vertices, foot.floor.triangles)
    assert (normal[:, 2] > 0).all()
    assert areas(foot.corners).sum() == pytest.approx(4.0, rel=1e-9)


def test_the_floor_under_the_block_is_dark(foot):
    middle = foot.corners.mean(axis=1)
    signed = distance_to_foot(foot.corners)
    under = (signed.max(axis=1) < 0.05 * N) & (signed.min(axis=1) < -0.1 * N) & (distance_to_corner(middle) > N)
    assert under.sum() > 100
    assert foot.floor.irradiance[under].max() == 0.0


def test_the_light_does_not_fade_towards_the_foot(foot):
    # At a cut, faces outside must show the light just outside of the block, not a mean with the dark; it is compared a
    # twentieth of the way into the face. 64 even rays know a half of the sky to within 0.02.
    middle = foot.corners.mean(axis=1)
    outside = (distance_to_foot(middle) > 0) & (distance_to_corner(middle) > N)
    inward = foot.corners + 0.05 * (middle[:, None] - foot.corners)
    at_cut = foot.is_cut & outside[:, None] & (distance_to_foot(inward) > 0)
    assert at_cut.sum() > 100
    error = foot.floor.irradiance[at_cut][:, 0] - truth(inward[at_cut], foot.solid)
    assert np.abs(error).max() < 0.08
    assert abs(error.mean()) < 0.01


def test_the_floor_outside_has_the_exact_light(foot):
    signed = distance_to_foot(foot.corners)
    outside = signed > 0.2 * N
    unique, first = np.unique(foot.corners[outside], axis=0, return_index=True)
    error = foot.floor.irradiance[outside][first][:, 0] - truth(unique, foot.solid)
    assert np.sqrt((error**2).mean()) < 0.04
    assert abs(error.mean()) < 0.01


def test_no_new_vertex_makes_a_sliver_along_an_edge(foot):
    edges = np.linalg.norm(np.roll(foot.corners, -1, axis=1) - foot.corners, axis=2)
    assert edges.min() > 0.01 * N / 4


@pytest.mark.parametrize("method", ["UNIFORM", "ADAPTIVE"])
def test_vertices_on_the_outline_of_a_low_block_show_the_light_beside_it(method):
    # The floor's vertices fall on the block's edges, where half of all rays end on its sides.
    floor = exact.rectangle("floor", (-1, -1, 0), (2, 0, 0), (0, 2, 0), reflectance=0.0)
    low = block("block", (-0.5, -0.5, 0.0), (0.5, 0.5, 0.01), reflectance=0.0)
    settings = BakeSettings(quality="DRAFT", minimum_size=0.1, method=method)
    mesh = bake(Scene((floor, low), np.ones(3)), settings).meshes[0]
    corners = mesh.vertices[mesh.triangles]
    off = np.abs(corners[..., :2]).max(axis=2)
    outside = corners[..., :2].mean(axis=1)
    outside = np.abs(outside).max(axis=1) > 0.5
    on = (np.abs(off - 0.5) < 1e-9) & outside[:, None]
    assert on.sum() > 20
    # A centimetre off it takes 0.2 of the sky, ten centimetres off 0.01; the light is drawn on from at least 0.75 of a
    # face's width.
    assert mesh.irradiance[on].min() > 0.8
    inside = np.abs(corners[..., :2]).max(axis=(1, 2)) < 0.5 - 1e-9
    assert mesh.irradiance[inside].max() == 0.0


def test_light_on_an_outline_stays_on_its_side():
    # Vertices 0 and 1 lie on a thin wall, 2 in the bright room and 3 in the dark one.
    of_corner = np.array([[0, 1, 2], [1, 0, 3]])
    seen, end = np.array([2, 2, 3, 3]), np.array([0, 1, 0, 1])
    ones, yes = np.ones(4), np.ones(4, dtype=bool)
    edges = CutEdges(seen, end, seen, end, ones, ones, yes, yes, 0.0 * ones)
    light = np.array([1.0, 1.0, 0.0, 0.0])[:, None].repeat(3, axis=1)
    corner, value = values_on_outlines(of_corner, edges, light, yes)
    assert corner.tolist() == [0, 1, 3, 4]
    assert value[:, 0].tolist() == [1.0, 1.0, 0.0, 0.0]
    # An edge that passes under something else tells nothing.
    corner, value = values_on_outlines(of_corner, edges, light, np.array([True, True, False, False]))
    assert corner.tolist() == [0, 1]


def test_a_vertex_that_uneven_faces_surround_gathers_where_it_is():
    points = np.array([[0.0, 0, 0], [1, 0, 0], [0.1, 0.1, 0], [0, 1, 0]])
    triangles = np.array([[0, 1, 2], [1, 3, 2], [3, 0, 2]])
    surfaces = join(Scene((surface_mesh("floor", points, triangles),), np.ones(3)))
    number = np.arange(4)
    faces = Faces(
        points, number, 0 * number, triangles, triangles, np.arange(3), np.tile(np.eye(3), (3, 1, 1)), np.arange(3)
    )
    places = receivers(surfaces, faces, np.arange(3), np.zeros(3, dtype=np.int64))
    moved = places.inward[places.of_corner[0]].any(axis=1)
    assert moved.tolist() == [True, True, False]


def test_a_block_in_the_air_cuts_nothing():
    floor = exact.rectangle("floor", (-1, -1, 0), (2, 0, 0), (0, 2, 0), reflectance=0.0)
    solid = block("block", (*LOW, 0.2), (*HIGH, 0.5), reflectance=0.0, turned=TURNED)
    result = bake(Scene((floor, solid), np.ones(3)), BakeSettings(quality="DRAFT", minimum_size=0.3, method="UNIFORM"))
    dyadic = result.meshes[0].barycentric * 2.0**8
    assert (dyadic == np.rint(dyadic)).all()
    assert result.meshes[0].irradiance.min() > 0


def test_a_patch_that_two_blocks_share_is_cut_by_both():
    floor = exact.rectangle("floor", (-1, -1, 0), (2, 0, 0), (0, 2, 0), reflectance=0.0)
    solids = [
        block(f"block {x}", (x - 0.15, -0.5, 0), (x + 0.15, 0.5, 0.4), reflectance=0.0, turned=t)
        for x, t in ((-0.3, 8), (0.3, -11))
    ]
    settings = BakeSettings(quality="DRAFT", minimum_size=0.1, method="UNIFORM")
    mesh = bake(Scene((floor, *solids), np.ones(3)), settings).meshes[0]
    assert t_junctions(mesh.vertices, mesh.triangles) == 0
    corners = mesh.vertices[mesh.triangles]
    dark = (mesh.irradiance[..., 0] == 0).all(axis=1)
    # What is dark has the area of the two feet, but for their corners, which a cut through a triangle rounds off.
    assert areas(corners)[dark].sum() == pytest.approx(2 * 0.3 * 1.0, rel=0.05)


def test_beyond_two_cuts_is_the_side_of_the_two_other_corners():
    # Corner 0 of the first triangle is seen, 1 and 2 are hidden. Across the edge 1-2, on another surface, 2 is seen,
    # so that the edge is cut for that one's sake, and the first triangle falls into four pieces.
    points = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [1, 1, 0]])
    triangles, of_corner = np.array([[0, 1, 2], [2, 1, 3]]), np.array([[0, 1, 2], [3, 4, 5]])
    number = np.arange(4)
    faces = Faces(points, number, 0 * number, triangles, triangles, np.arange(2), np.zeros((2, 3, 3)), np.arange(2))
    hidden = np.array([False, True, True, False, True, True])
    at = np.zeros((6, 3))
    places = Receivers(
        at, at, at, at, np.ones(6), np.arange(6), at, np.ones(6), *np.zeros((2, 6), dtype=int), of_corner
    )
    start, end, seen, unseen = np.array([[0, 1, 0, 1], [0, 2, 0, 2], [2, 1, 3, 4], [2, 3, 3, 5]]).T
    half = np.full(4, 0.5)
    no = np.zeros(4, dtype=bool)
    cuts = CutEdges(start, end, seen, unseen, half, half, no, no, 0.0 * half)
    bright, dark = np.ones((4, 3)), np.zeros((4, 3))
    values = np.where(hidden[of_corner], 0.0, 1.0)[..., None].repeat(3, axis=2)
    cut, face, light = cut_faces(faces, np.arange(2), places, hidden, cuts, values, bright, dark)
    lit = (light == 1.0).all(axis=(1, 2))
    assert (light[~lit] == 0.0).all()
    size = areas(cut.points[cut.corners[face]])
    for triangle in (0, 1):
        own = cut.triangle[face] == triangle
        assert size[own & lit].sum() == pytest.approx(0.5 / 4)
        assert size[own].sum() == pytest.approx(0.5)


def test_a_vertex_that_gathers_aside_does_not_move_the_cut():
    # Uneven faces around a vertex make its light be gathered a little into one of them; the outline stays where it is.
    points = np.array([[0.0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]])
    triangles = np.array([[0, 1, 2], [0, 2, 3]])
    number = np.arange(4)
    faces = Faces(points, number, 0 * number, triangles, triangles, np.arange(2), np.zeros((2, 3, 3)), np.arange(2))
    up, inward = np.tile(UP, (4, 1)), np.zeros((4, 3))
    inward[2] = (-0.05, -0.04, 0.0)
    zero, one = np.zeros((4, 3)), np.ones(4)
    places = Receivers(points + inward, up, up, zero, one, number, inward, one, *np.zeros((2, 4), dtype=int), triangles)
    hidden = np.array([False, False, True, True])
    cuts = find_cuts(faces, places, hidden, lambda where: where.points[:, 1] > 0.6)
    inner = ~cuts.border
    assert inner.sum() == 1
    assert (cuts.start[inner], cuts.end[inner]) == (0, 2)
    assert cuts.change[inner] == pytest.approx(0.6, abs=SECTIONS**-SEARCHES)
    # On the border it is gathered beside the edge, but no further along it.
    assert cuts.change[~cuts.border | (cuts.end == 2)] == pytest.approx(0.6, abs=0.04 + SECTIONS**-SEARCHES)


def test_the_foot_of_a_step_is_not_black_where_it_ends_at_a_wall():
    low = block("low step", (0.0, 0.0, 0.0), (1.4, 0.77, 0.22), reflectance=0.0)
    high = block("high step", (0.0, 0.42, 0.22), (1.4, 0.79, 0.44), reflectance=0.0)
    wall = exact.rectangle("wall", (1.4, -1.0, -0.5), (0, 0, 2.0), (0, 3.0, 0), reflectance=0.0)
    tread = bake(Scene((low, high, wall), np.ones(3)), BakeSettings(quality="DRAFT", minimum_size=0.1)).meshes[0]
    corners = tread.vertices[tread.triangles]
    # A cut is found to within 1/512 of an edge of at most 0.2.
    before_foot = (corners[..., 2] > 0.22 - 1e-6).all(axis=1) & (corners[..., 1].max(axis=1) < 0.4205)
    at_wall = before_foot & (corners[..., 0].min(axis=1) > 1.2)
    assert at_wall.any()
    # In the very corner a quarter of the sky is left, were wall and step without end; they hide no more than that.
    assert tread.irradiance[at_wall].min() > 0.2
