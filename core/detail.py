# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Vertices where the solution needs them: faces are split while interpolation between their corners misses too much.

The paper's rule looks at form factors and cannot see shadows; here the light that was gathered decides. What was
gathered once is kept, so each round costs its new vertices only.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from .cut_edges import ROUGH_SEARCHES, IsHidden, crooked_faces, faces_with_feet, find_cuts, within_faces
from .direct import LUMINANCE
from .error_estimate import interpolation_error, lit_area
from .gather import Gathered, Mixture
from .geometry import lengths
from .lit import Lit
from .memory import Room
from .met_places import bytes_of_tables
from .mixtures import middles_in_between
from .patches import PatchTree
from .receivers import INWARD, Receivers, receivers
from .scene import Floats, Ints
from .strips import extents
from .subdivision import Faces, conforming_faces
from .surfaces import Surfaces
from .surroundings import Surroundings

MOST_ALONE = 0.5
"""Share of the faces up to which those of split shells are made anew alone: taking them out and joining them costs."""

MOST_ROUNDS = 8
"""Rounds of splitting; each halves the faces at a shadow's border."""


WIDTHS_ON_STRIP = 4.0
"""Faces longer than a patch, and than so many widths of the strip that they are on, are split in any case."""

FACES_ALONG_STRIP = 1024.0
"""Unless they are shorter than this part of the strip."""

MOST_LEVELS_ON_STRIP = 4
"""Splits of a coarse patch from which on none is made for the strip that it is on: each makes faces half as long, but
twice as many across, for which nothing asks. A patch limit leaves hairs in few and long pieces."""


@dataclass(frozen=True)
class FaceSizes:
    """How far faces may be split.

    Attributes
    ----------
    patches : float, scene units
        That of the patches.
    smallest : float, scene units
        Only faces of twice this size or more are split.
    smallest_cut : float, scene units
        The same where the outline of another object crosses them.
    largest : float, scene units squared
        Area that a patch counts for at most: one that nothing is near enough to for the form factors to have split it
        is background, however wide.
    room : Room
        For receivers and what their rays met.
    """

    patches: float
    smallest: float
    smallest_cut: float
    largest: float
    room: Room


NEAR = 1.0
"""Sizes of a face within which something is near it: its shadow may fall between the corners."""

MISSED_BETWEEN = 0.1
"""Share of the light shown in the middle of an edge that what is gathered there must differ by to count, and"""

SURELY_MISSED = 3.0
"""standard errors of that."""

LEAST_WITH_MIDDLE = 4.0
"""Smallest sizes of a face from which on its middle is asked: of those below, one split would be all."""

RECEIVERS_OF_SPLIT = 2
"""More receivers that a split makes, about: at the middles of edges, which neighbours share, and to fit to these."""


class GatherAt(Protocol):
    """Gathers light at receivers."""

    def __call__(self, places: Receivers, mixture: Mixture | None = None) -> Gathered:
        """Gather light at all, but no indirect light at those of the mixture."""


