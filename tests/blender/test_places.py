# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Refined objects that are moved, and pairs of which one was deleted."""

import bpy
import numpy as np
import pytest
from mathutils import Matrix

from tests.blender.making import (
    add_cube,
    add_object,
    add_plane,
    bake_selected,
    colours_of,
    corner_positions,
    diffuse_material,
    full_disk,
    report,
)
from tests.blender.state import differences, file_state

pytestmark = pytest.mark.usefixtures("quick_bake")


def refined(name):
    return bpy.data.objects[f"{name} Radiosity"]


def baked_cube(prepare=lambda cube: None):
    cube = add_cube("Cube", materials=[diffuse_material("Paint")], select=True)
    prepare(cube)
    bake_selected("REFINED")
    return cube, refined("Cube")


def matrix(obj):
    bpy.context.view_layer.update()
    return np.array(obj.matrix_world)


def with_parent(cube):
    cube.parent, cube.parent.scale = add_object("Parent", None), (1.0, 3.0, 1.0)
    cube.matrix_parent_inverse = Matrix.Translation((4.0, 0.0, 0.0))


def with_constraint(cube):
    cube.constraints.new("COPY_SCALE").target = add_object("Target", None)


def animated(cube):
    cube.keyframe_insert("location", frame=1)


def turned_by_quaternion(cube):
    cube.rotation_mode, cube.delta_location = "QUATERNION", (1.0, 0.0, 0.0)


@pytest.mark.parametrize("prepare", [lambda cube: None, with_parent, with_constraint, turned_by_quaternion])
def test_a_refined_object_that_was_moved_is_baked_where_it_is(prepare):
    cube, output = baked_cube(prepare)
    output.location, output.scale = (5.0, 0.0, 0.0), (1.0, 2.0, 1.0)
    output.rotation_euler, output.rotation_quaternion = (0.1, 0.2, 0.3), (0.6, 0.8, 0.0, 0.0)
    moved = matrix(output)
    bake_selected("REFINED")
    assert matrix(refined("Cube")) == pytest.approx(moved, abs=1e-6)
    assert colours_of(refined("Cube").data)[:, :3] == pytest.approx(corner_positions(refined("Cube")), abs=1e-5)
    assert report()["warnings"] == []
    bpy.ops.radiosity.restore()
    assert matrix(cube) == pytest.approx(moved, abs=1e-6)


def test_restore_keeps_a_move_and_brings_all_else_back():
    cube = add_cube("Cube", materials=[diffuse_material("Paint")], select=True)
    before = file_state()
    bake_selected("REFINED")
    output = refined("Cube")
    output.matrix_world = Matrix.Translation((1.0, 2.0, 3.0))
    bpy.ops.radiosity.restore()
    assert tuple(cube.location) == (1.0, 2.0, 3.0)
    cube.location = (0.0, 0.0, 0.0)
    assert differences(before, file_state()) == []


def test_a_refined_object_that_was_given_a_parent_keeps_it():
    cube, output = baked_cube()
    parent = add_object("Mover", None)
    parent.location.x = 7.0
    output.parent = parent
    moved = matrix(output)
    bake_selected("REFINED")
    assert matrix(refined("Cube")) == pytest.approx(moved, abs=1e-6)
    bpy.ops.radiosity.restore()
    assert cube.parent == parent


@pytest.fixture
def plate():
    """Return a plate that hangs on a table, both originals of refined objects."""
    table, plate = add_cube("Table", select=True), add_cube("Plate", select=True)
    plate.parent, plate.matrix_parent_inverse = table, Matrix.Translation((0.0, 0.0, 2.0))
    table.location.y = 4.0
    bake_selected("REFINED")
    return plate


