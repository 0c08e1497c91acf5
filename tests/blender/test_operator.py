# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The bake operator: one clear sentence for whatever cannot be done, and nothing changed then."""

from dataclasses import replace

import bpy
import numpy as np
import pytest
from radiosity_bake.core.errors import Cancelled
from radiosity_bake.core.progress import no_progress
from radiosity_bake.operators.bake import bake_objects, profile, reason_not_to_bake
from radiosity_bake.operators.doors import Watch
from radiosity_bake.operators.settings import bake_settings

from tests.blender.making import (
    add_cube,
    add_lamp_mesh,
    add_mesh,
    add_object,
    add_plane,
    bake_selected,
    colours_of,
    linked_from_library,
    position_bake,
    report,
)
from tests.blender.state import file_state

# ---------------------------------------------------------------------------------------------------------------------
# When the button is grey


def test_the_button_is_grey_without_a_selected_mesh():
    assert reason_not_to_bake(bpy.context) == "Select the meshes to bake"
    assert not bpy.ops.radiosity.bake.poll()
    with pytest.raises(RuntimeError, match="Select the meshes to bake"):
        bpy.ops.radiosity.bake()


def test_the_button_is_grey_when_only_other_objects_are_selected():
    add_object("Empty", None, select=True)
    assert reason_not_to_bake(bpy.context) == "Select the meshes to bake"


def test_the_button_is_grey_in_edit_mode():
    add_cube(select=True)
    bpy.ops.object.mode_set(mode="EDIT")
    assert reason_not_to_bake(bpy.context) == "Leave edit mode to bake"
    bpy.ops.object.mode_set(mode="OBJECT")
    assert reason_not_to_bake(bpy.context) is None


def test_the_button_is_grey_without_the_ray_library_and_says_why(monkeypatch):
    add_cube(select=True)
    why = "The ray library embreex cannot be loaded"
    monkeypatch.setattr("radiosity_bake.core.ray_library.ray_library_problem", lambda: why)
    assert reason_not_to_bake(bpy.context) == why
    with pytest.raises(RuntimeError, match=why):
        bpy.ops.radiosity.bake()


def test_the_button_is_grey_while_a_bake_runs(monkeypatch):
    add_cube(select=True)
    monkeypatch.setattr(Watch, "running", object())
    assert "running" in reason_not_to_bake(bpy.context)


def test_the_button_is_grey_when_linked_meshes_alone_shall_be_baked_in_place(tmp_path):
    add_cube("Linked")
    linked = linked_from_library(tmp_path, "objects", "Linked")
    bpy.context.scene.collection.objects.link(linked)
    linked.select_set(True)
    bpy.context.scene.radiosity.output = "ORIGINAL"
    assert "linked from another file" in reason_not_to_bake(bpy.context)


# ---------------------------------------------------------------------------------------------------------------------
# What ends in a sentence


def test_a_mesh_without_faces_is_an_error_with_its_name():
    add_mesh("Points", [(0, 0, 0)], [], select=True)
    before = file_state()
    with pytest.raises(RuntimeError, match=r'None of the selected objects can be baked: "Points" has no faces$'):
        bpy.ops.radiosity.bake()
    assert file_state() == before


def test_a_selection_that_cannot_be_baked_is_one_sentence_about_the_whole():
    for name in ("A", "B", "C", "D"):
        add_cube(name, select=True).hide_render = True
    add_mesh("Points", [(0, 0, 0)], [], select=True)
    names = '"A", "B", "C" and 1 more'
    with pytest.raises(RuntimeError) as caught:
        bpy.ops.radiosity.bake()
    assert str(caught.value).strip() == (
        f'Error: None of the selected objects can be baked: {names} are not shown in renders, and "Points" has no faces'
    )


def test_a_scene_without_light_is_an_error_and_nothing_changes():
    add_cube(select=True)
    before = file_state()
    with pytest.raises(RuntimeError, match=r"^Error: [A-Z].*(light|emit)"):
        bpy.ops.radiosity.bake()
    assert file_state() == before


def test_a_lamp_that_is_hidden_in_renders_is_named_where_nothing_emits_light():
    add_cube(select=True)
    for name, energy in (("Key", 10.0), ("Broken", 0.0)):
        lamp = bpy.data.lights.new(name, "POINT")
        lamp.energy = energy
        add_object(name, lamp).hide_render = True
    with pytest.raises(RuntimeError, match=r'Nothing in the scene emits light.*\. "Key" is hidden in renders'):
        bpy.ops.radiosity.bake()


@pytest.mark.usefixtures("quick_bake")
def test_what_renders_and_is_no_mesh_is_named_when_it_is_selected():
    add_object("Smoke", bpy.data.volumes.new("Smoke"), select=True)
    add_cube(select=True)
    bake_selected()
    assert any('"Smoke" was skipped: it is not a mesh' in warning for warning in report()["warnings"])


