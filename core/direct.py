# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Direct light of emitting triangles: exact form factors times the visible share of what they stand for; and of lamps.

Every receiver point spreads a fixed number of shadow rays over the emitters in proportion to what each would send it
unoccluded. Few emitters are all looked at; of many, see `many_lights`. Lamps have rays of their own, see `lamps`.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property, lru_cache

import numpy as np
from numpy.typing import NDArray

from .direct_light import DirectLight
from .emitting_pieces import emitting_pieces, piece_areas
from .enclosure import enclosed_sides
from .form_factors import above_horizon, heights_of, piece_factor
from .lamps import lamp_light
from .light_tree import LightTree, light_tree
from .lit_points import LitPoints
from .many_lights import light_of_many
from .sampling import LATTICE_ERROR, Singles, hashed, ray_counts, sequence, triangle_lattice
from .scene import LUMINANCE as LUMINANCE
from .scene import UNLINKED, Floats, Ints, Lamp, LightLinking, SunLamp
from .surfaces import Surfaces
from .terminator import arriving
from .visibility import OFFSET, RayScene, spread_of_rays

FEW_EMITTERS = 16
"""Emitters of which each gets a ray of its own beside its share: where nothing is hidden the result is then exact."""

ENCLOSED_CHANCE = 0.3
"""Share of the light of sides that see little but emitters which is taken to get out when shadow rays are shared out.
It is less on average, but some receivers look right into the opening."""

FEWEST_RAYS = 16
"""Rays that the enclosed sides get and the others, if there are as many for all: the hidden part of a few is missed."""

GRAZING = 1e-7
"""Cosine at an emitter below which a receiver lies in its plane, as the emitter's own points do up to rounding: it sees
none of it. Double precision leaves 1e-11 at 10 km from the origin."""

PATTERNS = 16
"""Ways to spread the rays over a triangle, of which a receiver's key chooses one."""

FACTORS_PER_BATCH = 2**14
"""Receiver and emitter pairs whose exact form factors are computed at once: they stay in a core's second cache."""

RAYS_PER_BATCH = 2**15
"""Rays whose places are worked on at once."""


@dataclass(frozen=True, eq=False)
class Emitters:
    """Triangles and lamps whose light is computed explicitly: k triangles, and l lamps with the numbers from k on.

    Attributes
    ----------
    triangle : (k,) int
        Index into the surfaces' triangles, which may have several pieces where their emission varies.
    within : (k, 3, 3) float
        Barycentric coordinates of the piece's corners in it.
    corners : (k, 3, 3) float
    normals : (k, 3) float
    areas : (k,) float
    radiance : (k, 3) float, W m^-2 sr^-1
    one_sided : (k,) bool
        Emitters whose back is dark, and those on solids, whose backs nothing sees.
    enclosed : (k, 2) bool
        Fronts and backs that see little but other emitters.
    linking : tuple of LightLinking
        Those that there are,
    linking_of : (k,) int
        and which of them each triangle has.
    lamps : tuple of Lamp
    """

    triangle: Ints
    within: Floats
    corners: Floats
    normals: Floats
    areas: Floats
    radiance: Floats
    one_sided: NDArray[np.bool_]
    enclosed: NDArray[np.bool_]
    linking: tuple[LightLinking, ...]
    linking_of: Ints
    lamps: tuple[Lamp, ...] = ()

    @cached_property
    def strengths(self) -> Floats:
        """What weights of direct light count by, (k + l, 3): radiance of triangles, strength of lamps."""
        return np.concatenate([self.radiance, *(lamp.strength[None] for lamp in self.lamps)])

    def lamps_alone(self, of_world: bool) -> Floats:
        """The strengths of those lamps that are the world's suns or of those that are not, and 0 for all else."""
        alone = self.strengths.copy()
        chosen = [isinstance(lamp, SunLamp) and lamp.of_world for lamp in self.lamps]
        alone[: len(self.triangle)] = 0.0
        alone[len(self.triangle) :][np.array(chosen, dtype=bool) != of_world] = 0.0
        return alone

    @cached_property
    def trees(self) -> tuple[tuple[LightTree, float], ...]:
        """The sides that shine, put together, and the share of the shadow rays that they get; the enclosed apart."""
        luminance = self.radiance @ LUMINANCE
        shines = np.stack([np.ones(len(luminance), dtype=bool), ~self.one_sided], axis=1) & (luminance > 0.0)[:, None]
        found = []
        for which, chance in ((shines & ~self.enclosed, 1.0), (shines & self.enclosed, ENCLOSED_CHANCE)):
            emitter, side = np.nonzero(which)
            if len(emitter):
                tree = light_tree(self.corners, self.normals, self.areas, luminance, emitter, side)
                found.append((tree, chance * float(tree.flux_before[-1])))
        total = sum(weight for _, weight in found)
        return tuple((tree, weight / total) for tree, weight in found)

    def linked_alone(self) -> Floats:
        """The radiance of those triangles whose light is not for all meshes, and 0 for all else, as `strengths`."""
        alone = np.zeros_like(self.strengths)
        linked = np.array([linking != UNLINKED for linking in self.linking], dtype=bool)
        alone[: len(self.triangle)] = np.where(linked[self.linking_of][:, None], self.radiance, 0.0)
        return alone

    @cached_property
    def linked(self) -> tuple[tuple[LightLinking, Ints, Emitters], ...]:
        """The triangles of each light linking by themselves: their numbers here, and they alone without lamps."""
        if len(self.linking) == 1:
            return ((self.linking[0], np.arange(len(self.triangle)), self),)
        groups = []
        for number, linking in enumerate(self.linking):
            some = np.flatnonzero(self.linking_of == number)
            names = ("triangle", "within", "corners", "normals", "areas", "radiance", "one_sided", "enclosed")
            taken = {name: getattr(self, name)[some] for name in names}
            alone = Emitters(**taken, linking=(linking,), linking_of=np.zeros(len(some), dtype=np.int64))
            groups.append((linking, some, alone))
        return tuple(groups)

    def recoloured(self, surfaces: Surfaces) -> Emitters:
        """The same emitters, with the emission and the lamps that `surfaces` have."""
        return replace(self, radiance=surfaces.emission_over(self.triangle, self.within), lamps=surfaces.lamps)


