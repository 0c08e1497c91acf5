# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""One mesh of Blender as arrays, and as it stands in the world."""

from dataclasses import dataclass, replace
from hashlib import blake2b
from typing import Any

import bpy
import numpy as np
from numpy.typing import NDArray

from ..core.scene import Floats, Ints

_LEAST_DETERMINANT = 1e-12
"""Below this share of the product of its axes' lengths a matrix has no inverse worth having."""


@dataclass(frozen=True, eq=False)
class LocalMesh:
    """A mesh in its own space, cut into triangles.

    Attributes
    ----------
    vertices : (v, 3) float, local units
    triangles, corners : (t, 3) int
        Vertices and face corners of the mesh ("loops") at the corners of each triangle.
    normals : (t, 3, 3) float, unit
        Shading normals at the corners of each triangle, in single precision as Blender has them; of a triangle that
        Cycles renders flat its own, which differs from its face's where that is not planar.
    slots : (t,) int
        Material index of each triangle.
    vertex_of_corner : (c,) int
    materials : tuple of Material or None
        Those of the mesh itself, which an object's slots may override.
    """

    vertices: Floats
    triangles: Ints
    corners: Ints
    normals: Floats
    slots: Ints
    vertex_of_corner: Ints
    materials: tuple[Any, ...]


def local_mesh(mesh: bpy.types.Mesh) -> LocalMesh:
    """Return the arrays of a mesh with faces."""
    mesh.calc_loop_triangles()
    count = len(mesh.loop_triangles)
    triangles = np.empty((count, 3), dtype=np.int32)
    corners = np.empty((count, 3), dtype=np.int32)
    slots = np.empty(count, dtype=np.int32)
    vertices = np.empty((len(mesh.vertices), 3), dtype=np.float32)
    normals = np.empty((len(mesh.loops), 3), dtype=np.float32)
    vertex_of_corner = np.empty(len(mesh.loops), dtype=np.int32)
    mesh.loop_triangles.foreach_get("vertices", triangles.reshape(-1))
    mesh.loop_triangles.foreach_get("loops", corners.reshape(-1))
    mesh.loop_triangles.foreach_get("material_index", slots)
    mesh.vertices.foreach_get("co", vertices.reshape(-1))
    mesh.corner_normals.foreach_get("vector", normals.reshape(-1))
    mesh.loops.foreach_get("vertex_index", vertex_of_corner)
    normals = normals[corners]
    flat = np.flatnonzero(_rendered_flat(mesh))
    normals[flat] = _own_normals(vertices[triangles[flat]])[:, None]
    return LocalMesh(
        vertices=vertices.astype(np.float64),
        triangles=triangles.astype(np.int64),
        corners=corners.astype(np.int64),
        normals=normals,
        slots=slots.astype(np.int64),
        vertex_of_corner=vertex_of_corner.astype(np.int64),
        materials=tuple(mesh.materials),
    )


def _rendered_flat(mesh: bpy.types.Mesh) -> NDArray[np.bool_]:
    """Return (t,) bool whether Cycles shades each triangle by its own normal.

    It does so for faces that are flat, but takes the normals of corners, all over the mesh, where some are custom or
    where edges are sharp between faces of which some are smooth.
    """
    count = len(mesh.loop_triangles)
    if mesh.normals_domain == "FACE":
        return np.ones(count, dtype=bool)
    sharp = mesh.attributes.get("sharp_face")
    if sharp is None or mesh.has_custom_normals or _has_sharp_edges(mesh):
        return np.zeros(count, dtype=bool)
    flat_face = np.empty(len(mesh.polygons), dtype=bool)
    sharp.data.foreach_get("value", flat_face)
    face_of_triangle = np.empty(count, dtype=np.int32)
    mesh.loop_triangles.foreach_get("polygon_index", face_of_triangle)
    return flat_face[face_of_triangle]


def _has_sharp_edges(mesh: bpy.types.Mesh) -> bool:
    sharp = mesh.attributes.get("sharp_edge")
    if sharp is None:
        return False
    values = np.empty(len(mesh.edges), dtype=bool)
    sharp.data.foreach_get("value", values)
    return bool(values.any())


def _own_normals(corners: Floats) -> Floats:
    """Return the unit normals of triangles (t, 3, 3), zero where they have no area."""
    a, b, c = corners.astype(np.float64).transpose(1, 0, 2)
    normals = np.cross(b - a, c - a)
    length = np.linalg.norm(normals, axis=1, keepdims=True)
    return np.divide(normals, length, out=np.zeros_like(normals), where=length > 0.0)


def fingerprint(data: bpy.types.ID | None) -> bytes:
    """Return a digest of what gives an object its shape: vertices and faces, points of curves, letters, balls."""
    if isinstance(data, bpy.types.Mesh):
        shape = [
            _read(data.vertices, "co", 3, np.float32),
            _read(data.loops, "vertex_index", 1, np.int32),
            _read(data.polygons, "loop_start", 1, np.int32),
        ]
    elif isinstance(data, bpy.types.Curve):
        shape = [_read(spline.points, "co", 4, np.float32) for spline in data.splines]
        shape += [_read(spline.bezier_points, "co", 3, np.float32) for spline in data.splines]
        shape.append(getattr(data, "body", "").encode())
    elif isinstance(data, bpy.types.MetaBall):
        shape = [_read(data.elements, "co", 3, np.float32), _read(data.elements, "radius", 1, np.float32)]
    else:
        shape = []
    return blake2b(b"|".join(shape)).digest()


def _read(elements: Any, name: str, size: int, kind: Any) -> bytes:
    values = np.empty(size * len(elements), dtype=kind)
    elements.foreach_get(name, values)
    return values.tobytes()


def inverse_of(matrix: Floats) -> Floats | None:
    """Return the inverse of a transform, or None when it flattens what it places."""
    linear = matrix[:3, :3]
    lengths = np.linalg.norm(linear, axis=0)
    if not abs(np.linalg.det(linear)) > _LEAST_DETERMINANT * np.prod(lengths):
        return None
    return np.linalg.inv(matrix)


def turned_over(local: LocalMesh) -> LocalMesh:
    """Return the mesh with its triangles wound the other way."""
    other_way = [0, 2, 1]
    return replace(
        local,
        triangles=local.triangles[:, other_way],
        corners=local.corners[:, other_way],
        normals=local.normals[:, other_way],
    )


def placed(local: LocalMesh, matrix: Floats) -> tuple[Floats, Floats]:
    """Return world vertices (v, 3) and unit corner normals (t, 3, 3), in float64.

    The inverse transpose is the cofactor matrix up to a positive factor (and the sign of the determinant), and the
    cofactors exist for a matrix that flattens the mesh, too.
    """
    linear = matrix[:3, :3]
    vertices = local.vertices @ linear.T + matrix[:3, 3]
    cofactors = np.stack([np.cross(linear[(k + 1) % 3], linear[(k + 2) % 3]) for k in range(3)])
    if np.linalg.det(linear) < 0.0:
        cofactors = -cofactors
    normals = local.normals @ cofactors.T
    length = np.linalg.norm(normals, axis=-1, keepdims=True)
    return vertices, np.divide(normals, length, out=np.zeros_like(normals), where=length > 0.0)
