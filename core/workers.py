# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Threads that share out array work and rays in batches."""

from __future__ import annotations

import os
from collections.abc import Callable
from concurrent.futures import Future, ThreadPoolExecutor, wait
from typing import TypeVar

Result = TypeVar("Result")

RAYS_PER_BATCH = 32768
"""Rays handed to the ray library at once: short enough (about 10 ms) to report and to stop, long enough to be fast."""

FEWEST_RAYS_PER_BATCH = 8192

BATCHES_OF_SHORT_WORK = 8
"""Batches that little work is cut into, so that no thread waits long for the last."""

BATCHES_IN_FLIGHT = 4
"""Batches queued for each thread, so that none idles while the main one reports."""


class Workers:
    """A pool of threads.

    Parameters
    ----------
    threads : int
        0 takes every core.
    """

    def __init__(self, threads: int = 0) -> None:
        self.threads = threads or os.cpu_count() or 1
        self._pool = ThreadPoolExecutor(self.threads)

    def close(self) -> None:
        """End the threads."""
        self._pool.shutdown()

    def map(
        self,
        work: Callable[[int, int], Result],
        count: int,
        rays_each: int,
        report: Callable[[float], None] = lambda share: None,
    ) -> list[Result]:
        """Call `work(first, last)` over `count` items in batches, on all threads; results in order.

        The batches depend on the numbers alone, not on the threads, so neither does the result. `report` is called
        with the share done from the calling thread between batches, and may raise to stop.
        """
        rays = min(RAYS_PER_BATCH, max(FEWEST_RAYS_PER_BATCH, count * rays_each // BATCHES_OF_SHORT_WORK))
        size = max(1, rays // max(1, rays_each))
        starts = range(0, count, size)
        if len(starts) < 2:
            return [work(0, count) for _ in starts]
        results: list[Result] = []
        waiting: list[Future[Result]] = []
        try:
            for start in starts:
                waiting.append(self._pool.submit(work, start, min(start + size, count)))
                if len(waiting) >= BATCHES_IN_FLIGHT * self.threads:
                    results.append(waiting.pop(0).result())
                    report(len(results) / len(starts))
            while waiting:
                results.append(waiting.pop(0).result())
                report(len(results) / len(starts))
        except BaseException:
            for future in waiting:
                future.cancel()
            wait(waiting)
            raise
        return results
