# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Colours that vary over triangles: their means over patches, cells and around vertices, and how images become cells.

Nothing is sampled at a point. An image is averaged over each cell of a triangle once, and what asks for a colour gets
the mean over the cells that it covers.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .sampling import Singles
from .scene import Floats, Ints, Texture

POINTS_AT_ONCE = 2**20
"""Cells that are looked up at once."""

MOST_STEPS = 512
"""Points along the edge of what a mean is taken over, at most."""


def cell_centres(along: int) -> Singles:
    """Barycentric weights of corners 1 and 2 at the centres of cells, (along^2, 2).

    A triangle with s cells along each edge has s * s of them: row i of the first weight holds s - i that stand like the
    triangle and between them s - i - 1 upside down.
    """
    row = np.repeat(np.arange(along), 2 * (along - np.arange(along)) - 1)
    within = np.arange(along**2) - row * (2 * along - row)
    third = np.where(within & 1, 2.0 / 3.0, 1.0 / 3.0)
    return (np.stack([row + third, (within >> 1) + third], axis=1) / along).astype(np.float32)


def cell_corners(centres: Singles, along: NDArray[Any]) -> Floats:
    """Barycentric coordinates of the corners of cells in their triangle, (n, 3, 3).

    Parameters
    ----------
    centres : (n, 2) float32
        As of `cell_centres`.
    along : (n,) int
        Cells along the edge of the triangle each lies in.
    """
    scaled = centres * along[:, None]
    upright = np.where(scaled[:, 0] - np.floor(scaled[:, 0]) < 0.5, 1.0, -1.0)
    third = (upright / (3.0 * along))[:, None, None]
    u, v = np.moveaxis(centres[:, None, :] + third * np.array([(-1.0, -1.0), (2.0, -1.0), (-1.0, 2.0)]), 2, 0)
    return np.stack([1.0 - u - v, u, v], axis=2)


def with_means(colours: Floats, texture: Texture | None) -> Floats:
    """Colours of triangles (t, 3), those that vary replaced by their mean."""
    if texture is None or len(texture.triangle) == 0:
        return colours
    means = colours.copy()
    first = np.cumsum(texture.along**2) - texture.along**2
    sums = np.add.reduceat(texture.colours, first, axis=0, dtype=np.float64)
    means[texture.triangle] = sums / (texture.along**2)[:, None]
    return means


