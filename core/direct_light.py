# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Direct light before it has a colour: how much of each emitter's radiance arrives at each receiver."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .sampling import Singles
from .scene import Floats, Ints


@dataclass(frozen=True, eq=False)
class DirectLight:
    """Receivers and the emitters that they see, as sparse entries.

    Attributes
    ----------
    count : int
        Receivers, with or without entries.
    receiver, emitter : (p,) int32
        There may be several entries for a pair; all of a receiver's are in the order they were added in. Of k emitters,
        number e + (c + 1) k stands for what emitter e sends in channel c alone.
    weight : (p,) float or float32
        Irradiance over pi for a radiance of 1: form factor times visible share, over the chance to be drawn.
    """

    count: int
    receiver: NDArray[np.int32]
    emitter: NDArray[np.int32]
    weight: Floats | Singles

    @staticmethod
    def of(count: int, receiver: Ints, emitter: Ints, weight: Floats | Singles) -> DirectLight:
        """Make entries of those whose weight is not zero."""
        some = np.flatnonzero(weight)
        return DirectLight(
            count,
            receiver[some].astype(np.int32),
            emitter[some].astype(np.int32),
            weight[some],
        )

    @staticmethod
    def none(count: int) -> DirectLight:
        """Receivers that get none."""
        return DirectLight(count, np.zeros(0, np.int32), np.zeros(0, np.int32), np.zeros(0))

    @staticmethod
    def stacked(parts: list[DirectLight]) -> DirectLight:
        """Receivers below each other."""
        first = np.cumsum([0, *(part.count for part in parts)])
        moved = [
            part.renumbered(np.arange(part.count) + at, int(first[-1])) for part, at in zip(parts, first, strict=False)
        ]
        return DirectLight.joined(moved) if moved else DirectLight.none(0)

    @staticmethod
    def joined(parts: list[DirectLight]) -> DirectLight:
        """Entries of the same receivers in one."""
        return DirectLight(
            parts[0].count,
            np.concatenate([part.receiver for part in parts]),
            np.concatenate([part.emitter for part in parts]),
            np.concatenate([part.weight for part in parts]),
        )

    def renumbered(self, number: Ints, count: int) -> DirectLight:
        """Entries under another number of their receiver, (self.count,); those of number -1 are left out."""
        receiver = number[self.receiver]
        kept = np.flatnonzero(receiver >= 0)
        return DirectLight(count, receiver[kept].astype(np.int32), self.emitter[kept], self.weight[kept])

    def weighted(self, share: float | Floats) -> DirectLight:
        """The same entries, times a share that is given once or for each receiver."""
        factor = np.broadcast_to(share, self.count)[self.receiver]
        return DirectLight(self.count, self.receiver, self.emitter, self.weight * factor)

    def in_channel(self, channel: int, emitters: int) -> DirectLight:
        """The same entries, for one channel alone."""
        number = (self.emitter + (channel + 1) * emitters).astype(np.int32)
        return DirectLight(self.count, self.receiver, number, self.weight)

    def weighted_of(self, emitter: int, emitters: int, share: Floats) -> DirectLight:
        """The same entries, those of one of so many emitters times a share of each receiver, (self.count,)."""
        of_it = self.emitter % emitters == emitter
        factor = np.where(of_it, share[self.receiver], 1.0)
        return DirectLight(self.count, self.receiver, self.emitter, self.weight * factor)

    def with_more(self, taken: Ints, more: DirectLight, rows: Ints) -> DirectLight:
        """The receivers `taken`, each at most once, of which `rows` are replaced by `more`."""
        place = np.full(self.count, -1, dtype=np.int64)
        ours = np.ones(len(taken), dtype=bool)
        ours[rows] = False
        place[taken[ours]] = np.flatnonzero(ours)
        return DirectLight.joined([self.renumbered(place, len(taken)), more.renumbered(rows, len(taken))])

    def irradiance(self, radiance: Floats | Singles) -> Floats:
        """Irradiance over pi of each receiver, (count, 3), W m^-2 sr^-1.

        Parameters
        ----------
        radiance : (k, 3) float, W m^-2 sr^-1
            Of the emitters.
        """
        total = np.empty((self.count, 3))
        block, emitter = np.zeros(1, dtype=np.int32), self.emitter
        if len(emitter) and emitter.max() >= len(radiance):
            block, emitter = np.divmod(emitter, np.int32(len(radiance)))
        for channel in range(3):
            light = self.weight * np.take(radiance[:, channel], emitter)
            if len(block) == len(emitter):
                light *= (block == 0) | (block == channel + 1)
            total[:, channel] = np.bincount(self.receiver, weights=light, minlength=self.count)
        return total
