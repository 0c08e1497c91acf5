# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The final gather: irradiance at receivers from the solved radiosity and, explicitly, from the emitters."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .direct import LUMINANCE, Emitters, direct_irradiance
from .receivers import Receivers
from .rows import BURIED, COVER_GAP, ESCAPED
from .sampling import Singles, frames, hemisphere_lattice
from .scene import Floats, Ints
from .transport import Transport
from .visibility import OFFSET

LEAST_COVERED_SHARE = 0.9
"""A receiver is covered when more of its rays than this end within `COVER_GAP` of its faces' size."""

LEAST_VALID_SHARE = 0.5
"""A receiver is buried when fewer of its rays than this left it outside a solid; from an outside point all do."""


BELOW = -3
"""Stands for what a ray meets that would leave below the surface, beside `ESCAPED` and `BURIED`."""


@dataclass(frozen=True)
class GatherRays:
    """Rays of each receiver.

    Attributes
    ----------
    hemisphere : int
        Rays that look up the radiosity of the surfaces around.
    shadow : int
        Rays over all emitters.
    penumbra : int
        The same, again, for receivers that see an emitter in part.
    deep : int
        The same, again, where these still leave more than `tolerance`.
    tolerance : float
        Standard error of the direct light, relative to the mean light of all receivers.
    """

    hemisphere: int
    shadow: int
    penumbra: int
    deep: int
    tolerance: float


@dataclass(frozen=True, eq=False)
class Radiance:
    """What a ray sees at the end of its way.

    Attributes
    ----------
    values : (elements + 3, 3) float32, W m^-2 sr^-1
        By element; the last three stand for `BELOW`, `BURIED` and `ESCAPED`, which index from the end.
    """

    values: Singles

    @staticmethod
    def of(elements: Floats, world: Floats) -> Radiance:
        """Join the radiance of elements (2 * nodes and twins, 3) with that of the world (3,)."""
        values = np.concatenate([elements, np.zeros((3, 3))])
        values[ESCAPED] = world
        return Radiance(values.astype(np.float32))


@dataclass(frozen=True, eq=False)
class Gathered:
    """Irradiance at receivers.

    Attributes
    ----------
    irradiance : (n, 3) float, W m^-2 sr^-1
        Irradiance over pi.
    noise : (n,) float
        Standard error of its luminance, from two halves of the rays.
    hidden : (n,) bool
        Receivers that nothing but what hides them can see: inside a solid, or covered so closely.
    """

    irradiance: Floats
    noise: Floats
    hidden: NDArray[np.bool_]


def gather(
    transport: Transport,
    radiance: Radiance,
    emitters: tuple[Emitters, ...],
    receivers: Receivers,
    counts: GatherRays,
    report: Callable[[float], None],
) -> Gathered:
    """Gather light at receivers: emitters by form factor and shadow rays, all else by rays that look up `radiance`.

    Each set of emitters has its own shadow rays.
    """
    total = len(receivers.points)
    if total == 0:
        return Gathered(np.zeros((0, 3)), np.zeros(0), np.zeros(0, dtype=bool))

    pattern = hemisphere_lattice(counts.hemisphere, transport.seed + 101)

    def indirect(first: int, last: int) -> tuple[Floats, Floats, NDArray[np.bool_]]:
        return _indirect_part(transport, radiance, receivers, slice(first, last), pattern)

    parts = transport.rays.map(indirect, total, counts.hemisphere, lambda share: report(0.7 * share))
    means, noise = (np.concatenate([p[k] for p in parts]) for k in (0, 1))
    hidden = np.concatenate([p[2] for p in parts])
    direct = sum((_direct(transport, each, receivers, counts, report) for each in emitters), np.zeros((total, 3)))
    return Gathered(means + direct, noise, hidden)


def hidden_receivers(transport: Transport, receivers: Receivers, rays: int) -> NDArray[np.bool_]:
    """Whether receivers are hidden, as `gather` finds it, by fewer rays, (n,) bool."""
    pattern = hemisphere_lattice(rays, transport.seed + 102)

    def work(first: int, last: int) -> NDArray[np.bool_]:
        elements, distance = _looked(transport, receivers, slice(first, last), pattern)
        return _is_hidden(transport, receivers.sizes[first:last], elements, distance)

    parts = transport.rays.map(work, len(receivers.points), rays)
    return np.concatenate([np.zeros(0, dtype=bool), *parts])


def _indirect_part(
    transport: Transport, radiance: Radiance, receivers: Receivers, part: slice, pattern: Singles
) -> tuple[Floats, Floats, NDArray[np.bool_]]:
    elements, distance = _looked(transport, receivers, part, pattern)
    rays = elements.shape[1]
    seen = radiance.values[elements]
    valid = rays - (elements == BURIED).sum(axis=1)
    means = seen.sum(axis=1, dtype=np.float64) / np.maximum(valid, 1)[:, None]
    half = seen[:, ::2].mean(axis=1) - seen[:, 1::2].mean(axis=1)
    # Inside a solid the few rays that slip out at an edge mean nothing.
    means[valid < LEAST_VALID_SHARE * rays] = 0.0
    hidden = _is_hidden(transport, receivers.sizes[part], elements, distance)
    return means, np.abs(half @ LUMINANCE) / 2.0, hidden


