# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""What goes straight through triangles: curtains, panes, and the holes of leaves that a texture's alpha cuts out.

To others such a triangle is an opaque one full of holes: a ray meets what is opaque of it or goes on. Its reflectance
and emission are means over all of it, so where a ray has met it they count as those of its opaque share.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from .sampling import Singles
from .scene import LUMINANCE, Floats, Ints, SurfaceMesh, Texture
from .textures import cell_at, joined, mean_colours, with_means

OPAQUE = 1e-3
"""Share of the light up to which what goes through is left out, as nothing is seen of it."""


@dataclass(frozen=True, eq=False)
class Transmittance:
    """The shares of light that go straight through triangles.

    Attributes
    ----------
    means : (t, 1) float, 0..1
        Over each triangle, in luminance.
    texture : Texture or None
        Of those over which it varies; its colours are (cells, 1).
    """

    means: Floats
    texture: Texture | None

    @cached_property
    def some(self) -> NDArray[np.bool_]:
        """Triangles that let any light through, (t,)."""
        result: NDArray[np.bool_] = self.means[:, 0] > OPAQUE
        return result

    @cached_property
    def _table(self) -> tuple[Ints, Ints, Singles]:
        """Cells along the edges of each triangle, 1 where it does not vary, its first cell, and the shares of all."""
        count = len(self.means)
        along, first = np.ones(count, dtype=np.int64), np.arange(count)
        shares = self.means[:, 0]
        if self.texture is not None:
            cells = self.texture.along**2
            along[self.texture.triangle] = self.texture.along
            first[self.texture.triangle] = count + np.cumsum(cells) - cells
            shares = np.concatenate([shares, self.texture.colours[:, 0]])
        return along, first, shares.astype(np.float32)

    def at(self, triangle: NDArray[np.int32], u: Singles, v: Singles) -> Singles:
        """The share at places of triangles, (n,), by barycentric weights of corners 1 and 2."""
        along, first, shares = self._table
        cell = first[triangle] + cell_at(along[triangle], u.astype(np.float64), v.astype(np.float64))
        result: Singles = shares[cell]
        return result

    def opacity_over(self, triangle: Ints, corners: Floats, row: Ints | None = None) -> Floats:
        """Mean share over parts of triangles that does not go through, (n, 1); see `mean_colours`."""
        opacity: Floats = 1.0 - mean_colours(self.means, self.texture, triangle, corners, row)
        return opacity


def transmittance_of(meshes: tuple[SurfaceMesh, ...], kept: list[Ints]) -> Transmittance | None:
    """What goes through the triangles `kept` of meshes, in the order of both; None where nothing does."""
    means = [
        np.zeros((len(k), 1)) if m.transmittance is None else _share(m.transmittance[k])
        for m, k in zip(meshes, kept, strict=True)
    ]
    texture = joined([(mesh.transmittance_texture, k) for mesh, k in zip(meshes, kept, strict=True)])
    if texture is not None:
        texture = replace(texture, colours=_share(texture.colours).astype(np.float32))
    found = Transmittance(with_means(np.concatenate(means), texture), texture)
    return found if found.some.any() else None


def of_opaque(colours: Floats, opacity: Floats) -> Floats:
    """Colours (n, 3), means over all of surfaces, as those of their opaque shares, (n, 1); 0 where all is clear."""
    result: Floats = np.divide(colours, opacity, out=np.zeros_like(colours), where=opacity > OPAQUE)
    return result


def _share(colours: Floats | Singles) -> Floats:
    share: Floats = np.clip(np.nan_to_num(colours, posinf=1.0), 0.0, 1.0) @ LUMINANCE
    return share[:, None]
