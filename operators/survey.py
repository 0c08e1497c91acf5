# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Whether one tracing serves all frames of a range, told before the first ray: what moves, and what shines when."""

import numpy as np
from numpy.typing import NDArray

from ..core.errors import BakeError
from ..core.relight import shapes_of, sources_of
from ..core.scene import Scene

_WAY_OUT = "choose Original Mesh as the output, or a file for each frame"


class UnlikeFramesError(BakeError):
    """The frames need tracings of their own."""


class Survey:
    """What the frames of a range have in common."""

    def __init__(self) -> None:
        self._shapes: tuple[bytes, ...] = ()
        self._names: list[str] = []
        self._sources: dict[int, NDArray[np.bool_]] = {}

    def look(self, frame: int, scene: Scene) -> None:
        """Compare a frame with the first.

        Raises
        ------
        UnlikeFramesError
            When something moved or changed its shape, so that refined meshes of the two would differ.
        """
        shapes = shapes_of(scene)
        if not self._sources:
            self._shapes = shapes
            self._names = _names_of_sources(scene)
        elif shapes != self._shapes:
            raise UnlikeFramesError(f"{self._what_changed(shapes, scene)}; refined meshes would differ; {_WAY_OUT}")
        self._sources[frame] = sources_of(scene)

    def _what_changed(self, shapes: tuple[bytes, ...], scene: Scene) -> str:
        first = min(self._sources)
        if len(shapes) != len(self._shapes):
            return f"objects or lamps were added, removed or hidden since frame {first}"
        parts = (*scene.meshes, *scene.lamps)
        changed = next(part for part, now, then in zip(parts, shapes, self._shapes, strict=True) if now != then)
        return f'"{changed.name}" moved or changed its shape since frame {first}'

    def order(self) -> list[int]:
        """Return the frames in the order to light them: first one with all the lights of the range, to be traced.

        Raises
        ------
        UnlikeFramesError
            When there is none.
        """
        frames = list(self._sources)
        brightest = max(frames, key=lambda frame: int(self._sources[frame].sum()))
        for frame in frames:
            new = np.flatnonzero(self._sources[frame] & ~self._sources[brightest])
            if len(new):
                raise UnlikeFramesError(
                    f"{self._names[new[0]]} shines at frame {frame} and not at frame {brightest}, and none of the "
                    f"frames has all lights on, which the refined meshes of one bake need; {_WAY_OUT}"
                )
        return [brightest, *(frame for frame in frames if frame != brightest)]


def _names_of_sources(scene: Scene) -> list[str]:
    """Return what each entry of `sources_of` is, to begin a sentence with."""
    lamps = [f'"{lamp.name}"' for lamp in scene.lamps]
    faces = [f'"{mesh.name}"' for mesh in scene.meshes for _ in range(len(mesh.triangles))]
    return [*lamps, *faces, "The World", "A World that differs by direction"]
