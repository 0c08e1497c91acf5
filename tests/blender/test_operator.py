# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The bake operator: one clear sentence for whatever cannot be done, and nothing changed then."""

import json
import time
from types import SimpleNamespace

import bpy
import numpy as np
import pytest
from radiosity_bake.core.errors import Cancelled, NoLightError
from radiosity_bake.core.progress import Progress
from radiosity_bake.operators import bake as bake_module
from radiosity_bake.operators.bake import RADIOSITY_OT_bake, bake_objects, reason_not_to_bake
from radiosity_bake.operators.settings import bake_settings

from tests.blender.making import (
    add_cube,
    add_lamp_mesh,
    add_mesh,
    add_object,
    add_plane,
    colours_of,
    position_bake,
)
from tests.blender.state import file_state


def bake():
    return bpy.ops.radiosity.bake()


def report():
    return json.loads(bpy.context.scene.radiosity.report)


def run_instead(monkeypatch, function):
    monkeypatch.setattr(bake_module, "_core_bake", lambda: function)


# ---------------------------------------------------------------------------------------------------------------------
# When the button is grey


def test_the_button_is_grey_without_a_selected_mesh():
    assert reason_not_to_bake(bpy.context) == "Select the meshes to bake"
    assert not bpy.ops.radiosity.bake.poll()
    with pytest.raises(RuntimeError, match="Select the meshes to bake"):
        bake()


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
    monkeypatch.setattr("radiosity_bake.core.visibility.ray_library_problem", lambda: why)
    assert reason_not_to_bake(bpy.context) == why
    with pytest.raises(RuntimeError, match=why):
        bake()


def test_the_button_is_grey_while_a_bake_runs(monkeypatch):
    add_cube(select=True)
    monkeypatch.setattr(RADIOSITY_OT_bake, "job", object())
    assert "running" in reason_not_to_bake(bpy.context)


def test_the_button_is_grey_when_all_selected_meshes_are_linked(tmp_path):
    add_cube("Linked")
    path = str(tmp_path / "library.blend")
    bpy.ops.wm.save_as_mainfile(filepath=path)
    bpy.ops.wm.read_factory_settings(use_empty=True)
    with bpy.data.libraries.load(path, link=True) as (_, wanted):
        wanted.objects = ["Linked"]
    (linked,) = wanted.objects
    bpy.context.scene.collection.objects.link(linked)
    linked.select_set(True)
    assert "linked from another file" in reason_not_to_bake(bpy.context)


# ---------------------------------------------------------------------------------------------------------------------
# What ends in a sentence


def test_a_mesh_without_faces_is_an_error_with_its_name():
    add_mesh("Points", [(0, 0, 0)], [], select=True)
    before = file_state()
    with pytest.raises(RuntimeError, match=r'None of the selected objects can be baked: "Points" has no faces$'):
        bake()
    assert file_state() == before


def test_a_selection_that_cannot_be_baked_is_one_sentence_about_the_whole():
    for name in ("A", "B", "C", "D"):
        add_cube(name, select=True).hide_render = True
    add_mesh("Points", [(0, 0, 0)], [], select=True)
    names = '"A", "B", "C" and 1 more'
    with pytest.raises(RuntimeError) as caught:
        bake()
    assert str(caught.value).strip() == (
        f'Error: None of the selected objects can be baked: {names} are not shown in renders, and "Points" has no faces'
    )


def test_a_scene_without_light_is_an_error_and_nothing_changes():
    add_cube(select=True)
    before = file_state()
    with pytest.raises(RuntimeError, match=r"^Error: [A-Z].*(light|emit)"):
        bake()
    assert file_state() == before


@pytest.mark.usefixtures("quick_bake")
def test_other_objects_in_the_selection_are_skipped_and_named():
    add_object("Empty", None, select=True)
    add_cube(select=True)
    assert bake() == {"FINISHED"}
    assert any('"Empty"' in warning for warning in report()["warnings"])


