# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""What is written, and where."""

from __future__ import annotations

from typing import Any

from . import stage
from .cases import case


@case("Refined mesh, at the original's vertices", output="REFINED")
def refined_output() -> list[Any]:
    """The subdivided floor has the light of the original at its vertices."""
    floor = stage.room()
    stage.lamp("AREA", shape="SQUARE", size=0.5)
    return [floor]
