# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The refined output: a new object in the place of its hidden original."""

import math
from functools import partial

import bpy
import numpy as np
import pytest
from mathutils import Matrix

from tests.blender.making import (
    add_collection,
    add_cube,
    add_mesh,
    add_object,
    add_plane,
    bake_selected,
    colours_of,
    corner_positions,
    diffuse_material,
    position_bake,
    select_also,
)

pytestmark = pytest.mark.usefixtures("quick_bake")


def bake(*objects):
    select_also(*objects)
    bake_selected("REFINED")
    return [bpy.data.objects[f"{obj.name} Radiosity"] for obj in objects]


def test_every_corner_carries_its_value_and_alpha_one():
    (output,) = bake(add_cube())
    assert len(output.data.polygons) == 24
    colours = colours_of(output.data)
    assert colours[:, :3] == pytest.approx(corner_positions(output), abs=1e-6)
    assert np.all(colours[:, 3] == 1.0)
    assert colours_of(output.data, "Irradiance")[:, :3] == pytest.approx(0.5 * colours[:, :3], abs=1e-6)


def test_attributes_are_float_colours_of_corners_and_radiosity_is_active():
    (output,) = bake(add_cube())
    colours = output.data.color_attributes
    assert [(a.name, a.data_type, a.domain) for a in colours] == [
        ("Radiosity", "FLOAT_COLOR", "CORNER"),
        ("Irradiance", "FLOAT_COLOR", "CORNER"),
    ]
    assert colours.active_color.name == "Radiosity"
    assert colours[colours.render_color_index].name == "Radiosity"


def test_the_refined_object_takes_the_place_of_its_original():
    collection = add_collection("Room")
    parent = add_object("Parent", None)
    parent.scale = (1.0, 3.0, 1.0)
    cube = add_cube(collection=collection)
    cube.parent, cube.location, cube.rotation_euler = parent, (1.0, 2.0, 3.0), (0.1, 0.5, 0.9)
    cube.matrix_parent_inverse = Matrix.Translation((4.0, 0.0, 0.0))
    (output,) = bake(cube)
    assert output.parent == parent
    assert [c.name for c in output.users_collection] == ["Room"]
    bpy.context.view_layer.update()
    # A parent scaled unevenly shears: copying location, rotation and scale alone would not do.
    assert np.array(output.matrix_world) == pytest.approx(np.array(cube.matrix_world), abs=1e-6)
    assert colours_of(output.data)[:, :3] == pytest.approx(corner_positions(output), abs=1e-5)


def test_the_original_is_hidden_and_the_refined_object_selected_and_active():
    cube = add_cube()
    (output,) = bake(cube)
    assert cube.hide_render and cube.hide_viewport and cube.hide_get()
    assert not output.hide_render and output.visible_get()
    assert bpy.context.selected_objects == [output]
    assert bpy.context.object == output


def test_constraints_and_settings_of_the_object_are_kept_but_not_its_modifiers():
    cube = add_cube()
    cube.constraints.new("COPY_LOCATION").target = add_object("Target", None)
    cube.modifiers.new("Subdivision", "SUBSURF")
    cube.pass_index, cube["mine"] = 7, 42
    (output,) = bake(cube)
    assert len(output.constraints) == 1
    assert len(output.modifiers) == 0
    assert (output.pass_index, output["mine"]) == (7, 42)


def front_faces_outwards(obj):
    matrix = np.array(obj.matrix_world)
    for polygon in obj.data.polygons:
        a, b, c = (matrix[:3, :3] @ np.array(obj.data.vertices[v].co) for v in polygon.vertices)
        mirrored = -1.0 if np.linalg.det(matrix[:3, :3]) < 0.0 else 1.0
        if mirrored * np.cross(b - a, c - a) @ (a + b + c) <= 0.0:
            return False
    return True


@pytest.mark.parametrize("scale", [(1.0, 1.0, 1.0), (-1.0, 1.0, 1.0), (-0.5, -2.0, -1.0)])
def test_the_front_stays_outside_in_mirrored_objects(scale):
    cube = add_cube()
    cube.scale = scale
    (output,) = bake(cube)
    assert front_faces_outwards(output)
    assert not any(polygon.use_smooth for polygon in output.data.polygons)
    assert colours_of(output.data)[:, :3] == pytest.approx(corner_positions(output), abs=1e-6)


def test_an_object_flattened_by_its_scale_is_baked_in_world_space():
    cube = add_cube()
    cube.location, cube.scale = (5.0, 6.0, 7.0), (1.0, 1.0, 0.0)
    cube.delta_location = (1.0, 0.0, 0.0)
    (output,) = bake(cube)
    bpy.context.view_layer.update()
    assert np.array(output.matrix_world) == pytest.approx(np.eye(4))
    positions = corner_positions(output)
    assert positions.min(axis=0) == pytest.approx([5.0, 5.0, 7.0])
    assert positions.max(axis=0) == pytest.approx([7.0, 7.0, 7.0])


def test_vertices_far_from_the_origin_keep_their_exact_local_places():
    cube = add_cube()
    cube.location = (65536.0, 0.0, 0.0)
    cube.data.vertices[0].co.x = -1.0001
    (output,) = bake(cube)
    assert output.data.vertices[0].co == cube.data.vertices[0].co


