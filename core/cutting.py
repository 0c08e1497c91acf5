# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Faces cut where light breaks off on their edges (`cut_edges`), so that each piece takes the light of its own side."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from . import templates
from .cut_edges import CutEdges, along_edges, own_cuts
from .receivers import Receivers
from .scene import Floats, Ints
from .subdivision import Faces

BEFORE_CUT = 0.75
"""Share of the way from the seen end to the cut at which light is gathered, to be drawn on in a straight line: right at
the foot of an object is a contact shadow that is often narrower than the face, and would darken all of it."""

SHORT_WAY = 0.05
"""Share of an edge up to which a cut takes the light of the edge's seen end as it is."""

BEYOND_CUT = 0.004
"""Share of the edge beyond the cut at which the hidden side is gathered: a few times what the search leaves open."""


def cut_receivers(faces: Faces, places: Receivers, cuts: CutEdges) -> tuple[Receivers, Receivers]:
    """Receivers before each cut, for `drawn_to_cut`, and just beyond it, or before it as seen from the other end."""
    before = along_edges(faces, places, cuts, BEFORE_CUT * cuts.change)
    beyond = np.where(cuts.beyond > 0.0, 1.0 - BEFORE_CUT * cuts.beyond, np.minimum(cuts.change + BEYOND_CUT, 1.0))
    return before, along_edges(faces, places, cuts, beyond)


def drawn_to_cut(at_corner: Floats, before_cut: Floats, change: Floats, hidden: NDArray[np.bool_]) -> Floats:
    """Light at cuts, (k, 3), from that at their seen ends and at `BEFORE_CUT` of the way.

    Close to a seen end it is that end's. From an end on the outline itself, on so short a way there is the contact
    shadow alone, and under an object that does not quite touch, darkness; and where the end is in a corner, it was
    gathered aside, but on the way to the cut there are the planes of both walls.

    Parameters
    ----------
    change : (k,) float
        Where the cuts are on their edges.
    hidden : (k,) bool
        Whether the places before the cuts are hidden, which tell nothing of the light beside them.
    """
    drawn = np.maximum(at_corner + (before_cut - at_corner) / BEFORE_CUT, 0.0)
    return np.where((hidden | (change < SHORT_WAY))[:, None], at_corner, drawn)


def values_on_outlines(
    of_corner: Ints, edges: CutEdges, drawn: Floats, sound: NDArray[np.bool_]
) -> tuple[Ints, Floats]:
    """Light at the corners of faces that lie on an outline: that of the side of it that the face is on.

    What was gathered right there is a contact shadow, or the light of both sides. Faces around a vertex that share an
    edge to it, other than along the outline, are on one side; the light drawn along these edges is theirs.

    Parameters
    ----------
    of_corner : (f, 3) int
        Receivers of the corners of the faces' fronts.
    edges : CutEdges
        That end on outlines.
    drawn : (k, 3) float
        Light at their ends, drawn in a straight line.
    sound : (k,) bool
        Edges nothing hides on the way.

    Returns
    -------
    corner : (c,) int
        Numbers of the corners, 3 for each face.
    value : (c, 3) float
    """
    chosen = np.flatnonzero(sound)
    key = (edges.seen[chosen] << 32) | edges.hidden[chosen]
    order = np.argsort(key, kind="stable")
    key, chosen = key[order], chosen[order]
    corners, of_edge = [np.zeros(0, dtype=np.int64)], [np.zeros(0, dtype=np.int64)]
    for step in (1, 2) if len(key) else ():
        wanted = ((np.roll(of_corner, -step, axis=1) << 32) | of_corner).ravel()
        place = np.minimum(np.searchsorted(key, wanted), len(key) - 1)
        corner = np.flatnonzero(key[place] == wanted)
        corners.append(corner)
        of_edge.append(place[corner])
    corner, edge = np.concatenate(corners), np.concatenate(of_edge)
    # The lowest corner that faces are linked with stands for their side.
    side = np.arange(of_corner.size)
    while True:
        lowest = np.full(len(key), of_corner.size)
        np.minimum.at(lowest, edge, side[corner])
        linked = side.copy()
        np.minimum.at(linked, corner, lowest[edge])
        if np.array_equal(linked, side):
            break
        side = linked
    count = np.bincount(side[corner], minlength=of_corner.size)
    own = np.unique(corner)
    value = np.empty((len(own), 3))
    for channel in range(3):
        summed = np.bincount(side[corner], weights=drawn[chosen[edge], channel], minlength=of_corner.size)
        value[:, channel] = summed[side[own]] / count[side[own]]
    return own, value


