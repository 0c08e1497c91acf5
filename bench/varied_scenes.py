# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Scenes that nothing was tuned on, as different from each other as what artists bring: for `python -m bench.survey`.

Metres, z up, fronts to the side that is lit. Walls have a thickness and stand on the floor, furniture stands on it too,
things touch and stick in each other: as they are modelled, and not as a method would like them.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace

import numpy as np
from numpy.typing import ArrayLike
from radiosity_bake.core.scene import Floats, Scene, SurfaceMesh, surface_mesh

from tests.scenes import exact

from .scenes import (
    COOL,
    DARKNESS,
    GREY,
    LAMP,
    WARM,
    WHITE,
    Ints,
    ball,
    block,
    cylinder,
    panel,
    room_walls,
    smooth,
    table,
    vertex_normals,
)

RED, GREEN, BLUE = (0.75, 0.08, 0.06), (0.1, 0.6, 0.12), (0.08, 0.15, 0.7)
DARK, BRIGHT = (0.1, 0.1, 0.1), (0.9, 0.9, 0.9)
WOOD = (0.45, 0.28, 0.15)
WALLS = (WOOD, WHITE, WARM, WHITE, COOL, WHITE)


# ------------------------------------------------------------------------------------------------- building blocks


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


# ---------------------------------------------------------------------------------------------------- the scenes


def bedroom() -> Scene:
    """A bedroom of 4 x 4.5 x 2.6 m: bed, pillows, wardrobe, desk, chair, a rug 1 cm thick, a lamp on a rod."""
    meshes = list(room_walls((4.0, 4.5, 2.6), WALLS))
    meshes += [
        block("Bed Frame", (0.0, 1.2, 0.1), (2.1, 1.6, 0.22), reflectance=WOOD),
        block("Bed Foot 1", (0.05, 1.25, 0.0), (0.08, 0.08, 0.1), reflectance=WOOD),
        block("Bed Foot 2", (1.95, 1.25, 0.0), (0.08, 0.08, 0.1), reflectance=WOOD),
        block("Bed Foot 3", (0.05, 2.65, 0.0), (0.08, 0.08, 0.1), reflectance=WOOD),
        block("Bed Foot 4", (1.95, 2.65, 0.0), (0.08, 0.08, 0.1), reflectance=WOOD),
        block("Mattress", (0.05, 1.25, 0.32), (2.0, 1.5, 0.2), reflectance=BRIGHT),
        block("Head Board", (0.0, 1.15, 0.32), (0.05, 1.7, 0.7), reflectance=WOOD),
        block("Wardrobe", (1.2, 3.9, 0.0), (1.8, 0.6, 2.1), reflectance=WOOD),
        block("Rug", (2.2, 1.0, 0.0), (1.4, 2.2, 0.01), degrees=8.0, reflectance=RED),
        block("Night Stand", (0.0, 0.6, 0.0), (0.4, 0.45, 0.5), reflectance=WHITE),
        block("Picture", (1.0, 0.0, 1.4), (0.8, 0.02, 0.6), reflectance=BLUE),
        cylinder("Rod", (2.0, 2.2, 2.22), 0.01, 0.38, segments=8, reflectance=DARK),
        panel("Lamp", (1.75, 1.95, 2.2), (0.5, 0.5)),
    ]
    meshes += table("Desk", (3.2, 0.3), (0.7, 1.3), 0.74, 0.05)
    meshes += table("Chair", (2.6, 0.6), (0.42, 0.42), 0.45, 0.03)
    meshes.append(block("Chair Back", (2.6, 0.6, 0.45), (0.03, 0.42, 0.45), reflectance=WOOD))
    for k, y in enumerate((1.6, 2.4)):
        pillow = ball(f"Pillow {k + 1}", (0.35, y, 0.58), 1.0, levels=3, reflectance=BRIGHT)
        middle = np.array([0.35, y, 0.58])
        flat = (pillow.vertices - middle) * [0.22, 0.33, 0.09]
        normals = vertex_normals(flat, pillow.triangles)
        meshes.append(smooth(pillow.name, middle + flat, pillow.triangles, normals, BRIGHT))
    return Scene(tuple(meshes), DARKNESS)