def light_up_in_detail(
    surfaces: Surfaces,
    lit: NDArray[np.bool_],
    tree: PatchTree,
    partly: NDArray[np.bool_],
    sizes: FaceSizes,
    tolerance: float,
    surroundings: Surroundings,
    light_up_first: Callable[[Faces, Floats, Floats], Lit],
    gather_at: GatherAt,
    gather_roughly: Callable[[Receivers], Gathered],
    is_hidden: IsHidden,
    stands_on: Callable[[Receivers, Ints, NDArray[np.bool_]], NDArray[np.bool_]],
) -> tuple[Lit, PatchTree, bool]:
    """Gather light at the corners of a conforming mesh, and split its faces until the estimated error is small.

    Parameters
    ----------
    lit : (shells, 2) bool
        Front and back: whether light reaches them.
    tree : PatchTree
        The patches to begin with; not changed.
    partly : (nodes,) bool
        Patches some rays of which started inside a solid or under a cover.
    sizes : FaceSizes
    tolerance : float
        RMS error over the surface to be reached, relative to the mean.
    surroundings : Surroundings
        Of the tree: where errors count for more.
    light_up_first : callable
        Gathers light at the corners of the patches, of which a share counts, on whose sides errors count for more.
    gather_at : callable
        The same at all vertices after them.
    gather_roughly : callable
        The same with few rays.
    is_hidden : callable
        Tells whether receivers are hidden: faces that another object hides in part are split where it has a corner.
    stands_on : callable
        Tells of faces (f, 3), whose corners are receivers some of which are hidden, on which edges a solid stands.

    Returns
    -------
    The faces and their light, the tree whose leaves they lie in, and whether there would be too many vertices if they
    were split as they should be.
    """
    shown = _ShownFaces(surfaces, lit, tree.copy(), sizes.largest, tolerance, surroundings, light_up_first, gather_at)

    def bright_enough(lit: Lit) -> NDArray[np.bool_]:
        # Where a sealed room ends that is dark anyhow, nothing breaks off.
        return _brightest_corner(lit) > tolerance * shown.mean_light

    def split_by_feet(first_new: int) -> Ints:
        nodes = [np.zeros(0, dtype=np.int64)]
        for lit, chosen in shown.parts():
            count = len(chosen)
            node = lit.faces.node
            new, patch = node >= first_new, node < len(partly)
            new[patch] &= partly[shown.tree.patch[node[patch]]]
            seen = ~lit.gathered.hidden[lit.places.of_corner[:count]].any(axis=1) & bright_enough(lit)
            faces = np.flatnonzero(chosen & new & seen & (shown.tree.sizes(node) >= 2.0 * sizes.smallest_cut))
            nodes.append(node[faces_with_feet(lit.faces, lit.places, faces, is_hidden)])
        return np.unique(np.concatenate(nodes))

    def split_on_strips(first_new: int) -> Ints:
        leaf = np.unique(np.concatenate([lit.faces.node[chosen] for lit, chosen in shown.parts()]))
        leaf = leaf[(shown.tree.sizes(leaf) > sizes.patches) & (shown.tree.level[leaf] < MOST_LEVELS_ON_STRIP)]
        triangle = shown.tree.triangle[leaf]
        shells = np.zeros(len(surfaces.closed), dtype=bool)
        shells[surfaces.shell_of_triangle[triangle]] = True
        among = np.flatnonzero(shells[surfaces.shell_of_triangle])
        width, length = (extent[np.searchsorted(among, triangle)] for extent in extents(surfaces, among))
        slender: Ints = leaf[shown.tree.sizes(leaf) > np.maximum(WIDTHS_ON_STRIP * width, length / FACES_ALONG_STRIP)]
        return slender

    def split_by_error(first_new: int) -> Ints:
        return _nodes_to_split(shown.missed_light(), shown.tree, sizes.smallest, tolerance)

    found_between = np.zeros(0)

    def split_by_middles(first_new: int) -> Ints:
        nonlocal found_between
        found = np.zeros(len(shown.tree))
        found[: len(found_between)] = found_between
        for lit, chosen in shown.parts():
            node = lit.faces.node
            wanted = chosen & (node >= first_new) & (shown.tree.sizes(node) >= LEAST_WITH_MIDDLE * sizes.smallest)
            found += _missed_between(surfaces, lit, shown.strict(lit), wanted, len(found), gather_roughly)
        missed = shown.missed_light()
        # What has been split has no area any more.
        found_between = np.where(missed[1] > 0.0, found, 0.0)
        missed[0] = found_between
        return _nodes_to_split(missed, shown.tree, sizes.smallest, tolerance)

    looked_at = 0

    def split_by_outline(first_new: int) -> Ints:
        nonlocal looked_at
        nodes, looked_at, first_new = [np.zeros(0, dtype=np.int64)], len(shown.tree), looked_at
        for lit, chosen in shown.parts():
            faces = bright_enough(lit) & chosen & (lit.faces.node >= first_new)
            if faces.any():
                nodes.append(_nodes_with_crooked_cuts(lit, faces, shown.tree, sizes, is_hidden))
                nodes.append(_nodes_under_solids(lit, faces, shown.tree, sizes, stands_on))
        return np.unique(np.concatenate(nodes))

    full = False
    for nodes_to_split in (
        split_on_strips,
        split_by_feet,
        split_by_error,
        split_by_outline,
        split_by_middles,
        split_by_outline,
    ):
        first_new = 0
        for _ in range(MOST_ROUNDS):
            nodes = nodes_to_split(first_new)
            crowded = not shown.fits(RECEIVERS_OF_SPLIT * len(nodes), sizes.room)
            if len(nodes) == 0 or crowded:
                full |= len(nodes) > 0
                break
            first_new = len(shown.tree)
            shown.split(nodes)
    return shown.all(), shown.tree, full


