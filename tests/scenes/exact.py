# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Scenes whose answer is known exactly: each function returns the scene and what a right program finds in it.

Every polygon is wound so that its front faces the space that is lit. Form factors are those of whole meshes, F[i, j]
from mesh i to mesh j; sums over triangles of a mesh are weighted by the area of the sending triangle.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray
from radiosity_bake.core.scene import Scene, SurfaceMesh, surface_mesh

Floats = NDArray[np.float64]
Case = tuple[Scene, dict[str, Any]]

BLACK = (0.0, 0.0, 0.0)
QUAD = ((0, 1, 2), (0, 2, 3))


def rgb(value: ArrayLike) -> Floats:
    """Return a colour from a grey level or three channels."""
    return np.array(np.broadcast_to(np.asarray(value, dtype=np.float64), 3))


def rectangle(
    name: str, corner: ArrayLike, u: ArrayLike, v: ArrayLike, *, reflectance: ArrayLike = 0.0, emission: ArrayLike = 0.0
) -> SurfaceMesh:
    """Return a parallelogram of two triangles whose front looks along u x v.

    Parameters
    ----------
    corner, u, v : (3,) array_like, scene units
    """
    c, a, b = (np.asarray(x, dtype=np.float64) for x in (corner, u, v))
    return surface_mesh(name, [c, c + a, c + a + b, c + b], QUAD, reflectance=rgb(reflectance), emission=rgb(emission))


def box_walls(
    size: ArrayLike, *, reflectance: ArrayLike = 0.0, emission: ArrayLike = 0.0, origin: ArrayLike = (0.0, 0.0, 0.0)
) -> tuple[SurfaceMesh, ...]:
    """Return the six walls of a closed box, one mesh each, fronts inward: floor, ceiling, -x, +x, -y, +y."""
    (x, y, z), o = np.diag(np.asarray(size, dtype=np.float64)), np.asarray(origin, dtype=np.float64)
    walls = (
        ("floor", o, x, y),
        ("ceiling", o + z, y, x),
        ("west", o, y, z),
        ("east", o + x, z, y),
        ("south", o, z, x),
        ("north", o + y, x, z),
    )
    return tuple(rectangle(n, c, u, v, reflectance=reflectance, emission=emission) for n, c, u, v in walls)


def closed_room(
    size: ArrayLike, *, reflectance: ArrayLike, emission: ArrayLike = 0.0, name: str = "room"
) -> SurfaceMesh:
    """Return the same box as one mesh of 12 triangles and 8 shared vertices, fronts inward."""
    x, y, z = np.asarray(size, dtype=np.float64)
    vertices = [(i * x, j * y, k * z) for k in (0, 1) for j in (0, 1) for i in (0, 1)]
    quads = ((0, 1, 3, 2), (4, 6, 7, 5), (0, 2, 6, 4), (1, 5, 7, 3), (0, 4, 5, 1), (2, 3, 7, 6))
    triangles = [t for a, b, c, d in quads for t in ((a, b, c), (a, c, d))]
    return surface_mesh(name, vertices, triangles, reflectance=rgb(reflectance), emission=rgb(emission))


def parallel_factor(width: float, height: float, distance: float) -> float:
    """Return the form factor of two aligned parallel rectangles (Howell's catalogue, C-11)."""
    x, y = width / distance, height / distance
    a, b = 1.0 + x * x, 1.0 + y * y
    total = 0.5 * math.log(a * b / (a + y * y))
    total += x * math.sqrt(b) * math.atan(x / math.sqrt(b)) + y * math.sqrt(a) * math.atan(y / math.sqrt(a))
    total -= x * math.atan(x) + y * math.atan(y)
    return 2.0 * total / (math.pi * x * y)


def perpendicular_factor(edge: float, depth: float, height: float) -> float:
    """Return the form factor from a floor (edge x depth) to a wall (edge x height) that share an edge (C-14)."""
    w, h = depth / edge, height / edge
    ww, hh = w * w, h * h
    s = ww + hh
    total = w * math.atan(1.0 / w) + h * math.atan(1.0 / h) - math.sqrt(s) * math.atan(1.0 / math.sqrt(s))
    total += 0.25 * (
        math.log((1.0 + ww) * (1.0 + hh) / (1.0 + s))
        + ww * math.log(ww * (1.0 + s) / ((1.0 + ww) * s))
        + hh * math.log(hh * (1.0 + s) / ((1.0 + hh) * s))
    )
    return total / (math.pi * w)


