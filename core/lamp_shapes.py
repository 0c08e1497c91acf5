# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The shapes of lamps, and what each would send a receiver, were nothing in the way.

To a receiver every lamp is a flat shape: a sphere is the disk in which its tangents touch it, a sun is a disk at a
distance of 1. Where the light of a shape has a closed form, it is taken; elsewhere many places of the shape are added
up.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from .form_factors import point_to_triangle
from .sampling import GOLDEN, frames
from .scene import AreaLamp, Cone, Falloff, Floats, Ints, Lamp, PointLamp, Profile, SunLamp

FEW_LAMPS = 32
"""Lamps of which each gets a ray from every receiver: as many as a world may have suns."""

NEAR = 2.0
"""Radii from the middle of a lamp within which its light is not that of a point."""

PLACES = 256
"""Places of a lamp that are added up where its light has no closed form. A straight edge, such as the horizon's, cuts
off a share that is wrong by 0.8 * 0.5 * 256**-0.75 = 0.6% of the lamp (`LATTICE_ERROR`)."""

PROFILE_PLACES = 16
"""Places of a lamp over which its profile is averaged where the rest has a closed form: it changes slowly over them."""

PLACES_AT_ONCE = 2**17
"""Receivers times places whose working arrays are in memory at once."""

CLOSEST = 1.001
"""Radii from a sphere's middle at which a receiver inside sees it: just outside, where half of all it sees shines."""

ROUNDING = 1e-6
"""By which the edge of a beam is wider when receivers are chosen, radians: more than arccos loses near 1."""

TINY = np.finfo(np.float64).tiny


@dataclass(frozen=True, eq=False)
class Shapes:
    """A lamp as each of n receivers sees it.

    Attributes
    ----------
    way : (n, 3) float
        From the receivers to the middle: scene units, or a length of 1 to a sun.
    half_axes : (n, 2, 3) float
    normals : (n, 3) float, unit
        Where the shape shines to.
    weight : (n,) float
        Its area times its radiance, for a strength of 1.
    """

    way: Floats
    half_axes: Floats
    normals: Floats
    weight: Floats


@dataclass(frozen=True, eq=False)
class EvenPoints:
    """Those of many lamps that shine to all sides alike.

    Attributes
    ----------
    lamp : (k,) int
    centre : (k, 3) float
    radius : (k,) float
    soft : (k,) bool
    """

    lamp: Ints
    centre: Floats
    radius: Floats
    soft: NDArray[np.bool_]

    def taken(self, which: Ints) -> EvenPoints:
        """Some of them."""
        return EvenPoints(self.lamp[which], self.centre[which], self.radius[which], self.soft[which])


@lru_cache(maxsize=4)
def even_points(lamps: tuple[Lamp, ...]) -> EvenPoints:
    found = [(k, lamp) for k, lamp in enumerate(lamps) if isinstance(lamp, PointLamp) and lamp.is_even]
    return EvenPoints(
        np.array([k for k, _ in found], dtype=np.int64),
        np.array([lamp.centre for _, lamp in found], dtype=np.float64).reshape(-1, 3),
        np.array([lamp.radius for _, lamp in found], dtype=np.float64),
        np.array([lamp.soft for _, lamp in found], dtype=bool),
    )


def ways_to_points(lamps: EvenPoints, points: Floats, square: Floats) -> tuple[Floats, Floats]:
    """From receivers to a place on the disk that each sees of its lamp, and where the disk shines to, both (r, 3)."""
    way, radius = lamps.centre - points, lamps.radius
    distance = np.maximum(np.linalg.norm(way, axis=1), np.maximum(CLOSEST * radius, TINY))
    # A sphere is seen as the disk in which the tangents touch it.
    nearer = np.where(lamps.soft, 1.0, 1.0 - (radius / distance) ** 2)
    toward = way / distance[:, None]
    across = frames(toward, np.zeros(len(way)))[:, :2].astype(np.float64)
    away, turn = radius * np.sqrt(nearer * square[:, 0]), 2.0 * np.pi * square[:, 1]
    aside = np.stack([away * np.cos(turn), away * np.sin(turn)], axis=1)
    return way * nearer[:, None] + np.einsum("rk,rkx->rx", aside, across), -toward


