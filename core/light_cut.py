# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Where groups of receivers cut a tree of lights, and what they get of its nodes unoccluded.

Each group cuts the tree where a node is exact enough for all of the group, so what a receiver costs does not grow with
the number of emitters.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from .geometry import normalized
from .light_tree import LightTree
from .sampling import Singles
from .scene import Floats, Ints

TOLERANCE = 0.005
"""Doubt about a node, relative to the light of all, up to which it is not split. What all nodes together are off by is
less than that, RMS over receivers (tests/core/test_light_tree.py)."""

LARGEST_ANGLE = 0.25
"""Radius over distance above which no node is taken as a whole."""

CURVATURE = 2.0
"""Relative error of a node's light over the square of the angle that it is seen at."""

STRADDLING = 0.1
"""Share of the spread of cosines, or of heights, over a node that is in doubt while a part of it may be turned away."""

SPREAD = 0.6
"""Half the spread of heights over a node, in its radii, were they even."""

GRAZING = 1e-6
"""Cosine at a light below which a receiver lies in its plane, in single precision."""

TINY = np.finfo(np.float32).tiny


@dataclass(frozen=True, eq=False)
class Cut:
    """Nodes that together hold all light that groups of receivers can get, by groups and the order of lights.

    Attributes
    ----------
    group, node : (m,) int
    light : (size, m) float32
        What each receiver of the group gets of the node unoccluded: irradiance over pi, in luminance.
    rough : (m,) bool
        Nodes of one light that are so near to the group that this may be off.
    """

    group: Ints
    node: Ints
    light: Singles
    rough: NDArray[np.bool_] = field(default_factory=lambda: np.zeros(0, dtype=bool))


def cut(tree: LightTree, points: Floats, normals: Floats) -> Cut:
    """Cut the tree for groups of receivers.

    Parameters
    ----------
    points : (g, size, 3) float, scene units
    normals : (g, size, 3) float
    """
    groups = _Groups.of(points - tree.origin, normals)
    count = len(points)
    settled = np.zeros(count)
    group, node = np.arange(count), np.ones(count, dtype=np.int64)
    kept: list[tuple[Ints, Ints, NDArray[np.bool_]]] = []
    while len(group):
        way = groups.way(tree, group, node)
        axis = groups.axis.take(group, axis=1)
        light = _light(tree.sums.take(node, axis=1), way, axis)
        doubt = _doubt(tree, node, way, axis, groups.shape.take(group, axis=1))
        total = settled + np.bincount(group, weights=light, minlength=count)
        fine, dark = doubt <= TOLERANCE * total[group], doubt <= 0.0
        done = ~dark & (fine | (tree.last[node] - tree.first[node] <= 1))
        keep, split = np.flatnonzero(done), np.flatnonzero(~(done | dark))
        kept.append((group[keep], node[keep], ~fine[keep]))
        settled += np.bincount(group[keep], weights=light[keep], minlength=count)
        group = np.repeat(group[split], 2)
        node = np.repeat(2 * node[split], 2)
        node[1::2] += 1
    group, node, rough = (np.concatenate([k[i] for k in kept]) for i in range(3))
    order = np.lexsort((tree.first[node], group))
    group, node = group[order], node[order]
    way = groups.way(tree, group, node)
    light, sums = np.empty((points.shape[1], len(node)), dtype=np.float32), tree.sums.take(node, axis=1)
    for k in range(len(light)):
        light[k] = _light(sums, way - groups.off[k].take(group, axis=1), groups.normals[k].take(group, axis=1))
    return Cut(group, node, light, rough[order])


@dataclass(frozen=True, eq=False)
class _Groups:
    """What groups of receivers have in common.

    Attributes
    ----------
    middle : (3, g) float
    axis : (3, g) float32
        Mean normal.
    shape : (4, g) float32
        Radius about the middle, cosine and sine of the largest angle between a normal and the axis, and the largest
        distance of the middle from a receiver's plane.
    off, normals : (size, 3, g) float32
        From the middle to each receiver, and its normal.
    """

    middle: Floats
    axis: Singles
    shape: Singles
    off: Singles
    normals: Singles

    @staticmethod
    def of(points: Floats, normals: Floats) -> _Groups:
        """Of points and normals (g, size, 3)."""
        middle = points.mean(axis=1)
        off = points - middle[:, None]
        axis = normalized(normals.sum(axis=1))
        cosine = np.where(axis.any(axis=1), np.einsum("gkx,gx->gk", normals, axis).min(axis=1), -1.0)
        sine = np.where(cosine < 0.0, 1.0, np.sqrt(np.maximum(1.0 - cosine**2, 0.0)))
        depth = np.abs(np.einsum("gkx,gkx->gk", normals, off)).max(axis=1)
        radius = np.linalg.norm(off, axis=2).max(axis=1)
        return _Groups(
            np.ascontiguousarray(middle.T),
            np.ascontiguousarray(axis.T.astype(np.float32)),
            np.stack([radius, cosine, sine, depth]).astype(np.float32),
            np.ascontiguousarray(off.transpose(1, 2, 0).astype(np.float32)),
            np.ascontiguousarray(normals.transpose(1, 2, 0).astype(np.float32)),
        )

    def way(self, tree: LightTree, group: Ints, node: Ints) -> Singles:
        """From the middles of groups to the centres of nodes, (3, m)."""
        way: Singles = (tree.centre.take(node, axis=1) - self.middle.take(group, axis=1)).astype(np.float32)
        return way


