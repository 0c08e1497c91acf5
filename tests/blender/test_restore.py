# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Restore brings everything back exactly, and a bake that fails changes nothing."""

import bpy
import pytest

from tests.blender.making import (
    add_collection,
    add_cube,
    add_mesh,
    add_object,
    add_plane,
    bake_selected,
    dark_bake,
    diffuse_material,
    full_disk,
    select_also,
)
from tests.blender.state import differences, file_state

pytestmark = pytest.mark.usefixtures("quick_bake")


def simple():
    return [add_cube(materials=[diffuse_material("Red"), diffuse_material("Blue")])]


def without_slots():
    return [add_cube()]


def with_empty_slots():
    return [add_cube(materials=[None, diffuse_material()])]


def slots_of_the_object():
    cube = add_cube(materials=[diffuse_material("Mesh's"), diffuse_material("Second")])
    cube.material_slots[0].link = "OBJECT"
    cube.material_slots[0].material = diffuse_material("Object's")
    return [cube]


def shared_mesh():
    first = add_cube("First", materials=[diffuse_material()])
    second = add_object("Second", first.data)
    second.material_slots[0].link = "OBJECT"
    add_object("Bystander", first.data)
    return [first, second]


def own_colour_attributes():
    cube = add_cube()
    for name, kind, domain in (("Paint", "BYTE_COLOR", "POINT"), ("Mask", "FLOAT_COLOR", "CORNER")):
        attribute = cube.data.color_attributes.new(name, kind, domain)
        attribute.data[1].color = (0.25, 0.5, 0.75, 1.0)
    cube.data.color_attributes.active_color_name = "Mask"
    cube.data.color_attributes.default_color_name = "Paint"
    cube.data.attributes.active_index = cube.data.attributes.find("Paint")
    return [cube]


def attributes_of_our_names():
    cube = add_cube()
    cube.data.color_attributes.new("Radiosity", "BYTE_COLOR", "CORNER").data[2].color = (1.0, 0.0, 0.0, 1.0)
    cube.data.attributes.new("Irradiance", "FLOAT", "POINT").data[3].value = 4.0
    cube.data.uv_layers.new(name="Radiosity Back")
    return [cube]


def hidden_in_the_viewport():
    cube, plane = add_cube(), add_plane()
    collection = add_collection("Room")
    collection.objects.link(cube)
    bpy.context.scene.collection.objects.unlink(cube)
    return [cube, plane]


def with_modifiers_and_custom_normals():
    cube = add_cube()
    cube.data.shade_smooth()
    cube.data.normals_split_custom_set([(0.0, 0.0, 1.0)] * 24)
    modifier = cube.modifiers.new("Subdivision", "SUBSURF")
    modifier.levels, modifier.render_levels = 0, 1
    plane = add_plane()
    plane.modifiers.new("Mirror", "MIRROR")
    return [cube, plane]


def with_a_parent_and_a_fake_user():
    parent, cube = add_object("Parent", None), add_cube()
    cube.parent, cube.location = parent, (1.0, 2.0, 3.0)
    cube.data.use_fake_user = True
    child = add_plane("Child")
    child.parent = cube
    return [cube]


CASES = [
    simple,
    without_slots,
    with_empty_slots,
    slots_of_the_object,
    shared_mesh,
    own_colour_attributes,
    attributes_of_our_names,
    hidden_in_the_viewport,
    with_modifiers_and_custom_normals,
    with_a_parent_and_a_fake_user,
]


def prepare(make):
    select_also(*make())
    add_plane("Unselected")
    return file_state()


@pytest.mark.parametrize("output", ["REFINED", "ORIGINAL"])
@pytest.mark.parametrize("make", CASES)
def test_restore_brings_everything_back(make, output):
    before = prepare(make)
    bake_selected(output)
    assert differences(before, file_state())
    assert bpy.ops.radiosity.restore() == {"FINISHED"}
    assert differences(before, file_state()) == []


@pytest.mark.parametrize("outputs", [("REFINED", "ORIGINAL"), ("ORIGINAL", "REFINED"), ("REFINED", "REFINED")])
@pytest.mark.parametrize("make", CASES)
def test_restore_after_two_bakes_brings_the_originals_back(make, outputs):
    before = prepare(make)
    for output in outputs:
        bake_selected(output)
    bpy.ops.radiosity.restore()
    assert differences(before, file_state()) == []


@pytest.mark.parametrize("output", ["REFINED", "ORIGINAL"])
@pytest.mark.parametrize("make", CASES)
def test_a_bake_that_cannot_be_stored_changes_nothing(make, output):
    before = prepare(make)
    with full_disk():
        bake_selected(output)
    assert differences(before, file_state()) == []


