# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Small bright places, such as the ceiling above a lamp: receivers send rays of their own to them.

Rays spread over the hemisphere meet such a place by chance, and it lights the room. So light from it is found
twice over, by the rays of the hemisphere that meet it and by rays that are aimed at it, each weighted by the balance
heuristic (Veach & Guibas 1995): close to such a place the hemisphere's count, far from it the aimed ones. What either
sees there is looked up alike.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .aimed_light import AimedLight
from .balance import Balance
from .cells import SPECIAL, Cells
from .direct_light import DirectLight
from .geometry import order_along_curve
from .lit_points import LitPoints
from .sampling import GOLDEN, Singles, hashed
from .scene import Floats, Ints
from .solve import Solution
from .surfaces import Surfaces
from .visibility import OFFSET, Hits, RayScene

BRIGHT = 2.0
"""Radiance of a bright place over the mean irradiance, over pi, of all surfaces, in one of the channels at least."""

MOST_PLACES = 512
"""Elements that rays are aimed at: those that bring most noise."""

AIMED_SHARE = 0.5
"""Aimed rays for each ray of the hemisphere."""

ENTRY_IN_PLACES = 3
"""What an entry of `AimedLight` takes, in places that rays met."""

LEAST_BEND = 1e-9
"""What the square of the mean normal of a place lacks at least that is bent: of a flat one it is rounding."""

TINY = 1e-30
"""Below any area, and any square of a distance, that rays are traced over."""


@dataclass(frozen=True, eq=False)
class BrightPlaces:
    """Sides of patches that rays are aimed at, each made of the cells on it.

    Attributes
    ----------
    of_place : (places + sky + 3,) int32
        Which of k bright places each place of `Cells` is part of, -1 for none.
    cell_of_place : (places,) int32
        And which of its c cells.
    reach : (places,) float32
        Rays shorter than that see another place than that they met (see `Cells`).
    centre, vector : (k, 3) float, scene units
        Mean place, and the sum of the normals weighted by area over the area.
    radius, area : (k,) float, scene units
    flux : (k,) float
        Area times radiance, in shares of the mean, of the channel where it is brightest.
    place : (c,) int32
        The place of each cell, by bright places and along a curve.
    corners : (c, 3, 3) float, scene units
    normals : (c, 3) float
        Of the side that is bright.
    area_before : (c + 1,) float
        Of all cells before each.
    first : (k + 1,) int
        First cell of each.
    """

    of_place: NDArray[np.int32]
    cell_of_place: NDArray[np.int32]
    reach: Singles
    centre: Floats
    vector: Floats
    radius: Floats
    area: Floats
    flux: Floats
    place: NDArray[np.int32]
    corners: Floats
    normals: Floats
    area_before: Floats
    first: Ints

    def normal_of_place(self, place: NDArray[np.int32]) -> Floats:
        """Normals at places that are bright, (n, 3)."""
        return self.normals[self.cell_of_place[place]]


