# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Low-discrepancy points, decorrelated from one receiver to the next, and what they are mapped to.

The sequences are additive recurrences on the generalised golden ratio (M. Roberts 2018): point i has coordinates
frac(i * a_d) with a_d = g**-(d+1) and g the positive root of x**(dim+1) = x + 1. A fixed number of patterns are made of
them, each shifted by its own random numbers (Cranley & Patterson 1976); a patch takes the pattern that its hash names
and turns it about its normal by an angle that its hash gives. So a ray costs no more than two products of small
matrices, and depends on nothing but the seed and the patch. Vertices, which the eye compares, all take one
lattice.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from .scene import Floats, Ints

PATTERNS = 64
"""Patterns that patches share; turned about their normals, no two patches have the same rays."""

GOLDEN = 0.6180339887498949

LATTICE_ERROR = 0.8
"""Standard error of a share V of a triangle found by n points of a lattice, over sqrt(V (1 - V)) n**-0.75. Shares cut
off by straight lines in any place, found by 8 to 1,024 points, have 0.7 to 0.9 of it (tests/core/test_direct.py)."""

LATTICE_FALL = 0.75
"""The power of n that it falls by."""

RAY_COUNTS = np.array([1, 2, 3, *(n << k for k in range(1, 12) for n in (2, 3))])
"""So many rays a part of an emitter may get: all that get the same number can be treated at once."""

Singles = NDArray[np.float32]


@lru_cache
def _steps(dimensions: int) -> tuple[float, ...]:
    root = 2.0
    for _ in range(64):
        root = (1.0 + root) ** (1.0 / (dimensions + 1))
    return tuple(root ** -(k + 1) for k in range(dimensions))


def sequence(first: int, count: int, dimensions: int) -> Floats:
    """Points `first` to `first + count - 1` of the recurrence, (count, dimensions), in [0, 1)."""
    index = np.arange(first + 1, first + count + 1, dtype=np.float64)
    result: Floats = np.mod(index[:, None] * np.array(_steps(dimensions)), 1.0)
    return result


def mixed(x: NDArray[np.uint64]) -> NDArray[np.uint64]:
    """SplitMix64's finalizer (Steele, Lea & Flood 2014): neighbouring integers become unrelated ones, any shape."""
    x = (x ^ (x >> np.uint64(30))) * np.uint64(0xBF58476D1CE4E5B9)
    x = (x ^ (x >> np.uint64(27))) * np.uint64(0x94D049BB133111EB)
    return x ^ (x >> np.uint64(31))


def hashed(keys: Ints, dimensions: int, seed: int) -> Floats:
    """Uniform numbers in [0, 1) that depend on the key, the dimension and the seed alone, (n, dimensions)."""
    with np.errstate(over="ignore"):
        base = mixed(keys.astype(np.uint64) + np.uint64(0x9E3779B97F4A7C15) * np.uint64(seed + 1))
        lanes = np.arange(1, dimensions + 1, dtype=np.uint64) * np.uint64(0xD1342543DE82EF95)
        drawn = mixed(base[:, None] + lanes)
    return (drawn >> np.uint64(11)).astype(np.float64) * 2.0**-53


def radical_inverse(first: int, count: int) -> Floats:
    """Numbers `first` to `first + count - 1` of van der Corput's sequence in base 2, (count,), in [0, 1)."""
    index = np.arange(first, first + count)
    bits = (index[:, None] >> np.arange(32)) & 1
    result: Floats = bits @ 0.5 ** np.arange(1, 33)
    return result


def chances(first: int, count: int) -> Floats:
    """Numbers of rays `first` to `first + count - 1`, even whatever their directions, (count,), in [0, 1)."""
    result: Floats = np.mod((np.arange(first, first + count) + 0.5) * (np.sqrt(3.0) - 1.0), 1.0)
    return result


def even_chances(count: int) -> Singles:
    """Numbers of so many rays in all, (count,), in [0, 1): those of `chances`, drawn to equal steps in their order."""
    order = np.argsort(chances(0, count))
    even = np.empty(count, dtype=np.float32)
    even[order] = (np.arange(count) + 0.5) / count
    return even


def shifted(points: Floats, shifts: Floats) -> Floats:
    """Points (r, d) shifted for each of n receivers by (n, d), wrapped into [0, 1): (n, r, d)."""
    moved = points[None, :, :] + shifts[:, None, :]
    moved -= moved >= 1.0
    return moved


def triangle_weights(square: Floats) -> Floats:
    """Uniform barycentric weights of corners 1 and 2 from points of the unit square, folded along its diagonal."""
    return np.where(square.sum(axis=-1, keepdims=True) > 1.0, 1.0 - square, square)


