# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""What Blender's lamps mean for radiosity: shape, strength and direction, in the units that Cycles gives them."""

from dataclasses import replace
from typing import NamedTuple

import bpy
import numpy as np

from ..core.scene import AreaLamp, Cone, Falloff, Floats, Lamp, PointLamp, SunLamp
from .lamp_profiles import may_have_profile
from .materials import constant_emission, uses_nodes
from .node_links import input_of, source_of
from .node_values import ValueReader

SMALLEST_SPREAD = np.radians(1.0)
"""Radians: at 0 the light of an area lamp is parallel, and all of it would leave in a direction that no ray meets."""

MANY_BOUNCES = 16
"""Of a lamp's light: to stop after so many is hardly seen."""

LARGEST_SUN = np.radians(120.0)
"""Radians of a sun's diameter above which it is no disk any more that a few rays could stand for."""


_POWERS = {"Quadratic": 0, "Linear": 1, "Constant": 2}
"""Of the distance, by which the outputs of a Light Falloff node undo that light falls off with its square."""


class ReadLamp(NamedTuple):
    """What a lamp does.

    Attributes
    ----------
    lamp : Lamp or None
        None where it gives no light to surfaces: a portal, or one that is hidden from diffuse rays.
    notes : tuple of str
        Clauses that say what was skipped or guessed.
    unread : tuple of str
        Clauses on nodes that make it brighter in one direction than in another, which Cycles may evaluate; the lamp is
        as it were without nodes then.
    factor : (3,) float
        What is known of its nodes, where there are some that are unread.
    """

    lamp: Lamp | None
    notes: tuple[str, ...] = ()
    unread: tuple[str, ...] = ()
    factor: Floats = np.ones(3)


def lamp_of(obj: bpy.types.Object, matrix: Floats) -> ReadLamp:
    """Return what a lamp does.

    Parameters
    ----------
    obj : Object
        An evaluated object of type LIGHT.
    matrix : (4, 4) float
        From its space to the world's.
    """
    light = obj.data
    if not obj.visible_diffuse:
        return ReadLamp(None)
    if light.type == "AREA" and getattr(getattr(light, "cycles", None), "is_portal", False):
        return ReadLamp(None)
    factor, unread, falloff = _emission_of(light)
    limits = tuple(_limits(light))
    axes, centre = matrix[:3, :3], matrix[:3, 3].copy()
    if unread and np.linalg.det(axes) != 0.0 and may_have_profile(light):
        return ReadLamp(_point_lamp(obj, centre, axes, _power(light)), limits, unread, factor)
    power, notes = factor * _power(light), (*unread, *limits)
    if falloff is not None:
        return ReadLamp(replace(_point_lamp(obj, centre, axes, power), falloff=falloff), notes)
    if light.type == "SUN":
        return ReadLamp(_sun_lamp(obj, axes, power), notes)
    if np.linalg.det(axes) == 0.0 and light.type in {"AREA", "SPOT"}:
        return ReadLamp(None, (*notes, "its scale is 0, and it gives no light"))
    if light.type == "AREA":
        lamp = _area_lamp(obj, centre, axes, power)
        return ReadLamp(lamp, notes if lamp is not None else (*notes, "its size is 0, and it gives no light"))
    return ReadLamp(_point_lamp(obj, centre, axes, power), notes)


def _emission_of(light: bpy.types.Light) -> tuple[Floats, tuple[str, ...], Falloff | None]:
    """Return what the nodes of a lamp multiply its light by, clauses on the unread, and what they make of distance."""
    if not uses_nodes(light):
        return np.ones(3), (), None
    constant = (*constant_emission(light), None)
    output = light.node_tree.get_output_node("CYCLES")
    shader, groups = source_of(input_of(output, "Surface"), ()) if output is not None else (None, ())
    if light.type not in {"POINT", "SPOT"} or shader is None or shader.node.type != "EMISSION":
        return constant
    source, outer = source_of(input_of(shader.node, "Strength"), groups)
    if source is None or source.node.type != "LIGHT_FALLOFF":
        return constant
    values = ValueReader()
    strength, smooth = (values.value(source.node, name, outer) for name in ("Strength", "Smooth"))
    colour = values.colour(shader.node, "Color", groups)
    if values.notes:
        return constant
    falloff = Falloff(_POWERS[source.identifier], max(float(smooth), 0.0))
    return colour * strength, (), falloff if falloff != Falloff(0, 0.0) else None


