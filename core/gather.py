# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The final gather: irradiance at receivers from the solved radiosity and, explicitly, from the emitters."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .aimed_light import AimedLight
from .bright_places import BrightPlaces, aimed_light, most_of_aimed
from .cells import BELOW, Cells, Radiance
from .direct import LUMINANCE, Emitters, direct_light
from .direct_light import DirectLight
from .geometry import order_along_curve
from .met_places import MetPlaces, MetTable, weighted
from .receivers import Receivers, taken_of_two
from .rows import COVER_GAP, ESCAPED
from .sampling import LATTICE_FALL, Singles, even_chances, frames, hemisphere_lattice
from .scene import Floats, Ints
from .transport import Transport
from .visibility import OFFSET, Hits, RayScene
from .workers import Workers
from .world import map_cells

LEAST_COVERED_SHARE = 0.9
"""A receiver is covered when more of its rays than this end within `COVER_GAP` of its faces' size."""

LEAST_VALID_SHARE = 0.9
"""A receiver is buried when fewer of its rays than this left it outside a solid; from an outside point all do. Inside a
cupboard that stands against a wall, many rays seem to: they meet the wall where it lies in the plane of the back."""

MOST_DOUBLINGS = 4
"""Times that the hemisphere rays are doubled at most."""

NOISY = 2.0**0.25
"""Times the noise asked for from which on rays are doubled: between none and one time of the slowest fall there is."""

FASTEST_FALL = 0.75
"""Noise falls as a power of the rays: 1/2 where they were random, this for an even pattern and edges."""

ROUGH, FEWEST_ROUGH = 8, 32
"""Times fewer rays that only look for what is far off, and how many there are over the hemisphere at least."""

MORE_RECEIVERS = 8
"""Times more receivers than patches have corners that there shall be room for."""

SMALLER_FOR_CUTS = 8.0
"""Times that faces may be smaller than others where an outline crosses them. What covers a place must not depend on it:
at the rim of a lamp a millimetre under a ceiling, the light in the gap would show there alone."""

TOUCHING = 1e-2
"""Share of the size of the smallest face within which rays end where something stands on a place's very edge, and"""

LEAST_TOUCHING_SHARE = 0.15
"""share of the rays of a place that end there: at the foot of a wall half of them do, at that of a pillar's corner a
quarter."""

IN_PLANE = 1e-6
"""Distance, in units of the scene's extent, up to which a ray has met the plane that it began in: rounding alone."""

UPRIGHT = 0.5
"""Cosine of the angle to the surface up to which what stands on it is no cover of it."""

FLAT = 1e-5
"""Difference between the shading normal and the surface's own below which no ray starts under the surface."""


