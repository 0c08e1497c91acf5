# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Objects of another file: their refined meshes are of this one, and nothing of theirs is written."""

import bpy
import pytest
from radiosity_bake.operators.command import main

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
    linked_from_library,
    report,
    select_also,
)
from tests.blender.state import differences, file_state

pytestmark = pytest.mark.usefixtures("quick_bake")


@pytest.fixture
def linked(tmp_path):
    """Return a cube of another file, selected in this one."""
    add_cube("Linked", materials=[diffuse_material("Paint")]).location = (1.0, 2.0, 3.0)
    cube = linked_from_library(tmp_path, "objects", "Linked")
    bpy.context.scene.collection.objects.link(cube)
    select_also(cube)
    return cube


def of_other_files(state):
    """Return the part of the state of a file that is of another; `name_full` ends in its library then."""
    return {
        kind: {name: value for name, value in state[kind].items() if name.endswith("]")}
        for kind in ("objects", "meshes", "materials")
    }


def without_places(state):
    """Return the state without where objects are linked, shown and selected in this file, which is of this file."""
    for values in state["objects"].values():
        for name in ("collections", "eye", "selected", "users", "is_library_indirect", "tag"):
            values.pop(name, None)
    for kind in ("meshes", "materials"):
        for values in state[kind].values():
            values.pop("users", None)
    return state


def test_a_linked_object_is_replaced_by_a_local_refined_one(linked):
    before = without_places(of_other_files(file_state()))
    assert all(before[kind] for kind in ("objects", "meshes", "materials"))
    bake_selected("REFINED")
    (output,) = bpy.context.selected_objects
    assert output.library is None and output.data.library is None
    assert colours_of(output.data)[:, :3] == pytest.approx(corner_positions(output), abs=1e-5)
    assert bpy.context.scene.objects[:] == [output] and bpy.context.object == output
    assert linked.radiosity.kind == "NONE" and not linked.hide_render
    assert differences(before, without_places(of_other_files(file_state()))) == []


def test_a_linked_object_comes_back_with_restore(linked):
    before = file_state()
    bake_selected("REFINED")
    bake_selected("REFINED")
    assert report()["objects"] == ["Linked Radiosity"]
    assert bpy.ops.radiosity.restore() == {"FINISHED"}
    assert differences(before, file_state()) == []
    assert bpy.context.selected_objects == [linked]


def test_a_linked_object_comes_back_after_saving_and_opening(linked, tmp_path):
    bake_selected("REFINED")
    path = str(tmp_path / "room.blend")
    bpy.ops.wm.save_as_mainfile(filepath=path)
    bpy.ops.wm.open_mainfile(filepath=path)
    assert [obj.name for obj in bpy.context.scene.objects] == ["Linked Radiosity"]
    assert bpy.ops.radiosity.restore() == {"FINISHED"}
    (cube,) = bpy.context.scene.objects
    assert cube.library is not None


def test_a_moved_refined_object_of_a_linked_one_is_baked_where_its_file_puts_it(linked):
    bake_selected("REFINED")
    bpy.context.selected_objects[0].location.x = 9.0
    bake_selected("REFINED")
    (warning,) = report()["warnings"]
    assert "its own file puts it" in warning
    assert tuple(bpy.context.selected_objects[0].location) == (1.0, 2.0, 3.0)


def test_a_bake_of_a_linked_object_that_cannot_be_stored_changes_nothing(linked):
    before = file_state()
    with full_disk():
        bake_selected("REFINED")
    assert differences(before, file_state()) == []


def test_colours_in_place_need_a_local_object_and_say_so(linked):
    select_also(add_plane())
    bake_selected("ORIGINAL")
    assert report()["objects"] == ["Plane"]
    assert any("Refined Mesh bakes it" in warning for warning in report()["warnings"])


def test_an_object_of_a_linked_collection_asks_for_an_override(tmp_path):
    add_cube("Linked", collection=add_collection("Parts"))
    parts = linked_from_library(tmp_path, "collections", "Parts")
    bpy.context.scene.collection.children.link(parts)
    parts.objects[0].select_set(True)
    with pytest.raises(RuntimeError, match=r'"Linked" is in a collection that is linked .* library override'):
        bake_selected("REFINED")


def test_an_instance_of_a_linked_collection_is_baked(tmp_path):
    add_cube("Linked", collection=add_collection("Parts"))
    parts = linked_from_library(tmp_path, "collections", "Parts")
    instance = add_object("Instance", None, select=True)
    instance.instance_type, instance.instance_collection = "COLLECTION", parts
    instance.location.x = 4.0
    before = file_state()
    bake_selected("REFINED")
    (output,) = bpy.context.selected_objects
    assert output.library is None
    assert colours_of(output.data)[:, :3] == pytest.approx(corner_positions(output), abs=1e-5)
    assert bpy.ops.radiosity.restore() == {"FINISHED"}
    assert differences(before, file_state()) == []


def test_a_local_object_with_a_linked_mesh_and_material_leaves_them_alone(tmp_path):
    add_cube("Linked", materials=[diffuse_material("Paint")])
    mesh = linked_from_library(tmp_path, "meshes", bpy.data.objects["Linked"].data.name)
    select_also(add_object("Local", mesh))
    before = of_other_files(file_state())
    for output in ("ORIGINAL", "REFINED"):
        bake_selected(output)
        assert differences(without_places(before), without_places(of_other_files(file_state()))) == []
    assert bpy.ops.radiosity.restore() == {"FINISHED"}
    assert bpy.data.objects["Local"].data == mesh


@pytest.fixture
def without_library(tmp_path):
    """Open a file that links a collection and an object of a library which was deleted since."""
    parts = add_collection("Parts")
    for name in ("Chair", "Table"):
        add_cube(name, collection=parts)
    parts = linked_from_library(tmp_path, "collections", "Parts")
    instance = add_object("Instance", None)
    instance.instance_type, instance.instance_collection = "COLLECTION", parts
    bpy.context.scene.collection.objects.link(parts.objects["Chair"])
    add_cube("Room")
    path = str(tmp_path / "room.blend")
    bpy.ops.wm.save_as_mainfile(filepath=path)
    (tmp_path / "library.blend").unlink()
    bpy.ops.wm.open_mainfile(filepath=path)


@pytest.mark.usefixtures("without_library")
def test_a_library_that_is_gone_is_named_with_what_is_missing():
    select_also(bpy.data.objects["Room"])
    bake_selected("REFINED")
    (warning,) = report()["warnings"]
    assert warning.startswith('The linked file "')
    assert warning.endswith('library.blend" could not be read, so "Chair", "Parts" from it are left out')


@pytest.mark.usefixtures("without_library")
def test_the_command_names_a_library_that_is_gone_when_nothing_is_left(tmp_path, capsys):
    bpy.data.objects.remove(bpy.data.objects["Room"])
    bpy.data.objects.remove(bpy.data.objects["Instance"])
    assert main(["--output", str(tmp_path / "baked.blend")]) == 1
    assert 'library.blend" could not be read' in capsys.readouterr().err


def test_what_a_library_no_longer_has_is_named(linked, tmp_path):
    add_cube("Room", select=True)
    path = str(tmp_path / "room.blend")
    bpy.ops.wm.save_as_mainfile(filepath=path)
    bpy.ops.wm.read_factory_settings(use_empty=True)
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "library.blend"))
    bpy.ops.wm.open_mainfile(filepath=path)
    bake_selected("REFINED")
    (warning,) = report()["warnings"]
    assert 'library.blend" has changed, so "Linked" from it is left out' in warning
