# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Which sides of which shells light can reach: a few thousand random walks from the emitters and the world.

A closed mesh may be a solid, whose inside no light enters, or a room seen from within; a box without a bottom on a
floor is as good as a solid. Only the light can tell. Rays that meet an unreached side started inside a solid (on a
floor that runs on under a block) and are dropped.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from .lamp_shapes import FEW_LAMPS
from .scene import Floats, Ints
from .surfaces import Surfaces, signed_volumes
from .visibility import Hits, RayScene
from .walks import (
    Steps,
    Walks,
    from_emitters,
    from_lamp,
    from_sides,
    from_world,
    meets_light,
    straight_to_emitters,
    through_cracks,
    walked,
)

WALKS = 16384
"""Random walks started; a side that takes part in the lighting of a room meets hundreds of them."""

MOST_WALKS, FEWEST_OF_THOUSANDS = 2**16, 16
"""Walks that all of many lamps start, about, and what each of thousands starts at least."""

FEWEST_WALKS = 256
"""Walks that each of many lamps starts, or each of many sides in doubt: enough to meet the front of what a lamp lights
more often than `LEAST_VISITS`."""

MOST_BACK = 1024
"""Walks that start from a side in doubt at most."""

MOST_IN_DOUBT = 64
"""Sides in doubt that are asked, the largest first."""

MOST_WAYS = 64
"""Walks between a side in doubt and light that are looked at whether they pass a crack."""

LEAST_VISITS = 3
"""Visits that make a side lit: one or two may be rays that slipped through an edge."""

LEAST_WAYS = 2
"""Ways between a side in doubt and light that make it lit: one may have slipped through where three surfaces meet."""

LEAST_SHARE = 0.01
"""Share of the visits to be expected by its area, and of those to its other side, below which a side is in doubt."""

WIDEST_CRACK = 2e-3
"""Share of the size of a shell up to which an opening is a crack: under a box that does not quite stand on its floor
there is no light to speak of, but if it counted as lit, its outline on the floor would not be looked for."""

LEAST_INDOORS = 0.8
"""Share of the light from the outside of a lamp in a room that meets something, in each step: the room may have a
window."""

STEPS_INDOORS = 3
"""A house that glows downward lights the ground first; from there most of it gets into the open."""

RAYS_TO_LOOK = 64
"""Rays that leave a side of a shell that emits, or of what it may hold, to see where it is."""

MOST_HELD = 8
"""Of the shells within the bounds of one that emits, so many of the largest are asked whether it holds them."""

AGAINST_A_WALL = 0.01
"""Share of a room's extent by which furniture may stick out of it, or only touch it from within."""

MOST_HOLDING = 1000
"""Of the shells that emit, so many of the largest are asked whether they hold another; smaller ones are lamps."""

EXPECTED_VISITS = 20.0
"""Visits to be expected by its area without which an unvisited side of a shell means nothing."""


