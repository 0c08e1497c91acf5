# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Triangles of several pieces in one plane: the walls of two rooms beside each other, or a face that is there twice."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from .scene import Floats, Ints

SAME_PLANE = 1e-6
"""By how much normals differ, and distances in a scene of size 1, within one plane: as little as float32 tells."""


def share_planes(
    normals: Floats, corners: Floats, shell: Ints, extent: float
) -> tuple[NDArray[np.bool_], NDArray[np.bool_]]:
    """Whether triangles lie in one plane with some of another shell that look the same way, and the other way.

    Parameters
    ----------
    normals : (t, 3) float
    corners : (t, 3, 3) float
    shell : (t,) int
    extent : float
        Size of the scene.
    """
    alike, opposed = np.zeros(len(shell), dtype=bool), np.zeros(len(shell), dtype=bool)
    if len(shell) == 0:
        return alike, opposed
    largest = np.take_along_axis(normals, np.abs(normals).argmax(axis=1)[:, None], axis=1)
    turn = np.where(largest < 0.0, -1.0, 1.0)
    middle = (corners.min(axis=(0, 1)) + corners.max(axis=(0, 1))) / 2.0
    axis = turn * normals
    offset = np.einsum("tx,tx->t", axis, corners.mean(axis=1) - middle) / extent
    values = np.column_stack([axis, offset]) / SAME_PLANE
    # Rounded in two ways, so that no plane is on the border of both.
    for shift in (0.0, 0.5):
        _, plane = np.unique(np.rint(values + shift).astype(np.int64), axis=0, return_inverse=True)
        plane = plane.ravel()
        side = 2 * plane + (turn[:, 0] > 0.0)
        by_side = np.bincount(
            np.unique(np.column_stack([side, shell]), axis=0)[:, 0], minlength=2 * int(plane.max()) + 2
        )
        by_plane = np.bincount(np.unique(np.column_stack([plane, shell]), axis=0)[:, 0])
        alike |= by_side[side] > 1
        opposed |= (by_side[side ^ 1] > 0) & (by_plane[plane] > 1)
    return alike, opposed
