# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The whole bake from top to bottom."""

from __future__ import annotations

from .progress import ProgressCallback, no_progress
from .result import BakeResult
from .scene import Scene
from .settings import BakeSettings


def bake(scene: Scene, settings: BakeSettings, progress: ProgressCallback = no_progress) -> BakeResult:
    """Bake the light of `scene` into the meshes that ask for it.

    Raises
    ------
    BakeError
        One of its kinds, with a sentence that says what to do.
    Cancelled
        When `progress` raised it.
    """
    raise NotImplementedError
