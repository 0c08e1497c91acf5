# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Light of the bright places that rays are aimed at, before it has a colour."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .direct_light import DirectLight
from .sampling import Singles
from .scene import LUMINANCE, Floats


@dataclass(frozen=True, eq=False)
class AimedLight:
    """How much of the radiance of bright places arrives at receivers.

    Attributes
    ----------
    even, odd : DirectLight
        By every other ray, as their difference tells the noise. Their emitters are places.
    """

    even: DirectLight
    odd: DirectLight

    @staticmethod
    def none(count: int) -> AimedLight:
        """No light at so many receivers."""
        return AimedLight(DirectLight.none(count), DirectLight.none(count))

    @staticmethod
    def stacked(parts: list[AimedLight]) -> AimedLight:
        """Receivers below each other."""
        return AimedLight(*(DirectLight.stacked([getattr(p, half) for p in parts]) for half in ("even", "odd")))

    def weighted(self, share: Floats) -> AimedLight:
        """The same, times a share of each receiver."""
        return AimedLight(self.even.weighted(share), self.odd.weighted(share))

    def places(self) -> NDArray[np.int32]:
        """The places that light comes from."""
        return np.unique(np.concatenate([self.even.emitter, self.odd.emitter]))

    def bytes(self) -> int:
        """What it takes in memory."""
        halves = (self.even, self.odd)
        return sum(half.receiver.nbytes + half.emitter.nbytes + half.weight.nbytes for half in halves)

    def irradiance(self, radiance: Singles) -> tuple[Floats, Floats]:
        """Irradiance over pi, (n, 3), and how much more of its luminance the even rays bring than the others, (n,)."""
        if not len(self.even.emitter) and not len(self.odd.emitter):
            return np.zeros((self.even.count, 3)), np.zeros(self.even.count)
        even, odd = self.even.irradiance(radiance), self.odd.irradiance(radiance)
        return even + odd, (even - odd) @ LUMINANCE
