# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Direct light of thousands of emitters: what a cut of their tree would send, times visible shares of its parts.

What a receiver would get of all lights unoccluded is known: up to `MOST_EACH` lights one by one, of more by a cut of
their tree. Its shadow rays are spread evenly over that light, in the order of the tree, so that rays which follow one
another ask for places close together. Nodes that get several rays have a visible share of their own; other rays share
one with their neighbours. Where nothing hides the lights the result is the same whatever the rays.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from .direct_light import DirectLight
from .form_factors import above_horizon, heights_of, piece_factor
from .light_cut import GRAZING, Cut, cut
from .light_tree import NORMALS_WEIGHT, LightTree, halved
from .lit_points import LitPoints
from .sampling import GOLDEN, LATTICE_ERROR, Singles, hashed
from .scene import Floats, Ints
from .visibility import OFFSET, RayScene

MOST_EACH = 2048
"""Lights that are looked at one by one: of so many it takes about as long as a cut of their tree."""

MOST_TOLD = 256
"""Lights of which each keeps what gets through of it; of more, those that rays were sent to stand for the others."""

PAIRS_AT_ONCE = 2**16
"""Receivers times lights whose working arrays stay in a core's second cache."""

GROUP = 16
"""Receivers that share a cut, at most."""

LARGEST_GROUP = 0.25
"""Radius of a group over its distance from the middle of any of `COARSE_NODES` nodes, at most."""

COARSE_NODES = 32

RECEIVERS_AT_ONCE = 512
"""Receivers of groups whose cuts are worked on at once."""

RAYS_TOGETHER = 4
"""Rays that find one visible share: of a node that gets as many, or of several nodes in a row that do not."""

EXACT_ANGLE = 0.1
"""Radius over distance of a light from which on its form factor is computed exactly; below it, what the formula for
nodes gives is off by a hundredth at most."""

FAINTEST = 1e-30
"""Below this share of its flux a light sends a receiver none, and one that gets less in all is dark: what is divided by
it is still a float32."""

CLOSEST = np.float32(np.sqrt(np.finfo(np.float32).tiny))
"""Square of a distance below which its own square is no float32."""


@dataclass(frozen=True, eq=False)
class _Places:
    """Groups of receivers.

    Attributes
    ----------
    points, normals, lift : (g, size, 3) float
    shifts : (g, size, 2) float
        Of their sampling patterns.
    """

    points: Floats
    normals: Floats
    lift: Floats
    shifts: Floats


