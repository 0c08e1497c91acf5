# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The colour of a glowing body, as a Blackbody node gives it."""

import numpy as np

from ..core.scene import LUMINANCE, Floats

_WAVELENGTHS = np.arange(380.0, 781.0, 5.0)
"""Nanometres."""

_SECOND_RADIATION_CONSTANT = 1.438777e7
"""Nanometre kelvin."""

_REC709 = np.array([(3.2406, -1.5372, -0.4986), (-0.9689, 1.8758, 0.0415), (0.0557, -0.2040, 1.0570)])
"""From the colours of the CIE 1931 observer to linear RGB (IEC 61966-2-1)."""


def blackbody(kelvin: float) -> Floats:
    """Return the linear RGB of a body of a temperature, (3,), of luminance 1: Planck's law, no channel below 0."""
    kelvin = min(max(kelvin, 800.0), 12000.0)
    light = _WAVELENGTHS**-5.0 / np.expm1(_SECOND_RADIATION_CONSTANT / (_WAVELENGTHS * kelvin))
    colour = np.maximum(_REC709 @ (_observer() @ light), 0.0)
    result: Floats = colour / (LUMINANCE @ colour)
    return result


def _observer() -> Floats:
    """Return what the CIE 1931 observer sees of each wavelength, (3, n): the fit of Wyman, Sloan & Shirley 2013."""

    def lobe(height: float, centre: float, below: float, above: float) -> Floats:
        away = _WAVELENGTHS - centre
        result: Floats = height * np.exp(-0.5 * (away * np.where(away < 0.0, below, above)) ** 2)
        return result

    red = lobe(0.362, 442.0, 0.0624, 0.0374) + lobe(1.056, 599.8, 0.0264, 0.0323) + lobe(-0.065, 501.1, 0.0490, 0.0382)
    green = lobe(0.821, 568.8, 0.0213, 0.0247) + lobe(0.286, 530.9, 0.0613, 0.0322)
    blue = lobe(1.217, 437.0, 0.0845, 0.0278) + lobe(0.681, 459.0, 0.0385, 0.0725)
    return np.stack([red, green, blue])
