# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The one door to the ray library: owns its scaling, its offsets, its threads and its counts."""

from __future__ import annotations

import copy
import threading
import time
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .kept_rays import LEAST_ROW, MOVED, KeptRays, Keys, keys_of
from .ray_library import TracedTriangles
from .ray_memory import RayMemory, frame_of
from .sampling import Singles
from .scene import Floats, Ints
from .transmittance import Transmittance
from .workers import Workers

OFFSET = 2e-6
"""Distance by which rays start off their surface, in units of the scene's largest extent. Coordinates are centred and
scaled to [-0.5, 0.5], where neighbouring float32 differ by 6e-8 at most: 33 of these steps, well above the few that an
intersection is off by, and below a gap of 0.1 mm in a scene of 50 m."""


FAINTEST = np.float32(1e-4)
"""Share of the light below which what comes through many sheets counts as nothing."""

MOST_SHEETS = 256
"""Surfaces that let some of the light through, which a ray goes on behind at most."""


@dataclass(frozen=True, eq=False)
class Hits:
    """Where rays first met a surface.

    Attributes
    ----------
    triangle : (n,) int32
        -1 where the ray left the scene.
    u, v : (n,) float32
        Barycentric weights of the triangle's corners 1 and 2.
    distance : (n,) float32, local units
        Huge where the ray left the scene.
    back : (n,) bool
        Whether the ray met the side that the triangle's winding makes the back.
    directions : (n, 3) float32
        In which the rays came: not as they left, where glass reflected them.
    """

    triangle: NDArray[np.int32]
    u: NDArray[np.float32]
    v: NDArray[np.float32]
    distance: NDArray[np.float32]
    back: NDArray[np.bool_]
    directions: NDArray[np.float32]

    def codes(self) -> NDArray[np.int32]:
        """Triangles and sides in one: twice the triangle, and 1 more for its back, (n,); below 0 for none."""
        codes: NDArray[np.int32] = 2 * self.triangle + self.back
        return codes

    def take(self, which: Ints, others: Hits) -> None:
        """Put others in place of some, but for the directions."""
        for name in ("triangle", "u", "v", "distance", "back"):
            getattr(self, name)[which] = getattr(others, name)

    def weights(self) -> NDArray[np.float32]:
        """The two weights side by side, (n, 2)."""
        return np.stack([self.u, self.v], axis=1)


@dataclass(frozen=True, eq=False)
class _Blockers:
    """What hides things: triangles that do so wholly, and those that let some of the light through, if any do."""

    opaque: TracedTriangles
    sheets: TracedTriangles | None


