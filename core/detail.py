# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Vertices where the solution needs them: faces are split while interpolation between their corners misses too much.

The paper's rule looks at form factors and cannot see shadows; here the light that was gathered decides. What was
gathered once is kept, so each round costs its new vertices only.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .cutting import ROUGH_SEARCHES, IsHidden, crooked_faces, find_cuts
from .direct import LUMINANCE
from .error_estimate import interpolation_error, relative_error
from .gather import Gathered, corner_values
from .geometry import triangle_areas
from .patches import PatchTree
from .receivers import Receivers, receivers
from .scene import Floats, Ints
from .subdivision import Faces, conforming_faces
from .surfaces import Surfaces

MOST_ROUNDS = 8
"""Rounds of splitting; each halves the faces at a shadow's border."""


@dataclass(frozen=True, eq=False)
class Lit:
    """Faces and the light gathered at them.

    Attributes
    ----------
    faces : Faces
    face, side : (f,) int
        Faces and sides (1: the back) with values: all fronts in order, then some backs.
    enclosed : (f,) bool
        Those inside a closed mesh that see nothing but the same inside: what glows there is not looked at closely.
    places : Receivers
        `of_corner` has a row for each face side.
    gathered : Gathered
        At the receivers.
    """

    faces: Faces
    face: Ints
    side: Ints
    enclosed: NDArray[np.bool_]
    places: Receivers
    gathered: Gathered

    def corner_irradiance(self) -> Floats:
        """Irradiance over pi at the corners of the face sides, (f, 3, 3)."""
        return corner_values(self.gathered, self.places.of_corner)

    def counted(self, surfaces: Surfaces) -> NDArray[np.bool_]:
        """Face sides whose error counts: neither emitters nor enclosed, nor hidden altogether, (f,)."""
        dark = np.all(surfaces.emission[self.faces.triangle[self.face]] == 0.0, axis=1)
        shown: NDArray[np.bool_] = np.any(~self.gathered.hidden[self.places.of_corner], axis=1)
        return dark & shown & ~self.enclosed

    def error(self, surfaces: Surfaces) -> float:
        """Estimated RMS error over the surface, relative to its mean."""
        corners = self.faces.points[self.faces.corners[self.face]]
        return relative_error(
            corners, self.places.of_corner, self.corner_irradiance(), self.gathered.noise, self.counted(surfaces)
        )


@dataclass(frozen=True)
class FaceSizes:
    """How far faces may be split.

    Attributes
    ----------
    smallest : float, scene units
        Only faces of twice this size or more are split.
    smallest_cut : float, scene units
        The same where the outline of another object crosses them.
    most_vertices : int
        Receivers after which no face is split any more.
    """

    smallest: float
    smallest_cut: float
    most_vertices: int


@dataclass(frozen=True, eq=False)
class Sides:
    """What is known of the sides of shells.

    Attributes
    ----------
    lit : (shells, 2) bool
        Front and back: whether light reaches them.
    enclosed : (shells,) bool
        Closed shells whose insides see nothing else, and whose fronts are seen.
    """

    lit: NDArray[np.bool_]
    enclosed: NDArray[np.bool_]


GatherAt = Callable[[Receivers], Gathered]


def light_up(surfaces: Surfaces, sides: Sides, faces: Faces, gather_at: GatherAt) -> Lit:
    """Gather light at all corners of faces as they are."""
    face, side, enclosed = _wanted_sides(faces, surfaces, sides)
    places = receivers(surfaces, faces, face, side)
    return Lit(faces, face, side, enclosed, places, gather_at(places))


