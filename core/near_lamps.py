# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Lamps close to a patch: most of their light falls between the few points that the patch is sampled at, or on one."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from .geometry import largest_edges
from .lamp_shapes import unoccluded
from .scene import Floats, Lamp, PointLamp

NEAR_SIZE = 0.25
"""Longest edge of a triangle, in distances of the lamp, up to which the light on it is about that at three points: they
integrate it to the second order, and what is left is below 0.1%."""

SLENDER = 4.0
"""Longest edge over the altitude on it from which on a triangle is halved, and not cut into four, which are as slender:
of a sliver's parts, a lamp would have twice as many near it with each cut."""

MOST_HALVINGS = 12
"""Splits of a patch towards a lamp that all but touches it."""


def near_shares(lamps: tuple[Lamp, ...], corners: Floats, points: Floats, normals: Floats) -> dict[int, Floats]:
    """By what the light that each lamp sends to a few points of triangles is to be multiplied, (n,), by its number.

    Were nothing in the way, it is then the mean over each triangle. Lamps that are near to none are left out.

    Parameters
    ----------
    corners : (n, 3, 3) float
    points, normals : (n, p, 3) float
    """
    if len(points) == 0:
        return {}
    found = {}
    for number, lamp in enumerate(lamps):
        if not isinstance(lamp, PointLamp) or not lamp.strength.any():
            continue
        near = np.flatnonzero(_is_near(lamp, corners))
        sampled = unoccluded(lamp, points[near].reshape(-1, 3), normals[near].reshape(-1, 3))
        sampled = sampled.reshape(len(near), points.shape[1]).mean(axis=1)
        lit = sampled > 0.0
        if lit.any():
            shares = np.ones(len(points))
            shares[near[lit]] = mean_unoccluded(lamp, corners[near[lit]], normals[near[lit], 0]) / sampled[lit]
            found[number] = shares
    return found


def mean_unoccluded(lamp: PointLamp, corners: Floats, normals: Floats) -> Floats:
    """Mean over triangles of the irradiance over pi for a strength of 1, were nothing in the way, (n,).

    Parameters
    ----------
    corners : (n, 3, 3) float
    normals : (n, 3) float
    """
    mean = np.zeros(len(corners))
    triangle, share = np.arange(len(corners)), np.ones(len(corners))
    for halving in range(MOST_HALVINGS + 1):
        split = _is_near(lamp, corners) if halving < MOST_HALVINGS else np.zeros(len(corners), dtype=bool)
        done = np.flatnonzero(~split)
        middles = (corners[done] + np.roll(corners[done], -1, axis=1)) / 2.0
        light = unoccluded(lamp, middles.reshape(-1, 3), np.repeat(normals[triangle[done]], 3, axis=0))
        weighted = share[done] * light.reshape(-1, 3).mean(axis=1)
        mean += np.bincount(triangle[done], weights=weighted, minlength=len(mean))
        slender = _is_slender(corners)
        four, two = np.flatnonzero(split & ~slender), np.flatnonzero(split & slender)
        corners = np.concatenate([_quarters(corners[four]), _halves(corners[two])])
        triangle = np.concatenate([np.tile(triangle[four], 4), np.tile(triangle[two], 2)])
        share = np.concatenate([np.tile(share[four] / 4.0, 4), np.tile(share[two] / 2.0, 2)])
    return mean


def _is_near(lamp: PointLamp, corners: Floats) -> NDArray[np.bool_]:
    """Whether light changes too much over triangles, (n,)."""
    distance = np.linalg.norm(corners.mean(axis=1) - lamp.centre, axis=1)
    size = _sizes(corners)
    near: NDArray[np.bool_] = size > NEAR_SIZE * np.maximum(distance, lamp.radius)
    return near


def _is_slender(corners: Floats) -> NDArray[np.bool_]:
    """Whether triangles are much longer than wide, (n,)."""
    across = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    slender: NDArray[np.bool_] = _sizes(corners) ** 2 > SLENDER * np.linalg.norm(across, axis=1)
    return slender


def _sizes(corners: Floats) -> Floats:
    """Longest edges of triangles, (n,)."""
    return largest_edges(corners.reshape(-1, 3), np.arange(3 * len(corners)).reshape(-1, 3))


def _halves(corners: Floats) -> Floats:
    """Triangles cut from the middle of their longest edge, (2 n, 3, 3)."""
    longest = np.linalg.norm(np.roll(corners, -1, axis=1) - corners, axis=2).argmax(axis=1)
    turn = (longest[:, None] + np.arange(3)) % 3
    a, b, c = np.moveaxis(np.take_along_axis(corners, turn[..., None], axis=1), 1, 0)
    middle = (a + b) / 2.0
    return np.concatenate([np.stack(part, axis=1) for part in ((a, middle, c), (middle, b, c))])


def _quarters(corners: Floats) -> Floats:
    """Triangles cut by the middles of their edges, (4 n, 3, 3)."""
    a, b, c = corners[:, 0], corners[:, 1], corners[:, 2]
    ab, bc, ca = (a + b) / 2.0, (b + c) / 2.0, (c + a) / 2.0
    return np.concatenate([np.stack(part, axis=1) for part in ((a, ab, ca), (ab, b, bc), (ca, bc, c), (ab, bc, ca))])
