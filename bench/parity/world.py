# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Light from outside of the scene."""

from __future__ import annotations

from typing import Any

from . import stage
from .cases import case


@case("Constant world")
def world_constant() -> list[Any]:
    """A blue sky without a texture over an open scene."""
    floor = stage.room()
    stage.world((0.4, 0.6, 1.0), 1.5)
    return [floor]