def attic() -> Scene:
    """A loft under a roof: walls slant to a ridge, beams cross it, crates stand about, a lamp is let into the slope."""
    depth, outline = 6.0, [(0.0, 0.0), (5.0, 0.0), (5.0, 0.8), (2.5, 3.3), (0.0, 0.8)]
    shell = inside_out(prism("Loft", outline, depth, WHITE))
    shell.reflectance[:] = WHITE
    shell.reflectance[6:8] = WOOD  # the floor comes first of the sides, after the two gables of three triangles
    meshes = [shell]
    for k in range(3):
        meshes.append(block(f"Beam {k + 1}", (0.9, 1.2 + 1.8 * k, 1.9), (3.2, 0.15, 0.15), reflectance=WOOD))
        meshes.append(block(f"Post {k + 1}", (2.4, 1.2 + 1.8 * k, 0.0), (0.15, 0.15, 1.9), reflectance=WOOD))
    for k, (x, y, size, degrees) in enumerate(((0.3, 0.4, 0.6, 10.0), (3.8, 1.6, 0.7, -25.0), (1.0, 4.2, 0.9, 40.0))):
        colour = (WARM, COOL, GREY)[k]
        meshes.append(block(f"Crate {k + 1}", (x, y, 0.0), (size, size, size), degrees=degrees, reflectance=colour))
    meshes.append(block("Lid", (1.05, 4.3, 0.9), (0.5, 0.5, 0.3), degrees=15.0, reflectance=GREEN))
    lamp = panel("Skylight", (3.0, 1.6, 2.19), (1.0, 1.0), 0.7 * np.array(LAMP))
    meshes.append(turned(lamp, "y", 45.0, (3.5, 2.1, 2.2)))
    return Scene(tuple(meshes), DARKNESS)


def staircase() -> Scene:
    """Twelve steps, each a block that touches the next, to a landing; a banister of thin posts; one lamp upstairs."""
    meshes = list(room_walls((2.4, 6.0, 5.0), WALLS))
    rise, going = 0.2, 0.28
    for k in range(12):
        low = (0.0, 0.8 + going * k, 0.0)
        meshes.append(block(f"Step {k + 1}", low, (1.2, going, rise * (k + 1)), reflectance=WOOD))
        post = (1.15, low[1] + 0.12, rise * (k + 1))
        meshes.append(block(f"Post {k + 1}", post, (0.03, 0.03, 0.9), reflectance=BRIGHT))
    meshes.append(block("Landing", (0.0, 0.8 + 12 * going, 2.2), (2.4, 6.0 - 0.8 - 12 * going, 0.2), reflectance=WOOD))
    meshes.append(panel("Lamp", (0.8, 4.6, 4.9), (0.8, 0.8), 1.5 * np.array(LAMP)))
    return Scene(tuple(meshes), DARKNESS)


def rotunda() -> Scene:
    """A round hall of radius 6 m with a ring of twelve columns, a basin in the middle and a glowing disc above."""
    walls = inside_out(cylinder("Rotunda", (0.0, 0.0, 0.0), 6.0, 5.0, segments=48, reflectance=WHITE))
    meshes = [walls]
    for k in range(12):
        a = 2.0 * np.pi * k / 12
        foot = (4.2 * math.cos(a), 4.2 * math.sin(a), 0.0)
        meshes.append(cylinder(f"Column {k + 1}", foot, 0.25, 5.0, segments=20, reflectance=WARM if k % 2 else COOL))
        base = (foot[0] - 0.35, foot[1] - 0.35, 0.0)
        meshes.append(block(f"Base {k + 1}", base, (0.7, 0.7, 0.2), degrees=30.0 * k, reflectance=WHITE))
    meshes.append(pipe("Basin Wall", (0.0, 0.0, 0.0), (1.2, 1.4), 0.6, 32, BLUE))
    disc = cylinder("Disc", (0.0, 0.0, 4.6), 0.9, 0.1, segments=24, reflectance=DARK)
    glow = np.where(disc.corner_normals[:, :1, 2] < -0.5, np.array(LAMP), 0.0)
    meshes.append(replace(disc, emission=glow))
    return Scene(tuple(meshes), DARKNESS)


