# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Time, or vertices, at equal error: on straight lines between neighbouring settings, both scales logarithmic."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass
from itertools import pairwise

# Beyond its best setting a program is granted that its error falls as one over the square root of its time, as that of
# any sampling does, or as one over its vertices, as that of linear interpolation does where all is smooth; where
# shadows have borders it falls more slowly, and the cost given is too small.
BY_TIME = -0.5
BY_VERTICES = -1.0


@dataclass(frozen=True)
class AtError:
    """What an error costs.

    Attributes
    ----------
    cost : float
    kind : str
        `"between"` two settings; `"beyond"` the best one, by the slope granted; `"below"` the cheapest one, whose cost
        this is.
    """

    cost: float
    kind: str


def improving(points: Iterable[tuple[float, float]]) -> list[tuple[float, float]]:
    """Return the (cost, error) pairs that no cheaper one beats, cheapest first."""
    best: list[tuple[float, float]] = []
    for cost, error in sorted(points):
        if error > 0.0 and (not best or error < best[-1][1]):
            best.append((cost, error))
    return best


def cost_at(points: Iterable[tuple[float, float]], error: float, slope: float = BY_TIME) -> AtError | None:
    """Return what `error` costs a program whose settings have these (cost, error); None without settings.

    Parameters
    ----------
    slope : float
        Power of the cost by which the error is granted to fall beyond the best setting.
    """
    steps = improving(points)
    if not steps:
        return None
    if error >= steps[0][1]:
        return AtError(steps[0][0], "below")
    for (cost_a, error_a), (cost_b, error_b) in pairwise(steps):
        if error_b <= error <= error_a:
            share = math.log(error / error_a) / math.log(error_b / error_a)
            return AtError(cost_a * (cost_b / cost_a) ** share, "between")
    cost, last = steps[-1]
    return AtError(cost * (error / last) ** (1.0 / slope), "beyond")
