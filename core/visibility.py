# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The one door to the ray library: owns its scaling, its offsets, its threads and its counts."""

from __future__ import annotations

import copy
import threading
import time
from dataclasses import dataclass
from functools import cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .errors import RayLibraryError
from .scene import Floats, Ints
from .workers import Workers

OFFSET = 2e-6
"""Distance by which rays start off their surface, in units of the scene's largest extent. Coordinates are centred and
scaled to [-0.5, 0.5], where neighbouring float32 differ by 6e-8 at most: 33 of these steps, well above the few that an
intersection is off by, and below a gap of 0.1 mm in a scene of 50 m."""


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
    """

    triangle: NDArray[np.int32]
    u: NDArray[np.float32]
    v: NDArray[np.float32]
    distance: NDArray[np.float32]
    back: NDArray[np.bool_]

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
    ) -> None:
        self.workers = Workers(threads)
        used = points[triangles.ravel()]
        low, high = used.min(axis=0), used.max(axis=0)
        self._centre = (low + high) / 2.0
        extent = float((high - low).max())
        self.scale = 1.0 / extent if extent > 0.0 else 1.0
        self.rays = 0
        self.seconds = 0.0
        self._counting = threading.Lock()
        chosen = [np.ones(len(triangles), dtype=bool) if mask is None else mask for mask in (seen, shadow)]
        self._of_seen = self._of_shadow = _Triangles(self.local(points), triangles, chosen[0])
        if (chosen[0] != chosen[1]).any():
            self._of_shadow = _Triangles(self.local(points), triangles, chosen[1])
        self._whole: RayScene | None = None
        self._of_blockers = {
            which: _Triangles(self.local(points), triangles, mask) for which, mask in (blockers or {}).items()
        }

    def hidden_by(self, blockers: frozenset[int] | None) -> RayScene:
        """The same scene, in which these meshes alone hide things in `visible`; None for all that throw shadows."""
        if blockers is None:
            return self
        other = copy.copy(self)
        other._of_shadow, other._whole = self._of_blockers[blockers], self
        return other

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

    def first_hits(self, origins: NDArray[np.float32], directions: NDArray[np.float32]) -> Hits:
        """Trace rays (n, 3) from origins in local coordinates, lifted off their surface by `OFFSET`."""
        answer = self._run(self._of_seen, origins, directions, query="INTERSECT", output=True)
        back = np.einsum("nx,nx->n", directions, answer["Ng"]) > 0.0
        return Hits(self._of_seen.number(answer["primID"]), answer["u"], answer["v"], answer["tfar"], back)

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

    def visible(self, origins: NDArray[np.float32], toward: NDArray[np.float32]) -> NDArray[np.bool_]:
        """Whether nothing lies between origins and targets, both lifted off their surfaces, (n, r) bool.

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
            self._of_shadow, starts, toward.reshape(-1, 3), dists=ends, query="OCCLUDED"
        )
        return answer.reshape(toward.shape[:2]) < 0
