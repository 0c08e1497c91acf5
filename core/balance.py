# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The energy balance of the traced elements: what goes into the solver, and what comes of it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from .direct import Emitters, direct_light
from .direct_light import DirectLight
from .errors import UnsolvableError
from .geometry import order_along_curve
from .lit_points import LitPoints
from .near_lamps import near_shares
from .patches import PatchTree
from .rows import ESCAPED, Cover, Shares
from .scene import UNLINKED, Floats, Ints, Texture
from .solve import Exchange, Solution, Translucence
from .surfaces import Surfaces
from .textures import mean_colours
from .transmittance import of_opaque
from .transport import Transport, keys_of_points, sample_points

POINTS_PER_PATCH = 4
"""Points of a patch at which direct light is computed for the transport."""

MORE_POINTS = 16
"""Points of the patches that get much of the emitters' light: a lamp close to a wall lights few, and they the rest."""

MUCH_LIGHT = 1.0 / 1024.0
"""Share of what all patches get of the emitters from which on it is much."""

SHADOW_RAYS_PER_POINT = 8
"""Shadow rays of each of them: 32 a patch, and the gather averages over hundreds of patches."""


@dataclass(frozen=True, eq=False)
class TriangleMeans:
    """Means over elements of what triangles have, by area.

    Attributes
    ----------
    count : int
        Elements.
    element, node : (p,) int
        An entry for each member of a cluster, and one for what lies in a triangle.
    weight : (p,) float
        They add up to 1 for each element.
    triangle_of_node : (nodes,) int
    corners_of_node : (nodes, 3, 3) float
        Barycentric coordinates of the nodes' corners in their triangles.
    """

    count: int
    element: Ints
    node: Ints
    weight: Floats
    triangle_of_node: Ints
    corners_of_node: Floats

    @staticmethod
    def over(tree: PatchTree, nodes: Ints) -> TriangleMeans:
        """Over nodes (m,)."""
        return TriangleMeans(len(nodes), *tree.expanded(nodes), tree.triangle, tree.weights)

    def of(self, values: Floats, texture: Texture | None = None) -> Floats:
        """Mean over each element, (count, k), of values (triangles, k), some of which vary over their triangle."""
        inside = mean_colours(values, texture, self.triangle_of_node[self.node], self.corners_of_node, self.node)
        columns = [np.bincount(self.element, weights=self.weight * column, minlength=self.count) for column in inside.T]
        return np.stack(columns, axis=1)

    def reflectance(self, surfaces: Surfaces) -> Floats:
        """Of what is opaque of each element, (count, 3)."""
        reflectance = self.of_opaque(self.of(surfaces.reflectance, surfaces.reflectance_texture), surfaces)
        # A mean of ones is more than one by rounding, and would absorb less than nothing.
        return np.minimum(reflectance, 1.0)

    def emission(self, surfaces: Surfaces) -> Floats:
        """Of what is opaque of each element, (count, 3), W m^-2 sr^-1."""
        return self.of_opaque(self.of(surfaces.emission, surfaces.emission_texture), surfaces)

    def of_opaque(self, colours: Floats, surfaces: Surfaces) -> Floats:
        """Means over elements (count, 3) as those of what is opaque of them, which rays meet."""
        return colours if surfaces.transmittance is None else of_opaque(colours, self.opacity(surfaces))

    def opacity(self, surfaces: Surfaces) -> Floats:
        """Share of each element that light does not go through, (count, 1)."""
        if surfaces.transmittance is None:
            return np.ones((self.count, 1))
        return 1.0 - self.of(surfaces.transmittance.means, surfaces.transmittance.texture)


@dataclass(frozen=True, eq=False)
class SkyShares:
    """How the rays of elements that leave the scene are spread over the world's map.

    Attributes
    ----------
    element, cell : (p,) int
        An entry for each pair.
    share : (p,) float
        Of all valid rays of the element.
    """

    element: Ints
    cell: Ints
    share: Floats

    def irradiance(self, count: int, radiance: Floats) -> Floats:
        """Irradiance over pi of so many elements, (count, 3), by the radiance of the cells, (cells, 3)."""
        columns = [np.bincount(self.element, weights=self.share * c[self.cell], minlength=count) for c in radiance.T]
        return np.stack(columns, axis=1)