@pytest.mark.parametrize("bakes", [1, 2])
def test_what_hung_on_an_object_moves_with_its_refined_one(plate, bakes):
    for _ in range(bakes - 1):
        bake_selected("REFINED")
    refined("Table").location.x = 3.0
    assert matrix(refined("Plate")) == pytest.approx(np.array(Matrix.Translation((3.0, 4.0, 2.0))), abs=1e-6)
    moved = matrix(refined("Plate"))
    bake_selected("REFINED")
    assert matrix(refined("Plate")) == pytest.approx(moved, abs=1e-6)
    assert colours_of(refined("Plate").data)[:, :3] == pytest.approx(corner_positions(refined("Plate")), abs=1e-5)
    assert report()["warnings"] == []
    bpy.ops.radiosity.restore()
    assert plate.parent == bpy.data.objects["Table"]
    assert matrix(plate) == pytest.approx(moved, abs=1e-6)


def test_restore_leaves_originals_that_hang_together_as_they_were():
    table, plate = add_cube("Table", select=True), add_cube("Plate", select=True)
    plate.parent = table
    before = file_state()
    bake_selected("REFINED")
    bake_selected("REFINED")
    bpy.ops.radiosity.restore()
    assert differences(before, file_state()) == []


def test_refined_objects_may_hang_the_other_way_round(plate):
    refined("Plate").parent = None
    refined("Table").parent = refined("Plate")
    places = [matrix(refined(name)) for name in ("Table", "Plate")]
    bake_selected("REFINED")
    for name, place in zip(("Table", "Plate"), places, strict=True):
        assert matrix(refined(name)) == pytest.approx(place, abs=1e-6)
    bpy.ops.radiosity.restore()
    assert plate.parent is None
    assert bpy.data.objects["Table"].parent == plate


def test_an_original_that_a_script_moved_stays_where_the_script_put_it():
    cube, _ = baked_cube()
    cube.location.x = 5.0
    bake_selected("REFINED")
    assert refined("Cube").location.x == 5.0
    assert colours_of(refined("Cube").data)[:, 0].min() == pytest.approx(4.0)


def test_a_moved_refined_object_that_is_not_selected_lights_from_where_it_is(quick_bake):
    _, output = baked_cube()
    output.location.x = 5.0
    bpy.ops.object.select_all(action="DESELECT")
    add_plane(select=True)
    before = file_state()
    bake_selected("REFINED")
    scene, _ = quick_bake[-1]
    middles = {mesh.name: mesh.vertices[:, 0].mean() for mesh in scene.meshes}
    assert middles == {"Cube": pytest.approx(5.0), "Plane": pytest.approx(0.0)}
    bpy.ops.radiosity.restore()
    assert differences(before["objects"]["Cube Radiosity"], file_state()["objects"]["Cube Radiosity"]) == []


def test_a_moved_duplicate_does_not_move_the_original():
    cube, output = baked_cube()
    copy = output.copy()
    bpy.context.scene.collection.objects.link(copy)
    copy.location.x = 5.0
    bake_selected("REFINED")
    assert (cube.location.x, refined("Cube").location.x) == (0.0, 0.0)


def test_a_duplicate_of_a_refined_object_is_kept_and_that_is_said():
    _, output = baked_cube()
    copy = output.copy()
    copy.data = output.data.copy()
    copy.name = "A chair of mine"
    bpy.context.scene.collection.objects.link(copy)
    copy.select_set(True)
    bake_selected("REFINED")
    copy = bpy.data.objects["A chair of mine"]
    assert copy.data.color_attributes["Radiosity"] is not None and copy.material_slots[0].material is not None
    assert any("A chair of mine" in warning for warning in report()["warnings"])
    assert bpy.ops.radiosity.restore() == {"FINISHED"}
    assert "A chair of mine" in bpy.data.objects


def test_an_animated_object_stays_where_its_animation_puts_it_and_that_is_said():
    cube, output = baked_cube(animated)
    output.animation_data_clear()
    output.location.x = 5.0
    bake_selected("REFINED")
    (warning,) = report()["warnings"]
    assert '"Cube Radiosity" was moved' in warning and "animation" in warning
    assert colours_of(refined("Cube").data)[:, 0].max() == pytest.approx(1.0)
    assert cube.location.x == 0.0