def bright_places(
    cells: Cells, balance: Balance, solution: Solution, seen: Floats, surfaces: Surfaces, strict: Floats
) -> BrightPlaces | None:
    """The places that bring most noise to the rays of the hemisphere, or None where nothing is much brighter.

    Nor are there any where light is tinted on its way, as each channel then has rays of its own, or mirrored by glass,
    which aimed rays are not.

    Parameters
    ----------
    seen : (places, 3) float
        Radiance of places.
    strict : (m,) float
        How many times more errors count at the elements.
    """
    through = surfaces.transmittance
    if through is not None and (through.channels or through.refraction is not None):
        return None
    dark = ~balance.emission.any(axis=1)
    area = np.where(dark, balance.areas, 0.0)
    mean = area @ solution.incident / max(float(area.sum()), TINY)

    def brightness(radiance: Floats) -> Floats:
        # In the channel where it stands out most: beside a red light, a blue one is dim in luminance.
        shares = np.divide(radiance, mean, out=np.zeros_like(radiance), where=mean > 0.0)
        largest: Floats = shares.max(axis=1)
        return largest

    bright = brightness(solution.reflected)
    exchange = balance.exchange
    each = np.diff(np.append(exchange.start, len(exchange.source)))

    def met_by(weight: Floats) -> Floats:
        total: Floats = np.bincount(
            exchange.source, weight[exchange.receiver].repeat(each) * exchange.factor, len(bright)
        )
        return total

    # What a room takes for bright may be dim beside the street.
    met, counted = met_by(area), met_by(area * strict**2)
    own = balance.elements == balance.base
    noise = np.where(own & (counted * bright**2 > met * BRIGHT**2), counted * bright**2, 0.0)
    chosen = np.argsort(-noise, kind="stable")[:MOST_PLACES]
    chosen = np.sort(chosen[noise[chosen] > 0.0])
    if len(chosen) == 0:
        return None
    number = np.full(int(max(cells.element.max(), balance.elements.max())) + 1, -1, dtype=np.int32)
    number[balance.elements[chosen]] = np.arange(len(chosen))
    sides = 2 * len(cells.node)
    of_place = np.full(len(seen), -1, dtype=np.int32)
    of_place[:sides] = number[cells.element[:sides]]
    of_place[cells.unlit] = -1
    place = np.flatnonzero(of_place >= 0)
    cell = place >> 1
    points = surfaces.points[surfaces.triangles[cells.triangle[cell]]]
    corners = np.einsum("cij,cjx->cix", cells.corners(cell), points)
    middle = corners.mean(axis=1)
    along = np.empty(len(cell), dtype=np.int64)
    along[order_along_curve(middle)] = np.arange(len(cell))
    order = np.lexsort((along, of_place[place]))
    place, cell, corners, middle = place[order], cell[order], corners[order], middle[order]
    owner = of_place[place]
    normals = surfaces.normals[cells.triangle[cell]] * np.where(place & 1, -1.0, 1.0)[:, None]
    sizes = np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1) / 2.0

    def total(values: Floats) -> Floats:
        result: Floats = np.bincount(owner, weights=sizes * values, minlength=len(chosen))
        return result

    area = np.maximum(total(np.ones(len(owner))), TINY)
    centre = np.stack([total(column) / area for column in middle.T], axis=1)
    radius = np.zeros(len(chosen))
    np.maximum.at(radius, owner, np.linalg.norm(corners - centre[owner][:, None], axis=2).max(axis=1))
    cell_of_place = np.full(sides, -1, dtype=np.int32)
    cell_of_place[place] = np.arange(len(place))
    return BrightPlaces(
        np.concatenate([of_place, np.full(SPECIAL + len(surfaces.world) * (surfaces.world.ndim > 1), -1, np.int32)]),
        cell_of_place,
        cells.reach,
        centre,
        np.stack([total(column) / area for column in normals.T], axis=1),
        radius,
        area,
        total(brightness(seen[place])),
        place.astype(np.int32),
        corners,
        normals,
        np.concatenate([[0.0], np.cumsum(sizes)]),
        np.searchsorted(owner, np.arange(len(chosen) + 1)),
    )


def shares_of_rays(bright: BrightPlaces, points: Floats, normals: Floats) -> Floats:
    """Share of its aimed rays that each receiver sends to each bright place, (n, k); rows of zeros where it sees none.

    By what a disk of its size would send, and a little where it may be turned away. Of a bent place, such as a ring
    of faces within a lampshade, some look farther to the side than their mean normal does: as much as makes it short.
    """
    way = bright.centre - points[:, None]
    square = np.einsum("nkx,nkx->nk", way, way)
    distance = np.sqrt(np.maximum(square, TINY))
    size = np.minimum(bright.radius / distance, 1.0)
    height = np.einsum("nkx,nx->nk", way, normals) / distance
    facing = -np.einsum("nkx,kx->nk", way, bright.vector) / distance
    bend = 1.0 - np.einsum("kx,kx->k", bright.vector, bright.vector)
    facing += np.sqrt(np.where(bend > LEAST_BEND, bend, 0.0))
    light = np.clip(height + size, 0.0, 1.0) * np.clip(facing + size, 0.0, 1.0) * (height > -size)
    light *= bright.flux / (square + bright.radius**2)
    whole = light.sum(axis=1, keepdims=True)
    shares: Floats = np.divide(light, whole, out=np.zeros_like(light), where=whole > 0.0)
    return shares


def most_of_aimed(hemisphere: int) -> int:
    """What light of bright places takes at most beside so many rays of the hemisphere, in places that rays met."""
    return int(AIMED_SHARE * hemisphere) * ENTRY_IN_PLACES