def light_up_in_detail(
    surfaces: Surfaces,
    sides: Sides,
    tree: PatchTree,
    sizes: FaceSizes,
    tolerance: float,
    gather_at: GatherAt,
    is_hidden: IsHidden,
) -> tuple[Lit, PatchTree]:
    """Gather light at the corners of a conforming mesh, and split its faces until the estimated error is small.

    Parameters
    ----------
    sides : Sides
    tree : PatchTree
        The patches to begin with; not changed.
    sizes : FaceSizes
    tolerance : float
        RMS error over the surface to be reached, relative to the mean.
    is_hidden : callable
        Tells whether receivers are hidden: faces that another object hides in part are split where it has a corner.

    Returns
    -------
    The faces and their light, and the tree whose leaves they lie in.
    """
    tree = tree.copy()
    known = light_up(surfaces, sides, conforming_faces(surfaces, tree), gather_at)

    def split_by_error(known: Lit, first_new: int) -> Ints:
        return _nodes_to_split(surfaces, known, tree, sizes.smallest, tolerance)

    def split_by_outline(known: Lit, first_new: int) -> Ints:
        return _nodes_with_crooked_cuts(known, tree, sizes.smallest_cut, first_new, is_hidden)

    for nodes_to_split in (split_by_error, split_by_outline):
        first_new = 0
        for _ in range(MOST_ROUNDS):
            nodes = nodes_to_split(known, first_new)
            if len(nodes) == 0 or len(known.places.points) > sizes.most_vertices:
                break
            first_new = len(tree)
            tree.split(nodes)
            known = _updated(surfaces, sides, conforming_faces(surfaces, tree), gather_at, known)
    return known, tree


def _nodes_with_crooked_cuts(known: Lit, tree: PatchTree, smallest: float, first_new: int, is_hidden: IsHidden) -> Ints:
    """Leaves that can be split and whose faces a straight cut does not fit, among those made in the last round."""
    hidden = known.gathered.hidden
    new = known.faces.node >= first_new
    cuts = find_cuts(known.faces, known.places, hidden, is_hidden, ROUGH_SEARCHES, new)
    nodes = np.unique(known.faces.node[crooked_faces(known.faces, known.places, hidden, cuts, is_hidden)])
    return nodes[tree.sizes(nodes) >= 2.0 * smallest]


def _wanted_sides(faces: Faces, surfaces: Surfaces, sides: Sides) -> tuple[Ints, Ints, NDArray[np.bool_]]:
    """Faces and sides that get values, every front and the backs that light reaches, and which are enclosed; (f,)."""
    count = len(faces.triangle)
    shell = surfaces.shell_of_triangle[faces.triangle]
    behind = np.flatnonzero(sides.lit[shell, 1])
    face = np.concatenate([np.arange(count), behind])
    side = np.concatenate([np.zeros(count, dtype=np.int64), np.ones(len(behind), dtype=np.int64)])
    return face, side, (side == 1) & sides.enclosed[shell[face]]


def _updated(surfaces: Surfaces, sides: Sides, faces: Faces, gather_at: GatherAt, known: Lit) -> Lit:
    """Gather at the receivers that `known` has not, and take the others from it."""
    face, side, enclosed = _wanted_sides(faces, surfaces, sides)
    places = receivers(surfaces, faces, face, side)
    old = known.places
    place = np.minimum(np.searchsorted(old.codes, places.codes), len(old.codes) - 1)
    missing = np.flatnonzero(old.codes[place] != places.codes)
    new = gather_at(places.taken(missing))
    return Lit(faces, face, side, enclosed, places, known.gathered.with_more(place, new, missing))


def _nodes_to_split(surfaces: Surfaces, known: Lit, tree: PatchTree, smallest: float, tolerance: float) -> Ints:
    """The fewest leaves whose error must go for the rest to meet the tolerance, worst first."""
    faces, face = known.faces, known.face
    corners = faces.points[faces.corners[face]]
    luminance = known.corner_irradiance() @ LUMINANCE
    counted = known.counted(surfaces)
    area = triangle_areas(corners) * counted
    if not area.any():
        return np.zeros(0, dtype=np.int64)
    missed = interpolation_error(corners, known.places.of_corner, luminance)
    square = np.bincount(faces.node[face], weights=missed**2 * area, minlength=len(tree))
    mean = float((area * luminance.mean(axis=1)).sum() / area.sum())
    splittable = np.flatnonzero(square)
    splittable = splittable[tree.sizes(splittable) >= 2.0 * smallest]
    worst_first = splittable[np.argsort(-square[splittable], kind="stable")]
    allowed = (tolerance * mean) ** 2 * area.sum()
    # What is left of the error that splitting could mend before the first k are gone.
    left = square[worst_first].sum() - np.cumsum(square[worst_first]) + square[worst_first]
    return np.sort(worst_first[left > allowed])