def test_a_cancelled_bake_is_no_error_and_changes_nothing(monkeypatch):
    def cancelled(scene, settings, progress):
        raise Cancelled

    add_cube(select=True)
    before = file_state()
    run_instead(monkeypatch, cancelled)
    assert bake() == {"CANCELLED"}
    assert file_state() == before


def test_a_bug_keeps_its_traceback(monkeypatch):
    def broken(scene, settings, progress):
        raise ZeroDivisionError("a bug in the numerics")

    add_cube(select=True)
    run_instead(monkeypatch, broken)
    with pytest.raises(RuntimeError, match=r"in broken\n.*raise ZeroDivisionError"):
        bake()


def change_during_bake(monkeypatch, change):
    """Have `change` happen between reading and storing, as it may while the bake runs in its thread."""

    def bake_and_change(scene, settings, progress):
        change()
        return position_bake(scene, settings, progress)

    run_instead(monkeypatch, bake_and_change)


@pytest.mark.parametrize("output", ["REFINED", "ORIGINAL"])
def test_an_object_deleted_during_the_bake_is_a_sentence(monkeypatch, output):
    cube = add_cube(select=True)
    add_plane(select=True)
    bpy.context.scene.radiosity.output = output
    change_during_bake(monkeypatch, lambda: bpy.data.objects.remove(cube))
    with pytest.raises(RuntimeError, match='"Cube" was deleted during the bake; nothing was stored'):
        bake()
    assert [obj.name for obj in bpy.data.objects] == ["Plane"]
    assert bpy.data.objects["Plane"].radiosity.kind == "NONE"


@pytest.mark.parametrize("output", ["REFINED", "ORIGINAL"])
def test_a_mesh_edited_during_the_bake_is_a_sentence(monkeypatch, output):
    cube = add_cube(select=True)
    bpy.context.scene.radiosity.output = output
    change_during_bake(monkeypatch, lambda: setattr(cube.data.vertices[0].co, "x", -3.0))
    with pytest.raises(RuntimeError, match='The mesh of "Cube" was edited during the bake'):
        bake()
    assert cube.radiosity.kind == "NONE"
    assert len(cube.data.color_attributes) == 0


@pytest.mark.parametrize("output", ["REFINED", "ORIGINAL"])
def test_edit_mode_entered_during_the_bake_is_a_sentence(monkeypatch, output):
    cube = add_cube(select=True)
    bpy.context.scene.radiosity.output = output
    change_during_bake(monkeypatch, lambda: bpy.ops.object.mode_set(mode="EDIT"))
    with pytest.raises(RuntimeError, match='"Cube" is in edit mode; nothing was stored'):
        bake()
    bpy.ops.object.mode_set(mode="OBJECT")
    assert cube.radiosity.kind == "NONE"
    assert len(cube.data.color_attributes) == 0


def test_an_object_renamed_during_the_bake_is_found(monkeypatch):
    cube = add_cube(select=True)
    change_during_bake(monkeypatch, lambda: setattr(cube, "name", "Renamed"))
    assert bake() == {"FINISHED"}
    assert "Renamed Radiosity" in bpy.data.objects


def test_an_object_moved_during_the_bake_is_baked_where_it_was_and_named(monkeypatch):
    cube = add_cube(select=True)

    def move():
        cube.location.x = 5.0
        bpy.context.view_layer.update()

    change_during_bake(monkeypatch, move)
    assert bake() == {"FINISHED"}
    assert any("moved" in warning for warning in report()["warnings"])
    assert colours_of(bpy.data.objects["Cube Radiosity"].data)[:, 0].max() == pytest.approx(1.0)


# ---------------------------------------------------------------------------------------------------------------------
# The report


