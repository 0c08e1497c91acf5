# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The scratch scene: Cycles evaluates in it, and the file is as it was before."""

import bpy
import numpy as np
import pytest
from radiosity_bake.operators.scratch import NoCyclesError, bake_in, scratch_scene

from tests.blender.making import add_cube, add_plane, colours_of, emission_material
from tests.blender.state import differences, file_state


def bake_emission(scene, material):
    """Return the colours that a plane of the material emits at its vertices."""
    mesh = bpy.data.meshes.new("Scratch")
    mesh.from_pydata([(0, 0, 0), (1, 0, 0), (0, 1, 0)], [], [(0, 1, 2)])
    mesh.materials.append(material)
    mesh.color_attributes.active_color = mesh.color_attributes.new("Values", "FLOAT_COLOR", "POINT")
    obj = bpy.data.objects.new("Scratch", mesh)
    scene.collection.objects.link(obj)
    bake_in(scene, obj, type="EMIT", target="VERTEX_COLORS")
    return colours_of(mesh, "Values")


def names():
    """Return the names and users of the datablocks that a bake may make."""
    kinds = ("scenes", "objects", "meshes", "materials", "images", "worlds", "collections", "node_groups", "lights")
    return {(kind, block.name_full, block.users) for kind in kinds for block in getattr(bpy.data, kind)}


def test_a_material_of_the_file_is_evaluated_in_linear_light_unclamped():
    with scratch_scene() as scene:
        colours = bake_emission(scene, emission_material(colour=(0.25, 0.5, 1.0, 1.0), strength=20.0))
    np.testing.assert_allclose(colours[:, :3], np.tile([5.0, 10.0, 20.0], (3, 1)), rtol=1e-6)


def test_the_file_is_as_before_with_its_selection_and_its_names():
    material = emission_material()
    add_cube(materials=[material], select=True)
    add_plane("Scratch")
    before, named = file_state(), names()
    with scratch_scene() as scene:
        bake_emission(scene, material)
    assert differences(before, file_state()) == []
    assert names() == named


def test_what_was_made_is_gone_after_a_failure_too():
    named = names()
    with pytest.raises(ZeroDivisionError), scratch_scene() as scene:
        bake_emission(scene, emission_material())
        bpy.data.images.new("Left over", 4, 4)
        raise ZeroDivisionError
    assert names() == named


def test_a_refused_bake_says_why_and_leaves_nothing():
    named = names()
    with pytest.raises(RuntimeError, match="not enabled for rendering"), scratch_scene() as scene:
        obj = bpy.data.objects.new("Hidden", bpy.data.meshes.new("Hidden"))
        scene.collection.objects.link(obj)
        obj.hide_render = True
        bake_in(scene, obj, type="EMIT", target="VERTEX_COLORS")
    assert names() == named


def test_the_render_result_of_the_scene_stays(tmp_path):
    scene = bpy.context.scene
    camera = bpy.data.objects.new("Camera", bpy.data.cameras.new("Camera"))
    scene.collection.objects.link(camera)
    scene.camera = camera
    scene.render.engine, scene.cycles.samples, scene.cycles.use_denoising = "CYCLES", 1, False
    scene.render.resolution_x = scene.render.resolution_y = 8
    scene.render.image_settings.file_format = "OPEN_EXR"
    scene.world = bpy.data.worlds.new("Sky")
    scene.world.color = (0.1, 0.2, 0.3)
    bpy.ops.render.render()
    result = bpy.data.images["Render Result"]
    result.save_render(str(tmp_path / "before.exr"))
    with scratch_scene() as scratch:
        bake_emission(scratch, emission_material())
    result.save_render(str(tmp_path / "after.exr"))
    before, after = (
        np.array(bpy.data.images.load(str(tmp_path / f"{name}.exr")).pixels) for name in ("before", "after")
    )
    assert before.any()
    np.testing.assert_array_equal(before, after)


def test_without_cycles_a_sentence_says_what_to_do():
    bpy.ops.preferences.addon_disable(module="cycles")
    try:
        with pytest.raises(NoCyclesError, match="Turn on Cycles"), scratch_scene():
            pass
    finally:
        bpy.ops.preferences.addon_enable(module="cycles")
