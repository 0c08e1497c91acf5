# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""How far off a baked mesh is: by what is missed between vertices, by noise of the gather and by lost light."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .checks import Checks
from .geometry import lengths, triangle_areas
from .scene import Floats, Ints

SAFETY = 1.75
"""What the estimate is multiplied by: it cannot see what all rays of the gather agree on, such as the error of the
patches' own radiosity, nor every small place."""


FAR_OFF = {"DRAFT": 0.5, "GOOD": 0.2, "HIGH": 0.1}
"""Estimate above which a bake says that it is far from what its quality stands for: ten times as much."""

LIT_AREA_STEP = 1e-3
"""Share by which the lit area may still fall when it is taken for found."""

DIM = 1.0 / 16.0
"""Share of the mean light below which an area counts for less, in proportion to its light: a wide black ground around a
room would otherwise halve the mean, and so the error that is allowed, as often as it is doubled."""


BLACK = 1.0 / 256.0
"""The same in the estimate, which is to be that of all the surface where it has any light to speak of."""


def lit_area(area: Floats, light: Floats, dim: float = DIM) -> tuple[float, float]:
    """Area that has light, and the mean light of all over it.

    What is dimmer than a share `dim` of this mean counts for as much of its area as it has of that.

    Parameters
    ----------
    area : (f,) float
    light : (f,) float
        Light times area.

    Returns
    -------
    Zeros where there is no light.
    """
    total, counted = float(light.sum()), float(area.sum())
    if total <= 0.0:
        return 0.0, 0.0
    # Less area makes the mean larger, which dims the rest: it falls from step to step to the largest that fits itself.
    while True:
        fitting = float(np.minimum(area, light * counted / (dim * total)).sum())
        if fitting > (1.0 - LIT_AREA_STEP) * counted:
            return counted, total / counted
        counted = fitting


def gradients(corners: Floats, values: Floats) -> Floats:
    """Gradients of linear functions on each triangle, in its plane, (f, c, 3).

    Parameters
    ----------
    corners : (f, 3, 3) float
    values : (f, 3, c) float
        At the corners.
    """
    e1, e2 = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    d1, d2 = values[:, 1] - values[:, 0], values[:, 2] - values[:, 0]
    g11, g12, g22 = (np.einsum("fx,fx->f", a, b)[:, None] for a, b in ((e1, e1), (e1, e2), (e2, e2)))
    det = g11 * g22 - g12 * g12
    det = np.where(det > 0.0, det, np.inf)
    a, b = (d1 * g22 - d2 * g12) / det, (d2 * g11 - d1 * g12) / det
    result: Floats = np.einsum("fc,fx->fcx", a, e1) + np.einsum("fc,fx->fcx", b, e2)
    return result


PAIRS_AT_ONCE = 2**14
"""Pairs of faces whose working arrays stay in a core's second cache."""