def sky_shares(transport: Transport, number: Ints, escape: Floats) -> SkyShares:
    """Count the rays of each element that leave towards each cell of the world's map.

    Parameters
    ----------
    number : (elements,) int
        Of the traced elements.
    escape : (m,) float
        Share of their rays that leave.
    """
    keys = []
    for table in transport.tables:
        row, ray = np.nonzero(table.hits == ESCAPED)
        keys.append((number[table.element[row]] << 32) | table.root[row, ray])
    key, count = np.unique(np.concatenate(keys), return_counts=True)
    element, cell = key >> 32, key & 0xFFFFFFFF
    # Rays that leave the scene are no short ones: all are the element's own, and none its twin's.
    left = np.bincount(element, weights=count, minlength=len(escape))
    return SkyShares(element, cell, count * (escape[element] / left[element]))


@dataclass(frozen=True, eq=False)
class Balance:
    """The traced elements and twins, numbered 0 to m - 1, and their form factors.

    Attributes
    ----------
    elements : (m,) int
        Elements, and twins of those that are covered in part.
    base : (m,) int
        The element itself, or the one that a twin is part of.
    exchange : Exchange
    escape : (m,) float
        Share of each element's rays that leave the scene.
    sky : SkyShares or None
        Where these leave it to, where the world has a map.
    areas : (m,) float
        Area that is not inside a solid, that light does not go through, and that nothing in the same place is met for.
    emitting_areas : (m,) float
        The same with what is in one place with something else: as each emitter is sampled by itself, it lights as often
        as it is there.
    buried : (m,) float
        Share of the area that is.
    means : TriangleMeans
    reflectance, emission : (m, 3) float
    translucence : Translucence or None
    """

    elements: Ints
    base: Ints
    exchange: Exchange
    escape: Floats
    sky: SkyShares | None
    areas: Floats
    emitting_areas: Floats
    buried: Floats
    means: TriangleMeans
    reflectance: Floats
    emission: Floats
    translucence: Translucence | None

    def recoloured(self, surfaces: Surfaces) -> Balance:
        """The same elements, with the reflectance, translucence and emission that `surfaces` have."""
        means = self.means
        emission = emission_of_sides(means, self.base, surfaces)
        silky = translucence_of(means, self.base, self.elements, surfaces)
        return replace(self, reflectance=means.reflectance(surfaces), emission=emission, translucence=silky)

    def from_world(self, world: Floats) -> Floats:
        """Irradiance over pi of the elements by what their rays see of the world, (m, 3), without its suns."""
        if self.sky is None:
            return self.escape[:, None] * world
        return self.sky.irradiance(len(self.escape), world)


def balance_of(transport: Transport, cover: Cover, shares: Shares) -> Balance:
    """Number the traced elements and sort their form factors into what is exchanged and what escapes."""
    surfaces, tree = transport.surfaces, transport.tree
    traced = np.flatnonzero(transport.has_row())
    twins = cover.first_twin + np.arange(len(cover.element))
    elements, base = np.concatenate([traced, twins]), np.concatenate([traced, cover.element])
    number = np.full(cover.first_twin + len(twins), -1, dtype=np.int64)
    number[elements] = np.arange(len(elements))
    lost = shares.source == ESCAPED
    escape = np.zeros(len(elements))
    escape[number[shares.receiver[lost]]] = shares.share[lost]
    buried = transport.buried_share()[base]
    share = np.ones(len(elements))
    # By area as by rays: what is counted as sent out by the one part must not be received by the other.
    rays = np.zeros(len(elements))
    rays[number[shares.receiver]] = shares.rays
    below, beside = rays[number[twins]], rays[number[cover.element]]
    share[number[twins]] = below / np.maximum(below + beside, 1.0)
    share[number[cover.element]] -= share[number[twins]]
    means = TriangleMeans.over(tree, base >> 1)
    areas = tree.areas(base >> 1) * (1.0 - buried) * share * means.opacity(surfaces)[:, 0]
    return Balance(
        elements,
        base,
        exchange_of(number[shares.receiver[~lost]], number[shares.source[~lost]], shares.share[~lost]),
        escape,
        sky_shares(transport, number, escape) if surfaces.world.ndim > 1 else None,
        areas * transport.met_share(base),
        areas,
        buried,
        means,
        means.reflectance(surfaces),
        emission_of_sides(means, base, surfaces),
        translucence_of(means, base, elements, surfaces),
    )


def translucence_of(means: TriangleMeans, base: Ints, elements: Ints, surfaces: Surfaces) -> Translucence | None:
    """What elements send on of the light on their other sides, None where none does.

    Parameters
    ----------
    means : TriangleMeans
        Over the elements.
    base, elements : (m,) int
        As of `Balance`.
    """
    if surfaces.translucence is None:
        return None
    share = means.of_opaque(means.of(surfaces.translucence, surfaces.translucence_texture), surfaces)
    number = np.full(int(max(elements.max(), base.max() | 1)) + 1, -1, dtype=np.int64)
    number[elements] = np.arange(len(elements))
    other = number[base ^ 1]
    # Of what was not traced, no light is known.
    return Translucence(np.where(other[:, None] >= 0, np.minimum(share, 1.0), 0.0), other)