def rectangle_seen_from_below(points: ArrayLike, corner: ArrayLike, width: float, height: float) -> Floats:
    """Return the form factor from horizontal points facing up to a horizontal rectangle above them.

    The sum of four corner formulas
    phi = 1/(2 pi) [X/sqrt(1+X^2) atan(Y/sqrt(1+X^2)) + Y/sqrt(1+Y^2) atan(X/sqrt(1+Y^2))].

    Parameters
    ----------
    points : (n, 3) array_like, scene units
    corner : (3,) array_like
        The corner with least x and y.
    """
    p, c = np.asarray(points, dtype=np.float64), np.asarray(corner, dtype=np.float64)
    above = c[2] - p[:, 2]

    def quarter(dx: Floats, dy: Floats) -> Floats:
        x, y = dx / above, dy / above
        rx, ry = np.sqrt(1.0 + x * x), np.sqrt(1.0 + y * y)
        return (x / rx * np.arctan(y / rx) + y / ry * np.arctan(x / ry)) / (2.0 * math.pi)

    x0, y0 = c[0] - p[:, 0], c[1] - p[:, 1]
    x1, y1 = x0 + width, y0 + height
    return quarter(x1, y1) - quarter(x0, y1) - quarter(x1, y0) + quarter(x0, y0)


def furnace(reflectance: float = 0.5, emission: ArrayLike = 1.0, size: ArrayLike = (1.0, 1.0, 1.0)) -> Case:
    """A closed box whose every point emits and reflects alike: radiance E/(1 - rho) everywhere, whatever the shape."""
    level = rgb(emission) / (1.0 - reflectance)
    scene = Scene((closed_room(size, reflectance=reflectance, emission=emission),), np.zeros(3))
    return scene, {"radiosity": level, "irradiance": level}


def furnace_sphere(reflectance: float = 0.5, emission: ArrayLike = 1.0, levels: int = 2) -> Case:
    """The furnace in a sphere of triangles: a closed surface without walls in a plane."""
    vertices, triangles = icosphere(levels)
    mesh = surface_mesh("sphere", vertices, triangles[:, ::-1], reflectance=rgb(reflectance), emission=rgb(emission))
    level = rgb(emission) / (1.0 - reflectance)
    return Scene((mesh,), np.zeros(3)), {"radiosity": level, "irradiance": level}


def white_sky(reflectance: float = 0.5, radiance: ArrayLike = 1.0) -> Case:
    """A lone square under a constant world: irradiance/pi is the world's radiance on both sides."""
    square = rectangle("square", (0, 0, 0), (1, 0, 0), (0, 1, 0), reflectance=reflectance)
    sky = rgb(radiance)
    return Scene((square,), sky), {"irradiance": sky, "radiosity": reflectance * sky}


def aligned_squares(distance: float = 1.0, side: float = 1.0, scale: float = 1.0) -> Case:
    """Two squares face to face; at distance 1 the factor is 0.199825 at every `scale`."""
    a, d = side * scale, distance * scale
    lower = rectangle("lower", (0, 0, 0), (a, 0, 0), (0, a, 0))
    upper = rectangle("upper", (0, 0, d), (0, a, 0), (a, 0, 0), emission=1.0)
    return Scene((lower, upper), np.zeros(3)), {"form_factor": parallel_factor(side, side, distance)}


def perpendicular_squares(depth: float = 1.0, height: float = 1.0, scale: float = 1.0) -> Case:
    """A floor and a wall that share an edge of length 1; unit squares have the factor 0.200044 at every `scale`.

    The two meshes do not share vertices; `touching_squares` does.
    """
    e, d, h = scale, depth * scale, height * scale
    floor = rectangle("floor", (0, 0, 0), (d, 0, 0), (0, e, 0))
    wall = rectangle("wall", (0, 0, 0), (0, e, 0), (0, 0, h), emission=1.0)
    factor = perpendicular_factor(1.0, depth, height)
    return Scene((floor, wall), np.zeros(3)), {"form_factor": factor, "form_factor_back": factor * depth / height}


def touching_squares() -> Case:
    """The perpendicular squares as one mesh with a shared, hard edge: triangles 0-1 are the floor, 2-3 the wall."""
    vertices = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 1, 1), (0, 0, 1)]
    triangles = [(0, 1, 2), (0, 2, 3), (0, 3, 4), (0, 4, 5)]
    emission = [BLACK, BLACK, (1.0, 1.0, 1.0), (1.0, 1.0, 1.0)]
    mesh = surface_mesh("corner", vertices, triangles, emission=emission)
    return Scene((mesh,), np.zeros(3)), {"form_factor": perpendicular_factor(1.0, 1.0, 1.0)}