@pytest.mark.usefixtures("quick_bake")
def test_the_report_has_the_cores_numbers_the_objects_and_the_seconds_of_each_side():
    add_cube(select=True)
    bake()
    assert report()["objects"] == ["Cube Radiosity"]
    assert report()["patches"] == 1
    seconds = report()["seconds"]
    assert seconds["extract"] > 0.0 and seconds["store"] > 0.0
    assert seconds["total"] == pytest.approx(seconds["extract"] + seconds["store"], abs=1e-3)


def test_the_report_says_where_the_time_went():
    add_cube(select=True)
    add_lamp_mesh()
    bake()
    profile = report()["profile"]
    assert set(profile) == {"ray_library", "arrays", "blender"}
    assert sum(profile.values()) == pytest.approx(1.0, abs=1e-3)
    assert min(profile.values()) > 0.0


def test_warnings_of_the_core_are_in_the_report(monkeypatch):
    def warn(scene, settings, progress):
        result = position_bake(scene, settings, progress)
        result.report["warnings"] = ["Light leaks under the wall"]
        return result

    add_cube(select=True)
    run_instead(monkeypatch, warn)
    bake()
    assert "Light leaks under the wall" in report()["warnings"]


def test_progress_reaches_the_callback(quick_bake):
    cube, seen = add_cube(), []
    bake_objects(bpy.context, [cube], bake_settings(bpy.context.scene.radiosity), seen.append)
    assert [message.stage for message in seen] == ["Form factors", "Gathering"]


# ---------------------------------------------------------------------------------------------------------------------
# The modal door, without a window: events and a context are all it needs


class Window:
    """The part of a context that the modal door uses beside the file."""

    def __init__(self):
        self.status, self.timers, self.handlers, self.progress = None, 0, 0, None
        self.window_manager = self
        self.workspace = self
        self.windows = ()
        self.window = self.space_data = None
        self.scene, self.view_layer = bpy.context.scene, bpy.context.view_layer
        self.selected_objects = bpy.context.selected_objects

    @property
    def mode(self):
        return bpy.context.mode

    def evaluated_depsgraph_get(self):
        return bpy.context.evaluated_depsgraph_get()

    def event_timer_add(self, seconds, window):
        self.timers += 1
        return "timer"

    def event_timer_remove(self, timer):
        self.timers -= 1

    def modal_handler_add(self, operator):
        self.handlers += 1

    def progress_begin(self, least, most):
        self.progress = least

    def progress_update(self, value):
        self.progress = value

    def progress_end(self):
        self.progress = None

    def status_text_set(self, text):
        self.status = text


class ModalBake:
    """The operator's methods on a plain object, since Blender alone can make operators."""

    def __init__(self):
        self.reports = []

    def report(self, kind, text):
        self.reports.append((*kind, text))

    def __getattr__(self, name):
        return getattr(RADIOSITY_OT_bake, name).__get__(self)


TIMER = SimpleNamespace(type="TIMER", value="NOTHING")
ESC = SimpleNamespace(type="ESC", value="PRESS")
MOUSE = SimpleNamespace(type="MOUSEMOVE", value="NOTHING")


def until_it_ends(operator, window):
    began = time.monotonic()
    while time.monotonic() - began < 10.0:
        state = operator.modal(window, TIMER)
        if state != {"PASS_THROUGH"}:
            return state
        time.sleep(0.01)
    raise AssertionError("the bake did not end")


def assert_left(window):
    assert RADIOSITY_OT_bake.job is None
    assert (window.timers, window.progress, window.status) == (0, None, None)


@pytest.mark.usefixtures("quick_bake")
def test_a_modal_bake_lets_other_events_pass_and_stores_at_its_end():
    add_cube(select=True)
    operator, window = ModalBake(), Window()
    assert operator.invoke(window, None) == {"RUNNING_MODAL"}
    assert (window.timers, window.handlers) == (1, 1)
    assert "Esc" in window.status
    assert operator.modal(window, MOUSE) == {"PASS_THROUGH"}
    assert until_it_ends(operator, window) == {"FINISHED"}
    assert_left(window)
    assert "Cube Radiosity" in bpy.data.objects
    assert operator.reports[-1][0] == "INFO"


