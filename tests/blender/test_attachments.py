# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""What artists attach to refined objects outlives a second bake and Restore."""

import bpy
import numpy as np
import pytest
from mathutils import Matrix

from tests.blender.making import (
    add_collection,
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


@pytest.fixture
def table():
    """Return an original away from the origin, turned, and its refined object."""
    cube = add_cube("Table", select=True)
    cube.location, cube.rotation_euler = (1.0, 2.0, 3.0), (0.1, 0.5, 0.9)
    bake_selected("REFINED")
    return cube, bpy.data.objects["Table Radiosity"]


def place(obj):
    bpy.context.view_layer.update()
    return np.array(obj.matrix_world)


def child_of(parent):
    cup = add_object("Cup", None)
    cup.location.x = 0.05
    cup.parent, cup.matrix_parent_inverse = parent, Matrix.Translation((0.0, 4.0, 0.0))
    return cup


def constraint_to(target):
    constraint = add_object("Follower", None).constraints.new("COPY_LOCATION")
    constraint.target = target
    return constraint


def modifier_with(target):
    modifier = add_plane("Sheet").modifiers.new("Shrink", "SHRINKWRAP")
    modifier.target = target
    return modifier


def driver_of(target):
    variable = add_object("Driven", None).driver_add("location", 0).driver.variables.new()
    variable.targets[0].id = target
    return variable.targets[0]


ATTACHED = {"parent": child_of, "target": constraint_to, "modifier": modifier_with, "id": driver_of}


def pointed_to(owner):
    name = next(name for name in ("parent", "target", "id") if isinstance(getattr(owner, name, None), bpy.types.Object))
    return getattr(owner, name)


@pytest.mark.parametrize("attach", ATTACHED.values(), ids=ATTACHED)
def test_what_points_to_a_refined_object_points_to_it_after_a_second_bake_and_to_the_original_after_restore(
    table, attach
):
    cube, output = table
    owner = attach(output)
    bake_selected("REFINED")
    assert bpy.data.objects["Table Radiosity"] == output
    assert pointed_to(owner) == output
    bpy.ops.radiosity.restore()
    assert pointed_to(owner) == cube


def test_a_child_of_a_refined_object_stays_where_it_is(table):
    cube, output = table
    cup = child_of(output)
    output.location.z = 8.0
    before = place(cup)
    bake_selected("REFINED")
    assert place(cup) == pytest.approx(before, abs=1e-6)
    bpy.ops.radiosity.restore()
    assert place(cup) == pytest.approx(before, abs=1e-6)
    cube.location.z += 1.0
    assert place(cup)[2, 3] == pytest.approx(before[2, 3] + 1.0, abs=1e-6)


def test_a_bake_in_place_after_a_refined_one_hands_children_to_the_original(table):
    cube, output = table
    cup = child_of(output)
    before = place(cup)
    bake_selected("ORIGINAL")
    assert cup.parent == cube
    assert place(cup) == pytest.approx(before, abs=1e-6)


def test_what_is_attached_to_the_original_stays_there(table):
    cube, output = table
    cup = child_of(cube)
    cup_of_refined = child_of(output)
    bake_selected("REFINED")
    assert (cup.parent, cup_of_refined.parent) == (cube, output)
    bpy.ops.radiosity.restore()
    assert (cup.parent, cup_of_refined.parent) == (cube, cube)


def test_refined_objects_that_were_parented_to_one_another_are_so_as_originals():
    shelf, book = add_cube("Shelf", select=True), add_cube("Book", select=True)
    book.location.x = 5.0
    bake_selected("REFINED")
    refined = {name: bpy.data.objects[f"{name} Radiosity"] for name in ("Shelf", "Book")}
    refined["Book"].parent = refined["Shelf"]
    refined["Shelf"].location.y = 2.0
    before = place(refined["Book"])
    bake_selected("REFINED")
    assert place(refined["Book"]) == pytest.approx(before, abs=1e-6)
    assert colours_of(refined["Book"].data)[:, :3] == pytest.approx(corner_positions(refined["Book"]), abs=1e-5)
    bpy.ops.radiosity.restore()
    assert book.parent == shelf
    assert place(book) == pytest.approx(before, abs=1e-6)


def test_custom_properties_of_a_refined_object_are_kept(table):
    cube, output = table
    output["mine"], output["list"], output["group"] = 5, [1.0, 2.0], {"a": 1}
    output.id_properties_ui("mine").update(min=3, max=7, description="What it is for")
    bake_selected("REFINED")
    assert output["mine"] == 5
    cube["of the original"] = "new"
    bake_selected("REFINED")
    assert output["of the original"] == "new"
    bpy.ops.radiosity.restore()
    assert (cube["mine"], list(cube["list"]), cube["group"].to_dict()) == (5, [1.0, 2.0], {"a": 1})
    assert cube.id_properties_ui("mine").as_dict()["max"] == 7
    assert cube["of the original"] == "new"


def test_what_was_given_to_a_refined_object_stays_through_a_second_bake(table):
    _, output = table
    output.modifiers.new("Bevel", "BEVEL")
    output.data.materials[0] = mine = diffuse_material("Mine")
    output.data["of the mesh"] = 1
    output.name = "A table of mine"
    output.hide_set(True)
    bpy.context.view_layer.objects.active = output
    output.hide_set(False)
    output.select_set(True)
    bake_selected("REFINED")
    assert bpy.data.objects["A table of mine"] == output
    assert [modifier.name for modifier in output.modifiers] == ["Bevel"]
    assert output.material_slots[0].material == mine
    assert output.data["of the mesh"] == 1
    assert colours_of(output.data)[:, :3] == pytest.approx(corner_positions(output), abs=1e-5)


def test_restore_names_what_is_lost_with_a_refined_object(table, capfd):
    _, output = table
    output.modifiers.new("Bevel", "BEVEL")
    output.data.materials[0] = diffuse_material("Mine")
    bpy.ops.radiosity.restore()
    said = capfd.readouterr()
    assert 'What was added to "Table Radiosity" went with it: the modifiers "Bevel" and the materials "Mine"' in (
        said.out + said.err
    )


def test_a_bake_in_place_names_what_is_lost_with_a_refined_object(table):
    table[1].modifiers.new("Bevel", "BEVEL")
    bake_selected("ORIGINAL")
    assert report()["warnings"] == ['What was added to "Table Radiosity" went with it: the modifiers "Bevel"']


def test_an_original_takes_over_the_constraints_of_its_refined_object(table):
    cube, output = table
    goal = add_object("Goal", None)
    goal.location.x = 9.0
    output.constraints.new("COPY_LOCATION").target = goal
    before = place(output)
    bake_selected("REFINED")
    assert report()["warnings"] == []
    assert colours_of(output.data)[:, :3] == pytest.approx(corner_positions(output), abs=1e-5)
    assert len(output.constraints) == 1
    bpy.ops.radiosity.restore()
    assert place(cube) == pytest.approx(before, abs=1e-6)


def test_an_original_takes_over_the_animation_of_its_refined_object(table):
    cube, output = table
    for frame, height in ((1, 3.0), (11, 7.0)):
        output.location.z = height
        output.keyframe_insert("location", frame=frame)
    bpy.context.scene.frame_set(11)
    bake_selected("REFINED")
    assert report()["warnings"] == []
    assert colours_of(output.data)[:, 2].max() > 7.0
    bpy.ops.radiosity.restore()
    assert place(cube)[2, 3] == pytest.approx(7.0)
    bpy.context.scene.frame_set(1)
    assert place(cube)[2, 3] == pytest.approx(3.0)


def test_an_original_follows_its_refined_object_into_another_collection(table):
    cube, output = table
    room = add_collection("Room")
    room.objects.link(output)
    bpy.context.scene.collection.objects.unlink(output)
    bake_selected("REFINED")
    assert output.users_collection == (room,)
    bpy.ops.radiosity.restore()
    assert cube.users_collection == (room,)
    assert cube.visible_get()


def test_a_child_of_an_object_that_was_flattened_stays_in_place_and_that_is_said(capfd):
    sheet = add_cube("Sheet", select=True)
    sheet.location, sheet.scale = (5.0, 6.0, 7.0), (1.0, 1.0, 0.0)
    bake_selected("REFINED")
    cup = child_of(bpy.data.objects["Sheet Radiosity"])
    before = place(cup)
    bpy.ops.radiosity.restore()
    assert cup.parent is None
    assert place(cup) == pytest.approx(before, abs=1e-6)
    said = capfd.readouterr()
    assert '"Cup" cannot be parented to "Sheet"' in said.out + said.err


def test_an_original_that_hangs_on_a_child_of_its_refined_object_does_not_hang_on_itself():
    cube, mast = add_cube("Flag", select=True), add_object("Mast", None)
    cube.keyframe_insert("location", frame=1)
    cube.parent = mast
    bake_selected("REFINED")
    output = bpy.data.objects["Flag Radiosity"]
    output.parent = None
    mast.parent = output
    bpy.ops.radiosity.restore()
    assert (cube.parent, mast.parent) == (mast, None)


@pytest.mark.parametrize("output", ["REFINED", "ORIGINAL"])
def test_a_second_bake_that_cannot_be_stored_leaves_all_that_was_attached(table, output):
    cube, refined = table
    cup, constraint = child_of(refined), constraint_to(refined)
    refined["mine"] = 5
    refined.modifiers.new("Bevel", "BEVEL")
    refined.constraints.new("COPY_SCALE").target = cup
    refined.data.materials[0] = diffuse_material("Mine")
    refined.keyframe_insert("location", frame=1)
    room = add_collection("Room")
    room.objects.link(refined)
    bpy.context.scene.collection.objects.unlink(refined)
    before = file_state()
    with full_disk():
        bake_selected(output)
    assert differences(before, file_state()) == []
    assert (cup.parent, constraint.target) == (refined, refined)
    assert len(cube.constraints) == 0 and "mine" not in cube


@pytest.mark.parametrize("own_mesh", [True, False])
def test_restore_makes_originals_of_the_copies_of_a_refined_object(table, own_mesh):
    cube, output = table
    cube.modifiers.new("Bevel", "BEVEL")
    copy = output.copy()
    if own_mesh:
        copy.data = output.data.copy()
    room = add_collection("Room")
    room.objects.link(copy)
    copy.location.x, copy["mine"] = 9.0, 5
    cup = child_of(copy)
    before = place(copy), place(cup)
    bpy.ops.radiosity.restore()
    (twin,) = room.objects
    assert twin.data == cube.data and twin.visible_get() and not twin.hide_render
    assert (twin["mine"], cup.parent, twin.radiosity.kind) == (5, twin, "NONE")
    assert [modifier.name for modifier in twin.modifiers] == ["Bevel"]
    assert place(twin) == pytest.approx(before[0], abs=1e-6)
    assert place(cup) == pytest.approx(before[1], abs=1e-6)
    assert cube.location.x == 1.0 and "mine" not in cube
    assert sorted(obj.name for obj in bpy.data.objects) == ["Cup", "Table", "Table.001"]
    assert [mesh.name for mesh in bpy.data.meshes] == ["Table"]
