# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Indirect light on meshes that are denser than the light on them asks for.

Where a mesh came with faces that are smaller than any that would be split, light is gathered at about a quarter of the
vertices, no two of them neighbours, and the others take a mean of those around that has their place and their normal.
How good that is, the gathered ones tell: each of them, too, has others around, which are farther off than those of the
vertices between. Where they are wrong about it, all are gathered.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from .direct import LUMINANCE
from .error_estimate import lit_area
from .gather import Gathered, Mixture
from .geometry import lengths
from .met_places import weighted
from .receivers import Receivers
from .sampling import Singles, hashed
from .scene import Floats, Ints

FEWEST = 1024
"""Receivers on dense meshes below which all are gathered: it would not be worth the thought."""

MOST_NEIGHBOURS = 8
"""Of a receiver that light may be interpolated at; there are about six in an even mesh."""

LEAST_COSINE = 0.5
"""Of the angle between the normals of neighbours: sharper edges are borders."""

MOST_PARENTS = 8
"""Receivers that a mean is of, the nearest."""

MOST_NEARBY = 12
"""Gathered receivers within two edges that are thought of."""

FARTHER = 2.5
"""Times that the gathered ones may be wrong about each other. They are farther apart than from those in between, and
what is missed grows as the square; on the statue of `bench/scenes.py`, 2.6 times."""

LEANING = 0.1
"""Difference between shading normal and the surface's own from which on too many rays are below the surface."""

SHARE_OF_TOLERANCE = 0.75
"""Share of the tolerance of interpolation that a mean may miss."""

FEWEST_TOLD = 2
"""Of those that a mean is of, so many must have others around that have their place and normal as well."""

SAME_NORMAL = 0.03
"""How far a mean may be off in normal."""

PLACE = 0.3
"""How much a mean counts as off that is off in place by the distance of those that it is of, in that of normals."""

LARGEST_WEIGHTS = 2.0
"""Sum of the weights without their sign: a mean that reaches beyond what it is of makes noise larger."""

UNEVEN = 1e-3
"""How much less a mean that is uneven counts than one that is off, in squares of distance and normal."""

SEED = 301


def gather_sparsely(
    places: Receivers, strict: Floats, indirect_at: Callable[[Receivers], Gathered], longest: float, tolerance: float
) -> Gathered:
    """Indirect light at receivers of faces, of which those on dense meshes are gathered in part.

    Parameters
    ----------
    places : Receivers
        With `of_corner`.
    strict : (n,) float
        How many times more errors count there.
    indirect_at : callable
        Gathers indirect light.
    longest : float, scene units
        Faces below this size are dense.
    tolerance : float
        RMS error of interpolation over the surface, relative to the mean.
    """
    dense, around = _dense_neighbours(places, longest)
    if np.count_nonzero(dense) < FEWEST:
        return indirect_at(places)
    chosen = _apart(dense, around)
    first = np.flatnonzero(chosen | ~dense)
    gathered = indirect_at(places.taken(first))
    number = np.full(len(dense), -1, dtype=np.int64)
    number[first] = np.arange(len(first))

    own = np.flatnonzero(dense)
    near = _nearby(own, around, chosen)
    parents, some = _nearest(places, own, near)
    weights, even = _even_weights(places, own, parents, some)
    told = np.flatnonzero(chosen[own])
    off = _excess(places, gathered, number, own[told], _others(own, around, near, told))
    share = places.sizes[first] ** 2 * np.where(chosen[first], len(own) / len(told), 1.0)
    allowed = SHARE_OF_TOLERANCE * tolerance * lit_area(share, share * (gathered.irradiance @ LUMINANCE))[1]
    # One that is off is so by its noise; not so the mean of some.
    excess = np.full(len(dense), np.inf)
    excess[own[told]] = off
    known = some & np.isfinite(excess[parents])
    square = np.where(known, excess[parents], 0.0).sum(axis=1) / np.maximum(known.sum(axis=1), 1)
    usable = ~(gathered.hidden | gathered.touching)
    parents = np.where(some, number[parents], 0)
    good = even & ~chosen[own] & (known.sum(axis=1) >= FEWEST_TOLD) & (square <= (FARTHER * allowed / strict[own]) ** 2)
    good &= (usable[parents] | (weights == 0.0)).all(axis=1)

    which = own[good]
    mixture = Mixture(which, gathered, parents[good], weights[good])
    others = mixture.others(len(dense))
    more = others[number[others] < 0]
    number[more] = len(first) + np.arange(len(more))
    return mixture.with_others(gathered.joined(indirect_at(places.taken(more)), number[others]))


def _dense_neighbours(places: Receivers, longest: float) -> tuple[NDArray[np.bool_], Ints]:
    """Receivers on dense faces, (n,) bool, and those around each, (d, MOST_NEIGHBOURS) by number; itself as filling."""
    of_corner, count = places.of_corner, len(places.points)
    dense = (places.sizes < longest) & ~places.inward.any(axis=1)
    dense &= lengths(places.normals - places.lift) < LEANING
    start = np.concatenate([of_corner, np.roll(of_corner, -1, axis=1)]).ravel()
    end = np.concatenate([np.roll(of_corner, -1, axis=1), of_corner]).ravel()
    both = dense[start] & dense[end]
    key = np.unique(start[both] * np.int64(count) + end[both])
    start, end = key // count, key % count
    smooth = np.einsum("ex,ex->e", places.normals[start], places.normals[end]) > LEAST_COSINE
    start, end = start[smooth], end[smooth]
    degree = np.bincount(start, minlength=count)
    dense &= (degree > 0) & (degree <= MOST_NEIGHBOURS)
    number = np.cumsum(dense) - 1
    around = np.repeat(np.flatnonzero(dense)[:, None], MOST_NEIGHBOURS, axis=1)
    place = np.arange(len(start)) - (np.cumsum(degree) - degree)[start]
    both = dense[start] & dense[end]
    around[number[start[both]], place[both]] = end[both]
    return dense, around


