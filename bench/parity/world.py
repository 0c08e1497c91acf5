# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Light from outside of the scene."""

from __future__ import annotations

from typing import Any

import bpy
import numpy as np

from . import stage
from .cases import case


@case("Constant world")
def world_constant() -> list[Any]:
    """A blue sky without a texture over an open scene."""
    floor = stage.room()
    stage.world((0.4, 0.6, 1.0), 1.5)
    return [floor]


def nodes(kind: str, **values: Any) -> tuple[Any, Any]:
    """Give the scene a world whose background is a node's first output; returns the node and its tree."""
    made = bpy.data.worlds.new("World")
    tree = stage.node_tree(made)
    node = tree.nodes.new(kind)
    for name, value in values.items():
        setattr(node, name, value)
    stage.show(tree, stage.shader(tree, "ShaderNodeBackground", Color=node.outputs[0]))
    bpy.context.scene.world = made
    return node, tree


def sky(elevation: float = 35.0, strength: float = 0.1, **values: Any) -> Any:
    """Give the scene the sky of the version's best model, with its sun, and return the node."""
    kinds = [item.identifier for item in bpy.types.ShaderNodeTexSky.bl_rna.properties["sky_type"].enum_items]
    kind = "NISHITA" if "NISHITA" in kinds else "MULTIPLE_SCATTERING"
    place = {"sun_elevation": np.radians(elevation), "sun_rotation": np.radians(150.0)}
    node, tree = nodes("ShaderNodeTexSky", **{"sky_type": kind, **place, **values})
    next(n for n in tree.nodes if n.type == "BACKGROUND").inputs["Strength"].default_value = strength
    return node


def photograph(width: int = 1024) -> Any:
    """Return an equirectangular image of clouds with a sun of two by two texels that has half of the light."""
    height = width // 2
    latitude = (np.arange(height) + 0.5)[:, None] / height * np.pi - np.pi / 2.0
    longitude = (np.arange(width) + 0.5) / width * 2.0 * np.pi
    light = np.where(latitude > 0.0, 0.3 + 0.5 * np.sin(latitude), 0.1) + 0.0 * longitude
    drawn = np.random.default_rng(3)
    for _ in range(60):
        a, b = drawn.uniform(0.0, 2.0 * np.pi), drawn.uniform(0.05, 1.4)
        cosine = np.cos(latitude) * np.cos(b) * np.cos(longitude - a) + np.sin(latitude) * np.sin(b)
        light += 1.5 * np.exp((cosine - 1.0) * 200.0)
    pixels = np.ones((height, width, 4), dtype=np.float32)
    pixels[..., :3] = light[..., None] * [0.6, 0.8, 1.0]
    row, column = round(0.8 * height), round(0.2 * width)
    pixels[row : row + 2, column : column + 2, :3] = [6e4, 5e4, 4e4]
    return float_image(pixels)


def float_image(pixels: Any) -> Any:
    """Return a linear image of (h, w, 4) values, rows from below."""
    height, width, _ = pixels.shape
    image = bpy.data.images.new("Photograph", width, height, float_buffer=True, is_data=True)
    image.pixels.foreach_set(pixels.ravel())
    image.update()
    image.pack()
    return image


def environment(image: Any, turn: tuple[float, float, float], projection: str = "EQUIRECTANGULAR") -> None:
    """Give the scene an environment texture, turned by a Mapping node."""
    node, tree = nodes("ShaderNodeTexEnvironment", image=image, projection=projection)
    mapping = stage.shader(tree, "ShaderNodeMapping", Vector=tree.nodes.new("ShaderNodeTexCoord").outputs["Generated"])
    mapping.inputs["Rotation"].default_value = turn
    tree.links.new(mapping.outputs[0], node.inputs["Vector"])


def windowed_room() -> Any:
    """Return the floor of a closed room whose right wall has a window of 1 x 1 m."""
    floor = stage.closed_room()
    wall = bpy.data.objects["Right"]
    green = wall.data.materials[0]
    bpy.data.objects.remove(wall)
    a, h, low, high, half = 1.5, 2.4, 0.9, 1.9, 0.5
    y, z = (-a, -half, half, a), (0.0, low, high, h)
    corners = [(a, p, q) for q in z for p in y]
    quads = [(4 * j + i + 1, 4 * j + i, 4 * j + i + 4, 4 * j + i + 5) for j in range(3) for i in range(3)]
    stage.mesh("Right", corners, [quad for k, quad in enumerate(quads) if k != 4], green)
    return floor


@case("Sky texture with its sun, over an open scene")
def world_sky() -> list[Any]:
    """A floor, a wall and a board under a clear sky."""
    floor = stage.room()
    sky()
    return [floor]


