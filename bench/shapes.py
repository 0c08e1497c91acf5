# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Shapes and colours that `bench/varied_scenes.py` is put together of, beside those of `bench/scenes.py`."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
from numpy.typing import ArrayLike
from radiosity_bake.core.scene import Floats, Scene, SurfaceMesh, surface_mesh

from tests.scenes import exact

from .scenes import COOL, LAMP, WARM, WHITE, Ints, ball, smooth, vertex_normals

RED, GREEN, BLUE = (0.75, 0.08, 0.06), (0.1, 0.6, 0.12), (0.08, 0.15, 0.7)
DARK, BRIGHT = (0.1, 0.1, 0.1), (0.9, 0.9, 0.9)
WOOD = (0.45, 0.28, 0.15)
WALLS = (WOOD, WHITE, WARM, WHITE, COOL, WHITE)


def turned(mesh: SurfaceMesh, axis: str, degrees: float, about: ArrayLike) -> SurfaceMesh:
    """Return a mesh turned about an axis through a point.

    Parameters
    ----------
    axis : str
        `'x'`, `'y'` or `'z'`.
    about : (3,) array_like, m
    """
    c, s = math.cos(math.radians(degrees)), math.sin(math.radians(degrees))
    rows = {"x": [[1, 0, 0], [0, c, -s], [0, s, c]], "y": [[c, 0, s], [0, 1, 0], [-s, 0, c]]}
    matrix = np.array(rows.get(axis, [[c, -s, 0], [s, c, 0], [0, 0, 1]]), dtype=np.float64)
    point = np.asarray(about, dtype=np.float64)
    return replace(
        mesh, vertices=(mesh.vertices - point) @ matrix.T + point, corner_normals=mesh.corner_normals @ matrix.T
    )


def scaled(scene: Scene, factor: float) -> Scene:
    """Return the scene in another size; radiances stay."""
    return replace(scene, meshes=tuple(replace(m, vertices=factor * m.vertices) for m in scene.meshes))


def prism(name: str, outline: list[tuple[float, float]], depth: float, reflectance: ArrayLike) -> SurfaceMesh:
    """Return a closed solid of one convex outline in x and z, counterclockwise seen from -y, drawn out along y."""
    n = len(outline)
    ring = np.array([(x, 0.0, z) for x, z in outline])
    vertices = np.concatenate([ring, ring + np.array([0.0, depth, 0.0])])
    i = np.arange(n)
    j = (i + 1) % n
    fan = np.stack([np.zeros(n - 2, int), i[1:-1], i[2:]], axis=1)
    side = np.stack([i, j + n, j, i, i + n, j + n], axis=1).reshape(-1, 3)
    triangles = np.concatenate([fan, fan[:, ::-1] + n, side])
    return surface_mesh(name, vertices, triangles, reflectance=exact.rgb(reflectance))


def inside_out(mesh: SurfaceMesh) -> SurfaceMesh:
    """Return a mesh seen from its other side."""
    return replace(mesh, triangles=mesh.triangles[:, ::-1], corner_normals=-mesh.corner_normals[:, ::-1])


def pipe(
    name: str, base: ArrayLike, radii: tuple[float, float], height: float, segments: int, reflectance: ArrayLike
) -> SurfaceMesh:
    """Return the side of an upright cylinder or cone, one sheet without ends, smooth-shaded, its front outward."""
    angle = 2.0 * np.pi * np.arange(segments) / segments
    ring = np.stack([np.cos(angle), np.sin(angle), np.zeros(segments)], axis=1)
    low = np.asarray(base, dtype=np.float64)
    vertices = np.concatenate([low + radii[0] * ring, low + radii[1] * ring + np.array([0.0, 0.0, height])])
    i = np.arange(segments)
    j = (i + 1) % segments
    triangles = np.stack([i, j, j + segments, i, j + segments, i + segments], axis=1).reshape(-1, 3)
    slope = np.array([0.0, 0.0, (radii[0] - radii[1]) / height])
    normals = np.tile(ring + slope, (2, 1))
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    return smooth(name, vertices, triangles, normals, reflectance)


def torus(
    name: str, centre: ArrayLike, radii: tuple[float, float], cells: tuple[int, int], reflectance: ArrayLike
) -> SurfaceMesh:
    """Return a smooth-shaded ring lying flat."""
    around, across = cells
    a, b = np.meshgrid(2 * np.pi * np.arange(around) / around, 2 * np.pi * np.arange(across) / across, indexing="ij")
    normal = np.stack([np.cos(a) * np.cos(b), np.sin(a) * np.cos(b), np.sin(b)], axis=2).reshape(-1, 3)
    middle = radii[0] * np.stack([np.cos(a), np.sin(a), np.zeros_like(a)], axis=2).reshape(-1, 3)
    i, k = (x.ravel() for x in np.meshgrid(np.arange(around), np.arange(across), indexing="ij"))
    j, m = (i + 1) % around, (k + 1) % across
    p, q, r, s = i * across + k, j * across + k, j * across + m, i * across + m
    triangles = np.stack([p, q, r, p, r, s], axis=1).reshape(-1, 3)
    return smooth(name, np.asarray(centre) + middle + radii[1] * normal, triangles, normal, reflectance)


def lumpy_ball(
    name: str, centre: ArrayLike, radius: float, lumps: float, levels: int, reflectance: ArrayLike, seed: int = 0
) -> SurfaceMesh:
    """Return a closed smooth-shaded body: a sphere whose radius a few waves change by the share `lumps`."""
    unit, triangles = exact.icosphere(levels)
    rng = np.random.default_rng(seed)
    waves = 3.0 * rng.normal(size=(5, 3))
    height = np.cos(unit @ waves.T + 2.0 * np.pi * rng.random(5)).mean(axis=1)
    vertices = radius * unit * (1.0 + lumps * height)[:, None]
    return smooth(name, np.asarray(centre) + vertices, triangles, vertex_normals(vertices, triangles), reflectance)


def globe(name: str, centre: ArrayLike, radius: float, power: float = 1.0, levels: int = 2) -> SurfaceMesh:
    """Return a lamp: a ball that glows."""
    return ball(name, centre, radius, levels=levels, reflectance=0.0, emission=power * np.array(LAMP))


def chequered_sheet(name: str, corner: ArrayLike, u: ArrayLike, v: ArrayLike, cells: int) -> SurfaceMesh:
    """Return a parallelogram of cells x cells squares, dark and bright by turns."""
    o, a, b = (np.asarray(x, dtype=np.float64) for x in (corner, u, v))
    i, j = np.meshgrid(np.arange(cells + 1), np.arange(cells + 1), indexing="ij")
    vertices = o + (i.reshape(-1, 1) * a + j.reshape(-1, 1) * b) / cells
    i, j = (x.ravel() for x in np.meshgrid(np.arange(cells), np.arange(cells), indexing="ij"))
    p = i * (cells + 1) + j
    q = p + cells + 1
    triangles: Ints = np.stack([p, q, q + 1, p, q + 1, p + 1], axis=1).reshape(-1, 3)
    shade: Floats = np.where(np.repeat((i + j) % 2, 2)[:, None] == 0, np.array(DARK), np.array(BRIGHT))
    return surface_mesh(name, vertices, triangles, reflectance=shade)