@dataclass(frozen=True)
class GatherRays:
    """Rays of each receiver.

    Attributes
    ----------
    hemisphere : int
        Rays that look up the radiosity of the surfaces around.
    noise : float
        Standard error of the light that they bring, relative to the mean, above which there are more of them.
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
    noise: float
    shadow: int
    penumbra: int
    deep: int
    tolerance: float


@dataclass(frozen=True, eq=False)
class Gathered:
    """Irradiance at receivers.

    Attributes
    ----------
    irradiance : (n, 3) float, W m^-2 sr^-1
        Irradiance over pi.
    direct : DirectLight
        Where the part of it that comes from the emitters comes from, and
    direct_irradiance : (n, 3) float, W m^-2 sr^-1
        how much it is.
    noise : (n,) float
        Standard error of its luminance, from two halves of the rays.
    hidden : (n,) bool
        Receivers that nothing but what hides them can see: inside a solid, or covered so closely.
    touching : (n,) bool
        Receivers on the outline of what stands there: their light is that of neither side.
    free : (n,) float, scene units
        The shortest way of their rays: nothing that these find is nearer.
    places : MetPlaces
        What the rays met, to look it up again.
    """

    irradiance: Floats
    direct: DirectLight
    direct_irradiance: Floats
    noise: Floats
    hidden: NDArray[np.bool_]
    touching: NDArray[np.bool_]
    free: Floats
    places: MetPlaces

    @staticmethod
    def none(rays: int) -> Gathered:
        """At no receiver."""
        return Gathered.without_light(0, MetPlaces.of(MetTable.of(np.zeros((0, rays), np.int32))), hidden=False)

    @staticmethod
    def dark(count: int, rays: int) -> Gathered:
        """At so many receivers that see nothing."""
        table = MetTable.of(np.full((1, rays), BELOW, dtype=np.int32))
        return Gathered.without_light(count, MetPlaces.of_rows((table,), np.zeros(count, np.int64), rays), hidden=True)

    @staticmethod
    def without_light(count: int, places: MetPlaces, hidden: bool) -> Gathered:
        """No light at so many receivers, all hidden or none, whose rays met `places`."""
        dark, nothing, no = np.zeros((count, 3)), np.zeros(count), np.zeros(count, dtype=bool)
        return Gathered(dark, DirectLight.none(count), dark, nothing, no | hidden, no, nothing, places)

    def with_indirect(self, indirect: Gathered) -> Gathered:
        """The same direct light, with other indirect light."""
        direct, light = self.direct, self.direct_irradiance
        return replace(indirect, irradiance=indirect.irradiance + light, direct=direct, direct_irradiance=light)

    def taken(self, which: Ints) -> Gathered:
        """At some of the receivers, each at most once."""
        return self.joined(Gathered.none(self.places.rays), which)

    def joined(self, others: Gathered, which: Ints) -> Gathered:
        """At some of these receivers and of others, which are counted on from these; each at most once."""
        own = len(self.noise)
        number = np.full(own + len(others.noise), -1, dtype=np.int64)
        number[which] = np.arange(len(which))
        direct = [self.direct.renumbered(number[:own], len(which)), others.direct.renumbered(number[own:], len(which))]
        return Gathered(
            taken_of_two(self.irradiance, others.irradiance, which),
            DirectLight.joined(direct),
            taken_of_two(self.direct_irradiance, others.direct_irradiance, which),
            taken_of_two(self.noise, others.noise, which),
            taken_of_two(self.hidden, others.hidden, which),
            taken_of_two(self.touching, others.touching, which),
            taken_of_two(self.free, others.free, which),
            self.places.joined(others.places).taken(which),
        )

    def with_more(self, taken: Ints, more: Gathered, rows: Ints) -> Gathered:
        """Those of `taken`, of which `rows` are replaced by `more`."""

        def merged(ours: Any, theirs: Any) -> Any:
            values = ours[taken]
            values[rows] = theirs
            return values

        return Gathered(
            merged(self.irradiance, more.irradiance),
            self.direct.with_more(taken, more.direct, rows),
            merged(self.direct_irradiance, more.direct_irradiance),
            merged(self.noise, more.noise),
            merged(self.hidden, more.hidden),
            merged(self.touching, more.touching),
            merged(self.free, more.free),
            self.places.with_more(taken, more.places, rows),
        )


@dataclass(frozen=True, eq=False)
class Mixture:
    """Receivers whose indirect light is a mean of what was gathered at others.

    Attributes
    ----------
    which : (m,) int
        The receivers.
    known : Gathered
        At the others.
    parents : (m, k) int
        Of those, and
    weights : (m, k) float
        by how much each counts.
    """

    which: Ints
    known: Gathered
    parents: Ints
    weights: Floats | Singles

    def others(self, count: int) -> Ints:
        """Those of so many receivers that are no mixtures."""
        own = np.ones(count, dtype=bool)
        own[self.which] = False
        return np.flatnonzero(own)

    def with_others(self, gathered: Gathered) -> Gathered:
        """The indirect light of all receivers, of which that of `others` was gathered."""
        count = len(self.which) + len(gathered.noise)
        number = np.empty(count, dtype=np.int64)
        number[self.which] = np.arange(len(self.which))
        number[self.others(count)] = len(self.which) + np.arange(len(gathered.noise))
        return self._mixed().joined(gathered, number)

    def _mixed(self) -> Gathered:
        known, count = self.known, len(self.which)
        places = known.places.mixed(self.parents, self.weights)
        return replace(
            Gathered.without_light(count, places, hidden=False),
            irradiance=weighted(self.weights, known.irradiance - known.direct_irradiance, self.parents),
            noise=weighted(np.abs(self.weights), known.noise, self.parents),
            free=np.where(self.weights != 0.0, known.free[self.parents], np.inf).min(axis=1, initial=np.inf),
        )


def gather(
    transport: Transport,
    cells: Cells,
    radiance: Radiance,
    emitters: Emitters,
    receivers: Receivers,
    counts: GatherRays,
    finest: float,
    most_kept: int,
    report: Callable[[float], None],
    mixture: Mixture | None = None,
    bright: BrightPlaces | None = None,
) -> Gathered:
    """Gather light at receivers: emitters by form factor and shadow rays, all else by rays that look up `radiance`.

    Those of `mixture` send no such rays.

    Parameters
    ----------
    finest : float, scene units
        Size that faces may be split down to: what covers a receiver from farther off than theirs leaves it a view.
    most_kept : int
        What rays met is kept while there are no more of them.
    bright : BrightPlaces or None
        To be sent rays of their own.
    """
    if len(receivers.points) == 0:
        return Gathered.none(counts.hemisphere * len(transport.rays.in_channels()))
    asked = receivers if mixture is None else receivers.taken(mixture.others(len(receivers.points)))
    indirect = gather_indirect(transport, cells, radiance, asked, counts, finest, most_kept, report, bright)
    if mixture is not None:
        indirect = mixture.with_others(indirect)
    return with_direct(transport, emitters, receivers, counts, report, indirect)


def with_direct(
    transport: Transport,
    emitters: Emitters,
    receivers: Receivers,
    counts: GatherRays,
    report: Callable[[float], None],
    indirect: Gathered,
) -> Gathered:
    """Gather direct light at receivers whose indirect light is known."""
    direct = _direct(transport, emitters, receivers, counts, report)
    irradiance = direct.irradiance(emitters.strengths)
    return replace(indirect, irradiance=indirect.irradiance + irradiance, direct=direct, direct_irradiance=irradiance)


def gather_indirect(
    transport: Transport,
    cells: Cells,
    radiance: Radiance,
    receivers: Receivers,
    counts: GatherRays,
    finest: float,
    most_kept: int,
    report: Callable[[float], None],
    bright: BrightPlaces | None = None,
) -> Gathered:
    """The same, but no direct light."""
    total, scenes = len(receivers.points), transport.rays.in_channels()
    each = counts.hemisphere * len(scenes)
    if total == 0:
        return Gathered.none(each)
    pattern = hemisphere_lattice(counts.hemisphere, transport.seed + 101)
    room = each + (most_of_aimed(counts.hemisphere) if bright is not None else 0)
    kept = np.empty((total, each if total * room <= most_kept else 0), dtype=np.int32)

    def places_met(found: Hits, below: NDArray[np.bool_] | slice) -> NDArray[np.int32]:
        places = cells.places(found)
        if radiance.first_of_sky is not None:
            left = np.flatnonzero(places == ESCAPED)
            places[left] = radiance.first_of_sky + map_cells(found.directions[left])
        places[below] = BELOW
        return places.reshape(-1, counts.hemisphere)

    def indirect(
        first: int, last: int
    ) -> tuple[Floats, Floats, Floats, NDArray[np.bool_], NDArray[np.bool_], AimedLight]:
        part = slice(first, last)
        looks = [_looked(transport, receivers, part, pattern, rays) for rays in scenes]
        places = np.concatenate([places_met(*look) for look in looks], axis=1)
        found, _ = looks[0]
        aimed = AimedLight.none(len(places))
        if bright is not None:
            at = receivers.lit_points(part)
            aimed = aimed_light(bright, transport.rays, at, found, places, transport.seed + 103)
            places[bright.of_place[places] >= 0] = BELOW
        means, difference, valid = _mean_seen(radiance, places, len(scenes))
        # As the hemisphere's rays, which count if they are valid.
        aimed = aimed.weighted(np.where(valid < LEAST_VALID_SHARE, 0.0, 1.0 / np.maximum(valid, LEAST_VALID_SHARE)))
        more, doubt = aimed.irradiance(radiance.values[:, :3])
        means, noise = means + more, np.abs(difference + doubt)
        # What covers a place is opaque: any channel tells.
        distance = found.distance.reshape(-1, counts.hemisphere)
        in_plane = _in_plane_of_met(transport, receivers.lift[part], found)
        hidden = _covered(transport, receivers.sizes[part], finest, distance, in_plane) | (valid < LEAST_VALID_SHARE)
        kept[part] = places[:, : kept.shape[1]]
        shell = transport.surfaces.shell_of_triangle[found.triangle].reshape(distance.shape)
        beside = np.where(shell == receivers.shell[part, None], np.float32(np.inf), distance)
        touching = _touching(transport, receivers.inward[part], finest, beside) & ~hidden
        free: Floats = distance.min(axis=1).astype(np.float64) / transport.rays.scale
        return means, noise, free, hidden, touching, aimed

    parts = transport.rays.workers.map(indirect, total, counts.hemisphere, lambda share: report(0.7 * share))
    means, noise, free = (np.concatenate([p[k] for p in parts]) for k in (0, 1, 2))
    hidden, touching = (np.concatenate([p[k] for p in parts]) for k in (3, 4))
    aimed = AimedLight.stacked([p[5] for p in parts]) if kept.shape[1] else AimedLight.none(total)
    places = MetPlaces.of(MetTable(kept, aimed), len(scenes))
    return Gathered(means, DirectLight.none(total), np.zeros((total, 3)), noise, hidden, touching, free, places)


def enough_rays(counts: GatherRays, first: int, noise: float, receivers: int, most_kept: int) -> GatherRays:
    """The same counts, or more hemisphere rays where light comes from few small bright places, so that they are noisy.

    All receivers get as many, as all take the same pattern. How fast noise falls depends on how small the places are:
    it is to be measured again with what this returns.

    Parameters
    ----------
    first : int
        Hemisphere rays that the quality begins with.
    noise : float
        With these counts, relative to the mean.
    receivers : int
        Corners of the patches.
    most_kept : int
        As of `gather`; there shall be room for more receivers.
    """
    ratio = noise / counts.noise
    if ratio <= NOISY:
        return counts
    doublings = max(int(np.log2(ratio) / FASTEST_FALL), 1)
    most = min(first << MOST_DOUBLINGS, most_kept // (MORE_RECEIVERS * receivers))
    while doublings and counts.hemisphere << doublings > most:
        doublings -= 1
    return replace(counts, hemisphere=counts.hemisphere << doublings) if doublings else counts


def rough_rays(counts: GatherRays) -> GatherRays:
    """Few rays, to find out where light is far from what is expected."""
    few = {name: max(getattr(counts, name) // ROUGH, 8) for name in ("shadow", "penumbra", "deep")}
    return replace(counts, hemisphere=max(counts.hemisphere // ROUGH, FEWEST_ROUGH), **few)


def look_again(workers: Workers, radiance: Radiance, gathered: Gathered) -> Gathered:
    """The same rays, whose ends are looked up in another `radiance`; none is traced."""
    places = gathered.places
    named = places.named()

    def work(first: int, last: int) -> tuple[Floats, Floats, Floats]:
        return _mean_seen(radiance, places.places(named[first:last]), places.channels)

    parts = workers.map(work, len(named), places.rays)
    if not parts:
        return gathered
    more, doubt = places.aimed_at(named, radiance.values[:, :3])
    means = places.of_receivers(named, np.concatenate([p[0] for p in parts]) + more)
    noise = places.errors_of_receivers(named, np.abs(np.concatenate([p[1] for p in parts]) + doubt))
    return replace(gathered, irradiance=means + gathered.direct_irradiance, noise=noise)


def hidden_receivers(transport: Transport, receivers: Receivers, finest: float, rays: int) -> NDArray[np.bool_]:
    """Whether receivers are hidden, as `gather` finds it, by fewer rays, (n,) bool."""
    pattern = hemisphere_lattice(rays, transport.seed + 102)

    def work(first: int, last: int) -> NDArray[np.bool_]:
        part = slice(first, last)
        found, _ = _looked(transport, receivers, part, pattern, transport.rays)
        buried = (found.triangle >= 0) & transport.unlit_side[2 * found.triangle + found.back]
        distance = found.distance.reshape(last - first, rays)
        in_plane = _in_plane_of_met(transport, receivers.lift[part], found)
        covered = _covered(transport, receivers.sizes[part], finest, distance, in_plane)
        result: NDArray[np.bool_] = covered | (buried.reshape(-1, rays).mean(axis=1) > 1.0 - LEAST_VALID_SHARE)
        return result

    parts = transport.rays.workers.map(work, len(receivers.points), rays)
    return np.concatenate([np.zeros(0, dtype=bool), *parts])


def _mean_seen(radiance: Radiance, places: NDArray[np.int32], channels: int = 1) -> tuple[Floats, Floats, Floats]:
    """Mean of what the rays (n, r) see, (n, 3), how far its luminance is off one way and the share of valid rays.

    What it is off by is half of what the even rays see more than the odd ones: their size is a standard error.

    With three `channels`, a third of the rays sees each.
    """
    if channels > 1:
        thirds = [_mean_seen(radiance, third) for third in np.split(places, channels, axis=1)]
        means = np.stack([light[:, k] for k, (light, _, _) in enumerate(thirds)], axis=1)
        doubt: Floats = sum(share * np.abs(off) for share, (_, off, _) in zip(LUMINANCE, thirds, strict=True))
        return means, doubt, np.minimum.reduce([valid for _, _, valid in thirds])
    count, rays = places.shape
    # The four numbers of a place are taken as one complex one: several times faster than as a row.
    seen = np.take(radiance.values.view(np.complex128)[:, 0], places).view(np.float32).reshape(count, rays // 2, 8)
    # Sums of every other ray, as a product with a row of ones, which the array library does fastest.
    halves = np.matmul(np.ones((1, rays // 2), dtype=np.float32), seen).reshape(count, 2, 4).astype(np.float64)
    total = halves.sum(axis=1)
    valid = total[:, 3] / rays
    means = total[:, :3] / np.maximum(total[:, 3:], 1.0)
    # Inside a solid the few rays that slip out at an edge mean nothing.
    means[valid < LEAST_VALID_SHARE] = 0.0
    return means, (halves[:, 0, :3] - halves[:, 1, :3]) @ LUMINANCE / rays, valid


def _looked(
    transport: Transport, receivers: Receivers, part: slice, pattern: Singles, scene: RayScene
) -> tuple[Hits, NDArray[np.bool_] | slice]:
    """What the rays of receivers meet, (n * r,), and which of them started below their surface."""
    rays = len(pattern)
    # All receivers take the same pattern: what it misses then changes slowly over a surface instead of mottling it, at
    # the same error.
    normals = receivers.normals[part]
    directions = (pattern @ frames(normals, np.zeros(len(normals)))).reshape(-1, 3)
    lift = receivers.lift[part].astype(np.float32)
    origins = np.repeat(transport.rays.local(receivers.points[part]) + lift * np.float32(OFFSET), rays, axis=0)
    even = np.tile(even_chances(rays), len(normals)) if transport.surfaces.transmittance is not None else None
    found = scene.first_hits(origins, directions, even, rays)
    if not np.any(np.abs(normals - lift) > FLAT):
        return found, slice(0)
    # A smooth shading normal leans over its face: what it asks for from below the face is dark, as in Cycles.
    below = (directions.reshape(len(lift), rays, 3) @ lift[:, :, None]).ravel() <= 0.0
    found.distance[below] = np.inf
    return found, below


def _in_plane_of_met(transport: Transport, lift: Floats, found: Hits) -> Ints:
    """Rays of places (n,) that met what stands on the surface in the very plane that they began in, by number."""
    met = np.flatnonzero(found.distance < IN_PLANE)
    place = met // (len(found.distance) // len(lift))
    upright = np.abs(np.einsum("rx,rx->r", transport.surfaces.normals[found.triangle[met]], lift[place])) < UPRIGHT
    began: Ints = met[upright]
    return began


def _covered(
    transport: Transport, sizes: Floats, finest: float, distance: Singles, in_plane: Ints
) -> NDArray[np.bool_]:
    """Whether places are covered, (n,), by the distances (n, r) that their rays reach.

    A ray that began in the plane of what it met there tells of neither side of it: `in_plane` (k,).
    """
    reach = (COVER_GAP * transport.rays.scale * np.minimum(SMALLER_FOR_CUTS * sizes, finest)).astype(np.float32)
    near = distance < reach[:, None]
    near.ravel()[in_plane] = False
    result: NDArray[np.bool_] = near.mean(axis=1) > LEAST_COVERED_SHARE
    return result


def _touching(transport: Transport, inward: Floats, finest: float, distance: Singles) -> NDArray[np.bool_]:
    """Whether places are on the outline of what stands there, (n,), by how far rays (n, r) get until they meet that.

    The surface itself does not count: what goes on in a fold has the light of the fold.
    """
    # Solids are smaller by a hair for rays.
    reach = np.float32(transport.rays.scale * max(TOUCHING * finest, 10.0 * transport.surfaces.hair))
    # On the border of its own surface a vertex gathers aside, and meets what is beside it from there.
    result: NDArray[np.bool_] = ((distance < reach).mean(axis=1) > LEAST_TOUCHING_SHARE) & ~inward.any(axis=1)
    return result


def _direct(
    transport: Transport,
    emitters: Emitters,
    receivers: Receivers,
    counts: GatherRays,
    report: Callable[[float], None],
) -> DirectLight:
    def pass_over(chosen: Ints, rays: int, salt: int, low: float, high: float) -> tuple[DirectLight, Floats]:
        # Receivers close together share what they need to know of many emitters.
        order = order_along_curve(receivers.points[chosen])

        def work(first: int, last: int) -> tuple[DirectLight, Floats]:
            part = chosen[order[first:last]]
            return direct_light(emitters, transport.rays, receivers.lit_points(part), rays, transport.seed + salt)

        parts = transport.rays.workers.map(work, len(chosen), rays, lambda share: report(low + (high - low) * share))
        light = DirectLight.stacked([p[0] for p in parts]).renumbered(order, len(chosen))
        uncertainty = np.zeros(len(chosen))
        uncertainty[order] = np.concatenate([np.zeros(0), *(p[1] for p in parts)])
        return light, uncertainty

    everyone = np.arange(len(receivers.points))
    if len(emitters.strengths) == 0:
        return DirectLight.none(len(everyone))
    direct, uncertainty = pass_over(everyone, counts.shadow, 201, 0.7, 0.8)
    most = counts.tolerance * float((direct.irradiance(emitters.strengths) @ LUMINANCE).mean())
    # Where the rays of the next pass would surely leave too much, they are not asked.
    enough = uncertainty <= most * (counts.penumbra / counts.shadow) ** LATTICE_FALL
    again = np.flatnonzero((uncertainty > 0.0) & enough)
    more, uncertainty[again] = pass_over(again, counts.penumbra, 202, 0.8, 0.85)
    direct = direct.with_more(everyone, more, again)
    deep = np.flatnonzero(uncertainty > most)
    more, _ = pass_over(deep, counts.deep, 203, 0.85, 1.0)
    return direct.with_more(everyone, more, deep)


def corner_values(gathered: Gathered, of_corner: Ints) -> Floats:
    """Irradiance at face corners, (f, 3, 3), without the dark or bright rim that hidden vertices would draw.

    A face that is hidden at some corners and seen at others shows the seen ones' light to its end: at a hidden corner
    it takes the mean of what such faces show at their other corners, at a corner on an outline what it shows itself.
    Faces hidden altogether keep what was gathered.

    Parameters
    ----------
    of_corner : (f, 3) int
        Receivers of each face's corners.
    """
    values = gathered.irradiance[of_corner]
    hidden, touching = gathered.hidden[of_corner], gathered.touching[of_corner]
    whole = ~hidden & ~touching
    # Where no corner is off the outlines, those on them are the best there is.
    seen = np.where(whole.any(axis=1)[:, None], whole, ~hidden)
    mixed = np.flatnonzero(seen.any(axis=1) & ~seen.all(axis=1))
    shown = np.einsum("fk,fkc->fc", seen[mixed], values[mixed]) / seen[mixed].sum(axis=1)[:, None]
    face, corner = np.nonzero(touching[mixed] & ~seen[mixed])
    values[mixed[face], corner] = shown[face]
    face, corner = np.nonzero(hidden[mixed])
    target, size = of_corner[mixed[face], corner], len(gathered.hidden)
    count = np.maximum(np.bincount(target, minlength=size), 1)
    for channel in range(values.shape[2]):
        mean = np.bincount(target, weights=shown[face, channel], minlength=size) / count
        values[mixed[face], corner, channel] = mean[target]
    return values