def triangle_lattice(count: int, shift: Floats) -> Floats:
    """So many points of a triangle, as even as they can be, as weights of its three corners, (count, 3).

    A golden lattice of the unit square, whose one side is drawn together to the first corner. Of what a straight edge
    cuts off the triangle it finds the share with half the error of `sequence`, folded.

    Parameters
    ----------
    shift : (2,) float, 0..1
        Where in their cells the points lie, and where round the first corner they begin.
    """
    index = np.arange(count, dtype=np.float64)
    away = np.sqrt((index + shift[0]) / count)
    across = np.mod(index * GOLDEN + shift[1], 1.0)
    return np.stack([1.0 - away, away * (1.0 - across), away * across], axis=1)


def ray_counts(wanted: Floats) -> Ints:
    """Those of `RAY_COUNTS` that are nearest in ratio to the numbers wanted."""
    counts: Ints = RAY_COUNTS[np.searchsorted(np.sqrt(RAY_COUNTS[1:] * RAY_COUNTS[:-1]), wanted)]
    return counts


def hemisphere(square: Floats) -> Floats:
    """Directions about +z with density cos / pi from points of the unit square, (..., 2) to (..., 3)."""
    radius, angle = np.sqrt(square[..., 0]), square[..., 1] * (2.0 * np.pi)
    height = np.sqrt(np.maximum(0.0, 1.0 - square[..., 0]))
    return np.stack([radius * np.cos(angle), radius * np.sin(angle), height], axis=-1)


def hemisphere_lattice(count: int, seed: int) -> Singles:
    """So many directions about +z with density cos / pi, as even as they can be: a shifted golden lattice, (count, 3).

    It cannot be continued, unlike `sequence`; 256 of its directions have a fourth of the error in the mean cosine.
    """
    index = np.arange(count, dtype=np.float64)
    square = np.stack([(index + 0.5) / count, np.mod(index * GOLDEN, 1.0)], axis=1)
    return hemisphere(shifted(square, hashed(np.zeros(1, dtype=np.int64), 2, seed))[0]).astype(np.float32)


def frames(normals: Floats, angles: Floats) -> Singles:
    """Rows tangent, bitangent and normal of each (n, 3), turned about the normal by (n,) radians: (n, 3, 3).

    The frame is that of Duff et al. 2017, "Building an Orthonormal Basis, Revisited".
    """
    nx, ny, nz = normals[:, 0], normals[:, 1], normals[:, 2]
    sign = np.where(nz >= 0.0, 1.0, -1.0)
    a = -1.0 / (sign + nz)
    b = nx * ny * a
    tangent = np.stack([1.0 + sign * nx * nx * a, sign * b, -sign * nx], axis=-1)
    bitangent = np.stack([b, sign + ny * ny * a, -ny], axis=-1)
    cos, sin = np.cos(angles)[:, None], np.sin(angles)[:, None]
    turned = [cos * tangent + sin * bitangent, cos * bitangent - sin * tangent, normals]
    return np.stack(turned, axis=1).astype(np.float32)


def cosine_directions(square: Floats, normals: Floats) -> Floats:
    """One direction for each normal with density cos / pi about it: (n, 2) and (n, 3) give (n, 3)."""
    frame = frames(normals, np.zeros(len(normals)))
    result: Floats = np.einsum("nk,nkx->nx", hemisphere(square), frame.astype(np.float64))
    return result


@dataclass(frozen=True, eq=False)
class Patterns:
    """Sampling patterns of r rays, with positions on a triangle where the rays leave a patch.

    Attributes
    ----------
    directions : (PATTERNS, r, 3) float32
        About +z, with density cos / pi.
    positions : (PATTERNS, r, 3) float32
        (1, u, v) with the barycentric weights of corners 1 and 2.
    chances : (r,) float
        By which rays go on through what lets a part of the light through.
    shares : (r,) float
        Where the rays leave a cluster, as shares of its triangles' area laid end to end: evenly spread, and by another
        sequence than the directions, or the two would go together.
    """

    directions: Singles
    positions: Singles
    chances: Floats
    shares: Floats

    @staticmethod
    def make(first: int, count: int, seed: int) -> Patterns:
        """Rays `first` to `first + count - 1` of each pattern; patterns with the same seed go on where others ended."""
        shifts = hashed(np.arange(PATTERNS), 4, seed)
        # The first two steps are close to 6/7 and 3/4: good enough for positions, uneven for directions.
        points = shifted(sequence(first, count, 4), shifts)
        weights = triangle_weights(points[..., :2])
        positions = np.concatenate([np.ones((*weights.shape[:2], 1)), weights], axis=-1)
        directions = hemisphere(points[..., 2:]).astype(np.float32)
        return Patterns(directions, positions.astype(np.float32), chances(first, count), radical_inverse(first, count))

    def choose(self, keys: Ints, seed: int) -> tuple[Ints, Floats]:
        """The pattern of each receiver and the angle it is turned by, both (n,)."""
        drawn = hashed(keys, 2, seed)
        return (drawn[:, 0] * PATTERNS).astype(np.int64), drawn[:, 1] * (2.0 * np.pi)
