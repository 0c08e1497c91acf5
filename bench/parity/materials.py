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

PALE = (0.8, 0.7, 0.5)


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


@case("Principled BSDF, half of it metal or glass", quantity="Radiosity")
def half_metal() -> list[Any]:
    """What is left of its base colour is diffuse."""
    made = stage.material(
        "Half Metal",
        "ShaderNodeBsdfPrincipled",
        Base_Color=PALE,
        Metallic=0.3,
        Transmission_Weight=0.2,
        Roughness=1.0,
        Specular_IOR_Level=0.0,
    )
    floor = stage.room(made)
    # What is glass or metal of the floor would mirror on the wall.
    bpy.data.objects.remove(bpy.data.objects["Wall"])
    bpy.data.objects.remove(bpy.data.objects["Board"])
    stage.lamp("AREA", shape="SQUARE", size=0.5)
    return [floor]


def principled_room(**inputs: Any) -> list[Any]:
    """Return the floor of a room of Principled BSDFs, with a table, under a lamp."""
    floor = stage.closed_room()
    paints = {"Left": (0.6, 0.1, 0.05), "Right": (0.1, 0.5, 0.12)}
    for thing in [thing for thing in bpy.context.scene.objects if thing.type == "MESH"]:
        colour = paints.get(thing.name, (0.7, 0.7, 0.7))
        thing.data.materials[0] = stage.material(thing.name, "ShaderNodeBsdfPrincipled", Base_Color=colour)
    wood = stage.material("Wood", "ShaderNodeBsdfPrincipled", **{"Base_Color": (0.3, 0.2, 0.1), **inputs})
    stage.box("Table", (-0.5, -0.3, 0.4), (0.5, 0.3, 0.8), wood)
    stage.lamp("AREA", place=(0.0, 0.0, 2.38), shape="SQUARE", size=0.6, energy=40.0)
    return [floor]


@case("A room of Principled BSDFs as Blender makes them, with their gloss")
def gloss_as_made() -> list[Any]:
    """What gloss mirrors lights the room."""
    return principled_room()


@case("A table of rough metal in that room")
def metal_table() -> list[Any]:
    """Metal is black itself and lights others."""
    return principled_room(Base_Color=(0.8, 0.8, 0.8), Metallic=1.0, Roughness=0.4)


@case("A wall that the camera sees otherwise, by a Light Path node")
def seen_by_camera() -> list[Any]:
    """What travels is what rays between diffuse surfaces see."""
    floor = stage.room()
    made = bpy.data.materials.new("Two Looks")
    tree = stage.node_tree(made)
    mix, path = tree.nodes.new("ShaderNodeMixShader"), tree.nodes.new("ShaderNodeLightPath")
    tree.links.new(path.outputs["Is Camera Ray"], mix.inputs[0])
    tree.links.new(stage.shader(tree, "ShaderNodeBsdfDiffuse", Color=(0.8, 0.1, 0.1)).outputs[0], mix.inputs[1])
    tree.links.new(stage.shader(tree, "ShaderNodeEmission", Color=(0.1, 0.3, 0.9)).outputs[0], mix.inputs[2])
    stage.show(tree, mix)
    bpy.data.objects["Wall"].data.materials[0] = made
    stage.lamp("AREA", shape="SQUARE", size=0.5)
    return [floor]


@case("Mix and Add Shader: a wall that is diffuse and shines a little")
def mixed_shaders() -> list[Any]:
    """A mix of two colours, to which an emission is added."""
    floor = stage.room()
    made = bpy.data.materials.new("Mixed")
    tree = stage.node_tree(made)
    mix, add = tree.nodes.new("ShaderNodeMixShader"), tree.nodes.new("ShaderNodeAddShader")
    mix.inputs[0].default_value = 0.3
    tree.links.new(stage.shader(tree, "ShaderNodeBsdfDiffuse", Color=(0.8, 0.1, 0.1)).outputs[0], mix.inputs[1])
    tree.links.new(stage.shader(tree, "ShaderNodeBsdfDiffuse", Color=(0.1, 0.8, 0.3)).outputs[0], mix.inputs[2])
    tree.links.new(mix.outputs[0], add.inputs[0])
    tree.links.new(
        stage.shader(tree, "ShaderNodeEmission", Color=(0.2, 0.4, 1.0), Strength=0.1).outputs[0], add.inputs[1]
    )
    stage.show(tree, add)
    bpy.data.objects["Wall"].data.materials[0] = made
    stage.lamp("AREA", shape="SQUARE", size=0.5)
    return [floor]