def cave() -> Scene:
    """A lumpy hollow of about 3 m radius with balls of strong colours and one small bright lamp."""
    meshes = [inside_out(lumpy_ball("Cave", (0.0, 0.0, 0.0), 3.0, 0.35, 5, (0.6, 0.5, 0.4)))]
    places = ((-1.2, 0.4, -1.3), (0.9, -0.9, -1.4), (0.3, 1.4, -1.0), (-0.4, -1.5, -0.9), (1.5, 0.6, 0.2))
    for k, (place, colour) in enumerate(zip(places, (RED, GREEN, BLUE, BRIGHT, (0.8, 0.7, 0.05)), strict=True)):
        meshes.append(ball(f"Ball {k + 1}", place, 0.35 + 0.08 * k, levels=4, reflectance=colour))
    meshes.append(globe("Lamp", (-0.6, -0.2, 0.9), 0.1, 3.0, levels=1))
    return Scene(tuple(meshes), DARKNESS)


def doors() -> Scene:
    """A corridor 12 m long with four rooms beside it, doorways in walls 10 cm thick, lamps in two of the rooms."""
    length, wide, high, thick = 12.0, 5.2, 2.5, 0.1
    meshes = list(room_walls((length, wide, high), WALLS))
    for k in range(4):
        # Rooms of 3 m; the wall to the corridor is a piece at each side of the doorway and one above it.
        x = 3.0 * k
        wall = 1.8
        meshes += [
            block(f"Wall {k + 1} West", (x, wall, 0.0), (1.0, thick, high), reflectance=WHITE),
            block(f"Wall {k + 1} East", (x + 1.9, wall, 0.0), (1.1, thick, high), reflectance=WHITE),
            block(f"Wall {k + 1} Above", (x + 1.0, wall, 2.05), (0.9, thick, high - 2.05), reflectance=WHITE),
        ]
        if k:
            low = (x - 0.5 * thick, wall + thick, 0.0)
            meshes.append(block(f"Party Wall {k}", low, (thick, wide - wall - thick, high), reflectance=GREEN))
        meshes.append(block(f"Cupboard {k + 1}", (x + 0.3, 4.7, 0.0), (1.0, 0.5, 1.4), reflectance=(WARM, COOL)[k % 2]))
    meshes.append(panel("Lamp 1", (1.2, 3.2, 2.45), (0.6, 0.6)))
    meshes.append(panel("Lamp 2", (7.2, 3.2, 2.45), (0.6, 0.6)))
    return Scene(tuple(meshes), DARKNESS)


def thin_things() -> Scene:
    """A table on legs of 2 cm with twenty thin things on and about it: sheets, rods, frames; a small lamp above."""
    meshes = list(room_walls((3.5, 3.0, 2.5), WALLS))
    meshes += table("Table", (0.9, 0.9), (1.6, 1.0), 0.75, 0.02)
    rng = np.random.default_rng(5)
    for k in range(8):
        x, y = 1.0 + 1.3 * rng.random(), 1.0 + 0.7 * rng.random()
        size = (0.2, 0.14, 0.003 + 0.004 * k)
        meshes.append(block(f"Sheet {k + 1}", (x, y, 0.75), size, degrees=180.0 * rng.random(), reflectance=BRIGHT))
    for k in range(6):
        x, y = 0.3 + 2.9 * rng.random(), 0.2 + 0.5 * rng.random() + 1.9 * (k % 2)
        meshes.append(cylinder(f"Rod {k + 1}", (x, y, 0.0), 0.012, 1.2, segments=10, reflectance=(RED, BLUE)[k % 2]))
    for k in range(3):
        slat = block(f"Slat {k + 1}", (0.2, 0.3 + 0.8 * k, 0.4), (0.01, 0.6, 0.9), reflectance=GREEN)
        meshes.append(turned(slat, "y", 20.0, (0.2, 0.0, 0.4)))
    for k in range(3):
        corner = (3.0 - 0.3 * k, 1.2 + 0.4 * k, 0.2)
        meshes.append(exact.rectangle(f"Paper {k + 1}", corner, (0.1, 0.35, 0.0), (0.05, 0.0, 0.4), reflectance=WHITE))
    meshes.append(panel("Lamp", (1.5, 1.3, 2.3), (0.3, 0.3), 3.0 * np.array(LAMP)))
    return Scene(tuple(meshes), DARKNESS)


