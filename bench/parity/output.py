# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""What is written, and where."""

from __future__ import annotations

from typing import Any

import bpy

from . import stage
from .cases import case


@case("Refined mesh, at the original's vertices", output="REFINED")
def refined_output() -> list[Any]:
    """The subdivided floor has the light of the original at its vertices."""
    floor = stage.room()
    stage.lamp("AREA", shape="SQUARE", size=0.5)
    return [floor]


def every_kind_of_light() -> list[Any]:
    """Return the floor of a room with a lamp, a panel that glows, and a world."""
    floor = stage.room()
    stage.lamp("AREA", shape="SQUARE", size=0.5, energy=5.0)
    stage.grid("Panel", 0.6, 0.6, 1, stage.glow(), location=(-0.5, 0.5, 1.3), rotation=(3.1416, 0, 0))
    stage.world((0.4, 0.6, 1.0), 0.2)
    # A rendering shows all of the light and cannot be compared.
    bpy.context.scene.camera = None
    return [floor]


@case("Direct light of a lamp, a panel and the world", light="DIRECT", output="REFINED")
def direct_only() -> list[Any]:
    """Cycles' bake with its Direct pass alone."""
    return every_kind_of_light()


@case("Indirect light of the same", light="INDIRECT", output="REFINED")
def indirect_only() -> list[Any]:
    """Cycles' bake with its Indirect pass alone."""
    return every_kind_of_light()
