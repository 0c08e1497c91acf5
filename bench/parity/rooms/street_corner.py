# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""A street corner under a sky."""

from __future__ import annotations

import math
from typing import Any

from .. import stage
from . import parts


def build() -> None:
    """Two houses with windows from array modifiers, kerbs, trees, cars and street lamps; sky and a low sun."""
    stage.grid("Road", 40.0, 40.0, 10, parts.principled("Asphalt", (0.09, 0.09, 0.10)))
    paving = parts.principled("Paving", (0.36, 0.34, 0.31))
    stage.box("Pavement", (-20.0, 4.0, 0.0), (-4.0, 20.0, 0.14), paving)
    stage.box("Pavement Opposite", (4.0, 4.0, 0.0), (20.0, 20.0, 0.14), paving)
    _house("Corner House", (-16.0, 7.0), (10.0, 9.0), 4, parts.principled("Yellow Plaster", (0.62, 0.45, 0.22)))
    _house("Brick House", (6.5, 7.0), (11.0, 8.0), 3, parts.principled("Brick", (0.38, 0.14, 0.09)))
    for k, (x, y) in enumerate(((-5.0, 5.2), (5.2, 5.4), (-10.5, 5.2), (11.0, 5.4))):
        _tree(f"Tree {k + 1}", (x, y))
    colours = ((0.45, 0.04, 0.03), (0.05, 0.12, 0.35), (0.55, 0.55, 0.55))
    for k, (place, colour) in enumerate(zip(((-8.0, 2.4), (9.0, 2.5), (-1.6, 10.0)), colours, strict=True)):
        _car(f"Car {k + 1}", place, k == 2, parts.principled(f"Car Paint {k + 1}", colour))
    steel = parts.principled("Steel", (0.25, 0.25, 0.26))
    for k, x in enumerate((-4.4, 4.5)):
        parts.cylinder(f"Street Lamp Post {k + 1}", 0.06, 5.0, steel, (x, 4.4, 0.14), 12)
        stage.box(f"Street Lamp {k + 1}", (x - 0.1, 3.6, 5.0), (x + 0.1, 4.5, 5.1), steel)
    stage.lamp("SUN", turn=(math.radians(52), 0.0, math.radians(35)), angle=0.00918, energy=3.5, color=(1.0, 0.9, 0.75))
    parts.sky(math.radians(38), math.radians(145), 0.1)
    stage.camera((3.0, -11.0, 2.6), (-1.5, 8.0, 2.6), 24.0)


def _house(name: str, corner: tuple[float, float], size: tuple[float, float], floors: int, walls: Any) -> None:
    (x, y), (width, depth), height = corner, size, 3.0 * floors
    dark, trim = parts.principled("Panes", (0.03, 0.04, 0.05)), parts.principled("Trim", (0.7, 0.68, 0.62))
    stage.box(name, (x, y, 0.14), (x + width, y + depth, height), walls)
    stage.box(f"{name} Cornice", (x - 0.25, y - 0.25, height), (x + width + 0.25, y + depth + 0.25, height + 0.3), trim)
    count = int(width // 2)
    for part, material, low, high in (
        ("Panes", dark, (x + 0.5, y - 0.02, 1.2), (x + 1.4, y + 0.02, 2.7)),
        ("Sills", trim, (x + 0.4, y - 0.18, 1.1), (x + 1.5, y - 0.001, 1.2)),
    ):
        thing = stage.box(f"{name} {part}", low, high, material)
        for axis, (number, step) in enumerate(((count, (2.0, 0.0, 0.0)), (floors, (0.0, 0.0, 3.0)))):
            array = thing.modifiers.new(f"Array {axis}", "ARRAY")
            array.count, array.use_relative_offset, array.use_constant_offset = number, False, True
            array.constant_offset_displace = step


def _tree(name: str, place: tuple[float, float]) -> None:
    parts.cylinder(f"{name} Trunk", 0.14, 2.0, parts.principled("Bark", (0.12, 0.08, 0.05)), (*place, 0.14), 10, 0.1)
    crown = parts.ball(f"{name} Crown", 1.3, parts.principled("Leaves", (0.08, 0.2, 0.05)), (*place, 3.1), 2, False)
    crown.scale = (1.0, 1.0, 1.25)


def _car(name: str, place: tuple[float, float], turned: bool, paint: Any) -> None:
    tyre = parts.principled("Tyre", (0.03, 0.03, 0.03))
    body = stage.box(f"{name} Body", (-2.0, -0.8, 0.3), (2.0, 0.8, 0.85), paint)
    cabin = stage.box(
        f"{name} Cabin", (-1.0, -0.7, 0.85), (1.1, 0.7, 1.4), parts.principled("Car Glass", (0.05, 0.06, 0.07))
    )
    parts.rounded(body, 0.12, 3)
    parts.rounded(cabin, 0.15, 3)
    wheels = []
    for k, (x, y) in enumerate(((-1.3, -0.8), (1.3, -0.8), (-1.3, 0.6), (1.3, 0.6))):
        wheel = parts.cylinder(f"{name} Wheel {k + 1}", 0.33, 0.2, tyre, (x, y + 0.2, 0.33), 16)
        wheel.rotation_euler.x = math.pi / 2.0
        wheels.append(wheel)
    parent = stage.add(name, None, (*place, 0.0), (0.0, 0.0, math.pi / 2.0 if turned else 0.0))
    for thing in (body, cabin, *wheels):
        thing.parent = parent
