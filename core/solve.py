# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The energy balance: radiosity from the form factors of the rows, for three channels at once."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .scene import Floats, Ints

RESIDUAL = 1e-5
"""Relative residual to which the balance is solved: far below the noise of the form factors, and above the rounding of
single precision sums."""

RESTART = 24
"""Search directions kept before GMRES starts anew."""

MOST_ITERATIONS = 240


@dataclass(frozen=True, eq=False)
class Exchange:
    """Form factors between m elements as sparse rows.

    Attributes
    ----------
    receiver : (r,) int
        The element of each row that has entries, 0 to m - 1, each once.
    start : (r,) int
        First entry of each row.
    source : (p,) int
        Element of each entry, 0 to m - 1.
    factor : (p,) float
        Form factor from the row's element to the source.
    """

    receiver: Ints
    start: Ints
    source: Ints
    factor: NDArray[np.float32]

    def apply(self, values: Floats) -> Floats:
        """Sum over the sources of form factor times value, (m, c); in single precision, as exact as the rays are."""
        total = np.zeros_like(values)
        if len(self.start):
            # Channel by channel: taking and adding single numbers is five times faster than taking and adding rows.
            for channel in range(values.shape[1]):
                terms = np.take(values[:, channel].astype(np.float32), self.source)
                terms *= self.factor
                total[self.receiver, channel] = np.add.reduceat(terms, self.start)
        return total


@dataclass(frozen=True, eq=False)
class Translucence:
    """What elements send on of the light on their other sides.

    Attributes
    ----------
    share : (m, 3) float
    other : (m,) int
        The element on the other side; any where the share is 0.
    """

    share: Floats
    other: Ints

    def sent_on(self, incident: Floats) -> Floats:
        """Radiance by the irradiance over pi of all elements, (m, 3)."""
        radiance: Floats = self.share * incident[self.other]
        return radiance


@dataclass(frozen=True, eq=False)
class Solution:
    """The solved balance and how it ended.

    Attributes
    ----------
    reflected : (m, 3) float, W m^-2 sr^-1
        Radiance that each element reflects, and sends on from its other side.
    incident : (m, 3) float, W m^-2 sr^-1
        Irradiance over pi of each element.
    """

    reflected: Floats
    incident: Floats
    iterations: int
    residual: float
    converged: bool


def solve_balance(
    exchange: Exchange, reflectance: Floats, direct: Floats, areas: Floats, translucence: Translucence | None = None
) -> Solution:
    """Solve L = rho (E_direct / pi + F L) for the reflected radiance L of m elements.

    With translucence, the share tau of the same on the other side comes to it.

    By restarted GMRES (Saad & Schultz 1986) in the area-weighted inner product: many bounces cost few iterations, as
    the interreflections of a room have one slow mode.

    Parameters
    ----------
    exchange : Exchange
    reflectance : (m, 3) float
    direct : (m, 3) float, W m^-2 sr^-1
        Irradiance over pi that is not reflected radiance of an element: emitters, world.
    areas : (m,) float
    translucence : Translucence or None
    """

    def sent(incident: Floats) -> Floats:
        reflected = reflectance * incident
        return reflected if translucence is None else reflected + translucence.sent_on(incident)

    source = sent(direct)
    weight = areas[:, None] / areas.sum()

    def balance(radiance: Floats) -> Floats:
        return radiance - sent(exchange.apply(radiance))

    reflected, iterations, residual = gmres(balance, source, weight)
    reflected = np.maximum(reflected, 0.0)
    incident = direct + exchange.apply(reflected)
    return Solution(reflected, incident, iterations, residual, residual <= RESIDUAL)


def gmres(apply: Callable[[Floats], Floats], source: Floats, weight: Floats) -> tuple[Floats, int, float]:
    """Solve apply(x) = source to `RESIDUAL`; returns x, the iterations and the relative residual reached."""

    def dot(a: Floats, b: Floats) -> float:
        return float((weight * a * b).sum())

    scale = np.sqrt(dot(source, source))
    x = source.copy()
    if scale == 0.0:
        return x, 0, 0.0
    iterations = 0
    while True:
        remainder = source - apply(x)
        norm = np.sqrt(dot(remainder, remainder))
        if norm <= RESIDUAL * scale or iterations >= MOST_ITERATIONS:
            return x, iterations, float(norm / scale)
        basis = [remainder / norm]
        upper = np.zeros((RESTART + 1, RESTART))
        for k in range(RESTART):
            vector = apply(basis[k])
            for i, direction in enumerate(basis):
                upper[i, k] = dot(vector, direction)
                vector = vector - upper[i, k] * direction
            upper[k + 1, k] = np.sqrt(dot(vector, vector))
            iterations += 1
            target = np.zeros(k + 2)
            target[0] = norm
            step, *_ = np.linalg.lstsq(upper[: k + 2, : k + 1], target, rcond=None)
            missed = np.linalg.norm(upper[: k + 2, : k + 1] @ step - target)
            if missed <= 0.5 * RESIDUAL * scale or upper[k + 1, k] <= 1e-14 * norm or iterations >= MOST_ITERATIONS:
                break
            basis.append(vector / upper[k + 1, k])
        x = x + sum((s * direction for s, direction in zip(step, basis, strict=False)), np.zeros_like(x))