@case("Two UV maps, a picture through each")
def two_uv_maps() -> list[Any]:
    """One picture times another, whose UV map is turned and runs twice over the wall."""

    def product(tree: Any) -> Any:
        mix, second = tree.nodes.new("ShaderNodeMix"), tree.nodes.new("ShaderNodeUVMap")
        mix.data_type, mix.blend_type = "RGBA", "MULTIPLY"
        second.uv_map = "Second"
        pictures = image_texture(tree), image_texture(tree, second.outputs[0])
        for name, value in zip(("A_Color", "B_Color"), pictures, strict=True):
            tree.links.new(value, next(socket for socket in mix.inputs if socket.identifier == name))
        next(socket for socket in mix.inputs if socket.identifier == "Factor_Float").default_value = 1.0
        return next(socket for socket in mix.outputs if socket.identifier == "Result_Color")

    floors = painted_wall(product)
    mesh = bpy.data.objects["Wall"].data
    layer = mesh.uv_layers.new(name="Second")
    for corner, at in enumerate(mesh.uv_layers["UVMap"].uv):
        layer.uv[corner].vector = (2.0 * at.vector.y, 2.0 * at.vector.x)
    return floors


@case("A transparent sheet above the floor")
def transparent_sheet() -> list[Any]:
    """Light goes through it from the lamp and from the wall."""
    floor = stage.room()
    air = stage.material("Air", "ShaderNodeBsdfTransparent")
    stage.grid("Sheet", 2.5, 2.5, 2, air, location=(0.0, 0.0, 0.4))
    stage.lamp("AREA", shape="DISK", size=0.5)
    return [floor]


@case("A sheet of red glass above the floor")
def tinted_glass() -> list[Any]:
    """A Transparent BSDF with a colour."""
    floor = stage.room()
    red = stage.material("Red Glass", "ShaderNodeBsdfTransparent", Color=(0.9, 0.5, 0.4))
    stage.grid("Sheet", 2.5, 2.5, 2, red, location=(0.0, 0.0, 0.4))
    stage.lamp("AREA", shape="DISK", size=0.5)
    return [floor]


@case("A curtain of alpha 0.5 between a lamp and the floor")
def curtain() -> list[Any]:
    """Half of the light goes through it, from the lamp and from the wall, and it reflects some of the rest."""
    floor = stage.room()
    cloth = stage.material("Cloth", "ShaderNodeBsdfPrincipled", Base_Color=PALE, Alpha=0.5, Specular_IOR_Level=0.0)
    stage.grid("Curtain", 2.5, 2.5, 2, cloth, location=(0.0, 0.0, 0.9))
    stage.lamp("AREA", shape="DISK", size=0.5)
    return [floor]


@case("The curtain itself, lit from behind", quantity="Radiosity")
def curtain_itself() -> list[Any]:
    """What the half of it that is cloth reflects."""
    floor = stage.room()
    cloth = stage.material("Cloth", "ShaderNodeBsdfPrincipled", Base_Color=PALE, Alpha=0.5, Specular_IOR_Level=0.0)
    hung = stage.grid("Curtain", 1.5, 1.5, 6, cloth, location=(0.2, 0.0, 0.9), rotation=(0.0, 1.2, 0.0))
    stage.lamp("AREA", shape="DISK", size=0.5)
    del floor
    return [hung]


def leaf(size: int = 64) -> Any:
    """Return an image of a green leaf with five lobes, clear around it."""
    image = bpy.data.images.new("Leaf", size, size, alpha=True)
    x, y = np.meshgrid(*[(np.arange(size) + 0.5) / size * 2.0 - 1.0] * 2)
    pixels = np.empty((size, size, 4), dtype=np.float32)
    pixels[...] = (0.2, 0.6, 0.15, 1.0)
    pixels[..., 3] = np.hypot(x, y) < 0.6 + 0.3 * np.cos(5.0 * np.arctan2(y, x))
    image.pixels.foreach_set(pixels.reshape(-1))
    return image


