# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The scenes of the benchmark as arrays, made by pure functions: metres, z up, fronts to the side that is lit."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray
from radiosity_bake.core.scene import Floats, Scene, SurfaceMesh, surface_mesh

from tests.scenes import exact
from tools import rooms

from . import teapot

Ints = NDArray[np.int64]

WHITE = rooms.PAPER_WHITE
WARM = rooms.PAPER_WARM
COOL = rooms.PAPER_COOL
GREY = (0.5, 0.5, 0.5)
LAMP = (16.0, 14.0, 11.0)
DARKNESS = np.zeros(3)


def mesh_of(surface: rooms.Surface) -> SurfaceMesh:
    """Return a room's surface as triangles: polygons become fans, as they are convex."""
    triangles = [(f[0], f[k], f[k + 1]) for f in surface.faces for k in range(1, len(f) - 1)]
    return surface_mesh(
        surface.name, surface.vertices, triangles, reflectance=surface.reflectance, emission=surface.emission
    )


def scene_of(surfaces: Sequence[rooms.Surface]) -> Scene:
    """Return a scene of `tools.rooms` with a black world."""
    return Scene(tuple(mesh_of(s) for s in surfaces), DARKNESS)


def even_size(scene: Scene, patches: int) -> float:
    """Return the minimum size at which a scene, cut evenly, has about so many patches: equation (17) of the theory."""
    area = 0.0
    for mesh in scene.meshes:
        a, b, c = (mesh.vertices[mesh.triangles[:, k]] for k in range(3))
        area += 0.5 * float(np.linalg.norm(np.cross(b - a, c - a), axis=1).sum())
    return math.sqrt(4.0 * area / patches) / math.sqrt(2.0)


# ------------------------------------------------------------------------------------------------- building blocks


def rotation(degrees: float) -> Floats:
    """Return the (3, 3) rotation about the vertical."""
    c, s = math.cos(math.radians(degrees)), math.sin(math.radians(degrees))
    return np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])


def block(
    name: str,
    low: ArrayLike,
    size: ArrayLike,
    *,
    degrees: float = 0.0,
    reflectance: ArrayLike = GREY,
    emission: ArrayLike = 0.0,
) -> SurfaceMesh:
    """Return a closed box, fronts outward, turned about the vertical through its middle.

    Parameters
    ----------
    low, size : (3,) array_like, m
        The corner with least coordinates before it is turned, and the extents.
    """
    inside_out = exact.closed_room(size, reflectance=reflectance, emission=emission, name=name)
    half = 0.5 * np.asarray(size, dtype=np.float64)
    placed = (inside_out.vertices - half) @ rotation(degrees).T + half + np.asarray(low, dtype=np.float64)
    return surface_mesh(
        name,
        placed,
        inside_out.triangles[:, ::-1],
        reflectance=exact.rgb(reflectance),
        emission=exact.rgb(emission),
    )


def smooth(
    name: str, vertices: Floats, triangles: Ints, normals: Floats, reflectance: ArrayLike, emission: ArrayLike = 0.0
) -> SurfaceMesh:
    """Return a smooth-shaded mesh from a normal for each vertex."""
    return surface_mesh(
        name,
        vertices,
        triangles,
        corner_normals=normals[triangles],
        reflectance=exact.rgb(reflectance),
        emission=exact.rgb(emission),
    )


def ball(
    name: str,
    centre: ArrayLike,
    radius: float,
    *,
    levels: int = 3,
    reflectance: ArrayLike = GREY,
    emission: ArrayLike = 0,
) -> SurfaceMesh:
    """Return a smooth-shaded sphere of 20 * 4^levels triangles, fronts outward."""
    unit, triangles = exact.icosphere(levels)
    return smooth(name, np.asarray(centre) + radius * unit, triangles, unit, reflectance, emission)


def cylinder(
    name: str,
    base: ArrayLike,
    radius: float,
    height: float,
    *,
    segments: int = 24,
    reflectance: ArrayLike = GREY,
    bottom: bool = True,
) -> SurfaceMesh:
    """Return an upright cylinder, its side smooth-shaded, its ends flat: 4 * segments - 4 triangles, fronts outward."""
    angle = 2.0 * np.pi * np.arange(segments) / segments
    ring = np.stack([np.cos(angle), np.sin(angle), np.zeros(segments)], axis=1)
    low = np.asarray(base, dtype=np.float64) + radius * ring
    vertices = np.concatenate([low, low + np.array([0.0, 0.0, height])])
    i = np.arange(segments)
    j = (i + 1) % segments
    side = np.stack([i, j, j + segments, i, j + segments, i + segments], axis=1).reshape(-1, 3)
    fan = np.stack([np.zeros(segments - 2, int), i[1:-1], i[2:]], axis=1)
    ends = [fan + segments] + ([fan[:, ::-1]] if bottom else [])
    triangles = np.concatenate([side, *ends])
    mesh = surface_mesh(name, vertices, triangles, reflectance=exact.rgb(reflectance))
    mesh.corner_normals[: len(side)] = ring[side % segments]
    return mesh