@case("Sky texture at sunset")
def world_sunset() -> list[Any]:
    """A low sun with much glow around it."""
    floor = stage.room()
    sky(8.0, 0.2)
    return [floor]


@case("Sky texture without its sun")
def world_sky_without_sun() -> list[Any]:
    """The blue alone."""
    floor = stage.room()
    sky(sun_disc=False)
    return [floor]


@case("Room with a window under a sky with sun", samples=2048)
def world_window() -> list[Any]:
    """All light comes through a window, most of it as a sunbeam."""
    floor = windowed_room()
    sky(30.0, 0.3, sun_rotation=np.radians(75.0))
    return [floor]


@case("Environment texture with a tiny bright sun, turned by a Mapping node")
def world_environment() -> list[Any]:
    """A photograph of clouds, of which four texels have half of the light."""
    floor = stage.room()
    environment(photograph(), (0.1, -0.2, 0.7))
    return [floor]


@case("Photograph with other hue and saturation, and a sun lamp")
def world_photograph_and_sun() -> list[Any]:
    """Two suns, one of them in the picture, whose colours go through a Hue/Saturation/Value node."""
    floor = stage.room()
    environment(photograph(), (0.0, 0.0, 0.4))
    tree = bpy.context.scene.world.node_tree
    background, image = (next(n for n in tree.nodes if n.type == kind) for kind in ("BACKGROUND", "TEX_ENVIRONMENT"))
    changed = stage.shader(tree, "ShaderNodeHueSaturation", Hue=0.6, Saturation=1.4, Value=0.5, Color=image.outputs[0])
    tree.links.new(changed.outputs[0], background.inputs["Color"])
    stage.lamp("SUN", turn=(0.4, 0.5, 0.0), angle=0.05)
    return [floor]


@case("Mirror ball")
def world_mirror_ball() -> list[Any]:
    """The other projection of environment textures."""
    floor = stage.room()
    environment(photograph(512), (0.0, 0.0, 0.4), "MIRROR_BALL")
    return [floor]


@case("World of procedural nodes, with another look for the camera")
def world_nodes() -> list[Any]:
    """Bands of a wave texture; the camera alone sees red."""
    floor = stage.room()
    wave, tree = nodes("ShaderNodeTexWave")
    coordinates = tree.nodes.new("ShaderNodeTexCoord")
    tree.links.new(coordinates.outputs["Generated"], wave.inputs["Vector"])
    wave.inputs["Scale"].default_value = 0.7
    tree.links.new(wave.outputs["Color"], next(n for n in tree.nodes if n.type == "BACKGROUND").inputs["Color"])
    red = stage.shader(tree, "ShaderNodeBackground", Color=(1.0, 0.0, 0.0))
    plain = next(n for n in tree.nodes if n.type == "BACKGROUND" and n != red)
    mix = tree.nodes.new("ShaderNodeMixShader")
    tree.links.new(tree.nodes.new("ShaderNodeLightPath").outputs["Is Camera Ray"], mix.inputs[0])
    tree.links.new(plain.outputs[0], mix.inputs[1])
    tree.links.new(red.outputs[0], mix.inputs[2])
    stage.show(tree, mix)
    return [floor]


@case("Street corner under a sky")
def world_street() -> list[Any]:
    """Two houses at a corner, a kerb and a lamp post, in evening sun."""
    brick, plaster = stage.paint("Brick", (0.45, 0.18, 0.12)), stage.paint("Plaster", (0.75, 0.7, 0.6))
    asphalt = stage.paint("Asphalt", (0.12, 0.12, 0.13))
    # What stands on something stands on the yard, so that all of the street's vertices lie open.
    street = stage.grid("Street", 16.0, 8.0, 20, asphalt, location=(0.0, -4.0, 0.0))
    stage.mesh("Yard", [(-8, 0, 0), (8, 0, 0), (8, 8, 0), (-8, 8, 0)], [(0, 1, 2, 3)], asphalt)
    stage.box("House", (-7.0, 1.05, -0.01), (-1.05, 7.0, 6.0), brick)
    stage.box("Shop", (1.05, 1.05, -0.01), (7.0, 7.0, 4.5), plaster)
    stage.box("Kerb", (-7.0, 0.05, -0.01), (-1.05, 1.0, 0.15), plaster)
    stage.box("Post", (-0.93, 0.07, -0.01), (-0.85, 0.15, 4.0), plaster)
    sky(25.0, 0.2)
    stage.camera((5.0, -7.5, 4.0), (-0.5, 1.5, 1.5), 30.0)
    return [street]