@pytest.mark.usefixtures("quick_bake")
def test_lamps_and_cameras_that_are_selected_along_with_meshes_are_no_warnings():
    add_object("Empty", None, select=True)
    add_object("Key", bpy.data.lights.new("Key", "POINT"), select=True)
    add_object("Eye", bpy.data.cameras.new("Eye"), select=True)
    add_object("Bones", bpy.data.armatures.new("Bones"), select=True)
    add_cube(select=True)
    bake_selected()
    assert report()["warnings"] == []


@pytest.mark.usefixtures("quick_bake")
def test_objects_that_are_skipped_for_one_reason_are_one_sentence():
    for name in "ABCDE":
        add_mesh(name, [(0, 0, 0)], [], select=True)
    add_cube(select=True)
    bake_selected()
    assert report()["warnings"] == ['"A", "B", "C" and 2 more were skipped: they have no faces']


def test_what_the_core_says_of_several_objects_is_one_sentence(run_instead):
    def warned(scene, settings, progress=no_progress):
        result = position_bake(scene, settings, progress)
        told = [f"{mesh.name}: {index + 2} triangles without area left out" for index, mesh in enumerate(scene.meshes)]
        told += [f"{scene.meshes[0].name}: light reaches only the back of its faces", "The memory: limit"]
        return replace(result, report={**result.report, "warnings": told})

    for name in ("A", "B: with a colon", "C", "D", "E"):
        add_cube(name, select=True)
    run_instead(warned)
    bake_selected()
    assert report()["warnings"] == [
        '"A", "B: with a colon", "C" and 2 more: 20 triangles without area left out',
        "A: light reaches only the back of its faces",
        "The memory: limit",
    ]


@pytest.mark.usefixtures("quick_bake")
def test_invalid_settings_are_a_sentence(refused_settings):
    add_cube(select=True)
    with pytest.raises(RuntimeError, match=refused_settings):
        bpy.ops.radiosity.bake()


def test_a_cancelled_bake_is_no_error_and_changes_nothing(run_instead):
    def cancelled(scene, settings, progress):
        raise Cancelled

    add_cube(select=True)
    before = file_state()
    run_instead(cancelled)
    assert bpy.ops.radiosity.bake() == {"CANCELLED"}
    assert file_state() == before


def test_a_bug_keeps_its_traceback(run_instead):
    def broken(scene, settings, progress):
        raise ZeroDivisionError("a bug in the numerics")

    add_cube(select=True)
    run_instead(broken)
    with pytest.raises(RuntimeError, match=r"in broken\n.*raise ZeroDivisionError"):
        bpy.ops.radiosity.bake()


def change_during_bake(run_instead, change):
    """Have `change` happen between reading and storing, as it may while the bake runs in its thread."""

    def bake_and_change(scene, settings, progress):
        change()
        return position_bake(scene, settings, progress)

    run_instead(bake_and_change)


@pytest.mark.parametrize("output", ["REFINED", "ORIGINAL"])
def test_an_object_deleted_during_the_bake_is_a_sentence(run_instead, output):
    cube = add_cube(select=True)
    add_plane(select=True)
    bpy.context.scene.radiosity.output = output
    change_during_bake(run_instead, lambda: bpy.data.objects.remove(cube))
    with pytest.raises(RuntimeError, match='"Cube" was deleted during the bake; nothing was stored'):
        bpy.ops.radiosity.bake()
    assert [obj.name for obj in bpy.data.objects] == ["Plane"]
    assert bpy.data.objects["Plane"].radiosity.kind == "NONE"


@pytest.mark.parametrize("output", ["REFINED", "ORIGINAL"])
def test_a_mesh_edited_during_the_bake_is_a_sentence(run_instead, output):
    cube = add_cube(select=True)
    bpy.context.scene.radiosity.output = output
    change_during_bake(run_instead, lambda: setattr(cube.data.vertices[0].co, "x", -3.0))
    with pytest.raises(RuntimeError, match='The mesh of "Cube" was edited during the bake'):
        bpy.ops.radiosity.bake()
    assert cube.radiosity.kind == "NONE"
    assert len(cube.data.color_attributes) == 0


@pytest.mark.parametrize("output", ["REFINED", "ORIGINAL"])
def test_edit_mode_entered_during_the_bake_is_a_sentence(run_instead, output):
    cube = add_cube(select=True)
    bpy.context.scene.radiosity.output = output
    change_during_bake(run_instead, lambda: bpy.ops.object.mode_set(mode="EDIT"))
    with pytest.raises(RuntimeError, match='"Cube" is in edit mode; nothing was stored'):
        bpy.ops.radiosity.bake()
    bpy.ops.object.mode_set(mode="OBJECT")
    assert cube.radiosity.kind == "NONE"
    assert len(cube.data.color_attributes) == 0


