# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""What may happen to the file while a bake runs: each trap under Bake and under Bake Frames, for both outputs.

`tests/window/traps.py` springs the same in a real window.
"""

from types import SimpleNamespace

import bpy
import pytest
from radiosity_bake.operators import doors
from radiosity_bake.operators.animation import RADIOSITY_OT_bake_frames
from radiosity_bake.operators.bake import RADIOSITY_OT_bake

from tests.blender.making import add_cube, add_plane, diffuse_material, position_bake, report, select_also
from tests.blender.state import differences, file_state
from tests.blender.test_modal import ESC, TIMER, assert_left, begun, until_it_ends

KINDS = {"bake": RADIOSITY_OT_bake, "frames": RADIOSITY_OT_bake_frames}


@pytest.fixture(params=["REFINED", "ORIGINAL"])
def output(request):
    return request.param


@pytest.fixture(params=KINDS)
def trapped(request, output, run_instead):
    """A bake of a box, or of two frames, that has begun and goes on when it is looked after: operator and window."""

    def bake(scene, settings, progress, **options):
        result = position_bake(scene, settings, progress)
        # Nothing moves from frame to frame, or refined meshes could not carry both.
        result.report["relit"] = True
        return result

    run_instead(bake)
    scene = bpy.context.scene
    scene.frame_start, scene.frame_end, scene.radiosity.output = 1, 2, output
    scene.frame_set(5)
    add_plane("Floor")
    box = add_cube("Box", materials=[diffuse_material()])
    select_also(box)
    properties = {"frame_output": "ATTRIBUTES"} if request.param == "frames" else {}
    operator, window = begun(KINDS[request.param], **properties)
    yield operator, window
    if doors.Watch.running is not None:
        doors.Watch.running.cancel(window)


def sentence_at_the_end(trapped, state):
    operator, window = trapped
    assert until_it_ends(operator, window) == state
    assert_left(window)
    ((kind, sentence),) = operator.reports
    assert kind == ("ERROR" if state == {"CANCELLED"} else "INFO")
    return sentence


def test_an_object_that_is_deleted_is_named_and_nothing_is_stored(trapped):
    bpy.data.objects.remove(bpy.data.objects["Box"])
    before = file_state()
    assert '"Box" was deleted' in sentence_at_the_end(trapped, {"CANCELLED"})
    bpy.context.scene.frame_set(5)
    assert not differences(before["objects"], file_state()["objects"])
    assert {mesh.name for mesh in bpy.data.meshes} == {"Floor", "Box"}


def test_an_object_that_is_edited_is_named_and_nothing_is_stored(trapped):
    bpy.data.meshes["Box"].vertices[0].co.x = 3.0
    before = file_state()
    assert 'The mesh of "Box" was edited' in sentence_at_the_end(trapped, {"CANCELLED"})
    assert not differences(before, file_state())


def test_faces_that_are_added_are_an_edit_too(trapped):
    mesh = bpy.data.meshes["Box"]
    mesh.clear_geometry()
    mesh.from_pydata([(0, 0, 0), (1, 0, 0), (0, 1, 0)], [], [(0, 1, 2)])
    assert 'The mesh of "Box" was edited' in sentence_at_the_end(trapped, {"CANCELLED"})


def test_an_object_that_is_renamed_is_found(trapped):
    bpy.data.objects["Box"].name = "Chest"
    assert "Baked" in sentence_at_the_end(trapped, {"FINISHED"})
    assert report()["objects"][0].startswith("Chest")


def enter_edit_mode(window):
    bpy.context.view_layer.objects.active = bpy.data.objects["Box"]
    bpy.ops.object.mode_set(mode="EDIT")


def rename(window):
    bpy.data.objects["Box"].name = "Chest"


def delete(window):
    bpy.data.objects.remove(bpy.data.objects["Box"])


def give_another_mesh(window):
    bpy.data.objects["Box"].data = bpy.data.meshes["Floor"]


def show_another_scene(window):
    other = bpy.data.scenes.new("Other")
    bpy.context.window.scene = other
    window.scene, window.view_layer = other, other.view_layers[0]


@pytest.mark.parametrize(
    ("first", "second", "state"),
    [
        (enter_edit_mode, delete, "CANCELLED"),
        (show_another_scene, delete, "CANCELLED"),
        (give_another_mesh, rename, "CANCELLED"),
        (rename, show_another_scene, "FINISHED"),
    ],
)
def test_two_traps_at_once_end_in_one_sentence_too(trapped, first, second, state):
    first(trapped[1])
    second(trapped[1])
    sentence_at_the_end(trapped, {state})
    assert not any(mesh.validate() for mesh in bpy.data.meshes)


def test_a_scene_that_is_deleted_ends_the_bake(trapped):
    _, window = trapped
    scene, other = bpy.context.scene, bpy.data.scenes.new("Other")
    bpy.context.window.scene = other
    window.scene, window.view_layer = other, other.view_layers[0]
    bpy.data.scenes.remove(scene)
    assert "The scene was deleted" in sentence_at_the_end(trapped, {"CANCELLED"})
    assert not other.radiosity.report


def test_another_scene_that_is_shown_keeps_its_frame_and_gets_no_light(trapped):
    _, window = trapped
    scene, other = bpy.context.scene, bpy.data.scenes.new("Other")
    other.frame_set(7)
    bpy.context.window.scene = other
    window.scene, window.view_layer = other, other.view_layers[0]
    assert "Baked" in sentence_at_the_end(trapped, {"FINISHED"})
    assert (scene.frame_current, other.frame_current) == (5, 7)
    assert scene.radiosity.report and not other.radiosity.report


def test_a_view_layer_that_is_removed_ends_the_bake(trapped):
    scene = bpy.context.scene
    scene.view_layers.new("Another")
    scene.view_layers.remove(scene.view_layers[0])
    assert "The view layer" in sentence_at_the_end(trapped, {"CANCELLED"})


class Workspace:
    status, deleted = None, False

    def status_text_set(self, text):
        if self.deleted:
            raise ReferenceError("StructRNA of type WorkSpace has been removed")
        self.status = text


@pytest.mark.parametrize("deleted", [False, True])
def test_the_status_text_goes_from_a_workspace_that_is_left_or_deleted(trapped, deleted):
    operator, window = trapped
    first, second = Workspace(), Workspace()
    for workspace in (first, second):
        window.workspace = workspace
        operator._watch._show(window, operator._watch.latest)
        assert "Radiosity" in workspace.status
        first.deleted = deleted
    assert deleted or first.status is None
    assert operator.modal(window, ESC) == {"CANCELLED"}
    assert second.status is None


def test_without_a_workspace_as_when_a_file_is_opened_the_bake_is_left_without_a_word(trapped):
    operator, window = trapped
    window.workspace = None
    operator.cancel(window)
    assert_left(window)
    assert operator.reports == []
    assert bpy.context.scene.frame_current == 5
    # Blender may call it once more.
    operator.cancel(window)


def test_objects_that_are_being_moved_are_not_exchanged_before_that_is_over(trapped):
    operator, window = trapped
    moving = SimpleNamespace(bl_idname="TRANSFORM_OT_translate")
    window.windows = [SimpleNamespace(modal_operators=[None, moving], screen=SimpleNamespace(areas=[]))]
    while "Confirm or cancel what you are doing" not in window.status:
        assert operator.modal(window, TIMER) == {"PASS_THROUGH"}
    assert bpy.data.objects["Box"].radiosity.kind == "NONE"
    window.windows = []
    assert "Baked" in sentence_at_the_end(trapped, {"FINISHED"})


def test_handlers_that_fail_do_not_end_the_bake(trapped, capfd):
    def broken(*_):
        raise RuntimeError("meant to fail")

    lists = (bpy.app.handlers.depsgraph_update_post, bpy.app.handlers.frame_change_post)
    for handlers in lists:
        handlers.append(broken)
    try:
        assert "Baked" in sentence_at_the_end(trapped, {"FINISHED"})
    finally:
        for handlers in lists:
            handlers.remove(broken)


def test_a_handler_that_deletes_what_is_baked_ends_it_in_a_sentence(trapped):
    def delete(*_):
        if "Box" in bpy.data.objects:
            bpy.data.objects.remove(bpy.data.objects["Box"])

    bpy.app.handlers.frame_change_pre.append(delete)
    try:
        bpy.context.scene.frame_set(6)
        assert '"Box" was deleted' in sentence_at_the_end(trapped, {"CANCELLED"})
    finally:
        bpy.app.handlers.frame_change_pre.remove(delete)


@pytest.mark.usefixtures("quick_bake")
def test_drivers_that_fail_are_named():
    box = add_cube("Box", materials=[diffuse_material("Paint")], select=True)
    box.driver_add("location", 2).driver.expression = "no_such_name"
    box.driver_add("scale", 0).driver.expression = "1.0"
    box.data.materials[0].node_tree.nodes[-1].inputs[0].driver_add("default_value", 0).driver.expression = "1 / 0"
    assert bpy.ops.radiosity.bake() == {"FINISHED"}
    of_object, of_nodes = report()["warnings"]
    assert of_object.startswith('"Box" has drivers that fail (location)')
    assert "default_value" in of_nodes