def test_a_flat_object_stays_flat():
    (output,) = bake(add_cube())
    assert not output.data.has_custom_normals
    assert not any(polygon.use_smooth for polygon in output.data.polygons)


def test_a_smooth_object_keeps_its_corner_normals():
    cube = add_cube()
    cube.data.shade_smooth()
    (output,) = bake(cube)
    normals = np.array([normal.vector for normal in output.data.corner_normals])
    expected = corner_positions(output)
    expected /= np.linalg.norm(expected, axis=1, keepdims=True)
    original = np.abs(corner_positions(output)).min(axis=1) > 0.99
    assert np.einsum("ij,ij->i", normals, expected)[original].min() > 0.999


def test_slots_are_kept_in_number_and_faces_keep_their_slot():
    cube = add_cube(materials=[diffuse_material("Red"), diffuse_material("Blue"), diffuse_material("Unused")])
    cube.data.polygons[5].material_index = 1
    (output,) = bake(cube)
    assert len(output.material_slots) == 3
    on_top = [polygon.material_index for polygon in output.data.polygons if polygon.normal.z > 0.9]
    assert on_top == [1] * 4
    assert sorted({polygon.material_index for polygon in output.data.polygons}) == [0, 1]


def display_of(obj):
    (material,) = {slot.material for slot in obj.material_slots}
    return material


def test_the_display_material_emits_the_attribute_at_strength_one():
    (output,) = bake(add_cube())
    nodes = display_of(output).node_tree.nodes
    (emission,) = (node for node in nodes if node.type == "EMISSION")
    (colour,) = (node for node in nodes if node.type == "VERTEX_COLOR")
    assert colour.layer_name == "Radiosity"
    assert emission.inputs["Strength"].default_value == 1.0
    assert emission.inputs["Color"].links[0].from_node == colour


def test_all_objects_share_one_display_material():
    first, second = bake(add_cube("A"), add_plane("B"))
    assert display_of(first) == display_of(second)


def test_values_of_the_back_are_stored_and_shown_on_the_back(run_instead):
    run_instead(partial(position_bake, back=True))
    (output,) = bake(add_plane())
    assert colours_of(output.data, "Radiosity Back")[:, :3] == pytest.approx(-corner_positions(output), abs=1e-6)
    assert "Irradiance Back" in output.data.color_attributes
    assert output.data.color_attributes.active_color.name == "Radiosity"
    layers = {node.layer_name for node in display_of(output).node_tree.nodes if node.type == "VERTEX_COLOR"}
    assert layers == {"Radiosity", "Radiosity Back"}


def test_the_original_mesh_and_materials_are_untouched():
    material = diffuse_material()
    cube = add_cube(materials=[material])
    bake(cube)
    assert len(cube.data.color_attributes) == 0
    assert cube.data.materials[0] == material


def test_baking_again_replaces_the_first_result():
    cube = add_cube()
    bake(cube)
    assert [obj.name for obj in bpy.context.selected_objects] == ["Cube Radiosity"]
    assert bpy.ops.radiosity.bake() == {"FINISHED"}
    assert sorted(obj.name for obj in bpy.data.objects) == ["Cube", "Cube Radiosity"]
    assert sorted(mesh.name for mesh in bpy.data.meshes) == ["Cube", "Cube Radiosity"]
    assert len(bpy.data.objects["Cube Radiosity"].data.polygons) == 24


def test_a_baked_object_takes_part_in_the_next_bake_with_its_own_materials(quick_bake):
    cube, plane = add_cube(materials=[diffuse_material(colour=(0.25, 0.5, 0.75, 1.0))]), add_plane()
    bake(cube)
    bpy.ops.object.select_all(action="DESELECT")
    bake(plane)
    meshes = {mesh.name: mesh for mesh in quick_bake[-1][0].meshes}
    assert sorted(meshes) == ["Cube", "Plane"]
    assert not meshes["Cube"].baked
    assert meshes["Cube"].reflectance[0] == pytest.approx([0.25, 0.5, 0.75])
    assert not np.any(meshes["Cube"].emission)


def test_triangles_that_a_mesh_cannot_hold_do_not_spoil_the_others():
    mesh = add_mesh("Sliver", [(0, 0, 0), (1, 0, 0), (2, 0, 0), (0, 1, 0)], [(0, 1, 2), (0, 1, 3)])
    (output,) = bake(mesh)
    assert colours_of(output.data)[:, :3] == pytest.approx(corner_positions(output), abs=1e-6)


def test_many_objects_are_baked_at_once():
    outputs = bake(*(add_cube(f"Cube {number}") for number in range(5)))
    assert len(outputs) == 5
    assert len(bpy.context.selected_objects) == 5


def test_an_animated_original_hides_behind_a_refined_object_that_moves_with_it():
    cube = add_cube()
    cube.keyframe_insert("location", frame=1)
    cube.location.x = 10.0
    cube.keyframe_insert("location", frame=11)
    bpy.context.scene.frame_set(1)
    (output,) = bake(cube)
    bpy.context.scene.frame_set(11)
    assert math.isclose(output.matrix_world.translation.x, 10.0, abs_tol=1e-5)
