# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""A world that is not even: a smooth map of directions that rays look up, and suns for what is too bright for that.

A ray that leaves the scene stands for some solid angle. What is much smaller and brighter would be met by few rays or
by none, and make noise. It is taken out of the map, put together in spots, and each spot is a sun: a lamp that gets
shadow rays of its own. The direction of a sun is that of the light's vector sum, so its unoccluded light is exact.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .direct import LUMINANCE
from .geometry import normalized
from .scene import Floats, Ints, SunLamp

ACROSS = 64
"""Cells along an edge of the map: each is 2 to 4 degrees wide, somewhat less than what a ray of the gather is for."""

MAP_CELLS = ACROSS * ACROSS

BRIGHT = 10.0
"""Times the usual radiance of the sky from which on light is taken out of the map: at 4 there are three times as many
suns at the same error, at 30 studio lamps make noise."""

MOST_SUNS = 32

LEAST_SPOT = 0.006
"""Share of the sky's light below which a spot is left in the map, or not split further."""

LARGEST_SPOT = np.radians(8.0)
"""Radius of a spot above which it is split."""

BLOCK = 8
"""Texels of the cube along an edge of what is looked at closer."""

MOST_WINDOWS = 12

LEAST_WINDOW, PEAKED = 0.001, 4.0
"""Share of the sky's light that is too bright in a block which is looked at closer, and how many times brighter its
brightest texel is than the block: even lamps need no closer look."""

COARSE = 128
"""Texels along an edge of the cube, as others are averaged."""

ROUNDS = 12
"""Times that what is too bright is left out of the mean."""

ROUNDNESS = 2.5
"""Ratio of the variances of a spot, along and across, above which it is split: a disk stands for it."""

CORE = 0.125
"""Share of a spot's highest radiance above which it is its core: the disc of the sun, without what glows around."""

LEAST_CORE, SMALLER = 0.1, 0.75
"""Share of a spot's light that its core must have, and of its radius that the core's may, to be told apart."""

STEPS = 2.0**14
"""Directions and angles of suns are rounded to this part of 1, so that those of a world that only changed its strength
are the same."""


@dataclass(frozen=True, eq=False)
class SkySamples:
    """A sky as so many small parts of it.

    Attributes
    ----------
    directions : (n, 3) float, unit
    solid_angles : (n,) float, sr
        About 4 pi in all.
    radiance : (n, 3) float, W m^-2 sr^-1
        Linear RGB, the mean over each part.
    """

    directions: Floats
    solid_angles: Floats
    radiance: Floats


WHOLE_FACES: Floats = np.array([(face, -1.0, -1.0, 2.0) for face in range(6)])
"""The windows that are the faces of the cube."""

_FRAMES: Floats = np.array(
    [
        [(1, 0, 0), (0, 1, 0), (0, 0, 1)],
        [(-1, 0, 0), (0, -1, 0), (0, 0, 1)],
        [(0, 1, 0), (-1, 0, 0), (0, 0, 1)],
        [(0, -1, 0), (1, 0, 0), (0, 0, 1)],
        [(0, 0, 1), (1, 0, 0), (0, 1, 0)],
        [(0, 0, -1), (1, 0, 0), (0, -1, 0)],
    ],
    dtype=np.float64,
)
"""The faces of a cube: outward, and along the columns and the rows of their texels, (6, 3, 3)."""


def window_corners(windows: Floats) -> Floats:
    """The corners of square windows in the faces of the cube from -1 to 1, (k, 4, 3).

    Parameters
    ----------
    windows : (k, 4) float
        The face, the lower corner in it, and the side.
    """
    return _at(windows, np.array([(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)]))


def _at(windows: Floats, shares: Floats) -> Floats:
    """Places in windows, (k, n, 3), at shares (n, 2) of their sides."""
    frame = _FRAMES[windows[:, 0].astype(np.int64)]
    local = windows[:, None, 1:3] + windows[:, None, 3:] * shares
    places: Floats = frame[:, None, 0] + local @ frame[:, 1:]
    return places


def window_samples(windows: Floats, radiance: Floats) -> SkySamples:
    """The texels (k, n, n, 3) of windows, row by row from the lower corner."""
    texels = radiance.shape[1]
    middle = (np.arange(texels) + 0.5) / texels
    shares = np.stack(np.meshgrid(middle, middle), axis=-1).reshape(-1, 2)
    places = _at(windows, shares)
    distance = np.linalg.norm(places, axis=2)
    # A texel's area, seen from the middle at an angle whose cosine is one over the distance.
    solid = (windows[:, 3:] / texels) ** 2 / distance**3
    return SkySamples((places / distance[..., None]).reshape(-1, 3), solid.ravel(), radiance.reshape(-1, 3))


