# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Random walks of light: from emitters, lamps and the world, or from a surface back to them."""

from __future__ import annotations

from dataclasses import dataclass, fields, replace

import numpy as np
from numpy.typing import NDArray

from .direct import LUMINANCE
from .geometry import normalized, side_normals
from .lamp_shapes import unoccluded
from .lamps import BEYOND
from .sampling import cosine_directions, frames, hashed, triangle_weights
from .scene import AreaLamp, Floats, Ints, Lamp, SunLamp
from .surfaces import Surfaces
from .visibility import OFFSET, RayScene

LONGEST_WALK = 16

AXES = 4
"""Directions across a ray, evenly turned, in which it is shifted to and fro."""

WINDOWS = ((0.0, 2.0 / 3.0), (1.0 / 3.0, 1.0))
"""Parts of a ray that are shifted, each by itself: of a slanting ray between floor and ceiling, one end can be shifted
to one side alone and the other to the other."""


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
        return Walks(*(getattr(self, field.name)[which] for field in fields(Walks)))

    @staticmethod
    def joined(parts: list[Walks]) -> Walks:
        """All walks of one or more lists."""
        return Walks(*(np.concatenate([getattr(part, field.name) for part in parts]) for field in fields(Walks)))


@dataclass(frozen=True, eq=False)
class Steps:
    """Straight pieces of walks, those of a walk in the order they were walked.

    Attributes
    ----------
    walk : (n,) int
    triangle : (n,) int
        Met at the end, -1 where the walk left the scene.
    back : (n,) bool
    start, end : (n, 3) float
        Both a little off the surface they lie on.
    """

    walk: Ints
    triangle: Ints
    back: NDArray[np.bool_]
    start: Floats
    end: Floats

    def taken(self, which: Ints) -> Steps:
        """Some of the steps."""
        return Steps(*(getattr(self, field.name)[which] for field in fields(Steps)))

    @staticmethod
    def joined(parts: list[Steps]) -> Steps:
        """The steps of several walks, whose numbers are counted on; one list or more."""
        first = np.cumsum([0] + [int(part.walk.max(initial=-1)) + 1 for part in parts])
        parts = [replace(part, walk=part.walk + start) for part, start in zip(parts, first, strict=False)]
        return Steps(*(np.concatenate([getattr(part, field.name) for part in parts]) for field in fields(Steps)))

    def leading_to(self, last: Ints) -> tuple[Ints, Ints]:
        """All steps of a walk that lead to one of its steps, and that one, for each of `last` (k,).

        Returns
        -------
        step : (p,) int
        way : (p,) int
            To which of `last` it leads.
        """
        order = np.argsort(self.walk, kind="stable")
        place = np.empty_like(order)
        place[order] = np.arange(len(order))
        first = np.searchsorted(self.walk[order], self.walk[last])
        count = place[last] - first + 1
        way = np.repeat(np.arange(len(last)), count)
        return order[first[way] + np.arange(len(way)) - np.repeat(np.cumsum(count) - count, count)], way


def walked(surfaces: Surfaces, rays: RayScene, walks: Walks, seed: int, longest: int = LONGEST_WALK) -> Steps:
    """Follow walks until they leave the scene, meet what reflects nothing, or are so many steps long."""
    number = np.arange(len(walks.triangle))
    parts = []
    far = 2.0 * sphere_around(surfaces)[1]
    for bounce in range(longest):
        if len(number) == 0:
            break
        hits = rays.first_hits(rays.local(walks.origin), walks.direction.astype(np.float32))
        met = hits.triangle >= 0
        triangle, back = hits.triangle.astype(np.int64), hits.back & met
        weights = hits.weights().astype(np.float64)
        end = np.where(
            met[:, None], _on_sides(surfaces, rays, triangle, back, weights), walks.origin + far * walks.direction
        )
        parts.append(Steps(number, triangle, back, walks.origin, end))
        on = np.flatnonzero(met & surfaces.reflectance[triangle].any(axis=1))
        number = number[on]
        walks = leaving(surfaces, rays, triangle[on], back[on], weights[on], seed + bounce + 10)
    nothing, none = np.zeros((0, 3)), np.zeros(0, dtype=np.int64)
    parts.append(Steps(none, none, none.astype(bool), nothing, nothing))
    return Steps(*(np.concatenate([getattr(part, field.name) for part in parts]) for field in fields(Steps)))


