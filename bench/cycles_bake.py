# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Cycles' own bake to vertices, in a process of its own: `python cycles_bake.py SCENE.npz BAKED.npz`.

Reads and writes plain arrays (see `bench.peers.cycles`), and imports nothing of ours.
"""

from __future__ import annotations

import os
import sys
import time
from collections.abc import Mapping
from typing import Any

import bpy
import numpy as np

ATTRIBUTE = "Baked"


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
    smooth = np.full(len(mesh.polygons), bool(arrays[f"smooth_{k}"]))
    mesh.polygons.foreach_set("use_smooth", smooth)
    mesh.color_attributes.new(ATTRIBUTE, "FLOAT_COLOR", "POINT")
    mesh.color_attributes.active_color = mesh.color_attributes[ATTRIBUTE]
    mesh.update()
    thing = bpy.data.objects.new(f"object_{k}", mesh)
    bpy.context.scene.collection.objects.link(thing)
    return thing


def set_up(arrays: Mapping[str, np.ndarray]) -> None:
    """Make Cycles a reference of itself: many bounces, no clamping, no denoising, a fixed number of samples."""
    scene = bpy.context.scene
    scene.render.engine = "CYCLES"
    cycles = scene.cycles
    cycles.device = "CPU"
    cycles.samples = int(arrays["samples"])
    cycles.use_adaptive_sampling = False
    cycles.use_denoising = False
    cycles.max_bounces = cycles.diffuse_bounces = int(arrays["bounces"])
    cycles.sample_clamp_direct = cycles.sample_clamp_indirect = 0.0
    cycles.caustics_reflective = cycles.caustics_refractive = False
    cycles.bake_type = "DIFFUSE"
    scene.render.bake.use_pass_direct = scene.render.bake.use_pass_indirect = True
    scene.render.bake.use_pass_color = False
    scene.render.bake.target = "VERTEX_COLORS"
    scene.world = bpy.data.worlds.new("World")
    scene.world.use_nodes = True
    background = scene.world.node_tree.nodes["Background"]
    background.inputs["Color"].default_value = (*(float(c) for c in arrays["world"]), 1.0)
    background.inputs["Strength"].default_value = 1.0


def main(given: str, answered: str) -> None:
    """Bake the scene of one file and write the vertices' values to the other."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    with np.load(given) as file:
        arrays = dict(file)
    set_up(arrays)
    count = sum(name.startswith("vertices_") for name in arrays)
    things = {k: make_object(arrays, k) for k in range(count)}
    wanted = [k for k in things if bool(arrays[f"baked_{k}"])]
    for k, thing in things.items():
        thing.select_set(k in wanted)
    bpy.context.view_layer.objects.active = things[wanted[0]]
    start, used = time.perf_counter(), sum(os.times()[:2])
    bpy.ops.object.bake(type="DIFFUSE")
    seconds, processor_seconds = time.perf_counter() - start, sum(os.times()[:2]) - used
    result: dict[str, np.ndarray] = {"seconds": np.array(seconds), "processor_seconds": np.array(processor_seconds)}
    for k in wanted:
        attribute = things[k].data.color_attributes[ATTRIBUTE]
        values = np.empty(4 * len(attribute.data), dtype=np.float32)
        attribute.data.foreach_get("color", values)
        result[f"irradiance_{k}"] = values.reshape(-1, 4)[:, :3].astype(np.float64)
    np.savez(answered, **result)


if __name__ == "__main__":
    main(*sys.argv[-2:])