@dataclass(frozen=True, eq=False)
class FaceCuts:
    """The cuts as the faces see them.

    Attributes
    ----------
    point : (s, 3) int
        New point on the edges 0-1, 1-2, 2-0 of each face, -1 where there is none.
    share : (s, 3) float
        Where, from the edge's first corner.
    own : (s, 3) int
        The cut whose two ends are this face's own receivers, -1 where the edge is cut for a neighbour's sake.
    """

    point: Ints
    share: Floats
    own: Ints


def _cuts_of_faces(faces: Faces, of_corner: Ints, cuts: CutEdges) -> tuple[Faces, FaceCuts]:
    """Make one new point for each edge that is cut, and find the cuts of each face's edges."""
    start, end = faces.corners, np.roll(faces.corners, -1, axis=1)
    key, forward = _edge_keys(faces.places, start, end)
    cut_key, cut_forward = _edge_keys(faces.places, cuts.start, cuts.end)
    unique, first = np.unique(cut_key, return_index=True)
    place = np.minimum(np.searchsorted(unique, key), len(unique) - 1)
    present = unique[place] == key
    from_low = np.where(cut_forward, cuts.share, 1.0 - cuts.share)[first]
    share = np.where(forward, from_low[place], 1.0 - from_low[place])
    point = np.where(present, len(faces.points) + place, -1)
    own = own_cuts(of_corner, cuts, present)
    a, b = cuts.start[first], cuts.end[first]
    t = cuts.share[first, None]
    made = faces.points[a] * (1.0 - t) + faces.points[b] * t
    return Faces(
        np.concatenate([faces.points, made]),
        np.concatenate([faces.places, np.arange(len(faces.points), len(faces.points) + len(made))]),
        np.concatenate([faces.mesh_of_point, faces.mesh_of_point[a]]),
        faces.corners,
        faces.vertices,
        faces.triangle,
        faces.weights,
        faces.node,
    ), FaceCuts(point, share, own)


def _edge_keys(places: Ints, start: Ints, end: Ints) -> tuple[Ints, NDArray[np.bool_]]:
    a, b = places[start], places[end]
    return (np.minimum(a, b) << 32) | np.maximum(a, b), a < b


def _divided(of_corner: Ints, cuts: CutEdges, own: Ints, unseen: NDArray[np.bool_]) -> tuple[Ints, Ints]:
    """Mark in `unseen` (f, 3) the corner of each face that a thin wall leaves alone, as if it were hidden.

    Returns
    -------
    own : (f, 3) int
        The same without cuts by walls that end or meet within the face.
    start : (f, 3) int
        Corner of the face that each cut begins at.
    """
    by_wall = (own >= 0) & (cuts.beyond[own] > 0.0)
    divided = (by_wall.sum(axis=1) == 2) & ~unseen.any(axis=1)
    face = np.flatnonzero(divided)
    unseen[face, (np.argmin(by_wall[face], axis=1) + 2) % 3] = True
    corner = np.arange(3)
    start = np.where(of_corner == cuts.seen[own], corner, (corner + 1) % 3)
    return np.where(by_wall & ~divided[:, None], -1, own), start