@dataclass(frozen=True, eq=False)
class Neighbours:
    """Pairs of faces that share an edge.

    Attributes
    ----------
    edge, other : (p,) int32
        The edge as one of each face's own, counted through all faces, three for each.
    reach : (p,) float, scene units
        How far a change of gradient at the edge reaches.
    """

    edge: NDArray[np.int32]
    other: NDArray[np.int32]
    reach: Floats

    def beside(self, faces: NDArray[np.bool_]) -> Neighbours:
        """Those pairs one of which is among `faces`, (f,) bool."""
        some = np.flatnonzero(faces[self.edge // 3] | faces[self.other // 3])
        return Neighbours(self.edge[some], self.other[some], self.reach[some])


def neighbours(corners: Floats, of_corner: Ints) -> Neighbours:
    """Find the faces that share an edge, and how far what changes there reaches.

    That is the edge's length, between one and two altitudes on it as in a right isosceles triangle: slender faces reach
    far from their short edges, and not from their long ones.

    Parameters
    ----------
    corners : (f, 3, 3) float, scene units
    of_corner : (f, 3) int
        Receivers of the corners: faces that share two are neighbours.
    """
    following = of_corner[:, [1, 2, 0]]
    low, high = np.minimum(of_corner, following).ravel(), np.maximum(of_corner, following).ravel()
    key = low * np.int64(of_corner.max(initial=0) + 1) + high
    order = np.argsort(key, kind="stable")
    key = key[order]
    pair = np.flatnonzero(key[1:] == key[:-1])
    edge, other = order[pair], order[pair + 1]
    points, first = corners.reshape(-1, 3), edge // 3
    length = lengths(points[3 * first + (edge + 1) % 3] - points[edge])
    area = triangle_areas(corners)
    altitude = np.divide(area[first] + area[other // 3], length, out=np.zeros(len(pair)), where=length > 0.0)
    reach = np.clip(length, altitude, 2.0 * altitude)
    return Neighbours(edge.astype(np.int32), other.astype(np.int32), reach)


def interpolation_error(corners: Floats, beside: Neighbours, values: Floats) -> Floats:
    """Estimated RMS error of linear interpolation on each face and over the channels, (f,), in the unit of `values`.

    Where a smooth function is interpolated, the gradient jumps across an edge by about its second derivative times the
    distance h of the faces' middles, and the error in between is h^2 / 8 times that derivative (Zienkiewicz & Zhu 1987
    estimate the same from the recovered gradient). For h stands `Neighbours.reach`.

    A face without neighbours, as each is of a flat ball, has no such jump. Light that falls by a share s across it in a
    smooth way is missed by about s^2 / 8 of itself, and a shadow's border, where s is 1, by up to a half: s^2 / 2.

    Parameters
    ----------
    corners : (f, 3, 3) float, scene units
    beside : Neighbours
        Among these faces.
    values : (f, 3, c) float
        At the corners.
    """
    gradient = gradients(corners, values)
    a, b, c = (np.ascontiguousarray(values[:, corner]) for corner in range(3))
    low, high = np.minimum(np.minimum(a, b), c), np.maximum(np.maximum(a, b), c)
    # Where three faces share an edge, one of them is in two pairs, once on either side.
    square = np.zeros(3 * len(corners))
    alone = np.ones(len(corners), dtype=bool)
    alone[beside.edge // 3], alone[beside.other // 3] = False, False
    alone = np.flatnonzero(alone)
    # What is drawn on in a straight line beyond a cut may be below zero.
    span = high[alone] - low[alone]
    own = span**2 / (2.0 * np.maximum(np.maximum(high[alone], span), np.finfo(np.float64).tiny))
    square[3 * alone] = (own**2).mean(axis=1)
    for start in range(0, len(beside.edge), PAIRS_AT_ONCE):
        edge, other = (side[start : start + PAIRS_AT_ONCE] for side in (beside.edge, beside.other))
        first, second = edge // 3, other // 3
        jump = lengths(gradient.take(first, axis=0) - gradient.take(second, axis=0))
        # Around a thin rod gradients turn with the surface: no more is missed than half of what the values span.
        span = np.maximum(high.take(first, axis=0), high.take(second, axis=0))
        span -= np.minimum(low.take(first, axis=0), low.take(second, axis=0))
        missed = np.minimum(jump * (beside.reach[start : start + PAIRS_AT_ONCE] / 8.0)[:, None], span / 2.0)
        missed *= missed
        mean = missed @ np.full(missed.shape[1], 1.0 / missed.shape[1])
        square[edge] = np.maximum(square[edge], mean)
        square[other] = np.maximum(square[other], mean)
    a, b, c = square.reshape(-1, 3).T
    return np.sqrt(np.maximum(np.maximum(a, b), c))


@dataclass(frozen=True, eq=False)
class Expected:
    """What the light at the vertices of face sides lets expect of the error.

    Attributes
    ----------
    weight : (f,) float
        Area that counts (of emitters and of what is hidden, none).
    light : (f,) float
        Mean over the corners and channels.
    missed : (f,) float
        Squared error of interpolation.
    noise : (f,) float
        Squared standard error.
    front : (f,) bool
    """

    weight: Floats
    light: Floats
    missed: Floats
    noise: Floats
    front: NDArray[np.bool_]


def relative_error(expected: Expected, checks: Checks, fronts: int, irradiance: Floats, imbalance: float) -> float:
    """Estimate the RMS error relative to the mean: over the fronts, or over all sides if that is more.

    Interpolation, the noise that vertices have in common and lost light are added in squares. What interpolation misses
    is the mean of two: what is expected is known everywhere, what the checks find is true, but of few places.

    Parameters
    ----------
    expected : Expected
    checks : Checks
    fronts : int
        Face sides that the checks are on and that are fronts; backs are behind them.
    irradiance : (f, 3, 3) float, W m^-2 sr^-1
        At the corners of these.
    imbalance : float
        Share of the power that is unaccounted for.
    """
    light = np.einsum("kc,kcx->kx", checks.weights, irradiance[checks.row])
    light[checks.gathered.hidden] = 0.0
    found = (checks.missed(irradiance) ** 2).mean(axis=1)
    largest = 0.0
    # The backs of walls under a bright sky would hide what is wrong in a room.
    for sides, asked in ((expected.front, checks.row < fronts), (True, True)):
        weight, area = expected.weight * sides, checks.areas * asked
        missed, noise = (_relative(weight, expected.light, square) for square in (expected.missed, expected.noise))
        square = (missed + _relative(area, light.mean(axis=1), found) + noise) / 2.0 + imbalance**2
        largest = max(largest, SAFETY * math.sqrt(square))
    return largest


def _relative(area: Floats, light: Floats, square: Floats) -> float:
    """Mean of squares over an area, relative to the square of the mean light; 0 in the dark."""
    lit, mean = lit_area(area, area * light, BLACK)
    return float(area @ square) / lit / mean**2 if mean > 0.0 else 0.0


def error_warnings(error: float, quality: str, output: str) -> list[str]:
    """A sentence where the light changes faster than the mesh can show.

    Parameters
    ----------
    error : float
        As `relative_error` gives it.
    """
    if error <= FAR_OFF[quality]:
        return []
    if output == "ORIGINAL":
        what = "bake to Refined Mesh, or subdivide the mesh where shadows and lamps are"
    else:
        what = "choose a smaller Minimum Size, and look for something that shines right beside a surface"
    return [f"The estimated error of {error:.0%} is far more than {quality.title()} stands for; {what}"]
