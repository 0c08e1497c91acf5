# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""What the tests of core share: scenes made traceable, small rooms, and geometry checked by brute force."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace

import numpy as np
from numpy.typing import ArrayLike, NDArray
from radiosity_bake.core.coarse_patches import clustered_patches, coarse_patches
from radiosity_bake.core.patches import PatchTree
from radiosity_bake.core.reachability import lit_sides
from radiosity_bake.core.result import BakedMesh
from radiosity_bake.core.scene import Scene, SurfaceMesh, surface_mesh
from radiosity_bake.core.surfaces import join
from radiosity_bake.core.transport import Transport
from radiosity_bake.core.visibility import RayScene

from tests.scenes import exact
from tools import rooms

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

DARK = np.zeros(3)

CUBE_QUADS = ((0, 2, 3, 1), (4, 5, 7, 6), (0, 4, 6, 2), (1, 3, 7, 5), (0, 1, 5, 4), (2, 6, 7, 3))


# ------------------------------------------------------------------------------------------------------------ scenes


def block(
    name: str,
    low: ArrayLike,
    high: ArrayLike,
    *,
    reflectance: ArrayLike = 0.5,
    emission: ArrayLike = 0.0,
    turned: float = 0.0,
    bottom: bool = True,
) -> SurfaceMesh:
    """Return a box with its front outward, turned about its own vertical axis by degrees, with or without a bottom."""
    low, high = np.asarray(low, dtype=np.float64), np.asarray(high, dtype=np.float64)
    corners = np.array([(i, j, k) for k in (0, 1) for j in (0, 1) for i in (0, 1)])
    vertices = low + corners * (high - low)
    angle = np.radians(turned)
    turn = np.array([[np.cos(angle), -np.sin(angle), 0], [np.sin(angle), np.cos(angle), 0], [0, 0, 1]])
    middle = (low + high) / 2
    quads = CUBE_QUADS if bottom else CUBE_QUADS[1:]
    triangles = [t for a, b, c, d in quads for t in ((a, b, c), (a, c, d))]
    return surface_mesh(
        name, (vertices - middle) @ turn.T + middle, triangles, reflectance=exact.rgb(reflectance), emission=emission
    )


def flipped(mesh: SurfaceMesh) -> SurfaceMesh:
    """Return a mesh with its front and back exchanged."""
    return surface_mesh(
        mesh.name,
        mesh.vertices,
        mesh.triangles[:, ::-1],
        reflectance=mesh.reflectance,
        emission=mesh.emission,
        baked=mesh.baked,
    )


def grid(name: str, cells: int, **options: object) -> SurfaceMesh:
    """Return the unit square in the plane z = 0, its front up, as cells x cells squares of two triangles."""
    side = np.arange(cells + 1) / cells
    vertices = [(x, y, 0.0) for y in side for x in side]
    row = cells + 1
    triangles = []
    for j in range(cells):
        for i in range(cells):
            a = j * row + i
            triangles += [(a, a + 1, a + row + 1), (a, a + row + 1, a + row)]
    return surface_mesh(name, vertices, triangles, **options)


def dense(scene: Scene, times: int) -> Scene:
    """Return the scene with each triangle cut into four, so many times over; nothing that is seen changes."""
    meshes = []
    for mesh in scene.meshes:
        surfaces = join(Scene((replace(mesh, baked=True),), scene.world))
        tree = PatchTree(surfaces)
        for _ in range(times):
            tree.split(tree.leaves())
        leaves = tree.leaves()
        parent = surfaces.input_triangle[tree.triangle[leaves]]
        meshes.append(
            surface_mesh(
                mesh.name,
                tree.points,
                tree.corners[leaves],
                corner_normals=tree.weights[leaves] @ mesh.corner_normals[parent],
                reflectance=mesh.reflectance[parent],
                emission=mesh.emission[parent],
                baked=mesh.baked,
            )
        )
    return Scene(tuple(meshes), scene.world)


def room_with_block(reflectance: float = 0.5, **options: object) -> Scene:
    """Return a room of 2 x 2 x 2 with a lamp a little below the ceiling and, turned on the floor, a block."""
    lamp = exact.rectangle("lamp", (0.7, 0.7, 1.95), (0, 0.6, 0), (0.6, 0, 0), emission=(5.0, 4.0, 3.0))
    walls = exact.box_walls((2, 2, 2), reflectance=reflectance)
    return Scene((*walls, lamp, block("block", (0.5, 0.6, 0.0), (1.1, 1.2, 0.8), turned=25.0, **options)), DARK)


def cornell_box() -> Scene:
    """Return the Cornell box with its lamp set into the ceiling, polygons cut into fans."""
    meshes = []
    for s in rooms.cornell_box():
        triangles = [(f[0], f[k], f[k + 1]) for f in s.faces for k in range(1, len(f) - 1)]
        meshes.append(surface_mesh(s.name, s.vertices, triangles, reflectance=s.reflectance, emission=s.emission))
    return Scene(tuple(meshes), DARK)


def moved(scene: Scene, scale: float = 1.0, by: ArrayLike = (0.0, 0.0, 0.0)) -> Scene:
    """Return the scene scaled about the origin, then moved."""
    return Scene(
        tuple(
            SurfaceMesh(
                m.name,
                m.vertices * scale + np.asarray(by),
                m.triangles,
                m.corner_normals,
                m.reflectance,
                m.emission,
                m.baked,
            )
            for m in scene.meshes
        ),
        scene.world,
    )


