# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Direct light of lamps: what each would send a receiver unoccluded, times the visible share of its shape.

Shadow rays go to a few places of the shape that the receiver sees.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from .direct_light import DirectLight
from .geometry import order_along_curve
from .lamp_shapes import (
    FEW_LAMPS,
    PLACES_AT_ONCE,
    even_points,
    is_sharp,
    kernel_of,
    shapes_of,
    unoccluded_of_all,
    ways_to,
    ways_to_points,
)
from .lit_points import LitPoints
from .sampling import GOLDEN, LATTICE_ERROR, Singles, hashed, ray_counts
from .scene import Floats, Ints, Lamp, SunLamp
from .terminator import arriving
from .visibility import OFFSET, RayScene, spread_of_rays

STRONG = 2.0
"""Rays due to one of many lamps from which on it gets them as one of few does."""

PAIRS_AT_ONCE = 2**17
"""Many lamps times receivers whose working arrays stay in a core's second cache."""

BEYOND = 2.0
"""Length of a ray to a sun in extents of the scene, whose diagonal is 1.73 of them."""

DARK = 1e-200
"""Luminance that stands for none where it is divided by."""


def lamp_light(
    lamps: tuple[Lamp, ...],
    luminance: Floats,
    first_number: int,
    rays: RayScene,
    at: LitPoints,
    shadow_rays: int,
    seed: int,
) -> tuple[DirectLight, Floats]:
    """Direct light of lamps at n points.

    Parameters
    ----------
    luminance : (l,) float
        Of the lamps' strengths.
    first_number : int
        The number of the first lamp as an emitter.
    shadow_rays : int
        Rays each point spreads over all lamps. Of `FEW_LAMPS`, each that it would see gets one at least; of more,
        each from which `STRONG` rays are due, and the others share the rest.

    Returns
    -------
    light : DirectLight
    uncertainty : (n,) float, W m^-2 sr^-1
        Standard error of its luminance, were the rays independent.
    """
    count = len(at)
    size = max(1, PAIRS_AT_ONCE // len(lamps))
    if len(lamps) > FEW_LAMPS and count > size:
        parts = [
            lamp_light(lamps, luminance, first_number, rays, at.taken(slice(k, k + size)), shadow_rays, seed)
            for k in range(0, count, size)
        ]
        return DirectLight.stacked([part[0] for part in parts]), np.concatenate([part[1] for part in parts])
    shifts = hashed(at.keys, 2, seed)
    whole = unoccluded_of_all(lamps, at.points, at.normals)
    for of_lamp, lamp in zip(whole, lamps, strict=True):
        if lamp.linking.receivers is not None:
            of_lamp[~np.isin(at.mesh, list(lamp.linking.receivers))] = 0.0
    bright = whole * luminance[:, None]
    total = np.maximum(bright.sum(axis=0), DARK)
    entries, variance = [DirectLight.none(count)], np.zeros(count)
    if len(lamps) > FEW_LAMPS:
        weak = shadow_rays * bright < STRONG * total
        drawn = _drawn(lamps, np.where(weak, bright, 0.0), shadow_rays / total, shifts[:, 0])
        light, variance = _light_of_drawn(lamps, luminance, first_number, rays, at, shifts, drawn)
        entries.append(light)
        whole[weak] = 0.0
    wanted = ray_counts(shadow_rays * bright / total)
    for number in np.flatnonzero(whole.any(axis=1)):
        lamp = lamps[number]
        some = np.flatnonzero(whole[number])
        rays_of = np.ones_like(some) if is_sharp(lamp) else wanted[number, some]
        visible, spread = np.ones(len(some)), np.zeros(len(some))
        for rays_each in np.unique(rays_of) if lamp.shadow else ():
            same = np.flatnonzero(rays_of == rays_each)
            size = PLACES_AT_ONCE // int(rays_each)
            for part in (same[k : k + size] for k in range(0, len(same), size)):
                there = at.taken(some[part])
                ways = ways_to(lamp, there.points, int(rays_each), shifts[some[part]])
                hidden_by = rays.hidden_by(lamp.linking.blockers)
                visible[part], spread[part] = _visible_share(lamp, hidden_by, there, ways)
        doubt = spread * rays_of**-1.5
        variance[some] += LATTICE_ERROR**2 * doubt * bright[number, some] ** 2
        emitter = np.full(len(some), first_number + number)
        entries.append(DirectLight.of(count, some, emitter, whole[number, some] * visible))
    return DirectLight.joined(entries), np.sqrt(variance)


@dataclass(frozen=True, eq=False)
class _Draw:
    """Rays to the weak among many lamps.

    Attributes
    ----------
    lamp, receiver : (r,) int
        By receivers.
    light : (r,) float, W m^-2 sr^-1
        Luminance that each ray stands for: together, all that the receiver would get of its weak lamps.
    """

    lamp: Ints
    receiver: Ints
    light: Floats


def _drawn(lamps: tuple[Lamp, ...], bright: Floats, rays_for_light: Floats, shifts: Floats) -> _Draw:
    """Spread rays at equal steps over the light of many lamps, in an order in which those near each other follow.

    Parameters
    ----------
    bright : (l, n) float
        Luminance that each receiver would get of each lamp.
    rays_for_light : (n,) float
        Rays due for a luminance of 1.
    shifts : (n,) float, 0..1
        Of the first ray.
    """
    order = order_along_curve(np.array([_middle(lamp) for lamp in lamps]))
    before = np.cumsum(bright[order], axis=0)
    total = before[-1]
    count = np.ceil(total * rays_for_light)
    step = total / np.maximum(count, 1.0)
    last = np.clip(np.ceil(before / np.where(step > 0.0, step, 1.0) - shifts), 0.0, count)
    rays_of = np.diff(last, axis=0, prepend=0.0).T.astype(np.int64)
    receiver, place = np.nonzero(rays_of)
    times = rays_of[receiver, place]
    receiver = receiver.repeat(times)
    return _Draw(order[place].repeat(times), receiver, step[receiver])


def _middle(lamp: Lamp) -> Floats:
    return np.zeros(3) if isinstance(lamp, SunLamp) else lamp.centre


def _light_of_drawn(
    lamps: tuple[Lamp, ...],
    luminance: Floats,
    first_number: int,
    rays: RayScene,
    at: LitPoints,
    shifts: Floats,
    drawn: _Draw,
) -> tuple[DirectLight, Floats]:
    """What gets through along the rays to weak lamps, and the variance of its luminance, (n,)."""
    count = len(at)
    receiver = drawn.receiver
    number = np.arange(len(receiver)) - np.searchsorted(receiver, receiver)
    square = np.mod(shifts[receiver] + number[:, None] * [GOLDEN, GOLDEN * GOLDEN], 1.0)
    visible = np.ones(len(receiver))
    even = even_points(lamps)
    simple = np.zeros(len(lamps), dtype=bool)
    simple[even.lamp] = [lamps[k].shadow and lamps[k].linking.blockers is None for k in even.lamp]
    place = np.full(len(lamps), -1)
    place[even.lamp] = np.arange(len(even.lamp))
    ask = np.flatnonzero(simple[drawn.lamp])
    there = at.taken(receiver[ask])
    ways, facing = ways_to_points(even.taken(place[drawn.lamp[ask]]), there.points, square[ask])
    ways = _raised(ways, there.normals)
    origins, back = rays.lifted(there.points, there.lift)
    local = ways * rays.scale + back + OFFSET * facing
    visible[ask] = arriving(rays, there, np.arange(len(ask)), origins, local.astype(np.float32)[:, None])[:, 0]
    for which in np.unique(drawn.lamp[~simple[drawn.lamp]]):
        lamp = lamps[which]
        some = np.flatnonzero(drawn.lamp == which) if lamp.shadow else np.zeros(0, dtype=np.int64)
        there = at.taken(receiver[some])
        ways = _raised(ways_to(lamp, there.points, 1, square[some])[:, 0], there.normals)[:, None]
        hidden_by = rays.hidden_by(lamp.linking.blockers)
        visible[some], _ = _visible_share(lamp, hidden_by, there, ways)
    seen = np.bincount(receiver, weights=visible, minlength=count)
    asked = np.maximum(np.bincount(receiver, minlength=count), 1)
    share = seen / asked
    light = np.bincount(receiver, weights=drawn.light, minlength=count)
    weight = drawn.light * visible / luminance[drawn.lamp]
    return DirectLight.of(count, receiver, first_number + drawn.lamp, weight), light**2 * share * (1.0 - share) / asked


def _raised(ways: Floats, normals: Floats) -> Floats:
    """Ways (r, 3) turned over to above the horizon: only what is there of a lamp counts for what gets through."""
    height = np.minimum(np.einsum("rx,rx->r", ways, normals), 0.0)
    raised: Floats = ways - 2.0 * height[:, None] * normals
    return raised


def _visible_share(lamp: Lamp, rays: RayScene, at: LitPoints, ways: Floats) -> tuple[Floats, Floats]:
    """Share of a lamp's light that comes through, by rays to places of it, and the variance of the rays, both (n,).

    Parameters
    ----------
    ways : (n, r, 3) float
        To the places.
    """
    facing = shapes_of(lamp, at.points).normals
    origins, back = rays.lifted(at.points, at.lift)
    if isinstance(lamp, SunLamp):
        local = ways * (BEYOND / np.linalg.norm(ways, axis=2, keepdims=True))
    else:
        # Off the lamp, which may lie in a ceiling's plane.
        local = ways * rays.scale + (back + OFFSET * facing)[:, None]
    toward: Singles = local.astype(np.float32)
    kernel = kernel_of(lamp, facing, at.normals, ways)
    above = (np.einsum("nrx,nx->nr", local, at.lift) > -OFFSET) | at.bulges[:, None]
    ask = np.flatnonzero((above & (kernel > 0.0)).any(axis=1))
    arrives = arriving(rays, at, ask, origins, toward[ask], isinstance(lamp, SunLamp))
    seen = above.astype(arrives.dtype)
    seen[ask] = arrives
    tried = kernel.sum(axis=1)
    # A few places may all miss what little is above the horizon: then each counts alike.
    kernel[tried <= 0.0] = 1.0
    share: Floats = (kernel * seen).sum(axis=1) / kernel.sum(axis=1)
    return share, spread_of_rays(seen, share)
