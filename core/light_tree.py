# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Thousands of emitters sorted into a binary tree, for those far away to be taken together.

A node stands for lights that lie close together and face about the same way: what they send to a distant point follows
from a few sums over them (after Walter et al. 2005, "Lightcuts", whose nodes stand for one of their lights).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from .geometry import normalized
from .sampling import Singles
from .scene import Floats, Ints

NORMALS_WEIGHT = 0.5
"""Extent of all lights that a turn of their normals by one radian counts as when they are sorted into a tree."""


@dataclass(frozen=True, eq=False)
class LightTree:
    """One-sided triangular lights in order, and the nodes of a complete binary tree over them.

    Node 1 is the root and node k has the children 2 k and 2 k + 1. Coordinates are relative to `origin`.

    Attributes
    ----------
    origin : (3,) float, scene units
    emitter : (k,) int
        The emitter that each light is a side of.
    corners : (k, 3, 3) float
    single_corners : (k, 3, 3) float32
        The same in single precision, for rays.
    normals : (k, 3) float32
        Of the side that shines.
    luminance : (k,) float
        Of the radiance.
    flux_before : (k + 1,) float
        Flux, area times luminance, of all lights before each.
    first, last : (nodes,) int
        The lights of a node are those from `first` to `last` - 1; there may be none.
    centre : (3, nodes) float
        Mean place, weighted by flux.
    shape : (5, nodes) float32
        Radius of the sphere about the centre that holds the corners; flux; cosine and sine of the largest angle
        between a normal and the axis; largest distance of the centre from the plane of a light.
    axis : (3, nodes) float32
        Direction of the mean normal.
    sums : (26, nodes) float32
        Radius and flux again; sum of the normals, weighted by flux (3); covariance of the normals (xx, yy, zz, xy, xz,
        yz); sum of the products of normals and places about the centre, weighted by flux (9); covariance of the places
        themselves, all over the lights (6).
    """

    origin: Floats
    emitter: Ints
    corners: Floats
    single_corners: Singles
    normals: Singles
    luminance: Floats
    flux_before: Floats
    first: Ints
    last: Ints
    centre: Floats
    shape: Singles
    axis: Singles
    sums: Singles


def halved(features: Floats, parts: int) -> Ints:
    """An order of points (n, d) that halves them again and again across their largest extent, (n,).

    Part i of `parts`, a power of two, is what lies from place i * n // parts to place (i + 1) * n // parts.
    """
    count = len(features)
    order, there, now = np.arange(count), features, 1
    while now < parts:
        bounds = np.arange(now + 1) * count // now
        part = np.repeat(np.arange(now), np.diff(bounds))
        # Parts without a point take that of their neighbour: it does not matter how they would be halved.
        start = np.minimum(bounds[:-1], count - 1)
        extent = np.maximum.reduceat(there, start) - np.minimum.reduceat(there, start)
        along = np.argmax(extent, axis=1)[part]
        sort = np.lexsort((there[np.arange(count), along], part))
        order, there = order[sort], there[sort]
        now *= 2
    return order


