# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""A bake from the window: progress, Esc, and an end in any mode. Events and a context stand for the window."""

import time
from types import SimpleNamespace

import bpy
import pytest
from radiosity_bake.core.progress import Progress
from radiosity_bake.operators.bake import RADIOSITY_OT_bake
from radiosity_bake.operators.doors import Watch

from tests.blender.making import add_cube, dark_bake
from tests.blender.state import file_state


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


class Operator:
    """An operator's doors on a plain object, since Blender alone can make operators."""

    def __init__(self, kind=RADIOSITY_OT_bake, **properties):
        self.kind, self.reports = kind, []
        self.__dict__.update(properties)

    def report(self, kind, text):
        self.reports.append((*kind, text))

    def __getattr__(self, name):
        return getattr(self.kind, name).__get__(self)


TIMER = SimpleNamespace(type="TIMER", value="NOTHING")
ESC = SimpleNamespace(type="ESC", value="PRESS")
MOUSE = SimpleNamespace(type="MOUSEMOVE", value="NOTHING")


def begun(kind=RADIOSITY_OT_bake, **properties):
    """Return an operator whose bake of the selected objects has begun, and its window."""
    operator, window = Operator(kind, **properties), Window()
    assert operator.invoke(window, None) == {"RUNNING_MODAL"}
    return operator, window


def until_it_ends(operator, window):
    began = time.monotonic()
    while time.monotonic() - began < 10.0:
        state = operator.modal(window, TIMER)
        if state != {"PASS_THROUGH"}:
            return state
        time.sleep(0.01)
    raise AssertionError("the bake did not end")


def until_it_waits(operator, window):
    began = time.monotonic()
    while "Leave edit mode to finish the bake" not in window.status:
        assert operator.modal(window, TIMER) == {"PASS_THROUGH"}
        assert time.monotonic() - began < 10.0
        time.sleep(0.01)


def assert_left(window):
    assert Watch.running is None
    assert (window.timers, window.progress, window.status) == (0, None, None)


@pytest.mark.usefixtures("quick_bake")
def test_a_modal_bake_lets_other_events_pass_and_stores_at_its_end():
    add_cube(select=True)
    operator, window = begun()
    assert (window.timers, window.handlers) == (1, 1)
    assert "Esc" in window.status
    assert operator.modal(window, MOUSE) == {"PASS_THROUGH"}
    assert until_it_ends(operator, window) == {"FINISHED"}
    assert_left(window)
    assert "Cube Radiosity" in bpy.data.objects
    assert operator.reports[-1][0] == "INFO"


@pytest.mark.usefixtures("quick_bake")
@pytest.mark.parametrize("output", ["REFINED", "ORIGINAL"])
def test_a_bake_that_ends_in_edit_mode_is_stored_when_the_mode_is_left(output):
    cube = add_cube(select=True)
    bpy.context.scene.radiosity.output = output
    operator, window = begun()
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
    operator, window = begun()
    bpy.ops.object.mode_set(mode="EDIT")
    until_it_waits(operator, window)
    assert operator.modal(window, ESC) == {"CANCELLED"}
    bpy.ops.object.mode_set(mode="OBJECT")
    assert_left(window)
    assert cube.radiosity.kind == "NONE"


def test_an_error_does_not_wait_for_the_end_of_edit_mode(run_instead):
    add_cube(select=True)
    run_instead(dark_bake)
    operator, window = begun()
    bpy.ops.object.mode_set(mode="EDIT")
    assert until_it_ends(operator, window) == {"CANCELLED"}
    bpy.ops.object.mode_set(mode="OBJECT")
    assert operator.reports == [("ERROR", "Nothing in the scene emits light")]


def slow(scene, settings, progress):
    for step in range(1000):
        progress(Progress("Form factors", step / 1000, f"{step} rays"))
        time.sleep(0.01)


def test_a_modal_bake_shows_stage_share_and_counts(run_instead):
    add_cube(select=True)
    run_instead(slow)
    operator, window = begun()
    while not Watch.running.latest.detail:
        operator.modal(window, TIMER)
    assert "Form factors" in window.status and "rays" in window.status and "%" in window.status
    operator.modal(window, ESC)


def test_esc_ends_a_modal_bake_within_half_a_second_and_changes_nothing(run_instead):
    add_cube(select=True)
    before = file_state()
    run_instead(slow)
    operator, window = begun()
    time.sleep(0.05)
    began = time.monotonic()
    assert operator.modal(window, ESC) == {"CANCELLED"}
    assert time.monotonic() - began < 0.5
    assert_left(window)
    assert operator.reports[-1] == ("INFO", "Bake cancelled; nothing was changed")
    assert file_state() == before


def test_esc_does_not_wait_for_a_thread_that_does_not_listen(run_instead):
    add_cube(select=True)
    run_instead(lambda scene, settings, progress: time.sleep(1.0))
    operator, window = begun()
    began = time.monotonic()
    assert operator.modal(window, ESC) == {"CANCELLED"}
    assert time.monotonic() - began < 0.5
    assert_left(window)


def test_the_cancel_button_ends_a_modal_bake(run_instead):
    add_cube(select=True)
    run_instead(slow)
    assert not bpy.ops.radiosity.cancel.poll()
    operator, window = begun()
    assert bpy.ops.radiosity.cancel() == {"FINISHED"}
    assert operator.modal(window, TIMER) == {"CANCELLED"}
    assert_left(window)


def test_opening_another_file_ends_a_modal_bake(run_instead):
    add_cube(select=True)
    run_instead(slow)
    operator, window = begun()
    operator.cancel(window)
    assert_left(window)


def test_an_error_of_a_modal_bake_is_a_sentence(run_instead):
    add_cube(select=True)
    run_instead(dark_bake)
    operator, window = begun()
    assert until_it_ends(operator, window) == {"CANCELLED"}
    assert operator.reports == [("ERROR", "Nothing in the scene emits light")]
    assert_left(window)


def test_a_bug_in_a_modal_bake_leaves_nothing_running_and_keeps_its_traceback(run_instead):
    def broken(scene, settings, progress):
        raise ZeroDivisionError

    add_cube(select=True)
    run_instead(broken)
    operator, window = begun()
    with pytest.raises(ZeroDivisionError) as caught:
        until_it_ends(operator, window)
    assert caught.traceback[-1].name == "broken"
    assert_left(window)


def test_a_modal_bake_stores_in_the_scene_that_it_read(quick_bake):
    add_cube(select=True)
    scene = bpy.context.scene
    operator, window = begun()
    other = bpy.data.scenes.new("Other")
    window.scene, window.view_layer = other, other.view_layers[0]
    assert until_it_ends(operator, window) == {"FINISHED"}
    assert scene.radiosity.report and not other.radiosity.report
    assert "Cube Radiosity" in scene.objects


@pytest.mark.usefixtures("quick_bake")
def test_invalid_settings_are_a_sentence(refused_settings):
    add_cube(select=True)
    operator = Operator()
    assert operator.invoke(Window(), None) == {"CANCELLED"}
    assert operator.reports == [("ERROR", refused_settings)]