@case("A leaf that a texture's alpha cuts out of its card")
def leaf_card() -> list[Any]:
    """The shadow of the leaf and not of the card."""
    floor = stage.room()
    bpy.data.objects.remove(bpy.data.objects["Board"])
    made = bpy.data.materials.new("Leaf")
    tree = stage.node_tree(made)
    node = stage.shader(tree, "ShaderNodeBsdfPrincipled", Specular_IOR_Level=0.0)
    texture = tree.nodes.new("ShaderNodeTexImage")
    texture.image = leaf()
    tree.links.new(texture.outputs["Color"], node.inputs["Base Color"])
    tree.links.new(texture.outputs["Alpha"], node.inputs["Alpha"])
    stage.show(tree, node)
    stage.grid("Card", 1.2, 1.2, 1, made, location=(0.0, 0.0, 0.6), rotation=(0.3, 0.2, 0.0))
    stage.lamp("AREA", shape="DISK", size=0.2)
    return [floor]


@case("A window of half-clear glass in a closed room", samples=2048)
def half_clear_window() -> list[Any]:
    """Light comes into the room through a Mix of Transparent and Diffuse alone, from the sky and by many bounces."""
    floor = stage.closed_room()
    made = bpy.data.materials.new("Smoked")
    tree = stage.node_tree(made)
    mix = tree.nodes.new("ShaderNodeMixShader")
    mix.inputs[0].default_value = 0.4
    tree.links.new(stage.shader(tree, "ShaderNodeBsdfTransparent").outputs[0], mix.inputs[1])
    tree.links.new(stage.shader(tree, "ShaderNodeBsdfDiffuse", Color=PALE).outputs[0], mix.inputs[2])
    stage.show(tree, mix)
    bpy.data.objects["Ceiling"].data.materials[0] = made
    stage.world(strength=2.0)
    return [floor]


@case("A pane of glass between a lamp and the floor", samples=16384)
def glass_pane() -> list[Any]:
    """Light goes through both of its surfaces, and a part of it is reflected."""
    floor = stage.room()
    glass = stage.material("Glass", "ShaderNodeBsdfGlass", Roughness=0.0, IOR=1.45)
    stage.box("Pane", (-2.0, -2.0, 0.9), (2.0, 2.0, 0.95), glass)
    stage.lamp("AREA", shape="DISK", size=0.5)
    return [floor]


@case("A closed room under a skylight of smoked glass", samples=2048)
def skylight() -> list[Any]:
    """Principled transmission of grey glass: all light in the room has come through it."""
    floor = stage.closed_room()
    grey = (0.7, 0.7, 0.7)
    glass = stage.material(
        "Glass", "ShaderNodeBsdfPrincipled", Base_Color=grey, Transmission_Weight=1.0, Roughness=0.0, IOR=1.45
    )
    bpy.data.objects.remove(bpy.data.objects["Ceiling"])
    stage.box("Pane", (-1.5, -1.5, 2.4), (1.5, 1.5, 2.45), glass)
    stage.world(strength=2.0)
    return [floor]


def paper() -> Any:
    """Return a material that reflects some of the light and sends some on to its other side."""
    made = bpy.data.materials.new("Paper")
    tree = stage.node_tree(made)
    mix = tree.nodes.new("ShaderNodeMixShader")
    mix.inputs[0].default_value = 0.6
    tree.links.new(stage.shader(tree, "ShaderNodeBsdfDiffuse", Color=PALE).outputs[0], mix.inputs[1])
    tree.links.new(stage.shader(tree, "ShaderNodeBsdfTranslucent", Color=(0.9, 0.6, 0.3)).outputs[0], mix.inputs[2])
    stage.show(tree, mix)
    return made


@case("A translucent shade around a lamp", samples=8192)
def translucent_shade() -> list[Any]:
    """All of the floor's light has come through paper, or was reflected where it went past it."""
    floor = stage.room()
    stage.box("Shade", (-0.35, -0.35, 0.9), (0.35, 0.35, 1.5), paper())
    stage.lamp("POINT", (0.05, -0.05, 1.2), shadow_soft_size=0.05, energy=30.0)
    return [floor]


@case("Translucent paper, lit from behind", quantity="Radiosity")
def translucent_paper() -> list[Any]:
    """What leaves the side that no lamp sees."""
    stage.room()
    hung = stage.grid("Paper", 1.5, 1.5, 6, paper(), location=(0.2, 0.0, 0.9), rotation=(0.0, 1.2, 0.0))
    stage.lamp("AREA", (-0.6, -0.2, 1.6), shape="DISK", size=0.5)
    return [hung]


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