def blocked_squares() -> Case:
    """The aligned squares with a larger sheet between them: nothing gets through."""
    scene, _ = aligned_squares()
    sheet = rectangle("sheet", (-1, -1, 0.5), (3, 0, 0), (0, 3, 0))
    return Scene((*scene.meshes, sheet), np.zeros(3)), {"form_factor": 0.0, "irradiance": rgb(0.0)}


def box_factors(size: ArrayLike) -> Floats:
    """Return the (6, 6) form factors between the walls of `box_walls(size)`."""
    x, y, z = (float(s) for s in np.asarray(size, dtype=np.float64))
    normal_axis = (2, 2, 0, 0, 1, 1)
    extent = (x, y, z)
    factors = np.zeros((6, 6))
    for i, a in enumerate(normal_axis):
        for j, b in enumerate(normal_axis):
            if a == b and i != j:
                u, v = (extent[k] for k in range(3) if k != a)
                factors[i, j] = parallel_factor(u, v, extent[a])
            elif a != b:
                shared = extent[3 - a - b]
                factors[i, j] = perpendicular_factor(shared, extent[b], extent[a])
    return factors


def closed_box(size: ArrayLike = (1.0, 1.0, 1.0), reflectance: float = 0.0) -> Case:
    """Six walls of a box, a mesh each: every pair known (C-11, C-14), every row of fragments sums to 1."""
    meshes = box_walls(size, reflectance=reflectance, emission=1.0)
    return Scene(meshes, np.zeros(3)), {"form_factors": box_factors(size), "row_sum": 1.0}


