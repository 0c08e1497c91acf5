# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""How a bake tells where it is, and how it is asked to stop."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass


@dataclass(frozen=True)
class Progress:
    """One message from a running bake.

    Attributes
    ----------
    stage : str
        What is being done, in words for the status bar ("Form factors", "Solving", "Gathering").
    share : float
        Share of the whole bake that is done, 0 to 1; never decreases.
    detail : str
        Counts that belong to the stage ("1,240 patches, 317,440 rays").
    """

    stage: str
    share: float
    detail: str = ""


ProgressCallback = Callable[[Progress], None]
"""Called between batches of rays, from the thread that called `bake`; raises `Cancelled` to stop the bake."""


def no_progress(message: Progress) -> None:
    """Take the message and go on."""
