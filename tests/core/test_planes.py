# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Triangles in one plane, wherever it lies."""

import numpy as np
import pytest
from radiosity_bake.core.planes import share_planes


def planes_of(triangles, shell):
    corners = np.asarray(triangles, dtype=np.float64)
    cross = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normals = cross / np.linalg.norm(cross, axis=1)[:, None]
    extent = float(np.ptp(corners.reshape(-1, 3), axis=0).max())
    return share_planes(normals, corners, np.array(shell), extent)


@pytest.mark.parametrize("seed", range(20))
def test_triangles_of_two_pieces_in_one_plane_are_found_wherever_it_lies(seed):
    rng = np.random.default_rng(seed)
    turn, by = np.linalg.qr(rng.normal(size=(3, 3)))[0], rng.normal(size=3) * 100.0
    flat = rng.uniform(-1.0, 1.0, (4, 3, 3)) * (1.0, 1.0, 0.0)
    flat[3, :, 2] = 1e-3
    corners = flat @ turn.T + by
    alike, opposed = planes_of(corners, [0, 0, 1, 2])
    assert (alike | opposed).tolist() == [True, True, True, False]


def test_of_one_piece_or_one_way_none_look_the_other_way():
    up, down = [(0, 0, 0), (1, 0, 0), (0, 1, 0)], [(0, 0, 0), (0, 1, 0), (1, 0, 0)]
    assert not planes_of([up, down], [0, 0])[1].any()
    assert not planes_of([up, up], [0, 1])[1].any()
    assert planes_of([up, down], [0, 1])[1].all()
    assert not planes_of([up, down], [0, 1])[0].any()
    assert planes_of([up, up], [0, 1])[0].all()
