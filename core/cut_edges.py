# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Edges on which light breaks off, and where: at the foot of a block, the rim of a lamp under a ceiling, a thin wall.

Where one corner of a face is hidden and another is not, the light breaks off in between. The edges are searched for the
place by bisection (discontinuity meshing after Heckbert 1992, by visibility instead of geometry).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, fields

import numpy as np
from numpy.typing import NDArray

from .geometry import normalized
from .receivers import Receivers
from .sampling import sequence, triangle_weights
from .scene import Floats, Ints
from .subdivision import Faces

SECTIONS = 8
"""Pieces that an edge is cut into at once to find where it is hidden: many places cost little more than one."""

SEARCHES, ROUGH_SEARCHES = 3, 2
"""Times that the piece found is searched again: the cut is found to a 1/512 of the edge, or to 1/64 of it."""

PLACES_FOR_FEET = 32
"""Places of a face that are asked for a foot between its corners."""

FACES_FOR_FEET = 512
"""Faces whose places are made at once: a few megabytes of them."""

PLACES_ALONG_CUT = (0.15, 0.5, 0.85)
DISTANCE_FROM_CUT = 0.08
"""Where a cut is checked: shares of its length, and the distance from it as a share of the face's width."""

LEAST_PIECE = 0.004
"""Share of the edge that a cut keeps from its ends, so that no sliver is left."""

TINY = np.finfo(np.float64).tiny


@dataclass(frozen=True, eq=False)
class CutEdges:
    """Edges with a hidden and a seen end, each with the place where the one turns into the other.

    Or with two seen ends and something thin in between.

    Attributes
    ----------
    start, end : (k,) int
        Points, start seen and end hidden, or seen as well.
    seen, hidden : (k,) int
        Receivers of the two ends.
    change : (k,) float
        Where the edge stops being seen, 0 at the start.
    share : (k,) float
        Where it is cut: there, unless that is too close to an end.
    border : (k,) bool
        Whether the surface ends at the edge: light is gathered beside it, off the plane of the next wall.
    whole : (k,) bool
        Edges that end on the outline and are not cut: both numbers are 1.
    beyond : (k,) float
        How far the end's side reaches towards the start where the end is seen, too; 0 where it is not.
    """

    start: Ints
    end: Ints
    seen: Ints
    hidden: Ints
    change: Floats
    share: Floats
    border: NDArray[np.bool_]
    whole: NDArray[np.bool_]
    beyond: Floats

    def taken(self, which: NDArray[np.bool_] | Ints) -> CutEdges:
        """Some of the edges."""
        return CutEdges(*(getattr(self, field.name)[which] for field in fields(CutEdges)))

    @staticmethod
    def joined(parts: list[CutEdges]) -> CutEdges:
        """All edges of several lists."""
        return CutEdges(*(np.concatenate([getattr(p, field.name) for p in parts]) for field in fields(CutEdges)))


IsHidden = Callable[[Receivers], NDArray[np.bool_]]


def find_cuts(
    faces: Faces,
    places: Receivers,
    hidden: NDArray[np.bool_],
    is_hidden: IsHidden,
    searches: int = SEARCHES,
    among: NDArray[np.bool_] | None = None,
) -> CutEdges:
    """Search the edges of the faces' fronts.

    Parameters
    ----------
    places : Receivers
        `of_corner` begins with the fronts of all faces, in order.
    hidden : (n,) bool
        Of the receivers.
    is_hidden : callable
        Tells the same of other receivers.
    searches : int
        Each cuts what the last one left open by `SECTIONS`.
    among : (f,) bool or None
        Faces whose edges are searched; None for all.
    """
    (start, end, seen, unseen), border = _edges_from_to(faces, places, ~hidden, hidden, among)
    count = len(start)
    low, width = np.zeros(count), 1.0
    inner = np.arange(1, SECTIONS) / SECTIONS
    for _ in range(searches if count else 0):
        share = (low[:, None] + width * inner).ravel()
        each = np.repeat(np.arange(count), SECTIONS - 1)
        no = np.zeros(len(each), dtype=bool)
        tried = CutEdges(start[each], end[each], seen[each], unseen[each], share, share, border[each], no, 0.0 * share)
        inside = is_hidden(along_edges(faces, places, tried, share)).reshape(count, SECTIONS - 1)
        # The first section whose end is hidden; the last one's end is known to be.
        first = np.where(inside.any(axis=1), inside.argmax(axis=1), SECTIONS - 1)
        low, width = low + first * width / SECTIONS, width / SECTIONS
    high = low + width
    change = (low + high) / 2.0
    share = np.clip(change, LEAST_PIECE, 1.0 - LEAST_PIECE)
    return CutEdges(start, end, seen, unseen, change, share, border, np.zeros(count, dtype=bool), np.zeros(count))