@pytest.mark.parametrize("outputs", [(a, b) for a in ("REFINED", "ORIGINAL") for b in ("REFINED", "ORIGINAL")])
@pytest.mark.parametrize("make", CASES)
def test_a_second_bake_that_cannot_be_stored_leaves_the_first_whole(make, outputs):
    before = prepare(make)
    bake_selected(outputs[0])
    first = file_state()
    with full_disk():
        bake_selected(outputs[1])
    assert differences(first, file_state()) == []
    bpy.ops.radiosity.restore()
    assert differences(before, file_state()) == []


def test_a_second_bake_that_finds_no_light_leaves_the_first_whole(run_instead):
    prepare(simple)
    bake_selected("REFINED")
    first = file_state()
    run_instead(dark_bake)
    with pytest.raises(RuntimeError, match="Nothing in the scene emits light"):
        bake_selected("ORIGINAL")
    assert differences(first, file_state()) == []


def test_only_the_selected_objects_are_restored_if_any_of_them_is_baked():
    a, b = add_cube("A", select=True), add_cube("B", select=True)
    bake_selected("REFINED")
    bpy.data.objects["A Radiosity"].select_set(False)
    bpy.ops.radiosity.restore()
    assert a.radiosity.kind == "SOURCE"
    assert b.radiosity.kind == "NONE"
    assert "B Radiosity" not in bpy.data.objects and "A Radiosity" in bpy.data.objects
    assert bpy.context.scene.radiosity.report


def test_all_are_restored_if_none_of_the_selected_is_baked():
    add_cube("A", select=True)
    bake_selected("REFINED")
    bpy.ops.object.select_all(action="DESELECT")
    add_plane(select=True)
    bpy.ops.radiosity.restore()
    assert sorted(obj.name for obj in bpy.data.objects) == ["A", "Plane"]


def test_restore_says_so_when_nothing_is_baked():
    add_cube(select=True)
    assert not bpy.ops.radiosity.restore.poll()


def test_restore_survives_renamed_objects_and_materials():
    material = diffuse_material()
    cube = add_cube(materials=[material], select=True)
    bake_selected("ORIGINAL")
    cube.name, material.name = "Renamed", "Renamed Paint"
    bpy.ops.radiosity.restore()
    assert cube.material_slots[0].material == material


def test_restore_survives_a_deleted_refined_object():
    cube = add_cube(select=True)
    bake_selected("REFINED")
    bpy.data.objects.remove(bpy.data.objects["Cube Radiosity"])
    bpy.ops.radiosity.restore()
    assert not cube.hide_render and not cube.hide_viewport and not cube.hide_get()


def test_restore_survives_a_deleted_original():
    cube = add_cube(select=True)
    bake_selected("REFINED")
    bpy.context.scene.collection.objects.unlink(cube)
    bpy.ops.radiosity.restore()
    assert [obj.name for obj in bpy.context.scene.objects] == ["Cube"]
    assert bpy.data.objects["Cube"].visible_get()


def test_a_bake_survives_saving_and_loading(tmp_path):
    add_cube(materials=[diffuse_material("Red")], select=True)
    before = prepare(without_slots)
    bake_selected("ORIGINAL")
    path = str(tmp_path / "baked.blend")
    bpy.ops.wm.save_as_mainfile(filepath=path)
    bpy.ops.wm.open_mainfile(filepath=path)
    bpy.ops.radiosity.restore()
    after = file_state()
    for state in (before, after):
        for kind in ("objects", "meshes", "materials", "collections"):
            for item in state[kind].values():
                (item[0] if isinstance(item, tuple) else item).pop("session_uid", None)
    assert differences(before, after) == []


def test_edits_of_the_mesh_after_a_bake_in_place_are_kept():
    cube = add_cube(select=True)
    bake_selected("ORIGINAL")
    cube.data.vertices[0].co.x = -5.0
    bpy.ops.radiosity.restore()
    assert cube.data.vertices[0].co.x == -5.0
    assert len(cube.data.color_attributes) == 0


def test_a_material_given_after_the_bake_is_kept():
    cube = add_cube(materials=[diffuse_material("Old")], select=True)
    bake_selected("ORIGINAL")
    new = diffuse_material("New")
    cube.material_slots[0].material = new
    bpy.ops.radiosity.restore()
    assert cube.material_slots[0].material == new


def test_loose_parts_and_other_meshes_are_left_alone():
    add_mesh("Points", [(0, 0, 0)], [], select=True)
    add_cube(select=True)
    before = file_state()
    bake_selected("ORIGINAL")
    bpy.ops.radiosity.restore()
    assert differences(before, file_state()) == []
