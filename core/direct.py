# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Direct light of emitting triangles: exact form factors times the visible share of what they stand for.

Every receiver point spreads a fixed number of shadow rays over the emitters in proportion to what each would send it
unoccluded. An emitter that is due less than one ray is drawn with that probability and weighted by its inverse
(systematic sampling), so thousands of emitters cost no more rays than one and the expectation is exact.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from .direct_light import DirectLight
from .form_factors import above_horizon, heights_of, piece_factor, point_to_triangle
from .sampling import Singles, hashed, sequence, triangle_lattice, triangle_weights
from .scene import Floats, Ints
from .surfaces import Surfaces
from .visibility import OFFSET, RayScene

LUMINANCE = np.array([0.2126, 0.7152, 0.0722])
"""Rec. 709 luminance of linear RGB."""

LARGEST_EMITTER_COUNT = 4096
"""Emitters sampled one by one; the rest, weakest first, are left to the rays that happen to hit them."""

FEW_EMITTERS = 16
"""Emitters of which each gets a ray of its own beside its share: where nothing is hidden the result is then exact."""

GRAZING = 1e-7
"""Cosine at an emitter below which a receiver lies in its plane, as the emitter's own points do up to rounding: it sees
none of it. Double precision leaves 1e-11 at 10 km from the origin."""

NEAR = 4.0
"""Distance, in radii of an emitter, within which its share is computed exactly."""

RAY_COUNTS = np.array([1, 2, 3, *(n << k for k in range(1, 12) for n in (2, 3))])
"""So many rays a part of an emitter may get: all that get the same number can be treated at once."""

PATTERNS = 16
"""Ways to spread the rays over a triangle, of which a receiver's key chooses one."""

LATTICE_ERROR = 0.8
"""Standard error of a share V of a triangle found by n points of a lattice, over sqrt(V (1 - V)) n**-0.75. Shares cut
off by straight lines in any place, found by 8 to 1,024 points, have 0.7 to 0.9 of it (tests/core/test_direct.py)."""

FACTORS_PER_BATCH = 2**14
"""Receiver and emitter pairs whose exact form factors are computed at once: they stay in a core's second cache."""

PAIRS_PER_BATCH = 2**18
"""Receiver and emitter pairs weighed at once: some 50 MB of working arrays for each thread."""


@dataclass(frozen=True, eq=False)
class Emitters:
    """Triangles whose light is computed explicitly.

    Attributes
    ----------
    triangle : (k,) int
        Index into the surfaces' triangles.
    corners : (k, 3, 3) float
    normals : (k, 3) float
    areas : (k,) float
    radiance : (k, 3) float, W m^-2 sr^-1
    one_sided : (k,) bool
        Emitters on solids, whose backs nothing sees.
    """

    triangle: Ints
    corners: Floats
    normals: Floats
    areas: Floats
    radiance: Floats
    one_sided: NDArray[np.bool_]

    def recoloured(self, surfaces: Surfaces) -> Emitters:
        """The same emitters, with the emission that `surfaces` have."""
        return replace(self, radiance=surfaces.emission[self.triangle])


def strongest_emitters(surfaces: Surfaces, lit: NDArray[np.bool_]) -> Emitters:
    """Choose the emitters that rays would sample worst: by area times squared radiance, as their variance goes.

    Parameters
    ----------
    lit : (shells, 2) bool
        Sides that light reaches: what emits into the inside of a solid is of no use.
    """
    luminance = surfaces.emission @ LUMINANCE
    weight = surfaces.areas * luminance**2
    count = min(int((weight > 0.0).sum()), LARGEST_EMITTER_COUNT)
    chosen = np.sort(np.argsort(-weight, kind="stable")[:count])
    return Emitters(
        chosen,
        surfaces.points[surfaces.triangles[chosen]],
        surfaces.normals[chosen],
        surfaces.areas[chosen],
        surfaces.emission[chosen],
        ~lit[surfaces.shell_of_triangle[chosen], 1],
    )