def light_tree(
    corners: Floats,
    normals: Floats,
    areas: Floats,
    luminance: Floats,
    emitter: Ints,
    side: Ints,
) -> LightTree:
    """Sort sides of emitting triangles into a tree.

    Parameters
    ----------
    corners : (e, 3, 3) float
    normals : (e, 3) float
    areas : (e,) float
    luminance : (e,) float
        Of the radiance, above 0 for those chosen.
    emitter, side : (k,) int
        The sides (1: the back) that shine.
    """
    flux = areas * luminance
    sign = np.where(side == 1, -1.0, 1.0)[:, None]
    origin = corners.mean(axis=(0, 1))
    middle = corners.mean(axis=1) - origin
    extent = float(np.ptp(middle, axis=0).max())
    leaves = 1 << (len(emitter) - 1).bit_length()
    features = np.concatenate([middle[emitter], NORMALS_WEIGHT * extent * sign * normals[emitter]], axis=1)
    order = halved(features, leaves)
    emitter, sign = emitter[order], sign[order]
    bounds = np.arange(leaves + 1) * len(order) // leaves
    full = np.diff(bounds) > 0

    def by_leaf(values: Floats) -> Floats:
        padded = np.zeros((leaves, *values.shape[1:]))
        padded[full] = values
        return padded

    leaf = _Leaves(
        by_leaf(flux[emitter]),
        by_leaf(corners[emitter] - origin),
        by_leaf(sign * normals[emitter]),
    )
    # The root comes second: there is no node 0.
    levels = [_level(leaf, 1 << level) for level in range(leaves.bit_length())]
    centre, shape, axis, vector, variance, moment, places = (
        np.concatenate([values[0][:1], *values]) for values in zip(*levels, strict=True)
    )
    starts = [np.arange(1 << level) * leaves >> level for level in range(leaves.bit_length())]
    first = np.concatenate([[0], *(bounds[start] for start in starts)])
    last = np.concatenate([[0], *(np.append(bounds[start[1:]], bounds[-1]) for start in starts)])

    def by_coordinate(values: Floats) -> Singles:
        return np.ascontiguousarray(values.T.astype(np.float32))

    return LightTree(
        origin,
        emitter,
        corners[emitter] - origin,
        (corners[emitter] - origin).astype(np.float32),
        (sign * normals[emitter]).astype(np.float32),
        luminance[emitter],
        np.concatenate([[0.0], np.cumsum(flux[emitter])]),
        first,
        last,
        np.ascontiguousarray(centre.T),
        by_coordinate(shape),
        by_coordinate(axis),
        by_coordinate(np.concatenate([shape[:, :2], vector, variance, moment, places], axis=1)),
    )


@dataclass(frozen=True, eq=False)
class _Leaves:
    """The lowest nodes: lights in order, with lights of no flux between them.

    Attributes
    ----------
    flux : (leaves,) float
    corners : (leaves, 3, 3) float
    normals : (leaves, 3) float
    """

    flux: Floats
    corners: Floats
    normals: Floats


def _level(leaf: _Leaves, nodes: int) -> tuple[Floats, ...]:
    """Centre, shape, axis, vector, variance, moment and places of the nodes of one level, each (nodes, ...)."""
    each = len(leaf.flux) // nodes
    real = leaf.flux > 0.0

    def total(values: Floats) -> Floats:
        weighted = leaf.flux.reshape(-1, *[1] * (values.ndim - 1)) * values
        result: Floats = weighted.reshape(nodes, each, *values.shape[1:]).sum(axis=1)
        return result

    def largest(values: Floats) -> Floats:
        result: Floats = np.where(real, values, -1.0).reshape(nodes, each).max(axis=1)
        return result

    def own(values: Floats) -> Floats:
        return np.repeat(values, each, axis=0)

    flux = total(np.ones(len(leaf.flux)))
    share = 1.0 / np.maximum(flux, np.finfo(np.float64).tiny)[:, None]
    place = leaf.corners.mean(axis=1)
    centre, vector = total(place) * share, total(leaf.normals)
    axis = normalized(vector)
    off, turn = place - own(centre), leaf.normals - own(vector * share)
    cosine = 1.0 - largest(1.0 - np.einsum("kx,kx->k", leaf.normals, own(axis)))
    # Normals that cancel have no axis.
    cosine = np.where(axis.any(axis=1), cosine, -1.0)
    sine = np.where(cosine < 0.0, 1.0, np.sqrt(np.maximum(1.0 - cosine**2, 0.0)))
    depth = largest(np.abs(np.einsum("kx,kx->k", leaf.normals, off)))
    radius = largest(np.linalg.norm(leaf.corners - own(centre)[:, None], axis=2).max(axis=1))
    variance = total(_products(turn)) * share
    # A triangle reaches as far as its middle and, about that, a twelfth of its corners together (variances).
    within = leaf.corners - place[:, None]
    places = total(_products(off) + _products(within).sum(axis=1) / 12.0) * share
    moment = total((leaf.normals[:, :, None] * off[:, None, :]).reshape(-1, 9))
    shape = np.stack([radius, flux, cosine, sine, depth], axis=1)
    return centre, shape, axis, vector, variance, moment, places


def _products(vectors: Floats) -> Floats:
    """Products of the components of vectors (..., 3) with each other: xx, yy, zz, xy, xz, yz, (..., 6)."""
    x, y, z = np.moveaxis(vectors, -1, 0)
    return np.stack([x * x, y * y, z * z, x * y, x * z, y * z], axis=-1)
