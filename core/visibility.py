# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The one door to the ray library: owns its scaling, its offsets, its threads and its counts."""

from __future__ import annotations

import copy
import threading
import time
from dataclasses import dataclass, replace
from functools import cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .errors import RayLibraryError
from .geometry import frame
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


@cache
def ray_library_problem() -> str | None:
    """Return why the ray library cannot be used, as a sentence, or None if it can; asked at every redraw."""
    try:
        _library()
    except RayLibraryError as error:
        return str(error)
    return None


@cache
def _library() -> Any:
    try:
        from embreex import mesh_construction, rtcore_scene
    except Exception as error:  # a wheel for another system may fail in any way while it is loaded
        raise RayLibraryError(
            f"The ray library embreex cannot be loaded ({error}); install the Radiosity Bake package made for this "
            "system and Blender version"
        ) from error
    return mesh_construction, rtcore_scene


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

    def weights(self) -> NDArray[np.float32]:
        """The two weights side by side, (n, 2)."""
        return np.stack([self.u, self.v], axis=1)


class _Triangles:
    """Some of the triangles as the ray library has them."""

    def __init__(self, points: NDArray[np.float32], triangles: Ints, chosen: NDArray[np.bool_]) -> None:
        mesh_construction, rtcore_scene = _library()
        self._chosen = None if chosen.all() else np.flatnonzero(chosen).astype(np.int32)
        # The ray library takes no empty mesh; a triangle without area is never met.
        kept = triangles[chosen] if chosen.any() else np.zeros((1, 3))
        self._scene = rtcore_scene.EmbreeScene()
        mesh_construction.TriangleMesh(self._scene, points, kept.astype(np.int32))
        # Embree builds its tree at the first ray; do it here, on one thread.
        self._scene.run(np.zeros((1, 3), np.float32), np.array([[0, 0, 1]], np.float32), query="OCCLUDED")

    def run(self, origins: NDArray[np.float32], directions: NDArray[np.float32], **options: Any) -> Any:
        """Trace rays, as the ray library does."""
        return self._scene.run(origins, directions, **options)

    def number(self, met: NDArray[np.int32]) -> NDArray[np.int32]:
        """Numbers among all triangles of those that were met, -1 for none."""
        if self._chosen is None:
            return met
        known: NDArray[np.int32] = np.append(self._chosen, np.int32(-1))[met]
        return known


@dataclass(frozen=True, eq=False)
class _Blockers:
    """What hides things: triangles that do so wholly, and those that let some of the light through, if any do."""

    opaque: _Triangles
    sheets: _Triangles | None


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

    Attributes
    ----------
    workers : Workers
    rays : int
        Rays traced so far.
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
    ) -> None:
        self.workers = Workers(threads)
        self._centre, extent = frame(points[triangles.ravel()])
        self.scale = 1.0 / extent if extent > 0.0 else 1.0
        self.rays = 0
        self.seconds = 0.0
        self._counting = threading.Lock()
        chosen = [np.ones(len(triangles), dtype=bool) if mask is None else mask for mask in (seen, shadow)]
        self.transmittance = transmittance
        self._of_seen = _Triangles(self.local(points), triangles, chosen[0])

        def blocking(mask: NDArray[np.bool_]) -> _Blockers:
            through = mask & (transmittance.some if transmittance is not None else False)
            wholly = mask & ~through
            same = (wholly == chosen[0]).all()
            return _Blockers(
                self._of_seen if same else _Triangles(self.local(points), triangles, wholly),
                _Triangles(self.local(points), triangles, through) if through.any() else None,
            )

        self._of_shadow = blocking(chosen[1])
        self._of_sight = self._of_shadow if (chosen[0] == chosen[1]).all() else blocking(chosen[0])
        self._whole: RayScene | None = None
        self._of_blockers = {which: blocking(mask) for which, mask in (blockers or {}).items()}

    def hidden_by(self, blockers: frozenset[int] | None) -> RayScene:
        """The same scene, in which these meshes alone hide things in `visible`; None for all that throw shadows."""
        if blockers is None:
            return self
        other = copy.copy(self)
        other._of_shadow, other._whole = self._of_blockers[blockers], self._whole or self
        return other

    def of_sight(self) -> RayScene:
        """The same scene, in which `visible` asks for what `first_hits` meets, whether it throws shadows or not."""
        other = copy.copy(self)
        other._of_shadow, other._whole = self._of_sight, self._whole or self
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
        self, triangles: _Triangles, origins: NDArray[np.float32], directions: NDArray[np.float32], **options: Any
    ) -> Any:
        start = time.perf_counter()
        answer = triangles.run(origins, directions, **options)
        elapsed = time.perf_counter() - start
        whole = self._whole or self
        with self._counting:
            whole.seconds += elapsed
            whole.rays += len(origins)
        return answer

    def first_hits(
        self, origins: NDArray[np.float32], directions: NDArray[np.float32], chances: Singles | None = None
    ) -> Hits:
        """Trace rays (n, 3) from origins in local coordinates, lifted off their surface by `OFFSET`.

        Parameters
        ----------
        chances : (n,) float32, 0..1, or None
            Of each ray: it goes on through what lets a larger share of the light through, or is reflected by glass.
            None has all go through what is more clear than opaque.
        """
        hits, normals = self._first_hits(origins, directions)
        if self.transmittance is None:
            return hits
        left = np.full(len(origins), 0.5, dtype=np.float32) if chances is None else chances.copy()
        mirrored = replace(hits, directions=directions.copy())
        self._go_on(mirrored, normals, origins, left)
        return mirrored

    def _first_hits(self, origins: Singles, directions: Singles) -> tuple[Hits, Singles]:
        """What rays meet, and the normals there, (n, 3), of any length."""
        answer = self._run(self._of_seen, origins, directions, query="INTERSECT", output=True)
        back = np.einsum("nx,nx->n", directions, answer["Ng"]) > 0.0
        hits = Hits(self._of_seen.number(answer["primID"]), answer["u"], answer["v"], answer["tfar"], back, directions)
        return hits, answer["Ng"]

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
        # The ray library counts in lengths of the direction.
        ends = np.ones(len(starts), dtype=np.float32)
        answer: NDArray[np.int32] = self._run(
            self._of_shadow.opaque, starts, toward.reshape(-1, 3), dists=ends, query="OCCLUDED"
        )
        clear = answer.reshape(toward.shape[:2]) < 0
        if self._of_shadow.sheets is None:
            return clear
        return self._through(self._of_shadow.sheets, starts, toward.reshape(-1, 3), clear.ravel()).reshape(clear.shape)

    def _through(
        self, sheets: _Triangles, origins: Singles, directions: Singles, clear: NDArray[np.bool_]
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