def narrow_gap() -> Scene:
    """A room that gets all its light through a gap of 10 cm: from a lamp next door, and from what that one lights.

    Only the dark room is baked, or the other one would be the mean.
    """
    floor, ceiling, west, _, south, north = room_walls((2.0, 3.0, 2.5), WALLS)
    wall = [
        block("Wall South", (2.0, 0.0, 0.0), (0.1, 1.7, 2.5), reflectance=WHITE),
        block("Wall North", (2.0, 1.8, 0.0), (0.1, 1.2, 2.5), reflectance=WHITE),
    ]
    lamp = panel("Lamp", (0.3, 1.3, 2.3), (0.8, 0.8), 3.0 * np.array(LAMP))
    bright = [replace(m, baked=False) for m in (floor, ceiling, west, south, north, *wall, lamp)]
    floor, ceiling, _, east, south, north = room_walls((4.0, 3.0, 2.5), WALLS)
    dark = [replace(m, vertices=m.vertices + [2.0, 0.0, 0.0]) for m in (floor, ceiling, east, south, north)]
    dark += [
        block("Crate", (3.6, 1.2, 0.0), (0.7, 0.7, 0.7), degrees=30.0, reflectance=WARM),
        ball("Ball", (4.8, 0.8, 0.4), 0.4, levels=3, reflectance=COOL),
    ]
    return Scene((*dark, *bright), DARKNESS)