def edges_to_outlines(
    faces: Faces, places: Receivers, hidden: NDArray[np.bool_], touching: NDArray[np.bool_]
) -> CutEdges:
    """Edges of the faces' fronts that end in a vertex on an outline.

    Parameters
    ----------
    places : Receivers
        `of_corner` begins with the fronts of all faces, in order.
    hidden, touching : (n,) bool
        Of the receivers.
    """
    (start, end, seen, at), border = _edges_from_to(faces, places, ~hidden & ~touching, touching)
    ones = np.ones(len(start))
    return CutEdges(start, end, seen, at, ones, ones, border, ones.astype(bool), 0.0 * ones)


def edges_under_walls(faces: Faces, places: Receivers, hidden: NDArray[np.bool_], ways: Floats) -> CutEdges:
    """Edges of the faces' fronts with two seen ends that a thin wall crosses, of faces that it divides.

    Parameters
    ----------
    places : Receivers
        `of_corner` begins with the fronts of all faces, in order.
    hidden : (n,) bool
        Of the receivers.
    ways : (f, 3, 2) float
        As `blocked_edges` has them.
    """
    count = len(faces.triangle)
    of_corner = places.of_corner[:count]
    seen = ~hidden[of_corner].any(axis=1, keepdims=True)
    crossed = (ways < 1.0).all(axis=2) & seen
    crossed &= crossed.sum(axis=1, keepdims=True) == 2
    found = np.flatnonzero(crossed)
    following = np.roll(of_corner, -1, axis=1)
    start, end = of_corner.ravel()[found], following.ravel()[found]
    keys = (np.minimum(of_corner, following) << 32 | np.maximum(of_corner, following)).ravel()
    _, first = np.unique(keys[found], return_index=True)
    _, number, faces_beside = np.unique(keys, return_inverse=True, return_counts=True)
    found, start, end = found[first], start[first], end[first]
    point, next_point = faces.corners.ravel(), np.roll(faces.corners, -1, axis=1).ravel()
    change, beyond = ways.reshape(-1, 2)[found].T
    share = np.clip((change + 1.0 - beyond) / 2.0, LEAST_PIECE, 1.0 - LEAST_PIECE)
    border, no = faces_beside[number[found]] == 1, np.zeros(len(found), dtype=bool)
    return CutEdges(point[found], next_point[found], start, end, change, share, border, no, beyond)


def _edges_from_to(
    faces: Faces,
    places: Receivers,
    start: NDArray[np.bool_],
    end: NDArray[np.bool_],
    among: NDArray[np.bool_] | None = None,
) -> tuple[Ints, NDArray[np.bool_]]:
    """Edges of the fronts of faces from some receivers (n,) to others: points, receivers, (4, k), and border."""
    count = len(faces.triangle)
    receiver = places.of_corner[:count].ravel()
    following = np.roll(places.of_corner[:count], -1, axis=1).ravel()
    point, next_point = faces.corners.ravel(), np.roll(faces.corners, -1, axis=1).ravel()
    turned = start[following] & end[receiver]
    wanted = turned | (start[receiver] & end[following])
    found = np.flatnonzero(wanted if among is None else wanted & np.repeat(among, 3))
    turned = turned[found]
    pairs = np.stack(
        [
            np.where(turned, next_point[found], point[found]),
            np.where(turned, point[found], next_point[found]),
            np.where(turned, following[found], receiver[found]),
            np.where(turned, receiver[found], following[found]),
        ],
        axis=1,
    )
    edges, faces_beside = np.unique(pairs, axis=0, return_counts=True)
    return edges.T, faces_beside == 1


def crooked_faces(
    faces: Faces, places: Receivers, hidden: NDArray[np.bool_], cuts: CutEdges, is_hidden: IsHidden
) -> Ints:
    """Faces that a straight cut does not fit, such as those with the corner of a block on them; indices of faces.

    Beside the line between a face's two cuts, the hidden side is asked whether it is hidden, and the seen one whether
    it is seen.
    """
    if len(cuts.start) == 0:
        return np.zeros(0, dtype=np.int64)
    count = len(faces.triangle)
    of_corner = places.of_corner[:count]
    own = own_cuts(of_corner, cuts, np.ones((count, 3), dtype=bool))
    face = np.flatnonzero((own >= 0).sum(axis=1) == 2)
    if len(face) == 0:
        return face
    corners, unseen = of_corner[face], hidden[of_corner[face]]
    # Barycentric coordinates of the two cuts, and the way from the middle of the seen corners to that of the hidden.
    two = np.argsort(own[face] < 0, axis=1, kind="stable")[:, :2]
    ends = [_cut_weights(faces, face, two[:, k], own, cuts) for k in (0, 1)]
    across = unseen / unseen.sum(axis=1)[:, None] - ~unseen / (~unseen).sum(axis=1)[:, None]
    tests, expected, member = [], [], []
    for along in PLACES_ALONG_CUT:
        on_cut = ends[0] * (1.0 - along) + ends[1] * along
        for step in (-DISTANCE_FROM_CUT, DISTANCE_FROM_CUT):
            weights = on_cut + step * across
            inside = np.flatnonzero((weights > 0.0).all(axis=1))
            tests.append(weights[inside])
            expected.append(np.full(len(inside), step > 0.0))
            member.append(inside)
    weights, at = np.concatenate(tests), np.concatenate(member)
    wrong = is_hidden(within_faces(faces, face[at], places, corners[at], weights)) != np.concatenate(expected)
    return np.unique(face[at[wrong]])