class _ShownFaces:
    """Faces that are split from round to round.

    Shells of which no face is split, such as most dense meshes, are looked at once; of the others, only those split in
    a round are made anew, unless they are most of them.

    Attributes
    ----------
    tree : PatchTree
    mean_light : float, W m^-2 sr^-1
        Mean luminance of what has light, before the first split.
    """

    def __init__(
        self,
        surfaces: Surfaces,
        lit: NDArray[np.bool_],
        tree: PatchTree,
        largest: float,
        tolerance: float,
        surroundings: Surroundings,
        light_up_first: Callable[[Faces, Floats, Floats], Lit],
        gather_at: GatherAt,
    ) -> None:
        self._surfaces, self._lit, self.tree, self._gather_at = surfaces, lit, tree, gather_at
        self._surroundings = surroundings
        self._share_of_patch = counted_share(tree.areas(tree.patch), largest)
        self._changed_shells = np.zeros(len(lit), dtype=bool)
        faces = conforming_faces(surfaces, tree, ~self._changed_shells)
        self._first = light_up_first(faces, self._share(faces), surroundings.of_faces(faces, tree))
        self._changed = self._first.part(np.zeros(len(faces.triangle), dtype=bool))
        self._missed = _missed_light(surfaces, self._first, self.strict(self._first), len(tree))
        _, area, light = self._missed
        lit_of_all, self.mean_light = lit_area(area, light)
        self._goal = tolerance * self.mean_light, lit_of_all
        self._shell_of_node = surfaces.shell_of_triangle[tree.triangle]

    def parts(self) -> list[tuple[Lit, NDArray[np.bool_]]]:
        """All faces, as some of those of each entry."""
        kept = ~self._changed_shells[self._shell_of_node[self._first.faces.node]]
        return [(self._first, kept), (self._changed, np.ones(len(self._changed.faces.triangle), dtype=bool))]

    def fits(self, more: int, room: Room) -> bool:
        """Whether there is room for so many more places where light is gathered."""
        first, changed = self._first.gathered.places, self._changed.gathered.places
        return room.holds(len(first) + len(changed), bytes_of_tables(first, changed), more)

    def missed_light(self) -> Floats:
        """As `_missed_light`, of all faces."""
        missed = _missed_light(self._surfaces, self._changed, self.strict(self._changed), len(self.tree))
        missed[:, : len(self._shell_of_node)] += np.where(self._changed_shells[self._shell_of_node], 0.0, self._missed)
        return missed

    def split(self, nodes: Ints) -> None:
        """Split leaves, and gather light at the new vertices."""
        split = np.zeros(len(self._changed_shells), dtype=bool)
        split[self._surfaces.shell_of_triangle[self.tree.triangle[nodes]]] = True
        new = split & ~self._changed_shells
        if new.any():
            more = self._first.part(new[self._shell_of_node[self._first.faces.node]])
            self._changed_shells |= new
            (first, kept), (changed, every) = self.parts()
            # Of a dense mesh that has changed, what its rays met is not kept twice.
            if 2 * np.count_nonzero(kept) < len(kept):
                self._first = first.part(kept)
            del first
            self._changed = changed.with_others(every, more, self.tree)
        others = ~split[self._surfaces.shell_of_triangle[self._changed.faces.triangle]]
        few = np.count_nonzero(others) > (1.0 - MOST_ALONE) * len(others)
        self.tree.split(nodes)
        if few:
            faces = conforming_faces(self._surfaces, self.tree, split)
            updated = self._updated(self._changed.part(~others), faces)
            self._changed = self._changed.with_others(others, updated, self.tree)
        else:
            faces = conforming_faces(self._surfaces, self.tree, self._changed_shells)
            self._changed = self._updated(self._changed, faces)

    def _updated(self, known: Lit, faces: Faces) -> Lit:
        """Gather at the receivers of the faces that are not known, and take the others from what is."""
        face, side = wanted_sides(faces, self._surfaces, self._lit)
        places = receivers(self._surfaces, faces, face, side)
        old = known.places
        place = np.minimum(np.searchsorted(old.codes, places.codes), len(old.codes) - 1)
        missing = np.flatnonzero(old.codes[place] != places.codes)
        asked = places.taken(missing)
        new = self._gather_at(asked, middles_in_between(known, self.strict(known), self.tree, asked, self._goal))
        return Lit(faces, face, side, places, known.gathered.with_more(place, new, missing), self._share(faces))

    def _share(self, faces: Faces) -> Floats:
        """Share of the area of faces that counts, (faces,)."""
        share: Floats = self._share_of_patch[self.tree.ancestors(len(self._share_of_patch))[faces.node]]
        return share

    def strict(self, known: Lit) -> Floats:
        """How many times more errors count on face sides, (f,)."""
        strict: Floats = self._surroundings.of_faces(known.faces, self.tree)[known.face, known.side]
        return strict

    def all(self) -> Lit:
        """The faces and their light."""
        (first, kept), (changed, _) = self.parts()
        return first.with_others(kept, changed, self.tree) if self._changed_shells.any() else first


