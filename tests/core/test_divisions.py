# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Triangles that a thin wall divides: where it stands on their edges, and what light each side takes."""

import numpy as np
import pytest
from radiosity_bake.core.cut_edges import edges_under_walls
from radiosity_bake.core.cutting import cut_faces
from radiosity_bake.core.divisions import Divisions, blocked_edges
from radiosity_bake.core.receivers import Receivers
from radiosity_bake.core.subdivision import Faces
from radiosity_bake.core.visibility import RayScene

UP = np.array([0.0, 0.0, 1.0])
POINTS = np.array([[0.0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]])
TRIANGLES = np.array([[0, 1, 2], [2, 3, 0]])
WALL_AT = 0.4


def floor_and_wall(height=0.0, length=3.0):
    """The unit square and, at x + y = WALL_AT, a wall as high as it from a height on."""
    ends = np.array([[WALL_AT, 0.0], [0.0, WALL_AT]]) + np.array([[1.0, -1.0], [-1.0, 1.0]]) * (length - 1.0) / 2.0
    wall = np.array([[*ends[0], height], [*ends[1], height], [*ends[1], 1.0], [*ends[0], 1.0]])
    return RayScene(np.concatenate([POINTS, wall]), np.concatenate([TRIANGLES, TRIANGLES + 4]))


def floor_places():
    up, zero = np.tile(UP, (4, 1)), np.zeros((4, 3))
    one, number = np.ones(4), np.arange(4)
    return Receivers(POINTS, up, up, zero, one, number, zero, one, 0 * number, 0 * number, TRIANGLES)


def floor_faces():
    number = np.arange(4)
    weights = np.tile(np.eye(3), (2, 1, 1))
    return Faces(POINTS, number, 0 * number, TRIANGLES, TRIANGLES, np.arange(2), weights, np.arange(2))


NONE_HIDDEN = np.zeros(4, dtype=bool)
ALL = np.ones(4, dtype=bool)


@pytest.mark.parametrize("height", [0.0, 1e-3], ids=["on the floor", "a hair above it"])
def test_a_wall_is_met_where_it_stands_on_the_edges_from_both_ends(height):
    rays = floor_and_wall(height)
    ways = blocked_edges(rays, floor_places(), TRIANGLES, NONE_HIDDEN, 0.05, ALL)
    rays.close()
    expected = [[[0.4, 0.6], [1, 1], [0.8, 0.2]], [[1, 1], [0.6, 0.4], [0.2, 0.8]]]
    # The wall stands where x + y is 0.4; single precision of coordinates up to 1.
    assert ways == pytest.approx(np.array(expected), abs=1e-5)


def test_what_hangs_higher_than_a_gap_divides_nothing():
    rays = floor_and_wall(height=0.1)
    assert (blocked_edges(rays, floor_places(), TRIANGLES, NONE_HIDDEN, 0.05, ALL) == 1.0).all()
    rays.close()


def test_a_wall_that_ends_within_a_triangle_does_not_divide_it():
    # It crosses the diagonal, and ends before the two other edges.
    rays = floor_and_wall(length=0.5)
    ways = blocked_edges(rays, floor_places(), TRIANGLES, NONE_HIDDEN, 0.05, ALL)
    rays.close()
    assert (ways < 1.0).all(axis=2).sum() == 2
    assert len(Divisions.of(ways).number) == 0
    assert len(edges_under_walls(floor_faces(), floor_places(), NONE_HIDDEN, ways).start) == 0


def test_places_take_the_corners_of_their_own_side_alone():
    rays = floor_and_wall()
    divisions = Divisions.of(blocked_edges(rays, floor_places(), TRIANGLES, NONE_HIDDEN, 0.05, ALL))
    rays.close()
    assert divisions.number.tolist() == [0, 1]
    assert divisions.alone.tolist() == [0, 2]
    assert divisions.thin.all()
    shares = np.random.default_rng(5).dirichlet(np.ones(3), 200)
    triangle = np.repeat([0, 1], 100)
    divided, own = divisions.own_corners(triangle, shares)
    assert divided.tolist() == list(range(200))
    at = np.einsum("mk,mkx->mx", shares, POINTS[TRIANGLES[triangle]])
    near = at[:, 0] + at[:, 1] < WALL_AT
    is_near = np.array([[True, False, False], [False, False, True]])[triangle]
    assert near.any() and not near.all()
    assert own.sum(axis=1) == pytest.approx(np.ones(200))
    assert (own[is_near != near[:, None]] == 0.0).all()
    # Beyond the wall, the two corners keep their ratio.
    far = np.flatnonzero(~near & (triangle == 0))
    assert own[far, 1] * shares[far, 2] == pytest.approx(own[far, 2] * shares[far, 1])


def test_the_two_pieces_of_a_divided_face_take_the_light_of_their_own_side():
    rays = floor_and_wall()
    faces, places = floor_faces(), floor_places()
    cuts = edges_under_walls(faces, places, NONE_HIDDEN, blocked_edges(rays, places, TRIANGLES, NONE_HIDDEN, 0.05, ALL))
    rays.close()
    assert len(cuts.start) == 3
    # Corner 0 is in the bright room, all others are in the dark one; each cut is drawn from both of its ends.
    bright = np.array([1.0, 0.0, 0.0, 0.0])
    at_start, at_end = (np.repeat(bright[end][:, None], 3, axis=1) for end in (cuts.seen, cuts.hidden))
    values = np.repeat(bright[TRIANGLES][..., None], 3, axis=2)
    cut, face, light = cut_faces(faces, np.arange(2), places, NONE_HIDDEN, cuts, values, at_start, at_end)
    corners = cut.points[cut.corners[face]]
    near = corners.mean(axis=1)[:, :2].sum(axis=1) < WALL_AT
    assert (light[near] == 1.0).all()
    assert (light[~near] == 0.0).all()
    size = np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1) / 2.0
    assert size[near].sum() == pytest.approx(WALL_AT**2 / 2.0)
    assert size.sum() == pytest.approx(1.0)
