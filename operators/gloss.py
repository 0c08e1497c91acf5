# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""How much light the gloss of a shader sends on, in the mean over light from all sides.

Gloss looks different from everywhere, so no colour of a vertex shows it. But the light goes on, and a room of materials
as Blender makes them is brighter for it by some percent: it counts as sent evenly to all sides.
"""

from functools import lru_cache

import numpy as np

from ..core.scene import Floats
from ..core.transmittance import fresnel

_DIRECTIONS, _FACETS = 16, 32
"""Places of Gauss and Legendre for the angle of the light, and steps along both axes of the facets that it meets: 1e-3
of the share off at a roughness of 0.5."""

_SMOOTH = 0.01
"""Roughness below which gloss mirrors as much as a mirror."""


@lru_cache(maxsize=256)
def mean_gloss(roughness: float, index: float) -> float:
    """Return the share that a clear layer of an index of refraction mirrors.

    Facets as of Walter et al. 2007, those that are seen drawn as by Heitz 2018, and Fresnel's formula on each.
    """
    if index <= 1.0:
        return 0.0
    alpha = max(roughness, _SMOOTH) ** 2
    place, weight = np.polynomial.legendre.leggauss(_DIRECTIONS)
    cosine = 0.5 + 0.5 * place
    shares = [_mirrored(float(mu), alpha, index) for mu in cosine]
    return float(weight @ (cosine * shares))


def mean_sheen(roughness: float) -> float:
    """Return the share that sheen reflects: 0.11 at a roughness of 0.5, 0.44 at 1, as Cycles renders balls of it."""
    return 0.44 * min(max(roughness, 0.0), 1.0) ** 2


def index_at_level(index: float, level: float) -> float:
    """Return the index of refraction that a Principled BSDF takes, whose Specular IOR Level scales what it mirrors."""
    head_on = min(max(2.0 * level, 0.0) * ((index - 1.0) / (index + 1.0)) ** 2, 0.99)
    return (1.0 + np.sqrt(head_on)) / (1.0 - np.sqrt(head_on))


def _mirrored(cosine: float, alpha: float, index: float) -> float:
    """Share of light that comes in at an angle."""
    view = np.array([np.sqrt(max(1.0 - cosine * cosine, 0.0)), 0.0, cosine])
    facets = _seen_facets(view, alpha)
    along = np.clip(facets @ view, 0.0, 1.0)
    out = 2.0 * along * facets[:, 2] - cosine
    leaves = out > 0.0
    hidden = _shadowing(cosine, alpha)
    seen = (1.0 + hidden) / (1.0 + hidden + _shadowing(np.where(leaves, out, 1.0), alpha))
    mirrored = fresnel(along.astype(np.float32), np.full(len(along), index, dtype=np.float32))
    return float(np.mean(np.where(leaves, seen * mirrored, 0.0)))


def _seen_facets(view: Floats, alpha: float) -> Floats:
    """Normals of facets (n, 3), as many of each as are seen from a direction of no azimuth."""
    step = (np.arange(_FACETS) + 0.5) / _FACETS
    first, second = (axis.ravel() for axis in np.meshgrid(step, step))
    stretched = view * [alpha, 1.0, 1.0]
    stretched = stretched / np.linalg.norm(stretched)
    across, up = np.array([0.0, 1.0, 0.0]), np.array([-stretched[2], 0.0, stretched[0]])
    radius, angle = np.sqrt(first), 2.0 * np.pi * second
    a, b = radius * np.cos(angle), radius * np.sin(angle)
    share = 0.5 * (1.0 + stretched[2])
    b = (1.0 - share) * np.sqrt(np.maximum(1.0 - a * a, 0.0)) + share * b
    rest = np.sqrt(np.maximum(1.0 - a * a - b * b, 0.0))
    normal = a[:, None] * across + b[:, None] * up + rest[:, None] * stretched
    normal = normal * [alpha, alpha, 1.0]
    result: Floats = normal / np.linalg.norm(normal, axis=1, keepdims=True)
    return result


def _shadowing(cosine, alpha: float):
    """Smith's auxiliary function of GGX."""
    square = np.square(cosine)
    return 0.5 * (np.sqrt(1.0 + alpha * alpha * (1.0 - square) / np.maximum(square, 1e-12)) - 1.0)
