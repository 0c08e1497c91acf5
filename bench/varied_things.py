# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Rooms whose things are hard: thin, touching, tilted, curved, chequered, small; for `bench/varied_scenes.py`."""

from __future__ import annotations

import math

import numpy as np
from radiosity_bake.core.scene import Scene

from tests.scenes import exact

from .scenes import COOL, DARKNESS, LAMP, WARM, WHITE, ball, block, cylinder, panel, room_walls, table
from .shapes import (
    BLUE,
    BRIGHT,
    DARK,
    GREEN,
    RED,
    WALLS,
    WOOD,
    chequered_sheet,
    lumpy_ball,
    prism,
    scaled,
    torus,
    turned,
)


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