def all_emitters(surfaces: Surfaces, lit: NDArray[np.bool_], rays: RayScene, seed: int) -> Emitters:
    """All triangles that emit, and all lamps.

    Parameters
    ----------
    lit : (shells, 2) bool
        Sides that light reaches: what emits into the inside of a solid is of no use.
    """
    chosen, within = emitting_pieces(surfaces)
    enclosed = np.zeros((len(chosen), 2), dtype=bool)
    if len(chosen) > FEW_EMITTERS:
        whole, piece_of = np.unique(chosen, return_inverse=True)
        enclosed = enclosed_sides(surfaces, whole, rays, seed)[piece_of]
    linkings = [surfaces.linking[mesh] for mesh in surfaces.mesh_of_triangle[chosen]]
    known = {linking: number for number, linking in enumerate(dict.fromkeys(linkings))}
    return Emitters(
        chosen,
        within,
        np.einsum("kij,kjx->kix", within, surfaces.points[surfaces.triangles[chosen]]),
        surfaces.normals[chosen],
        surfaces.areas[chosen] * piece_areas(within),
        surfaces.emission_over(chosen, within),
        ~lit[surfaces.shell_of_triangle[chosen], 1] | surfaces.front_only[chosen],
        enclosed,
        tuple(known),
        np.array([known[linking] for linking in linkings], dtype=np.int64),
        surfaces.lamps,
    )


def direct_light(
    emitters: Emitters, rays: RayScene, at: LitPoints, shadow_rays: int, seed: int
) -> tuple[DirectLight, Floats]:
    """Direct light at n points.

    Parameters
    ----------
    shadow_rays : int
        Rays each point spreads over all emitters.

    Returns
    -------
    light : DirectLight
    uncertainty : (n,) float, W m^-2 sr^-1
        Standard error of its luminance, were the rays independent: 0 where every emitter is seen whole or not at all.
    """
    scenes = rays.in_channels()
    if len(scenes) == 1:
        return _direct_light(emitters, rays, at, shadow_rays, seed)
    found = [_direct_light(emitters, scene, at, shadow_rays, seed) for scene in scenes]
    coloured = [light.in_channel(k, len(emitters.strengths)) for k, (light, _) in enumerate(found)]
    doubt: Floats = sum(share * error for share, (_, error) in zip(LUMINANCE, found, strict=True))
    return DirectLight.joined(coloured), doubt


def _direct_light(
    emitters: Emitters, rays: RayScene, at: LitPoints, shadow_rays: int, seed: int
) -> tuple[DirectLight, Floats]:
    """Direct light as `direct_light` gives it, of all channels alike."""
    by_triangles, doubt = _direct_of_linked(emitters, rays, at, shadow_rays, seed)
    if not emitters.lamps:
        return by_triangles, doubt
    first, luminance = len(emitters.triangle), emitters.strengths @ LUMINANCE
    by_lamps, more = lamp_light(emitters.lamps, luminance[first:], first, rays, at, shadow_rays, seed)
    return DirectLight.joined([by_triangles, by_lamps]), np.hypot(doubt, more)


def _direct_of_linked(
    emitters: Emitters, rays: RayScene, at: LitPoints, shadow_rays: int, seed: int
) -> tuple[DirectLight, Floats]:
    """What emitting triangles send to the meshes that their light is for."""
    if emitters.linking in ((), (UNLINKED,)):
        return _direct_of_triangles(emitters, rays, at, shadow_rays, seed)
    count = len(at)
    entries, variance = [DirectLight.none(count)], np.zeros(count)
    for linking, chosen, group in emitters.linked:
        hidden_by = rays.hidden_by(linking.blockers)
        if linking.receivers is None:
            light, doubt = _direct_of_triangles(group, hidden_by, at, shadow_rays, seed)
            rows = np.arange(count)
        else:
            rows = np.flatnonzero(np.isin(at.mesh, list(linking.receivers)))
            light, doubt = _direct_of_triangles(group, hidden_by, at.taken(rows), shadow_rays, seed)
            light = light.renumbered(rows, count)
        if len(emitters.linked) > 1:
            light = replace(light, emitter=chosen[light.emitter].astype(np.int32))
        entries.append(light)
        variance[rows] += doubt**2
    return DirectLight.joined(entries), np.sqrt(variance)