@pytest.mark.usefixtures("quick_bake")
def test_a_refined_object_that_is_edited_is_not_replaced(run_instead):
    add_cube(select=True)
    bake_selected()
    output = bpy.context.object
    change_during_bake(run_instead, lambda: bpy.ops.object.mode_set(mode="EDIT"))
    with pytest.raises(RuntimeError, match='"Cube Radiosity" is in edit mode; nothing was stored'):
        bpy.ops.radiosity.bake()
    bpy.ops.object.mode_set(mode="OBJECT")
    assert bpy.data.objects["Cube Radiosity"] == output


def test_an_object_renamed_during_the_bake_is_found(run_instead):
    cube = add_cube(select=True)
    change_during_bake(run_instead, lambda: setattr(cube, "name", "Renamed"))
    bake_selected()
    assert "Renamed Radiosity" in bpy.data.objects


def test_an_object_moved_during_the_bake_is_baked_where_it_was_and_named(run_instead):
    cube = add_cube(select=True)

    def move():
        cube.location.x = 5.0
        bpy.context.view_layer.update()

    change_during_bake(run_instead, move)
    bake_selected()
    assert any("moved" in warning for warning in report()["warnings"])
    assert colours_of(bpy.data.objects["Cube Radiosity"].data)[:, 0].max() == pytest.approx(1.0)


# ---------------------------------------------------------------------------------------------------------------------
# The report


@pytest.mark.usefixtures("quick_bake")
def test_the_report_has_the_cores_numbers_the_objects_and_the_seconds_of_each_side():
    add_cube(select=True)
    bake_selected()
    assert report()["objects"] == ["Cube Radiosity"]
    assert report()["patches"] == 1
    seconds = report()["seconds"]
    assert seconds["extract"] > 0.0 and seconds["store"] > 0.0
    assert seconds["total"] == pytest.approx(seconds["extract"] + seconds["store"], abs=1e-3)


def test_the_report_says_where_the_time_went():
    add_cube(select=True)
    add_lamp_mesh()
    bake_selected()
    shares = report()["profile"]
    assert set(shares) == {"ray_library", "arrays", "blender"}
    assert sum(shares.values()) == pytest.approx(1.0, abs=1e-3)
    assert min(shares.values()) > 0.0


def test_the_shares_of_the_time_are_of_the_clock_and_the_ray_librarys_that_of_one_thread():
    seconds = {"extract": 0.5, "store": 1.5, "total": 10.0}
    two_threads = profile(seconds, {"seconds_in_ray_library": 10.0, "threads": 2})
    assert two_threads == pytest.approx({"ray_library": 0.5, "arrays": 0.3, "blender": 0.2})
    one_thread = profile(seconds, {"seconds_in_ray_library": 3.0, "threads": 1})
    assert one_thread == pytest.approx({"ray_library": 0.3, "arrays": 0.5, "blender": 0.2})
    assert profile(seconds, {}) == pytest.approx({"ray_library": 0.0, "arrays": 0.8, "blender": 0.2})


def test_warnings_of_the_core_are_in_the_report(run_instead):
    def warn(scene, settings, progress):
        result = position_bake(scene, settings, progress)
        result.report["warnings"] = ["Light leaks under the wall"]
        return result

    add_cube(select=True)
    run_instead(warn)
    bake_selected()
    assert "Light leaks under the wall" in report()["warnings"]


def test_progress_reaches_the_callback(quick_bake):
    cube, seen = add_cube(), []
    bake_objects(bpy.context, [cube], bake_settings(bpy.context.scene.radiosity), seen.append)
    assert [message.stage for message in seen] == ["Form factors", "Gathering"]


# ---------------------------------------------------------------------------------------------------------------------
# Everything together, with the real numerics


@pytest.mark.parametrize("output", ["REFINED", "ORIGINAL"])
def test_a_floor_under_a_lamp_is_brightest_in_its_middle(output):
    floor = add_plane("Floor", select=True)
    floor.scale = (4.0, 4.0, 1.0)
    floor.data.update()
    bpy.context.scene.radiosity.output = output
    bpy.context.scene.radiosity.quality = "DRAFT"
    add_lamp_mesh(strength=10.0)
    bake_selected()
    colours = colours_of(bpy.context.object.data)
    assert np.all(np.isfinite(colours)) and colours[:, :3].min() > 0.0
    if output == "REFINED":
        assert colours[:, 0].max() > 4.0 * colours[:, 0].min()
    assert report()["rays"] > 0


def test_a_bevel_that_meets_itself_leaves_no_face_with_a_corner_twice():
    # A bevel as wide as half the height puts vertices on one another; Blender crashed in the normals of such faces.
    box = add_cube("Box", select=True)
    box.scale = (0.75, 0.8, 0.05)
    bevel = box.modifiers.new("Bevel", "BEVEL")
    bevel.width, bevel.segments = 0.05, 3
    bpy.ops.object.transform_apply(scale=True)
    add_lamp_mesh()
    bpy.context.scene.radiosity.quality = "DRAFT"
    bake_selected("REFINED")
    mesh = bpy.data.objects["Box Radiosity"].data
    assert all(len(set(face.vertices)) == 3 for face in mesh.polygons)