class RayScene:
    """Triangles that rays can be traced against, from several threads.

    Parameters
    ----------
    points : (v, 3) float, scene units
    triangles : (t, 3) int
    threads : int
        0 takes every core.
    seen, shadow : (t,) bool or None
        Triangles that `first_hits` meets, and those that hide things in `visible`; None for all.
    blockers : dict of (t,) bool, or None
        Other triangles that hide what is asked of `hidden_by`, by the numbers of their meshes.
    transmittance : Transmittance or None
        What goes through triangles.
    before : KeptRays or None
        What rays met in another bake, which is not to be traced again.
    most_kept : int
        Bytes of what rays meet in this one that are kept; 0 keeps nothing.

    Attributes
    ----------
    workers : Workers
    rays : int
        Rays traced so far.
    known : int
        Rays that were not, as others had met before what they meet; of them, only what moved was asked.
    seconds : float
        Time spent inside the ray library, summed over threads.
    scale : float
        Local units for a scene unit.
    """

    def __init__(
        self,
        points: Floats,
        triangles: Ints,
        threads: int = 0,
        seen: NDArray[np.bool_] | None = None,
        shadow: NDArray[np.bool_] | None = None,
        blockers: dict[frozenset[int], NDArray[np.bool_]] | None = None,
        transmittance: Transmittance | None = None,
        before: KeptRays | None = None,
        most_kept: int = 0,
    ) -> None:
        self.workers = Workers(threads)
        self._centre, extent = frame_of(points[triangles.ravel()], before)
        self.scale = 1.0 / extent if extent > 0.0 else 1.0
        self.rays = self.known = 0
        self.seconds = 0.0
        self._counting = threading.Lock()
        chosen = [np.ones(len(triangles), dtype=bool) if mask is None else mask for mask in (seen, shadow)]
        self.transmittance = transmittance
        self._of_seen = TracedTriangles(self.local(points), triangles, chosen[0])

        def blocking(mask: NDArray[np.bool_]) -> _Blockers:
            through = mask & (transmittance.some if transmittance is not None else False)
            wholly = mask & ~through
            same = (wholly == chosen[0]).all()
            return _Blockers(
                self._of_seen if same else TracedTriangles(self.local(points), triangles, wholly),
                TracedTriangles(self.local(points), triangles, through) if through.any() else None,
            )

        self._of_shadow = blocking(chosen[1])
        self._of_sight = self._of_shadow if (chosen[0] == chosen[1]).all() else blocking(chosen[0])
        self._whole: RayScene | None = None
        self._of_blockers = {which: blocking(mask) for which, mask in (blockers or {}).items()}
        self._memory: RayMemory | None = None
        self._throws_shadows = True
        if most_kept or before is not None:
            some = transmittance.some if transmittance is not None else np.zeros(len(triangles), dtype=bool)
            self._memory = RayMemory(
                before,
                most_kept,
                self._centre,
                extent,
                self.local(points),
                triangles,
                chosen[0],
                chosen[1] & ~some,
                transmittance is not None,
            )

    @property
    def remembers(self) -> bool:
        """Whether rays of a bake before are known, or those of this one are kept."""
        return self._memory is not None

    def kept(self) -> KeptRays | None:
        """What rays met, for another bake; None where that is not wanted, or would be too much."""
        return self._memory.kept() if self._memory is not None else None

    def hidden_by(self, blockers: frozenset[int] | None) -> RayScene:
        """The same scene, in which these meshes alone hide things in `visible`; None for all that throw shadows."""
        if blockers is None:
            return self
        other = copy.copy(self)
        other._of_shadow, other._whole = self._of_blockers[blockers], self._whole or self
        other._throws_shadows = False
        return other

    def of_sight(self) -> RayScene:
        """The same scene, in which `visible` asks for what `first_hits` meets, whether it throws shadows or not."""
        other = copy.copy(self)
        other._of_shadow, other._whole = self._of_sight, self._whole or self
        other._throws_shadows = self._throws_shadows and self._of_sight is self._of_shadow
        return other

    def in_channels(self) -> tuple[RayScene, ...]:
        """The same scene for light of each channel, where what goes through is tinted; else it alone."""
        if self.transmittance is None or not self.transmittance.channels:
            return (self,)
        scenes = []
        for channel in self.transmittance.channels:
            other = copy.copy(self)
            other.transmittance, other._whole = channel, self._whole or self
            scenes.append(other)
        return tuple(scenes)

    def close(self) -> None:
        """End the threads."""
        self.workers.close()

    def local(self, points: Floats) -> NDArray[np.float32]:
        """Positions (..., 3) in the ray library's own coordinates, centred and scaled to 1."""
        return ((points - self._centre) * self.scale).astype(np.float32)

    def _run(
        self,
        triangles: TracedTriangles,
        origins: NDArray[np.float32],
        directions: NDArray[np.float32],
        known: bool = False,
        **options: Any,
    ) -> Any:
        """Trace rays, which do not count where they are `known` and only what moved is asked."""
        start = time.perf_counter()
        answer = triangles.run(origins, directions, **options)
        elapsed = time.perf_counter() - start
        whole = self._whole or self
        with self._counting:
            whole.seconds += elapsed
            if not known:
                whole.rays += len(origins)
        return answer

    def first_hits(
        self,
        origins: NDArray[np.float32],
        directions: NDArray[np.float32],
        chances: Singles | None = None,
        each: int = 1,
    ) -> Hits:
        """Trace rays (n, 3) from origins in local coordinates, lifted off their surface by `OFFSET`.

        Parameters
        ----------
        chances : (n,) float32, 0..1, or None
            Of each ray: it goes on through what lets a larger share of the light through, or is reflected by glass.
            None has all go through what is more clear than opaque.
        each : int
            Rays that belong together, such as those of one receiver: they are kept, and found again, as a row.
        """
        hits, normals = self._first_hits_of_rows(origins, directions, each)
        if self.transmittance is None:
            return hits
        left = np.full(len(origins), 0.5, dtype=np.float32) if chances is None else chances.copy()
        mirrored = replace(hits, directions=directions.copy())
        self._go_on(mirrored, normals, origins, left)
        return mirrored

    def _first_hits(self, origins: Singles, directions: Singles) -> tuple[Hits, Singles]:
        """What rays meet, and the normals there, (n, 3), of any length."""
        answer = self._run(self._of_seen, origins, directions, query="INTERSECT", output=True)
        return _hits_of(answer, self._of_seen.number(answer["primID"]), directions), answer["Ng"]

    def _first_hits_of_rows(self, origins: Singles, directions: Singles, each: int) -> tuple[Hits, Singles]:
        """The same, but what rays met before is asked for what moved alone; what all meet is kept."""
        memory = self._memory
        if memory is None or each < LEAST_ROW or len(directions) == 0:
            return self._first_hits(origins, directions)
        keys = keys_of(origins, directions, each)
        if each in memory.hits:
            hits, normals = self._known_hits(memory, origins, directions, keys, each)
        else:
            hits, normals = self._first_hits(origins, directions)
        if memory.to_keep is not None:
            # Whoever asked may change what they were given.
            columns = (values.reshape(-1, each).copy() for values in (hits.codes(), hits.u, hits.v, hits.distance))
            memory.to_keep.add("hits", each, keys, *columns)
        if memory.normals is not None:
            met = np.flatnonzero(hits.triangle >= 0)
            memory.normals[hits.triangle[met]] = normals[met]
        return hits, normals

    def _known_hits(
        self, memory: RayMemory, origins: Singles, directions: Singles, keys: Keys, each: int
    ) -> tuple[Hits, Singles]:
        """What rays meet, those of known rows by what they met before, and normals there where they are needed."""
        rows = memory.hits[each]
        known, place = rows.find(keys)
        code, u, v, distance = (answer[place].ravel() for answer in rows.answers)
        moved = memory.of_seen
        hits = Hits(moved.now[code >> 1], u, v, distance, code & 1 == 1, directions)
        normals = np.zeros_like(directions) if memory.normals is None else memory.normals[np.maximum(hits.triangle, 0)]
        again = np.repeat(~known, each) | (hits.triangle == MOVED)
        left = np.flatnonzero(again)
        self._count_known(len(directions) - len(left))
        if moved.came is not None:
            distance[left] = 0.0
            limits = {"dists": distance, "query": "INTERSECT", "output": True}
            answer = self._run(moved.came, origins, directions, known=True, **limits)
            nearer = np.flatnonzero(answer["primID"] >= 0)
            answer = {name: values[nearer] for name, values in answer.items()}
            hits.take(nearer, _hits_of(answer, moved.number(answer["primID"]), directions[nearer]))
            normals[nearer] = answer["Ng"]
        found, found_normals = self._first_hits(origins[left], directions[left])
        hits.take(left, found)
        normals[left] = found_normals
        return hits, normals

    def _count_known(self, rays: int) -> None:
        whole = self._whole or self
        with self._counting:
            whole.known += rays

    def _go_on(self, hits: Hits, normals: Singles, origins: Singles, chances: Singles) -> None:
        """Put in place of hits that let a ray through what it meets behind; `chances` are used up."""
        assert self.transmittance is not None
        rows = np.flatnonzero(hits.triangle >= 0)
        normals, starts, reach = normals[rows], origins[rows], hits.distance[rows]
        for _ in range(MOST_SHEETS):
            on = np.flatnonzero(self.transmittance.some[hits.triangle[rows]])
            share = self.transmittance.at(hits.triangle[rows[on]], hits.u[rows[on]], hits.v[rows[on]])
            on, share = on[chances[rows[on]] < share], share[chances[rows[on]] < share]
            if len(on) == 0:
                return
            rows, normals, starts, reach = rows[on], normals[on], starts[on], reach[on]
            # What is left of a number below the share is as evenly spread as the number was.
            chances[rows] /= share
            way = hits.directions[rows]
            starts = _beyond(starts, way, reach, normals)
            glass = self.transmittance.reflected(hits.triangle[rows], way, normals)
            if glass is not None:
                back = np.flatnonzero(chances[rows] < glass)
                forth = np.flatnonzero(chances[rows] >= glass)
                chances[rows[back]] /= glass[back]
                chances[rows[forth]] = (chances[rows[forth]] - glass[forth]) / (1.0 - glass[forth])
                starts[back], way[back] = _mirrored(starts[back], way[back], normals[back])
                hits.directions[rows] = way
            behind, normals = self._first_hits(starts, way)
            reach = behind.distance
            hits.distance[rows] += reach
            for name in ("triangle", "u", "v", "back"):
                getattr(hits, name)[rows] = getattr(behind, name)
            on = np.flatnonzero(behind.triangle >= 0)
            rows, normals, starts, reach = rows[on], normals[on], starts[on], reach[on]

    def lifted(self, points: Floats, normals: Floats) -> tuple[NDArray[np.float32], Floats]:
        """Where rays start that leave a surface at points (n, 3) on the side of its normals.

        Returns
        -------
        origins : (n, 3) float32, local units
        back : (n, 3) float, local units
            The way from these origins to the points, free of their rounding: a target that is seen at a grazing angle
            must not slip through its plane.
        """
        exact = (points - self._centre) * self.scale
        origins = (exact + normals * OFFSET).astype(np.float32)
        return origins, exact - origins

    def visible(
        self, origins: NDArray[np.float32], toward: NDArray[np.float32]
    ) -> NDArray[np.bool_] | NDArray[np.float32]:
        """Whether nothing lies between origins and targets, both lifted off their surfaces, (n, r) bool.

        Where something lets a part of the light through, the share that arrives, (n, r) float32.

        Parameters
        ----------
        origins : (n, 3) float32, local units
        toward : (n, r, 3) float32, local units
            The way from each origin to its targets.
        """
        starts = np.repeat(origins, toward.shape[1], axis=0)
        clear = self._clear_of_rows(origins, starts, toward.reshape(-1, 3)).reshape(toward.shape[:2])
        if self._of_shadow.sheets is None:
            return clear
        return self._through(self._of_shadow.sheets, starts, toward.reshape(-1, 3), clear.ravel()).reshape(clear.shape)

    def _clear(
        self, starts: Singles, toward: Singles, triangles: TracedTriangles | None = None, known: bool = False
    ) -> NDArray[np.bool_]:
        """Whether none of some triangles, or of all that are opaque, hides the ends of rays (n,)."""
        # The ray library counts in lengths of the direction.
        limits = {"dists": np.ones(len(starts), dtype=np.float32), "query": "OCCLUDED"}
        answer = self._run(triangles or self._of_shadow.opaque, starts, toward, known=known, **limits)
        result: NDArray[np.bool_] = answer < 0
        return result

    def _clear_of_rows(self, origins: Singles, starts: Singles, toward: Singles) -> NDArray[np.bool_]:
        """The same of rows of rays, but what was asked before is asked for what moved alone; all answers are kept.

        Parameters
        ----------
        origins : (rows, 3) float32
        starts : (n, 3) float32
            The same for each ray.
        """
        memory, each = self._memory, len(starts) // max(len(origins), 1)
        if memory is None or not self._throws_shadows or each < LEAST_ROW:
            return self._clear(starts, toward)
        keys = keys_of(origins, toward, each)
        if each in memory.clear:
            clear = self._known_clear(memory, starts, toward, keys, each)
        else:
            clear = self._clear(starts, toward)
        if memory.to_keep is not None:
            memory.to_keep.add("clear", each, keys, np.packbits(clear.reshape(-1, each), axis=1))
        return clear

    def _known_clear(
        self, memory: RayMemory, starts: Singles, toward: Singles, keys: Keys, each: int
    ) -> NDArray[np.bool_]:
        """Whether rays are clear, those of known rows by whether they were before."""
        rows = memory.clear[each]
        known, place = rows.find(keys)
        clear = np.unpackbits(rows.answers[0][place], axis=1, count=each).ravel() > 0
        again = np.repeat(~known, each)
        moved = memory.of_shadow
        if moved.gone is not None:
            # What hid it is gone, but something else may hide it, too.
            hidden = np.flatnonzero(~clear & ~again)
            again[hidden] = ~self._clear(starts[hidden], toward[hidden], moved.gone, known=True)
        if moved.came is not None:
            free = np.flatnonzero(clear & ~again)
            clear[free] = self._clear(starts[free], toward[free], moved.came, known=True)
        left = np.flatnonzero(again)
        self._count_known(len(starts) - len(left))
        clear[left] = self._clear(starts[left], toward[left])
        return clear

    def _through(
        self, sheets: TracedTriangles, origins: Singles, directions: Singles, clear: NDArray[np.bool_]
    ) -> NDArray[np.float32]:
        """The share of the light that comes through sheets along those of the rays (n,) that are else clear."""
        assert self.transmittance is not None
        result = clear.astype(np.float32)
        rows = np.flatnonzero(clear)
        starts, way, gone = origins[rows], directions[rows], np.zeros(len(rows), dtype=np.float32)
        for _ in range(MOST_SHEETS):
            answer = self._run(sheets, starts, way, dists=1.0 - gone, query="INTERSECT", output=True)
            on = np.flatnonzero(answer["primID"] >= 0)
            met = sheets.number(answer["primID"][on])
            result[rows[on]] *= self.transmittance.at(met, answer["u"][on], answer["v"][on])
            glass = self.transmittance.reflected(met, way[on], answer["Ng"][on])
            if glass is not None:
                result[rows[on]] *= 1.0 - glass
            kept = result[rows[on]] > FAINTEST
            result[rows[on[~kept]]] = 0.0
            on = on[kept]
            if len(on) == 0:
                break
            starts = _beyond(starts[on], way[on], answer["tfar"][on], answer["Ng"][on])
            gone = np.minimum(gone[on] + answer["tfar"][on], np.float32(1.0))
            rows, way = rows[on], way[on]
        return result


