# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Where walls pass through triangles, or stand on them: lines on which what a triangle sees and gets breaks off.

A wall of single faces that goes on below the floor is lit by the room above it and by the sky below. Both sides of
the floor are lit, so it hides nothing by itself; but no light goes from one part of the wall to the other.
"""

from __future__ import annotations

from dataclasses import dataclass, fields

import numpy as np
from numpy.typing import NDArray

from .geometry import cross, largest_edges, lengths, order_along_curve, side_normals
from .scene import Floats, Ints
from .surfaces import Surfaces
from .visibility import RayScene

CRACK, CRACK_OF_TRIANGLE = 1e-3, 0.05
"""A wall that ends closer to a triangle than this share of its piece's size, and of its own longest edge, stands on
it: less light passes below than is worth telling."""

LEAST_SINE = 0.05
"""Of the angle between two triangles that meet along a line to speak of: 3 degrees. Sheets in one plane meet
everywhere."""

SAME_LINE = 1e-4
"""Share of a triangle's size within which two lines on it are one."""

LEAST_CROSSED = 1.0 / 8.0
"""Of triangles smaller than patches, those that are smaller than so much of their size stay whole."""

LEAST_LINE = 0.5
"""Share of a triangle's size, or the size of a patch, that a line is long at least: around the leg of a table rays tell
what it covers."""

LARGEST_THICKNESS = 2.0
"""In sizes of the smallest patch: through what is thicker no patch near it reaches. Where it covers a part of one, rays
tell."""

LEAST_SLENDERNESS = 4.0
"""Times its thickness that a solid is long at least where it counts as a wall: blocks and legs are not."""

LINES_OF_PATCHES, FEWEST_LINES = 0.5, 64
"""Lines for each square of a patch's size that the area has, at most, the longest ones, but so many in any case: the
leaves of a tree cross each other everywhere, and to cut them would make many times the patches that they are worth."""

HEIGHT = 0.05
"""In sizes of the smallest patch: how high above a surface a ray tells how thick is what stands there."""

QUERIES_AT_ONCE = 2**16
"""Triangles that are looked up in the boxes at once."""


@dataclass(frozen=True, eq=False)
class Crossings:
    """Lines on triangles, each along which one sheet or more cross it or stand on it.

    Attributes
    ----------
    triangle : (k,) int
    across : (k, 3) float, unit
        In the triangle's plane, square to the line.
    offset : (k,) float, scene units
        The line is where `across` times the way from the triangle's first corner is this.
    along : (k, 3) float, unit
    low, high : (k,) float, scene units
        Where the line begins and ends, there or beyond, as `along` times that way.
    """

    triangle: Ints
    across: Floats
    offset: Floats
    along: Floats
    low: Floats
    high: Floats

    def taken(self, which: NDArray[np.bool_] | Ints) -> Crossings:
        """Some of the lines."""
        return Crossings(*(getattr(self, field.name)[which] for field in fields(Crossings)))

    @staticmethod
    def none() -> Crossings:
        """No line at all."""
        nothing, vectors = np.zeros(0), np.zeros((0, 3))
        return Crossings(np.zeros(0, dtype=np.int64), vectors, nothing, vectors, nothing, nothing)