@dataclass(frozen=True, eq=False)
class SkyCube:
    """A sky on the faces of a cube.

    Attributes
    ----------
    radiance : (6, n, n, 3) float, W m^-2 sr^-1
        Linear RGB in the middle of each texel.
    """

    radiance: Floats

    def bright_windows(self) -> Floats:
        """Windows around what is so bright and so small that it is to be looked at closer, (k, 4)."""
        size = self.radiance.shape[1] // BLOCK
        luminance = self.radiance @ LUMINANCE
        usual = _usual(luminance)
        over = np.maximum(luminance - BRIGHT * usual, 0.0)
        blocks = over.reshape(6, size, BLOCK, size, BLOCK)
        power, peak = blocks.sum(axis=(2, 4)), blocks.max(axis=(2, 4))
        chosen = (power > LEAST_WINDOW * luminance.sum()) & (peak * BLOCK**2 > PEAKED * power)
        # What is bright at the border of a block may go on in the next.
        wide = np.pad(chosen, ((0, 0), (1, 1), (1, 1)))
        near = [wide[:, 1 + i : size + 1 + i, 1 + j : size + 1 + j] for i in (-1, 0, 1) for j in (-1, 0, 1)]
        face, row, column = np.nonzero(np.any(near, axis=0))
        brightest = np.argsort(-power[face, row, column], kind="stable")[:MOST_WINDOWS]
        face, row, column = face[brightest], row[brightest], column[brightest]
        side = 2.0 / size
        return np.stack([face, column * side - 1.0, row * side - 1.0, np.full(len(face), side)], axis=1)

    def with_windows(self, windows: Floats, radiance: Floats) -> SkySamples:
        """The sky as samples: the texels (k, m, m, 3) of some windows, and the others of the cube, averaged.

        Parameters
        ----------
        windows : (k, 4) float
            Of `bright_windows`.
        """
        size = self.radiance.shape[1]
        step = max(1, size // COARSE)
        cube = window_samples(WHOLE_FACES, self.radiance)
        side = size // BLOCK
        seen = np.ones((6, side, side), dtype=bool)
        lower = np.rint((windows[:, 1:3] + 1.0) * side / 2.0).astype(np.int64)
        seen[windows[:, 0].astype(np.int64), lower[:, 1], lower[:, 0]] = False
        kept = seen.repeat(BLOCK // step, axis=1).repeat(BLOCK // step, axis=2).ravel()

        def sums(values: Floats) -> Floats:
            parts = values.reshape(6, size // step, step, size // step, step, -1).sum(axis=(2, 4))
            return parts.reshape(len(kept), -1)[kept]

        weight = cube.solid_angles[:, None]
        solid = sums(weight)[:, 0]
        directions = normalized(sums(weight * cube.directions))
        mean = sums(weight * cube.radiance) / solid[:, None]
        near = window_samples(windows, radiance)
        return SkySamples(
            np.concatenate([directions, near.directions]),
            np.concatenate([solid, near.solid_angles]),
            np.concatenate([mean, near.radiance]),
        )


def _usual(luminance: Floats, weight: Floats | None = None) -> float:
    """Mean luminance of a sky without what is much brighter, as its sun may have most of the light."""
    usual = np.average(luminance, weights=weight)
    for _ in range(ROUNDS):
        usual = np.average(np.minimum(luminance, BRIGHT * usual), weights=weight)
    return float(usual)


def map_cells(directions: NDArray[np.floating]) -> NDArray[np.int32]:
    """The cell of the map that directions (n, 3) of any length lie in, (n,): an octahedron unfolded to a square."""
    square = _unfolded(directions)
    across = np.clip((square * np.float32(ACROSS)).astype(np.int32), 0, ACROSS - 1)
    cells: NDArray[np.int32] = across[:, 1] * ACROSS + across[:, 0]
    return cells


def _unfolded(directions: NDArray[np.floating]) -> NDArray[np.floating]:
    """Places in the unit square, (n, 2)."""
    flat = directions[:, :2] / np.abs(directions).sum(axis=1, keepdims=True)
    outer = (1.0 - np.abs(flat[:, ::-1])) * np.where(flat < 0.0, -1.0, 1.0).astype(flat.dtype)
    return 0.5 + 0.5 * np.where(directions[:, 2:] < 0.0, outer, flat)


def sky_map(sky: SkySamples) -> Floats:
    """The radiance of a sky in each cell of the map, (cells, 3), smoothed over neighbouring cells."""
    at = _unfolded(sky.directions) * ACROSS - 0.5
    low: Ints = np.floor(at).astype(np.int64)
    part = at - low
    light, weight = np.zeros((MAP_CELLS, 3)), np.zeros(MAP_CELLS)
    for i, j in ((0, 0), (0, 1), (1, 0), (1, 1)):
        cell = _wrapped(low + np.array([i, j]))
        share = sky.solid_angles * np.abs(1 - i - part[:, 0]) * np.abs(1 - j - part[:, 1])
        weight += np.bincount(cell, weights=share, minlength=MAP_CELLS)
        for channel in range(3):
            light[:, channel] += np.bincount(cell, weights=share * sky.radiance[:, channel], minlength=MAP_CELLS)
    return light / np.maximum(weight, np.finfo(np.float64).tiny)[:, None]


def _wrapped(at: Ints) -> Ints:
    """Numbers of the cells at whole coordinates (n, 2), of which some lie one beyond the edge of the square."""
    x, y = at.T
    over = (x < 0) | (x >= ACROSS)
    y = np.where(over, ACROSS - 1 - y, y)
    x = np.clip(x, 0, ACROSS - 1)
    over = (y < 0) | (y >= ACROSS)
    x = np.where(over, ACROSS - 1 - x, x)
    cells: Ints = np.clip(y, 0, ACROSS - 1) * ACROSS + x
    return cells


def split_sky(sky: SkySamples, name: str) -> tuple[Floats, tuple[SunLamp, ...]]:
    """Take what is bright and small out of a sky.

    Returns
    -------
    radiance : (cells, 3) float, W m^-2 sr^-1
        The map of the rest.
    suns : tuple of SunLamp
        All named `name`, the one with most light first.
    """
    luminance = sky.radiance @ LUMINANCE
    limit = BRIGHT * _usual(luminance, sky.solid_angles)
    over = np.flatnonzero(luminance > limit)
    light = (sky.solid_angles[over] * (1.0 - limit / luminance[over]))[:, None] * sky.radiance[over]
    total = float(sky.solid_angles @ luminance)
    spots = _spots(sky.directions[over], light, sky.solid_angles[over], total)
    radiance = sky.radiance.copy()
    suns = []
    for spot in spots:
        direction, angle, strength = _sun_of(sky.directions[over[spot]], light[spot], sky.solid_angles[over[spot]])
        suns.append(SunLamp(name, direction, angle, strength, of_world=True))
        radiance[over[spot]] *= (limit / luminance[over[spot]])[:, None]
    return sky_map(SkySamples(sky.directions, sky.solid_angles, radiance)), tuple(suns)


def _spots(directions: Floats, light: Floats, solid_angles: Floats, total: float) -> list[Ints]:
    """Put bright samples together to spots that disks can stand for."""
    power = light @ LUMINANCE
    waiting = [np.arange(len(power))] if len(power) else []
    done: list[Ints] = []
    while waiting:
        spot = waiting.pop(int(np.argmax([power[s].sum() for s in waiting])))
        weight = power[spot]
        if weight.sum() < LEAST_SPOT * total:
            continue
        parts = _parted(directions[spot], light[spot] @ LUMINANCE, solid_angles[spot])
        if parts is not None and len(waiting) + len(done) < MOST_SUNS - 1:
            waiting += [spot[parts], spot[~parts]]
            continue
        done.append(spot)
    return sorted(done, key=lambda spot: -float(power[spot].sum()))


def _parted(directions: Floats, power: Floats, solid_angles: Floats) -> NDArray[np.bool_] | None:
    """Which samples of a spot one of its two parts is made of, or None where a disk can stand for the whole."""
    radiance = power / solid_angles
    core = radiance > CORE * radiance.max()
    radius, axes, spread = _extent(directions, power)
    strong = not core.all() and power[core].sum() > LEAST_CORE * power.sum()
    if strong and _extent(directions[core], power[core])[0] < SMALLER * radius:
        return core
    texel = np.sqrt(solid_angles.max())
    if radius > LARGEST_SPOT or spread[0] > ROUNDNESS * max(spread[1], texel * texel):
        side = (directions - np.average(directions, axis=0, weights=power)) @ axes > 0.0
        if side.any() and not side.all():
            return side
    return None


def _extent(directions: Floats, power: Floats) -> tuple[float, Floats, Floats]:
    """Radius of a disk that spreads as wide as a spot, its longest axis, and the variances along and across."""
    away = directions - np.average(directions, axis=0, weights=power)
    spread, axes = np.linalg.eigh((away * power[:, None]).T @ away / power.sum())
    # That of a disk is half its squared radius, a quarter along each axis.
    return float(np.sqrt(2.0 * spread.sum())), axes[:, 2], spread[:0:-1]


def _sun_of(directions: Floats, light: Floats, solid_angles: Floats) -> tuple[Floats, float, Floats]:
    """Direction, angle and irradiance of the disk that stands for a spot."""
    power = light @ LUMINANCE
    vector = (power[:, None] * directions).sum(axis=0)
    middle = normalized(vector[None])[0]
    # The variance of a disk is half its squared radius; each sample is one itself.
    square = 2.0 * (power * ((directions - middle) ** 2).sum(axis=1)).sum() / power.sum()
    square += (power * solid_angles).sum() / power.sum() / np.pi
    strength = light.sum(axis=0) * (np.linalg.norm(vector) / power.sum())
    toward = normalized(np.round(middle * STEPS)[None])[0]
    angle = np.round(2.0 * np.sqrt(square) * STEPS) / STEPS
    return -toward, float(angle), strength
