# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Which sides of which shells light can reach: a few thousand random walks from the emitters and the world.

A closed mesh may be a solid, whose inside no light enters, or a room seen from within; a box without a bottom on a
floor is as good as a solid. Only the light can tell. Rays that meet an unreached side started inside a solid (on a
floor that runs on under a block) and are dropped.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .direct import LUMINANCE
from .geometry import normalized
from .sampling import cosine_directions, frames, hashed, triangle_weights
from .scene import AreaLamp, Floats, Ints, Lamp, SunLamp
from .surfaces import Surfaces, signed_volumes
from .visibility import OFFSET, RayScene

WALKS = 16384
"""Random walks started; a side that takes part in the lighting of a room meets hundreds of them."""

FEWEST_WALKS = 256
"""Walks that each of many lamps starts: enough to meet the front of what it lights more often than `LEAST_VISITS`."""

LONGEST_WALK = 16

LEAST_VISITS = 3
"""Visits that make a side lit: one or two may be rays that slipped through an edge."""

LEAST_SHARE = 0.01
"""Share of the visits to be expected by its area, and of those to its front, that the back of a lit shell must get."""

LEAST_INDOORS = 0.8
"""Share of the light from the outside of a lamp in a room that meets something: the room may have a window."""

AGAINST_A_WALL = 0.01
"""Share of a room's extent by which furniture may stick out of it, or only touch it from within."""

MOST_HOLDING = 1000
"""Of the shells that emit, so many of the largest are asked whether they hold another; smaller ones are lamps."""

EXPECTED_VISITS = 20.0
"""Visits to be expected by its area without which an unvisited side of a shell means nothing."""


