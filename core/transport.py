# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The traced transport: for each side of each patch, where its rays ended.

An *element* is one side of a patch: twice the patch's node, plus 1 for the back. Its *row* are rays that leave it with
cosine distribution from points spread over it; the share of them that ends on another element is the form factor to it.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from .form_factors import point_to_triangle
from .geometry import side_normals
from .location import Locator
from .patches import PatchTree
from .rows import BURIED, COVER_GAP, ESCAPED, Cover, Rows, Shares, all_shares, joined, shares_to, split_shares
from .sampling import Patterns, Singles, frames, hashed, sequence, shifted, triangle_weights
from .scene import Floats, Ints
from .surfaces import Surfaces
from .visibility import OFFSET, RayScene
from .world import map_cells

COVER_POINTS, LEAST_SHORT = 16, 0.82
"""Points of a patch that are tested, and the share of rays that must be short at one of them for the patch to be
covered in part; beside a wall half of them are, in the corner of a room three quarters, in a gap above a lamp often no
more than five sixths."""

COVER_RAYS, SURE_COVER_RAYS = 8, 512
"""Rays of each point at first, and where the patch then seems covered in part: of eight, seven are often short in the
corner of a room, and what counts as covered there exchanges light with its like alone."""

LONG_ROW = 4
"""Times more rays that an element is given when most of its first ones started inside a solid."""

LARGE_SHARE = 1.0 / 256.0
"""Share of the light emitted by all that makes an element one of the few that send out much of it: how much of that
leaves an open scene is told by their rows alone."""

PROBES, PROBES_FROM = 16, 8.0
"""Rays that look whether an element or another in its plane is met, and how far off they start, in `OFFSET`."""

POINTS_OF_A_FACTOR = 4
"""Points of a receiver over which a form factor in closed form is averaged."""


def element_normals(surfaces: Surfaces, tree: PatchTree, elements: Ints) -> Floats:
    """Unit normals of elements, turned to their side, (m, 3)."""
    return side_normals(surfaces.normals[tree.triangle[elements >> 1]], elements & 1)


def keys_of_points(keys: Ints, count: int) -> Ints:
    """Keys of so many points on each of what has a key (m,), (m * count,)."""
    result: Ints = (keys[:, None] * count + np.arange(count)).ravel()
    return result


def points_in(tree: PatchTree, nodes: Ints, weights: Floats) -> Floats:
    """Positions of barycentric weights (m, r, 2) of corners 1 and 2 in nodes (m,): (m, r, 3)."""
    a, b, c = (tree.points[tree.corners[nodes, k]][:, None] for k in range(3))
    u, v = weights[..., :1], weights[..., 1:]
    result: Floats = a + (b - a) * u + (c - a) * v
    return result


def sample_points(surfaces: Surfaces, tree: PatchTree, elements: Ints, count: int, seed: int) -> tuple[Floats, Floats]:
    """Points spread over elements and the normals there, both (m, count, 3)."""
    square = shifted(sequence(0, count, 2), hashed(tree.keys(elements), 2, seed))
    carriers, remainder = tree.carriers(elements >> 1, square[..., 0])
    weights = triangle_weights(np.stack([remainder, square[..., 1]], axis=-1))
    return points_on(surfaces, tree, elements, carriers, weights)


def points_on(
    surfaces: Surfaces, tree: PatchTree, elements: Ints, carriers: Ints, weights: Floats
) -> tuple[Floats, Floats]:
    """Positions of barycentric weights (m, r, 2) in triangles (m, r) of elements (m,), and normals, both (m, r, 3)."""
    nodes = carriers.ravel()
    points = points_in(tree, nodes, weights.reshape(-1, 1, 2)).reshape(*carriers.shape, 3)
    sides = np.repeat(elements & 1, carriers.shape[1])
    return points, side_normals(surfaces.normals[tree.triangle[nodes]], sides).reshape(*carriers.shape, 3)