def _sun_lamp(obj: bpy.types.Object, axes: Floats, power: Floats) -> SunLamp:
    light = obj.data
    if not _is_normalized(light):
        power = power * (np.pi * np.sin(light.angle / 2.0) ** 2)
    return SunLamp(obj.name, -_unit(axes[:, 2]), min(float(light.angle), LARGEST_SUN), power, light.use_shadow)


def _point_lamp(obj: bpy.types.Object, centre: Floats, axes: Floats, power: Floats) -> PointLamp:
    light = obj.data
    # The scale of the object changes neither radius nor power.
    radius = float(light.shadow_soft_size)
    intensity = power / (4.0 * np.pi) if _is_normalized(light) else power * radius**2
    cone = None
    if light.type == "SPOT":
        cone = Cone(np.linalg.inv(axes), float(np.cos(light.spot_size / 2.0)), float(light.spot_blend))
    return PointLamp(obj.name, centre, radius, intensity, light.use_soft_falloff, cone, light.use_shadow)


def _area_lamp(obj: bpy.types.Object, centre: Floats, axes: Floats, power: Floats) -> AreaLamp | None:
    light = obj.data
    height = light.size_y if light.shape in {"RECTANGLE", "ELLIPSE"} else light.size
    half_axes = np.stack([axes[:, 0] * light.size / 2.0, axes[:, 1] * height / 2.0])
    elliptic = light.shape in {"DISK", "ELLIPSE"}
    area = (np.pi if elliptic else 4.0) * float(np.linalg.norm(np.cross(*half_axes)))
    if area == 0.0:
        return None
    radiance = power / np.pi
    if _is_normalized(light):
        radiance = radiance / area
    spread = max(float(light.spread), SMALLEST_SPREAD)
    return AreaLamp(obj.name, centre, half_axes, -_unit(axes[:, 2]), radiance, elliptic, spread, light.use_shadow)


def _limits(light: bpy.types.Light) -> list[str]:
    """Return clauses on values that are outside of what is supported."""
    notes = []
    if light.energy < 0.0:
        notes.append("its power is negative; it was taken for zero")
    bounces = getattr(getattr(light, "cycles", None), "max_bounces", MANY_BOUNCES)
    if bounces < MANY_BOUNCES:
        notes.append(f"its light goes on after the {bounces} bounces that it is limited to")
    if light.type == "AREA" and light.spread < SMALLEST_SPREAD:
        notes.append("its spread was taken for 1 degree, the least that is supported")
    if light.type == "SUN" and light.angle > LARGEST_SUN:
        notes.append("its angle was taken for 120 degrees, the most that is supported")
    return notes


def _power(light) -> Floats:
    """Colour times power (strength for a sun), with the exposure and the temperature where Blender has them."""
    colour = np.array(light.color, dtype=np.float64)
    if getattr(light, "use_temperature", False):
        colour = colour * np.array(light.temperature_color, dtype=np.float64)[:3]
    power: Floats = colour * (light.energy * 2.0 ** getattr(light, "exposure", 0.0))
    return power


def _is_normalized(light) -> bool:
    """Whether its power does not depend on its size."""
    return getattr(light, "normalize", True)


def _unit(vector: Floats) -> Floats:
    length = float(np.linalg.norm(vector))
    # A sun scaled to nothing shines down, as an unturned one does.
    return vector / length if length > 0.0 else np.array([0.0, 0.0, 1.0])
