# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""What the rays of the gather met, kept in the tables that it was found in, however receivers are put together."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .scene import Ints


@dataclass(frozen=True, eq=False)
class MetPlaces:
    """The place that each ray of receivers met.

    It is most of what a bake holds in memory. So no table is copied when receivers are added or left out, and receivers
    name their rows instead.

    Attributes
    ----------
    tables : tuple of (k, rays) int32
    row : (n,) int
        Of each receiver, counted through all tables.
    rays : int
        Of each receiver; 0 where the places of some are not kept, and there are no tables.
    channels : int
        1, or 3 where a third of the rays is for each.
    """

    tables: tuple[NDArray[np.int32], ...]
    row: Ints
    rays: int
    channels: int = 1

    @staticmethod
    def of(table: NDArray[np.int32], channels: int = 1) -> MetPlaces:
        """The places of receivers (n, rays), row by row."""
        return MetPlaces((table,), np.arange(len(table)), table.shape[1], channels)

    def __len__(self) -> int:
        return len(self.row)

    def joined(self, others: MetPlaces) -> MetPlaces:
        """Those of these receivers, then those of others."""
        rays = min(self.rays, others.rays)
        counted_on = others.row + sum(len(table) for table in self.tables)
        tables = self.tables + others.tables if rays else ()
        return MetPlaces(tables, np.concatenate([self.row, counted_on]), rays, max(self.channels, others.channels))

    def taken(self, which: Ints) -> MetPlaces:
        """Those of some of the receivers."""
        return MetPlaces(self.tables, self.row[which], self.rays, self.channels)

    def with_more(self, taken: Ints, more: MetPlaces, rows: Ints) -> MetPlaces:
        """Those of `taken`, of which `rows` are replaced by `more`."""
        which = taken.copy()
        which[rows] = len(self) + np.arange(len(more))
        return self.joined(more).taken(which)

    def between(self, first: int, last: int) -> NDArray[np.int32]:
        """Those of the receivers from `first` up to `last`, (last - first, rays)."""
        row = self.row[first:last]
        found = np.empty((len(row), self.rays), dtype=np.int32)
        ends = np.cumsum([len(table) for table in self.tables])
        among = np.searchsorted(ends, row, side="right")
        for k in np.flatnonzero(np.bincount(among)) if self.tables else ():
            here = np.flatnonzero(among == k)
            found[here] = self.tables[k].take(row[here] - (ends[k] - len(self.tables[k])), axis=0)
        return found