def test_a_flattened_object_that_was_not_moved_is_baked_again_without_a_word():
    def flatten(cube):
        cube.location, cube.scale = (5.0, 6.0, 7.0), (1.0, 1.0, 0.0)

    cube, _ = baked_cube(flatten)
    bake_selected("REFINED")
    assert report()["warnings"] == []
    assert tuple(cube.location) == (5.0, 6.0, 7.0)


def test_a_moved_object_whose_bake_cannot_be_stored_is_left_alone():
    _, output = baked_cube()
    output.location.x = 5.0
    before = file_state()
    with full_disk():
        bake_selected("ORIGINAL")
    assert differences(before, file_state()) == []


# ---------------------------------------------------------------------------------------------------------------------
# One of the two is gone


def test_restore_brings_back_an_original_whose_refined_object_was_deleted_whatever_is_selected():
    room, lamp = add_cube("Room", select=True), add_plane("L", select=True)
    bake_selected("REFINED")
    bpy.data.objects.remove(refined("Room"))
    assert bpy.context.selected_objects == [refined("L")]
    bpy.ops.radiosity.restore()
    assert not room.hide_render and room.visible_get()
    assert not lamp.hide_render and lamp.visible_get()


def test_an_original_whose_refined_object_was_deleted_is_shown_by_its_next_bake():
    room, _ = baked_cube()
    bpy.data.objects.remove(refined("Cube"))
    room.hide_viewport = False
    room.hide_set(False)
    room.select_set(True)
    bake_selected("ORIGINAL")
    assert not room.hide_render and room.visible_get()
    bpy.ops.radiosity.restore()
    assert not room.hide_render and room.visible_get()


def test_an_original_that_lights_unseen_is_said():
    add_cube("Room", select=True)
    bake_selected("REFINED")
    bpy.data.objects.remove(refined("Room"))
    add_plane(select=True)
    bake_selected("REFINED")
    (warning,) = report()["warnings"]
    assert '"Room" takes part in the light though its refined object was deleted' in warning


def test_a_deleted_original_is_baked_again_with_its_own_materials():
    cube, _ = baked_cube()
    bpy.context.scene.collection.objects.unlink(cube)
    bake_selected("REFINED")
    assert sorted(obj.name for obj in bpy.data.objects) == ["Cube", "Cube Radiosity"]
    assert report()["warnings"] == []
    bpy.ops.radiosity.restore()
    assert [slot.material.name for slot in cube.material_slots] == ["Paint"]
    assert cube.visible_get()


@pytest.mark.parametrize("output", ["REFINED", "ORIGINAL"])
def test_a_refined_object_without_its_original_is_an_ordinary_mesh(output):
    cube, left = baked_cube()
    bpy.data.objects.remove(cube)
    before = file_state()
    for _ in range(2):
        bake_selected(output)
    names = {"REFINED": ["Cube Radiosity", "Cube Radiosity.001"], "ORIGINAL": ["Cube Radiosity"]}
    assert sorted(obj.name for obj in bpy.data.objects) == names[output]
    bpy.ops.radiosity.restore()
    assert left.material_slots[0].material.name == "Radiosity Display"
    after = file_state()
    for state in (before, after):
        state["objects"]["Cube Radiosity"].pop("baked")
        state["scenes"].clear()
    assert differences(before, after) == []


def test_restore_says_which_objects_could_not_stay_where_they_were_moved(capfd):
    _, output = baked_cube(animated)
    output.animation_data_clear()
    output.location.x = 5.0
    bpy.context.view_layer.update()
    bpy.ops.radiosity.restore()
    said = capfd.readouterr()
    assert '"Cube" went back to where its animation or constraints put it' in said.out + said.err
