# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""How dim the surroundings of a surface are: what may be wrong there is relative to them.

The outer walls of a house in the sun are fifty times as bright as the room behind them. An error that is small beside
the mean of all would be a stain on the walls of the room, to which the eye, or the exposure of a picture, adapts.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from .balance import Balance
from .direct import LUMINANCE
from .error_estimate import lit_area
from .patches import PatchTree
from .receivers import Receivers
from .scene import Floats, Ints
from .solve import Solution
from .subdivision import Faces

DIM_ROOM = 0.75
"""Light of the surroundings, relative to the mean of all, below which errors count for more."""

FAINTEST = 2.0**-6
"""The same below which they count for no more than there."""

STEPS = 16
"""Times that light is averaged over what is seen from a place: enough to find the whole of a room from each place in
it, also from the end of a corridor and from under a cupboard, and too few to go out by the window."""


@dataclass(frozen=True, eq=False)
class Surroundings:
    """How strict to be about errors: in how many times dimmer surroundings than `DIM_ROOM` they are, 1 where in none.

    Attributes
    ----------
    of_element : (m,) float
        Of the elements of a balance.
    of_node : (nodes, 2) float
        Of both sides of the leaves of the patch tree, by the patch that each is or is in.
    """

    of_element: Floats
    of_node: Floats

    def of_faces(self, faces: Faces, tree: PatchTree) -> Floats:
        """Of both sides of faces in leaves of `tree`, which may have been split on, (faces, 2)."""
        result: Floats = self.of_node[tree.ancestors(len(self.of_node))[faces.node]]
        return result

    def of_triangles(self, tree: PatchTree, count: int) -> Floats:
        """Of both sides of so many input triangles, (count, 2): the strictest of the leaves each was split into."""
        leaves = tree.leaves()
        leaves = leaves[leaves < len(self.of_node)]
        result = np.ones((count, 2))
        np.maximum.at(result, tree.triangle[leaves], self.of_node[leaves])
        return result


def at_receivers(places: Receivers, strict: Floats) -> Floats:
    """How strict to be at receivers, (n,), by the strictest of the face sides around each, (f,)."""
    result = np.ones(len(places.points))
    np.maximum.at(result, places.of_corner, strict[:, None])
    return result


def surroundings_of(balance: Balance, solution: Solution, tree: PatchTree) -> Surroundings:
    """Average the light over what is seen from each element, again over what is seen from there, and so on.

    Few rays that leave the scene go out by a window, and see what the element has itself; where many do, it is outside,
    among what is as bright as anything.
    """
    dark = ~balance.emission.any(axis=1)
    area, light = np.where(dark, balance.areas, 0.0), solution.incident @ LUMINANCE
    _, mean = lit_area(area, area * light)
    strict = np.ones(len(light))
    if mean > 0.0:
        level = np.clip(light / mean, FAINTEST, 1.0)[:, None]
        unmet = 1.0 - balance.exchange.apply(np.ones_like(level))
        for _ in range(STEPS):
            level = balance.exchange.apply(level) + unmet * (level + unmet * (1.0 - level))
        strict = np.maximum(DIM_ROOM / np.maximum(level[:, 0], FAINTEST), 1.0)
    of_side = np.ones(2 * len(tree))
    own = np.flatnonzero(balance.elements == balance.base)
    of_side[balance.elements[own]] = strict[own]
    patch: Ints = np.maximum(tree.patch, 0)
    return Surroundings(strict, of_side.reshape(-1, 2)[patch])
