# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Places of other kinds than rooms with furniture, for `bench/varied_scenes.py`: single sheets, bars, deep lamps."""

from __future__ import annotations

import math

import numpy as np
from radiosity_bake.core.scene import Floats, Scene, SurfaceMesh, surface_mesh

from tests.scenes import exact

from .scenes import COOL, DARKNESS, GREY, LAMP, WARM, WHITE, ball, block, cylinder, panel, room_walls, smooth
from .shapes import BLUE, BRIGHT, DARK, GREEN, RED, WOOD, globe, lumpy_ball, pipe, turned

LAWN = (0.2, 0.35, 0.1)


def shop() -> Scene:
    """A shop of 6 x 5 x 3 m with goods on open shelves, a counter, and lamps deep in cans that hang off the ceiling."""
    meshes = list(room_walls((6.0, 5.0, 3.0), ((0.4, 0.38, 0.35), WHITE, WHITE, (0.7, 0.2, 0.15), WHITE, COOL)))
    rng = np.random.default_rng(11)
    for unit, x in enumerate((0.6, 2.9)):
        meshes.append(block(f"Back {unit + 1}", (x, 4.94, 0.0), (2.0, 0.03, 2.0), reflectance=WOOD))
        meshes += [
            block(f"Side {unit + 1} {side}", (x + side, 4.54, 0.0), (0.03, 0.4, 2.0), reflectance=WOOD)
            for side in (0.0, 1.97)
        ]
        for level in range(5):
            z = 0.1 + 0.45 * level
            meshes.append(block(f"Shelf {unit + 1} {level + 1}", (x + 0.03, 4.54, z), (1.94, 0.4, 0.02)))
            for k in range(6):
                size = (0.12 + 0.12 * rng.random(), 0.15 + 0.15 * rng.random(), 0.1 + 0.25 * rng.random())
                where = (x + 0.08 + 0.31 * k, 4.6, z + 0.02)
                meshes.append(block(f"Box {unit + 1} {level + 1} {k + 1}", where, size, reflectance=rng.random(3)))
    meshes += [
        block("Counter", (1.0, 1.2, 0.0), (2.4, 0.6, 0.95), reflectance=WARM),
        block("Counter Top", (0.95, 1.15, 0.95), (2.5, 0.7, 0.04), reflectance=DARK),
        block("Till", (1.3, 1.3, 0.99), (0.35, 0.3, 0.25), degrees=12.0, reflectance=GREY),
        cylinder("Stand", (4.6, 2.2, 0.0), 0.4, 0.8, segments=32, reflectance=BRIGHT),
        lumpy_ball("Cap", (4.6, 2.2, 1.0), 0.2, 0.4, 3, BLUE),
    ]
    for k, (x, y) in enumerate(((1.4, 3.6), (3.0, 3.6), (4.6, 3.6), (2.2, 1.8), (4.6, 1.6))):
        meshes.append(pipe(f"Can {k + 1}", (x, y, 2.6), (0.1, 0.1), 0.25, 24, DARK))
        lamp = exact.rectangle(
            f"Bulb {k + 1}",
            (x - 0.06, y - 0.06, 2.75),
            (0.0, 0.12, 0.0),
            (0.12, 0.0, 0.0),
            emission=6.0 * np.array(LAMP),
        )
        meshes.append(lamp)
    return Scene(tuple(meshes), DARKNESS)


def arch(
    name: str, radius: float, foot: float, length: float, pieces: int, reflectance: tuple[float, ...]
) -> SurfaceMesh:
    """Return half a tube on the plane z = foot, one sheet along y, smooth-shaded, its front inward."""
    angle = np.pi * np.arange(pieces + 1) / pieces
    normal = np.stack([-np.cos(angle), np.zeros(pieces + 1), -np.sin(angle)], axis=1)
    ring = np.array([0.0, 0.0, foot]) - radius * normal
    vertices = np.concatenate([ring, ring + [0.0, length, 0.0]])
    i = np.arange(pieces)
    triangles = np.stack([i, i + 1, i + pieces + 2, i, i + pieces + 2, i + pieces + 1], axis=1).reshape(-1, 3)
    return smooth(name, vertices, triangles, np.concatenate([normal, normal]), reflectance)