def _brightest_corner(known: Lit) -> Floats:
    """Luminance of the brightest seen corner of the front of each face, (faces,)."""
    of_corner = known.places.of_corner[: len(known.faces.triangle)]
    light = np.where(known.gathered.hidden, 0.0, known.gathered.irradiance @ LUMINANCE)
    brightest: Floats = light[of_corner].max(axis=1, initial=0.0)
    return brightest


def _nodes_with_crooked_cuts(
    known: Lit, faces: NDArray[np.bool_], tree: PatchTree, sizes: FaceSizes, is_hidden: IsHidden
) -> Ints:
    """Leaves that can be split and that a straight cut does not fit, among those that some `faces` (f,) lie in."""
    hidden = known.gathered.hidden
    cuts = find_cuts(known.faces, known.places, hidden, is_hidden, ROUGH_SEARCHES, faces)
    nodes = np.unique(known.faces.node[crooked_faces(known.faces, known.places, hidden, cuts, is_hidden)])
    return nodes[tree.sizes(nodes) >= 2.0 * sizes.smallest_cut]


def _nodes_under_solids(
    known: Lit,
    faces: NDArray[np.bool_],
    tree: PatchTree,
    sizes: FaceSizes,
    stands_on: Callable[[Receivers, Ints, NDArray[np.bool_]], NDArray[np.bool_]],
) -> Ints:
    """Leaves that can be split and that a solid stands on between seen corners, among those some `faces` lie in."""
    node, hidden = known.faces.node, known.gathered.hidden
    of_corner = known.places.of_corner[: len(node)]
    seen = ~hidden[of_corner].any(axis=1)
    asked = np.flatnonzero(faces & seen & (tree.sizes(node) >= 2.0 * sizes.smallest_cut))
    nodes: Ints = np.unique(node[asked[stands_on(known.places, of_corner[asked], hidden).any(axis=1)]])
    return nodes


def wanted_sides(faces: Faces, surfaces: Surfaces, lit: NDArray[np.bool_]) -> tuple[Ints, Ints]:
    """Faces and sides that get values, every front and the backs that light reaches, (f,)."""
    count = len(faces.triangle)
    shell = surfaces.shell_of_triangle[faces.triangle]
    behind = np.flatnonzero(lit[shell, 1])
    face = np.concatenate([np.arange(count), behind])
    side = np.concatenate([np.zeros(count, dtype=np.int64), np.ones(len(behind), dtype=np.int64)])
    return face, side


def counted_share(areas: Floats, largest: float) -> Floats:
    """Share of the areas of patches that counts, where each counts for `largest` at most."""
    share: Floats = largest / np.maximum(areas, max(largest, np.finfo(np.float64).tiny))
    return share


def counted_share_of_triangles(tree: PatchTree, largest: float) -> Floats:
    """The same of the surfaces' triangles, (t,), of which patches are parts or clusters."""
    leaves = tree.leaves()
    triangle, area = tree.triangle[leaves], tree.areas(leaves)
    counted = np.bincount(triangle, weights=area * counted_share(tree.areas(tree.patch[leaves]), largest))
    share: Floats = counted / np.maximum(np.bincount(triangle, weights=area), np.finfo(np.float64).tiny)
    return share


