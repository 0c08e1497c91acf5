# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Time by stage, and progress on the way."""

from __future__ import annotations

import time
from collections.abc import Callable

from .progress import Progress, ProgressCallback


class Clock:
    """Tells the caller where the bake is and remembers how long each stage took.

    Attributes
    ----------
    seconds : dict of str to float
        By stage, in snake case, with `total` once stopped.
    """

    def __init__(self, progress: ProgressCallback) -> None:
        self._progress = progress
        self._stage, self._low, self._high, self._share = "", 0.0, 0.0, 0.0
        self._begun = self._stage_begun = time.perf_counter()
        self.seconds: dict[str, float] = {}

    def start(self, stage: str, low: float, high: float) -> None:
        """Begin a stage that takes the bake from share `low` to `high`."""
        self._finish_stage()
        self._stage, self._low, self._high = stage, low, high
        self.report(0.0)

    def report(self, share: float, detail: str = "") -> None:
        """Tell the share of the stage that is done; what was told before never goes back."""
        self._share = max(self._share, self._low + (self._high - self._low) * min(share, 1.0))
        self._progress(Progress(self._stage, self._share, detail))

    def repeated(self, part: float, detail: Callable[[], str] = str) -> Callable[[float], None]:
        """A report for work that is done nobody knows how often: each time it takes `part` of what is left."""
        done = 0.0

        def report(share: float) -> None:
            nonlocal done
            left = part * (1.0 - done)
            self.report(done + left * share, detail())
            if share >= 1.0:
                done += left

        return report

    def stop(self) -> None:
        """End the last stage."""
        self._finish_stage()
        self.seconds["total"] = time.perf_counter() - self._begun
        self._progress(Progress("Done", 1.0))

    def _finish_stage(self) -> None:
        now = time.perf_counter()
        if self._stage:
            name = self._stage.lower().replace(" ", "_")
            self.seconds[name] = self.seconds.get(name, 0.0) + now - self._stage_begun
        self._stage_begun = now