def tunnel() -> Scene:
    """A road tunnel of 40 m, lit by a row of small lamps and by the sky at both ends, with kerbs and two vans."""
    length = 40.0
    meshes = [
        exact.rectangle("Ground", (-20.0, -20.0, -0.01), (40.0, 0.0, 0.0), (0.0, 80.0, 0.0), reflectance=LAWN),
        exact.rectangle("Road", (-5.0, -20.0, 0.0), (10.0, 0.0, 0.0), (0.0, 80.0, 0.0), reflectance=(0.15, 0.15, 0.16)),
        arch("Vault", 4.0, 1.2, length, 24, (0.6, 0.58, 0.52)),
        block("Kerb 1", (-4.2, 0.0, 0.0), (1.0, length, 0.2)),
        block("Kerb 2", (3.2, 0.0, 0.0), (1.0, length, 0.2)),
        block("Wall 1", (-4.3, 0.0, 0.0), (0.3, length, 1.21), reflectance=BRIGHT),
        block("Wall 2", (4.0, 0.0, 0.0), (0.3, length, 1.21), reflectance=BRIGHT),
    ]
    for k, y in enumerate((9.0, 24.0)):
        x = -2.6 + 3.2 * k
        meshes.append(block(f"Van {k + 1}", (x, y, 0.3), (1.9, 4.6, 1.8), reflectance=(RED, WHITE)[k]))
        for m, (dx, dy) in enumerate(((0.0, 0.7), (1.65, 0.7), (0.0, 3.4), (1.65, 3.4))):
            wheel = turned(
                cylinder("Wheel", (0.0, 0.0, 0.0), 0.32, 0.25, segments=16, reflectance=DARK), "y", 90.0, (0, 0, 0)
            )
            name, at = f"Wheel {k + 1} {m + 1}", np.array([x + dx, y + dy, 0.32])
            meshes.append(surface_mesh(name, wheel.vertices + at, wheel.triangles, reflectance=exact.rgb(DARK)))
    meshes += [panel(f"Lamp {k + 1}", (-0.15, 2.0 + 5.0 * k, 4.9), (0.3, 1.2), 1.5 * np.array(LAMP)) for k in range(8)]
    return Scene(tuple(meshes), np.array([0.8, 1.0, 1.3]))


def sheet(name: str, *corners: tuple[float, float, float], reflectance: tuple[float, ...]) -> SurfaceMesh:
    """Return a flat polygon without thickness, triangles about its first corner."""
    fan = [(0, k, k + 1) for k in range(1, len(corners) - 1)]
    return surface_mesh(name, np.array(corners), fan, reflectance=exact.rgb(reflectance))


