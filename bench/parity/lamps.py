# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Blender's lamps, and meshes that shine."""

from __future__ import annotations

from typing import Any

import bpy

from . import stage
from .cases import case


@case("Point lamp, radius 0")
def point_without_radius() -> list[Any]:
    """Hard shadows."""
    floor = stage.room()
    stage.lamp("POINT", shadow_soft_size=0.0)
    return [floor]


@case("Point lamp, radius 0.3 m")
def point_with_radius() -> list[Any]:
    """Soft shadows of a ball."""
    floor = stage.room()
    stage.lamp("POINT", shadow_soft_size=0.3, color=(1.0, 0.6, 0.3))
    return [floor]


@case("Point lamp, radius 0.3 m, without soft falloff")
def point_without_soft_falloff() -> list[Any]:
    """The other of Blender's two meanings of a radius."""
    floor = stage.room()
    stage.lamp("POINT", shadow_soft_size=0.3, use_soft_falloff=False)
    return [floor]


@case("Spot lamp, size 80°, blend 0.4, radius 0.1 m")
def spot() -> list[Any]:
    """A turned cone with a soft rim."""
    floor = stage.room()
    stage.lamp("SPOT", turn=(0.2, 0.3, 0.0), spot_size=1.396, spot_blend=0.4, shadow_soft_size=0.1, energy=30.0)
    return [floor]


@case("Area lamp, square")
def area_square() -> list[Any]:
    """A lamp of 0.5 m."""
    floor = stage.room()
    stage.lamp("AREA", shape="SQUARE", size=0.5)
    return [floor]


@case("Area lamp, rectangle, turned and scaled")
def area_rectangle() -> list[Any]:
    """The object's scale changes the lamp's size."""
    floor = stage.room()
    stage.lamp("AREA", turn=(0.3, 0.2, 1.0), scale=(2, 1, 3), shape="RECTANGLE", size=0.3, size_y=0.8)
    return [floor]


@case("Area lamp, disk")
def area_disk() -> list[Any]:
    """A lamp of 0.6 m."""
    floor = stage.room()
    stage.lamp("AREA", shape="DISK", size=0.6)
    return [floor]


@case("Area lamp, ellipse, mirrored")
def area_ellipse() -> list[Any]:
    """Negative scale."""
    floor = stage.room()
    stage.lamp("AREA", scale=(-1, 1, 1), turn=(0.2, 0.0, 0.3), shape="ELLIPSE", size=0.8, size_y=0.3)
    return [floor]


@case("Area lamp, spread 90°")
def area_spread() -> list[Any]:
    """The light leaves in a cone."""
    floor = stage.room()
    stage.lamp("AREA", shape="SQUARE", size=0.5, spread=1.571)
    return [floor]


@case("Sun, angle 0°")
def sun_sharp() -> list[Any]:
    """Parallel light."""
    floor = stage.room()
    stage.lamp("SUN", turn=(0.4, 0.3, 0.0), angle=0.0)
    return [floor]


@case("Sun, angle 10°")
def sun_wide() -> list[Any]:
    """A sun that is wider than the real one."""
    floor = stage.room()
    stage.lamp("SUN", turn=(0.4, 0.3, 0.0), angle=0.1745)
    return [floor]


@case("A lamp without shadows")
def without_shadow() -> list[Any]:
    """Its light goes through everything, the light that it makes does not."""
    floor = stage.room()
    stage.lamp("POINT", shadow_soft_size=0.1, use_shadow=False)
    return [floor]


@case("A lamp hidden from diffuse rays")
def hidden_from_diffuse() -> list[Any]:
    """Only the second lamp gives light to matt surfaces."""
    floor = stage.room()
    stage.lamp("POINT", shadow_soft_size=0.1).visible_diffuse = False
    stage.lamp("AREA", place=(-0.4, 0.5, 1.4), shape="SQUARE", size=0.4)
    return [floor]


@case("A lamp with temperature and exposure")
def temperature_and_exposure() -> list[Any]:
    """What newer versions of Blender have."""
    floor = stage.room()
    stage.lamp("POINT", shadow_soft_size=0.2, use_temperature=True, temperature=3500.0, exposure=1.0)
    return [floor]


@case("Emission shader in a lamp")
def lamp_with_nodes() -> list[Any]:
    """The shader multiplies the lamp's colour and power."""
    floor = stage.room()
    light = stage.lamp("POINT", shadow_soft_size=0.2).data
    tree = stage.node_tree(light)
    stage.show(tree, stage.shader(tree, "ShaderNodeEmission", Color=(0.4, 0.8, 1.0), Strength=2.0))
    return [floor]


def _shining_by(light: Any, kind: str, socket: str, output: str = "Color") -> Any:
    """Have a node make an input of a lamp's Emission shader, and return the node and the tree."""
    tree = stage.node_tree(light)
    shine, node = stage.shader(tree, "ShaderNodeEmission"), tree.nodes.new(kind)
    tree.links.new(next(found for found in node.outputs if found.identifier == output), shine.inputs[socket])
    stage.show(tree, shine)
    return node, tree


@case("Light Falloff that is linear and smooth")
def lamp_with_falloff() -> list[Any]:
    """Light that falls off with the distance in place of its square."""
    floor = stage.room()
    light = stage.lamp("POINT", shadow_soft_size=0.1).data
    falloff, _ = _shining_by(light, "ShaderNodeLightFalloff", "Strength", "Linear")
    falloff.inputs["Strength"].default_value, falloff.inputs["Smooth"].default_value = 1.5, 0.4
    return [floor]