def lit_sides(surfaces: Surfaces, rays: RayScene, seed: int) -> NDArray[np.bool_]:
    """Whether light reaches the front and the back of each shell, (shells, 2) bool."""
    shells = len(surfaces.closed)
    # The inside is the back, unless the normals look inward.
    inside = (signed_volumes(surfaces) >= 0.0).astype(int)
    walks = _from_emitters(surfaces, rays, seed)
    left = surfaces.shell_of_triangle[walks.triangle]
    is_outward = walks.back != inside[left]
    housing = _housings(surfaces) & _is_indoors(surfaces, rays, walks.taken(np.flatnonzero(is_outward)))
    visits = _visits(surfaces, rays, walks.taken(np.flatnonzero(~housing[left] | is_outward)), seed)
    if surfaces.world.any():
        visits += _visits(surfaces, rays, _from_world(surfaces, rays, seed), seed + 7)
    shining = [source for source in surfaces.lamps if source.strength.any()]
    for number, source in enumerate(shining):
        count = max(WALKS // len(shining), FEWEST_WALKS)
        visits += _visits(surfaces, rays, _from_lamp(source, surfaces, rays, count, seed + 100 + number), seed + 8)
    area = np.bincount(surfaces.shell_of_triangle, weights=surfaces.areas, minlength=shells)
    expected = visits.sum() * area / area.sum()
    lit = visits >= LEAST_VISITS
    # A lit shell's back that a hundredth part of the light of its area finds is reached through a crack under it.
    lit[:, 1] &= ~((visits[:, 1] < LEAST_SHARE * expected) & (visits[:, 1] < LEAST_SHARE * visits[:, 0]))
    # What is too small to judge is taken as it most likely is: a solid where closed, lit on both sides where open.
    small = expected < EXPECTED_VISITS
    lit[small, 0] = True
    lit[small & ~surfaces.closed, 1] = True
    emits = np.bincount(surfaces.shell_of_triangle, weights=surfaces.emission.any(axis=1), minlength=shells) > 0
    lit[emits, 0] = True
    lit[emits & ~surfaces.closed, 1] = True
    lit[np.flatnonzero(housing), inside[housing]] = False
    # A shell that no light reaches at all shows its front, black.
    lit[~lit.any(axis=1), 0] = True
    return lit


@dataclass(frozen=True, eq=False)
class Walks:
    """Where walks are under way: on a side of a triangle (-1: outside of the scene).

    Attributes
    ----------
    triangle : (n,) int
    back : (n,) bool
    origin, direction : (n, 3) float
    """

    triangle: Ints
    back: NDArray[np.bool_]
    origin: Floats
    direction: Floats

    def taken(self, which: Ints) -> Walks:
        """Some of the walks."""
        return Walks(self.triangle[which], self.back[which], self.origin[which], self.direction[which])


def _visits(surfaces: Surfaces, rays: RayScene, walks: Walks, seed: int) -> Floats:
    """Times that walks met the front and the back of each shell, (shells, 2)."""
    visits = np.zeros((len(surfaces.closed), 2))
    shell = surfaces.shell_of_triangle
    inward = (walks.triangle >= 0) & _self_lit(surfaces)[shell[walks.triangle]] & walks.back
    left = walks.triangle
    for bounce in range(LONGEST_WALK):
        if len(walks.triangle) == 0:
            break
        hits = rays.first_hits(rays.local(walks.origin), walks.direction.astype(np.float32))
        met = hits.triangle >= 0
        if bounce == 0:
            met &= ~(inward & (shell[hits.triangle] == shell[left]))
        triangle, back = hits.triangle[met].astype(np.int64), hits.back[met]
        np.add.at(visits, (shell[triangle], back.astype(np.int64)), 1.0)
        reflecting = surfaces.reflectance[triangle].any(axis=1)
        weights = hits.weights()[met].astype(np.float64)[reflecting]
        walks = _leaving(surfaces, rays, triangle[reflecting], back[reflecting], weights, seed + bounce + 10)
    return visits


def _leaving(
    surfaces: Surfaces, rays: RayScene, triangle: Ints, back: NDArray[np.bool_], weights: Floats, seed: int
) -> Walks:
    """Walks that leave sides of triangles at barycentric weights (n, 2), with cosine distribution."""
    normal = side_normals(surfaces.normals[triangle], back)
    a, b, c = (surfaces.points[surfaces.triangles[triangle, k]] for k in range(3))
    origin = a + (b - a) * weights[:, :1] + (c - a) * weights[:, 1:] + normal * (OFFSET / rays.scale)
    return Walks(triangle, back, origin, cosine_directions(hashed(np.arange(len(triangle)), 2, seed), normal))


def _from_emitters(surfaces: Surfaces, rays: RayScene, seed: int) -> Walks:
    """Walks from emitting triangles in proportion to their power, from both sides."""
    power = np.cumsum(surfaces.areas * (surfaces.emission @ LUMINANCE))
    if power[-1] <= 0.0:
        nothing = np.zeros((0, 3))
        return Walks(np.zeros(0, dtype=np.int64), np.zeros(0, dtype=bool), nothing, nothing)
    step = (np.arange(WALKS) + 0.5) / WALKS * power[-1]
    triangle = np.minimum(np.searchsorted(power, step, side="right"), len(power) - 1)
    drawn = hashed(np.arange(WALKS), 3, seed + 1)
    weights = triangle_weights(drawn[:, 1:3])
    return _leaving(surfaces, rays, triangle, drawn[:, 0] < 0.5, weights, seed + 2)


def _from_world(surfaces: Surfaces, rays: RayScene, seed: int) -> Walks:
    """Walks inward from a sphere around the scene: with cosine distribution they cross it evenly from everywhere."""
    drawn = hashed(np.arange(WALKS), 4, seed + 3)
    outward = _even_directions(drawn)
    middle, radius = _sphere_around(surfaces)
    outside = np.full(WALKS, -1, dtype=np.int64)
    origin = middle + radius * outward
    return Walks(outside, np.zeros(WALKS, dtype=bool), origin, cosine_directions(drawn[:, 2:], -outward))


def _sphere_around(surfaces: Surfaces) -> tuple[Floats, float]:
    """Middle and radius of a sphere that holds all triangles."""
    used = surfaces.points[surfaces.triangles.ravel()]
    low, high = used.min(axis=0), used.max(axis=0)
    return (low + high) / 2.0, 0.5 * float(np.linalg.norm(high - low)) * 1.01


def _from_lamp(lamp: Lamp, surfaces: Surfaces, rays: RayScene, count: int, seed: int) -> Walks:
    """So many walks from a lamp, in the directions that it shines in."""
    drawn = hashed(np.arange(count), 4, seed)
    if isinstance(lamp, SunLamp):
        middle, radius = _sphere_around(surfaces)
        direction = np.broadcast_to(lamp.direction, (count, 3))
        across = frames(direction, np.zeros(count))[:, :2].astype(np.float64)
        place = np.einsum("nk,nkx->nx", 2.0 * drawn[:, :2] - 1.0, across)
        origin = middle + radius * (place - direction)
    elif isinstance(lamp, AreaLamp):
        normal = np.broadcast_to(lamp.normal, (count, 3))
        # A rectangle's corners lie outside of its ellipse, which is no harm here.
        origin = lamp.centre + (2.0 * drawn[:, :2] - 1.0) @ lamp.half_axes + normal * (OFFSET / rays.scale)
        direction = cosine_directions(drawn[:, 2:], normal)
    else:
        direction = _even_directions(drawn)
        if lamp.cone is not None:
            # Even over the cone in the lamp's own space: between its edge and its axis.
            local = _even_directions(np.stack([drawn[:, 0] * (1.0 - lamp.cone.cosine) / 2.0, drawn[:, 1]], axis=1))
            direction = normalized(local * [1.0, 1.0, -1.0] @ np.linalg.inv(lamp.cone.inverse).T)
        origin = np.broadcast_to(lamp.centre, (count, 3))
    return Walks(np.full(count, -1, dtype=np.int64), np.zeros(count, dtype=bool), origin, direction)


def _even_directions(drawn: Floats) -> Floats:
    """Directions spread evenly over the sphere by the first two of the numbers drawn, from +z on, (n, 3)."""
    z, turn = 1.0 - 2.0 * drawn[:, 0], 2.0 * np.pi * drawn[:, 1]
    flat = np.sqrt(np.maximum(0.0, 1.0 - z * z))
    return np.stack([flat * np.cos(turn), flat * np.sin(turn), z], axis=1)


def _self_lit(surfaces: Surfaces) -> NDArray[np.bool_]:
    """Closed shells that emit all over, such as a bulb: light inside that only meets the shell itself is of no use."""
    emits = surfaces.emission.any(axis=1)
    dark = np.bincount(surfaces.shell_of_triangle, weights=~emits, minlength=len(surfaces.closed))
    result: NDArray[np.bool_] = surfaces.closed & (dark == 0)
    return result


def _housings(surfaces: Surfaces) -> NDArray[np.bool_]:
    """Closed shells that emit somewhere and hold nothing, (shells,): what glows inside, nobody sees.

    Both sides of an emitter glow, so the inside of a lamp's housing would be the brightest place of a room; where the
    housing lies flush in a ceiling it would light the ceiling's other side. A room that emits holds other shells, or is
    the largest shell there is, or stands in the open.
    """
    shell, count = surfaces.shell_of_triangle, len(surfaces.closed)
    low, high = np.full((count, 3), np.inf), np.full((count, 3), -np.inf)
    corners = surfaces.points[surfaces.triangles]
    np.minimum.at(low, shell, corners.min(axis=1))
    np.maximum.at(high, shell, corners.max(axis=1))
    extent = (high - low).max(axis=1)
    emits = np.bincount(shell, weights=surfaces.emission.any(axis=1), minlength=count) > 0
    housing: NDArray[np.bool_] = surfaces.closed & emits & (extent < extent.max())
    # Of the shells that begin between the two ends of a housing along x, those that end there too in all directions.
    order = np.argsort(low[:, 0], kind="stable")
    largest = np.flatnonzero(housing)
    largest = largest[np.argsort(-extent[largest], kind="stable")[:MOST_HOLDING]]
    slack = AGAINST_A_WALL * extent[:, None]
    first = np.searchsorted(low[order, 0], (low - slack)[:, 0], side="left")
    last = np.searchsorted(low[order, 0], high[:, 0], side="right")
    size = (high - low + slack).prod(axis=1)
    for candidate in largest:
        near = order[first[candidate] : last[candidate]]
        inside = (low[near] >= (low - slack)[candidate]).all(axis=1) & (high[near] <= (high + slack)[candidate]).all(
            axis=1
        )
        # A second lamp in the same place is none that it holds.
        housing[candidate] = not np.any(inside & (size[near] < 0.5 * size[candidate]))
    return housing


def _is_indoors(surfaces: Surfaces, rays: RayScene, walks: Walks) -> NDArray[np.bool_]:
    """Shells whose light outward meets something nearly always, (shells,), by the first step of walks that go there."""
    hits = rays.first_hits(rays.local(walks.origin), walks.direction.astype(np.float32))
    shell, count = surfaces.shell_of_triangle[walks.triangle], len(surfaces.closed)
    met = np.bincount(shell, weights=hits.triangle >= 0, minlength=count)
    result: NDArray[np.bool_] = met >= LEAST_INDOORS * np.bincount(shell, minlength=count)
    return result


def side_normals(normals: Floats, sides: Ints | NDArray[np.bool_]) -> Floats:
    """Normals turned over where the side is the back (1)."""
    return normals * np.where(sides == 1, -1.0, 1.0)[:, None]
