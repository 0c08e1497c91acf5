# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""How a single object takes part in the light: by what the artist set for it, and by its ray visibility in Cycles."""

from collections.abc import Sequence
from dataclasses import dataclass

import bpy
import numpy as np

from ..core.scene import GRAZING, Floats

_OVERRIDABLE = {"LIBRARY_OVERRIDABLE"}


class ObjectSettings(bpy.types.PropertyGroup):
    """What an artist sets for one object (`object.radiosity_settings`)."""

    use_reflectance: bpy.props.BoolProperty(
        name="Override Reflectance",
        description="Reflect light in the colour below, whatever the materials are",
        default=False,
        options=set(),
        override=_OVERRIDABLE,
    )
    reflectance: bpy.props.FloatVectorProperty(
        name="Reflectance",
        description="Share of the light that the object reflects, in place of the Base Color of its materials",
        subtype="COLOR",
        size=3,
        default=(0.8, 0.8, 0.8),
        min=0.0,
        max=1.0,
        options=set(),
        override=_OVERRIDABLE,
    )
    emits: bpy.props.BoolProperty(
        name="Emits",
        description=(
            "The object's emission lights others. Turn it off for a lamp shade or a screen whose light a lamp gives "
            "already: it glows, but lights nothing"
        ),
        default=True,
        options=set(),
        override=_OVERRIDABLE,
    )
    receives: bpy.props.BoolProperty(
        name="Receives",
        description=(
            "The object gets baked colours when it is selected. Turn it off for what shall shape the light and stay as "
            "it is, such as a character"
        ),
        default=True,
        options=set(),
        override=_OVERRIDABLE,
    )
    casts: bpy.props.BoolProperty(
        name="Casts",
        description=(
            "The object throws shadows and reflected light on others. Turn it off for what light passes, such as the "
            "glass of a window"
        ),
        default=True,
        options=set(),
        override=_OVERRIDABLE,
    )


@dataclass(frozen=True, eq=False)
class Role:
    """How an object, or an instance, takes part in the light.

    Attributes
    ----------
    seen, shadow : bool
        As `SurfaceMesh` has them.
    lights : bool
        Whether its emission lights others.
    receives : bool
        Whether it can be baked.
    reflectance : (3,) float or None
        In place of that of its materials.
    grazing : float
        As `SurfaceMesh` has it.
    """

    seen: bool
    shadow: bool
    lights: bool
    receives: bool
    reflectance: Floats | None
    grazing: float


def role_of(objects: Sequence[bpy.types.Object]) -> Role:
    """Return the role of an object, followed by the one that instances it, if any: what either forbids is forbidden."""
    settings = [obj.radiosity_settings for obj in objects]
    casts = all(of_object.casts for of_object in settings)
    seen = all(obj.visible_diffuse for obj in objects)
    overriding = next((of_object for of_object in settings if of_object.use_reflectance), None)
    return Role(
        seen=casts and seen,
        shadow=casts and all(obj.visible_shadow for obj in objects),
        lights=seen and all(of_object.emits for of_object in settings),
        receives=all(of_object.receives for of_object in settings),
        reflectance=None if overriding is None else np.array(overriding.reflectance, dtype=np.float64),
        grazing=_grazing(objects[0]),
    )


def _grazing(obj: bpy.types.Object) -> float:
    """Return the geometry offset of the shadow terminator, which versions of Blender have in different places."""
    cycles = getattr(obj, "cycles", None)
    for owner in (obj, cycles):
        if hasattr(owner, "shadow_terminator_geometry_offset"):
            return float(owner.shadow_terminator_geometry_offset)
    return GRAZING