def _hits_of(answer: Any, triangle: NDArray[np.int32], directions: Singles) -> Hits:
    """An answer of the ray library, with the triangles' numbers among all."""
    back = np.einsum("nx,nx->n", directions, answer["Ng"]) > 0.0
    return Hits(triangle, answer["u"], answer["v"], answer["tfar"], back, directions)


def spread_of_rays(seen: NDArray[np.bool_] | NDArray[np.float32], share: Floats) -> Floats:
    """Variance of what rays (n, r) to one light say of it, whose mean is `share`, (n,).

    Behind a curtain all say the same, half of the light: there is nothing to be in doubt of.
    """
    spread: Floats = share * (1.0 - share) if seen.dtype == bool else seen.var(axis=1, dtype=np.float64)
    return spread


def _mirrored(beyond: Singles, directions: Singles, normals: Singles) -> tuple[Singles, Singles]:
    """Where rays (n, 3) that would go on `beyond` a surface start on this side of it, and in which direction."""
    unit = normals / np.maximum(np.sqrt(np.einsum("nx,nx->n", normals, normals)), np.finfo(np.float32).tiny)[:, None]
    along = np.einsum("nx,nx->n", directions, unit)[:, None]
    return beyond - np.copysign(np.float32(2.0 * OFFSET), along) * unit, directions - 2.0 * along * unit


def _beyond(origins: Singles, directions: Singles, distance: Singles, normals: Singles) -> Singles:
    """Where rays (n, 3) go on behind what they met, off it by `OFFSET`."""
    side = np.einsum("nx,nx->n", directions, normals)
    length = np.sqrt(np.einsum("nx,nx->n", normals, normals))
    lift = np.copysign(np.float32(OFFSET), side) / np.maximum(length, np.finfo(np.float32).tiny)
    result: Singles = origins + directions * distance[:, None] + normals * lift[:, None]
    return result
