# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Points of surfaces that light is asked for at, as sampling needs to know them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

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
    keys : (n,) int
        Numbers that choose their sampling patterns.
    mesh : (n,) int
        That each lies on; any where no light is for some of the meshes alone.
    """

    points: Floats
    normals: Floats
    lift: Floats
    keys: Ints
    mesh: Ints

    @staticmethod
    def of(points: Floats, normals: Floats, keys: Ints | None = None, mesh: Ints | None = None) -> LitPoints:
        """Points of flat surfaces, each with a pattern of its own and on the first mesh unless told otherwise."""
        count = len(points)
        own = np.arange(count) if keys is None else keys
        return LitPoints(points, normals, normals, own, np.zeros(count, dtype=np.int64) if mesh is None else mesh)

    def __len__(self) -> int:
        return len(self.points)

    @property
    def leans(self) -> bool:
        """Whether any shading normal may lean over its face."""
        return self.lift is not self.normals

    def taken(self, which: Ints | slice) -> LitPoints:
        """Some of them."""
        normals = self.normals[which]
        lift = self.lift[which] if self.leans else normals
        return LitPoints(self.points[which], normals, lift, self.keys[which], self.mesh[which])
