# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Points spread evenly over the baked surface: where every method is compared with the reference."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from radiosity_bake.core.scene import Floats, Ints, Scene, SurfaceMesh

# Fractional parts of the plastic number's powers (Roberts 2018, the R_2 sequence).
PLASTIC = np.array([0.7548776662466927, 0.5698402909980532])

# Triangles belong to one plane when their normals and offsets agree to this, relative to the mesh's extent.
PLANE_TOLERANCE = 1e-4


@dataclass(frozen=True, eq=False)
class Probes:
    """Points of the front side of baked meshes, emitters left out.

    Attributes
    ----------
    mesh : (n,) int
        Index into `Scene.meshes`.
    triangle : (n,) int
        Index into the mesh's input triangles.
    barycentric : (n, 3) float
    position : (n, 3) float, scene units
    normal : (n, 3) float, unit
        The triangle's.
    shading_normal : (n, 3) float, unit
        Interpolated from the corners'.
    area : float, scene units squared
        What all probes together stand for; each stands for `area / n`.
    """

    mesh: Ints
    triangle: Ints
    barycentric: Floats
    position: Floats
    normal: Floats
    shading_normal: Floats
    area: float

    def __len__(self) -> int:
        return len(self.mesh)


def triangle_areas(mesh: SurfaceMesh) -> Floats:
    """Return the area of each triangle: (t,) float."""
    a, b, c = (mesh.vertices[mesh.triangles[:, k]] for k in range(3))
    return 0.5 * np.linalg.norm(np.cross(b - a, c - a), axis=1)


def area_uniform_probes(scene: Scene, count: int, seed: int = 0) -> Probes:
    """Return `count` points, as many on each triangle as its share of the area wants, to within one.

    The triangles are laid end to end by area and cut at equal distances; within its triangle a point follows the R_2
    sequence. The same scene, count and seed give the same points.
    """
    meshes, triangles, areas = [], [], []
    for index, mesh in enumerate(scene.meshes):
        if not mesh.baked:
            continue
        keep = np.flatnonzero(~np.any(mesh.emission > 0.0, axis=1))
        meshes.append(np.full(len(keep), index))
        triangles.append(keep)
        areas.append(triangle_areas(mesh)[keep])
    mesh_of, triangle_of, area = (np.concatenate(x) for x in (meshes, triangles, areas))
    total = float(area.sum())
    cuts = (np.arange(count) + 0.5) * (total / count)
    chosen = np.minimum(np.searchsorted(np.cumsum(area), cuts), len(area) - 1)
    barycentric = _spread(count, seed)
    position, normal, shading = (np.empty((count, 3)) for _ in range(3))
    for index in np.unique(mesh_of):
        rows = np.flatnonzero(mesh_of[chosen] == index)
        p, n, s = surface_at(scene.meshes[index], triangle_of[chosen[rows]], barycentric[rows])
        position[rows], normal[rows], shading[rows] = p, n, s
    return Probes(mesh_of[chosen], triangle_of[chosen], barycentric, position, normal, shading, total)


def _spread(count: int, seed: int) -> Floats:
    """Return barycentric coordinates of the R_2 sequence, folded onto the triangle: (count, 3)."""
    shift = np.random.default_rng(seed).random(2)
    u, v = ((np.arange(1, count + 1)[:, None] * PLASTIC + shift) % 1.0).T
    outside = u + v > 1.0
    u, v = np.where(outside, 1.0 - u, u), np.where(outside, 1.0 - v, v)
    return np.stack([1.0 - u - v, u, v], axis=1)


def surface_at(mesh: SurfaceMesh, triangle: Ints, barycentric: Floats) -> tuple[Floats, Floats, Floats]:
    """Return position, geometric normal and shading normal at points of triangles: (n, 3) each."""
    corners = mesh.vertices[mesh.triangles[triangle]]
    position = np.einsum("nk,nkc->nc", barycentric, corners)
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normal /= np.linalg.norm(normal, axis=1, keepdims=True)
    shading = np.einsum("nk,nkc->nc", barycentric, mesh.corner_normals[triangle])
    length = np.linalg.norm(shading, axis=1, keepdims=True)
    shading = np.where(length > 1e-6, shading / np.maximum(length, 1e-6), normal)
    return position, normal, shading


def faces_of(mesh: SurfaceMesh) -> Ints:
    """Return which flat face each triangle belongs to: (t,) int, numbered by first appearance; -1 without area.

    A face is all triangles of the mesh in one plane: a wall, a side of a block.
    """
    a, b, c = (mesh.vertices[mesh.triangles[:, k]] for k in range(3))
    normal = np.cross(b - a, c - a)
    length = np.linalg.norm(normal, axis=1, keepdims=True)
    normal = np.divide(normal, length, out=np.zeros_like(normal), where=length > 0.0)
    low = mesh.vertices.min(axis=0)
    extent = float(np.ptp(mesh.vertices, axis=0).max()) or 1.0
    offset = np.einsum("ij,ij->i", normal, a - low) / extent
    planes = np.column_stack([normal, offset])
    face = np.full(len(planes), -1)
    found: list[NDArray[np.float64]] = []
    for t in np.flatnonzero(length[:, 0] > 0.0):
        if found:
            distance = np.abs(np.asarray(found) - planes[t]).max(axis=1)
            nearest = int(distance.argmin())
            if distance[nearest] < PLANE_TOLERANCE:
                face[t] = nearest
                continue
        face[t] = len(found)
        found.append(planes[t])
        if len(found) > 64:
            return np.zeros(len(planes), dtype=np.int64)  # curved: one face
    return face
