# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The light that was gathered at the vertices, as rays see it: interpolated over the faces, cell by cell.

A patch has one radiosity, however light changes across it. What was gathered at the vertices is finer and less noisy,
so the rays of the gather look a second time, at what they found themselves: one more bounce of the solution, on the
finest mesh there is, without tracing.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from .cells import SPECIAL, Cells
from .direct import LUMINANCE
from .divisions import Divisions
from .lit import Lit
from .met_places import MetPlaces
from .patches import PatchTree
from .sampling import Singles
from .scene import Floats, Ints
from .world import MAP_CELLS

STEEP = 1.0
"""Difference between a face's corners, relative to their mean, above which a face that is a whole patch shows the
patch's own radiosity: what was gathered at three points says less of its mean than rays from all over it."""

MOST_CORRECTED = 0.1
"""Share by which the light at the vertices is made to agree with the patches' power at most."""

WAYS_OUT = (0.25, 0.5, 0.75, 0.99)
"""Shares of the way from the middle of a cell to its corners at which faces that are not hidden are looked for. What
reaches out of a convex foot has a corner of the cell, of which rounding must not make its neighbour's."""

MET_AT_ONCE = 2**17
"""Places met by rays that are looked through at once."""


class PlacesOnFaces:
    """Where the places that rays met lie on the faces: all of the interpolation that does not depend on light.

    Parameters
    ----------
    tree : PatchTree
        Whose leaves the shown faces lie in: a further subdivision of the one that `cells` were made of.
    met : MetPlaces
        What rays met: other places need no radiance.
    aside : (places,) bool
        Places that say nothing of the power that the vertices' light should have: on elements that are covered or
        inside a solid in part, whose radiosity is that of the rest.
    of_node : (2 * nodes, 3) int
        As `receivers_of_nodes` has them.
    hidden : (receivers,) bool
    divisions : Divisions
        Of the sides of nodes, (2 * nodes,).
    """

    def __init__(
        self,
        cells: Cells,
        tree: PatchTree,
        met: MetPlaces,
        aside: NDArray[np.bool_],
        of_node: Ints,
        hidden: NDArray[np.bool_],
        divisions: Divisions,
    ) -> None:
        self.tree = tree
        count = len(cells.element)
        leaf, weights = tree.descend(cells.node, cells.centre)
        # Behind the places come the cells of the world's map, and what is none counts from the end.
        seen = np.zeros(count + MAP_CELLS + SPECIAL, dtype=bool)
        # As indices, places take twice the memory, which is that of all gather rays: some at a time.
        rows = max(1, MET_AT_ONCE // max(met.rays, 1))
        named = met.named()
        for first in range(0, len(named), rows):
            seen[met.places(named[first : first + rows])] = True
        seen[met.places_aimed_at()] = True
        seen[cells.copied] |= seen[count - len(cells.copied) : count]
        self.place = np.flatnonzero(seen[: 2 * len(leaf)]).astype(np.int32)
        cell = self.place >> 1
        leaf, weights = leaf[cell], weights[cell]
        unseen = hidden[of_node] & (of_node >= 0).all(axis=1, keepdims=True)
        out = _out_of_hidden_faces(cells, tree, self.place, unseen.all(axis=1), leaf, weights)
        # What is close over the hidden middle sees what it covers, and not what is beside that.
        kept = np.flatnonzero(~np.isin(cells.copied, self.place[out]))
        self.copy, self.copied = count - len(cells.copied) + kept, cells.copied[kept]
        self.side = (2 * leaf + (self.place & 1)).astype(np.int32)
        self.whole = leaf == cells.element[self.place] >> 1
        self.areas = cells.areas[cell]
        self.open = ~aside[self.place]
        u, v = weights.T
        shares = np.stack([1.0 - u - v, u, v], axis=1)
        divided, own = divisions.own_corners(self.side, shares)
        shares[divided] = own
        # On the two sides of a wall, a patch's own radiosity is that of neither.
        self.whole[divided] = False
        self.mixed = np.flatnonzero(unseen.any(axis=1) & ~unseen.all(axis=1))
        self.unseen = unseen[self.mixed]
        self.divided, self.beside_walls = divisions.number, bool(divisions.thin.any())
        self.at_divided = of_node[divisions.number]
        self.shares = shares.astype(np.float32)
        self.triangle = tree.triangle[leaf].astype(np.int32)


def _out_of_hidden_faces(
    cells: Cells,
    tree: PatchTree,
    places: NDArray[np.int32],
    hidden: NDArray[np.bool_],
    leaf: Ints,
    weights: Singles,
) -> Ints:
    """Move places (p,) that lie on hidden faces to where their cells reach out of these; returns which were moved.

    The middle of a cell may lie under what stands there, but rays meet only what reaches out from under it.

    Parameters
    ----------
    hidden : (2 * nodes,) bool
        Sides of leaves that nothing sees.
    leaf : (p,) int
        That each lies in, and
    weights : (p, 2) float32
        its barycentric coordinates there; both are changed.
    """
    wanted = np.flatnonzero(hidden[2 * leaf + (places & 1)])
    moved = [np.zeros(0, dtype=np.int64)]
    for share in WAYS_OUT:
        corners = cells.corners_in_nodes(places[wanted] >> 1)[:, :, 1:]
        for corner in range(3):
            cell = places[wanted] >> 1
            at = cells.centre[cell] + share * (corners[:, corner] - cells.centre[cell])
            beside, inside = tree.descend(cells.node[cell], at.astype(np.float32))
            out = ~hidden[2 * beside + (places[wanted] & 1)]
            leaf[wanted[out]], weights[wanted[out]] = beside[out], inside[out]
            moved.append(wanted[out])
            wanted, corners = wanted[~out], corners[~out]
    return np.concatenate(moved)


class InterpolatedRadiance:
    """Radiance of each place from the irradiance at the vertices around it.

    Parameters
    ----------
    on_faces : PlacesOnFaces
    reflectance : (cells, 3) float32
    emission : (triangles, 3) float, W m^-2 sr^-1
        Emitted radiance that rays are to see.
    solved : (places, 3) float
        What places show that lie on no face: meshes that are not baked, twins of covered elements.
    translucence : (cells, 3) float32 or None
    """

    def __init__(
        self,
        on_faces: PlacesOnFaces,
        reflectance: Singles,
        emission: Floats,
        solved: Floats,
        translucence: Singles | None = None,
    ) -> None:
        self._on_faces, self._solved = on_faces, solved
        self._translucence = None if translucence is None else translucence[on_faces.place >> 1]
        self._reflectance = reflectance[on_faces.place >> 1]
        self._emission = emission.astype(np.float32)[on_faces.triangle]
        self._counted = np.where(on_faces.open, on_faces.areas, 0.0)
        self._power = (solved[on_faces.place] - self._emission) * self._counted[:, None]

    def at(self, shown: Lit) -> Floats:
        """Radiance of places when the vertices have the light of `shown`, (places, 3), W m^-2 sr^-1."""
        there = self._on_faces
        corners = corner_irradiance_of_nodes(there.tree, shown)
        # Rays meet what is seen of a face, and parts of it may be hidden altogether and dark.
        seen = np.where(there.unseen, np.nan, 0.0)[:, :, None] + corners[there.mixed]
        corners[there.mixed] = np.where(there.unseen[:, :, None], np.nanmean(seen, axis=1, keepdims=True), seen)
        corners[there.divided] = shown.gathered.irradiance[there.at_divided]
        irradiance = np.einsum("pk,pkc->pc", there.shares, corners.take(there.side, axis=0))
        light = corners @ LUMINANCE.astype(np.float32)
        with np.errstate(invalid="ignore"):
            steep = np.ptp(light, axis=1) > STEEP * light.mean(axis=1)
        known = np.isfinite(irradiance[:, 0]) & ~(there.whole & steep[there.side])
        result = self._solved.copy()
        reflected = self._reflectance * irradiance
        if self._translucence is not None:
            silky = np.flatnonzero(self._translucence.any(axis=1))
            behind = np.einsum("pk,pkc->pc", there.shares[silky], corners[there.side[silky] ^ 1])
            known[silky] &= np.isfinite(behind[:, 0])
            reflected[silky] += self._translucence[silky] * behind
        reflected[~known] = 0.0
        reflected *= self._balanced(reflected, known)
        reflected += self._emission
        place = there.place[known]
        result[place] = reflected[known]
        lit = np.zeros(len(result), dtype=bool)
        lit[place] = True
        shown_again = lit[there.copied]
        result[there.copy[shown_again]] = result[there.copied[shown_again]]
        return result

    def _balanced(self, reflected: Singles, known: NDArray[np.bool_]) -> Floats:
        """What reflected light, none where it is not known, is to be multiplied by for as much power as the patches
        reflect, (3,).

        Straight lines between vertices cut the tops off: the faces tell how light is spread, the patches how much
        there is of it.
        """
        power, drawn = known.astype(np.float64) @ self._power, self._counted @ reflected
        ratio = np.divide(power, drawn, out=np.ones(3), where=drawn > 0.0)
        corrected: Floats = np.clip(ratio, 1.0 - MOST_CORRECTED, 1.0 + MOST_CORRECTED)
        return corrected


def corner_irradiance_of_nodes(tree: PatchTree, shown: Lit) -> NDArray[np.float32]:
    """Irradiance over pi at the corners of each side of each node, (2 * nodes, 3, 3); NaN where no face lies in it."""
    values = np.full((2 * len(tree), 3, 3), np.nan, dtype=np.float32)
    at_corners = shown.corner_irradiance()
    for corner, row, of_face in _corners_of_nodes(tree, shown):
        values[2 * shown.faces.node[shown.face[row]] + shown.side[row], corner] = at_corners[row, of_face]
    return values


def receivers_of_nodes(tree: PatchTree, shown: Lit) -> Ints:
    """Receivers at the corners of each side of each node, (2 * nodes, 3); -1 where no face lies in it."""
    receivers = np.full((2 * len(tree), 3), -1, dtype=np.int64)
    for corner, row, of_face in _corners_of_nodes(tree, shown):
        at = 2 * shown.faces.node[shown.face[row]] + shown.side[row]
        receivers[at, corner] = shown.places.of_corner[row, of_face]
    return receivers


def _corners_of_nodes(tree: PatchTree, shown: Lit) -> Iterator[tuple[int, Ints, int]]:
    """Corners of nodes, each with the face sides that have it, and as which of their own corners."""
    node = shown.faces.node[shown.face]
    for corner_of_node in range(3):
        wanted = tree.corners[node, corner_of_node]
        for corner_of_face in range(3):
            same = np.flatnonzero(shown.faces.corners[shown.face, corner_of_face] == wanted)
            yield corner_of_node, same, corner_of_face
