# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The ray library, if it can be loaded, and triangles as it has them."""

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .errors import RayLibraryError
from .scene import Ints


@cache
def ray_library_problem() -> str | None:
    """Return why the ray library cannot be used, as a sentence, or None if it can; asked at every redraw."""
    try:
        library()
    except RayLibraryError as error:
        return str(error)
    return None


@cache
def library() -> Any:
    try:
        from embreex import mesh_construction, rtcore_scene
    except Exception as error:  # a wheel for another system may fail in any way while it is loaded
        raise RayLibraryError(
            f"The ray library embreex cannot be loaded ({error}); install the Radiosity Bake package made for this "
            "system and Blender version"
        ) from error
    return mesh_construction, rtcore_scene


class TracedTriangles:
    """Some of the triangles as the ray library has them."""

    def __init__(self, points: NDArray[np.float32], triangles: Ints, chosen: NDArray[np.bool_]) -> None:
        mesh_construction, rtcore_scene = library()
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