def room_walls(size: ArrayLike, reflectances: Sequence[ArrayLike]) -> tuple[SurfaceMesh, ...]:
    """Return a closed room with a reflectance for floor, ceiling, west, east, south and north."""
    walls = exact.box_walls(size)
    return tuple(
        surface_mesh(w.name.capitalize(), w.vertices, w.triangles, reflectance=exact.rgb(r))
        for w, r in zip(walls, reflectances, strict=True)
    )


def panel(name: str, low: ArrayLike, size: tuple[float, float], emission: ArrayLike = LAMP) -> SurfaceMesh:
    """Return a lamp 2 cm thick that glows below and is grey on its other sides.

    A lone rectangle would glow on both sides and light the ceiling behind it more than all the rest of the room.
    """
    case = block(name, low, (*size, 0.02))
    glow = np.zeros((len(case.triangles), 3))
    glow[:2] = emission  # `closed_room` begins with the bottom
    return surface_mesh(name, case.vertices, case.triangles, reflectance=case.reflectance, emission=glow)


# ---------------------------------------------------------------------------------------------------- the scenes


def cornell_box() -> Scene:
    """The Cornell box with its measured coordinates and colours, the lamp set into a hole of the ceiling.

    Emitters glow on both sides, as in Cycles, so a lamp hung under the ceiling lights the part of it that it hides 100
    times brighter than anything that is seen: that would be the mean, and the error, of the whole box. What hangs like
    that is `cornell_box_hung`.
    """
    return scene_of(rooms.cornell_box())


def cornell_box_hung() -> Scene:
    """The same with an unbroken ceiling: the lamp hangs 0.1 mm under it and lights it from there."""
    return scene_of(rooms.cornell_box_hung())


def paper_scene_1() -> Scene:
    """Five cubes and one cube-shaped lamp (Kulyasov & Nikulin 2010, scene 1)."""
    return scene_of(rooms.paper_scene_1())


def furnace() -> Scene:
    """A closed box that emits and reflects alike everywhere: radiance 2 at every point."""
    return exact.furnace(0.5)[0]


def paper_furniture() -> list[SurfaceMesh]:
    """Return what the paper's scenes 2 and 3 share: a room, four cylinders, two boxes and a Utah teapot."""
    shell = [mesh_of(s) for s in rooms.paper_scene_1()[:5]]
    spots = ((-1.5, 3.5), (1.5, 3.5), (-1.5, 1.0), (1.5, 1.0))
    columns = [
        cylinder(f"Cylinder {k + 1}", (x, y, 0.0), 0.22, 1.6, segments=32, reflectance=WHITE, bottom=False)
        for k, (x, y) in enumerate(spots)
    ]
    boxes = [
        block("Box 1", (-0.5, 1.7, 0.0), (1.0, 1.0, 0.7), degrees=20.0, reflectance=WHITE),
        block("Box 2", (0.2, 2.9, 0.0), (0.7, 0.6, 1.1), degrees=-15.0, reflectance=COOL),
    ]
    pot = teapot.tessellate(8)
    placed = pot.vertices * 0.16 @ rotation(25.0).T + np.array([0.0, 2.2, 0.7])
    table_pot = smooth("Teapot", placed, pot.triangles, pot.normals @ rotation(25.0).T, WARM)
    return [*shell, *columns, *boxes, table_pot]


def paper_scene_2() -> Scene:
    """Four cylinders, two boxes, a Utah teapot; lamps: a sphere and two cubes."""
    lamps = [
        ball("Lamp Sphere", (0.0, 2.0, 2.4), 0.18, levels=2, reflectance=0.0, emission=LAMP),
        block("Lamp Cube 1", (-1.3, 2.6, 2.3), (0.2, 0.2, 0.2), reflectance=0.0, emission=LAMP),
        block("Lamp Cube 2", (1.1, 1.2, 2.3), (0.2, 0.2, 0.2), reflectance=0.0, emission=LAMP),
    ]
    return Scene((*paper_furniture(), *lamps), DARKNESS)


