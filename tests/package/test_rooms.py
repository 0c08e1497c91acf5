# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The example rooms that tests, benchmarks and the demo share."""

from __future__ import annotations

import numpy as np
import pytest

from tools.rooms import CAMERAS, ROOMS, cornell_box, paper_scene_1


def normals_and_centres(surface):
    points = np.array(surface.vertices)
    for face in surface.faces:
        corners = points[list(face)]
        yield np.cross(corners[1] - corners[0], corners[2] - corners[0]), corners.mean(axis=0)


@pytest.mark.parametrize("room", ROOMS)
def test_walls_face_into_the_room_and_closed_things_face_outwards(room):
    for surface in ROOMS[room]():
        everything = np.array([p for s in ROOMS[room]() for p in s.vertices])
        middle = (everything.min(axis=0) + everything.max(axis=0)) / 2
        own_middle = np.array(surface.vertices).mean(axis=0)
        for normal, centre in normals_and_centres(surface):
            if len(surface.faces) <= 4:  # a wall, or the ceiling around the lamp
                assert normal @ (middle - centre) > 0, surface.name
            else:
                assert normal @ (centre - own_middle) > 0, surface.name


def test_the_cornell_box_has_its_published_size():
    points = np.array([p for s in cornell_box() for p in s.vertices])
    np.testing.assert_allclose(np.ptp(points, axis=0), [0.556, 0.5592, 0.5488], atol=1e-12)


def test_every_surface_has_a_name_of_its_own_and_a_physical_reflectance():
    for surfaces in (cornell_box(), paper_scene_1()):
        assert len({s.name for s in surfaces}) == len(surfaces)
        assert all(0.0 <= value < 1.0 for s in surfaces for value in s.reflectance)
        assert [s.name for s in surfaces if max(s.emission) > 0.0] == ["Lamp"]


def test_scene_1_of_the_paper_has_five_cubes_and_a_cube_lamp():
    cubes = [s for s in paper_scene_1() if len(s.faces) == 6]
    assert [s.name for s in cubes] == ["Cube 1", "Cube 2", "Cube 3", "Cube 4", "Cube 5", "Lamp"]


def test_there_is_a_camera_for_every_room():
    assert CAMERAS.keys() == ROOMS.keys()