def find_crossings(surfaces: Surfaces, rays: RayScene, lit: NDArray[np.bool_], smallest: float) -> Crossings:
    """Find the lines along which sheets and thin walls cross triangles.

    Parameters
    ----------
    lit : (shells, 2) bool
        Front and back: whether light reaches them.
    smallest : float, scene units
        The minimum size n of patches. What is far smaller is neither cut nor cuts anything.
    """
    shell = surfaces.shell_of_triangle
    large = surfaces.areas >= (LEAST_CROSSED * smallest) ** 2
    cutters = np.flatnonzero((lit.all(axis=1)[shell] | large) & lit.any(axis=1)[shell] & surfaces.seen)
    asked = np.flatnonzero(lit.any(axis=1)[shell] & large)
    if len(cutters) == 0:
        return Crossings.none()
    crack = _cracks(surfaces)
    boxes = _Boxes(surfaces.points[surfaces.triangles[cutters]], crack[cutters])
    parts, thick = [Crossings.none()], [np.zeros(0)]
    for first in range(0, len(asked), QUERIES_AT_ONCE):
        some = asked[first : first + QUERIES_AT_ONCE]
        row, item = boxes.near(surfaces.points[surfaces.triangles[some]], surfaces.normals[some])
        lines, cutter = _lines(surfaces, some[row], cutters[item], crack)
        parts.append(lines)
        thick.append(_thickness(surfaces, rays, lit, lines, cutter, HEIGHT * smallest))
    found = Crossings(*(np.concatenate([getattr(p, field.name) for p in parts]) for field in fields(Crossings)))
    lines, thickness = _merged(found, np.concatenate(thick), surfaces)
    size = largest_edges(surfaces.points, surfaces.triangles[lines.triangle])
    shortest, length = np.minimum(smallest, LEAST_LINE * size), lines.high - lines.low
    corners = surfaces.points[surfaces.triangles[lines.triangle]]
    way = corners - corners[:, :1]
    beside = np.einsum("kx,kjx->kj", lines.across, way) - lines.offset[:, None]
    # What runs along an edge cuts nothing.
    within = np.minimum(beside.max(axis=1), -beside.min(axis=1)) > SAME_LINE * size
    enters, leaves = _sections(beside, np.einsum("kx,kjx->kj", lines.along, way))
    divides = within & (lines.low < enters + SAME_LINE * size) & (lines.high > leaves - SAME_LINE * size)
    thin = (thickness < LARGEST_THICKNESS * smallest) & (length > LEAST_SLENDERNESS * thickness)
    kept = np.flatnonzero((thin | divides) & (length > shortest))
    within = within[kept]
    most = max(FEWEST_LINES, int(LINES_OF_PATCHES * float(surfaces.areas.sum()) / smallest**2))
    longest = np.argsort(-length[kept[within]], kind="stable")[:most]
    return lines.taken(np.sort(np.concatenate([kept[~within], kept[within][longest]])))


def _sections(beside: Floats, along: Floats) -> tuple[Floats, Floats]:
    """Where lines enter and leave triangles, (k,), from the corners' distances (k, 3) beside and along them."""
    other_beside, other_along = np.roll(beside, -1, axis=1), np.roll(along, -1, axis=1)
    crossed = (beside > 0.0) != (other_beside > 0.0)
    share = beside / np.where(crossed, beside - other_beside, 1.0)
    place = along + share * (other_along - along)
    return np.where(crossed, place, np.inf).min(axis=1), np.where(crossed, place, -np.inf).max(axis=1)


def _thickness(
    surfaces: Surfaces, rays: RayScene, lit: NDArray[np.bool_], lines: Crossings, cutter: Ints, height: float
) -> Floats:
    """How thick what stands at lines is, (k,), scene units: 0 for what divides two spaces.

    So does what has light on both sides. Where one side is dark, a ray along the surface tells what is there: nothing,
    or another space, as behind a sheet, or the far side of a solid.

    Parameters
    ----------
    cutter : (k,) int
        Triangles that the lines are of.
    height : float, scene units
        Of the ray over the surface.
    """
    shell = surfaces.shell_of_triangle
    asked = np.flatnonzero(~lit.all(axis=1)[shell[cutter]])
    thickness = np.zeros(len(cutter))
    lines, cutter = lines.taken(asked), cutter[asked]
    corners = surfaces.points[surfaces.triangles[lines.triangle]]
    normal, origin = surfaces.normals[lines.triangle], corners[:, 0]
    # The middle of the line on the triangle, raised to where the cutter is, if light comes there.
    own = np.einsum("kx,kjx->kj", lines.along, corners - origin[:, None])
    middle = np.maximum(lines.low, own.min(axis=1)) + np.minimum(lines.high, own.max(axis=1))
    place = origin + lines.across * lines.offset[:, None] + lines.along * middle[:, None] / 2.0
    above = surfaces.points[surfaces.triangles[cutter]].mean(axis=1) - place
    back = np.einsum("kx,kx->k", above, normal) < 0.0
    back ^= ~lit[shell[lines.triangle], back.astype(np.int64)]
    place = place + side_normals(normal, back) * height
    inward = side_normals(surfaces.normals[cutter], lit[shell[cutter], 0])
    start, _ = rays.lifted(place, inward)
    hits = rays.first_hits(start, inward.astype(np.float32))
    solid = (hits.triangle >= 0) & ~lit[shell[hits.triangle], hits.back.astype(np.int64)]
    thickness[asked] = np.where(solid, hits.distance, 0.0) / rays.scale
    return thickness