def tent() -> Scene:
    """A tent of single sheets on a lawn at night, open at one end, a lantern in it, a glowing stove before it."""
    ridge, half, deep = 1.9, 1.4, 2.6
    cloth = (0.75, 0.55, 0.2)
    meshes = [
        exact.rectangle("Lawn", (-6.0, -6.0, 0.0), (12.0, 0.0, 0.0), (0.0, 12.0, 0.0), reflectance=LAWN),
        sheet("Left", (-half, 0, 0), (-half, deep, 0), (0, deep, ridge), (0, 0, ridge), reflectance=cloth),
        sheet("Right", (half, deep, 0), (half, 0, 0), (0, 0, ridge), (0, deep, ridge), reflectance=cloth),
        sheet("End", (half, deep, 0), (-half, deep, 0), (0, deep, ridge), reflectance=cloth),
        sheet("Flap 1", (-half, 0, 0), (-0.6, -0.25, 0), (0, 0, ridge), reflectance=RED),
        sheet("Flap 2", (half, 0, 0), (0, 0, ridge), (0.6, -0.25, 0), reflectance=RED),
        cylinder("Pole 1", (0.0, 0.05, 0.0), 0.02, ridge - 0.02, segments=10, reflectance=WOOD),
        cylinder("Pole 2", (0.0, deep - 0.05, 0.0), 0.02, ridge - 0.02, segments=10, reflectance=WOOD),
        block("Mat 1", (-1.1, 0.5, 0.0), (0.7, 1.9, 0.04), reflectance=BLUE),
        block("Mat 2", (0.4, 0.5, 0.0), (0.7, 1.9, 0.04), reflectance=GREEN),
        lumpy_ball("Pack", (0.0, 2.2, 0.25), 0.25, 0.4, 3, WARM),
        globe("Lantern", (0.0, 1.2, 1.4), 0.06, 2.0),
        cylinder("Stove", (-0.4, -1.6, 0.0), 0.12, 0.2, segments=24, reflectance=DARK),
        ball("Fire", (-0.4, -1.6, 0.26), 0.05, levels=2, reflectance=0.0, emission=(40.0, 15.0, 4.0)),
        block("Box", (0.6, -1.7, 0.0), (0.5, 0.35, 0.3), degrees=25.0, reflectance=WOOD),
    ]
    return Scene(tuple(meshes), np.array([0.002, 0.003, 0.006]))


def greenhouse() -> Scene:
    """A greenhouse of thin white bars without panes under a bright sky, with raised beds, pots and plants."""
    wide, deep, eaves, ridge, bar = 3.0, 5.0, 1.8, 2.7, 0.03
    meshes = [
        exact.rectangle("Ground", (-8.0, -8.0, 0.0), (19.0, 0.0, 0.0), (0.0, 21.0, 0.0), reflectance=LAWN),
        block("Base", (0.0, 0.0, 0.0), (0.1, deep, 0.5), reflectance=RED),
        block("Base 2", (wide - 0.1, 0.0, 0.0), (0.1, deep, 0.5), reflectance=RED),
        block("Ridge", (wide / 2 - bar, 0.0, ridge), (2 * bar, deep, 2 * bar), reflectance=BRIGHT),
        block("Eaves 1", (0.0, 0.0, eaves), (bar, deep, bar), reflectance=BRIGHT),
        block("Eaves 2", (wide - bar, 0.0, eaves), (bar, deep, bar), reflectance=BRIGHT),
    ]
    slope = math.degrees(math.atan2(ridge - eaves, wide / 2))
    long = math.hypot(ridge - eaves, wide / 2)
    for k in range(9):
        y = (deep - bar) / 8 * k
        for side, x in enumerate((0.03, wide - 0.03 - bar)):
            meshes.append(block(f"Post {side + 1} {k + 1}", (x, y, 0.5), (bar, bar, eaves - 0.5), reflectance=BRIGHT))
        rafter = block("Rafter", (0.0, y, eaves), (long, bar, bar), reflectance=BRIGHT)
        for side, (tilt, x) in enumerate(((-slope, 0.0), (slope + 180.0, wide))):
            turned_bar = turned(rafter, "y", tilt, (0.0, 0.0, eaves))
            moved = turned_bar.vertices + [x, 0.0, 0.03]
            meshes.append(
                surface_mesh(f"Rafter {side + 1} {k + 1}", moved, rafter.triangles, reflectance=exact.rgb(BRIGHT))
            )
    for k, x in enumerate((0.25, 1.95)):
        meshes.append(block(f"Bed {k + 1}", (x, 0.4, 0.0), (0.8, 4.2, 0.35), reflectance=WOOD))
        for m in range(5):
            where = (x + 0.4, 0.8 + 0.8 * m, 0.35)
            meshes.append(cylinder(f"Pot {k + 1} {m + 1}", where, 0.12, 0.2, segments=20, reflectance=WARM))
            top = (where[0], where[1], 0.72)
            meshes.append(lumpy_ball(f"Plant {k + 1} {m + 1}", top, 0.2, 0.5, 3, GREEN, seed=5 * k + m))
    return Scene(tuple(meshes), np.array([1.4, 1.7, 2.2]))