def emission_of_sides(means: TriangleMeans, elements: Ints, surfaces: Surfaces) -> Floats:
    """Emission of elements, (m, 3), none of those that are backs of triangles which emit from their front alone.

    Parameters
    ----------
    means : TriangleMeans
        Over the elements.
    elements : (m,) int
    """
    emission = means.emission(surfaces)
    emission[(elements & 1 == 1) & surfaces.front_only[means.triangle_of_node[elements >> 1]]] = 0.0
    return emission


def exchange_of(receiver: Ints, source: Ints, factor: Floats) -> Exchange:
    """Make rows of entries whose receivers are together."""
    start = np.flatnonzero(np.diff(receiver, prepend=-1))
    return Exchange(receiver[start], start, source, factor.astype(np.float32))


def left_emission(surfaces: Surfaces, emitters: Emitters) -> Floats:
    """The emission of triangles that is left to rays: zero where the emitter is sampled explicitly, (triangles, 3)."""
    emission = surfaces.emission.copy()
    emission[emitters.triangle] = 0.0
    return emission


def direct_on_patches(
    transport: Transport, cover: Cover, balance: Balance, emitters: Emitters, report: Callable[[float], None]
) -> DirectLight:
    """What each element gets of the emitters, in the mean over a few points, of m receivers.

    Which patches get more points is told by the rays that left them. Chosen by what the few points say, a patch whose
    points all miss the light would keep its darkness, and one whose points meet it would lose its own.
    """
    count = len(balance.elements)
    number = np.full(cover.first_twin + len(cover.element), -1, dtype=np.int64)
    number[balance.elements] = np.arange(count)
    whole = np.flatnonzero((balance.elements == balance.base) & (cover.twin[balance.base] < 0))
    power = balance.areas * balance.exchange.apply(balance.emission).sum(axis=1)
    # How much of a lamp's light a patch gets, no ray has told: all are taken as if it were much.
    much = (power[whole] > MUCH_LIGHT * power.sum()) | (len(emitters.lamps) > 0)
    direct = []
    for rows, points in ((whole[~much], POINTS_PER_PATCH), (whole[much], MORE_POINTS)):
        at_points = _direct_on(transport, balance, emitters, rows, points, report)
        direct.append(at_points.weighted(1.0 / points).renumbered(np.repeat(rows, points), count))
    if len(cover.element):
        at_points = _direct_at(transport, emitters, cover.element, cover.points, cover.normals, report)
        # A point belongs to both parts as its rays do, so that the parts get together what the points do.
        for covered, part in ((cover.element, 1.0 - cover.short), (cover.twin[cover.element], cover.short)):
            receiver = np.where(part > 0.0, number[covered][:, None], -1)
            share = part / part.sum(axis=1)[:, None]
            direct.append(at_points.weighted(share.ravel()).renumbered(receiver.ravel(), count))
    return DirectLight.joined(direct)


def unreflected_light(balance: Balance, direct: DirectLight, emitters: Emitters, surfaces: Surfaces) -> Floats:
    """Irradiance over pi of each element that is not reflected radiance: emitters and the world, (m, 3).

    Parameters
    ----------
    direct : DirectLight
        What the elements get of the emitters.
    """
    left = left_emission(surfaces, emitters)
    by_rays = balance.exchange.apply(balance.means.of_opaque(balance.means.of(left), surfaces))
    return direct.irradiance(emitters.strengths) + by_rays + balance.from_world(surfaces.world)


def _direct_on(
    transport: Transport,
    balance: Balance,
    emitters: Emitters,
    rows: Ints,
    count: int,
    report: Callable[[float], None],
) -> DirectLight:
    """Direct light at so many points of elements, of which `rows` (k,) of the balance are asked: k * count receivers.

    No point is inside a solid.
    """
    elements, partly = balance.elements[rows], balance.buried[rows] > 0.0
    points, normals = sample_points(transport.surfaces, transport.tree, elements, count, transport.seed + 51)
    points[partly], normals[partly] = transport.open_points(elements[partly], count)
    light = _direct_at(transport, emitters, elements, points, normals, report)
    tree = transport.tree
    simple = np.flatnonzero(~partly & ~tree.is_cluster(elements >> 1))
    corners = tree.points[tree.corners[elements[simple] >> 1]]
    for number, near in near_shares(emitters.lamps, corners, points[simple], normals[simple]).items():
        share = np.ones(len(elements))
        share[simple] = near
        lamp = len(emitters.triangle) + number
        light = light.weighted_of(lamp, len(emitters.strengths), np.repeat(share, count))
    return light


