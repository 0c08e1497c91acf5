# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""A bedroom with a window and the sun."""

from __future__ import annotations

import math

import numpy as np

from .. import stage
from . import parts


def build() -> None:
    """Walls with thickness, a window cut by a modifier, bevelled furniture, curtains without thickness, sun and sky."""
    plaster, floor = parts.principled("Plaster", (0.75, 0.72, 0.68)), parts.principled("Oak Floor", (0.38, 0.24, 0.13))
    left, right, front, back, top, thick = -2.0, 2.0, -1.8, 1.8, 2.6, 0.25
    stage.box("Floor", (left - thick, front - thick, -thick), (right + thick, back + thick, 0.0), floor)
    stage.box("Ceiling", (left - thick, front - thick, top), (right + thick, back + thick, top + thick), plaster)
    stage.box("Right Wall", (right, front - thick, 0.0), (right + thick, back + thick, top), plaster)
    stage.box("Back Wall", (left, back, 0.0), (right, back + thick, top), plaster)
    stage.box("Front Wall", (left, front - thick, 0.0), (right, front, top), plaster)
    opening = ((left - 2 * thick, -0.9, 0.85), (left + thick, 0.9, 2.15))
    ends = ((left - thick, front - thick, 0.0), (left, back + thick, top))
    parts.wall_with_opening("Window Wall", *ends, opening, plaster)
    _window(left - 0.15)
    _curtain("Curtain Near", left + 0.08, -1.25, -0.75)
    _curtain("Curtain Far", left + 0.08, 0.75, 1.25)
    _bed(parts.principled("Dark Wood", (0.13, 0.07, 0.04)))
    _night_table(parts.principled("Walnut", (0.22, 0.12, 0.06)))
    wardrobe = stage.box(
        "Wardrobe", (0.9, -1.78, 0.0), (1.97, -1.2, 2.1), parts.principled("White Paint", (0.8, 0.8, 0.78))
    )
    parts.rounded(wardrobe, 0.01)
    rug = stage.grid("Rug", 1.6, 1.4, 8, parts.principled("Rug", (0.45, 0.12, 0.10)), location=(-0.6, -0.4, 0.012))
    rug.modifiers.new("Thickness", "SOLIDIFY").thickness = 0.012
    stage.lamp("SUN", turn=(math.radians(0), math.radians(-58), math.radians(-12)), angle=0.00918, energy=4.0)
    parts.sky(math.radians(32), math.radians(90), 0.12)
    stage.camera((0.8, -1.74, 1.6), (-0.75, 0.6, 0.85), 18.0)


def _window(x: float) -> None:
    paint = parts.principled("Window Paint", (0.82, 0.82, 0.80))
    stage.box("Frame Bottom", (x, -0.9, 0.85), (x + 0.06, 0.9, 0.90), paint)
    stage.box("Frame Top", (x, -0.9, 2.10), (x + 0.06, 0.9, 2.15), paint)
    for k, y in enumerate((-0.9, -0.025, 0.85)):
        stage.box(f"Frame Post {k + 1}", (x, y, 0.90), (x + 0.06, y + 0.05, 2.10), paint)


def _curtain(name: str, x: float, near: float, far: float) -> None:
    """A sheet that waves, lit on both sides."""
    columns, rows = 24, 6
    y, z = np.linspace(near, far, columns + 1), np.linspace(0.06, 2.35, rows + 1)
    vertices = [(x + 0.035 * math.sin(40.0 * a), a, b) for b in z for a in y]
    row = columns + 1
    faces = [(a, a + 1, a + row + 1, a + row) for j in range(rows) for a in range(j * row, j * row + columns)]
    thing = stage.mesh(name, vertices, faces, parts.principled("Linen", (0.70, 0.62, 0.48)))
    thing.data.polygons.foreach_set("use_smooth", [True] * len(faces))


def _bed(wood) -> None:
    linen = parts.principled("Sheets", (0.80, 0.80, 0.82))
    parts.rounded(stage.box("Bed Frame", (-0.4, 0.0, 0.12), (1.9, 1.7, 0.34), wood), 0.02)
    parts.rounded(stage.box("Headboard", (1.9, -0.02, 0.12), (1.97, 1.72, 1.05), wood), 0.02)
    for k, (x, y) in enumerate(((-0.37, 0.03), (-0.37, 1.6), (1.8, 0.03), (1.8, 1.6))):
        stage.box(f"Bed Foot {k + 1}", (x, y, 0.0), (x + 0.07, y + 0.07, 0.12), wood)
    parts.rounded(stage.box("Mattress", (-0.35, 0.05, 0.345), (1.88, 1.65, 0.56), linen), 0.06, 3)
    cover = parts.principled("Blanket", (0.12, 0.22, 0.38))
    parts.rounded(stage.box("Blanket", (-0.38, 0.02, 0.50), (1.1, 1.68, 0.60), cover), 0.05, 3)
    for k, y in enumerate((0.42, 1.25)):
        pillow = parts.ball(f"Pillow {k + 1}", 1.0, linen, (1.55, y, 0.63), 3)
        pillow.scale = (0.24, 0.34, 0.10)


def _night_table(wood) -> None:
    parts.rounded(stage.box("Night Table", (1.5, -0.55, 0.0), (1.97, -0.12, 0.5), wood), 0.008)
    parts.cylinder("Lamp Foot", 0.06, 0.02, wood, (1.74, -0.33, 0.5))
    parts.cylinder("Lamp Stem", 0.012, 0.25, wood, (1.74, -0.33, 0.52), 12)
    stage.lamp("POINT", place=(1.74, -0.33, 0.86), shadow_soft_size=0.04, energy=4.0, color=(1.0, 0.7, 0.4))
