# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""What a material means for radiosity: its reflectance and emission, read from its nodes.

They are constants, or vary over the mesh as far as they follow from images and colour attributes. What needs any other
node is named, for Blender to evaluate it.
"""

from dataclasses import replace

import bpy
import numpy as np

from .display import is_display
from .gloss import mean_gloss
from .shaders import GREY, ShaderReader
from .surface import Colour, Surface, alike, surface_of
from .varying import varies

_GLOSS_WITHOUT_MATERIAL = (0.5, 1.5)
"""Its roughness and index of refraction from Blender 5 on: those of a new Principled BSDF."""


def uses_nodes(owner: bpy.types.Material | bpy.types.World | bpy.types.Light) -> bool:
    """Return whether a material, world or lamp is made of nodes."""
    # From Blender 5.0 on nodes are always used, and asking warns that the property goes away.
    return owner.node_tree is not None and (bpy.app.version >= (5, 0, 0) or owner.use_nodes)


def material_surface(material: bpy.types.Material | None) -> Surface:
    """Return what `material` does to light; None is the grey of a mesh without a material."""
    if material is None:
        share = mean_gloss(*_GLOSS_WITHOUT_MATERIAL) if bpy.app.version >= (5, 0, 0) else 0.0
        return surface_of(GREY, mirrored=share, covered=share)
    if is_display(material):
        return surface_of(GREY, notes=["it shows an earlier bake; plain grey was used instead"])
    if not uses_nodes(material):
        return surface_of(np.clip(material.diffuse_color[:3], 0.0, 1.0))
    shader = _sided(material.node_tree)
    if _is_displaced(material):
        shader = replace(shader, notes=(*shader.notes, "its displacement is left out; a Displace modifier takes part"))
    elif _is_bumped(material):
        shader = replace(shader, notes=(*shader.notes, "its bump is left out; the mesh's own normals count"))
    if varies(shader.reflectance):
        return shader
    reflectance = np.clip(shader.reflectance, 0.0, 1.0)
    if np.any(reflectance != shader.reflectance):
        notes = (*shader.notes, "its colour is brighter than white; white was used instead")
        return replace(shader, reflectance=reflectance, notes=notes)
    return shader


def _sided(tree: bpy.types.NodeTree) -> Surface:
    """Return what a material does to light; of what its back does otherwise, only to be dark is understood."""
    reader = ShaderReader(tree, with_textures=True)
    front = reader.surface()
    if not reader.asked_for_side or front.clear:
        return front
    back = ShaderReader(tree, with_textures=True, back=True).surface()
    front_only = not varies(back.emission) and not np.any(back.emission)
    same = front_only or alike(front.emission, back.emission)
    if same and (alike(front.reflectance, back.reflectance) or back.clear):
        return replace(front, front_only=front_only)
    note = "it looks otherwise from behind; its front counts, but for emission that ends there"
    return replace(front, front_only=front_only, notes=(*front.notes, note))


def _is_displaced(material: bpy.types.Material) -> bool:
    """Return whether Cycles moves the surface itself."""
    return material.displacement_method != "BUMP" and _has_displacement(material)


def _is_bumped(material: bpy.types.Material) -> bool:
    """Return whether Cycles turns normals in place of moving the surface."""
    return material.displacement_method == "BUMP" and _has_displacement(material)


def _has_displacement(material: bpy.types.Material) -> bool:
    output = material.node_tree.get_output_node("CYCLES")
    return output is not None and output.inputs["Displacement"].is_linked


def constant_emission(owner: bpy.types.World | bpy.types.Light) -> tuple[Colour, tuple[str, ...]]:
    """Return what the nodes of a world or lamp emit as far as they are constants, and what was skipped of them.

    Returns
    -------
    emission : (3,) float
    notes : tuple of str
    """
    shader = ShaderReader(owner.node_tree).surface()
    return shader.emission, shader.notes