def unoccluded_of_all(lamps: tuple[Lamp, ...], points: Floats, normals: Floats) -> Floats:
    """Irradiance over pi for strengths of 1, were nothing in the way, (l, n): as `unoccluded`, but faster of many."""
    if len(lamps) <= FEW_LAMPS:
        return np.stack([unoccluded(lamp, points, normals) for lamp in lamps])
    light = np.zeros((len(lamps), len(points)))
    even = even_points(lamps)
    # About their middle, as products of large coordinates cancel.
    origin = points.mean(axis=0)
    centre, at = even.centre - origin, points - origin
    radius, soft = even.radius[:, None], even.soft[:, None]
    height = centre @ normals.T - np.einsum("nx,nx->n", at, normals)
    square = np.maximum((centre**2).sum(axis=1)[:, None] + (at**2).sum(axis=1) - 2.0 * centre @ at.T, TINY)
    light[even.lamp] = np.maximum(height, 0.0) / ((square + soft * radius**2) * np.sqrt(square) * np.pi)
    # What reaches below the horizon, and what is as near as it is large, is done one by one.
    single = (np.abs(height) < radius) | (square < NEAR**2 * radius**2)
    for row in np.flatnonzero(single.any(axis=1)):
        number, some = even.lamp[row], np.flatnonzero(single[row])
        light[number, some] = unoccluded(lamps[number], points[some], normals[some])
    for number in np.setdiff1d(np.arange(len(lamps)), even.lamp):
        light[number] = unoccluded(lamps[number], points, normals)
    return light


def unoccluded(lamp: Lamp, points: Floats, normals: Floats) -> Floats:
    """Irradiance over pi for a strength of 1, were nothing in the way, (n,).

    Parameters
    ----------
    points, normals : (n, 3) float
    """
    shapes = shapes_of(lamp, points)
    height = np.einsum("nx,nx->n", shapes.way, normals)
    reach = np.sqrt((np.einsum("nkx,nx->nk", shapes.half_axes, normals) ** 2).sum(axis=1))
    light = np.zeros(len(points))
    if isinstance(lamp, AreaLamp):
        # The corner of a rectangle reaches farther than the rim of its ellipse.
        seen = (height + np.sqrt(2.0) * reach > 0.0) & (np.einsum("nx,nx->n", shapes.way, shapes.normals) < 0.0)
        summed = np.flatnonzero(seen)
        if not lamp.elliptic and lamp.spread >= np.pi:
            corners = _triangles_of(lamp)
            light[summed] = point_to_triangle(points[summed, None], normals[summed, None], corners).sum(axis=1)
            return light
    else:
        summed = np.flatnonzero(height + reach > 0.0)
        if isinstance(lamp, SunLamp) or lamp.cone is None:
            # A disk that faces its receiver, seen whole: E = pi L sin^2 alpha cos theta.
            square = (shapes.way**2).sum(axis=1)
            radius_square = (shapes.half_axes[:, 0] ** 2).sum(axis=1)
            above = np.flatnonzero(height >= reach)
            facing = shapes.weight[above] / (square + radius_square)[above]
            light[above] = facing * height[above] / np.sqrt(np.maximum(square[above], TINY)) / np.pi
            if isinstance(lamp, PointLamp) and lamp.profile is not None:
                above = above[light[above] > 0.0]
                light[above] *= _mean_in_profile(lamp, lamp.profile, points[above])
            if isinstance(lamp, PointLamp) and lamp.falloff is not None:
                light[above] *= _at_distance(lamp.falloff, square[above])
            summed = summed[height[summed] < reach[summed]]
    summed = summed[_in_beam(lamp, points[summed])]
    places = 1 if is_sharp(lamp) else PLACES
    size = PLACES_AT_ONCE // places
    for part in (summed[k : k + size] for k in range(0, len(summed), size)):
        ways = ways_to(lamp, points[part], places, np.full((len(part), 2), 0.5))
        kernel = kernel_of(lamp, shapes.normals[part], normals[part], ways)
        light[part] = shapes.weight[part] * kernel.mean(axis=1) / np.pi
    return light