def faces_with_feet(faces: Faces, places: Receivers, among: Ints, is_hidden: IsHidden) -> Ints:
    """Those of the faces `among` that hide some place between their corners: the foot of a leg stands on them."""
    weights = triangle_weights(sequence(0, PLACES_FOR_FEET, 2))
    shares = np.concatenate([1.0 - weights.sum(axis=1, keepdims=True), weights], axis=1)
    found = [np.zeros(0, dtype=np.int64)]
    for first in range(0, len(among), FACES_FOR_FEET):
        some = among[first : first + FACES_FOR_FEET]
        face = np.repeat(some, len(shares))
        inside = within_faces(faces, face, places, places.of_corner[face], np.tile(shares, (len(some), 1)))
        found.append(some[is_hidden(inside).reshape(-1, len(shares)).any(axis=1)])
    return np.concatenate(found)


def _cut_weights(faces: Faces, face: Ints, edge: Ints, own: Ints, cuts: CutEdges) -> Floats:
    """Barycentric coordinates, in each face, of the cut on one of its edges, (f, 3)."""
    row, following = np.arange(len(face)), (edge + 1) % 3
    cut = own[face, edge]
    forward = faces.places[faces.corners[face, edge]] == faces.places[cuts.start[cut]]
    share = np.where(forward, cuts.share[cut], 1.0 - cuts.share[cut])
    weights = np.zeros((len(face), 3))
    weights[row, edge], weights[row, following] = 1.0 - share, share
    return weights


def own_cuts(of_corner: Ints, cuts: CutEdges, present: NDArray[np.bool_]) -> Ints:
    following = np.roll(of_corner, -1, axis=1)
    key = (np.minimum(of_corner, following) << 32) | np.maximum(of_corner, following)
    cut_key = (np.minimum(cuts.seen, cuts.hidden) << 32) | np.maximum(cuts.seen, cuts.hidden)
    order = np.argsort(cut_key, kind="stable")
    place = np.minimum(np.searchsorted(cut_key[order], key), len(order) - 1)
    return np.where(present & (cut_key[order[place]] == key), order[place], -1)


def within_faces(faces: Faces, face: Ints, places: Receivers, corners: Ints, weights: Floats) -> Receivers:
    """Receivers inside faces, at barycentric coordinates (m, 3)."""

    def mixed(values: Floats) -> Floats:
        result: Floats = np.einsum("mk,mkx->mx", weights, values[corners])
        return result

    return Receivers(
        points=np.einsum("mk,mkx->mx", weights, faces.points[faces.corners[face]]),
        normals=normalized(mixed(places.normals)),
        lift=normalized(mixed(places.lift)),
        rise=mixed(places.rise),
        grazing=places.grazing[corners[:, 0]],
        codes=places.codes[corners[:, 0]],
        inward=np.zeros((len(face), 3)),
        sizes=places.sizes[corners].mean(axis=1),
        mesh=places.mesh[corners[:, 0]],
        shell=places.shell[corners[:, 0]],
        of_corner=np.zeros((0, 3), dtype=np.int64),
    )


def along_edges(faces: Faces, places: Receivers, cuts: CutEdges, share: Floats) -> Receivers:
    """Receivers on edges, at a share of the way."""
    t = share[:, None]

    def mixed(values: Floats) -> Floats:
        return values[cuts.seen] * (1.0 - t) + values[cuts.hidden] * t

    # Aside only: along the edge it would move the place that is asked about.
    start, way = faces.points[cuts.start], faces.points[cuts.end] - faces.points[cuts.start]
    ahead = np.einsum("kx,kx->k", mixed(places.inward), way) / np.maximum(np.einsum("kx,kx->k", way, way), TINY)
    inward = np.where(cuts.border[:, None], mixed(places.inward) - ahead[:, None] * way, 0.0)
    return Receivers(
        points=start + way * t + inward,
        normals=normalized(mixed(places.normals)),
        lift=normalized(mixed(places.lift)),
        rise=mixed(places.rise),
        grazing=places.grazing[cuts.seen],
        codes=places.codes[cuts.seen],
        inward=inward,
        sizes=places.sizes[cuts.seen] * (1.0 - share) + places.sizes[cuts.hidden] * share,
        mesh=places.mesh[cuts.seen],
        shell=places.shell[cuts.seen],
        of_corner=np.zeros((0, 3), dtype=np.int64),
    )
