# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Scenes as an artist would have them: a file each, whose docstring is the title and whose `build` makes the scene."""

from __future__ import annotations

import importlib
from types import ModuleType

NAMES = ("bedroom", "street_corner", "shaded_lamp", "textured_hall", "pillar_forest", "game_level")


def module_of(name: str) -> ModuleType:
    """Return the file of a room."""
    return importlib.import_module(f"{__name__}.{name}")


def title_of(name: str) -> str:
    """Return what the room is, as a sentence."""
    return (module_of(name).__doc__ or name).splitlines()[0].rstrip(".")