def is_sharp(lamp: Lamp) -> bool:
    """Whether it is a point, all of which one ray sees."""
    if isinstance(lamp, AreaLamp):
        return False
    return (lamp.angle if isinstance(lamp, SunLamp) else lamp.radius) == 0.0


def shapes_of(lamp: Lamp, points: Floats) -> Shapes:
    count = len(points)
    if isinstance(lamp, AreaLamp):
        area = (np.pi if lamp.elliptic else 4.0) * np.linalg.norm(np.cross(*lamp.half_axes))
        return Shapes(
            lamp.centre - points,
            np.broadcast_to(lamp.half_axes, (count, 2, 3)),
            np.broadcast_to(lamp.normal, (count, 3)),
            np.full(count, area),
        )
    if isinstance(lamp, SunLamp):
        way = np.broadcast_to(-lamp.direction, (count, 3))
        radius, weight = np.full(count, np.tan(lamp.angle / 2.0)), np.full(count, np.cos(lamp.angle / 2.0) ** -2.0)
    else:
        way = lamp.centre - points
        radius, weight = np.full(count, lamp.radius), np.ones(count)
        if not lamp.soft and lamp.radius > 0.0:
            distance = np.maximum(np.linalg.norm(way, axis=1), CLOSEST * lamp.radius)
            weight = 1.0 - (lamp.radius / distance) ** 2
            way, radius = way * weight[:, None], radius * np.sqrt(weight)
    toward = way / np.maximum(np.linalg.norm(way, axis=1, keepdims=True), TINY)
    across = frames(toward, np.zeros(count))[:, :2].astype(np.float64)
    return Shapes(way, across * radius[:, None, None], -toward, weight)


def _triangles_of(lamp: AreaLamp) -> Floats:
    """The two halves of a rectangle, (2, 3, 3)."""
    u, v = lamp.half_axes
    a, b, c, d = (lamp.centre + x * u + y * v for x, y in ((-1, -1), (1, -1), (1, 1), (-1, 1)))
    return np.array([(a, b, c), (a, c, d)])


def ways_to(lamp: Lamp, points: Floats, count: int, shifts: Floats) -> Floats:
    """From receivers to so many places spread evenly over the shape that they see, (n, count, 3).

    Parameters
    ----------
    shifts : (n, 2) float, 0..1
        Of the lattice.
    """
    shapes = shapes_of(lamp, points)
    index = np.arange(count)
    one = (index + shifts[:, :1]) / count
    other = np.mod(index * GOLDEN + shifts[:, 1:], 1.0)
    if isinstance(lamp, AreaLamp) and not lamp.elliptic:
        x, y = 2.0 * one - 1.0, 2.0 * other - 1.0
    else:
        away, turn = np.sqrt(one), 2.0 * np.pi * other
        x, y = away * np.cos(turn), away * np.sin(turn)
    ways: Floats = shapes.way[:, None] + np.stack([x, y], axis=2) @ shapes.half_axes
    return ways


def kernel_of(lamp: Lamp, facing: Floats, normals: Floats, ways: Floats) -> Floats:
    """What places send for their share of the area and a radiance of 1, (n, count).

    Parameters
    ----------
    facing : (n, 3) float, unit
        Where the shape shines to.
    ways : (n, count, 3) float
    """
    height = np.maximum(np.einsum("nrx,nx->nr", ways, normals), 0.0)
    front = np.maximum(-np.einsum("nrx,nx->nr", ways, facing), 0.0)
    square = np.maximum(np.einsum("nrx,nrx->nr", ways, ways), TINY)
    kernel: Floats = height * front / (square * square)
    if isinstance(lamp, PointLamp) and lamp.cone is not None:
        kernel *= _in_cone(lamp.cone, -ways)
    if isinstance(lamp, PointLamp) and lamp.profile is not None:
        kernel *= _in_profile(lamp.profile, -ways)
    if isinstance(lamp, PointLamp) and lamp.falloff is not None:
        kernel *= _at_distance(lamp.falloff, square)
    if isinstance(lamp, AreaLamp) and lamp.spread < np.pi:
        half = lamp.spread / 2.0
        tangent = np.sqrt(np.maximum(square - front**2, 0.0)) / np.maximum(front, TINY)
        kernel *= np.maximum(np.tan(half) - tangent, 0.0) / (np.tan(half) - half)
    return kernel