def _missed_light(surfaces: Surfaces, known: Lit, strict: Floats, nodes: int) -> Floats:
    """By node: squared error of interpolation times area, area, and light times area, (3, nodes).

    All are means over the channels. Errors count as many times more as `strict` says of the face sides, (f,).
    """
    faces, face = known.faces, known.face
    corners = faces.points[faces.corners[face]]
    irradiance = known.corner_irradiance()
    area = known.weights(surfaces)
    square = (strict * interpolation_error(corners, known.neighbours, irradiance)) ** 2
    summed = (square * area, area, area * irradiance.mean(axis=(1, 2)))
    by_node = [np.bincount(faces.node[face], weights=value, minlength=nodes) for value in summed]
    return np.stack(by_node).astype(np.float64)  # of no face at all, counts are whole numbers


def _missed_between(
    surfaces: Surfaces,
    known: Lit,
    strict: Floats,
    faces: NDArray[np.bool_],
    nodes: int,
    gather_roughly: Callable[[Receivers], Gathered],
) -> Floats:
    """By node: squared difference between the light in the middle of the longest edge and what is shown there, times
    area, (nodes,); of those `faces` (f,) that something is near to. Nothing where rays are too few to tell.

    Differences count as many times as `strict` says of the face sides, (f,).
    """
    of_corner, gathered = known.places.of_corner, known.gathered
    corners = known.faces.points[known.faces.corners[known.face]]
    along = lengths(np.roll(corners, -1, axis=1) - corners)
    size = along.max(axis=1)
    near = gathered.free[of_corner].min(axis=1) < NEAR * size
    near &= ~(gathered.hidden[of_corner] | gathered.touching[of_corner]).any(axis=1)
    weight = known.weights(surfaces)
    row = np.flatnonzero(faces[known.face] & near & (weight > 0.0))
    if len(row) == 0:
        return np.zeros(nodes)
    edge = along[row].argmax(axis=1)
    start, end = of_corner[row, edge], of_corner[row, (edge + 1) % 3]
    _, first, at, beside = np.unique(
        np.minimum(start, end) << 32 | np.maximum(start, end),
        return_index=True,
        return_inverse=True,
        return_counts=True,
    )
    # An edge of one face alone may lie in the plane of the next wall.
    aside = np.where(beside == 1, INWARD, 0.0)
    weights = np.empty((len(first), 3))
    each, asked = np.arange(len(first)), row[first]
    for step, share in ((0, (1.0 - aside) / 2.0), (1, (1.0 - aside) / 2.0), (2, aside)):
        weights[each, (edge[first] + step) % 3] = share
    middles = gather_roughly(within_faces(known.faces, known.face[asked], known.places, of_corner[asked], weights))
    shown = np.einsum("ek,ekx->ex", weights, known.corner_irradiance()[asked])
    light = np.where(middles.hidden[:, None], 0.0, middles.irradiance)
    missed = np.sqrt(((shown - light) ** 2).mean(axis=1))
    told = missed > np.maximum(MISSED_BETWEEN * shown.mean(axis=1), SURELY_MISSED * middles.noise)
    square = np.where(told, missed**2, 0.0)[at] * strict[row] ** 2 * weight[row]
    return np.bincount(known.faces.node[known.face[row]], weights=square, minlength=nodes)


def _nodes_to_split(missed_light: Floats, tree: PatchTree, smallest: float, tolerance: float) -> Ints:
    """The fewest leaves whose error must go for the rest to meet the tolerance, worst first."""
    square, area, light = missed_light
    lit, mean = lit_area(area, light)
    splittable = np.flatnonzero(square)
    splittable = splittable[tree.sizes(splittable) >= 2.0 * smallest]
    worst_first = splittable[np.argsort(-square[splittable], kind="stable")]
    allowed = (tolerance * mean) ** 2 * lit
    # What is left of the error that splitting could mend before the first k are gone.
    left = square[worst_first].sum() - np.cumsum(square[worst_first]) + square[worst_first]
    return np.sort(worst_first[left > allowed])
