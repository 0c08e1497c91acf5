# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Points of surfaces that light is asked for at, as sampling needs to know them."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from .scene import Floats, Ints


@dataclass(frozen=True, eq=False)
class LitPoints:
    """Points that get light.

    Attributes
    ----------
    points, normals : (n, 3) float
        Where, and the axis of the hemisphere that light comes from.
    lift : (n, 3) float
        The side of the true surface that rays start on: `normals` themselves where none of them leans over its face.
    rise : (n, 3) float, scene units
        How far the curved surface that a smooth face stands for lies above it, see `core.terminator`.
    grazing : (n,) float
        Cosine to the face below which light is grazing.
    keys : (n,) int
        Numbers that choose their sampling patterns.
    mesh : (n,) int
        That each lies on; any where no light is for some of the meshes alone.
    """

    points: Floats
    normals: Floats
    lift: Floats
    rise: Floats
    grazing: Floats
    keys: Ints
    mesh: Ints

    @staticmethod
    def of(points: Floats, normals: Floats, keys: Ints | None = None, mesh: Ints | None = None) -> LitPoints:
        """Points of flat surfaces, each with a pattern of its own and on the first mesh unless told otherwise."""
        count = len(points)
        own = np.arange(count) if keys is None else keys
        on_mesh = np.zeros(count, dtype=np.int64) if mesh is None else mesh
        return LitPoints(points, normals, normals, np.zeros((count, 3)), np.ones(count), own, on_mesh)

    def __len__(self) -> int:
        return len(self.points)

    @property
    def leans(self) -> bool:
        """Whether any shading normal may lean over its face."""
        return self.lift is not self.normals

    @cached_property
    def bulges(self) -> NDArray[np.bool_]:
        """Points that a curved surface is meant to lie above, (n,)."""
        found: NDArray[np.bool_] = self.rise.any(axis=1)
        return found

    def taken(self, which: Ints | slice) -> LitPoints:
        """Some of them."""
        normals = self.normals[which]
        lift = self.lift[which] if self.leans else normals
        of_face = self.rise[which], self.grazing[which]
        return LitPoints(self.points[which], normals, lift, *of_face, self.keys[which], self.mesh[which])