def _in_beam(lamp: Lamp, points: Floats) -> NDArray[np.bool_]:
    """Whether points may get light of a spot or of an area lamp that does not shine to all sides, (n,)."""
    if isinstance(lamp, PointLamp) and lamp.cone is not None:
        local = (points - lamp.centre) @ lamp.cone.inverse.T
        distance = np.maximum(np.linalg.norm(local, axis=1), TINY)
        wide = np.arcsin(np.minimum(lamp.radius * np.linalg.norm(lamp.cone.inverse, 2) / distance, 1.0))
        away = np.arccos(np.clip(-local[:, 2] / distance, -1.0, 1.0))
        return np.asarray(away <= np.arccos(lamp.cone.cosine) + wide + ROUNDING)
    if isinstance(lamp, AreaLamp) and lamp.spread < np.pi:
        way = points - lamp.centre
        depth = way @ lamp.normal
        aside = np.linalg.norm(way - depth[:, None] * lamp.normal, axis=1)
        reach = np.linalg.norm(lamp.half_axes, axis=1).sum()
        return np.asarray(aside <= (depth * np.tan(lamp.spread / 2.0) + reach) * (1.0 + ROUNDING))
    return np.ones(len(points), dtype=bool)


def _in_cone(cone: Cone, directions: Floats) -> Floats:
    """Share of a spot's light that leaves in directions (n, r, 3) of any length, (n, r)."""
    local = directions @ cone.inverse.T
    along = -local[..., 2] / np.maximum(np.linalg.norm(local, axis=2), TINY)
    inside = (along - cone.cosine) / max((1.0 - cone.cosine) * cone.blend, 1e-9)
    step = np.clip(inside, 0.0, 1.0)
    share: Floats = step * step * (3.0 - 2.0 * step)
    return share


def _at_distance(falloff: Falloff, square: Floats) -> Floats:
    """What a lamp's light is multiplied by at distances, given squared, of any shape."""
    more: Floats = square ** (falloff.power / 2.0) * square / (falloff.smooth + square)
    return more


def _in_profile(profile: Profile, directions: Floats) -> Floats:
    """Share of a lamp's light that leaves in directions (n, r, 3) of any length, linear between those told, (n, r)."""
    local = directions @ profile.inverse.T
    away = np.arctan2(np.hypot(local[..., 0], local[..., 1]), -local[..., 2])
    turn = np.arctan2(local[..., 1], local[..., 0])
    rows, columns = profile.shares.shape
    row = np.clip(away * (rows / profile.reach) - 0.5, 0.0, rows - 1.0)
    column = np.mod(turn * (columns / (2.0 * np.pi)), columns)
    above, left = row.astype(np.int64), column.astype(np.int64)
    below, right = np.minimum(above + 1, rows - 1), np.mod(left + 1, columns)
    left = np.mod(left, columns)
    down, aside = row - above, column - np.floor(column)
    shares = profile.shares
    first = (1.0 - aside) * shares[above, left] + aside * shares[above, right]
    second = (1.0 - aside) * shares[below, left] + aside * shares[below, right]
    share: Floats = (1.0 - down) * first + down * second
    return share


def _mean_in_profile(lamp: PointLamp, profile: Profile, points: Floats) -> Floats:
    """Share of a lamp's light that leaves to points, in the mean over all of the lamp that they see, (n,)."""
    places = 1 if is_sharp(lamp) else PROFILE_PLACES
    size = PLACES_AT_ONCE // places
    parts = [points[k : k + size] for k in range(0, len(points), size)]
    shares = [_in_profile(profile, -ways_to(lamp, at, places, np.full((len(at), 2), 0.5))).mean(axis=1) for at in parts]
    return np.concatenate([np.zeros(0), *shares])
