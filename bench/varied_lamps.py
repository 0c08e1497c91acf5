# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Rooms whose lamps are what is hard about them, for `bench/varied_scenes.py`."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from radiosity_bake.core.scene import Scene

from tests.scenes import exact

from .scenes import COOL, DARKNESS, GREY, LAMP, WARM, WHITE, ball, block, cylinder, panel, room_walls, table
from .shapes import BLUE, BRIGHT, DARK, GREEN, RED, WALLS, WOOD, globe, pipe


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
