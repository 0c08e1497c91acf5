# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The material and the viewport shading that show baked colours."""

from collections.abc import Iterable
from contextlib import suppress

import bpy

from .journal import Journal

RADIOSITY = "Radiosity"
IRRADIANCE = "Irradiance"
RADIOSITY_BACK = "Radiosity Back"
IRRADIANCE_BACK = "Irradiance Back"
ATTRIBUTES = (RADIOSITY, IRRADIANCE, RADIOSITY_BACK, IRRADIANCE_BACK)

MARK = "radiosity_display"
"""Custom property that tells our materials from the user's, whatever they are renamed to."""
_NAMES = {"FRONT": "Radiosity Display", "BOTH": "Radiosity Display Two-Sided"}


def is_display(material: bpy.types.Material | None) -> bool:
    """Return whether `material` is one that a bake made to show its colours."""
    return material is not None and MARK in material


def display_material(both_sides: bool, journal: Journal) -> bpy.types.Material:
    """Return the material that shows the attribute `Radiosity`, made anew if the file has none.

    Parameters
    ----------
    both_sides : bool
        Whether the back of a face shows the attribute `Radiosity Back` instead.
    """
    sides = "BOTH" if both_sides else "FRONT"
    for material in bpy.data.materials:
        if material.library is None and material.get(MARK) == sides:
            return material
    material = new_material(_NAMES[sides], journal)
    mark(material, sides)
    _build_nodes(material.node_tree, both_sides)
    return material


def new_material(name: str, journal: Journal) -> bpy.types.Material:
    """Return a new material that is made of nodes."""
    material = bpy.data.materials.new(name)
    journal.on_failure(bpy.data.materials.remove, material)
    if bpy.app.version < (5, 0, 0):
        material.use_nodes = True
    return material


def mark(material: bpy.types.Material, kind: str) -> None:
    """Have `material` known as one of ours."""
    material[MARK] = kind
    # The colours hold all the light there is: to sample them as lamps as well would only cost Cycles time.
    if hasattr(material, "cycles"):
        material.cycles.emission_sampling = "NONE"


def _build_nodes(tree: bpy.types.NodeTree, both_sides: bool) -> None:
    tree.nodes.clear()
    front = _emission_of_attribute(tree, RADIOSITY, 0.0)
    # The glTF exporter of Blender knows an unlit material with vertex colours by a switch for camera rays.
    switch = tree.nodes.new("ShaderNodeMixShader")
    switch.location = (400.0, 0.0)
    rays = tree.nodes.new("ShaderNodeLightPath")
    rays.location = (200.0, 300.0)
    tree.links.new(rays.outputs["Is Camera Ray"], switch.inputs[0])
    tree.links.new(front.outputs[0], switch.inputs[1])
    tree.links.new(front.outputs[0], switch.inputs[2])
    _output(tree, switch, "ALL", 0.0)
    if not both_sides:
        return
    back = _emission_of_attribute(tree, RADIOSITY_BACK, -200.0)
    geometry = tree.nodes.new("ShaderNodeNewGeometry")
    geometry.location = (200.0, -300.0)
    mix = tree.nodes.new("ShaderNodeMixShader")
    mix.location = (400.0, -200.0)
    tree.links.new(geometry.outputs["Backfacing"], mix.inputs[0])
    tree.links.new(front.outputs[0], mix.inputs[1])
    tree.links.new(back.outputs[0], mix.inputs[2])
    # What is for one renderer goes before what is for all, which is all that the exporter looks at.
    _output(tree, mix, "CYCLES", -200.0)
    _output(tree, mix, "EEVEE", -400.0)


def _output(tree: bpy.types.NodeTree, shader: bpy.types.Node, target: str, height: float) -> None:
    output = tree.nodes.new("ShaderNodeOutputMaterial")
    output.target = target
    output.location = (600.0, height)
    tree.links.new(shader.outputs[0], output.inputs["Surface"])


def _emission_of_attribute(tree: bpy.types.NodeTree, name: str, height: float) -> bpy.types.Node:
    colour = tree.nodes.new("ShaderNodeVertexColor")
    colour.layer_name = name
    colour.location = (0.0, height)
    emission = tree.nodes.new("ShaderNodeEmission")
    emission.inputs["Strength"].default_value = 1.0
    emission.location = (200.0, height)
    tree.links.new(colour.outputs["Color"], emission.inputs["Color"])
    return emission


def remove_unused_display_materials() -> None:
    """Remove our materials that no object shows any more."""
    for material in list(bpy.data.materials):
        if is_display(material) and material.users - material.use_fake_user <= 0:
            bpy.data.materials.remove(material)


def show_in_viewport(context: bpy.types.Context, objects: Iterable[bpy.types.Object]) -> None:
    """Let the viewport that the bake was started from show `objects`, and their colours if it is solid.

    Studio light on top of baked light would show something that is neither, so the colours are shown unshaded.
    """
    space = context.space_data
    if getattr(space, "local_view", None) is not None:
        for obj in objects:
            obj.local_view_set(space, True)
    shading = getattr(space, "shading", None)
    if shading is None or shading.type != "SOLID" or shading.color_type == "VERTEX":
        return
    context.scene.radiosity.shading_before = f"{shading.color_type} {shading.light}"
    shading.color_type, shading.light = "VERTEX", "FLAT"


def show_as_before(context: bpy.types.Context) -> None:
    """Take back what `show_in_viewport` did, if the viewport still shows it."""
    settings = context.scene.radiosity
    shading = getattr(context.space_data, "shading", None)
    if shading is None or not settings.shading_before:
        return
    if shading.type == "SOLID" and (shading.color_type, shading.light) == ("VERTEX", "FLAT"):
        # Another Blender version may not know the value that this one wrote.
        with suppress(TypeError, ValueError):
            shading.color_type, shading.light = settings.shading_before.split()
    settings.shading_before = ""
