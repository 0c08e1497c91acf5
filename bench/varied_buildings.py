# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Buildings within and without, for `bench/varied_scenes.py`."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
from radiosity_bake.core.scene import Scene

from tests.scenes import exact

from .scenes import (
    COOL,
    DARKNESS,
    GREY,
    LAMP,
    WARM,
    WHITE,
    ball,
    block,
    cylinder,
    panel,
    room_walls,
    smooth,
    table,
    vertex_normals,
)
from .shapes import BLUE, BRIGHT, DARK, GREEN, RED, WALLS, WOOD, globe, inside_out, lumpy_ball, pipe, prism, turned


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