def mean_colours(
    means: Floats, texture: Texture | None, triangle: Ints, corners: Floats, row: Ints | None = None
) -> Floats:
    """Mean colour over parts of triangles, (n, 3).

    Parameters
    ----------
    means : (t, 3) float
        Of whole triangles.
    texture : Texture or None
        Of those over which colours vary.
    triangle : (n,) int
        The triangle that each part lies in.
    corners : (n, 3, 3) float
        Barycentric coordinates of the part's corners in it.
    row : (n,) int or None
        Those of `corners` that are meant: they are taken for what varies alone.
    """
    result = means[triangle]
    if texture is None:
        return result
    number = np.full(len(means), -1, dtype=np.int64)
    number[texture.triangle] = np.arange(len(texture.triangle))
    chosen = np.flatnonzero(number[triangle] >= 0)
    which, parts = number[triangle[chosen]], corners[chosen if row is None else row[chosen]]
    first = np.cumsum(texture.along**2) - texture.along**2
    edges = np.abs(parts - np.roll(parts, 1, axis=1)).max(axis=(1, 2), initial=0.0)
    # A point for each cell; to rounding, a part of whole cells gets their centres. Powers of two make few groups.
    wanted = np.ceil(np.log2(np.maximum(edges * texture.along[which], 1.0)) - 1e-6)
    steps = np.minimum(2 ** wanted.astype(np.int64), MOST_STEPS)
    for step in np.unique(steps):
        u, v = cell_centres(int(step)).astype(np.float64).T
        points = np.stack([1.0 - u - v, u, v], axis=1)
        same = np.flatnonzero(steps == step)
        size = max(1, POINTS_AT_ONCE // len(points))
        for begin in range(0, len(same), size):
            some = same[begin : begin + size]
            at = np.einsum("pk,nkx->npx", points, parts[some, :, 1:])
            cell = first[which[some], None] + cell_at(texture.along[which[some], None], at[..., 0], at[..., 1])
            result[chosen[some]] = texture.colours[cell].mean(axis=1, dtype=np.float64)
    return result


def cell_at(along: Ints, u: Floats, v: Floats) -> Ints:
    """Number within its triangle of the cell at barycentric weights of corners 1 and 2."""
    inside = along * (1.0 - 1e-9)
    u, v = np.clip(u, 0.0, 1.0) * inside, np.clip(v, 0.0, 1.0) * inside
    i = np.minimum(u.astype(np.int64), along - 1)
    j = np.minimum(v.astype(np.int64), along - 1 - i)
    upside_down = (u - i + v - j > 1.0) & (i + j < along - 1)
    cell: Ints = i * (2 * along - i) + 2 * j + upside_down
    return cell


def corner_colours(
    means: Floats, texture: Texture, vertices: Ints, triangle: Ints, corners: Floats, areas: Floats
) -> Floats:
    """Colours at the corners of faces, (f, 3, 3), filtered to the size of the faces around each vertex.

    Of each face, a vertex shows the quarter nearest to it; of all faces of the same part there, the mean by area.

    Parameters
    ----------
    vertices : (f, 3) int
        Numbers of the corners.
    triangle : (f,) int
    corners : (f, 3, 3) float
        As of `mean_colours`.
    areas : (f,) float
    """
    result = np.repeat(means[triangle][:, None], 3, axis=1)
    part_of_triangle = np.full(len(means), -1, dtype=np.int64)
    part_of_triangle[texture.triangle] = texture.part
    chosen = np.flatnonzero(part_of_triangle[triangle] >= 0)
    if len(chosen) == 0:
        return result
    own = corners[chosen]
    quarters = (own[:, :, None, :] + own[:, None, :, :]) / 2.0
    colours = mean_colours(means, texture, np.repeat(triangle[chosen], 3), quarters.reshape(-1, 3, 3))
    key = (part_of_triangle[triangle[chosen]][:, None] << 40) | vertices[chosen]
    _, shared = np.unique(key.ravel(), return_inverse=True)
    weight = np.repeat(areas[chosen], 3)
    total = np.bincount(shared, weights=weight)
    for channel in range(3):
        mean = np.bincount(shared, weights=weight * colours[:, channel]) / np.maximum(total, np.finfo(np.float64).tiny)
        result[chosen, :, channel] = mean[shared].reshape(-1, 3)
    return result


def joined(textures: list[tuple[Texture | None, Ints]]) -> Texture | None:
    """One texture of several meshes' triangles, or None where none varies.

    Parameters
    ----------
    textures : list of (Texture or None, (m,) int)
        Of each mesh, and the triangles of it that are kept: these are numbered one mesh after the other.
    """
    found, first, parts = [], 0, 0
    for texture, kept in textures:
        if texture is not None and len(texture.triangle):
            of_triangle = np.full(max(int(texture.triangle.max()), int(kept.max(initial=0))) + 1, -1, dtype=np.int64)
            of_triangle[texture.triangle] = np.arange(len(texture.triangle))
            number = of_triangle[kept]
            row = np.flatnonzero(number >= 0)
            found.append(
                replace(_taken(texture, number[row]), triangle=first + row, part=parts + texture.part[number[row]])
            )
            parts += int(texture.part.max()) + 1
        first += len(kept)
    if not any(len(texture.triangle) for texture in found):
        return None
    triangle, part, along, colours = (
        np.concatenate([getattr(texture, name) for texture in found])
        for name in ("triangle", "part", "along", "colours")
    )
    return Texture(triangle, part, along, colours)


def _taken(texture: Texture, which: Ints) -> Texture:
    """Some of the triangles of a texture."""
    count = texture.along**2
    first = np.cumsum(count) - count
    end = np.cumsum(count[which])
    cells = np.arange(int(end[-1]) if len(end) else 0) + np.repeat(first[which] - (end - count[which]), count[which])
    return Texture(texture.triangle[which], texture.part[which], texture.along[which], texture.colours[cells])


# ------------------------------------------------------------------------------------------------------------ images


@dataclass(frozen=True, eq=False)
class Image:
    """An image, and smaller ones of it, each averaged over two by two pixels of the one before.

    Attributes
    ----------
    levels : tuple of (h, w, c) float32
        The first has all pixels; the last has one. Row 0 is the lowest, as in texture coordinates.
    extension : str
        What lies outside of 0 to 1: `'REPEAT'`, `'MIRROR'`, `'EXTEND'` (the border goes on) or `'CLIP'` (nothing).
    closest : bool
        Whether a pixel has one colour, in place of passing over into the next.
    """

    levels: tuple[Singles, ...]
    extension: str = "REPEAT"
    closest: bool = False


def image_of(pixels: Singles, extension: str = "REPEAT", closest: bool = False) -> Image:
    """The image of pixels (h, w, c)."""
    levels = [np.ascontiguousarray(pixels, dtype=np.float32)]
    while max(levels[-1].shape[:2]) > 1:
        levels.append(halved(levels[-1]))
    return Image(tuple(levels), extension, closest)


def halved(pixels: Singles) -> Singles:
    """An image of half the width and height, rounded up, each pixel the mean over what it covers, (h, w, c) float32."""
    for axis in (0, 1):
        size = pixels.shape[axis]
        if size > 1 and size % 2 == 0:
            even, odd = (np.take(pixels, np.arange(k, size, 2), axis=axis) for k in (0, 1))
            pixels = (even + odd) / np.float32(2.0)
        elif size > 1:
            pixels = _resampled(pixels, axis, (size + 1) // 2)
    return pixels


def _resampled(pixels: Singles, axis: int, count: int) -> Singles:
    """Means over `count` even parts of one axis, whose borders may cut pixels."""
    size = pixels.shape[axis]
    sums = np.cumsum(np.moveaxis(pixels, axis, 0), axis=0, dtype=np.float64)
    sums = np.concatenate([np.zeros((1, *sums.shape[1:])), sums])
    border = np.arange(count + 1) * (size / count)
    low = np.minimum(border.astype(np.int64), size - 1)
    share = (border - low).reshape(-1, *[1] * (sums.ndim - 1))
    at = sums[low] * (1.0 - share) + sums[low + 1] * share
    result: Singles = np.moveaxis(np.diff(at, axis=0) * (count / size), 0, axis).astype(np.float32)
    return result


def sampled(image: Image, uv: Floats, footprint: Floats) -> Floats:
    """Colours of an image about places, averaged over about `footprint` pixels, (n, c).

    Parameters
    ----------
    uv : (n, 2) float
        0 to 1 over the image.
    footprint : (n,) float
        Width of what is averaged over, in pixels of the whole image.
    """
    level = np.clip(np.log2(np.maximum(footprint, 1.0)), 0.0, len(image.levels) - 1)
    low = np.floor(level).astype(np.int64)
    result = np.zeros((len(uv), image.levels[0].shape[2]))
    for k in np.unique(low):
        row = np.flatnonzero(low == k)
        share = (level[row] - k)[:, None]
        finer = _bilinear(image.levels[k], image.extension, uv[row], image.closest and k == 0)
        if share.any():
            finer = finer * (1.0 - share) + share * _bilinear(image.levels[k + 1], image.extension, uv[row])
        result[row] = finer
    return result


def _bilinear(pixels: Singles, extension: str, uv: Floats, closest: bool = False) -> Floats:
    height, width = pixels.shape[:2]
    x, y = uv[:, 0] * width - 0.5, uv[:, 1] * height - 0.5
    i, j = np.floor(x), np.floor(y)
    s, t = (x - i)[:, None], (y - j)[:, None]
    if closest:
        s, t = np.round(s), np.round(t)
    result: Floats = np.zeros((len(uv), pixels.shape[2]))
    for right, above, weight in ((0, 0, (1 - s) * (1 - t)), (1, 0, s * (1 - t)), (0, 1, (1 - s) * t), (1, 1, s * t)):
        column, inside = _within(i + right, width, extension)
        line, beside = _within(j + above, height, extension)
        result += weight * (inside & beside)[:, None] * pixels[line, column]
    return result


def _within(index: Floats, size: int, extension: str) -> tuple[Ints, NDArray[np.bool_]]:
    """The pixel along one axis that stands for any index, and whether there is one."""
    there = np.ones(len(index), dtype=bool)
    if extension == "REPEAT":
        index = np.mod(index, size)
    elif extension == "MIRROR":
        index = np.mod(index, 2 * size)
        index = np.minimum(index, 2 * size - 1 - index)
    elif extension == "CLIP":
        there = (index >= 0) & (index < size)
    return np.clip(index, 0, size - 1).astype(np.int64), there