def paper_scene_3() -> Scene:
    """The same with two cubes and a second teapot as lamps."""
    pot = teapot.tessellate(4)
    glowing = smooth(
        "Lamp Teapot", pot.vertices * 0.1 + np.array([0.0, 2.0, 2.3]), pot.triangles, pot.normals, 0.0, LAMP
    )
    return Scene((*paper_scene_2().meshes[:-3], *paper_scene_2().meshes[-2:], glowing), DARKNESS)


def corridor() -> Scene:
    """An L-shaped corridor, 2 m wide and 2.5 m high: the lamp is round the corner, so half of it is lit indirectly.

    The inner corner is at (2, 2); one leg runs along x to 8 m, one along y to 8 m, the lamp at its end.
    """
    width, length, height = 2.0, 8.0, 2.5
    outline = [(0, 0), (length, 0), (length, width), (width, width), (width, length), (0, length)]
    low = [(x, y, 0.0) for x, y in outline]
    high = [(x, y, height) for x, y in outline]
    # The L as three convex parts that share corners: the square at the bend and the two legs.
    bend = (0.0, width), (width, 0.0)
    flat = [*outline, *bend]
    cells = ((0, 7, 3, 6), (7, 1, 2, 3), (6, 3, 4, 5))
    floor_triangles = [t for a, b, c, d in cells for t in ((a, b, c), (a, c, d))]
    floor = surface_mesh("Floor", [(x, y, 0.0) for x, y in flat], floor_triangles, reflectance=GREY)
    ceiling = surface_mesh(
        "Ceiling", [(x, y, height) for x, y in flat], [t[::-1] for t in floor_triangles], reflectance=WHITE
    )
    walls = []
    for k in range(6):
        j = (k + 1) % 6
        corners = [low[j], low[k], high[k], high[j]]
        colour = WARM if k == 0 else WHITE
        walls.append(surface_mesh(f"Wall {k + 1}", corners, exact.QUAD, reflectance=colour))
    lamp = panel("Lamp", (0.5, length - 1.2, height - 0.05), (1.0, 1.0))
    return Scene((floor, ceiling, *walls, lamp), DARKNESS)


def furnished_room() -> Scene:
    """A closed room of 5 x 4 x 2.7 m with a table and four chairs on thin legs, shelves and balls, two lamps."""
    meshes = list(room_walls((5.0, 4.0, 2.7), (GREY, WHITE, WARM, COOL, WHITE, WHITE)))
    meshes += table("Table", (1.7, 1.4), (1.6, 1.0), 0.75, 0.04)
    for k, (x, y) in enumerate(((1.9, 0.75), (2.7, 0.75), (1.9, 2.65), (2.7, 2.65))):
        meshes += table(f"Chair {k + 1}", (x, y), (0.42, 0.42), 0.45, 0.03)
        meshes.append(block(f"Chair {k + 1} Back", (x, y + (0.39 if y > 2 else 0.0), 0.45), (0.42, 0.03, 0.45)))
    for k in range(4):
        meshes.append(block(f"Shelf {k + 1}", (0.05, 3.2, 0.4 + 0.5 * k), (0.9, 0.3, 0.03), reflectance=WHITE))
    for k, (x, y, z, r) in enumerate(((2.1, 1.8, 0.92, 0.15), (2.8, 2.0, 0.89, 0.12), (4.2, 3.2, 0.4, 0.4))):
        meshes.append(ball(f"Ball {k + 1}", (x, y, z), r, reflectance=(WARM, WHITE, COOL)[k]))
    meshes.append(panel("Ceiling Lamp", (2.1, 1.5, 2.65), (0.8, 0.8)))
    meshes.append(ball("Lamp Globe", (4.5, 0.5, 1.5), 0.12, levels=2, reflectance=0.0, emission=LAMP))
    return Scene(tuple(meshes), DARKNESS)


def table(
    name: str, low: tuple[float, float], size: tuple[float, float], height: float, leg: float
) -> list[SurfaceMesh]:
    """Return a top of thickness 0.04 m and four legs that end under it."""
    (x, y), (sx, sy), thick = low, size, 0.04
    top = block(name, (x, y, height - thick), (sx, sy, thick), reflectance=WARM)
    legs = [
        block(f"{name} Leg {k + 1}", (px, py, 0.0), (leg, leg, height - thick), reflectance=WARM)
        for k, (px, py) in enumerate(
            (px, py) for px in (x + 0.02, x + sx - leg - 0.02) for py in (y + 0.02, y + sy - leg - 0.02)
        )
    ]
    return [top, *legs]


