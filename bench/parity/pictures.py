# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""What Cycles renders, what we baked, and how they differ, side by side."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from .cycles import Floats

# Of what can be shown, where the median of what is not black in Cycles' picture goes.
MIDDLE = 0.35

# By which differences of display colours are enlarged, around a middle grey.
ENLARGED = 4.0
GAP = 6


def write(path: Path, theirs: Floats, ours: Floats) -> None:
    """Write Cycles' picture, ours, and their difference beside each other.

    Parameters
    ----------
    theirs, ours : (h, w, 3) float
        Radiance.
    """
    from PIL import Image

    first, second = exposed(theirs, ours)
    difference = np.clip(0.5 + ENLARGED * (second - first), 0.0, 1.0)
    gap = np.ones((len(first), GAP, 3))
    sheet = np.concatenate([first, gap, second, gap, difference], axis=1)
    path.parent.mkdir(parents=True, exist_ok=True)
    Image.fromarray(np.round(sheet * 255.0).astype(np.uint8)).save(path, quality=86, optimize=True)


def exposed(theirs: Floats, ours: Floats) -> tuple[Floats, Floats]:
    """Return both as display colours 0..1, exposed alike for the median of what is not black in the first."""
    brightest = theirs.max(axis=2)
    lit = brightest[brightest > 0.0]
    exposure = -np.log(1.0 - MIDDLE) / (float(np.median(lit)) if len(lit) else 1.0)
    return displayed(theirs * exposure), displayed(ours * exposure)


def displayed(light: Floats) -> Floats:
    """Return exposed radiance as display colours: bright parts bent so that none burns out, then the sRGB curve."""
    linear = 1.0 - np.exp(-np.maximum(light, 0.0))
    shown: Floats = np.where(linear <= 0.0031308, 12.92 * linear, 1.055 * linear ** (1.0 / 2.4) - 0.055)
    return shown