def cut_faces(
    faces: Faces,
    face: Ints,
    places: Receivers,
    hidden: NDArray[np.bool_],
    cuts: CutEdges,
    values: Floats,
    seen_value: Floats,
    hidden_value: Floats,
) -> tuple[Faces, Ints, Floats]:
    """Cut faces at the cuts of their edges, and give the pieces the values of their side.

    Parameters
    ----------
    face : (f,) int
        Face of each face side with values: all fronts in order, then some backs.
    values : (f, 3, 3) float
        At their corners: of the fronts as gathered, hidden or not.
    seen_value, hidden_value : (k, 3) float
        On the two sides of each cut, that of its start and that of its end.

    Returns
    -------
    faces : Faces
    face : (g,) int
    values : (g, 3, 3) float
        The same for the new faces.
    """
    if len(cuts.start) == 0:
        return faces, face, values
    count = len(faces.triangle)
    of_corner = places.of_corner[:count]
    faces, on_face = _cuts_of_faces(faces, of_corner, cuts)
    six = np.concatenate([faces.corners, on_face.point], axis=1)
    member, piece = templates.cut(faces.points, six, on_face.point >= 0)
    row = member[:, None]
    unseen = hidden[of_corner]
    own, start = _divided(of_corner, cuts, on_face.own, unseen)
    # A piece lies on the side of the corners it has. One between three cuts has none: two of these are on the edges of
    # the corner that is alone on its side, and it lies beyond them, on the side of the other two.
    own_corner = piece < 3
    piece_hidden: NDArray[np.bool_] = np.any(own_corner & unseen[row, np.minimum(piece, 2)], axis=1)
    without = ~own_corner.any(axis=1)
    piece_hidden[without] = unseen[member[without]].sum(axis=1) >= 2
    row_of_back = np.full(count, -1, dtype=np.int64)
    row_of_back[face[count:]] = np.arange(count, len(face))
    with_back = np.flatnonzero(row_of_back[member] >= 0)
    side = np.concatenate([np.arange(len(member)), with_back])
    rows = np.concatenate([member, row_of_back[member[with_back]]])
    new_values = _at_corners_of_pieces(values, rows, on_face.share, member[side], piece[side])
    at, vertex = np.nonzero(~own_corner & (own[row, piece - 3] >= 0))
    edge = piece[at, vertex] - 3
    cut, of_start = own[member[at], edge], unseen[member[at], start[member[at], edge]] == piece_hidden[at]
    new_values[at, vertex] = np.where(of_start[:, None], seen_value[cut], hidden_value[cut])
    weights = _at_corners_of_pieces(faces.weights, member, on_face.share, member, piece)
    corners = six[row, piece]
    new = Faces(
        faces.points,
        faces.places,
        faces.mesh_of_point,
        corners,
        # All light has been gathered: none asks for them any more.
        faces.places[corners],
        faces.triangle[member],
        weights,
        faces.node[member],
    )
    return new, side, new_values


def _at_corners_of_pieces(values: Floats, row: Ints, share: Floats, member: Ints, piece: Ints) -> Floats:
    """Values at the corners of pieces of faces, in a straight line between the faces' own, (g, 3, 3).

    Parameters
    ----------
    values : (n, 3, 3) float
        At the corners of faces.
    row : (g,) int
        Those of each piece.
    share : (f, 3) float
        Where the edges of the faces are cut, from their first corners.
    member : (g,) int
        The face of each piece.
    piece : (g, 3) int
        As of `templates.cut`.
    """
    result: Floats = values[row[:, None], np.minimum(piece, 2)]
    # Of a dense mesh few corners lie on cuts.
    at, vertex = np.nonzero(piece >= 3)
    first = piece[at, vertex] - 3
    t = share[member[at], first][:, None]
    result[at, vertex] = values[row[at], first] * (1.0 - t) + values[row[at], (first + 1) % 3] * t
    return result