# ----------------------------------------------------------------------------------------------------------- tracing


def transport_of(
    scene: Scene, *, smallest: float = 1e9, rays: int = 128, seed: int = 0, clustered: bool = False
) -> Transport:
    """Return the coarse patches of a scene ready to be traced; the default size leaves the triangles as they are."""
    surfaces = join(scene)
    tree = clustered_patches(surfaces, smallest) if clustered else coarse_patches(surfaces, smallest)
    ray_scene = RayScene(surfaces.points, surfaces.triangles, 2)
    lit = lit_sides(surfaces, ray_scene, seed)
    return Transport(surfaces, tree, ray_scene, lit, rays, seed)


def fronts(tree: PatchTree) -> Ints:
    """Return the elements of all leaves' fronts."""
    return 2 * tree.leaves()


def node_triangles(tree: PatchTree, nodes: Ints) -> Floats:
    """Return corner positions of nodes, (m, 3, 3)."""
    return tree.points[tree.corners[nodes]]


def areas(triangles: Floats) -> Floats:
    """Return the areas of triangles given by corner positions, (m,)."""
    return 0.5 * np.linalg.norm(np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0]), axis=1)


def hits_by_row(transport: Transport) -> dict[int, NDArray[np.int32]]:
    """Return a copy of each element's hits."""
    return {int(e): row.copy() for table in transport.tables for e, row in zip(table.element, table.hits, strict=True)}


def factor_matrix(transport: Transport) -> tuple[Floats, Floats]:
    """Return form factors between all elements and their standard errors, both dense (2 n, 2 n)."""
    shares, size = transport.shares(), 2 * len(transport.tree)
    factor, error = np.zeros((size, size)), np.zeros((size, size))
    inside = shares.source >= 0
    at = shares.receiver[inside], shares.source[inside]
    factor[at], error[at] = shares.share[inside], shares.standard_error()[inside]
    return factor, error


# ---------------------------------------------------------------------------------------------- geometry by brute force


def inside_weights(points: Floats, triangles: Floats) -> Floats:
    """Return barycentric coordinates of point i in triangle i, (m, 3), by least squares in its plane."""
    e1, e2, d = triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0], points - triangles[:, 0]
    g11, g12, g22, h1, h2 = (np.einsum("mx,mx->m", a, b) for a, b in ((e1, e1), (e1, e2), (e2, e2), (d, e1), (d, e2)))
    det = g11 * g22 - g12 * g12
    u, v = (h1 * g22 - h2 * g12) / det, (h2 * g11 - h1 * g12) / det
    return np.stack([1 - u - v, u, v], axis=1)


def t_junctions(points: Floats, triangles: Ints) -> int:
    """Count the pairs of a used vertex and an edge whose interior it lies in, by trying all."""
    extent = np.ptp(points[triangles.ravel()], axis=0).max()
    edges = np.unique(np.sort(triangles[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1), axis=0)
    used = points[np.unique(triangles)]
    found = 0
    step = max(1, 2_000_000 // len(used))
    for first in range(0, len(edges), step):
        a, b = points[edges[first : first + step]].transpose(1, 0, 2)
        along = b - a
        length = np.linalg.norm(along, axis=1)
        unit = along / length[:, None]
        # |p - a| and (p - a).u without an (e, v, 3) array.
        t = (unit @ used.T) - np.einsum("ex,ex->e", unit, a)[:, None]
        near = (t > 1e-7 * extent) & (t < length[:, None] - 1e-7 * extent)
        e, v = np.nonzero(near)
        distance = np.linalg.norm(used[v] - a[e] - t[e, v, None] * unit[e], axis=1)
        found += int((distance < 1e-9 * extent).sum())
    return found


def crosses(points: Floats, triangles: Ints) -> Floats:
    """Return normals times twice the area, (t, 3)."""
    a, b, c = (points[triangles[:, k]] for k in range(3))
    return np.cross(b - a, c - a)


def values_at(mesh: BakedMesh, parent: Ints, position: Floats, values: Floats) -> Floats:
    """Return corner values of a baked mesh interpolated at points of its input triangles, (n, 3), by trying all faces.

    Parameters
    ----------
    parent : (n,) int
        Input triangle of each point.
    position : (n, 3) float
    values : (s, 3, 3) float
    """
    corners = mesh.vertices[mesh.triangles]
    result = np.full((len(position), 3), np.nan)
    for triangle in np.unique(parent):
        own = np.flatnonzero(mesh.parent_triangle == triangle)
        for row in np.flatnonzero(parent == triangle):
            weights = inside_weights(np.broadcast_to(position[row], (len(own), 3)), corners[own])
            best = int(weights.min(axis=1).argmax())
            weight = np.maximum(weights[best], 0.0)
            result[row] = weight / weight.sum() @ values[own[best]]
    return result


def mesh_area(mesh: BakedMesh) -> Floats:
    """Return the area of each output triangle, (s,)."""
    return areas(mesh.vertices[mesh.triangles])


def mean_over(meshes: Iterable[BakedMesh], name: str = "irradiance") -> Floats:
    """Return the mean of an attribute over the area of meshes, (3,)."""
    meshes = list(meshes)
    area = np.concatenate([mesh_area(mesh) for mesh in meshes])
    value = np.concatenate([getattr(mesh, name).mean(axis=1) for mesh in meshes])
    return area @ value / area.sum()
