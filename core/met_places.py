# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""What the rays of the gather met, kept in the tables that it was found in, however receivers are put together."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .aimed_light import AimedLight
from .sampling import Singles
from .scene import Floats, Ints


@dataclass(frozen=True, eq=False)
class MetTable:
    """What the rays of k receivers met.

    Attributes
    ----------
    places : (k, rays) int32
        Place that each ray of the hemisphere met.
    aimed : AimedLight
        Of the bright places, which are dark in the table.
    """

    places: NDArray[np.int32]
    aimed: AimedLight

    @staticmethod
    def of(places: NDArray[np.int32]) -> MetTable:
        """Where no rays were aimed."""
        return MetTable(places, AimedLight.none(len(places)))

    def __len__(self) -> int:
        return len(self.places)

    def bytes(self) -> int:
        """What it takes in memory."""
        return self.places.nbytes + self.aimed.bytes()


@dataclass(frozen=True, eq=False)
class MetPlaces:
    """The place that each ray of receivers met.

    It is most of what a bake holds in memory. So no table is copied when receivers are added or left out, and receivers
    name their rows instead: one, or several with weights where the light is that of others, interpolated.

    Attributes
    ----------
    tables : tuple of MetTable
    rows : (n, r) int
        Of each receiver, counted through all tables.
    weights : (n, r) float32
        Of these rows; 0 where there are fewer.
    rays : int
        Of each row; 0 where the places of some are not kept, and there are no tables.
    channels : int
        1, or 3 where a third of the rays is for each.
    """

    tables: tuple[MetTable, ...]
    rows: Ints
    weights: Singles
    rays: int
    channels: int = 1

    @staticmethod
    def of(table: MetTable, channels: int = 1) -> MetPlaces:
        """The places of receivers, row by row."""
        return MetPlaces.of_rows((table,), np.arange(len(table)), table.places.shape[1], channels)

    @staticmethod
    def of_rows(tables: tuple[MetTable, ...], row: Ints, rays: int, channels: int = 1) -> MetPlaces:
        """The places of receivers that have one row (n,) each."""
        return MetPlaces(tables, row[:, None], np.ones((len(row), 1), dtype=np.float32), rays, channels)

    def __len__(self) -> int:
        return len(self.rows)

    def joined(self, others: MetPlaces) -> MetPlaces:
        """Those of these receivers, then those of others, with each table once."""
        rays = min(self.rays, others.rays)
        tables = {id(table): table for table in self.tables + others.tables}.values()
        begin = dict(zip(map(id, tables), _begins(tuple(tables)), strict=True))
        # Each of theirs moves to where the same table is now.
        moved = np.array([begin[id(table)] for table in others.tables], dtype=np.int64) - _begins(others.tables)
        theirs = others.rows
        if moved.any():
            theirs = theirs + moved[np.searchsorted(_begins(others.tables), theirs, side="right") - 1]
        wide = max(self.rows.shape[1], others.rows.shape[1])
        rows = np.concatenate([_widened(self.rows, wide), _widened(theirs, wide)])
        weights = np.concatenate([_widened(self.weights, wide, 0.0), _widened(others.weights, wide, 0.0)])
        return MetPlaces(tuple(tables) if rays else (), rows, weights, rays, max(self.channels, others.channels))

    def taken(self, which: Ints) -> MetPlaces:
        """Those of some of the receivers."""
        return MetPlaces(self.tables, self.rows[which], self.weights[which], self.rays, self.channels)

    def with_more(self, taken: Ints, more: MetPlaces, rows: Ints) -> MetPlaces:
        """Those of `taken`, of which `rows` are replaced by `more`."""
        which = taken.copy()
        which[rows] = len(self) + np.arange(len(more))
        return self.joined(more).taken(which)

    def mixed(self, parents: Ints, weights: Floats | Singles) -> MetPlaces:
        """Those of new receivers that have the light of some of these, (m, k), with weights (m, k)."""
        flat = (len(parents), parents.shape[1] * self.rows.shape[1])
        share = self.weights[parents] * weights.astype(np.float32)[:, :, None]
        rows, share = _merged(self.rows[parents].reshape(flat), share.reshape(flat))
        return MetPlaces(self.tables, rows, share, self.rays, self.channels)

    def named(self) -> Ints:
        """The rows that some receiver names, ascending."""
        return np.unique(self.rows[self.weights != 0.0])

    def places(self, rows: Ints) -> NDArray[np.int32]:
        """What the rays of such rows met, (m, rays)."""
        found = np.empty((len(rows), self.rays), dtype=np.int32)
        ends = np.cumsum([len(table) for table in self.tables])
        among = np.searchsorted(ends, rows, side="right")
        for k in np.flatnonzero(np.bincount(among)) if self.tables else ():
            here = np.flatnonzero(among == k)
            found[here] = self.tables[k].places.take(rows[here] - (ends[k] - len(self.tables[k])), axis=0)
        return found

    def aimed_at(self, rows: Ints, radiance: Singles) -> tuple[Floats, Floats]:
        """What rays that were aimed at bright places bring to such rows: see `AimedLight.irradiance`."""
        found = [table.aimed.irradiance(radiance) for table in self.tables]
        light, difference = (np.concatenate([part[k] for part in found]) for k in (0, 1))
        return light[rows], difference[rows]

    def places_aimed_at(self) -> NDArray[np.int32]:
        """The bright places that some row sees."""
        return np.concatenate([np.zeros(0, np.int32), *(table.aimed.places() for table in self.tables)])

    def of_receivers(self, named: Ints, values: Floats) -> Floats:
        """At receivers, (n, ...), what is known of the rows `named`, (m, ...)."""
        return weighted(self.weights, values, self._number(named))

    def errors_of_receivers(self, named: Ints, errors: Floats) -> Floats:
        """Standard error at receivers, (n,), at most, from those of the rows `named`, (m,), which may go together."""
        return weighted(np.abs(self.weights), errors, self._number(named))

    def _number(self, named: Ints) -> Ints:
        number: Ints = np.minimum(np.searchsorted(named, self.rows), max(len(named) - 1, 0))
        return number