def _direct_of_triangles(
    emitters: Emitters, rays: RayScene, at: LitPoints, shadow_rays: int, seed: int
) -> tuple[DirectLight, Floats]:
    """What emitting triangles send, in batches."""
    count = len(at)
    if len(emitters.triangle) == 0 or count == 0:
        return DirectLight.none(count), np.zeros(count)
    size = max(1, RAYS_PER_BATCH // shadow_rays)
    light = _direct_of_many
    if len(emitters.triangle) <= FEW_EMITTERS:
        size = max(1, min(size, FACTORS_PER_BATCH // len(emitters.triangle)))
        light = _direct_of_each
    parts = [
        light(emitters, rays, at.taken(slice(first, first + size)), shadow_rays, seed)
        for first in range(0, count, size)
    ]
    return DirectLight.stacked([part[0] for part in parts]), np.concatenate([part[1] for part in parts])


def _direct_of_each(
    emitters: Emitters, rays: RayScene, at: LitPoints, shadow_rays: int, seed: int
) -> tuple[DirectLight, Floats]:
    """Every emitter's exact form factor times its visible share, for few emitters."""
    points, normals, lift = at.points, at.normals, at.lift
    count = len(points)
    row, emitter = _in_sight(emitters, points, normals)
    axes, up = np.ascontiguousarray(normals.T), np.ascontiguousarray(lift.T)
    corners = emitters.corners.transpose(1, 2, 0).take(emitter, axis=2) - points.T.take(row, axis=1)
    axis = axes.take(row, axis=1)
    owner, pieces = above_horizon(corners, heights_of(corners, axis))
    row, emitter, axis = row[owner], emitter[owner], axis.take(owner, axis=1)
    factor = piece_factor(pieces, axis)
    leaning = np.zeros(len(row), dtype=bool)
    if at.leans:
        # What a smooth shading normal sees below its face is dark, unless the face stands for a surface above it.
        above = heights_of(pieces, up.take(row, axis=1))
        leaning = (np.minimum.reduce(above) < 0.0) | at.bulges[row]
        factor[(np.maximum.reduce(above) <= 0.0) & ~at.bulges[row]] = 0.0
    light = factor * (emitters.radiance @ LUMINANCE)[emitter]
    total = np.bincount(row, weights=light, minlength=count)
    rays_of = ray_counts(shadow_rays * light / np.maximum(total, np.finfo(np.float64).tiny)[row])
    rays_of[factor == 0.0] = 0
    pattern = (hashed(at.keys, 1, seed)[:, 0] * PATTERNS).astype(np.int64)
    origins, back = rays.lifted(points, lift)
    local = pieces * rays.scale + back.T.take(row, axis=1)
    local += _off_plane(pieces[0], emitters.normals.T.take(emitter, axis=1), rays.scale)
    flat = local.astype(np.float32)
    visible, spread = np.zeros(len(row)), np.zeros(len(row))
    for rays_each in np.unique(rays_of[rays_of > 0]):
        same = np.flatnonzero(rays_of == rays_each)
        # Of the same pattern in a row, for one product of matrices each.
        same = same[np.argsort(pattern[row[same]], kind="stable")]
        receiver = row[same]
        toward = _ways(flat.take(same, axis=2), pattern[receiver], int(rays_each), seed)
        if leaning[same].any():
            seen = arriving(rays, at, receiver, origins, toward)
        else:
            seen = rays.visible(origins.take(receiver, axis=0), toward)
        visible[same] = _visible_share(seen, toward, normals, receiver)
        spread[same] = spread_of_rays(seen, visible[same])
    variance = LATTICE_ERROR**2 * spread * np.maximum(rays_of, 1) ** -1.5 * light**2
    uncertainty = np.sqrt(np.bincount(row, weights=variance, minlength=count))
    return DirectLight.of(count, row, emitter, factor * visible), uncertainty


def _direct_of_many(
    emitters: Emitters, rays: RayScene, at: LitPoints, shadow_rays: int, seed: int
) -> tuple[DirectLight, Floats]:
    """What many emitters send unoccluded, times visible shares of parts of them."""
    light, variance = [DirectLight.none(len(at))], np.zeros(len(at))
    for tree, share in emitters.trees:
        some = max(min(FEWEST_RAYS, shadow_rays), round(share * shadow_rays))
        found, error = light_of_many(tree, rays, at, some, seed)
        light.append(found)
        variance += error**2
    return DirectLight.joined(light), np.sqrt(variance)


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


def _visible_share(seen: NDArray[np.bool_] | Singles, toward: Singles, normals: Floats, receiver: Ints) -> Floats:
    """Share of the form factor of triangles that comes through, by rays spread over their area, (p,).

    Parameters
    ----------
    seen : (p, r) bool, or float32 where something lets a part of the light through
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