def _cracks(surfaces: Surfaces) -> Floats:
    """Distance from each triangle within which it stands on another, (t,), scene units."""
    shell, count = surfaces.shell_of_triangle, len(surfaces.closed)
    corners = surfaces.points[surfaces.triangles]
    low, high = np.full((count, 3), np.inf), np.full((count, 3), -np.inf)
    np.minimum.at(low, shell, corners.min(axis=1))
    np.maximum.at(high, shell, corners.max(axis=1))
    longest = largest_edges(surfaces.points, surfaces.triangles)
    crack: Floats = np.minimum(CRACK * lengths(high - low)[shell], CRACK_OF_TRIANGLE * longest)
    return crack


class _Boxes:
    """Boxes about triangles, and about two such boxes each, and so on up to one about all.

    Parameters
    ----------
    corners : (n, 3, 3) float
    margin : (n,) float
        By which the boxes are larger than the triangles.
    """

    def __init__(self, corners: Floats, margin: Floats) -> None:
        self._order = order_along_curve(corners.mean(axis=1))
        margin = margin[self._order, None]
        low, high = corners.min(axis=1)[self._order] - margin, corners.max(axis=1)[self._order] + margin
        self._levels = [(low, high)]
        while len(low) > 1:
            if len(low) % 2:
                low, high = np.concatenate([low, low[-1:]]), np.concatenate([high, high[-1:]])
            low, high = np.minimum(low[::2], low[1::2]), np.maximum(high[::2], high[1::2])
            self._levels.append((low, high))

    def near(self, corners: Floats, normals: Floats) -> tuple[Ints, Ints]:
        """Triangles (q, 3, 3) whose boxes, and planes, meet boxes: pairs of numbers, (p,) each."""
        lowest, highest = corners.min(axis=1), corners.max(axis=1)
        offset = np.einsum("qx,qx->q", normals, corners[:, 0])
        query, box = np.arange(len(corners)), np.zeros(len(corners), dtype=np.int64)
        for level in range(len(self._levels) - 1, -1, -1):
            low, high = (bound[box] for bound in self._levels[level])
            meets = ((low <= highest[query]) & (high >= lowest[query])).all(axis=1)
            query, box, low, high = query[meets], box[meets], low[meets], high[meets]
            axis = normals[query]
            middle = np.einsum("px,px->p", axis, low + high) / 2.0 - offset[query]
            near = np.abs(middle) <= np.einsum("px,px->p", np.abs(axis), high - low) / 2.0
            query, box = query[near], box[near]
            if level:
                query, box = np.repeat(query, 2), (2 * box[:, None] + np.arange(2)).ravel()
                inside = box < len(self._levels[level - 1][0])
                query, box = query[inside], box[inside]
        return query, self._order[box]


def _lines(surfaces: Surfaces, triangle: Ints, sheet: Ints, crack: Floats) -> tuple[Crossings, Ints]:
    """Lines along which triangles of sheets cross other triangles, of pairs (p,), and whose lines these are."""
    places = surfaces.place_of_point[surfaces.triangles]
    # Neighbours meet in their common edge.
    apart = ~(places[triangle][:, :, None] == places[sheet][:, None, :]).any(axis=(1, 2))
    triangle, sheet = triangle[apart], sheet[apart]
    normal, other = surfaces.normals[triangle], surfaces.normals[sheet]
    along = cross(normal, other)
    sine = lengths(along)
    steep = sine > LEAST_SINE
    triangle, sheet, normal, other = triangle[steep], sheet[steep], normal[steep], other[steep]
    along, sine = along[steep] / sine[steep, None], sine[steep]
    corners, others = surfaces.points[surfaces.triangles[triangle]], surfaces.points[surfaces.triangles[sheet]]
    across = cross(along, normal)
    corners, others = corners - corners[:, :1], others - corners[:, :1]
    offset = np.einsum("px,px->p", other, others[:, 0]) / np.einsum("px,px->p", other, across)
    low, high = _reach(np.einsum("px,pkx->pk", normal, others), np.einsum("px,pkx->pk", along, others), crack[sheet])
    own = np.einsum("px,pkx->pk", along, corners)
    beside = np.einsum("px,pkx->pk", across, corners) - offset[:, None]
    slack = crack[triangle]
    common = np.minimum(high, own.max(axis=1)) - np.maximum(low, own.min(axis=1))
    met = (common > slack) & (beside.min(axis=1) < slack) & (beside.max(axis=1) > -slack)
    return Crossings(triangle, across, offset, along, low, high).taken(met), sheet[met]