def _apart(dense: NDArray[np.bool_], around: Ints) -> NDArray[np.bool_]:
    """Receivers no two of which are neighbours, though all others have one of them beside, (n,) bool (Luby 1986)."""
    own = np.flatnonzero(dense)
    rank = np.full(len(dense), np.inf)
    rank[own] = hashed(own, 1, SEED)[:, 0]
    chosen = np.zeros(len(dense), dtype=bool)
    undecided = np.arange(len(own))
    while len(undecided):
        at, beside = own[undecided], around[undecided]
        # A receiver is its own neighbour where it has fewer.
        first = (rank[beside] >= rank[at][:, None]).all(axis=1)
        chosen[at[first]] = True
        decided = first | chosen[beside].any(axis=1)
        rank[at[decided]] = np.inf
        undecided = undecided[~decided]
    return chosen


def _nearby(own: Ints, around: Ints, chosen: NDArray[np.bool_]) -> Ints:
    """The chosen receivers within two edges of each of `own` (d,), (d, k), ascending behind -1 for none."""
    row = np.zeros(len(chosen), dtype=np.int64)
    row[own] = np.arange(len(own))
    two = np.concatenate([around, around[row[around]].reshape(len(own), -1)], axis=1)
    near = _distinct(np.where(chosen[two], two, -1))
    return near[:, -MOST_NEARBY:]


def _others(own: Ints, around: Ints, near: Ints, told: Ints) -> Ints:
    """The chosen receivers within three edges of some of `own`, without themselves, (t, k)."""
    row = np.zeros(int(own[-1]) + 1, dtype=np.int64)
    row[own] = np.arange(len(own))
    three = near[row[around[told]]].reshape(len(told), -1)
    return _distinct(np.where(three != own[told][:, None], three, -1))


def _distinct(numbers: Ints) -> Ints:
    """Each row's numbers in order, -1 in place of those that are there twice."""
    numbers = np.sort(numbers, axis=1)
    numbers[:, 1:][numbers[:, 1:] == numbers[:, :-1]] = -1
    return np.sort(numbers, axis=1)


def _nearest(places: Receivers, own: Ints, near: Ints) -> tuple[Ints, NDArray[np.bool_]]:
    """The nearest of those near receivers `own` (d,) except themselves, (d, MOST_PARENTS), ascending; which are any."""
    distance = np.full(near.shape, np.inf)
    some, column = np.nonzero((near >= 0) & (near != own[:, None]))
    distance[some, column] = lengths(places.points[near[some, column]] - places.points[own[some]])
    nearest = np.sort(np.argsort(distance, axis=1, kind="stable")[:, :MOST_PARENTS], axis=1)
    found = np.isfinite(np.take_along_axis(distance, nearest, axis=1))
    return np.where(found, np.take_along_axis(near, nearest, axis=1), 0), found


def _excess(places: Receivers, gathered: Gathered, number: Ints, told: Ints, near: Ints) -> Floats:
    """Square of how far those near are off about receivers `told` (t,), as far as it is more than noise, (t,)."""
    parents, some = _nearest(places, told, near)
    weights, even = _even_weights(places, told, parents, some)
    luminance, noise = gathered.irradiance @ LUMINANCE, gathered.noise**2
    parents, here = np.where(some, number[parents], 0), number[told]
    off = weighted(weights, luminance, parents) - luminance[here]
    result: Floats = np.where(even, off**2 - weighted(weights**2, noise, parents) - noise[here], np.inf)
    return result


def _even_weights(
    places: Receivers, own: Ints, parents: Ints, some: NDArray[np.bool_]
) -> tuple[Singles, NDArray[np.bool_]]:
    """Weights (d, k) of means that have the places and normals of `own` (d,), and whether they have them, (d,) bool.

    Of all weights that add up to one, those with the least sum of squares of how far the mean is off, and, which counts
    less, of themselves times the distances.
    """
    way = places.points[parents] - places.points[own][:, None]
    distance = np.where(some, lengths(way), 0.0)
    apart = np.sqrt((distance**2).sum(axis=1) / np.maximum(some.sum(axis=1), 1))
    apart[apart == 0.0] = 1.0
    way *= PLACE / apart[:, None, None]
    turned = places.normals[parents] - places.normals[own][:, None]
    off = np.concatenate([way, turned], axis=2)
    off[~some] = 0.0
    matrix = off @ off.transpose(0, 2, 1)
    diagonal = np.arange(parents.shape[1])
    square = (distance / apart[:, None]) ** 2
    matrix[:, diagonal, diagonal] += np.where(some, UNEVEN * (square + UNEVEN), 1.0)
    weights = np.linalg.solve(matrix, some.astype(np.float64)[:, :, None])[:, :, 0]
    total = weights.sum(axis=1, keepdims=True)
    weights = np.divide(weights, total, out=np.zeros_like(weights), where=total > 0.0)
    mean_off = np.einsum("dk,dkx->dx", weights, off)
    even = some.any(axis=1) & (np.abs(weights).sum(axis=1) <= LARGEST_WEIGHTS)
    even &= lengths(mean_off) <= SAME_NORMAL
    return weights.astype(np.float32), even