def until_it_waits(operator, window):
    began = time.monotonic()
    while "Leave edit mode to finish the bake" not in window.status:
        assert operator.modal(window, TIMER) == {"PASS_THROUGH"}
        assert time.monotonic() - began < 10.0
        time.sleep(0.01)


@pytest.mark.usefixtures("quick_bake")
@pytest.mark.parametrize("output", ["REFINED", "ORIGINAL"])
def test_a_bake_that_ends_in_edit_mode_is_stored_when_the_mode_is_left(output):
    cube = add_cube(select=True)
    bpy.context.scene.radiosity.output = output
    operator, window = ModalBake(), Window()
    operator.invoke(window, None)
    bpy.ops.object.mode_set(mode="EDIT")
    until_it_waits(operator, window)
    assert operator.modal(window, TIMER) == operator.modal(window, MOUSE) == {"PASS_THROUGH"}
    assert cube.radiosity.kind == "NONE"
    bpy.ops.object.mode_set(mode="OBJECT")
    assert operator.modal(window, TIMER) == {"FINISHED"}
    assert_left(window)
    assert cube.radiosity.kind != "NONE"


@pytest.mark.usefixtures("quick_bake")
def test_a_bake_that_waits_for_the_end_of_edit_mode_can_be_cancelled():
    cube = add_cube(select=True)
    operator, window = ModalBake(), Window()
    operator.invoke(window, None)
    bpy.ops.object.mode_set(mode="EDIT")
    until_it_waits(operator, window)
    assert operator.modal(window, ESC) == {"CANCELLED"}
    bpy.ops.object.mode_set(mode="OBJECT")
    assert_left(window)
    assert cube.radiosity.kind == "NONE"


def test_an_error_does_not_wait_for_the_end_of_edit_mode(monkeypatch):
    def dark(scene, settings, progress):
        raise NoLightError("Nothing in the scene emits light")

    add_cube(select=True)
    run_instead(monkeypatch, dark)
    operator, window = ModalBake(), Window()
    operator.invoke(window, None)
    bpy.ops.object.mode_set(mode="EDIT")
    assert until_it_ends(operator, window) == {"CANCELLED"}
    bpy.ops.object.mode_set(mode="OBJECT")
    assert operator.reports == [("ERROR", "Nothing in the scene emits light")]


@pytest.mark.usefixtures("quick_bake")
def test_a_refined_object_that_is_edited_is_not_replaced(monkeypatch):
    add_cube(select=True)
    bake()
    output = bpy.context.object
    change_during_bake(monkeypatch, lambda: bpy.ops.object.mode_set(mode="EDIT"))
    with pytest.raises(RuntimeError, match='"Cube Radiosity" is in edit mode; nothing was stored'):
        bake()
    bpy.ops.object.mode_set(mode="OBJECT")
    assert bpy.data.objects["Cube Radiosity"] == output


def slow(scene, settings, progress):
    for step in range(1000):
        progress(Progress("Form factors", step / 1000, f"{step} rays"))
        time.sleep(0.01)


def test_a_modal_bake_shows_stage_share_and_counts(monkeypatch):
    add_cube(select=True)
    run_instead(monkeypatch, slow)
    operator, window = ModalBake(), Window()
    operator.invoke(window, None)
    while not RADIOSITY_OT_bake.job.latest.detail:
        operator.modal(window, TIMER)
    assert "Form factors" in window.status and "rays" in window.status and "%" in window.status
    operator.modal(window, ESC)


