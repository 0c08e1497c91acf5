# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The numbers that a bake can work with, and what it takes others for."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from .scene import AreaLamp, Floats, Lamp, PointLamp, SunLamp

LARGEST_COORDINATE = 1e12
"""Scene units beyond which nothing lies: neighbouring float32 are 65536 apart there, and of 1.8e19 a square is none."""

LARGEST_LIGHT, SMALLEST_LIGHT = 1e12, 1e-12
"""What gives light, in its own unit, is limited to the one, and below the other gives none. Many emitters
are weighed in float32, by light times squares of areas and distances (`light_tree`)."""


def sound_light(light: Floats | NDArray[np.float32]) -> Floats:
    """Light as it is taken: of any shape, none where it is no number, negative or negligible, and limited."""
    values = np.nan_to_num(np.asarray(light, dtype=np.float64), nan=0.0, posinf=0.0, neginf=0.0)
    values[values < SMALLEST_LIGHT] = 0.0
    result: Floats = np.minimum(values, LARGEST_LIGHT)
    return result


def light_warnings(name: str, what: str, light: Floats | NDArray[np.float32]) -> list[str]:
    """Sentences on light that is not taken as it is; of a negative one, whoever read it from the file tells."""
    finite = np.isfinite(light)
    warnings = []
    if not finite.all():
        warnings.append(f"{name}: {what} that is not a number was taken for none")
    if (np.asarray(light, dtype=np.float64)[finite] > LARGEST_LIGHT).any():
        warnings.append(f"{name}: {what} above {LARGEST_LIGHT:.0e} was limited to it")
    return warnings


def sound_lamp(lamp: Lamp) -> Lamp:
    """A lamp that light can be computed of: dark, and without a place, where it has none that is a number."""
    if _has_a_place(lamp):
        return replace(lamp, strength=sound_light(lamp.strength))
    return PointLamp(lamp.name, np.zeros(3), 0.0, np.zeros(3), shadow=lamp.shadow, linking=lamp.linking)


def lamp_warnings(lamp: Lamp) -> list[str]:
    """Sentences on what of a lamp is not taken as it is."""
    if _has_a_place(lamp):
        return light_warnings(lamp.name, "light", lamp.strength)
    return [f"{lamp.name}: a place, direction or size that is not a number, or too large; it gives no light"]


def _has_a_place(lamp: Lamp) -> bool:
    """Whether all that tells where it is, how large, and where it shines to, is a number within the limits."""
    if isinstance(lamp, AreaLamp):
        return bool(np.any(lamp.normal)) and _within(lamp.centre, lamp.half_axes, lamp.normal, np.array(lamp.spread))
    if isinstance(lamp, SunLamp):
        return bool(np.any(lamp.direction)) and _within(lamp.direction, np.array(lamp.angle))
    turned = lamp.cone is None or bool(np.isfinite(lamp.cone.inverse).all())
    return turned and lamp.radius >= 0.0 and _within(lamp.centre, np.array(lamp.radius))


def _within(*values: Floats) -> bool:
    return all(bool((np.abs(value) <= LARGEST_COORDINATE).all()) for value in values)