def icosphere(levels: int, radius: float = 1.0) -> tuple[Floats, NDArray[np.int64]]:
    """Return an icosahedron split `levels` times by edge midpoints, corners on the sphere, fronts outward.

    Returns
    -------
    vertices : (10 * 4^levels + 2, 3) float
    triangles : (20 * 4^levels, 3) int
    """
    g = 0.5 * (1.0 + math.sqrt(5.0))
    short, long = np.tile([-1.0, 1.0], 6), np.repeat([g, -g, g, -g, g, -g], 2)
    vertices = np.zeros((12, 3))
    for k, (i, j) in enumerate(((0, 1), (1, 2), (2, 0))):
        vertices[4 * k : 4 * k + 4, i], vertices[4 * k : 4 * k + 4, j] = (a[4 * k : 4 * k + 4] for a in (short, long))
    corners = "0 11 5 0 5 1 0 1 7 0 7 10 0 10 11 1 5 9 5 11 4 11 10 2 10 7 6 7 1 8 "
    corners += "3 9 4 3 4 2 3 2 6 3 6 8 3 8 9 4 9 5 2 4 11 6 2 10 8 6 7 9 8 1"
    triangles = np.array(corners.split(), dtype=np.int64).reshape(-1, 3)
    for _ in range(levels):
        edges = np.sort(triangles[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1)
        unique, index = np.unique(edges, axis=0, return_inverse=True)
        middle = index.reshape(-1, 3) + len(vertices)
        vertices = np.concatenate([vertices, vertices[unique].mean(axis=1)])
        (a, b, c), (ab, bc, ca) = triangles.T, middle.T
        triangles = np.stack([a, ab, ca, b, bc, ab, c, ca, bc, ab, bc, ca], axis=1).reshape(-1, 3)
        vertices /= np.linalg.norm(vertices, axis=1, keepdims=True)
    return radius * vertices / np.linalg.norm(vertices, axis=1, keepdims=True), triangles


def sphere_interior(levels: int = 2, radius: float = 1.0) -> Case:
    """The inside of a sphere: F_ij = A_j / (4 pi R^2) for every pair of patches of the true sphere.

    Flat triangles come close where they are far apart: measured with the oracle, the exact factor of two triangles
    whose centres are more than R apart stays within `far_tolerance` of their area's share (7.3% at levels 1, 4.9% at
    levels 2); neighbours differ by up to half. For single pairs take `oracle.form_factor`; rows of flat triangles sum
    to 1 exactly.
    """
    vertices, triangles = icosphere(levels, radius)
    mesh = surface_mesh("sphere", vertices, triangles[:, ::-1], emission=rgb(1.0))
    a, b, c = (vertices[triangles[:, k]] for k in range(3))
    area = 0.5 * np.linalg.norm(np.cross(b - a, c - a), axis=1)
    share = area / area.sum()
    return Scene((mesh,), np.zeros(3)), {
        "form_factors": np.tile(share, (len(area), 1)),
        "far_tolerance": 0.075,
        "row_sum": 1.0,
    }


def concentric_spheres(reflectance: float = 0.5, emission: ArrayLike = 1.0, levels: int = 3) -> Case:
    """A glowing ball in the middle of a hollow one: both uniform by symmetry, and a 2 x 2 system gives the answer.

    The form factors are those of the triangulated spheres' areas, exact for any convex body in an enclosure; that the
    radiosity is uniform holds as the triangles grow small.
    """
    vertices, triangles = icosphere(levels)
    ball = surface_mesh("ball", 0.5 * vertices, triangles, reflectance=rgb(reflectance), emission=rgb(emission))
    shell = surface_mesh("shell", vertices, triangles[:, ::-1], reflectance=rgb(reflectance))
    factors = np.array([[0.0, 1.0], [0.25, 0.75]])
    system = np.eye(2) - reflectance * factors
    radiosity = np.linalg.solve(system, np.stack([rgb(emission), rgb(0.0)]))
    expected = {"form_factors": factors, "radiosity": radiosity, "irradiance": factors @ radiosity}
    return Scene((ball, shell), np.zeros(3)), expected


def lamp_over_floor(
    reflectance: float = 0.0, emission: ArrayLike = 1.0, lamp_reflectance: float = 0.0, height: float = 1.0
) -> Case:
    """A 0.5 x 0.3 lamp over a 2 x 2 floor, nothing else: the floor's direct light is known at every point.

    `irradiance_at(points)` gives irradiance/pi, exact while the lamp reflects nothing.
    """
    floor = rectangle("floor", (-1, -1, 0), (2, 0, 0), (0, 2, 0), reflectance=reflectance)
    corner, width, depth = (0.1, -0.2, height), 0.5, 0.3
    lamp = rectangle("lamp", corner, (0, depth, 0), (width, 0, 0), reflectance=lamp_reflectance, emission=emission)

    def irradiance_at(points: ArrayLike) -> Floats:
        return rectangle_seen_from_below(points, corner, width, depth)[:, None] * rgb(emission)

    return Scene((floor, lamp), np.zeros(3)), {"irradiance_at": irradiance_at}


def room_mean_irradiance(reflectance: float = 0.5, flux: float = 10_000.0, side: float = 4.0) -> Case:
    """CIE 171:2006 5.8's room: of one reflectance, the mean irradiance is Phi / (S (1 - rho)) wherever the light is.

    The light is a square of 1 x 1 in the middle of the ceiling, of the room's reflectance, so the enclosure is uniform.
    The lamp's back lies outside; it emits there too, which does not change the inside.

    The expected means are over the whole inner surface, area weighted, divided by pi like every irradiance here.
    """
    radiance = flux / math.pi
    ring = (0.0, 0.5 * (side - 1.0), 0.5 * (side + 1.0), side)
    meshes = list(box_walls((side, side, side), reflectance=reflectance))
    vertices = [(x, y, side) for y in ring for x in ring]
    cells = [(i, j) for j in range(3) for i in range(3)]
    lit = [cell == (1, 1) for cell in cells]
    triangles, emission = [], []
    for (i, j), emits in zip(cells, lit, strict=True):
        a, b, c, d = (4 * j + i, 4 * (j + 1) + i, 4 * (j + 1) + i + 1, 4 * j + i + 1)
        triangles += [(a, b, c), (a, c, d)]
        emission += [rgb(radiance if emits else 0.0)] * 2
    meshes[1] = surface_mesh("ceiling", vertices, triangles, reflectance=rgb(reflectance), emission=emission)
    area = 6.0 * side * side
    total = flux / (area * (1.0 - reflectance)) / math.pi
    expected = {"mean_irradiance": rgb(total), "mean_indirect": rgb(reflectance * total), "flux": flux, "area": area}
    return Scene(tuple(meshes), np.zeros(3)), expected


def wall_and_sky(distance: float = 1.0, height: float = 1.0, half_length: float = 8.0) -> Case:
    """A point of the ground before the middle of a black wall: the wall takes its form factor from the white sky.

    Two perpendicular corner formulas phi = 1/(2 pi) [atan(L/d) - d/r atan(L/r)], r^2 = d^2 + h^2; for an endless wall
    that is 1/2 (1 - 1/sqrt(1 + k^2)) with k = h / d.
    """
    ground = rectangle("ground", (distance - 0.05, -0.05, 0), (0.1, 0, 0), (0, 0.1, 0))
    wall = rectangle("wall", (0, -half_length, 0), (0, 2 * half_length, 0), (0, 0, height))
    r = math.hypot(distance, height)
    taken = (math.atan(half_length / distance) - distance / r * math.atan(half_length / r)) / math.pi
    return Scene((ground, wall), rgb(1.0)), {
        "irradiance": rgb(1.0 - taken),
        "point": np.array([distance, 0.0, 0.0]),
    }