def curtain(
    name: str, start: Floats, end: Floats, height: float, folds: int, reflectance: tuple[float, ...]
) -> SurfaceMesh:
    """Return a hanging sheet in folds, smooth-shaded."""
    steps = 8 * folds
    t = np.arange(steps + 1) / steps
    along = end - start
    aside = np.array([-along[1], along[0], 0.0]) / np.linalg.norm(along)
    wave = 0.08 * np.sin(2.0 * np.pi * folds * t)
    foot = start + t[:, None] * along + wave[:, None] * aside
    slope = 0.16 * np.pi * folds * np.cos(2.0 * np.pi * folds * t) / np.linalg.norm(along)
    normals = aside - slope[:, None] * along / np.linalg.norm(along)
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    vertices = np.concatenate([foot, foot + [0.0, 0.0, height]])
    i, n = np.arange(steps), steps + 1
    # Of the two ways round, the one whose front is on the side of the normals.
    triangles = np.stack([i, i + n + 1, i + 1, i, i + n, i + n + 1], axis=1).reshape(-1, 3)
    a, b, c = (vertices[triangles[:, k]] for k in range(3))
    if np.cross(b - a, c - a)[0] @ normals[0] < 0.0:
        triangles = triangles[:, ::-1]
    return smooth(name, vertices, triangles, np.concatenate([normals, normals]), reflectance)


def theatre() -> Scene:
    """A small theatre: a stage with curtains in folds, lamps of three colours over it, rows of seats in the dark."""
    meshes = list(room_walls((8.0, 12.0, 5.0), (DARK, (0.3, 0.3, 0.3), (0.45, 0.1, 0.1), (0.45, 0.1, 0.1), DARK, GREY)))
    meshes += [
        block("Stage", (0.0, 8.0, 0.0), (8.0, 4.0, 0.9), reflectance=WOOD),
        block("Arch 1", (0.0, 8.0, 0.9), (0.8, 0.3, 4.1), reflectance=WARM),
        block("Arch 2", (7.2, 8.0, 0.9), (0.8, 0.3, 4.1), reflectance=WARM),
        block("Arch 3", (0.8, 8.0, 3.9), (6.4, 0.3, 1.1), reflectance=WARM),
        curtain("Curtain 1", np.array([0.8, 8.5, 0.9]), np.array([2.6, 8.5, 0.9]), 3.2, 9, RED),
        curtain("Curtain 2", np.array([5.6, 8.5, 0.9]), np.array([7.2, 8.5, 0.9]), 3.2, 8, RED),
        curtain("Backdrop", np.array([0.4, 11.7, 0.9]), np.array([7.6, 11.7, 0.9]), 3.6, 14, BLUE),
        block("Throne", (3.5, 10.2, 0.9), (0.8, 0.7, 0.5), reflectance=WOOD),
        block("Throne Back", (3.5, 10.8, 1.4), (0.8, 0.1, 0.9), reflectance=WOOD),
        cylinder("Column", (5.2, 9.8, 0.9), 0.2, 2.2, segments=32, reflectance=BRIGHT),
    ]
    colours = ((30.0, 4.0, 3.0), (26.0, 24.0, 18.0), (3.0, 6.0, 32.0))
    for k, colour in enumerate(colours):
        meshes.append(panel(f"Stage Lamp {k + 1}", (1.8 + 1.9 * k, 8.8, 4.4), (0.5, 0.3), 3.0 * np.array(colour)))
    for row in range(4):
        meshes.append(
            block(f"Step {row + 1}", (0.6, 0.0, 0.0), (6.8, 4.8 - 1.2 * row, 0.2 + 0.2 * row), reflectance=GREY)
        )
        for k in range(7):
            x, y, z = 0.9 + 0.9 * k, 3.9 - 1.2 * row, 0.2 + 0.2 * row
            meshes.append(block(f"Seat {row + 1} {k + 1}", (x, y, z), (0.55, 0.5, 0.42), reflectance=RED))
            meshes.append(block(f"Rest {row + 1} {k + 1}", (x, y - 0.08, z), (0.55, 0.08, 0.9), reflectance=RED))
    return Scene(tuple(meshes), DARKNESS)


