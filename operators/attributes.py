# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Which colour attributes a bake writes, and how: their names, domain, type and exposure."""

import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from ..core.result import BakedMesh, BakeResult, GroupLight
from ..core.scene import Floats, Scene
from ..core.settings import BakeSettings
from .extraction import Extraction
from .targets import baked_targets

RADIOSITY = "Radiosity"
IRRADIANCE = "Irradiance"
UNGROUPED = "Ungrouped"
"""In the name of the attribute with the light of no light group."""


@dataclass(frozen=True)
class Attributes:
    """The colour attributes of one bake.

    Attributes
    ----------
    settings : BakeSettings
    groups : tuple of str
        Light groups that have an attribute of their own, empty for the light of no group.
    maxima : dict of str to float
        For Radiosity and Irradiance the light that 1 stands for: 1 but for bytes.
    """

    settings: BakeSettings
    groups: tuple[str, ...] = ()
    maxima: dict[str, float] = field(default_factory=lambda: {RADIOSITY: 1.0, IRRADIANCE: 1.0})

    def name(self, quantity: str, back: bool = False, group: str | None = None) -> str:
        """Return the name of an attribute."""
        parts = [quantity]
        if group is not None:
            parts.append(group or UNGROUPED)
        if back:
            parts.append("Back")
        return self.settings.prefix + " ".join(parts)

    def names(self) -> list[str]:
        """Return the names of all attributes that there may be."""
        return [self.name(*which) for which in self._which()]

    def values(self, baked: BakedMesh) -> dict[str, Floats | None]:
        """Return the values (s, 3, 3) of each attribute as they are to be stored, None where there are none."""
        lights: dict[str | None, BakedMesh | GroupLight] = {
            None: baked,
            **{light.name: light for light in baked.groups},
        }
        values = {}
        for quantity, back, group in self._which():
            light = lights.get(group)
            found = light and getattr(light, f"{quantity.lower()}{'_back' if back else ''}")
            values[self.name(quantity, back, group)] = None if found is None else self._stored(found, quantity)
        return values

    def as_stored(self, values: Mapping[str, np.ndarray]) -> dict[str, np.ndarray]:
        """Return light by attribute name, as `values` of an attribute of floats gives it, as it is to be stored."""
        quantities = {self.name(*which): which[0] for which in self._which()}
        return {name: self._stored(light, quantities[name]) for name, light in values.items()}

    def quantity_shown(self) -> str:
        """Return what is shown where the colours of materials are not."""
        return IRRADIANCE if self.settings.light == "IRRADIANCE" else RADIOSITY

    def shown(self) -> str:
        """Return the name of the attribute that is active for the viewport and for the renderer."""
        return self.name(self.quantity_shown())

    def _which(self) -> Iterable[tuple[str, bool, str | None]]:
        quantities = [IRRADIANCE] if self.settings.light == "IRRADIANCE" else [RADIOSITY, IRRADIANCE]
        for back in (False, True):
            for quantity in quantities:
                yield quantity, back, None
        for group in self.groups:
            for back in (False, True):
                yield quantities[0], back, group

    def _stored(self, values: Floats, quantity: str) -> Floats:
        return values if self.settings.data_type == "FLOAT" else np.clip(values / self.maxima[quantity], 0.0, 1.0)


def attributes_to_be(settings: BakeSettings, scene: Scene) -> Attributes:
    """Return the attributes that a bake of `scene` will write, as far as they are known before it."""
    names = tuple(group.name for group in scene.light_groups)
    return Attributes(settings, (*names, "") if settings.light_groups else ())


def attributes_of(
    settings: BakeSettings,
    extraction: Extraction,
    result: BakeResult,
    beside: Iterable[Mapping[str, np.ndarray]] = (),
) -> tuple[Attributes, dict[str, Any] | None]:
    """Return the attributes of a bake, and the exposure of its bytes for the report: None where there are none.

    Parameters
    ----------
    settings : BakeSettings
    extraction : Extraction
    result : BakeResult
    beside : iterable of mapping of str to (c, 3) float
        Other light by attribute name, that is to have the same exposure.
    """
    attributes = attributes_to_be(settings, extraction.scene)
    if settings.data_type == "FLOAT":
        return attributes, None
    maxima, exposure = {}, {}
    beside = list(beside)
    meshes = [baked for _, baked in baked_targets(extraction.scene, extraction.targets, result, settings)]
    for quantity in (RADIOSITY, IRRADIANCE):
        names = (quantity.lower(), f"{quantity.lower()}_back")
        found = [getattr(mesh, name) for mesh in meshes for name in names]
        found += [sets.get(attributes.name(quantity, back)) for sets in beside for back in (False, True)]
        values = [part.max(axis=-1) for part in found if part is not None]
        brightest = max((float(part.max(initial=0.0)) for part in values), default=0.0)
        maximum = settings.byte_maximum or brightest or 1.0
        maxima[quantity] = maximum
        if attributes.name(quantity) in attributes.names():
            clipped = sum(int(np.count_nonzero(part > maximum)) for part in values)
            exposure[quantity] = {"maximum": maximum, "stops": math.log2(maximum), "clipped": clipped}
    return Attributes(settings, attributes.groups, maxima), exposure
