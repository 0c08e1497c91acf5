# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The estimated error of interpolation, on a function whose own is known."""

import numpy as np
import pytest
from radiosity_bake.core.error_estimate import interpolation_error

CELLS = 8


def strips(width, length):
    """Corners (f, 3, 3) and their numbers (f, 3) of a plane cut into cells of a width and a length, two faces each."""
    x, y = np.meshgrid(width * np.arange(CELLS + 1), length * np.arange(CELLS + 1), indexing="ij")
    points = np.stack([x.ravel(), y.ravel(), np.zeros(x.size)], axis=1)
    first = ((CELLS + 1) * np.arange(CELLS)[:, None] + np.arange(CELLS)).ravel()
    a, b, c, d = first, first + CELLS + 1, first + CELLS + 2, first + 1
    faces = np.concatenate([np.stack([a, b, c], axis=1), np.stack([a, c, d], axis=1)])
    return points[faces], faces


@pytest.mark.parametrize("slenderness", [1.0, 10.0, 100.0])
@pytest.mark.parametrize("axis", [0, 1])
def test_the_error_over_cells_follows_their_extent_along_which_light_changes(axis, slenderness):
    width = 0.1
    corners, of_corner = strips(width, slenderness * width)
    extent = (width, slenderness * width)[axis]
    found = interpolation_error(corners, of_corner, corners[..., axis] ** 2)
    # Faces on the border have no neighbour behind it that would tell.
    along = corners[..., axis]
    inside = (along.min(axis=1) > 0.5 * extent) & (along.max(axis=1) < (CELLS - 0.5) * extent)
    # Chords of x^2 miss h^2 / 4 in the middle of a cell. Where cells are longer than wide, the estimate may take the
    # edge for up to two altitudes.
    assert found[inside].min() >= (1.0 - 1e-9) * 0.25 * extent**2
    assert found[inside].max() <= (1.0 + 1e-9) * 0.5 * extent**2
