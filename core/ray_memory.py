# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""What a bake remembers of the rays of the one before, and what has moved since."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from .geometry import frame
from .kept_rays import MOVED, Changes, KeptRays, KeptRows, RowsToKeep
from .ray_library import TracedTriangles
from .sampling import Singles
from .scene import Floats, Ints

COARSER, WITHIN = 1.5, 1.000001
"""Times the extent of the scene up to which the coordinates of a bake before serve it, as all of them must for its rays
to be known; and how far points may lie out of these, by rounding."""


class MovedTriangles:
    """What became of some of the triangles since an earlier bake, as the ray library has it.

    Attributes
    ----------
    now : (triangles before + 1,) int32
        The number of each triangle now; `MOVED` for those that are not where they were, or were not in question. The
        last is -1, for none.
    came, gone : TracedTriangles or None
        What is where nothing was, and what is not where it was: None where there is none.
    """

    def __init__(self, before: Ints, corners_before: Singles, after: Ints, corners: Singles) -> None:
        changes = Changes.between(corners_before, corners)
        self.now = np.full(int(before.max(initial=-1)) + 2, MOVED, dtype=np.int32)
        stayed = np.flatnonzero(changes.now >= 0)
        self.now[before[stayed]] = after[changes.now[stayed]]
        self.now[-1] = -1
        self.are_all = len(changes.gone) == len(before)
        self.came = self._triangles(corners[changes.came])
        self.gone = self._triangles(corners_before[changes.gone])
        self._number = after[changes.came].astype(np.int32)

    @staticmethod
    def _triangles(corners: Singles) -> TracedTriangles | None:
        count = len(corners)
        if count == 0:
            return None
        return TracedTriangles(corners.reshape(-1, 3), np.arange(3 * count).reshape(-1, 3), np.ones(count, dtype=bool))

    def number(self, met: NDArray[np.int32]) -> NDArray[np.int32]:
        """Numbers among all triangles of those that came and were met."""
        return self._number[met]


class RayMemory:
    """What rays met in the bake before, if there was one, and what they meet in this one.

    Parameters
    ----------
    before : KeptRays or None
    most : int
        Bytes to keep; 0 for nothing.
    centre, extent : of the ray library's coordinates
    points : (v, 3) float32
        In these.
    triangles : (t, 3) int
    seen, shadow : (t,) bool
        Triangles that rays meet, and those that hide things wholly.
    with_normals : bool
        Whether rays may go on behind a triangle, for which its normal is needed.
    """

    def __init__(
        self,
        before: KeptRays | None,
        most: int,
        centre: Floats,
        extent: float,
        points: Singles,
        triangles: Ints,
        seen: NDArray[np.bool_],
        shadow: NDArray[np.bool_],
        with_normals: bool,
    ) -> None:
        self._centre, self._extent = centre, extent
        self._seen, self._shadow = np.flatnonzero(seen), np.flatnonzero(shadow)
        self._seen_corners = points[triangles[self._seen]]
        self._shadow_corners = self._seen_corners if (seen == shadow).all() else points[triangles[self._shadow]]
        self.normals = np.zeros((len(triangles), 3), dtype=np.float32) if with_normals else None
        self.to_keep = RowsToKeep(most) if most else None
        self.hits: dict[int, KeptRows] = {}
        self.clear: dict[int, KeptRows] = {}
        if before is None or before.extent != extent or (before.centre != centre).any():
            return
        if with_normals and before.normals is None:
            return
        self.of_seen = MovedTriangles(before.seen, before.seen_corners, self._seen, self._seen_corners)
        self.of_shadow = MovedTriangles(before.shadow, before.shadow_corners, self._shadow, self._shadow_corners)
        self.hits = {} if self.of_seen.are_all else before.hits
        self.clear = {} if self.of_shadow.are_all else before.clear
        if self.normals is not None and before.normals is not None:
            stayed = np.flatnonzero(self.of_seen.now[:-1] >= 0)
            self.normals[self.of_seen.now[stayed]] = before.normals[stayed]

    def kept(self) -> KeptRays | None:
        """What there is to keep; None where it would be too much."""
        if self.to_keep is None or self.to_keep.are_too_many:
            return None
        return KeptRays(
            self._centre,
            self._extent,
            self._seen,
            self._seen_corners,
            self._shadow,
            self._shadow_corners,
            self.normals,
            self.to_keep.taken("hits"),
            self.to_keep.taken("clear"),
        )


def frame_of(points: Floats, before: KeptRays | None) -> tuple[Floats, float]:
    """Centre and extent of the ray library's coordinates: those of a bake before, while all points are in them."""
    centre, extent = frame(points)
    if before is None or not extent <= before.extent <= COARSER * extent:
        return centre, extent
    within = (np.abs(points - before.centre) <= 0.5 * WITHIN * before.extent).all()
    return (before.centre, before.extent) if within else (centre, extent)