def pillar_hall(rows: int = 10) -> Scene:
    """A hall of 20 x 20 x 4 m with rows x rows pillars and nine lamps between them."""
    side, height = 20.0, 4.0
    meshes = list(room_walls((side, side, height), (GREY, WHITE, WARM, COOL, WHITE, WHITE)))
    step = side / rows
    for i in range(rows):
        for j in range(rows):
            corner = (step * (i + 0.5) - 0.2, step * (j + 0.5) - 0.2, 0.0)
            meshes.append(block(f"Pillar {i * rows + j + 1}", corner, (0.4, 0.4, height), reflectance=WHITE))
    for i in range(3):
        for j in range(3):
            x, y = (step * round((k + 0.5) * rows / 3) for k in (i, j))
            meshes.append(panel(f"Lamp {3 * i + j + 1}", (x - 0.3, y - 0.3, height - 0.05), (0.6, 0.6)))
    return Scene(tuple(meshes), DARKNESS)


def statue(around: int = 384, along: int = 160) -> Scene:
    """A statue of 2 * around * (along - 1) triangles (122,112) on a plinth in a closed room, with folds and hollows.

    Three swellings along a bent column: a closed surface of revolution, disturbed by smooth twisted waves.
    """
    angle = 2.0 * np.pi * np.arange(around) / around
    share = np.linspace(0.0, 1.0, along + 1)[1:-1]
    t, a = (x.ravel() for x in np.meshgrid(share, angle, indexing="ij"))
    radius = np.sqrt(np.sin(np.pi * t)) * (0.22 + 0.07 * np.cos(6.0 * np.pi * t))
    radius *= 1.0 + 0.12 * np.cos(7.0 * a + 9.0 * t) * np.sin(np.pi * t) + 0.04 * np.sin(23.0 * a - 31.0 * t)
    x = radius * np.cos(a) + 0.08 * np.sin(5.0 * t)
    y = radius * np.sin(a) + 0.06 * np.cos(4.0 * t)
    vertices = np.stack([x, y, 1.5 * t], axis=1)
    ends = np.array([[0.0, 0.06, 0.0], [0.08 * math.sin(5.0), 0.06 * math.cos(4.0), 1.5]])
    vertices = np.concatenate([vertices, ends]) + np.array([2.0, 2.0, 0.6])
    triangles = lathe_triangles(around, len(share))
    meshes = list(room_walls((4.0, 4.0, 3.0), (GREY, WHITE, WARM, COOL, WHITE, WHITE)))
    meshes.append(block("Plinth", (1.6, 1.6, 0.0), (0.8, 0.8, 0.6), degrees=15.0, reflectance=WHITE))
    meshes.append(smooth("Statue", vertices, triangles, vertex_normals(vertices, triangles), WHITE))
    meshes.append(panel("Lamp", (0.6, 0.8, 2.95), (0.8, 0.8)))
    return Scene(tuple(meshes), DARKNESS)


def lathe_triangles(around: int, rings: int) -> Ints:
    """Return the triangles of rings of vertices closed by two poles, which come last: fronts outward."""
    i, k = (x.ravel() for x in np.meshgrid(np.arange(rings - 1), np.arange(around), indexing="ij"))
    j = (k + 1) % around
    a, b, c, d = i * around + k, i * around + j, (i + 1) * around + j, (i + 1) * around + k
    body = np.stack([a, b, c, a, c, d], axis=1).reshape(-1, 3)
    k = np.arange(around)
    j = (k + 1) % around
    low, high, last = rings * around, rings * around + 1, (rings - 1) * around
    bottom = np.stack([j, k, np.full(around, low)], axis=1)
    top = np.stack([last + k, last + j, np.full(around, high)], axis=1)
    return np.concatenate([body, bottom, top])


def vertex_normals(vertices: Floats, triangles: Ints) -> Floats:
    """Return unit normals at vertices: the area-weighted mean of the triangles around each."""
    a, b, c = (vertices[triangles[:, k]] for k in range(3))
    cross = np.cross(b - a, c - a)
    total = np.zeros_like(vertices)
    for k in range(3):
        np.add.at(total, triangles[:, k], cross)
    return total / np.linalg.norm(total, axis=1, keepdims=True)


SCENES: dict[str, Callable[[], Scene]] = {
    "cornell_box": cornell_box,
    "cornell_box_hung": cornell_box_hung,
    "paper_scene_1": paper_scene_1,
    "paper_scene_2": paper_scene_2,
    "paper_scene_3": paper_scene_3,
    "furnace": furnace,
    "corridor": corridor,
    "furnished_room": furnished_room,
    "pillar_hall": pillar_hall,
    "statue": statue,
}
