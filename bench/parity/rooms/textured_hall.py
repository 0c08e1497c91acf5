# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""A hall with textured walls."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from .. import stage
from . import parts

HALF_WIDTH, HALF_LENGTH, HEIGHT = 3.0, 6.0, 4.0


def build() -> None:
    """Bricks, tiles and a painted frieze as pictures on UV maps, columns, and panels in the ceiling as lamps."""
    tiles = parts.textured("Tiles", parts.image("Tiles", 128, _tiles), 6.0)
    bricks = parts.textured("Bricks", parts.image("Bricks", 256, _bricks), 3.0)
    frieze = parts.textured("Frieze", parts.image("Frieze", 256, _frieze))
    width, length = 2.0 * HALF_WIDTH, 2.0 * HALF_LENGTH
    stage.grid("Floor", width, length, 12, tiles)
    quarter, up = math.pi / 2.0, HEIGHT / 2.0
    stage.grid("Left Wall", length, HEIGHT, 8, bricks, location=(-HALF_WIDTH, 0, up), rotation=(quarter, 0, quarter))
    stage.grid("Right Wall", length, HEIGHT, 8, bricks, location=(HALF_WIDTH, 0, up), rotation=(quarter, 0, -quarter))
    stage.grid("End Wall", width, HEIGHT, 8, frieze, location=(0, HALF_LENGTH, up), rotation=(quarter, 0, 0))
    stage.grid(
        "Entrance Wall", width, HEIGHT, 8, bricks, location=(0, -HALF_LENGTH, up), rotation=(quarter, 0, 2 * quarter)
    )
    plaster = parts.principled("Ceiling Paint", (0.8, 0.8, 0.78))
    stage.grid("Ceiling", width, length, 6, plaster, location=(0, 0, HEIGHT), rotation=(math.pi, 0, 0))
    stone = parts.principled("Stone", (0.55, 0.52, 0.46))
    for k in range(8):
        place = (1.9 * (-1) ** k, -4.5 + 3.0 * (k // 2), 0.0)
        parts.cylinder(f"Column {k + 1}", 0.22, HEIGHT - 0.4, stone, (place[0], place[1], 0.2))
        for part, z in (("Base", 0.0), ("Capital", HEIGHT - 0.2)):
            low, high = (place[0] - 0.3, place[1] - 0.3, z), (place[0] + 0.3, place[1] + 0.3, z + 0.2)
            stage.box(f"Column {k + 1} {part}", low, high, stone)
    for k, y in enumerate((-3.0, 0.0, 3.0)):
        lamp = stage.lamp("AREA", place=(0.0, y, HEIGHT - 0.03), shape="RECTANGLE", size=1.6, size_y=0.5, energy=120.0)
        lamp.name = f"Panel {k + 1}"
    stage.camera((0.3, -5.6, 1.7), (-0.2, 3.0, 1.7), 20.0)


def _tiles(u: Any, v: Any) -> Any:
    """Black and white, with grout."""
    dark = ((u > 0.5) ^ (v > 0.5))[..., None]
    grout = (np.minimum(u % 0.5, v % 0.5) < 0.015)[..., None]
    return np.where(grout, 0.45, np.where(dark, (0.16, 0.15, 0.17), (0.86, 0.84, 0.78)))


def _bricks(u: Any, v: Any) -> Any:
    """Rows of bricks of slightly different reds."""
    row = np.floor(v * 12)
    along = u * 5 + 0.5 * (row % 2)
    shade = 0.75 + 0.25 * np.sin(12.9898 * np.floor(along) + 78.233 * row)
    mortar = ((along % 1.0) < 0.05) | ((v * 12 % 1.0) < 0.12)
    red = shade[..., None] * np.array((0.72, 0.36, 0.27))
    return np.where(mortar[..., None], (0.70, 0.68, 0.64), red)


def _frieze(u: Any, v: Any) -> Any:
    """A blue wall below a golden wave."""
    wave = 0.6 + 0.1 * np.sin(6.0 * np.pi * u)
    blue, gold, cream = (0.15, 0.30, 0.62), (0.85, 0.62, 0.15), (0.9, 0.87, 0.78)
    near = (np.abs(v - wave) < 0.04)[..., None]
    return np.where(near, gold, np.where((v < wave)[..., None], blue, cream))
