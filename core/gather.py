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
from .sampling import Patterns, Singles, frames
from .scene import Floats, Ints
from .transport import BURIED, ESCAPED, Transport
from .visibility import OFFSET

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
    """

    hemisphere: int
    shadow: int
    penumbra: int


@dataclass(frozen=True, eq=False)
class Radiance:
    """What a ray sees at the end of its way.

    Attributes
    ----------
    values : (2 * nodes + 3, 3) float32, W m^-2 sr^-1
        By element; the last three stand for `BELOW`, `BURIED` and `ESCAPED`, which index from the end.
    dark : (2 * nodes + 3,) bool
        Surfaces that would reflect light and have none, and insides of solids.
    """

    values: Singles
    dark: NDArray[np.bool_]

    @staticmethod
    def of(elements: Floats, dark: NDArray[np.bool_], world: Floats) -> Radiance:
        """Join the radiance of elements (2 * nodes, 3) with that of the world (3,)."""
        values = np.concatenate([elements, np.zeros((3, 3))])
        values[ESCAPED] = world
        seen_dark = np.concatenate([dark, np.ones(3, dtype=bool)])
        seen_dark[ESCAPED] = False
        return Radiance(values.astype(np.float32), seen_dark)


@dataclass(frozen=True, eq=False)
class Gathered:
    """Irradiance at receivers.

    Attributes
    ----------
    irradiance : (n, 3) float, W m^-2 sr^-1
        Irradiance over pi.
    noise : (n,) float
        Standard error of its luminance, from two halves of the rays.
    buried : (n,) bool
        Receivers inside a solid, where nothing can be seen and the value means nothing.
    enclosed : (n,) bool
        Receivers that get no light and see nothing but unlit surfaces, such as a floor under a box without a bottom.
    """

    irradiance: Floats
    noise: Floats
    buried: NDArray[np.bool_]
    enclosed: NDArray[np.bool_]


def gather(
    transport: Transport,
    radiance: Radiance,
    emitters: Emitters,
    receivers: Receivers,
    counts: GatherRays,
    report: Callable[[float], None],
) -> Gathered:
    """Gather light at receivers: emitters by form factor and shadow rays, all else by rays that look up `radiance`."""
    total = len(receivers.points)

    patterns = Patterns.make(0, counts.hemisphere, transport.seed + 101)

    def indirect(first: int, last: int) -> tuple[Floats, Floats, Floats, NDArray[np.bool_]]:
        return _indirect_part(transport, radiance, receivers, slice(first, last), patterns)

    parts = transport.rays.map(indirect, total, counts.hemisphere, lambda share: report(0.7 * share))
    means, noise = (np.concatenate([p[k] for p in parts]) for k in (0, 1))
    valid, dark = np.concatenate([p[2] for p in parts]), np.concatenate([p[3] for p in parts])

    direct = _direct(transport, emitters, receivers, np.arange(total), counts, report)
    irradiance = means + direct
    buried = valid < LEAST_VALID_SHARE
    enclosed = dark & ~buried & ~(irradiance > 0.0).any(axis=1)
    return Gathered(irradiance, noise, buried, enclosed)


def _indirect_part(
    transport: Transport, radiance: Radiance, receivers: Receivers, part: slice, patterns: Patterns
) -> tuple[Floats, Floats, Floats, NDArray[np.bool_]]:
    rays = patterns.directions.shape[1]
    pattern, angle = patterns.choose(receivers.keys[part], transport.seed + 101)
    directions = (patterns.directions[pattern] @ frames(receivers.normals[part], angle)).reshape(-1, 3)
    lift = receivers.lift[part].astype(np.float32)
    origins = np.repeat(transport.rays.local(receivers.points[part]) + lift * np.float32(OFFSET), rays, axis=0)
    count = len(lift)
    # A smooth shading normal leans over its face: what it asks for from below the face is dark, as in Cycles.
    above = (directions.reshape(count, rays, 3) @ lift[:, :, None]).ravel() > 0.0
    elements = np.full(count * rays, BELOW, dtype=np.int32)
    if above.all():
        elements, _, _, _ = transport.look(origins, directions)
    else:
        elements[above], _, _, _ = transport.look(origins[above], directions[above])
    seen = radiance.values[elements].reshape(count, rays, 3)
    valid = rays - (elements == BURIED).reshape(count, rays).sum(axis=1)
    means = seen.sum(axis=1, dtype=np.float64) / np.maximum(valid, 1)[:, None]
    half = seen[:, : rays // 2].mean(axis=1) - seen[:, rays // 2 :].mean(axis=1)
    dark = radiance.dark[elements].reshape(count, rays).all(axis=1)
    return means, np.abs(half @ LUMINANCE) / 2.0, valid / rays, dark


def _direct(
    transport: Transport,
    emitters: Emitters,
    receivers: Receivers,
    chosen: Ints,
    counts: GatherRays,
    report: Callable[[float], None],
) -> Floats:
    def pass_over(chosen: Ints, rays: int, salt: int, low: float, high: float) -> tuple[Floats, NDArray[np.bool_]]:
        def work(first: int, last: int) -> tuple[Floats, NDArray[np.bool_]]:
            part = chosen[first:last]
            return direct_irradiance(
                emitters,
                transport.rays,
                receivers.points[part],
                receivers.normals[part],
                receivers.lift[part],
                receivers.keys[part],
                rays,
                transport.seed + salt,
            )

        parts = transport.rays.map(work, len(chosen), rays, lambda share: report(low + (high - low) * share))
        if not parts:
            return np.zeros((0, 3)), np.zeros(0, dtype=bool)
        return np.concatenate([p[0] for p in parts]), np.concatenate([p[1] for p in parts])

    if len(emitters.triangle) == 0:
        return np.zeros((len(chosen), 3))
    direct, penumbra = pass_over(chosen, counts.shadow, 201, 0.7, 0.8)
    again = np.flatnonzero(penumbra)
    direct[again], _ = pass_over(chosen[again], counts.penumbra, 202, 0.8, 1.0)
    return direct


def fill_hidden(values: Floats, gathered: Gathered, of_corner: Ints) -> Floats:
    """Give receivers that cannot be seen the mean of their neighbours' values, so that no dark rim shows at a foot.

    Buried receivers are filled however deep they lie; enclosed ones only next to a lit one, since the dark room behind
    a wall is enclosed too.

    Parameters
    ----------
    values : (n, c) float
    of_corner : (f, 3) int
        Receivers of each face's corners: neighbours share a face.
    """
    values = values.copy()
    known = ~(gathered.buried | gathered.enclosed)
    values[gathered.buried] = 0.0
    ring = gathered.buried | gathered.enclosed
    while True:
        near = known[of_corner]
        mixed = near.any(axis=1) & ~near.all(axis=1)
        faces, near = of_corner[mixed], near[mixed]
        if len(faces) == 0:
            return values
        face_sum = np.einsum("fk,fkc->fc", near, values[faces])
        target, member = faces[~near], np.nonzero(~near)[0]
        count = np.bincount(target, weights=near.sum(axis=1)[member], minlength=len(values))
        new = (count > 0) & ring
        if not new.any():
            return values
        for channel in range(values.shape[1]):
            total = np.bincount(target, weights=face_sum[member, channel], minlength=len(values))
            values[new, channel] = total[new] / count[new]
        known |= new
        ring = gathered.buried & ~known
