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

from .lamps import FEW_LAMPS
from .scene import Ints
from .surfaces import Surfaces, signed_volumes
from .visibility import RayScene
from .walks import Steps, Walks, from_emitters, from_lamp, from_side, from_world, meets_light, through_cracks, walked

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
"""Share of the light from the outside of a lamp in a room that meets something: the room may have a window."""

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
    housing = _housings(surfaces) & _is_indoors(surfaces, rays, walks.taken(np.flatnonzero(is_outward)))
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
    hits = rays.first_hits(rays.local(inward.origin), inward.direction.astype(np.float32))
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
    less room there is on its own side: under a wide sky it is these that find the window of a house.

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
    starts = [
        from_side(surfaces, rays, np.flatnonzero(shell == side >> 1), bool(side & 1), each, seed + 2 * k)
        for k, side in enumerate(asked)
    ]
    back = walked(surfaces, rays, Walks.joined(starts), seed + 1000)
    low, high = np.full((len(doubt), 3), np.inf), np.full((len(doubt), 3), -np.inf)
    corners = surfaces.points[surfaces.triangles]
    np.minimum.at(low, shell, corners.min(axis=1))
    np.maximum.at(high, shell, corners.max(axis=1))
    crack = WIDEST_CRACK * np.linalg.norm(high - low, axis=1)
    met = np.flatnonzero(np.isin(_side(surfaces, light), asked))
    arrived = np.flatnonzero(meets_light(surfaces, rays, back, shines))
    ways = np.zeros(doubt.size)
    for steps, last, side in (
        (light, met, _side(surfaces, light)[met]),
        (back, arrived, asked[back.walk[arrived] // each]),
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
    passable = ~(surfaces.seen & surfaces.shadow)
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