def lit_sides(surfaces: Surfaces, rays: RayScene, seed: int) -> NDArray[np.bool_]:
    """Whether light reaches the front and the back of each shell, (shells, 2) bool."""
    shell, shells = surfaces.shell_of_triangle, len(surfaces.closed)
    # The inside is the back, unless the normals look inward.
    inside = (signed_volumes(surfaces) >= 0.0).astype(int)
    walks = from_emitters(surfaces, rays, WALKS, seed)
    left = shell[walks.triangle]
    is_outward = walks.back != inside[left]
    housing = _housings(surfaces, rays, inside, walks.taken(np.flatnonzero(is_outward)), seed + 200)
    steps = _light(surfaces, rays, walks.taken(np.flatnonzero(~housing[left] | is_outward)), seed)
    visits = np.bincount(_side(surfaces, steps), minlength=2 * shells + 1)[:-1].reshape(-1, 2)
    area = np.bincount(shell, weights=surfaces.areas, minlength=shells)
    expected = visits.sum() * area / area.sum()
    # What is too small to judge is taken as it most likely is: a solid where closed, lit on both sides where open.
    small = (expected < EXPECTED_VISITS) | _passable(surfaces)
    few = (visits < LEAST_SHARE * expected[:, None]) & (visits < LEAST_SHARE * visits[:, ::-1])
    lit = (visits >= LEAST_VISITS) & ~few
    # Into what is closed, light that starts elsewhere does not get.
    doubt = ~lit & ~(small | housing)[:, None] & ((visits > 0) | ~surfaces.closed[:, None])
    shines = np.repeat(surfaces.emission.any(axis=1)[:, None], 2, axis=1)
    shines[surfaces.front_only, 1] = False
    shines[np.flatnonzero(housing[shell]), inside[shell[housing[shell]]]] = False
    lit |= _is_reached(surfaces, rays, steps, doubt & (area > 0.0)[:, None], shines, seed + 300)
    lit[small, 0] = True
    lit[small & ~surfaces.closed, 1] = True
    emits = np.bincount(shell, weights=surfaces.emission.any(axis=1), minlength=shells) > 0
    lit[emits, 0] = True
    lit[emits & ~surfaces.closed, 1] = True
    lit[np.flatnonzero(housing), inside[housing]] = False
    # What lets light through has light on both sides.
    lit[shell[surfaces.let_pass()]] = True
    # A shell that no light reaches at all shows its front, black.
    lit[~lit.any(axis=1), 0] = True
    return lit


def _light(surfaces: Surfaces, rays: RayScene, from_emitting: Walks, seed: int) -> Steps:
    """Walks from all that shines."""
    kept = np.flatnonzero(~_stays_inside(surfaces, rays, from_emitting))
    parts = [walked(surfaces, rays, from_emitting.taken(kept), seed)]
    if surfaces.world.any():
        parts.append(walked(surfaces, rays, from_world(surfaces, WALKS, seed), seed + 7))
    shining = [lamp for lamp in surfaces.lamps if lamp.strength.any()]
    each = max(WALKS, min(FEWEST_WALKS * len(shining), MOST_WALKS)) // max(len(shining), 1)
    count = max(each, FEWEST_OF_THOUSANDS)
    starts = [from_lamp(lamp, surfaces, rays, count, seed + 100 + number) for number, lamp in enumerate(shining)]
    # Of thousands of lamps all at once, of few each by itself.
    groups = [starts] if len(starts) > FEW_LAMPS else [[start] for start in starts]
    parts += [walked(surfaces, rays, Walks.joined(group), seed + 8) for group in groups]
    return Steps.joined(parts)


def _stays_inside(surfaces: Surfaces, rays: RayScene, walks: Walks) -> NDArray[np.bool_]:
    """Walks that leave the inside of a shell that emits all over and meet it again, (n,): they are of no use."""
    shell = surfaces.shell_of_triangle
    stays = _self_lit(surfaces)[shell[walks.triangle]] & walks.back
    inward = walks.taken(np.flatnonzero(stays))
    hits = _first_met(rays, inward)
    stays[stays] = (hits.triangle >= 0) & (shell[hits.triangle] == shell[inward.triangle])
    return stays


def _side(surfaces: Surfaces, steps: Steps) -> Ints:
    """The side that steps end on: twice the shell, plus 1 for the back; beyond all of them outside of the scene."""
    side = 2 * surfaces.shell_of_triangle[steps.triangle] + steps.back
    return np.where(steps.triangle >= 0, side, 2 * len(surfaces.closed))