def aimed_light(
    bright: BrightPlaces,
    rays: RayScene,
    at: LitPoints,
    found: Hits,
    places: NDArray[np.int32],
    seed: int,
) -> AimedLight:
    """How much of the radiance of bright places arrives at receivers.

    With r rays of the hemisphere of density p and s aimed ones of density q at a place, per area, each that arrives
    there counts p / (r p + s q).

    Parameters
    ----------
    at : LitPoints
        The n receivers.
    found : Hits
        What the rays of the hemisphere met, (n * r,), and
    places : (n, r) int32
        which places.
    """
    count, spread = places.shape
    aimed = int(AIMED_SHARE * spread)
    share = shares_of_rays(bright, at.points, at.normals)
    density = aimed * share / (bright.area * rays.scale**2)
    which = bright.of_place[places]
    met_by, ray = np.nonzero(which >= 0)
    hit, met = met_by * spread + ray, places[met_by, ray]
    way = found.directions[hit].astype(np.float64)
    facing = np.abs(np.einsum("rx,rx->r", way, bright.normal_of_place(met)))
    height = np.einsum("rx,rx->r", way, at.normals[met_by])
    chance = _chance(height, facing, found.distance[hit].astype(np.float64) ** 2)
    weight = chance / np.maximum(spread * chance + density[met_by, which[met_by, ray]], TINY)

    receiver, number, kind, cell, target = _targets(bright, share, aimed, seed)
    origins, back = rays.lifted(at.points, at.lift)
    way = (target - at.points[receiver]) * rays.scale
    toward = (way + back[receiver] + bright.normals[cell] * OFFSET).astype(np.float32)
    square = np.maximum(np.einsum("rx,rx->r", way, way), TINY)
    height = np.einsum("rx,rx->r", way, at.normals[receiver]) / np.sqrt(square)
    facing = -np.einsum("rx,rx->r", way, bright.normals[cell]) / np.sqrt(square)
    # What a smooth shading normal sees below its face is dark.
    above = np.einsum("rx,rx->r", toward, at.lift[receiver]) > -OFFSET
    far = square > bright.reach[bright.place[cell]].astype(np.float64) ** 2
    asked = np.flatnonzero((height > 0.0) & (facing > 0.0) & above & far)
    receiver, number, kind, cell = receiver[asked], number[asked], kind[asked], cell[asked]
    through = rays.of_sight().visible(origins[receiver], toward[asked][:, None])[:, 0]
    chance = _chance(height[asked], facing[asked], square[asked])
    aimed_weight = through * chance / (spread * chance + density[receiver, kind])

    receiver = np.concatenate([met_by, receiver])
    place = np.concatenate([met, bright.place[cell]])
    weights = np.concatenate([weight, aimed_weight]).astype(np.float32)
    odd = np.concatenate([ray, number]) & 1
    halves = (np.flatnonzero(odd == half) for half in (0, 1))
    return AimedLight(*(DirectLight.of(count, receiver[half], place[half], weights[half]) for half in halves))


def _chance(height: Floats, facing: Floats, square: Floats) -> Floats:
    """Density of rays of the hemisphere at places that they meet, per area."""
    density: Floats = height * facing / (np.pi * np.maximum(square, TINY))
    return density


def _targets(bright: BrightPlaces, share: Floats, aimed: int, seed: int) -> tuple[Ints, Ints, Ints, Ints, Floats]:
    """Where receivers aim at: receiver, number of the ray, bright place, cell, and a point on it (m, 3).

    At equal steps over the shares and, within a bright place, over the area of its cells; the same for all receivers.

    Parameters
    ----------
    share : (n, k) float
        See `shares_of_rays`.
    """
    shift = hashed(np.zeros(1, dtype=np.int64), 2, seed)[0]
    seeing = np.flatnonzero(share.any(axis=1))
    row, number = np.repeat(np.arange(len(seeing)), aimed), np.tile(np.arange(aimed), len(seeing))
    before = np.cumsum(share[seeing], axis=1)
    before /= before[:, -1:]
    along = (number + shift[0]) / aimed
    last = np.searchsorted((before + np.arange(len(before))[:, None]).ravel(), along + row, side="right")
    kind = np.clip(last - share.shape[1] * row, 0, share.shape[1] - 1)
    receiver = seeing[row]
    own = np.maximum(share[receiver, kind], TINY)
    within = np.clip(1.0 - (before[row, kind] - along) / own, 0.0, 1.0)
    area = bright.area_before[bright.first[kind]] + within * bright.area[kind]
    cell = np.searchsorted(bright.area_before, area, side="right") - 1
    cell = np.clip(cell, bright.first[kind], bright.first[kind + 1] - 1)
    size = np.maximum(bright.area_before[cell + 1] - bright.area_before[cell], TINY)
    away = np.sqrt(np.clip((area - bright.area_before[cell]) / size, 0.0, 1.0))
    across = np.mod(number * GOLDEN + shift[1], 1.0) * away
    weights = np.stack([1.0 - away, away - across, across], axis=1)
    return receiver, number, kind, cell, np.einsum("rk,rkx->rx", weights, bright.corners[cell])
