# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""What rays met in the bake of the frame before: of them, only those are traced again that what moved may concern.

Rays depend on nothing but where they leave, so most of those of a frame are those of the frame before, bit by bit. What
such a ray met is what it meets now, unless that has moved, or what moved is nearer now: to tell, what moved alone is
traced, a few triangles in place of the scene. What follows from the rays is as if all had been traced.
"""

from __future__ import annotations

import threading
from collections import defaultdict
from dataclasses import dataclass
from functools import cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .sampling import Singles
from .scene import Floats, Ints

Keys = NDArray[np.uint64]

LEAST_ROW = 4
"""Rays of a row from which on finding it is less work than tracing it."""

TELLING = 4
"""Rays of a row that tell it from others, in its beginning, its middle and its end: as all of a row follow one pattern
about one place, these are alike only where all are."""

MOVED = -2
"""In place of the number of what has moved away."""

_ODD = np.uint64(0x9E3779B97F4A7C15)


@cache
def _weights(count: int) -> Keys:
    return np.random.default_rng(count).integers(0, 2**64, count, dtype=np.uint64)


def codes_of(rows: Singles) -> Keys:
    """Numbers that tell rows (n, k) apart by all their bits, (n,)."""
    words = np.ascontiguousarray(rows, dtype=np.float32).view(np.uint32).astype(np.uint64)
    # Rows that differ in few high bits, as mirrored ones do in their signs, must not come close to each other.
    words *= _ODD
    words ^= words >> np.uint64(32)
    codes: Keys = words @ _weights(words.shape[1])
    return codes


def keys_of(origins: Singles, directions: Singles, each: int) -> Keys:
    """Numbers that tell rows of so many rays apart, (n,).

    Parameters
    ----------
    origins : (n, 3) or (n * each, 3) float32
    directions : (n * each, 3) float32
    """
    rows, telling = len(directions) // each, np.linspace(0, each - 1, TELLING).astype(np.int64)
    starts = origins.reshape(rows, -1, 3)
    starts = starts[:, telling] if starts.shape[1] == each else starts
    ways = directions.reshape(rows, each, 3)[:, telling]
    return codes_of(np.concatenate([starts, ways], axis=1).reshape(rows, -1))


@dataclass(frozen=True, eq=False)
class KeptRows:
    """Rows of r rays each, and what these met.

    Attributes
    ----------
    keys : (n,) uint64, ascending
    row : (n,) int
        That has each key.
    answers : tuple of (n, ...) arrays
        Of rays to what is nearest: codes (n, r) int32, and u, v and distance (n, r) float32 there, as of `Hits`. Of
        shadow rays: whether each is clear, (n, r / 8) uint8, eight to a byte.
    """

    keys: Keys
    row: Ints
    answers: tuple[NDArray[Any], ...]

    @staticmethod
    def of(parts: list[tuple[Keys, tuple[NDArray[Any], ...]]]) -> KeptRows:
        """Rows of several batches in any order, which are taken out of the list."""
        keys = np.concatenate([keys for keys, _ in parts])
        columns = [list(column) for column in zip(*(answers for _, answers in parts), strict=True)]
        parts.clear()
        answers = []
        while columns:
            # One after the other, as there are no two copies of all of them then.
            answers.append(np.concatenate(columns.pop(0)))
        order = np.argsort(keys)
        return KeptRows(keys[order], order, tuple(answers))

    def find(self, keys: Keys) -> tuple[NDArray[np.bool_], Ints]:
        """Which of some keys there are, and the row of each, or any."""
        place = np.minimum(np.searchsorted(self.keys, keys), len(self.keys) - 1)
        known: NDArray[np.bool_] = self.keys[place] == keys
        return known, self.row[place]

    def bytes(self) -> int:
        """What it takes."""
        return self.keys.nbytes + self.row.nbytes + sum(answer.nbytes for answer in self.answers)


@dataclass(frozen=True, eq=False)
class KeptRays:
    """What the rays of a bake met, for that of the next frame.

    Attributes
    ----------
    centre : (3,) float, scene units
    extent : float, scene units
        Of the ray library's coordinates.
    seen, shadow : (t,) int
        Triangles that there were for rays, and
    seen_corners, shadow_corners : (t, 3, 3) float32
        where they were, in these coordinates.
    normals : (triangles, 3) float32 or None
        As the ray library gives them, of all triangles that some ray met; None where none lets light through.
    hits, clear : dict of KeptRows by the number of rays of each row
        Rays to what is nearest, and shadow rays.
    """

    centre: Floats
    extent: float
    seen: Ints
    seen_corners: Singles
    shadow: Ints
    shadow_corners: Singles
    normals: Singles | None
    hits: dict[int, KeptRows]
    clear: dict[int, KeptRows]

    def bytes(self) -> int:
        """What it takes."""
        corners = self.seen_corners.nbytes + self.shadow_corners.nbytes
        return corners + sum(rows.bytes() for rows in (*self.hits.values(), *self.clear.values()))


@dataclass(frozen=True, eq=False)
class Changes:
    """What became of some triangles since the bake before.

    Attributes
    ----------
    now : (before,) int
        The number of each triangle now; `MOVED` for those that are not where they were.
    gone : (g,) int
        Those, and
    came : (c,) int
        triangles where there were none.
    """

    now: Ints
    gone: Ints
    came: Ints

    @staticmethod
    def between(before: Singles, after: Singles) -> Changes:
        """Compare corners (t, 3, 3): those of triangles that did not change are equal to the last bit."""
        one, other = (codes_of(corners.reshape(len(corners), -1)) for corners in (before, after))
        order, order_after = (np.argsort(codes, kind="stable") for codes in (one, other))
        one, other = one[order], other[order_after]
        # Of several in one place the first is the first again, and so on.
        place = np.searchsorted(other, one) + np.arange(len(one)) - np.searchsorted(one, one)
        stayed = np.flatnonzero(np.append(other, np.uint64(0))[np.minimum(place, len(other))] == one)
        stayed = stayed[place[stayed] < len(other)]
        now = np.full(len(one), MOVED, dtype=np.int64)
        now[order[stayed]] = order_after[place[stayed]]
        came = np.ones(len(other), dtype=bool)
        came[now[now >= 0]] = False
        return Changes(now, np.flatnonzero(now < 0), np.flatnonzero(came))


class RowsToKeep:
    """Rows that the threads of a bake collect, up to a number of bytes: of more than these, none are kept.

    Parameters
    ----------
    most : int
        Bytes.
    """

    def __init__(self, most: int) -> None:
        self._left = most
        self._parts: dict[tuple[str, int], list[tuple[Keys, tuple[NDArray[Any], ...]]]] = defaultdict(list)
        self._adding = threading.Lock()

    @property
    def are_too_many(self) -> bool:
        """Whether there was no room for all. That does not depend on which thread was first."""
        return self._left < 0

    def add(self, kind: str, each: int, keys: Keys, *answers: NDArray[Any]) -> None:
        """Keep rows of so many rays each, as `KeptRows` holds them."""
        with self._adding:
            self._left -= keys.nbytes + sum(answer.nbytes for answer in answers)
            if self.are_too_many:
                self._parts.clear()
            else:
                self._parts[kind, each].append((keys, answers))

    def taken(self, kind: str) -> dict[int, KeptRows]:
        """All rows of a kind, which are here no more."""
        return {each: KeptRows.of(self._parts.pop((name, each))) for name, each in list(self._parts) if name == kind}