def _on_sides(surfaces: Surfaces, rays: RayScene, triangle: Ints, back: NDArray[np.bool_], weights: Floats) -> Floats:
    """Places on sides of triangles at barycentric weights (n, 2), a little off them, (n, 3)."""
    normal = side_normals(surfaces.normals[triangle], back)
    a, b, c = (surfaces.points[surfaces.triangles[triangle, k]] for k in range(3))
    place: Floats = a + (b - a) * weights[:, :1] + (c - a) * weights[:, 1:] + normal * (OFFSET / rays.scale)
    return place


def leaving(
    surfaces: Surfaces, rays: RayScene, triangle: Ints, back: NDArray[np.bool_], weights: Floats, seed: int
) -> Walks:
    """Walks that leave sides of triangles at barycentric weights (n, 2), with cosine distribution."""
    normal = side_normals(surfaces.normals[triangle], back)
    origin = _on_sides(surfaces, rays, triangle, back, weights)
    return Walks(triangle, back, origin, cosine_directions(hashed(np.arange(len(triangle)), 2, seed), normal))


def from_emitters(surfaces: Surfaces, rays: RayScene, count: int, seed: int) -> Walks:
    """So many walks from emitting triangles in proportion to their power, from both sides."""
    power = np.cumsum(surfaces.areas * (surfaces.emission @ LUMINANCE))
    if power[-1] <= 0.0:
        nothing = np.zeros((0, 3))
        return Walks(np.zeros(0, dtype=np.int64), np.zeros(0, dtype=bool), nothing, nothing)
    step = (np.arange(count) + 0.5) / count * power[-1]
    triangle = np.minimum(np.searchsorted(power, step, side="right"), len(power) - 1)
    drawn = hashed(np.arange(count), 3, seed + 1)
    weights = triangle_weights(drawn[:, 1:3])
    back = (drawn[:, 0] < 0.5) & ~surfaces.front_only[triangle]
    return leaving(surfaces, rays, triangle, back, weights, seed + 2)


def from_sides(
    surfaces: Surfaces, rays: RayScene, shells: Ints, back: NDArray[np.bool_], count: int, seed: int
) -> Walks:
    """So many walks from each of some sides of shells (k,), spread evenly over it, those of a side together."""
    order = np.argsort(surfaces.shell_of_triangle, kind="stable")
    area = surfaces.areas[order]
    up_to = np.cumsum(area)
    first, last = (np.searchsorted(surfaces.shell_of_triangle[order], shells, side=end) for end in ("left", "right"))
    before = up_to[first] - area[first]
    drawn = hashed(np.arange(len(shells) * count), 3, seed)
    step = (np.arange(count) + drawn[:, 0].reshape(-1, count)) / count
    place = np.searchsorted(up_to, before[:, None] + step * (up_to[last - 1] - before)[:, None], side="right")
    triangle = order[np.clip(place, first[:, None], last[:, None] - 1)].ravel()
    return leaving(surfaces, rays, triangle, np.repeat(back, count), triangle_weights(drawn[:, 1:3]), seed + 1)


def from_world(surfaces: Surfaces, count: int, seed: int) -> Walks:
    """Walks inward from a sphere around the scene: with cosine distribution they cross it evenly from everywhere."""
    drawn = hashed(np.arange(count), 4, seed + 3)
    outward = _even_directions(drawn)
    middle, radius = sphere_around(surfaces)
    outside = np.full(count, -1, dtype=np.int64)
    origin = middle + radius * outward
    return Walks(outside, np.zeros(count, dtype=bool), origin, cosine_directions(drawn[:, 2:], -outward))


def sphere_around(surfaces: Surfaces) -> tuple[Floats, float]:
    """Middle and radius of a sphere that holds all triangles."""
    used = surfaces.points[surfaces.triangles.ravel()]
    low, high = used.min(axis=0), used.max(axis=0)
    return (low + high) / 2.0, 0.5 * float(np.linalg.norm(high - low)) * 1.01


def from_lamp(lamp: Lamp, surfaces: Surfaces, rays: RayScene, count: int, seed: int) -> Walks:
    """So many walks from a lamp, in the directions that it shines in."""
    drawn = hashed(np.arange(count), 4, seed)
    if isinstance(lamp, SunLamp):
        middle, radius = sphere_around(surfaces)
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


