# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""What a material does to light, as constants and as what varies over a mesh."""

from collections.abc import Iterable
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from .varying import Varying, combined, varies

Colour = NDArray[np.float64]

_CLEAR = 0.999
"""Share of the light that is let through from which on a material counts as not being there."""


@dataclass(frozen=True, eq=False)
class Surface:
    """What a material does to light.

    Attributes
    ----------
    reflectance : (3,) float or Varying, 0..1
        Diffuse albedo, linear RGB.
    emission : (3,) float or Varying, W m^-2 sr^-1
        Emitted radiance, linear RGB.
    notes : tuple of str
        What was skipped or guessed, each a clause to follow the material's name and a colon.
    through : (3,) float or Varying, 0..1
        Share of the light that goes straight through it, linear RGB.
    refraction : float
        Index of refraction where that is through glass, which reflects a part of it; else 1.
    clear : bool
        Whether all of it goes through, as if the material were not there.
    front_only : bool
        Whether it emits from its front alone.
    translucence : (3,) float or Varying, 0..1
        Share of the light on one side that leaves the other evenly in all directions, linear RGB.
    mirrored : (3,) float or Varying, 0..1
        Share of the light that gloss sends on, linear RGB; its own colours do not show it.
    covered : float or Varying, 0..1
        Share of what is diffuse that others do not get, as gloss lies above it.
    unread : tuple of str
        Nodes that only Blender can evaluate, in the words of its Add menu: where there is one, the colours are guesses.
    """

    reflectance: Colour | Varying
    emission: Colour | Varying
    notes: tuple[str, ...] = ()
    unread: tuple[str, ...] = ()
    through: Colour | Varying = field(default_factory=lambda: np.zeros(3))
    refraction: float = 1.0
    clear: bool = False
    front_only: bool = False
    translucence: Colour | Varying = field(default_factory=lambda: np.zeros(3))
    mirrored: Colour | Varying = field(default_factory=lambda: np.zeros(3))
    covered: float | Varying = 0.0

    @property
    def is_glossy(self) -> bool:
        """Whether others get other light from it than what it shows."""
        return varies(self.mirrored, self.covered) or bool(np.any(self.mirrored) or self.covered)

    def sent_on(self) -> Colour | Varying:
        """Return the share of the light that others get."""
        if not self.is_glossy:
            return self.reflectance
        return combined(_with_gloss, self.reflectance, self.mirrored, self.covered)

    @property
    def is_bare(self) -> bool:
        """Whether it has no light of its own to show: it is clear, or glass, tinted or not, and nothing else."""
        own = self.reflectance, self.emission, self.translucence
        dark = not self.unread and not varies(*own) and not np.any(own)
        return self.clear or (dark and bool(varies(self.through) or np.any(self.through)))

    def colours(self) -> tuple[Colour | Varying, ...]:
        """Return all that may vary."""
        return self.reflectance, self.emission, self.through, self.translucence, self.mirrored, self.covered


def surface_of(
    reflectance: object = 0.0,
    emission: object = 0.0,
    notes: Iterable[str] = (),
    unread: Iterable[str] = (),
    through: object = 0.0,
    refraction: float = 1.0,
    translucence: object = 0.0,
    mirrored: object = 0.0,
    covered: float | Varying = 0.0,
) -> Surface:
    def colour(value: object) -> Colour | Varying:
        if isinstance(value, Varying):
            return value
        return np.array(np.broadcast_to(np.asarray(value, dtype=np.float64), (3,)))

    clear = not varies(through) and refraction == 1.0 and bool(np.all(np.asarray(through) >= _CLEAR))
    return Surface(
        colour(reflectance),
        colour(emission),
        tuple(notes),
        tuple(unread),
        colour(0.0 if clear else through),
        refraction,
        clear,
        translucence=colour(translucence),
        mirrored=colour(mirrored),
        covered=covered,
    )


def alike(first: Colour | Varying, second: Colour | Varying) -> bool:
    """Return whether two colours are constants and the same."""
    return not varies(first, second) and np.array_equal(first, second)


def _with_gloss(reflectance, mirrored, covered):
    """Return the share that others get of light on something diffuse below something that mirrors."""
    return np.clip(reflectance * (1.0 - covered) + mirrored, 0.0, 1.0)