@case("IES file in a turned lamp")
def lamp_with_ies_file() -> list[Any]:
    """Measured candela, brighter to one side and dark behind."""
    floor = stage.room()
    light = stage.lamp("POINT", (0.1, 0.05, 1.5), (0.3, 0.2, 0.4), shadow_soft_size=0.1).data
    measured, _ = _shining_by(light, "ShaderNodeTexIES", "Strength", "Fac")
    sides = ("1000 1200 900 400 100 0 0", "1000 800 500 300 100 50 0", "1000 600 300 100 20 0 0")
    lines = ["IESNA91", "TILT=NONE", "1 1000 1 7 5 1 2 0.1 0.1 0", "1 1 50", "0 15 30 60 90 135 180"]
    measured.ies = bpy.data.texts.new("lamp.ies")
    measured.ies.write("\n".join([*lines, "0 90 180 270 360", *(sides[k] for k in (0, 1, 2, 1, 0)), ""]))
    measured.inputs["Strength"].default_value = 0.05
    return [floor]


@case("Spot lamp that throws a slide of many colours")
def lamp_with_slide() -> list[Any]:
    """A texture in the lamp's own coordinates."""
    floor = stage.room()
    turn = (0.1, 0.2, 0.7)
    light = stage.lamp("SPOT", turn=turn, energy=6.0, shadow_soft_size=0.02, spot_size=1.6, spot_blend=0.2).data
    slide, tree = _shining_by(light, "ShaderNodeTexNoise", "Color")
    slide.inputs["Scale"].default_value = 2.0
    tree.links.new(tree.nodes.new("ShaderNodeTexCoord").outputs["UV"], slide.inputs["Vector"])
    return [floor]


@case("Mesh emitter seen from its front")
def emitter_front() -> list[Any]:
    """A square of 0.6 m that faces the floor."""
    floor = stage.room()
    stage.grid("Panel", 0.6, 0.6, 1, stage.glow(), location=(0.3, -0.2, 1.5), rotation=(3.1416, 0, 0))
    return [floor]


@case("Mesh emitter seen from its back")
def emitter_back() -> list[Any]:
    """The same square turned over: an Emission shader shines from both sides."""
    floor = stage.room()
    stage.grid("Panel", 0.6, 0.6, 1, stage.glow(), location=(0.3, -0.2, 1.5))
    return [floor]


@case("Mesh emitter that shines from its front only")
def emitter_one_sided() -> list[Any]:
    """A Geometry node's Backfacing chooses between Emission and black."""
    floor = stage.room()
    made = bpy.data.materials.new("One Side")
    tree = stage.node_tree(made)
    back = stage.shader(tree, "ShaderNodeNewGeometry")
    shine = stage.shader(tree, "ShaderNodeEmission", Strength=5.0)
    dark = stage.shader(tree, "ShaderNodeEmission", Strength=0.0)
    mix = tree.nodes.new("ShaderNodeMixShader")
    tree.links.new(back.outputs["Backfacing"], mix.inputs[0])
    tree.links.new(shine.outputs[0], mix.inputs[1])
    tree.links.new(dark.outputs[0], mix.inputs[2])
    stage.show(tree, mix)
    stage.grid("Panel", 0.6, 0.6, 1, made, location=(0.3, -0.2, 1.5), rotation=(2.6, 0, 0))
    stage.grid("Turned Panel", 0.6, 0.6, 1, made, location=(-0.6, 0.5, 1.2))
    return [floor]


@case("Emissive ball of many faces")
def emitter_ball() -> list[Any]:
    """An icosphere of 320 triangles."""
    floor = stage.room()
    bpy.ops.mesh.primitive_ico_sphere_add(subdivisions=3, radius=0.15, location=(0.3, -0.2, 1.3))
    bpy.context.object.data.materials.append(stage.glow(colour=(1.0, 0.8, 0.5), strength=20.0))
    return [floor]


def _linked(name: str, **states: str) -> Any:
    """Return a collection for light linking, of objects by their names."""
    collection = bpy.data.collections.new(name)
    for number, (thing, state) in enumerate(states.items()):
        collection.objects.link(bpy.data.objects[thing])
        collection.collection_objects[number].light_linking.link_state = state
    return collection


@case("Light linking: a lamp that does not light the wall")
def light_linking_receivers() -> list[Any]:
    """The wall throws no red light on the floor."""
    floor = stage.room()
    lamp = stage.lamp("POINT", shadow_soft_size=0.2)
    lamp.light_linking.receiver_collection = _linked("Receivers", Wall="EXCLUDE")
    return [floor]


@case("Light linking: a lamp that lights the wall alone")
def light_linking_indirect() -> list[Any]:
    """The floor has what the wall reflects."""
    floor = stage.room()
    lamp = stage.lamp("POINT", shadow_soft_size=0.2)
    lamp.light_linking.receiver_collection = _linked("Receivers", Wall="INCLUDE")
    return [floor]


@case("Shadow linking: a board that throws no shadow")
def light_linking_blockers() -> list[Any]:
    """It is lit, and hides what others reflect."""
    floor = stage.room()
    lamp = stage.lamp("AREA", shape="SQUARE", size=0.3)
    lamp.light_linking.blocker_collection = _linked("Blockers", Board="EXCLUDE")
    return [floor]


@case("Light linking of a mesh emitter")
def light_linking_emitter() -> list[Any]:
    """It lights the floor alone, and only the wall may hide it."""
    floor = stage.room()
    panel = stage.grid("Panel", 0.6, 0.6, 1, stage.glow(), location=(0.3, -0.2, 1.5), rotation=(3.1416, 0, 0))
    panel.light_linking.receiver_collection = _linked("Receivers", Floor="INCLUDE")
    panel.light_linking.blocker_collection = _linked("Blockers", Wall="INCLUDE")
    return [floor]
