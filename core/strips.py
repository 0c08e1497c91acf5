# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Pieces of surfaces between hard edges and how wide they are: the sides of a table's leg, frames, thin boards.

On a strip as wide as one face no neighbour tells how light changes along it, so the light cannot ask for more vertices.
"""

from __future__ import annotations

import numpy as np

from .geometry import connected_components, lengths
from .scene import Floats, Ints
from .surfaces import Surfaces

ROUND = 0.6
"""Cosine between the normals of triangles above which a surface goes on across their edge, flat or round."""


def extents(surfaces: Surfaces, triangle: Ints) -> tuple[Floats, Floats]:
    """Width and length of the piece that each triangle is part of, were it a long strip.

    They are twice its area over its outline, and half of that.

    Parameters
    ----------
    triangle : (n,) int, ascending
        With all others of their pieces.

    Returns
    -------
    width, length : (n,) float, scene units
    """
    count = len(triangle)
    if count == 0:
        return np.zeros(0), np.zeros(0)
    places = surfaces.place_of_point[surfaces.triangles[triangle]]
    start, end = places.ravel(), np.roll(places, -1, axis=1).ravel()
    key = np.minimum(start, end) * np.int64(len(surfaces.points)) + np.maximum(start, end)
    length = lengths(surfaces.points[end] - surfaces.points[start])
    order = np.argsort(key, kind="stable")
    same = np.flatnonzero(key[order][1:] == key[order][:-1])
    first, second = order[same], order[same + 1]
    normals = surfaces.normals[triangle]
    on = np.einsum("px,px->p", normals[first // 3], normals[second // 3]) > ROUND
    first, second = first[on], second[on]
    piece = connected_components(np.stack([first // 3, second // 3], axis=1), count)
    inner = np.zeros(3 * count, dtype=bool)
    inner[first] = inner[second] = True
    outline = np.bincount(np.repeat(piece, 3), weights=np.where(inner, 0.0, length), minlength=count)
    area = np.bincount(piece, weights=surfaces.areas[triangle], minlength=count)
    # A ball has no outline, and is as wide as can be.
    width: Floats = np.divide(2.0 * area, outline, out=np.full(count, np.inf), where=outline > 0.0)
    return width[piece], outline[piece] / 2.0