def direct_light(
    emitters: Emitters,
    rays: RayScene,
    points: Floats,
    normals: Floats,
    lift: Floats,
    keys: Ints,
    shadow_rays: int,
    seed: int,
    neighbours: int = 1,
) -> tuple[DirectLight, Floats]:
    """Direct light at points.

    Parameters
    ----------
    points, normals : (n, 3) float
        Receivers and the axes of their hemispheres.
    lift : (n, 3) float
        The side of the true surface that shadow rays start on.
    keys : (n,) int
        Numbers of the receivers, for their sampling patterns.
    shadow_rays : int
        Rays each receiver spreads over all emitters.
    neighbours : int
        So many points in a row lie close together on a plane: what to expect of the emitters is found for all at once.

    Returns
    -------
    light : DirectLight
    uncertainty : (n,) float, W m^-2 sr^-1
        Standard error of its luminance, were the rays independent: 0 where every emitter is seen whole or not at all.
    """
    count = len(points)
    if len(emitters.triangle) == 0 or count == 0:
        return DirectLight.none(count), np.zeros(count)
    few = len(emitters.triangle) <= FEW_EMITTERS
    if few:
        size = max(1, min(FACTORS_PER_BATCH // len(emitters.triangle), PAIRS_PER_BATCH // shadow_rays))
    else:
        size = neighbours * max(1, PAIRS_PER_BATCH // max(len(emitters.triangle), neighbours * shadow_rays))
    parts = []
    for first in range(0, count, size):
        part = slice(first, first + size)
        axes = normals[part]
        up = axes if lift is normals else lift[part]
        if few:
            found = _direct_of_each(emitters, rays, points[part], axes, up, keys[part], shadow_rays, seed)
        else:
            found = _direct_part(emitters, rays, points[part], axes, up, keys[part], shadow_rays, seed, neighbours)
        parts.append(found)
    return DirectLight.stacked([part[0] for part in parts]), np.concatenate([part[1] for part in parts])


def _direct_of_each(
    emitters: Emitters,
    rays: RayScene,
    points: Floats,
    normals: Floats,
    lift: Floats,
    keys: Ints,
    shadow_rays: int,
    seed: int,
) -> tuple[DirectLight, Floats]:
    """Every emitter's exact form factor times its visible share, for few emitters."""
    count = len(points)
    row, emitter = _in_sight(emitters, points, normals)
    axes, up = np.ascontiguousarray(normals.T), np.ascontiguousarray(lift.T)
    corners = emitters.corners.transpose(1, 2, 0).take(emitter, axis=2) - points.T.take(row, axis=1)
    axis = axes.take(row, axis=1)
    owner, pieces = above_horizon(corners, heights_of(corners, axis))
    row, emitter, axis = row[owner], emitter[owner], axis.take(owner, axis=1)
    factor = piece_factor(pieces, axis)
    leaning = np.zeros(len(row), dtype=bool)
    if lift is not normals:
        # What a smooth shading normal sees below its face is dark.
        above = heights_of(pieces, up.take(row, axis=1))
        leaning = np.minimum.reduce(above) < 0.0
        factor[np.maximum.reduce(above) <= 0.0] = 0.0
    light = factor * (emitters.radiance @ LUMINANCE)[emitter]
    total = np.bincount(row, weights=light, minlength=count)
    rays_of = _ray_counts(shadow_rays * light / np.maximum(total, np.finfo(np.float64).tiny)[row])
    rays_of[factor == 0.0] = 0
    pattern = (hashed(keys, 1, seed)[:, 0] * PATTERNS).astype(np.int64)
    origins, back = rays.lifted(points, lift)
    local = pieces * rays.scale + back.T.take(row, axis=1)
    local += _off_plane(pieces[0], emitters.normals.T.take(emitter, axis=1), rays.scale)
    flat = local.astype(np.float32)
    visible = np.zeros(len(row))
    for rays_each in np.unique(rays_of[rays_of > 0]):
        same = np.flatnonzero(rays_of == rays_each)
        # Of the same pattern in a row, for one product of matrices each.
        same = same[np.argsort(pattern[row[same]], kind="stable")]
        at = row[same]
        toward = _ways(flat.take(same, axis=2), pattern[at], int(rays_each), seed)
        seen = rays.visible(origins.take(at, axis=0), toward)
        low = np.flatnonzero(leaning[same])
        seen[low] &= np.einsum("prx,px->pr", toward[low], lift[at[low]]) > -OFFSET
        visible[same] = _visible_share(seen, toward, normals, at)
    variance = LATTICE_ERROR**2 * visible * (1.0 - visible) * np.maximum(rays_of, 1) ** -1.5 * light**2
    uncertainty = np.sqrt(np.bincount(row, weights=variance, minlength=count))
    return DirectLight.of(count, row, emitter, factor * visible), uncertainty


def _in_sight(emitters: Emitters, points: Floats, normals: Floats) -> tuple[Ints, Ints]:
    """Pairs of a receiver and an emitter that is not wholly below its horizon, nor turned away; by receivers."""
    # About their middle, as products of large coordinates cancel.
    origin = emitters.corners.mean(axis=(0, 1))
    corners, at = emitters.corners - origin, points - origin
    highest = np.maximum.reduce([normals @ corners[:, k].T for k in range(3)])
    level = np.einsum("nx,nx->n", normals, at)[:, None]
    facing = at @ emitters.normals.T - np.einsum("kx,kx->k", corners[:, 0], emitters.normals)
    facing = np.where(emitters.one_sided, facing, np.abs(facing))
    first = corners[:, 0]
    square = (at**2).sum(axis=1)[:, None] + (first**2).sum(axis=1) - 2.0 * (at @ first.T)
    size = np.linalg.norm(corners - first[:, None], axis=2).max(axis=1)
    reach = np.sqrt(np.maximum(square, 0.0)) + size
    row, emitter = np.nonzero((highest > level) & (facing > GRAZING * reach))
    return row, emitter


def _off_plane(way: Floats, normals: Floats, scale: float) -> Floats:
    """How far targets are lifted off their emitters towards the receivers, (3, p), local units.

    Parameters
    ----------
    way : (3, p) float, scene units
        From receivers to a place in the emitters' planes.
    normals : (3, p) float
        Of the emitters.
    """
    facing = -(way * normals).sum(axis=0) * scale
    return np.clip(facing / 2.0, -OFFSET, OFFSET) * normals


def _ray_counts(wanted: Floats) -> Ints:
    """Those of `RAY_COUNTS` that are nearest in ratio to the numbers wanted."""
    counts: Ints = RAY_COUNTS[np.searchsorted(np.sqrt(RAY_COUNTS[1:] * RAY_COUNTS[:-1]), wanted)]
    return counts


def _ways(corners: Singles, pattern: Ints, rays: int, seed: int) -> Singles:
    """From receivers to points spread over triangles (3, 3, p), by patterns in ascending order: (p, rays, 3)."""
    ways = np.empty((len(pattern), 3 * rays), np.float32)
    flat = corners.reshape(9, -1)
    start = np.searchsorted(pattern, np.arange(PATTERNS + 1))
    for k in np.flatnonzero(np.diff(start)):
        part = slice(start[k], start[k + 1])
        np.matmul(flat[:, part].T, _spread(rays, int(k), seed), out=ways[part])
    return ways.reshape(-1, rays, 3)


@lru_cache(256)
def _spread(rays: int, pattern: int, seed: int) -> Singles:
    """The matrix that makes nine coordinates of a triangle's corners into three of each ray's target, (9, 3 * rays)."""
    shift = np.mod(hashed(np.zeros(1, dtype=np.int64), 2, seed)[0] + sequence(pattern, 1, 2)[0], 1.0)
    return np.kron(triangle_lattice(rays, shift).T, np.eye(3)).astype(np.float32)


def _visible_share(seen: NDArray[np.bool_], toward: Singles, normals: Floats, receiver: Ints) -> Floats:
    """Share of the form factor of triangles that comes through, by rays spread over their area, (p,).

    Parameters
    ----------
    seen : (p, r) bool
    toward : (p, r, 3) float32
        From the receiver to the point that the ray asks for.
    normals : (n, 3) float
    receiver : (p,) int
    """
    count = seen.astype(np.float32) @ np.ones(seen.shape[1], dtype=np.float32)
    share = np.minimum(count, 1.0).astype(np.float64)
    partly = np.flatnonzero((count > 0.0) & (count < seen.shape[1]))
    ways = toward[partly]
    square = np.einsum("prx,prx->pr", ways, ways)
    # The cosine at the emitter is its plane's distance over the ray's length: of one triangle it counts by length only.
    cosine = np.maximum(np.einsum("prx,px->pr", ways, normals[receiver[partly]].astype(np.float32)), 0.0)
    kernel = cosine / np.maximum(square * square, np.finfo(np.float32).tiny)
    share[partly] = (kernel * seen[partly]).sum(axis=1) / np.maximum(kernel.sum(axis=1), np.finfo(np.float32).tiny)
    return share


def _direct_part(
    emitters: Emitters,
    rays: RayScene,
    points: Floats,
    normals: Floats,
    lift: Floats,
    keys: Ints,
    shadow_rays: int,
    seed: int,
    neighbours: int,
) -> tuple[DirectLight, Floats]:
    together = points.reshape(-1, neighbours, 3)
    centre = together.mean(axis=1)
    spread = np.linalg.norm(together - centre[:, None], axis=2).max(axis=1)
    share = _expected_shares(emitters, centre, normals[::neighbours], spread)
    group = np.repeat(np.arange(len(centre)), neighbours)
    lit = np.flatnonzero(share.any(axis=1)[group])
    count = len(points)
    uncertainty = np.zeros(count)
    if len(lit) == 0:
        return DirectLight.none(count), uncertainty
    points, normals, lift, group = points[lit], normals[lit], lift[lit], group[lit]
    shift = hashed(keys[lit], 3, seed)
    emitter = _systematic_draw(share, group, shadow_rays, shift[:, 2])
    all_once = share.shape[1] <= FEW_EMITTERS
    drawn_rays = shadow_rays
    if all_once:
        everyone = np.broadcast_to(np.arange(share.shape[1]), (len(lit), share.shape[1]))
        emitter = np.sort(np.concatenate([emitter, everyone], axis=1), axis=1)
        shadow_rays += share.shape[1]

    flat_emitter = emitter.ravel()
    receiver = np.repeat(np.arange(len(lit)), shadow_rays)
    square = np.mod(sequence(0, shadow_rays, 2)[None] + shift[:, None, :2], 1.0).reshape(-1, 2)
    target = _points_on(emitters.corners[flat_emitter], triangle_weights(square))
    kernel = _kernel(points[receiver], normals[receiver], target, emitters, flat_emitter)
    # What a smooth shading normal sees below its face is in the form factor, and dark.
    above = np.einsum("mx,mx->m", target - points[receiver], lift[receiver]) > 0.0
    ask = np.flatnonzero((kernel > 0.0) & above)
    seen = np.zeros(len(kernel))
    start, back = rays.lifted(points[receiver[ask]], lift[receiver[ask]])
    way = target[ask] - points[receiver[ask]]
    local = way * rays.scale + back + _off_plane(way.T, emitters.normals[flat_emitter[ask]].T, rays.scale).T
    seen[ask] = rays.visible(start, local.astype(np.float32)[:, None])[:, 0]

    starts = np.flatnonzero(np.diff(receiver * np.int64(len(share[0])) + flat_emitter, prepend=-1))
    weight = np.add.reduceat(kernel, starts)
    visible = np.add.reduceat(kernel * seen, starts)
    visible = np.divide(visible, weight, out=np.zeros_like(visible), where=weight > 0.0)
    row, chosen = receiver[starts], flat_emitter[starts]
    factor = point_to_triangle(points[row], normals[row], emitters.corners[chosen])
    probability = np.ones(len(row)) if all_once else np.minimum(1.0, share[group[row], chosen] * drawn_rays)
    light_of = factor * (emitters.radiance[chosen] @ LUMINANCE)
    # Of the visible share among the rays of an emitter, and of emitters drawn by chance.
    rays_of = np.diff(np.append(starts, len(kernel)))
    variance = (visible * (1.0 - visible) / rays_of + visible**2 * (1.0 - probability)) * (light_of / probability) ** 2
    uncertainty[lit] = np.sqrt(np.bincount(row, weights=variance, minlength=len(lit)))
    return DirectLight.of(count, lit[row], chosen, factor * visible / probability), uncertainty


def _expected_shares(emitters: Emitters, points: Floats, normals: Floats, spread: Floats) -> Floats:
    """Each emitter's share of the unoccluded direct light about each point, (n, k); 0 where it surely sends none.

    Far emitters are taken as points at their centres, near ones by their exact form factor: a wall that glows beside
    the point may be most of what it sees, and its centre seen edge on. In single precision: these are only chances.

    Parameters
    ----------
    spread : (n,) float
        Receivers lie within this distance of the point, in its plane.
    """
    origin = emitters.corners.mean(axis=(0, 1))
    centres = emitters.corners.mean(axis=1) - origin
    radius = np.linalg.norm(emitters.corners - origin - centres[:, None], axis=2).max(axis=1).astype(np.float32)
    centre, at, axis = centres.astype(np.float32), (points - origin).astype(np.float32), normals.astype(np.float32)
    room = spread.astype(np.float32)[:, None]
    square = (at**2).sum(axis=1)[:, None] + (centre**2).sum(axis=1) - 2.0 * (at @ centre.T)
    np.maximum(square, np.finfo(np.float32).tiny, out=square)
    # Near the horizon the highest point of the emitter counts as well: one that only peeks over it is not forgotten.
    height = axis @ centre.T - (axis * at).sum(axis=1)[:, None]
    height = np.where(height > radius, height, (height + radius) / 2.0)
    facing = at @ emitters.normals.T.astype(np.float32) - (centre * emitters.normals).sum(axis=1).astype(np.float32)
    facing = np.where(emitters.one_sided, facing, np.abs(facing)) + room
    possible = (height > 0.0) & (facing > 0.0)
    areas = emitters.areas.astype(np.float32)
    distance = np.sqrt(square)
    value = np.minimum(height / distance, 1.0) * np.minimum(facing / distance, 1.0) * (areas / (square + areas))
    value[~possible] = 0.0
    row, near = np.nonzero(possible & (square < (NEAR * radius) ** 2))
    exact = np.pi * point_to_triangle(points[row], normals[row], emitters.corners[near])
    # Where receivers are spread about the point, one may see what the point does not.
    value[row, near] = exact + np.where(spread[row] > 0.0, 0.1, 0.0) * value[row, near]
    value *= (emitters.radiance @ LUMINANCE).astype(np.float32)
    total = value.sum(axis=1, keepdims=True)
    share: Floats = np.divide(value, total, out=np.zeros_like(value), where=total > 0.0)
    return share


def _systematic_draw(share: Floats, group: Ints, draws: int, offset: Floats) -> Ints:
    """Draw emitters in proportion to shares (g, k) at equal steps from a random start; sorted.

    Parameters
    ----------
    group : (n,) int
        The row of `share` each receiver draws from.
    offset : (n,) float, 0..1

    Returns
    -------
    (n, draws) int
    """
    emitters = share.shape[1]
    cumulative = np.cumsum(share, axis=1, dtype=np.float64)
    last = np.maximum(cumulative[:, -1:], np.finfo(np.float64).tiny)
    cumulative = cumulative / last + np.arange(len(share))[:, None]
    step = (np.arange(draws) + offset[:, None]) / draws + group[:, None]
    found = np.searchsorted(cumulative.ravel(), step.ravel(), side="right").reshape(len(group), draws)
    drawn = np.clip(found - group[:, None] * emitters, 0, emitters - 1)
    # Rounding may land on a neighbour without a share; take the likeliest instead.
    empty = share[group[:, None], drawn] <= 0.0
    return np.where(empty, np.argmax(share, axis=1)[group][:, None], drawn) if empty.any() else drawn


def _points_on(corners: Floats, weights: Floats) -> Floats:
    u, v = weights[:, :1], weights[:, 1:]
    return corners[:, 0] * (1.0 - u - v) + corners[:, 1] * u + corners[:, 2] * v


def _kernel(points: Floats, normals: Floats, target: Floats, emitters: Emitters, chosen: Ints) -> NDArray[np.float64]:
    """cos cos / r^2 between receivers and points on emitters, 0 below a horizon, (m,)."""
    toward = target - points
    square = np.einsum("mx,mx->m", toward, toward)
    cosine = np.maximum(np.einsum("mx,mx->m", toward, normals), 0.0)
    facing = -np.einsum("mx,mx->m", toward, emitters.normals[chosen])
    facing = np.where(emitters.one_sided[chosen], np.maximum(facing, 0.0), np.abs(facing))
    facing[facing <= GRAZING * np.sqrt(square)] = 0.0
    value: Floats = cosine * facing / np.maximum(square * square, np.finfo(np.float64).tiny)
    return value