def panel_hall() -> Scene:
    """A hall of 24 x 24 x 6 m under 64 small panels, with a gallery of pillars and stacks of crates."""
    side, high = 24.0, 6.0
    meshes = list(room_walls((side, side, high), (GREY, BRIGHT, WARM, COOL, WHITE, WHITE)))
    for k in range(64):
        x, y = 1.5 + 3.0 * (k % 8), 1.5 + 3.0 * (k // 8)
        meshes.append(panel(f"Panel {k + 1}", (x - 0.2, y - 0.2, high - 0.05), (0.4, 0.4), 1.5 * np.array(LAMP)))
    meshes += [
        block(f"Pillar {k + 1}", (2.0 + 2.8 * k, 18.0, 0.0), (0.4, 0.4, high), reflectance=WHITE) for k in range(8)
    ]
    meshes.append(block("Gallery", (0.0, 18.0, 3.0), (side, 6.0, 0.3), reflectance=WOOD))
    rng = np.random.default_rng(2)
    for k in range(12):
        x, y = 1.0 + 20.0 * rng.random(), 1.0 + 15.0 * rng.random()
        size = 0.8 + rng.random(3)
        crate = block(
            f"Crate {k + 1}", (x, y, 0.0), size, degrees=90.0 * rng.random(), reflectance=(RED, BLUE, WARM)[k % 3]
        )
        meshes.append(crate)
    return Scene(tuple(meshes), DARKNESS)


def low_lamp() -> Scene:
    """A room whose lamp is a lone glowing square 1 cm under the ceiling, which it lights, too."""
    meshes = list(room_walls((4.0, 4.0, 2.5), WALLS))
    lamp = exact.rectangle("Lamp", (1.5, 1.5, 2.49), (0.0, 1.0, 0.0), (1.0, 0.0, 0.0), emission=0.7 * np.array(LAMP))
    meshes.append(lamp)
    meshes.append(block("Crate", (0.6, 0.8, 0.0), (0.8, 0.8, 0.8), degrees=20.0, reflectance=GREEN))
    meshes.append(cylinder("Barrel", (2.8, 2.6, 0.0), 0.4, 1.2, segments=24, reflectance=WHITE))
    return Scene(tuple(meshes), DARKNESS)


def flush_lamps() -> Scene:
    """A room with lamps whose tops lie in the ceiling's plane: a panel in a housing, and a box that glows all over."""
    meshes = list(room_walls((4.0, 3.0, 2.5), WALLS))
    meshes.append(panel("Panel", (0.8, 0.8, 2.48), (0.8, 0.8)))
    meshes.append(block("Box", (2.6, 1.4, 2.42), (0.6, 0.6, 0.08), reflectance=0.0, emission=0.5 * np.array(LAMP)))
    meshes.append(block("Crate", (1.8, 1.0, 0.0), (0.7, 0.7, 0.9), degrees=35.0, reflectance=WHITE))
    return Scene(tuple(meshes), DARKNESS)


def shaded_lamp() -> Scene:
    """A bulb inside an open shade over a table, and a floor lamp whose shade is open above and below."""
    meshes = list(room_walls((4.0, 4.0, 2.6), WALLS))
    meshes += table("Table", (1.3, 1.3), (1.4, 1.4), 0.75, 0.06)
    meshes += [
        pipe("Shade", (2.0, 2.0, 1.5), (0.35, 0.12), 0.3, 32, (0.7, 0.6, 0.3)),
        globe("Bulb", (2.0, 2.0, 1.62), 0.06, 6.0),
        cylinder("Cord", (2.0, 2.0, 1.75), 0.008, 0.85, segments=8, reflectance=DARK),
        cylinder("Stand", (0.5, 3.4, 0.0), 0.02, 1.45, segments=12, reflectance=DARK),
        cylinder("Stand Foot", (0.5, 3.4, 0.0), 0.18, 0.03, segments=24, reflectance=DARK),
        pipe("Stand Shade", (0.5, 3.4, 1.4), (0.22, 0.16), 0.35, 32, (0.8, 0.75, 0.6)),
        globe("Stand Bulb", (0.5, 3.4, 1.55), 0.05, 6.0),
        ball("Bowl", (1.7, 1.8, 0.87), 0.12, levels=3, reflectance=RED),
    ]
    return Scene(tuple(meshes), DARKNESS)


def touching_blocks() -> Scene:
    """Blocks that share faces and edges, stick in each other, in the floor and in a wall; a plus of crossing bars."""
    meshes = list(room_walls((4.0, 4.0, 2.5), WALLS))
    meshes += [
        block("Stack 1", (0.5, 0.5, 0.0), (0.8, 0.8, 0.5), reflectance=RED),
        block("Stack 2", (0.5, 0.5, 0.5), (0.8, 0.8, 0.5), degrees=30.0, reflectance=WHITE),
        block("Beside", (1.3, 0.5, 0.0), (0.5, 0.8, 0.9), reflectance=BLUE),
        block("Sunk", (2.4, 0.6, -0.3), (0.8, 0.8, 0.8), degrees=25.0, reflectance=GREEN),
        turned(block("Through Wall", (3.4, 2.0, 0.6), (1.0, 0.6, 0.6), reflectance=WARM), "x", 30.0, (3.9, 2.3, 0.9)),
        block("Bar 1", (0.8, 2.6, 0.0), (1.4, 0.3, 0.3), reflectance=COOL),
        block("Bar 2", (1.35, 2.05, 0.0), (0.3, 1.4, 0.3), reflectance=COOL),
        block("Bar 3", (1.35, 2.6, 0.0), (0.3, 0.3, 1.4), reflectance=COOL),
        ball("Half Ball", (2.9, 3.2, 0.0), 0.5, levels=3, reflectance=WHITE),
        ball("Stuck Ball", (1.55, 1.3, 0.9), 0.35, levels=3, reflectance=BRIGHT),
        panel("Lamp", (1.6, 1.4, 2.4), (0.8, 0.8)),
    ]
    return Scene(tuple(meshes), DARKNESS)


def tilted() -> Scene:
    """A ramp from wall to wall with things that stand tilted on it and lean against a wall, and a tilted lamp."""
    meshes = list(room_walls((4.0, 4.0, 3.0), WALLS))
    meshes.append(prism("Ramp", [(0.0, 0.0), (4.0, 0.0), (4.0, 1.2)], 4.0, WOOD))
    slope, about = -math.degrees(math.atan2(1.2, 4.0)), (0.0, 0.0, 0.0)
    for k, (x, y, size) in enumerate(((1.0, 0.7, 0.5), (2.4, 2.5, 0.7), (3.0, 0.6, 0.4))):
        crate = block(f"Crate {k + 1}", (x, y, 0.0), (size,) * 3, degrees=25.0 * k, reflectance=(RED, BRIGHT, GREEN)[k])
        meshes.append(turned(crate, "y", slope, about))
    plank = block("Plank", (0.02, 1.6, 0.0), (0.04, 0.3, 1.8), reflectance=WARM)
    meshes.append(turned(plank, "y", -18.0, (0.06, 0.0, 1.8)))
    meshes.append(ball("Ball", (1.2, 2.6, 0.75), 0.3, levels=4, reflectance=COOL))
    meshes.append(turned(panel("Lamp", (1.2, 1.2, 2.6), (0.7, 0.7)), "x", 25.0, (1.5, 1.5, 2.6)))
    return Scene(tuple(meshes), DARKNESS)


def smooth_bodies() -> Scene:
    """Dense bodies with smooth normals: a ring, a ball, a lumpy one, and a coarse ball whose shading bends far."""
    meshes = list(room_walls((4.0, 4.0, 2.5), WALLS))
    meshes += [
        torus("Ring", (1.1, 1.2, 0.25), (0.55, 0.25), (96, 48), RED),
        ball("Ball", (2.9, 1.0, 0.5), 0.5, levels=5, reflectance=BRIGHT),
        lumpy_ball("Lump", (2.6, 2.9, 0.75), 0.6, 0.5, 5, WARM, seed=3),
        ball("Coarse Ball", (1.0, 3.0, 0.45), 0.45, levels=1, reflectance=COOL),
        panel("Lamp", (1.7, 1.8, 2.45), (0.6, 0.6)),
    ]
    return Scene(tuple(meshes), DARKNESS)


def chequered() -> Scene:
    """A room whose floor and wall alternate between reflectances of 0.1 and 0.9, and a mesh of many materials."""
    meshes = list(room_walls((4.0, 4.0, 2.5), ((0.1,) * 3, BRIGHT, (0.9, 0.1, 0.1), (0.1, 0.1, 0.9), DARK, BRIGHT)))
    meshes[0] = chequered_sheet("Floor", (0.0, 0.0, 0.0), (4.0, 0.0, 0.0), (0.0, 4.0, 0.0), 8)
    meshes[5] = chequered_sheet("North", (0.0, 4.0, 0.0), (4.0, 0.0, 0.0), (0.0, 0.0, 2.5), 5)
    for k in range(4):
        size = (0.5, 0.5, 0.4 + 0.3 * k)
        colour = exact.rgb(0.1 + 0.8 * k / 3)
        meshes.append(
            block(f"Block {k + 1}", (0.4 + 0.9 * k, 1.0 + 0.5 * k, 0.0), size, degrees=15.0 * k, reflectance=colour)
        )
    meshes.append(panel("Lamp", (2.6, 0.6, 2.3), (0.5, 0.9), 1.5 * np.array(LAMP)))
    return Scene(tuple(meshes), DARKNESS)


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


def matchbox() -> Scene:
    """A box 10 cm long with matches and beads in it, under a light of 2 cm: the smallest of the scenes."""
    meshes = list(room_walls((10.0, 6.0, 4.0), WALLS))
    for k in range(5):
        match = block(f"Match {k + 1}", (1.0, 1.0 + 0.5 * k, 0.0), (5.0, 0.2, 0.2), degrees=7.0 * k, reflectance=WOOD)
        meshes.append(match)
        meshes.append(ball(f"Head {k + 1}", match.vertices.max(axis=0) - [0.0, 0.2, 0.1], 0.2, reflectance=RED))
    meshes += [
        ball(f"Bead {k + 1}", (7.5 + 0.4 * k, 1.0 + 1.2 * k, 0.5), 0.5, levels=3, reflectance=(GREEN, BLUE)[k % 2])
        for k in range(4)
    ]
    meshes.append(panel("Lamp", (5.0, 2.0, 3.95), (2.0, 2.0)))
    return scaled(Scene(tuple(meshes), DARKNESS), 0.01)


def hangar() -> Scene:
    """A hangar 100 m long with an aircraft of a few bodies, ladders and containers: the largest of the scenes."""
    meshes = list(room_walls((100.0, 60.0, 20.0), (GREY, WHITE, WHITE, COOL, WHITE, WARM)))
    body = ball("Body", (0.0, 0.0, 0.0), 1.0, levels=4, reflectance=BRIGHT)
    long = body.vertices * [25.0, 3.0, 3.0]
    middle = np.array([50.0, 30.0, 6.0])
    meshes.append(smooth("Body", middle + long, body.triangles, vertex_normals(long, body.triangles), BRIGHT))
    meshes += [
        block("Wings", (46.0, 6.0, 5.5), (8.0, 48.0, 0.6), reflectance=BRIGHT),
        block("Tail", (69.0, 29.7, 7.0), (5.0, 0.6, 8.0), reflectance=RED),
        block("Tail Wings", (69.0, 23.0, 7.5), (4.0, 14.0, 0.4), reflectance=BRIGHT),
    ]
    for k, (x, y) in enumerate(((35.0, 30.0), (52.0, 26.0), (52.0, 34.0))):
        meshes.append(cylinder(f"Gear {k + 1}", (x, y, 0.0), 0.3, 4.5, segments=12, reflectance=DARK))
    for k in range(6):
        size = (6.0, 2.4, 2.6)
        place = (4.0 + 13.0 * k, 2.0 + 1.5 * (k % 3), 0.0)
        meshes.append(block(f"Container {k + 1}", place, size, degrees=12.0 * k, reflectance=(RED, BLUE, GREEN)[k % 3]))
    for k in range(10):
        x, y = 10.0 + 20.0 * (k % 5), 20.0 + 20.0 * (k // 5)
        meshes.append(panel(f"Lamp {k + 1}", (x - 1.5, y - 1.5, 19.8), (3.0, 3.0), 2.0 * np.array(LAMP)))
    return Scene(tuple(meshes), DARKNESS)


def window_room() -> Scene:
    """A room lit by the sky through a window, without any lamp: walls of 25 cm, a sill, a table and chairs."""
    size, thick = (5.0, 4.0, 2.7), 0.25
    floor, ceiling, west, _, south, north = room_walls(size, WALLS)
    x = size[0]
    meshes = [
        *(floor, ceiling, west, south, north),
        block("Below Window", (x, 0.0, 0.0), (thick, 4.0, 0.9), reflectance=WHITE),
        block("Above Window", (x, 0.0, 2.2), (thick, 4.0, 0.5), reflectance=WHITE),
        block("South of Window", (x, 0.0, 0.9), (thick, 1.0, 1.3), reflectance=WHITE),
        block("North of Window", (x, 3.0, 0.9), (thick, 1.0, 1.3), reflectance=WHITE),
        block("Bar", (x + 0.1, 1.97, 0.9), (0.05, 0.06, 1.3), reflectance=WOOD),
    ]
    meshes += table("Table", (2.6, 1.4), (1.6, 0.9), 0.75, 0.05)
    meshes += table("Chair", (2.2, 1.6), (0.42, 0.42), 0.45, 0.03)
    meshes.append(block("Shelf", (0.0, 0.5, 0.0), (0.35, 1.5, 2.0), reflectance=WOOD))
    meshes.append(ball("Bowl", (3.3, 1.8, 0.9), 0.15, levels=3, reflectance=RED))
    return Scene(tuple(meshes), np.array([3.0, 3.6, 4.5]))


def courtyard() -> Scene:
    """Open ground under a bright sky: a tower, a wall, an arch of blocks, a ball: most rays leave."""
    ground = exact.rectangle("Ground", (-10, -10, 0), (20, 0, 0), (0, 20, 0), reflectance=GREY)
    meshes = [
        ground,
        block("Tower", (-3.0, 1.0, 0.0), (2.5, 2.5, 6.0), degrees=20.0, reflectance=WHITE),
        block("Wall", (-6.0, -3.0, 0.0), (9.0, 0.3, 2.0), reflectance=WARM),
        block("Arch West", (2.0, 1.0, 0.0), (0.5, 1.0, 2.5), reflectance=COOL),
        block("Arch East", (4.0, 1.0, 0.0), (0.5, 1.0, 2.5), reflectance=COOL),
        block("Arch Above", (1.8, 0.9, 2.5), (2.9, 1.2, 0.5), reflectance=COOL),
        ball("Ball", (1.5, -1.5, 0.8), 0.8, levels=4, reflectance=RED),
    ]
    return Scene(tuple(meshes), np.array([1.0, 1.2, 1.6]))


VARIED_SCENES: dict[str, Callable[[], Scene]] = {
    scene.__name__: scene
    for scene in (
        bedroom,
        attic,
        staircase,
        rotunda,
        cave,
        doors,
        thin_things,
        narrow_gap,
        panel_hall,
        low_lamp,
        flush_lamps,
        shaded_lamp,
        touching_blocks,
        tilted,
        smooth_bodies,
        chequered,
        matchbox,
        hangar,
        window_room,
        courtyard,
    )
}