def straight_to_emitters(surfaces: Surfaces, rays: RayScene, starts: Walks, count: int, seed: int) -> Steps:
    """Straight pieces from the origins of walks to places on what emits, where nothing is between.

    Parameters
    ----------
    starts : Walks
        From sides, `count` together of each.
    """
    ends = from_emitters(surfaces, rays, count, seed)
    # Walks from a side begin in the order of its triangles, as these do.
    order = np.argsort(hashed(np.arange(len(ends.triangle)), 1, seed + 5)[:, 0], kind="stable")
    ends = ends.taken(np.tile(order, len(starts.triangle) // count))
    starts = starts.taken(np.arange(len(ends.triangle)))
    way = ends.origin - starts.origin
    above = np.einsum("nx,nx->n", way, side_normals(surfaces.normals[starts.triangle], starts.back)) > 0.0
    above &= np.einsum("nx,nx->n", way, side_normals(surfaces.normals[ends.triangle], ends.back)) < 0.0
    walk = np.flatnonzero(above)
    walk = walk[_is_clear(rays, starts.origin[walk], ends.origin[walk])]
    return Steps(walk, ends.triangle[walk], ends.back[walk], starts.origin[walk], ends.origin[walk])


def _even_directions(drawn: Floats) -> Floats:
    """Directions spread evenly over the sphere by the first two of the numbers drawn, from +z on, (n, 3)."""
    z, turn = 1.0 - 2.0 * drawn[:, 0], 2.0 * np.pi * drawn[:, 1]
    flat = np.sqrt(np.maximum(0.0, 1.0 - z * z))
    return np.stack([flat * np.cos(turn), flat * np.sin(turn), z], axis=1)


def meets_light(surfaces: Surfaces, rays: RayScene, steps: Steps, shines: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Whether steps end in light: on an emitter, in a world that shines, or where a lamp shines, (n,).

    Parameters
    ----------
    shines : (triangles, 2) bool
        Sides that emit.
    """
    met = steps.triangle >= 0
    light = np.where(met, shines[steps.triangle, steps.back.astype(np.int64)], surfaces.world.any())
    on = np.flatnonzero(met & ~light)
    normal = side_normals(surfaces.normals[steps.triangle[on]], steps.back[on])
    for lamp in surfaces.lamps:
        if not lamp.strength.any():
            continue
        facing = np.flatnonzero(unoccluded(lamp, steps.end[on], normal))
        at = steps.end[on[facing]]
        if isinstance(lamp, SunLamp):
            middle = at - lamp.direction * (BEYOND / rays.scale)
        else:
            middle = np.broadcast_to(lamp.centre, at.shape)
        light[on[facing]] |= _is_clear(rays.hidden_by(lamp.linking.blockers), at, middle) | (not lamp.shadow)
    return light


def through_cracks(rays: RayScene, steps: Steps, width: Floats) -> NDArray[np.bool_]:
    """Whether steps pass an opening of about a `width` (n,), in scene units, or less: on both sides it is shut, (n,).

    Light also slips through where meshes touch, by the rounding of a hit.
    """
    way = steps.end - steps.start
    across = frames(normalized(way), np.zeros(len(way)))[:, :2].astype(np.float64)
    narrow = np.zeros(len(way), dtype=bool)
    for low, high in WINDOWS:
        start, end = steps.start + low * way, steps.start + high * way
        for angle in np.pi * np.arange(AXES) / AXES:
            shift = (np.cos(angle) * across[:, 0] + np.sin(angle) * across[:, 1]) * width[:, None]
            open_somewhere = np.zeros(len(way), dtype=bool)
            for aside in (shift, -shift):
                legs = ((start, start + aside), (start + aside, end + aside), (end + aside, end))
                open_somewhere |= np.all([_is_clear(rays, *leg) for leg in legs], axis=0)
            narrow |= ~open_somewhere
    return narrow


def _is_clear(rays: RayScene, start: Floats, end: Floats) -> NDArray[np.bool_]:
    """Whether nothing lies between places off all surfaces, (n, 3) each."""
    origins = rays.local(start)
    toward = rays.local(end) - origins
    clear: NDArray[np.bool_] = rays.visible(origins, toward[:, None])[:, 0] > 0
    return clear