class Transport:
    """The rows of all elements that take part.

    Attributes
    ----------
    tables : list of Rows
        Elements with rows of ordinary length, and those with long ones.
    rays_per_row, cover_points : int
        Rays of an ordinary row, and points of a patch at which it is told whether it is covered in part.
    cover : Cover or None
        Elements told apart into what is covered and what is not, once refinement has ended.
    """

    def __init__(
        self,
        surfaces: Surfaces,
        tree: PatchTree,
        rays: RayScene,
        lit: NDArray[np.bool_],
        rays_per_row: int,
        seed: int,
    ) -> None:
        self.surfaces, self.tree, self.rays, self.seed = surfaces, tree, rays, seed
        self.unlit_side: NDArray[np.bool_] = ~lit[surfaces.shell_of_triangle].ravel()
        self.cover: Cover | None = None
        self.locator = Locator(tree)
        self._begin(rays_per_row, COVER_POINTS)

    def _begin(self, rays_per_row: int, cover_points: int) -> None:
        self.rays_per_row, self.cover_points = rays_per_row, cover_points
        self.tables = [Rows.none(rays_per_row), Rows.none(rays_per_row * LONG_ROW)]
        self._patterns = [
            Patterns.make(0, rays_per_row, self.seed),
            Patterns.make(rays_per_row, rays_per_row * (LONG_ROW - 1), self.seed),
        ]

    def begin_anew(self, times: int) -> None:
        """Forget all rows: those to come have so many times as many rays, and patches as many points."""
        self._begin(self.rays_per_row * times, self.cover_points * times)

    def row_count(self) -> int:
        """Rows traced and kept."""
        return sum(len(table.element) for table in self.tables)

    def kept_rays(self) -> int:
        """Rays that are kept in memory."""
        return sum(table.hits.size for table in self.tables)

    def seeing_area(self) -> float:
        """Area of all elements, each by the share of its rays that meet anything, scene units squared.

        The first ray that does is left out, of those that do and of all: on a ground a mile off, by chance one meets a
        house, and would count for acres.
        """
        area = 0.0
        for table in self.tables:
            met = (table.hits >= 0).sum(axis=1)
            share = np.maximum(met - 1, 0) / np.maximum(table.valid - 1, 1)
            area += float(self.tree.areas(table.element >> 1) @ share)
        return area

    def has_row(self) -> NDArray[np.bool_]:
        """Whether each element has been traced, (2 * nodes,)."""
        known = np.zeros(2 * len(self.tree), dtype=bool)
        for table in self.tables:
            known[table.element] = True
        return known

    def met_but_untraced(self) -> Ints:
        """Elements that some ray met and that have no row of their own yet, sorted."""
        met = np.zeros(2 * len(self.tree) + 2, dtype=bool)
        for table in self.tables:
            met[table.hits.ravel()] = True  # the two special hits mark the last two places
        sides = met[:-2].reshape(-1, 2)
        # What is seen of one side of these is light of the other.
        sides |= (sides.any(axis=1) & self.surfaces.translucent()[self.tree.triangle])[:, None]
        return np.flatnonzero(met[:-2] & ~self.has_row())

    def trace(self, elements: Ints, report: Callable[[float], None] = lambda share: None) -> None:
        """Trace a row for each element."""
        if len(elements):
            self.tables[0] = Rows.stacked([self.tables[0], self._traced(elements, self._patterns[0], report)])

    def lengthen(self, elements: Ints, report: Callable[[float], None] = lambda share: None) -> None:
        """Trace more rays for elements that have an ordinary row, which goes on where it ended."""
        ordinary = self.tables[0]
        place = np.full(2 * len(self.tree), -1, dtype=np.int64)
        place[ordinary.element] = np.arange(len(ordinary.element))
        row = place[elements]
        more = self._traced(elements, self._patterns[1], report)
        keep = np.ones(len(ordinary.element), dtype=bool)
        keep[row] = False
        self.tables[1] = Rows.stacked([self.tables[1], ordinary.taken(row).continued(more)])
        self.tables[0] = ordinary.taken(keep)

    def _traced(self, elements: Ints, patterns: Patterns, report: Callable[[float], None]) -> Rows:
        count = patterns.directions.shape[1]

        def work(first: int, last: int) -> Rows:
            part = elements[first:last]
            keys = self.tree.keys(part)
            pattern, angle = patterns.choose(keys, self.seed)
            normals = element_normals(self.surfaces, self.tree, part)
            corner, edge1, edge2 = self._local_triangles(part >> 1)
            spread = np.stack([corner + (normals * OFFSET).astype(np.float32), edge1, edge2], axis=1)
            origins = patterns.positions[pattern] @ spread
            directions = patterns.directions[pattern] @ frames(normals, angle)
            clustered = np.flatnonzero(self.tree.is_cluster(part >> 1))
            if len(clustered):
                origins[clustered], directions[clustered] = self._leaving_clusters(
                    part[clustered], patterns, pattern[clustered], angle[clustered]
                )
            chances = shifted(patterns.chances[:, None], hashed(keys, 1, self.seed + 72)).astype(np.float32)
            hits, root, weights, distance = self.look(
                origins.reshape(-1, 3), directions.reshape(-1, 3), chances.ravel(), count
            )
            hits = hits.reshape(-1, count)
            return Rows(
                part,
                hits,
                root.reshape(-1, count),
                weights.reshape(-1, count, 2),
                distance.reshape(-1, count),
                count - (hits == BURIED).sum(axis=1),
            )

        return Rows.stacked(self.rays.workers.map(work, len(elements), count, report))

    def _leaving_clusters(
        self, elements: Ints, patterns: Patterns, pattern: Ints, angle: Floats
    ) -> tuple[Singles, Singles]:
        """Origins and directions of the rays of clusters, each about the normal of its own triangle, (m, r, 3)."""
        carriers = self._carriers(elements, patterns)
        points, normals = points_on(
            self.surfaces, self.tree, elements, carriers, patterns.positions[pattern][..., 1:].astype(np.float64)
        )
        turned = frames(normals.reshape(-1, 3), np.repeat(angle, carriers.shape[1]))
        directions = (patterns.directions[pattern].reshape(-1, 1, 3) @ turned).reshape(points.shape)
        return self.rays.local(points) + (normals * OFFSET).astype(np.float32), directions

    def _carriers(self, elements: Ints, patterns: Patterns) -> Ints:
        """Triangles that the rays of elements leave, (m, r) nodes."""
        shares = shifted(patterns.shares[:, None], hashed(self.tree.keys(elements), 1, self.seed + 71))[..., 0]
        return self.tree.carriers(elements >> 1, shares)[0]

    def _local_triangles(self, nodes: Ints) -> tuple[Singles, Singles, Singles]:
        """First corner of each node and the two edges from it, in the ray library's coordinates."""
        a, b, c = (self.tree.points[self.tree.corners[nodes, k]] for k in range(3))
        scale = self.rays.scale
        return self.rays.local(a), ((b - a) * scale).astype(np.float32), ((c - a) * scale).astype(np.float32)

    def look(
        self, origins: Singles, directions: Singles, chances: Singles | None = None, each: int = 1
    ) -> tuple[NDArray[np.int32], NDArray[np.int32], Singles, Singles]:
        """Trace rays (n, 3) in the ray library's coordinates; `chances` and `each` as `RayScene.first_hits` takes them.

        Returns
        -------
        element : (n,) int32
            The leaf element met, `ESCAPED` or `BURIED`.
        root : (n,) int32
            The coarse patch met, or the cell of the world's map, and on the patch
        weights : (n, 2) float32
        distance : (n,) float32
        """
        found = self.rays.first_hits(origins, directions, chances, each)
        missed = found.triangle < 0
        triangle = np.maximum(found.triangle, 0)
        weights = found.weights()
        root = self.locator.coarse(triangle, weights)
        element = 2 * self.locator.leaves(root, weights) + found.back
        if self.cover is not None:
            self.cover.tell_apart(element, found.distance)
        element[self.unlit_side[2 * triangle + found.back]] = BURIED
        element[missed] = ESCAPED
        if self.surfaces.world.ndim > 1:
            root[missed] = map_cells(found.directions[missed])
        return element, root, weights, found.distance

    def follow_splits(self) -> int:
        """Drop the rows of patches that were split, and move the rays that met one to the child they met.

        Returns the number of rays moved; none is traced.
        """
        self.drop_split_rows()
        return self.move_rays()

    def drop_split_rows(self) -> None:
        """Forget the rows of patches that were split, whose parts are traced anew."""
        self.locator = Locator(self.tree)
        patch = np.repeat(self.tree.is_patch(), 2)
        self.tables = [table.taken(patch[table.element]) for table in self.tables]

    def move_rays(self) -> int:
        """Move the rays that met a patch that was split to the child they met, and return their number.

        The rows of split patches stay, and tell of their parts together.
        """
        moved, tree = 0, self.tree
        split = np.append(np.repeat(~tree.is_patch(), 2), [False, False])
        for table in self.tables:
            flat = table.hits.reshape(-1)
            stale = np.flatnonzero(split[flat])
            root = table.root.reshape(-1)[stale].astype(np.int64)
            leaf, _ = tree.descend(root, table.weights.reshape(-1, 2)[stale])
            flat[stale] = 2 * tree.patch[leaf] + (flat[stale] & 1)
            moved += len(stale)
        return moved

    def coupling(self, receivers: Ints, sources: Ints) -> Floats:
        """How strongly elements see each other by the distance and angles of their middles: an estimate, (p,).

        It is the form factor to a small source of the same area, and stays below 1 where they touch.
        """
        tree = self.tree
        nodes, place = np.unique(np.concatenate([receivers, sources]) >> 1, return_inverse=True)
        receiver, source = place[: len(receivers)], place[len(receivers) :]
        middle = tree.points[tree.corners[nodes]].mean(axis=1).astype(np.float32)
        area = tree.areas(nodes).astype(np.float32)
        normal = self.surfaces.normals[tree.triangle[nodes]].astype(np.float32)
        toward = middle[source] - middle[receiver]
        square = np.einsum("px,px->p", toward, toward)
        cosines = np.einsum("px,px->p", toward, normal[receiver]) * np.einsum("px,px->p", toward, normal[source])
        size = area[source]
        with np.errstate(invalid="ignore"):
            result: Floats = np.abs(cosines) * size / (square * (np.pi * square + size))
        return np.nan_to_num(result)

    def unoccluded_factors(self, receivers: Ints, sources: Ints) -> Floats:
        """Form factor from each receiver to each source as if nothing were in between, (p,)."""
        points, normals = sample_points(self.surfaces, self.tree, receivers, POINTS_OF_A_FACTOR, self.seed + 21)
        corners = self.tree.points[self.tree.corners[sources >> 1]]
        return point_to_triangle(points, normals, corners[:, None]).mean(axis=1)

    def lengthen_few(self, report: Callable[[float], None] = lambda share: None) -> None:
        """Trace more rays for elements whose rays are too few to tell.

        They are those most of whose rays started inside a solid, and those that send out much of all light.
        """
        table = self.tables[0]
        few = (table.valid > 0) & (2 * table.valid < table.hits.shape[1])
        few |= self._emitted_share(table.element) > LARGE_SHARE
        if few.any():
            self.lengthen(np.sort(table.element[few]), report)
            # What more rays are the first to meet sends and gets light as all else does.
            while len(met := self.met_but_untraced()):
                self.trace(met, report)

    def _emitted_share(self, elements: Ints) -> Floats:
        """Share of the light emitted by all of some elements that each of them emits, (m,)."""
        node = elements >> 1
        # The triangles of a cluster emit alike.
        power = self.surfaces.emission[self.tree.triangle[node]].sum(axis=1) * self.tree.areas(node)
        share: Floats = power / max(power.sum(), np.finfo(np.float64).tiny)
        return share

    def open_points(self, elements: Ints, count: int) -> tuple[Floats, Floats]:
        """Points of elements from which a ray left that did not start inside a solid, and normals, (m, count, 3)."""
        weights = np.zeros((len(elements), count, 2))
        carriers = np.repeat(elements[:, None] >> 1, count, axis=1)
        place = np.full(2 * len(self.tree), -1, dtype=np.int64)
        positions = np.concatenate([patterns.positions for patterns in self._patterns], axis=1)
        pattern, _ = self._patterns[0].choose(self.tree.keys(elements), self.seed)
        for table in self.tables:
            place[:] = -1
            place[table.element] = np.arange(len(table.element))
            here = np.flatnonzero(place[elements] >= 0)
            row = place[elements[here]]
            first_valid = np.argsort(table.hits[row] == BURIED, axis=1, kind="stable")
            turn = np.arange(count) % np.maximum(table.valid[row], 1)[:, None]
            ray = np.take_along_axis(first_valid, turn, axis=1)
            weights[here] = positions[pattern[here][:, None], ray, 1:]
            left = np.concatenate([self._carriers(elements[here], patterns) for patterns in self._patterns], axis=1)
            carriers[here] = np.take_along_axis(left, ray, axis=1)
        return points_on(self.surfaces, self.tree, elements, carriers, weights)

    def separate_cover(self, report: Callable[[float], None] = lambda share: None) -> Cover:
        """Find the elements that are covered in part, and send short rays to their twins; ends refinement."""
        tree = self.tree
        reach = np.repeat(COVER_GAP * self.rays.scale * tree.sizes(np.arange(len(tree))), 2).astype(np.float32)
        some = []
        for table in self.tables:
            short = (table.distance < reach[table.element][:, None]).mean(axis=1)
            some.append(table.element[(short > 0.5 / COVER_POINTS) & (short < 1.0 - 0.5 / COVER_POINTS)])
        elements = np.sort(np.concatenate(some))
        points, normals = sample_points(self.surfaces, tree, elements, self.cover_points, self.seed + 31)
        for rays in (COVER_RAYS, SURE_COVER_RAYS):
            short = self._short(elements, points, normals, reach, rays, report)
            covered = short >= LEAST_SHORT
            mixed = covered.any(axis=1) & ~covered.all(axis=1)
            elements, points, normals, short = elements[mixed], points[mixed], normals[mixed], short[mixed]
        twin = np.full(2 * len(tree), -1, dtype=np.int32)
        twin[elements] = 2 * len(tree) + np.arange(len(elements))
        self.cover = Cover(elements, points, normals, short, 2 * len(tree), twin, reach)
        for table in self.tables:
            hits = np.maximum(table.hits, 0)
            self.cover.tell_apart(hits, table.distance)
            np.copyto(table.hits, hits, where=table.hits >= 0)
        return self.cover

    def _short(
        self,
        elements: Ints,
        points: Floats,
        normals: Floats,
        reach: Singles,
        rays: int,
        report: Callable[[float], None],
    ) -> Floats:
        """Share of short ones of so many rays at points of elements, (k, points)."""
        patterns = Patterns.make(0, rays, self.seed + 32)
        count = points.shape[1]

        def work(first: int, last: int) -> Floats:
            axis = normals[first:last].reshape(-1, 3)
            key = keys_of_points(self.tree.keys(elements[first:last]), count)
            pattern, angle = patterns.choose(key, self.seed + 33)
            directions = (patterns.directions[pattern] @ frames(axis, angle)).reshape(-1, 3)
            start = self.rays.local(points[first:last].reshape(-1, 3)) + (axis * OFFSET).astype(np.float32)
            found = self.rays.first_hits(np.repeat(start, rays, axis=0), directions, each=rays)
            short = found.distance.reshape(-1, count, rays) < reach[elements[first:last]][:, None, None]
            result: Floats = short.mean(axis=2)
            return result

        parts = self.rays.workers.map(work, len(elements), count * rays, report)
        return np.concatenate([np.zeros((0, count)), *parts])

    def is_aside(self) -> NDArray[np.bool_]:
        """Elements that are partly inside a solid or covered, whose light is that of their rest, (2 * nodes,)."""
        aside = self.buried_share() > 0.0
        if self.cover is not None:
            aside |= self.cover.twin >= 0
        return aside

    def shares(self) -> Shares:
        """Form factors of all pairs from the rows as they are; those of twins from their short rays."""
        parts = []
        for table in self.tables:
            if self.cover is not None:
                mixed = self.cover.twin[table.element] >= 0
                parts.append(split_shares(table.taken(mixed), self.cover))
                table = table.taken(~mixed)
            parts.append(all_shares(table))
        return joined(parts)

    def shares_to(self, wanted: NDArray[np.bool_], first_row: int = 0, last_row: int | None = None) -> Shares:
        """Form factors from some rows of ordinary length to the elements marked in `wanted` (2 * nodes,).

        It costs less than `shares`, and is for the time before any row is lengthened.
        """
        return shares_to(self.tables[0].taken(slice(first_row, last_row)), np.append(wanted, [False, False]))

    def met_share(self, elements: Ints) -> Floats:
        """Share of elements (m,) that rays from outside meet: less than 1 where something else lies in their plane.

        Of two faces in one place rays meet now the one and now the other, and what both get is there once.
        """
        share = np.ones(len(elements))
        doubled = self.surfaces.doubled() & self.surfaces.seen
        asked = np.flatnonzero(doubled[self.tree.triangle[elements >> 1]])
        points, normals = sample_points(self.surfaces, self.tree, elements[asked], PROBES, self.seed + 61)

        def work(first: int, last: int) -> Floats:
            axis = normals[first:last].reshape(-1, 3)
            start = self.rays.local(points[first:last].reshape(-1, 3)) + (axis * PROBES_FROM * OFFSET).astype(
                np.float32
            )
            met = self.look(start, -axis.astype(np.float32), each=PROBES)[0].astype(np.int64)
            # What solids bury is no share of what is left.
            buried = met == BURIED
            if self.cover is not None:
                met[~buried] = self.cover.base_of(met[~buried])
            own = met.reshape(-1, PROBES) == elements[asked[first:last], None]
            left = PROBES - buried.reshape(-1, PROBES).sum(axis=1)
            result: Floats = np.where(left > 0, own.sum(axis=1) / np.maximum(left, 1), 1.0)
            return result

        parts = self.rays.workers.map(work, len(asked), PROBES)
        share[asked] = np.concatenate([np.zeros(0), *parts])
        return share

    def buried_share(self) -> Floats:
        """Share of each element's rays that started inside a solid, (2 * nodes,); 0 for elements without a row."""
        buried = np.zeros(2 * len(self.tree))
        for table in self.tables:
            buried[table.element] = 1.0 - table.valid / table.hits.shape[1]
        return buried