def _direct_at(
    transport: Transport,
    emitters: Emitters,
    elements: Ints,
    points: Floats,
    normals: Floats,
    report: Callable[[float], None],
) -> DirectLight:
    """Direct light at points of elements, (k, p, 3), as of k p receivers."""
    count = points.shape[1]
    order = order_along_curve(points[:, 0])
    mesh = transport.surfaces.mesh_of_triangle[transport.tree.triangle[elements >> 1]]

    def work(first: int, last: int) -> DirectLight:
        part = order[first:last]
        at, axis = points[part].reshape(-1, 3), normals[part].reshape(-1, 3)
        keys = keys_of_points(transport.tree.keys(elements[part]), count)
        asked = LitPoints.of(at, axis, keys, np.repeat(mesh[part], count))
        light, _ = direct_light(emitters, transport.rays, asked, SHADOW_RAYS_PER_POINT, transport.seed + 52)
        return light

    parts = transport.rays.workers.map(work, len(elements), count * SHADOW_RAYS_PER_POINT, report)
    number = (order[:, None] * count + np.arange(count)).ravel()
    return DirectLight.stacked(parts).renumbered(number, len(number))


def seen_radiance(nodes: int, balance: Balance, solution: Solution, emitters: Emitters, surfaces: Surfaces) -> Floats:
    """What gather rays see on each element and twin: reflected light, and emission that is not sampled explicitly."""
    values = np.zeros((max(2 * nodes, int(balance.elements.max(initial=0)) + 1), 3))
    left = balance.means.of(left_emission(surfaces, emitters))
    values[balance.elements] = solution.reflected + balance.means.of_opaque(left, surfaces)
    return values


def energy(
    balance: Balance,
    solution: Solution,
    from_lamps: Floats,
    from_suns: Floats,
    from_linked: Floats,
    surfaces: Surfaces,
) -> dict[str, float]:
    """Where the power goes, in W summed over the channels (for lengths in metres).

    `imbalance` is what emission, world and lamps bring in less what is absorbed and what leaves, as a share of what
    comes in: the form factors are sampled, so it is a check on them. Of lamps, what misses every surface is not known;
    nor is it of emission that is linked to some meshes alone, and what these get counts as emitted.

    Parameters
    ----------
    from_lamps, from_suns, from_linked : (m, 3) float, W m^-2 sr^-1
        Irradiance over pi that elements get of lamps, of the suns that stand for parts of the world, and of linked
        emission.
    """
    area, emitting = np.pi * balance.areas[:, None], np.pi * balance.emitting_areas[:, None]
    # What light goes through takes none of it away.
    met = area * balance.means.of(surfaces.seen[:, None].astype(np.float64))
    linked = np.array([linking != UNLINKED for linking in surfaces.linking])[surfaces.mesh_of_triangle]
    emission = balance.emission * (1.0 - balance.means.of(linked[:, None].astype(np.float64)))
    emitted = float((emitting * emission).sum() + (met * from_linked).sum())
    world = float((met * (balance.from_world(surfaces.world) + from_suns)).sum())
    lamps = float((met * from_lamps).sum())
    reflected = float((met * solution.reflected).sum())
    sent_on = balance.reflectance if balance.translucence is None else balance.reflectance + balance.translucence.share
    absorbed = float((met * (1.0 - sent_on) * solution.incident).sum())
    escaped = float(((emitting * emission + met * solution.reflected) * balance.escape[:, None]).sum())
    total = emitted + world + lamps
    return {
        "emitted": emitted,
        "from_world": world,
        "from_lamps": lamps,
        "reflected": reflected,
        "absorbed": absorbed,
        "escaped": escaped,
        "imbalance": (total - absorbed - escaped) / total if total > 0.0 else 0.0,
    }


def check_solved(solution: Solution, surfaces: Surfaces) -> None:
    """Raise where the balance has no finite solution.

    Raises
    ------
    UnsolvableError
        When the solver got nowhere and some surface reflects all light.
    """
    if not np.isfinite(solution.reflected).all() or (not solution.converged and surfaces.reflectance.max() >= 1.0):
        raise UnsolvableError(
            "Light is trapped between surfaces that reflect all of it; give the materials base colours below 1"
        )
