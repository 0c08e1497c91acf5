# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""What goes straight through triangles: curtains, panes, and the holes of leaves that a texture's alpha cuts out.

To others such a triangle is an opaque one full of holes: a ray meets what is opaque of it or goes on. Its reflectance
and emission are means over all of it, so where a ray has met it they count as those of its opaque share.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .sampling import Singles
from .scene import LUMINANCE, Floats, Ints, SurfaceMesh, Texture
from .textures import cell_at, joined, mean_colours, with_means

TINY = np.float32(np.finfo(np.float32).tiny)

MOST_REFRACTING = 10.0
"""Index of refraction above which none is taken."""

TINTED = 0.01
"""Difference between the channels of what goes through from which on they are told apart."""

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
    refraction : (t,) float32 or None
        Index of refraction of glass, 1 of all else; None where there is no glass.
    channels : tuple of Transmittance
        Of red, green and blue light, where some of it is tinted; else none.
    """

    means: Floats
    texture: Texture | None
    refraction: Singles | None = None
    channels: tuple[Transmittance, ...] = ()

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

    def reflected(self, triangle: NDArray[np.int32], directions: Singles, normals: Singles) -> Singles | None:
        """The share of what would go through that glass reflects instead, (n,); None where there is no glass.

        Parameters
        ----------
        triangle : (n,) int32
        directions, normals : (n, 3) float32
            Of rays, and of what they meet; of any length.
        """
        if self.refraction is None:
            return None
        square = np.einsum("nx,nx->n", directions, directions) * np.einsum("nx,nx->n", normals, normals)
        along = np.abs(np.einsum("nx,nx->n", directions, normals))
        return fresnel(np.minimum(along / np.sqrt(np.maximum(square, TINY)), 1.0), self.refraction[triangle])

    def opacity_over(self, triangle: Ints, corners: Floats, row: Ints | None = None) -> Floats:
        """Mean share over parts of triangles that does not go through, (n, 1); see `mean_colours`."""
        opacity: Floats = 1.0 - mean_colours(self.means, self.texture, triangle, corners, row)
        return opacity


def transmittance_of(meshes: tuple[SurfaceMesh, ...], kept: list[Ints]) -> Transmittance | None:
    """What goes through the triangles `kept` of meshes, in the order of both; None where nothing does."""
    means = _sound(
        np.concatenate(
            [
                np.zeros((len(k), 3)) if m.transmittance is None else m.transmittance[k]
                for m, k in zip(meshes, kept, strict=True)
            ]
        )
    )
    texture = joined([(mesh.transmittance_texture, k) for mesh, k in zip(meshes, kept, strict=True)])
    if texture is not None:
        texture = replace(texture, colours=_sound(texture.colours).astype(np.float32))
    index = [
        np.ones(len(k)) if m.refraction is None else np.nan_to_num(m.refraction[k], nan=1.0)
        for m, k in zip(meshes, kept, strict=True)
    ]
    refraction = np.clip(np.concatenate(index), 1.0, MOST_REFRACTING).astype(np.float32)
    glass = refraction if (refraction > 1.0).any() else None
    coloured: list[NDArray[Any]] = [means] if texture is None else [with_means(means, texture), texture.colours]
    weights = [np.eye(3)[k] for k in range(3)] if any((np.ptp(c, axis=1) > TINTED).any() for c in coloured) else []
    channels = tuple(_of_light(weight, means, texture, glass) for weight in weights)
    found = replace(_of_light(LUMINANCE, means, texture, glass), channels=channels)
    return found if found.some.any() else None


def _of_light(weights: Floats, means: Floats, texture: Texture | None, glass: Singles | None) -> Transmittance:
    """What goes through of light of some colour, (3,)."""
    own = None if texture is None else replace(texture, colours=(texture.colours @ weights).astype(np.float32)[:, None])
    return Transmittance(with_means((means @ weights)[:, None], own), own, glass)


def fresnel(cosine: Singles, refraction: Singles) -> Singles:
    """Share of light that glass reflects where it meets its surface at an angle outside of it, (n,).

    Inside, light meets the other surface of a pane at an angle at which as much is reflected. The formula is that of
    Cook & Torrance 1982.

    Parameters
    ----------
    cosine, refraction : (n,) float32
        Of the angle to the normal; the index.
    """
    bent = np.sqrt(refraction * refraction - 1.0 + cosine * cosine)
    across = (bent - cosine) / np.maximum(bent + cosine, TINY)
    along = (cosine * (bent + cosine) - 1.0) / (cosine * (bent - cosine) + 1.0)
    share: Singles = (0.5 * across * across * (1.0 + along * along)).astype(np.float32)
    return share


def of_opaque(colours: Floats, opacity: Floats) -> Floats:
    """Colours (n, 3), means over all of surfaces, as those of their opaque shares, (n, 1); 0 where all is clear."""
    result: Floats = np.divide(colours, opacity, out=np.zeros_like(colours), where=opacity > OPAQUE)
    return result


def _sound(colours: Floats | Singles) -> Floats:
    share: Floats = np.clip(np.nan_to_num(colours, posinf=1.0), 0.0, 1.0).astype(np.float64)
    return share