def test_esc_ends_a_modal_bake_within_half_a_second_and_changes_nothing(monkeypatch):
    add_cube(select=True)
    before = file_state()
    run_instead(monkeypatch, slow)
    operator, window = ModalBake(), Window()
    operator.invoke(window, None)
    time.sleep(0.05)
    began = time.monotonic()
    assert operator.modal(window, ESC) == {"CANCELLED"}
    assert time.monotonic() - began < 0.5
    assert_left(window)
    assert operator.reports[-1] == ("INFO", "Bake cancelled; nothing was changed")
    assert file_state() == before


def test_esc_does_not_wait_for_a_thread_that_does_not_listen(monkeypatch):
    add_cube(select=True)
    run_instead(monkeypatch, lambda scene, settings, progress: time.sleep(1.0))
    operator, window = ModalBake(), Window()
    operator.invoke(window, None)
    began = time.monotonic()
    assert operator.modal(window, ESC) == {"CANCELLED"}
    assert time.monotonic() - began < 0.5
    assert_left(window)


def test_the_cancel_button_ends_a_modal_bake(monkeypatch):
    add_cube(select=True)
    run_instead(monkeypatch, slow)
    operator, window = ModalBake(), Window()
    assert not bpy.ops.radiosity.cancel.poll()
    operator.invoke(window, None)
    assert bpy.ops.radiosity.cancel() == {"FINISHED"}
    assert operator.modal(window, TIMER) == {"CANCELLED"}
    assert_left(window)


def test_opening_another_file_ends_a_modal_bake(monkeypatch):
    add_cube(select=True)
    run_instead(monkeypatch, slow)
    operator, window = ModalBake(), Window()
    operator.invoke(window, None)
    operator.cancel(window)
    assert_left(window)


def test_an_error_of_a_modal_bake_is_a_sentence(monkeypatch):
    def dark(scene, settings, progress):
        raise NoLightError("Nothing in the scene emits light")

    add_cube(select=True)
    run_instead(monkeypatch, dark)
    operator, window = ModalBake(), Window()
    operator.invoke(window, None)
    assert until_it_ends(operator, window) == {"CANCELLED"}
    assert operator.reports == [("ERROR", "Nothing in the scene emits light")]
    assert_left(window)


def test_a_bug_in_a_modal_bake_leaves_nothing_running_and_keeps_its_traceback(monkeypatch):
    def broken(scene, settings, progress):
        raise ZeroDivisionError

    add_cube(select=True)
    run_instead(monkeypatch, broken)
    operator, window = ModalBake(), Window()
    operator.invoke(window, None)
    with pytest.raises(ZeroDivisionError) as caught:
        until_it_ends(operator, window)
    assert caught.traceback[-1].name == "broken"
    assert_left(window)


def test_a_modal_bake_stores_in_the_scene_that_it_read(monkeypatch, quick_bake):
    add_cube(select=True)
    scene = bpy.context.scene
    operator, window = ModalBake(), Window()
    operator.invoke(window, None)
    other = bpy.data.scenes.new("Other")
    window.scene, window.view_layer = other, other.view_layers[0]
    assert until_it_ends(operator, window) == {"FINISHED"}
    assert scene.radiosity.report and not other.radiosity.report
    assert "Cube Radiosity" in scene.objects


def test_invalid_settings_are_a_sentence(monkeypatch, quick_bake):
    from radiosity_bake.core.errors import SettingsError

    def refuse(properties):
        raise SettingsError("Threshold is 0; choose a value above 0 and up to 1")

    add_cube(select=True)
    monkeypatch.setattr(bake_module, "bake_settings", refuse)
    with pytest.raises(RuntimeError, match="Threshold is 0"):
        bake()
    operator = ModalBake()
    assert operator.invoke(Window(), None) == {"CANCELLED"}
    assert operator.reports[0][0] == "ERROR"


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
    assert bake() == {"FINISHED"}
    colours = colours_of(bpy.context.object.data)
    assert np.all(np.isfinite(colours)) and colours[:, :3].min() > 0.0
    if output == "REFINED":
        assert colours[:, 0].max() > 4.0 * colours[:, 0].min()
    assert report()["rays"] > 0
