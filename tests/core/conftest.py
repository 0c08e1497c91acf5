# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Bakes that several tests look at, made once."""

from __future__ import annotations

import pytest
from radiosity_bake.core.bake import bake
from radiosity_bake.core.result import BakeResult
from radiosity_bake.core.scene import Scene
from radiosity_bake.core.settings import BakeSettings

from tests.core.building import cornell_box, room_with_block


@pytest.fixture(scope="session")
def cornell_scene() -> Scene:
    """The Cornell box, its lamp set into the ceiling."""
    return cornell_box()


@pytest.fixture(scope="session")
def cornell_draft(cornell_scene: Scene) -> BakeResult:
    return bake(cornell_scene, BakeSettings(quality="DRAFT"))


@pytest.fixture(scope="session")
def room_scene() -> Scene:
    return room_with_block()


@pytest.fixture(scope="session")
def room_draft(room_scene: Scene) -> BakeResult:
    return bake(room_scene, BakeSettings(quality="DRAFT", minimum_size=0.15))


@pytest.fixture(scope="session")
def room_original(room_scene: Scene) -> BakeResult:
    return bake(room_scene, BakeSettings(quality="DRAFT", minimum_size=0.15, output="ORIGINAL"))


@pytest.fixture(scope="session")
def room_good(room_scene: Scene) -> BakeResult:
    return bake(room_scene, BakeSettings(quality="GOOD", minimum_size=0.15))