def street() -> Scene:
    """A street at dusk: a house with a lit window and a sign of many colours, a parked car, two street lamps."""
    meshes = [
        exact.rectangle("Road", (-10.0, -8.0, 0.0), (20.0, 0.0, 0.0), (0.0, 8.0, 0.0), reflectance=(0.12, 0.12, 0.13)),
        block("Pavement", (-10.0, 0.0, -0.1), (20.0, 2.5, 0.22), reflectance=GREY),
        block("House", (-6.0, 2.5, 0.0), (12.0, 5.0, 6.0), reflectance=(0.6, 0.45, 0.35)),
        block("Sill", (-1.1, 2.35, 1.0), (2.2, 0.15, 0.06), reflectance=BRIGHT),
        block("Door", (2.2, 2.46, 0.12), (1.0, 0.04, 2.1), reflectance=BLUE),
        block("Awning", (-1.4, 1.6, 2.5), (2.8, 0.9, 0.04), reflectance=GREEN),
        block("Body", (-2.2, -1.9, 0.28), (4.2, 1.7, 0.55), reflectance=RED),
        block("Cabin", (-1.3, -1.8, 0.83), (2.2, 1.5, 0.5), reflectance=DARK),
        block("Bin", (4.2, 1.6, 0.12), (0.5, 0.5, 0.9), degrees=20.0, reflectance=GREEN),
    ]
    window = exact.rectangle("Window", (-1.0, 2.49, 1.1), (2.0, 0.0, 0.0), (0.0, 0.0, 1.2), emission=(3.0, 2.4, 1.4))
    meshes.append(window)
    cells = 12
    x = np.linspace(-0.9, 0.9, cells + 1)
    points = np.concatenate(
        [np.stack([x, np.full(cells + 1, 2.44), np.full(cells + 1, z)], axis=1) for z in (2.8, 3.2)]
    )
    i = np.arange(cells)
    triangles = np.stack([i, i + 1, i + cells + 2, i, i + cells + 2, i + cells + 1], axis=1).reshape(-1, 3)
    hue = 2.0 * np.pi * np.repeat(i, 2) / cells
    colour = 6.0 * (1.0 + np.cos(hue[:, None] - 2.0 * np.pi * np.arange(3) / 3.0))
    meshes.append(surface_mesh("Sign", points, triangles, reflectance=np.zeros(3), emission=colour))
    for k, (wx, wy) in enumerate(((-1.5, -1.95), (1.2, -1.95), (-1.5, -0.4), (1.2, -0.4))):
        wheel = turned(
            cylinder("Wheel", (0.0, 0.0, 0.0), 0.3, 0.2, segments=20, reflectance=DARK), "x", 90.0, (0, 0, 0)
        )
        at = np.array([wx, wy + 0.2, 0.3])
        meshes.append(surface_mesh(f"Wheel {k + 1}", wheel.vertices + at, wheel.triangles, reflectance=exact.rgb(DARK)))
    for k, lx in enumerate((-5.0, 5.0)):
        meshes.append(cylinder(f"Post {k + 1}", (lx, 0.6, 0.12), 0.06, 4.0, segments=16, reflectance=DARK))
        meshes.append(block(f"Arm {k + 1}", (lx - 0.04, -0.9, 4.12), (0.08, 1.56, 0.08), reflectance=DARK))
        meshes.append(panel(f"Street Lamp {k + 1}", (lx - 0.15, -0.9, 4.05), (0.3, 0.5), 4.0 * np.array(LAMP)))
    return Scene(tuple(meshes), np.array([0.03, 0.045, 0.08]))
