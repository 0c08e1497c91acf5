# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Plain arrays as objects of a Blender scene, for the scripts that run in a process of their own; nothing of ours."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import bpy
import numpy as np


def colour_material(name: str, reflectance: np.ndarray, emission: np.ndarray) -> Any:
    """Return a diffuse material that also glows, as ours do."""
    material = bpy.data.materials.new(name)
    material.use_nodes = True
    tree = material.node_tree
    tree.nodes.clear()
    output, diffuse = tree.nodes.new("ShaderNodeOutputMaterial"), tree.nodes.new("ShaderNodeBsdfDiffuse")
    diffuse.inputs["Color"].default_value = (*(float(c) for c in reflectance), 1.0)
    shader = diffuse.outputs[0]
    if np.any(emission > 0.0):
        strength = float(emission.max())
        glow, add = tree.nodes.new("ShaderNodeEmission"), tree.nodes.new("ShaderNodeAddShader")
        glow.inputs["Color"].default_value = (*(float(c) / strength for c in emission), 1.0)
        glow.inputs["Strength"].default_value = strength
        tree.links.new(add.inputs[0], shader)
        tree.links.new(add.inputs[1], glow.outputs[0])
        shader = add.outputs[0]
    tree.links.new(output.inputs["Surface"], shader)
    return material


def make_object(arrays: Mapping[str, np.ndarray], k: int) -> Any:
    """Return mesh `k` as an object of the scene, with a material for each pair of colours."""
    mesh = bpy.data.meshes.new(f"mesh_{k}")
    mesh.from_pydata(arrays[f"vertices_{k}"].tolist(), [], arrays[f"triangles_{k}"].tolist())
    colours = np.concatenate([arrays[f"reflectance_{k}"], arrays[f"emission_{k}"]], axis=1)
    kinds, of_triangle = np.unique(colours, axis=0, return_inverse=True)
    for i, kind in enumerate(kinds):
        mesh.materials.append(colour_material(f"material_{k}_{i}", kind[:3], kind[3:]))
    mesh.polygons.foreach_set("material_index", of_triangle.ravel().astype(np.int32))
    mesh.polygons.foreach_set("use_smooth", np.broadcast_to(arrays[f"smooth_{k}"], len(mesh.polygons)).astype(bool))
    mesh.update()
    thing = bpy.data.objects.new(f"object_{k}", mesh)
    bpy.context.scene.collection.objects.link(thing)
    return thing


def set_world(radiance: np.ndarray) -> None:
    """Give the scene a constant world."""
    world = bpy.data.worlds.new("World")
    world.use_nodes = True
    background = world.node_tree.nodes["Background"]
    background.inputs["Color"].default_value = (*(float(c) for c in radiance), 1.0)
    background.inputs["Strength"].default_value = 1.0
    bpy.context.scene.world = world