def _light(sums: Singles, way: Singles, normals: Singles) -> Singles:
    """What receivers get of nodes unoccluded, in luminance, (m,).

    With a light's normal n_e and its place c + d about the node's centre, and w = c - x, each light gives
    f (n_e . (x - c - d)) (n . (c + d - x)) / (pi |c + d - x|^4); the sum over lights is taken to the second order in d,
    whose second moments are taken to be the same for all normals. Their part is negative on average in a closed room,
    and bounces would add up what leaving it out is off by. Where some lights may be turned away, or be below the
    horizon, it is that of evenly spread cosines and heights.

    Parameters
    ----------
    sums : (26, m) float32
        Those of the nodes.
    way, normals : (3, m) float32
        From receivers to the nodes' centres, and the receivers' normals.
    """
    x, y, z = way
    nx, ny, nz = normals
    radius, flux, vx, vy, vz, xx, yy, zz, xy, xz, yz = sums[:11]
    t, c = sums[11:20], sums[20:]
    square = np.maximum(x * x + y * y + z * z, TINY)
    height = x * nx + y * ny + z * nz
    variance = x * x * xx + y * y * yy + z * z * zz + 2.0 * (x * (y * xy + z * xz) + y * z * yz)
    facing, width = -(x * vx + y * vy + z * vz), np.sqrt(3.0 * np.maximum(variance, 0.0)) * flux
    margin = SPREAD * radius
    light = _positive(facing, width) * _positive(height, margin)
    tx, ty, tz = (x * t[k] + y * t[3 + k] + z * t[6 + k] for k in range(3))
    first_order = height * (4.0 * (tx * x + ty * y + tz * z) / square - (t[0] + t[4] + t[8]))
    first_order -= tx * nx + ty * ny + tz * nz
    # The covariance of the places times the way: how much they reach along it, and across.
    cx, cy, cz = x * c[0] + y * c[3] + z * c[4], x * c[3] + y * c[1] + z * c[5], x * c[4] + y * c[5] + z * c[2]
    along = (cx * x + cy * y + cz * z) / square
    bent = nx * (vx * c[0] + vy * c[3] + vz * c[4]) + ny * (vx * c[3] + vy * c[1] + vz * c[5])
    bent += nz * (vx * c[4] + vy * c[5] + vz * c[2])
    turned = facing * (nx * cx + ny * cy + nz * cz) - height * (vx * cx + vy * cy + vz * cz)
    second_order = (height * facing * (12.0 * along - 2.0 * (c[0] + c[1] + c[2])) - 4.0 * turned) / square - bent
    near = radius * radius > LARGEST_ANGLE**2 * square
    light += (first_order + second_order) * ((facing > width) & (height > margin) & ~near)
    # Close by, the light is limited as by a disk of the node's size.
    limited = np.where(near, square + radius * radius, square)
    result: Singles = np.maximum(light, 0.0) / (np.float32(np.pi) * limited * limited)
    return result


def _doubt(tree: LightTree, node: Ints, way: Singles, normals: Singles, group: Singles) -> Singles:
    """How far off the light of nodes may be for any receiver of a group, (m,); 0 where they surely give none."""
    x, y, z = way
    spread, normal_cosine, normal_sine, offset = group
    radius, flux, cosine, sine, depth = tree.shape.take(node, axis=1)
    far = np.sqrt(x * x + y * y + z * z)
    highest, lowest = _within_cone(x * normals[0] + y * normals[1] + z * normals[2], far, normal_cosine, normal_sine)
    ax, ay, az = tree.axis.take(node, axis=1)
    most, least = _within_cone(-(x * ax + y * ay + z * az), far, cosine, sine)
    # Receivers of one plane that lights lie in are all in it.
    across = ax * normals[0] + ay * normals[1] + az * normals[2]
    shift = spread * np.minimum(np.sqrt(np.maximum(1.0 - across * across, 0.0)) + sine + normal_sine, 1.0) + offset
    highest, lowest = np.minimum(highest + offset + radius, far), lowest - offset - radius
    most, least = np.minimum(most + depth + shift, far), least - depth - shift
    near = np.maximum(far - spread, 0.0)
    angle = radius / np.maximum(np.maximum(near, radius), TINY)
    closest = np.maximum(near * near, np.sqrt(TINY))
    doubt = most * highest * CURVATURE * angle * angle
    doubt += (STRADDLING + angle) * near * sine * highest * (least < 0.0)
    doubt += STRADDLING * radius * most * (lowest < 0.0)
    result: Singles = flux * doubt / (np.float32(np.pi) * closest) / closest
    result[angle > LARGEST_ANGLE] = np.inf
    result[(highest <= 0.0) | (most <= GRAZING * far)] = 0.0
    return result


def _within_cone(along: Singles, length: Singles, cosine: Singles, sine: Singles) -> tuple[Singles, Singles]:
    """The most and the least of a vector along any axis of a cone, from what it is along the middle one."""
    aside = np.sqrt(np.maximum(length * length - along * along, 0.0)) * sine
    inner = along * cosine
    most: Singles = np.where(along >= cosine * length, length, inner + aside)
    least: Singles = np.where(along <= -cosine * length, -length, inner - aside)
    return most, least


def _positive(value: Singles, spread: Singles) -> Singles:
    """The mean of what is positive of values spread evenly about `value`, so far to each side."""
    inside = np.clip(value, -spread, spread) + spread
    result: Singles = inside * inside / np.maximum(4.0 * spread, TINY)
    result += np.maximum(value, spread) - spread
    return result