def _begins(tables: tuple[MetTable, ...]) -> Ints:
    """The first row of each table, counted through all."""
    counts = np.array([len(table) for table in tables], dtype=np.int64)
    begins: Ints = np.cumsum(counts) - counts
    return begins


def bytes_of_tables(*places: MetPlaces) -> int:
    """What the tables of some receivers take together."""
    tables = {id(table): table for receivers in places for table in receivers.tables}
    return sum(table.bytes() for table in tables.values())


def weighted(weights: Floats | Singles, values: Floats, which: Ints) -> Floats:
    """Sums of weights (n, k) times the values (m, ...) that `which` (n, k) names, (n, ...)."""
    total: Floats = np.zeros((len(which), *values.shape[1:]))
    wide = (-1, *(1,) * (values.ndim - 1))
    for column, weight in zip(which.T, weights.T, strict=True):
        chosen = np.flatnonzero(weight)
        total[chosen] += values[column[chosen]] * weight[chosen].astype(np.float64).reshape(wide)
    return total


def _widened(values: NDArray[Any], wide: int, filling: float | None = None) -> NDArray[Any]:
    """Rows with as many columns: more of the first one, or of one number."""
    missing = wide - values.shape[1]
    if missing == 0:
        return values
    more = np.repeat(values[:, :1], missing, axis=1) if filling is None else np.full((len(values), missing), filling)
    return np.concatenate([values, more.astype(values.dtype)], axis=1)


def _merged(rows: Ints, weights: Singles) -> tuple[Ints, Singles]:
    """Rows (n, k) with weights, each named once and in order, in as few columns as all can do with."""
    order = np.argsort(rows, axis=1, kind="stable")
    rows, weights = np.take_along_axis(rows, order, axis=1), np.take_along_axis(weights, order, axis=1)
    # Of a row that is named again, all the weight goes to where it is named first.
    new = np.ones(rows.shape, dtype=bool)
    new[:, 1:] = rows[:, 1:] != rows[:, :-1]
    column = np.cumsum(new, axis=1) - 1
    wide = int(column.max(initial=0)) + 1
    merged, total = np.repeat(rows[:, :1], wide, axis=1), np.zeros((len(rows), wide), dtype=np.float32)
    receiver = np.arange(len(rows))
    for k in range(rows.shape[1]):
        merged[receiver, column[:, k]] = rows[:, k]
        total[receiver, column[:, k]] += weights[:, k]
    return merged, total
