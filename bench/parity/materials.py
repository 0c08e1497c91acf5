# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""What surfaces make of the light that reaches them, seen by what they give to others."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import bpy
import numpy as np

from . import stage
from .cases import case


@case("Closed room with coloured walls")
def closed_room() -> list[Any]:
    """Many bounces of coloured light."""
    floor = stage.closed_room()
    stage.lamp("AREA", place=(0.0, 0.0, 2.38), shape="SQUARE", size=0.6, energy=40.0)
    return [floor]


@case("Closed room with coloured walls, the light that leaves the floor", quantity="Radiosity")
def closed_room_radiosity() -> list[Any]:
    """The other attribute: reflected and emitted light."""
    floor = stage.closed_room()
    stage.lamp("AREA", place=(0.0, 0.0, 2.38), shape="SQUARE", size=0.6, energy=40.0)
    return [floor]


def picture(size: int = 64) -> Any:
    """Return an image of squares in six colours with soft borders, in sRGB."""
    image = bpy.data.images.new("Squares", size, size)
    colours = np.array(
        [(0.9, 0.3, 0.2), (0.2, 0.6, 0.3), (0.2, 0.3, 0.8), (0.9, 0.8, 0.3), (0.1, 0.1, 0.1), (0.9,) * 3]
    )
    x, y = np.meshgrid(np.arange(size) * 4 // size, np.arange(size) * 4 // size)
    pixels = np.ones((size, size, 4), dtype=np.float32)
    pixels[..., :3] = colours[(x + 3 * y) % 6]
    image.pixels.foreach_set(pixels.reshape(-1))
    return image


def image_texture(tree: Any, vector: Any = None) -> Any:
    """Return the colour of a picture, through the UV map or other vectors."""
    node = tree.nodes.new("ShaderNodeTexImage")
    node.image = picture()
    if vector is not None:
        tree.links.new(vector, node.inputs["Vector"])
    return node.outputs["Color"]


def painted_wall(colour_of: Callable[[Any], Any], shader: str = "ShaderNodeBsdfDiffuse", **inputs: Any) -> list[Any]:
    """Return the floor of a room whose wall has a colour that is linked to it, under a lamp that sees the wall."""
    floor = stage.room()
    bpy.data.objects.remove(bpy.data.objects["Wall"])
    made = bpy.data.materials.new("Painted")
    tree = stage.node_tree(made)
    node = stage.shader(tree, shader, **inputs)
    tree.links.new(colour_of(tree), node.inputs["Base Color" if "Principled" in shader else "Color"])
    stage.show(tree, node)
    stage.grid("Wall", 2.0, 2.0, 1, made, location=(-1.0, 0.0, 1.0), rotation=(np.pi / 2, 0.0, np.pi / 2))
    if shader != "ShaderNodeEmission":
        stage.lamp("AREA", (0.9, 0.0, 1.0), (0.0, np.pi / 2, 0.0), shape="SQUARE", size=0.5)
    return [floor]


@case("Image texture on a wall")
def image_on_wall() -> list[Any]:
    """A wall of one square lights the floor in the colours of its picture."""
    return painted_wall(image_texture)


@case("Image texture through a Mapping")
def mapped_image() -> list[Any]:
    """The picture turned and repeated."""

    def turned(tree: Any) -> Any:
        where, mapping = tree.nodes.new("ShaderNodeTexCoord"), tree.nodes.new("ShaderNodeMapping")
        mapping.inputs["Rotation"].default_value = (0.0, 0.0, 0.5)
        mapping.inputs["Scale"].default_value = (1.7, 0.8, 1.0)
        tree.links.new(where.outputs["UV"], mapping.inputs["Vector"])
        return image_texture(tree, mapping.outputs[0])

    return painted_wall(turned)


@case("Colour attribute on a wall")
def colour_attribute() -> list[Any]:
    """A colour for each corner of the wall."""

    def attribute(tree: Any) -> Any:
        node = tree.nodes.new("ShaderNodeVertexColor")
        node.layer_name = "Corners"
        return node.outputs["Color"]

    floors = painted_wall(attribute)
    colours = bpy.data.objects["Wall"].data.color_attributes.new("Corners", "FLOAT_COLOR", "POINT")
    colours.data.foreach_set("color", [0.9, 0.1, 0.1, 1, 0.1, 0.9, 0.1, 1, 0.1, 0.1, 0.9, 1, 0.9, 0.9, 0.9, 1])
    return floors


@case("Textured emission: a picture that shines")
def shining_picture() -> list[Any]:
    """An emitter of many colours, in pieces."""
    return painted_wall(image_texture, "ShaderNodeEmission", Strength=3.0)


@case("Procedural texture with a Color Ramp, evaluated by Cycles")
def procedural() -> list[Any]:
    """Nodes that are not read."""

    def noise(tree: Any) -> Any:
        texture, ramp = tree.nodes.new("ShaderNodeTexNoise"), tree.nodes.new("ShaderNodeValToRGB")
        texture.inputs["Scale"].default_value = 3.0
        ramp.color_ramp.elements[0].color, ramp.color_ramp.elements[1].color = (0.9, 0.1, 0.1, 1), (0.1, 0.2, 0.9, 1)
        tree.links.new(texture.outputs[0], ramp.inputs[0])
        return ramp.outputs["Color"]

    return painted_wall(noise)


@case("Principled BSDF with a picture, without gloss")
def principled_picture() -> list[Any]:
    """What remains diffuse of it."""
    return painted_wall(image_texture, "ShaderNodeBsdfPrincipled", Specular_IOR_Level=0.0)


@case("A transparent sheet above the floor")
def transparent_sheet() -> list[Any]:
    """Light goes through it from the lamp and from the wall."""
    floor = stage.room()
    air = stage.material("Air", "ShaderNodeBsdfTransparent")
    stage.grid("Sheet", 2.5, 2.5, 2, air, location=(0.0, 0.0, 0.4))
    stage.lamp("AREA", shape="DISK", size=0.5)
    return [floor]


@case("Emission from one side, by a Backfacing node")
def one_sided_emission() -> list[Any]:
    """A sheet that shines down and is dark above, between the floor and a wall."""
    floor = stage.room()
    made = bpy.data.materials.new("One Side")
    tree = stage.node_tree(made)
    mix, geometry = tree.nodes.new("ShaderNodeMixShader"), tree.nodes.new("ShaderNodeNewGeometry")
    tree.links.new(geometry.outputs["Backfacing"], mix.inputs[0])
    tree.links.new(stage.shader(tree, "ShaderNodeEmission", Strength=5.0).outputs[0], mix.inputs[1])
    tree.links.new(stage.shader(tree, "ShaderNodeBsdfDiffuse", Color=(0.0, 0.0, 0.0)).outputs[0], mix.inputs[2])
    stage.show(tree, mix)
    stage.grid("Sheet", 0.8, 0.8, 1, made, location=(0.2, 0.0, 1.2), rotation=(np.pi, 0.0, 0.0))
    stage.mesh("Roof", [(-2, -2, 2), (-2, 2, 2), (2, 2, 2), (2, -2, 2)], [(0, 1, 2, 3)], stage.paint("Roof"))
    return [floor]