def _reach(height: Floats, along: Floats, crack: Floats) -> tuple[Floats, Floats]:
    """From where to where triangles are no higher than a crack over a plane; the second is lower where none is.

    Parameters
    ----------
    height, along : (p, 3) float
        Of their corners over the plane, and in some direction.
    crack : (p,) float
    """
    low, high = np.full(len(crack), np.inf), np.full(len(crack), -np.inf)

    def count(at: Floats, valid: NDArray[np.bool_]) -> None:
        np.minimum(low, at, out=low, where=valid)
        np.maximum(high, at, out=high, where=valid)

    for k in range(3):
        count(along[:, k], np.abs(height[:, k]) <= crack)
        j = (k + 1) % 3
        for level in (-crack, crack):
            passes = (height[:, k] < level) != (height[:, j] < level)
            rise = np.where(passes, height[:, j] - height[:, k], 1.0)
            share = (level - height[:, k]) / rise
            count(along[:, k] + share * (along[:, j] - along[:, k]), passes)
    return low, high


def _merged(lines: Crossings, thickness: Floats, surfaces: Surfaces) -> tuple[Crossings, Floats]:
    """Join lines that continue each other: a wall of many triangles crosses a floor along one line.

    Parameters
    ----------
    thickness : (k,) float, scene units
        Of what crosses there. The thinnest counts: where it runs through other solids, rays find these.
    """
    if len(lines.triangle) == 0:
        return lines, thickness
    size = largest_edges(surfaces.points, surfaces.triangles[lines.triangle])
    # One direction and its opposite are the same line.
    largest = np.take_along_axis(lines.along, np.abs(lines.along).argmax(axis=1)[:, None], axis=1)
    turn = np.where(largest < 0.0, -1.0, 1.0)
    ends = np.sort(turn[:, 0] * [lines.low, lines.high], axis=0)
    lines = Crossings(lines.triangle, turn * lines.across, turn[:, 0] * lines.offset, turn * lines.along, *ends)
    key = np.column_stack([lines.triangle, np.rint(lines.along / SAME_LINE).astype(np.int64)])
    _, parallel = np.unique(key, axis=0, return_inverse=True)
    parallel = parallel.ravel()
    order = np.lexsort([lines.offset, parallel])
    lines, parallel, size, thickness = lines.taken(order), parallel[order], size[order], thickness[order]
    other = np.ones(len(order), dtype=bool)
    other[1:] = (np.diff(parallel) != 0) | (np.diff(lines.offset) > SAME_LINE * size[1:])
    group = np.cumsum(other)
    order = np.lexsort([lines.low, group])
    group, low, high = group[order], lines.low[order], lines.high[order]
    # The farthest end so far, within each group: groups are moved apart for it.
    apart = group * 2.0 * (np.abs(low).max() + np.abs(high).max())
    farthest = np.maximum.accumulate(high + apart) - apart
    new = np.ones(len(group), dtype=bool)
    new[1:] = (group[1:] != group[:-1]) | (low[1:] > farthest[:-1] + SAME_LINE * size[order[1:]])
    begin = np.flatnonzero(new)
    merged = lines.taken(order[begin])
    farthest = np.maximum.reduceat(high, begin)
    joined = Crossings(merged.triangle, merged.across, merged.offset, merged.along, low[begin], farthest)
    return joined, np.minimum.reduceat(thickness[order], begin)