def light_of_many(
    tree: LightTree, rays: RayScene, at: LitPoints, shadow_rays: int, seed: int
) -> tuple[DirectLight, Floats]:
    """Direct light of the lights of a tree at n points, and the standard error of its luminance (n,)."""
    points, normals, lift, shifts = at.points, at.normals, at.lift, hashed(at.keys, 2, seed)
    entries, uncertainty = [DirectLight.none(len(points))], np.zeros(len(points))
    if len(tree.emitter) <= MOST_EACH:
        size = max(1, PAIRS_AT_ONCE // len(tree.emitter))
        groups = [np.arange(k, min(k + size, len(points)))[None] for k in range(0, len(points), size)]
        weigh = _all_lights
    else:
        groups, weigh = _groups(tree, points, normals), _cut_lights
    for member in groups:
        places = _Places(points[member], normals[member], lift[member], shifts[member])
        found = weigh(tree, places)
        if len(found.node):
            light, error = _partly_hidden(tree, rays, places, found, shadow_rays)
            entries.append(light.renumbered(_first_places(member), len(points)))
            uncertainty[member] = error
    return DirectLight.joined(entries), uncertainty


def _first_places(member: Ints) -> Ints:
    """Which receiver each place in groups (g, size) stands for, (g * size,); -1 where one is repeated."""
    again = member == np.roll(member, 1, axis=1)
    again[:, 0] = False
    return np.where(again, -1, member).ravel()


def _all_lights(tree: LightTree, places: _Places) -> Cut:
    """Every light that can be seen, for one group."""
    leaves = len(tree.first) // 2
    node = leaves + np.flatnonzero(tree.shape[1, leaves:] > 0.0)
    points, normals = places.points[0] - tree.origin, places.normals[0].astype(np.float32)
    # About the receivers' middle, as products of large coordinates cancel.
    middle = points.mean(axis=0)
    at = (points - middle).astype(np.float32)
    centre = (tree.centre[:, node] - middle[:, None]).astype(np.float32)
    radius, flux, *vector = tree.sums[:5, node]
    facing = at @ np.stack(vector) - (centre * vector).sum(axis=0)
    facing -= GRAZING * flux * np.float32(np.linalg.norm(centre, axis=0).max(initial=0.0))
    height = normals @ centre - np.einsum("nx,nx->n", normals, at)[:, None]
    square = at @ (-2.0 * centre)
    square += (at * at).sum(axis=1)[:, None]
    square += (centre * centre).sum(axis=0)
    # Nearer than its size, a light is computed exactly.
    near = square * np.float32(EXACT_ANGLE**2) < radius * radius
    np.maximum(square, np.maximum(radius * radius / 4.0, CLOSEST), out=square)
    square *= square
    light = np.maximum(facing, 0.0, out=facing)
    light *= np.maximum(height, 0.0, out=height)
    light /= square
    light *= np.float32(1.0 / np.pi)
    _make_exact(tree, node, np.zeros(len(node), dtype=np.int64), near.nonzero(), light, places)
    some = np.flatnonzero(light.any(axis=0))
    return Cut(np.zeros(len(some), dtype=np.int64), node[some], light.take(some, axis=1))


def _cut_lights(tree: LightTree, places: _Places) -> Cut:
    """A cut for each group, with what is near computed exactly."""
    found = cut(tree, places.points, places.normals)
    rough = np.flatnonzero(found.rough)
    way = (tree.centre[:, found.node[rough]].T + tree.origin)[:, None] - places.points[found.group[rough]]
    near = np.einsum("rkx,rkx->kr", way, way) * EXACT_ANGLE**2 < tree.shape[0, found.node[rough]] ** 2
    member, pair = near.nonzero()
    _make_exact(tree, found.node, found.group, (member, rough[pair]), found.light, places)
    return found


def _make_exact(
    tree: LightTree, node: Ints, group: Ints, near: tuple[Ints, Ints], light: Singles, places: _Places
) -> None:
    """Replace some of the light (size, m) of single lights by what follows from their form factors."""
    member, pair = near
    which, at = tree.first[node[pair]], places.points[group[pair], member] - tree.origin
    axis = np.ascontiguousarray(places.normals[group[pair], member].T)
    corners = np.ascontiguousarray(tree.corners[which].transpose(1, 2, 0)) - at.T
    facing = -(corners[0] * tree.normals[which].T).sum(axis=0)
    owner, pieces = above_horizon(corners, heights_of(corners, axis))
    factor = np.bincount(owner, weights=piece_factor(pieces, axis.take(owner, axis=1)), minlength=len(at))
    factor[facing <= GRAZING * np.sqrt((corners**2).sum(axis=1).max(axis=0))] = 0.0
    light[member, pair] = factor * tree.luminance[which]


def _groups(tree: LightTree, points: Floats, normals: Floats) -> list[Ints]:
    """Receivers close together and facing about the same way, (g, size) each; some are there twice.

    A group is so small that what lights are far away for one of it are so for all.
    """
    count = len(points)
    parts = 1 << (-(-count // GROUP) - 1).bit_length()
    most = 1 << (count - 1).bit_length()
    extent = float(np.ptp(points, axis=0).max())
    order = halved(np.concatenate([points, NORMALS_WEIGHT * extent * normals], axis=1), most)
    coarse = slice(min(COARSE_NODES, len(tree.first) // 2), min(2 * COARSE_NODES, len(tree.first)))
    lights = tree.centre[:, coarse][:, tree.shape[1, coarse] > 0.0].T + tree.origin
    groups: list[Ints] = []
    part = np.arange(parts)
    while len(part):
        first, last = part * count // parts, (part + 1) * count // parts
        part, first, last = part[last > first], first[last > first], last[last > first]
        place = first[:, None] + np.arange((last - first).max(initial=1))
        member = order[np.minimum(place, last[:, None] - 1)]
        middle = points[member].mean(axis=1)
        radius = np.linalg.norm(points[member] - middle[:, None], axis=2).max(axis=1)
        nearest = np.linalg.norm(middle[:, None] - lights, axis=2).min(axis=1)
        wide = (radius > LARGEST_GROUP * nearest) & (last - first > 1)
        size = max(1, RECEIVERS_AT_ONCE // member.shape[1])
        kept = member[~wide]
        groups += [kept[k : k + size] for k in range(0, len(kept), size)]
        part = np.concatenate([2 * part[wide], 2 * part[wide] + 1])
        part.sort()
        parts *= 2
    return groups


@dataclass(frozen=True, eq=False)
class _Draw:
    """Which nodes get rays from which receivers.

    Attributes
    ----------
    member, pair : (p,) int
        Places in the arrays (size, m) of a cut: the receiver's in its group, and the pair of group and node.
    rays, first : (p,) int
        How many rays, and the number of the first among the receiver's.
    lower, width : (p,) float
        Where the node's light begins among the receiver's light, and how much it is, in rays.
    """

    member: Ints
    pair: Ints
    rays: Ints
    first: Ints
    lower: Floats
    width: Floats


def _partly_hidden(
    tree: LightTree, rays: RayScene, places: _Places, found: Cut, shadow_rays: int
) -> tuple[DirectLight, Floats]:
    """What gets through of the light of a cut, for receivers numbered through all groups, and its error (g, size)."""
    groups, size, _ = places.points.shape
    start = np.flatnonzero(np.diff(found.group, prepend=-1))
    total = np.zeros((size, groups), dtype=np.float32)
    total[:, found.group[start]] = np.add.reduceat(found.light, start, axis=1)
    draw = _draw(found, start, total, places.shifts[:, :, 0].T, shadow_rays)
    if len(draw.rays) == 0:
        return DirectLight.none(groups * size), np.zeros((groups, size))
    receiver = found.group[draw.pair] * size + draw.member
    node = found.node[draw.pair]
    light, seen, weight = _tried(tree, rays, places, node, receiver, draw)
    # Against what the rays were drawn by.
    flux = tree.shape[1, node]
    weight *= (flux / np.maximum(found.light[draw.member, draw.pair], FAINTEST * flux)).repeat(draw.rays)
    ray = total.T.ravel() / shadow_rays
    visible, variance = _visible_shares(groups * size, draw, receiver, ray, seen, weight, shadow_rays)
    uncertainty = np.sqrt(variance).reshape(groups, size)
    if len(tree.emitter) <= MOST_TOLD:
        return _told_apart(tree, found, draw, total[:, 0], visible, shadow_rays), uncertainty
    at = receiver.repeat(draw.rays)
    visible = visible[_part_of_ray(draw, receiver, shadow_rays)]
    run = np.flatnonzero(np.diff(at * len(tree.emitter) + light, prepend=-1))
    through = np.add.reduceat(ray[at] * visible, run) / tree.luminance[light[run]]
    return DirectLight.of(groups * size, at[run], tree.emitter[light[run]], through), uncertainty


def _told_apart(
    tree: LightTree, found: Cut, draw: _Draw, total: Singles, visible: Floats, shadow_rays: int
) -> DirectLight:
    """What gets through of every single light of one group, whether rays were sent to it or to its neighbours.

    Lights of several colours would else take the place of each other, and speckle even where nothing hides them.

    Parameters
    ----------
    total : (size,) float32
        The light of all.
    visible : (parts,) float
        See `_visible_shares`.
    """
    size = len(total)
    ray = np.divide(total, shadow_rays, dtype=np.float64)[:, None]
    width = np.divide(found.light, ray, out=np.zeros(found.light.shape), where=ray > 0.0)
    strips = visible[len(draw.rays) :].reshape(size, -1)
    seen_before = np.concatenate([np.zeros((size, 1)), RAYS_TOGETHER * np.cumsum(strips, axis=1)], axis=1)

    def seen_up_to(place: Floats) -> Floats:
        strip = np.clip((place / RAYS_TOGETHER).astype(np.int64), 0, strips.shape[1] - 1)
        part = place - RAYS_TOGETHER * strip
        before: Floats = np.take_along_axis(seen_before, strip, axis=1)
        return before + part * np.take_along_axis(strips, strip, axis=1)

    end = np.cumsum(width, axis=1)
    through = ray * (seen_up_to(end) - seen_up_to(end - width))
    own = np.flatnonzero(draw.rays >= RAYS_TOGETHER)
    at = draw.member[own], draw.pair[own]
    through[at] = found.light[at] * visible[own]
    member, pair = np.nonzero(through > 0.0)
    light = tree.first[found.node[pair]]
    order = np.lexsort((light, member))
    member, pair, light = member[order], pair[order], light[order]
    return DirectLight.of(size, member, tree.emitter[light], through[member, pair] / tree.luminance[light])


def _draw(found: Cut, start: Ints, total: Singles, shift: Floats, shadow_rays: int) -> _Draw:
    """Spread rays at equal steps over the light of the nodes of each group, which begin at `start`.

    Parameters
    ----------
    total : (size, g) float32
        The light of all nodes.
    shift : (size, g) float
        Of the first ray.
    """
    per_light = np.divide(shadow_rays, total, out=np.zeros_like(total), where=total > FAINTEST)
    share = found.light * per_light.take(found.group, axis=1)
    before = np.cumsum(share, axis=1, dtype=np.float64)
    if len(start) > 1:
        length = np.diff(np.append(start, share.shape[1]))
        before -= np.repeat(before[:, start] - share[:, start], length, axis=1)
    last = np.ceil(before - shift.take(found.group, axis=1)).astype(np.int32)
    rays = np.diff(last, axis=1, prepend=0)
    rays[:, start] = last[:, start]
    member, pair = np.nonzero((rays > 0) & (share > 0.0))
    chosen = member, pair
    return _Draw(
        member,
        pair,
        rays[chosen].astype(np.int64),
        (last[chosen] - rays[chosen]).astype(np.int64),
        before[chosen] - share[chosen],
        share[chosen].astype(np.float64),
    )


def _tried(
    tree: LightTree, rays: RayScene, places: _Places, node: Ints, at: Ints, draw: _Draw
) -> tuple[Ints, Singles, Singles]:
    """The light each ray asks for a place of, whether that is seen, and what it sends unoccluded for its flux, (r,).

    Parameters
    ----------
    node, at : (p,) int
        Nodes and receivers of what was drawn.
    """
    points, normals, lift = (v.reshape(-1, 3) for v in (places.points, places.normals, places.lift))
    shifts = places.shifts.reshape(-1, 2)
    receiver, number = at.repeat(draw.rays), _numbers(draw)
    # The place of a ray within its node tells the light and, within the light, how far from the first corner it ends.
    within = (number + shifts[:, 0][receiver] - draw.lower.repeat(draw.rays)) / draw.width.repeat(draw.rays)
    low, high = tree.flux_before[tree.first[node]], tree.flux_before[tree.last[node]]
    flux = low.repeat(draw.rays) + np.clip(within, 0.0, 1.0) * (high - low).repeat(draw.rays)
    light = np.searchsorted(tree.flux_before, flux, side="right") - 1
    light = np.clip(light, tree.first[node].repeat(draw.rays), (tree.last[node] - 1).repeat(draw.rays))
    before = tree.flux_before[light]
    # Beside a bright light, a faint one adds nothing to the sum.
    own = np.maximum(tree.flux_before[light + 1] - before, np.finfo(np.float64).tiny)
    away = np.sqrt(np.clip((flux - before) / own, 0.0, 1.0)).astype(np.float32)
    across = np.mod(number * GOLDEN + shifts[:, 1][receiver], 1.0).astype(np.float32) * away
    corners, facing = tree.single_corners.take(light, axis=0), tree.normals.take(light, axis=0)
    place = corners[:, 0] * (1.0 - away)[:, None]
    place += corners[:, 1] * (away - across)[:, None]
    place += corners[:, 2] * across[:, None]
    origins, back = rays.lifted(points, lift)
    base = ((tree.origin - points) * rays.scale + back).astype(np.float32)
    toward = place * np.float32(rays.scale) + base.take(receiver, axis=0)
    # Lifted off the light, as rays are off their surfaces.
    toward += facing * np.float32(OFFSET)
    height = np.einsum("rx,rx->r", toward, normals.astype(np.float32).take(receiver, axis=0))
    front = -np.einsum("rx,rx->r", toward, facing)
    square = np.einsum("rx,rx->r", toward, toward)
    weight = np.maximum(height, 0.0) * np.maximum(front, 0.0) / np.maximum(square * square, np.finfo(np.float32).tiny)
    ask = np.flatnonzero(weight > 0.0)
    seen = np.zeros(len(weight), dtype=np.float32)
    seen[ask] = rays.visible(origins.take(receiver[ask], axis=0), toward[ask][:, None])[:, 0]
    # What a smooth shading normal sees below its face is dark.
    seen *= np.einsum("rx,rx->r", toward, lift.astype(np.float32).take(receiver, axis=0)) > -OFFSET
    return light, seen, weight


def _numbers(draw: _Draw) -> Ints:
    """The number of each ray among its receiver's, (r,)."""
    end = np.cumsum(draw.rays)
    numbers: Ints = np.arange(draw.rays.sum()) + (draw.first - end + draw.rays).repeat(draw.rays)
    return numbers


def _visible_shares(
    count: int, draw: _Draw, at: Ints, light: Floats, seen: Singles, weight: Singles, shadow_rays: int
) -> tuple[Floats, Floats]:
    """Visible shares of the p nodes and then of the strips of each receiver, and the variance of its light (n,).

    Of a node that gets fewer than `RAYS_TOGETHER` rays, that of the strips that it lies in is to be taken.

    Parameters
    ----------
    count : int
        Receivers.
    at : (p,) int
    light : (n,) float32
        What a ray stands for.
    seen, weight : (r,)
        Of the rays.
    """
    strips, pairs = _strips(shadow_rays), len(at)
    receiver = at.repeat(draw.rays)
    part = _part_of_ray(draw, at, shadow_rays)
    size = pairs + count * strips
    tried, got = np.bincount(part, weight, size), np.bincount(part, weight * seen, size)
    # Where no ray counts, all that the receiver has must do.
    all_tried, all_got = np.bincount(receiver, weight, count), np.bincount(receiver, weight * seen, count)
    mean = np.divide(all_got, all_tried, out=np.zeros(count), where=all_tried > 0.0)
    receiver_of_part = np.concatenate([at, np.arange(count).repeat(strips)])
    share = np.divide(got, tried, out=mean[receiver_of_part], where=tried > 0.0)
    rays_of = np.bincount(part, minlength=size)
    # Rays on one triangle are a lattice; those of several nodes may be as bad as independent ones.
    alone = rays_of**2 / np.maximum(rays_of - 1, 1)
    gain = np.where(np.arange(size) < pairs, LATTICE_ERROR**2 * np.sqrt(rays_of), alone)
    variance = share * (1.0 - share) * gain * light[receiver_of_part] ** 2
    return share, np.bincount(receiver_of_part, variance, count)


def _strips(shadow_rays: int) -> int:
    """Of each receiver."""
    return shadow_rays // RAYS_TOGETHER + 1


def _part_of_ray(draw: _Draw, at: Ints, shadow_rays: int) -> Ints:
    """The node of the p that each ray is one of, or p and the number of its strip, where it gets too few, (r,).

    Parameters
    ----------
    at : (p,) int
        Receivers of the nodes.
    """
    own, pairs = draw.rays >= RAYS_TOGETHER, len(at)
    strip = pairs + at.repeat(draw.rays) * _strips(shadow_rays) + _numbers(draw) // RAYS_TOGETHER
    return np.where(own.repeat(draw.rays), np.arange(pairs).repeat(draw.rays), strip)
