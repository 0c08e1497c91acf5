# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""What is written, and where."""

from __future__ import annotations

import json
from typing import Any

import bpy

from . import cycles, stage
from .cases import case


@case("Refined mesh, at the original's vertices", output="REFINED")
def refined_output() -> list[Any]:
    """The subdivided floor has the light of the original at its vertices."""
    floor = stage.room()
    stage.lamp("AREA", shape="SQUARE", size=0.5)
    return [floor]


def every_kind_of_light() -> list[Any]:
    """Return the floor of a room with a lamp, a panel that glows, and a world."""
    floor = stage.room()
    stage.lamp("AREA", shape="SQUARE", size=0.5, energy=5.0)
    stage.grid("Panel", 0.6, 0.6, 1, stage.glow(), location=(-0.5, 0.5, 1.3), rotation=(3.1416, 0, 0))
    stage.world((0.4, 0.6, 1.0), 0.2)
    # A rendering shows all of the light and cannot be compared.
    bpy.context.scene.camera = None
    return [floor]


@case("Direct light of a lamp, a panel and the world", light="DIRECT", output="REFINED")
def direct_only() -> list[Any]:
    """Cycles' bake with its Direct pass alone."""
    return every_kind_of_light()


@case("Indirect light of the same", light="INDIRECT", output="REFINED")
def indirect_only() -> list[Any]:
    """Cycles' bake with its Indirect pass alone."""
    return every_kind_of_light()


@case("Colours on vertices", domain="POINT")
def on_points() -> list[Any]:
    """One colour for all corners of a vertex."""
    floor = stage.room()
    stage.lamp("AREA", shape="SQUARE", size=0.5)
    return [floor]


def from_bytes(things: list[Any]) -> list[Any]:
    """Bake and return the bytes, multiplied by what the report says that they were divided by."""
    bpy.ops.radiosity.bake()
    maximum = json.loads(bpy.context.scene.radiosity.report)["exposure"]["Irradiance"]["maximum"]
    return [cycles.corner_colours(thing.data, "Irradiance") * maximum for thing in things]


@case("Colours in bytes, times the maximum that the report tells", data_type="BYTE", ours=from_bytes)
def in_bytes() -> list[Any]:
    """A byte has 256 steps, in sRGB."""
    floor = stage.room()
    stage.lamp("AREA", shape="SQUARE", size=0.5, energy=60.0)
    return [floor]


def key_light(things: list[Any]) -> list[Any]:
    """Bake with a second lamp and a sky in other light groups, and return the light of the first lamp's."""
    bpy.data.objects["Lamp"].lightgroup = "Key"
    other = stage.lamp("POINT", (-0.5, 0.5, 1.0), color=(0.1, 0.3, 1.0), shadow_soft_size=0.1)
    other.lightgroup = "Fill"
    stage.world((0.4, 0.6, 1.0), 0.5)
    for name in ("Key", "Fill"):
        bpy.context.view_layer.lightgroups.add(name=name)
    bpy.ops.radiosity.bake()
    return [cycles.corner_colours(thing.data, "Radiosity Key") for thing in things]


@case("The light group of one lamp of several", quantity="Radiosity", light_groups=True, ours=key_light)
def light_group() -> list[Any]:
    """For Cycles, the other lights are not there."""
    floor = stage.room()
    stage.lamp("AREA", shape="SQUARE", size=0.5)
    bpy.context.scene.camera = None
    return [floor]


def by_settings_of_objects(things: list[Any]) -> list[Any]:
    """Bake with other materials and visibility, and settings of ours in their place."""
    wall, board, panel = (bpy.data.objects[name] for name in ("Wall", "Board", "Panel"))
    wall.radiosity_settings.use_reflectance = True
    wall.radiosity_settings.reflectance = (
        wall.data.materials[0].node_tree.nodes["Diffuse BSDF"].inputs[0].default_value[:3]
    )
    wall.data.materials[0] = stage.paint("White", (0.9, 0.9, 0.9))
    board.visible_shadow = board.visible_diffuse = True
    board.radiosity_settings.casts = False
    panel.data.materials[0] = stage.glow()
    panel.radiosity_settings.emits = False
    bpy.ops.radiosity.bake()
    return [cycles.corner_colours(thing.data, "Irradiance") for thing in things]


@case("An object's own reflectance, one that does not cast, one that does not emit", ours=by_settings_of_objects)
def settings_of_objects() -> list[Any]:
    """For Cycles a wall of that colour, a board that shadow and diffuse rays pass, and a black panel."""
    floor = stage.room()
    board = bpy.data.objects["Board"]
    board.visible_shadow = board.visible_diffuse = False
    stage.grid("Panel", 0.4, 0.4, 1, stage.paint("Black", (0.0, 0.0, 0.0)), location=(0.5, 0.4, 0.5))
    stage.lamp("AREA", shape="SQUARE", size=0.5)
    bpy.context.scene.camera = None
    return [floor]


def range_of_frames(things: list[Any]) -> list[Any]:
    """Bake the range and return the colours of the frame that the scene is at."""
    scene = bpy.context.scene
    scene.frame_start, scene.frame_end = 1, 3
    bpy.ops.radiosity.bake_frames(frame_output="ATTRIBUTES")
    return [cycles.corner_colours(thing.data, f"Irradiance.{scene.frame_current:04d}") for thing in things]


@case("A frame of a range, in which lamp and board move", ours=range_of_frames)
def animation() -> list[Any]:
    """The last of three frames: of the light alone the first changes, of the place of the board the second."""
    floor = stage.room()
    lamp, board = stage.lamp("AREA", shape="SQUARE", size=0.5), bpy.data.objects["Board"]
    for frame, energy, height in ((1, 10.0, 0.6), (2, 20.0, 0.6), (3, 30.0, 0.8)):
        lamp.data.energy, board.location.z = energy, height
        lamp.data.keyframe_insert("energy", frame=frame)
        board.keyframe_insert("location", frame=frame)
    bpy.context.scene.frame_set(3)
    return [floor]
