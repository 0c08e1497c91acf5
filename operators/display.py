# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The material and the viewport shading that show baked colours."""

from collections.abc import Iterable
from contextlib import suppress
from dataclasses import dataclass

import bpy

from .journal import Journal


@dataclass(frozen=True)
class Shown:
    """What of a baked mesh a display material shows.

    Attributes
    ----------
    front : str
        Name of the attribute.
    back : str or None
        That of the back, if it is to be seen.
    strength : float
        What values of 1 in the attributes stand for.
    emits : bool
        Whether what surfaces emit is to be seen, where that is not in the attribute.
    """

    front: str
    back: str | None = None
    strength: float = 1.0
    emits: bool = True


MARK = "radiosity_display"
"""Custom property that tells our materials from the user's, whatever they are renamed to."""


def is_display(material: bpy.types.Material | None) -> bool:
    """Return whether `material` is one that a bake made to show its colours."""
    return material is not None and MARK in material


def display_material(shown: Shown, journal: Journal) -> bpy.types.Material:
    """Return the material that shows an attribute as it is, made anew if the file has none."""
    kind = f"PLAIN {shown}"
    for material in bpy.data.materials:
        if material.library is None and material.get(MARK) == kind:
            return material
    material = new_material("Radiosity Display" if shown.back is None else "Radiosity Display Two-Sided", journal)
    mark(material, kind)
    _build_nodes(material.node_tree, shown)
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


def _build_nodes(tree: bpy.types.NodeTree, shown: Shown) -> None:
    tree.nodes.clear()
    front = _emission_of_attribute(tree, shown.front, shown.strength, 0.0)
    # The glTF exporter of Blender knows an unlit material with vertex colours by a switch for camera rays.
    switch = tree.nodes.new("ShaderNodeMixShader")
    switch.location = (400.0, 0.0)
    rays = tree.nodes.new("ShaderNodeLightPath")
    rays.location = (200.0, 300.0)
    tree.links.new(rays.outputs["Is Camera Ray"], switch.inputs[0])
    tree.links.new(front.outputs[0], switch.inputs[1])
    tree.links.new(front.outputs[0], switch.inputs[2])
    _output(tree, switch, "ALL", 0.0)
    if shown.back is None:
        return
    back = _emission_of_attribute(tree, shown.back, shown.strength, -200.0)
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


def _emission_of_attribute(tree: bpy.types.NodeTree, name: str, strength: float, height: float) -> bpy.types.Node:
    colour = tree.nodes.new("ShaderNodeVertexColor")
    colour.layer_name = name
    colour.location = (0.0, height)
    emission = tree.nodes.new("ShaderNodeEmission")
    emission.inputs["Strength"].default_value = strength
    emission.location = (200.0, height)
    tree.links.new(colour.outputs["Color"], emission.inputs["Color"])
    return emission


def remove_unused_display_materials() -> None:
    """Remove our materials that no object shows any more."""
    for material in list(bpy.data.materials):
        if is_display(material) and material.users - material.use_fake_user <= 0:
            bpy.data.materials.remove(material)
    remove_unused_groups()


def remove_unused_groups() -> None:
    """Remove our copies of node groups that none of our materials uses any more, outer ones first."""
    while True:
        unused = [group for group in bpy.data.node_groups if MARK in group and group.users - group.use_fake_user <= 0]
        if not unused:
            return
        bpy.data.batch_remove(unused)


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