def _is_reached(
    surfaces: Surfaces,
    rays: RayScene,
    light: Steps,
    doubt: NDArray[np.bool_],
    shines: NDArray[np.bool_],
    seed: int,
) -> NDArray[np.bool_]:
    """Whether light reaches the sides in doubt, (shells, 2), by ways that are wider than a crack.

    Walks from what shines find an opening the sooner the less room there is for them; walks from the side itself, the
    less room there is on its own side: under a wide sky it is these that find the window of a house. Neither finds a
    lamp of which little stands above the side's horizon, or one that is small and far away: that is looked at directly.

    Parameters
    ----------
    light : Steps
        From what shines.
    doubt : (shells, 2) bool
    shines : (triangles, 2) bool
        Sides that emit.
    """
    shell = surfaces.shell_of_triangle
    area = np.bincount(shell, weights=surfaces.areas, minlength=len(doubt))
    asked = np.flatnonzero(doubt)
    asked = np.sort(asked[np.argsort(-area[asked >> 1], kind="stable")[:MOST_IN_DOUBT]])
    reached = np.zeros(doubt.size, dtype=bool)
    if len(asked) == 0:
        return reached.reshape(-1, 2)
    each = int(np.clip(WALKS // len(asked), FEWEST_WALKS, MOST_BACK))
    starts = from_sides(surfaces, rays, asked >> 1, asked & 1 == 1, each, seed)
    back = walked(surfaces, rays, starts, seed + 1000)
    straight = straight_to_emitters(surfaces, rays, starts, each, seed + 2000)
    straight = straight.taken(np.flatnonzero(shines[straight.triangle, straight.back.astype(np.int64)]))
    low, high = _bounds(surfaces)
    crack = WIDEST_CRACK * np.linalg.norm(high - low, axis=1)
    met = np.flatnonzero(np.isin(_side(surfaces, light), asked))
    arrived = np.flatnonzero(meets_light(surfaces, rays, back, shines))
    ways = np.zeros(doubt.size)
    for steps, last, side in (
        (light, met, _side(surfaces, light)[met]),
        (back, arrived, asked[back.walk[arrived] // each]),
        (straight, np.arange(len(straight.walk)), asked[straight.walk // each]),
    ):
        chosen = _first_of_each(side, steps.walk[last])
        last, side = last[chosen], side[chosen]
        step, way = steps.leading_to(last)
        narrow = through_cracks(rays, steps.taken(step), crack[side[way] >> 1])
        wide = np.bincount(way, weights=narrow, minlength=len(last)) == 0
        ways += np.bincount(side[wide], minlength=doubt.size)
    reached[asked] = ways[asked] >= LEAST_WAYS
    return reached.reshape(-1, 2)


def _first_of_each(side: Ints, walk: Ints) -> Ints:
    """Entries (k,) that are the first of their walk on their side, `MOST_WAYS` of each side at most."""
    order = np.lexsort([walk, side])
    side, walk = side[order], walk[order]
    new = np.ones(len(order), dtype=bool)
    new[1:] = (np.diff(side) != 0) | (np.diff(walk) != 0)
    order, side = order[new], side[new]
    rank = np.arange(len(side)) - np.searchsorted(side, side)
    return order[rank < MOST_WAYS]


def _passable(surfaces: Surfaces) -> NDArray[np.bool_]:
    """Shells that some light goes through, (shells,): walks take no notice of them."""
    passable = ~(surfaces.seen & surfaces.shadow) | surfaces.let_pass()
    result: NDArray[np.bool_] = (
        np.bincount(surfaces.shell_of_triangle, weights=passable, minlength=len(surfaces.closed)) > 0
    )
    return result


def _self_lit(surfaces: Surfaces) -> NDArray[np.bool_]:
    """Closed shells that emit all over, such as a bulb: light inside that only meets the shell itself is of no use."""
    emits = surfaces.emission.any(axis=1)
    dark = np.bincount(surfaces.shell_of_triangle, weights=~emits, minlength=len(surfaces.closed))
    result: NDArray[np.bool_] = surfaces.closed & (dark == 0)
    return result


def _housings(surfaces: Surfaces, rays: RayScene, inside: Ints, outward: Walks, seed: int) -> NDArray[np.bool_]:
    """Closed shells that emit somewhere and hold nothing, (shells,): what glows inside, nobody sees.

    Both sides of an emitter glow, so the inside of a lamp's housing would be the brightest place of a room; where the
    housing lies flush in a ceiling it would light the ceiling's other side. A room that emits holds other shells, or is
    the largest shell there is, or stands in the open, or its normals look inward and nothing reaches into it.

    Parameters
    ----------
    inside : (shells,) int
        The side of each shell that looks inward.
    outward : Walks
        From emitters, to the outside of their shells.
    """
    shell, count = surfaces.shell_of_triangle, len(surfaces.closed)
    low, high = _bounds(surfaces)
    extent = (high - low).max(axis=1)
    emits = np.bincount(shell, weights=surfaces.emission.any(axis=1), minlength=count) > 0
    housing: NDArray[np.bool_] = surfaces.closed & emits & (extent < extent.max())
    largest = np.flatnonzero(housing)
    largest = largest[np.argsort(-extent[largest], kind="stable")[:MOST_HOLDING]]
    if len(largest) == 0:
        return housing
    housing &= _is_indoors(surfaces, rays, outward.taken(np.flatnonzero(housing[shell[outward.triangle]])), seed)
    turned = largest[inside[largest] == 0]
    hits = _first_met(rays, from_sides(surfaces, rays, turned, np.zeros(len(turned), bool), RAYS_TO_LOOK, seed + 2))
    own = (hits.triangle >= 0) & (shell[hits.triangle] == turned.repeat(RAYS_TO_LOOK))
    housing[turned[own.reshape(-1, RAYS_TO_LOOK).all(axis=1)]] = False
    # Of the shells that begin between the two ends of a housing along x, those that end there too in all directions.
    order = np.argsort(low[:, 0], kind="stable")
    slack = AGAINST_A_WALL * extent[:, None]
    first = np.searchsorted(low[order, 0], (low - slack)[:, 0], side="left")
    last = np.searchsorted(low[order, 0], high[:, 0], side="right")
    size = (high - low + slack).prod(axis=1)
    holders, held = [np.zeros(0, dtype=np.int64)], [np.zeros(0, dtype=np.int64)]
    for candidate in largest:
        near = order[first[candidate] : last[candidate]]
        within = (low[near] >= (low - slack)[candidate]).all(axis=1) & (high[near] <= (high + slack)[candidate]).all(
            axis=1
        )
        # A second lamp in the same place is none that it holds.
        within &= size[near] < 0.5 * size[candidate]
        found = near[within]
        found = found[np.argsort(-size[found], kind="stable")[:MOST_HELD]]
        holders.append(np.full(len(found), candidate))
        held.append(found)
    holder, one = np.concatenate(holders), np.concatenate(held)
    # What stands in the middle of a ring lies within its bounds, but sees it from outside.
    for side in (0, 1) if len(one) else ():
        walks = from_sides(surfaces, rays, one, np.full(len(one), side == 1), RAYS_TO_LOOK, seed + 4 + side)
        hits = _first_met(rays, walks)
        looks_at = (shell[hits.triangle] == holder.repeat(RAYS_TO_LOOK)) & (hits.triangle >= 0)
        looks_at &= hits.back == inside[holder].repeat(RAYS_TO_LOOK)
        housing[holder[looks_at.reshape(-1, RAYS_TO_LOOK).any(axis=1)]] = False
    return housing


def _is_indoors(surfaces: Surfaces, rays: RayScene, walks: Walks, seed: int) -> NDArray[np.bool_]:
    """Shells whose light outward meets something step after step, nearly always, (shells,)."""
    left = surfaces.shell_of_triangle[walks.triangle]
    steps = walked(surfaces, rays, walks, seed, STEPS_INDOORS)
    count = len(surfaces.closed)
    lost = np.bincount(left[steps.walk[steps.triangle < 0]], minlength=count)
    result: NDArray[np.bool_] = lost <= (1.0 - LEAST_INDOORS**STEPS_INDOORS) * np.bincount(left, minlength=count)
    return result


def _bounds(surfaces: Surfaces) -> tuple[Floats, Floats]:
    """Lowest and highest coordinates of each shell, (shells, 3)."""
    count = len(surfaces.closed)
    low, high = np.full((count, 3), np.inf), np.full((count, 3), -np.inf)
    corners = surfaces.points[surfaces.triangles]
    np.minimum.at(low, surfaces.shell_of_triangle, corners.min(axis=1))
    np.maximum.at(high, surfaces.shell_of_triangle, corners.max(axis=1))
    return low, high


def _first_met(rays: RayScene, walks: Walks) -> Hits:
    return rays.first_hits(rays.local(walks.origin), walks.direction.astype(np.float32))