def _looked(
    transport: Transport, receivers: Receivers, part: slice, pattern: Singles
) -> tuple[NDArray[np.int32], Singles]:
    """What the rays of receivers meet, and how far away, both (n, r)."""
    rays = len(pattern)
    # All receivers take the same pattern: what it misses then changes slowly over a surface instead of mottling it, at
    # the same error.
    normals = receivers.normals[part]
    directions = (pattern @ frames(normals, np.zeros(len(normals)))).reshape(-1, 3)
    lift = receivers.lift[part].astype(np.float32)
    origins = np.repeat(transport.rays.local(receivers.points[part]) + lift * np.float32(OFFSET), rays, axis=0)
    count = len(lift)
    # A smooth shading normal leans over its face: what it asks for from below the face is dark, as in Cycles.
    above = (directions.reshape(count, rays, 3) @ lift[:, :, None]).ravel() > 0.0
    elements, distance = np.full(count * rays, BELOW, dtype=np.int32), np.full(count * rays, np.inf, dtype=np.float32)
    elements[above], _, _, distance[above] = transport.look(origins[above], directions[above])
    return elements.reshape(count, rays), distance.reshape(count, rays)


def _is_hidden(
    transport: Transport, sizes: Floats, elements: NDArray[np.int32], distance: Singles
) -> NDArray[np.bool_]:
    reach = COVER_GAP * transport.rays.scale * sizes
    covered = (distance < reach[:, None]).mean(axis=1) > LEAST_COVERED_SHARE
    result: NDArray[np.bool_] = covered | ((elements == BURIED).mean(axis=1) > 1.0 - LEAST_VALID_SHARE)
    return result


def _direct(
    transport: Transport,
    emitters: Emitters,
    receivers: Receivers,
    counts: GatherRays,
    report: Callable[[float], None],
) -> Floats:
    def pass_over(chosen: Ints, rays: int, salt: int, low: float, high: float) -> tuple[Floats, Floats]:
        def work(first: int, last: int) -> tuple[Floats, Floats]:
            part = chosen[first:last]
            return direct_irradiance(
                emitters,
                transport.rays,
                receivers.points[part],
                receivers.normals[part],
                receivers.lift[part],
                np.zeros(len(part), dtype=np.int64),
                rays,
                transport.seed + salt,
            )

        parts = transport.rays.map(work, len(chosen), rays, lambda share: report(low + (high - low) * share))
        if not parts:
            return np.zeros((0, 3)), np.zeros(0)
        return np.concatenate([p[0] for p in parts]), np.concatenate([p[1] for p in parts])

    everyone = np.arange(len(receivers.points))
    if len(emitters.triangle) == 0:
        return np.zeros((len(everyone), 3))
    direct, uncertainty = pass_over(everyone, counts.shadow, 201, 0.7, 0.75)
    again = np.flatnonzero(uncertainty > 0.0)
    direct[again], uncertainty[again] = pass_over(again, counts.penumbra, 202, 0.75, 0.85)
    deep = np.flatnonzero(uncertainty > counts.tolerance * float((direct @ LUMINANCE).mean()))
    direct[deep], _ = pass_over(deep, counts.deep, 203, 0.85, 1.0)
    return direct


def corner_values(gathered: Gathered, of_corner: Ints) -> Floats:
    """Irradiance at face corners, (f, 3, 3), without the dark or bright rim that hidden vertices would draw.

    A face that is hidden at some corners and seen at others shows the seen ones' light to its end: at a hidden corner
    it takes the mean of what such faces show at their other corners. Faces hidden altogether keep what was gathered.

    Parameters
    ----------
    of_corner : (f, 3) int
        Receivers of each face's corners.
    """
    values = gathered.irradiance[of_corner]
    hidden = gathered.hidden[of_corner]
    mixed = np.flatnonzero(hidden.any(axis=1) & ~hidden.all(axis=1))
    unseen, corners = hidden[mixed], of_corner[mixed]
    shown = np.einsum("fk,fkc->fc", ~unseen, values[mixed]) / (~unseen).sum(axis=1)[:, None]
    face, corner = np.nonzero(unseen)
    target, size = corners[face, corner], len(gathered.hidden)
    count = np.maximum(np.bincount(target, minlength=size), 1)
    for channel in range(values.shape[2]):
        mean = np.bincount(target, weights=shown[face, channel], minlength=size) / count
        values[mixed[face], corner, channel] = mean[target]
    return values
