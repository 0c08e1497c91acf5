# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""What surfaces make of the light that reaches them, seen by what they give to others."""

from __future__ import annotations

from typing import Any

from . import stage
from .cases import case


@case("Closed room with coloured walls")
def closed_room() -> list[Any]:
    """Many bounces of coloured light."""
    floor = stage.closed_room()
    stage.lamp("AREA", place=(0.0, 0.0, 2.38), shape="SQUARE", size=0.6, energy=40.0)
    return [floor]


@case("Closed room with coloured walls, the light that leaves the floor", quantity="Radiosity")
def closed_room_radiosity() -> list[Any]:
    """The other attribute: reflected and emitted light."""
    floor = stage.closed_room()
    stage.lamp("AREA", place=(0.0, 0.0, 2.38), shape="SQUARE", size=0.6, energy=40.0)
    return [floor]
