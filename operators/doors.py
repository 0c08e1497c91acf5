# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The two doors of everything that bakes: to the end for scripts, and watched in the window for people.

While a bake is watched the artist may do anything: edit, delete, undo, switch scenes and workspaces, close the window,
open a file, disable the extension, quit. Whatever it is, a `Watch` ends in a sentence, and leaves nothing behind.
"""

from collections.abc import Callable
from contextlib import suppress
from typing import Any, ClassVar, Protocol

import bpy

from ..core.errors import BakeError, Cancelled
from ..core.progress import Progress, ProgressCallback, no_progress
from ..core.result import BakeResult
from ..core.scene import Scene
from ..core.settings import BakeSettings
from .display import show_in_viewport
from .job import Bake, BakeJob, Failed, Finished

POLL_SECONDS = 0.1
_PATIENCE_SECONDS = 0.3
"""How long Esc waits for the thread. It stops at its next message anyway, and what it finds then is thrown away."""
_PATIENCE_AT_THE_END = 5.0
"""How long the end of Blender, or of the extension, waits for it: Python cannot end below a thread that runs."""

_EDITING = ("TRANSFORM_OT_", "OBJECT_OT_")
"""Modal operators that hold on to objects, which must not be exchanged under them; by how their names begin."""


class Task(Protocol):
    """What is baked, in one step or several: `begin`, then the light in whatever thread, then `take`, until `done`."""

    purpose: str
    """What it goes on to do in object mode, to end a sentence with."""
    cancelled: str
    """The sentence on a bake that was cancelled."""

    @property
    def done(self) -> bool:
        """Whether every step was taken."""

    def begin(self) -> tuple[Scene, BakeSettings, Bake]:
        """Read the next step from Blender, and return what lights it; raises `BakeError`."""

    def take(self, result: BakeResult) -> None:
        """Keep the light of the step that was begun; raises `BakeError`."""

    def finish(self) -> dict[str, Any]:
        """Store what was taken, and return the report; raises `BakeError`."""

    def leave(self) -> None:
        """Put back whatever `begin` changed; called in any case, and last."""

    def summary(self, report: dict[str, Any]) -> str:
        """Return a sentence on a bake that ended well."""


def run_to_end(task: Task, progress: ProgressCallback = no_progress) -> dict[str, Any]:
    """Bake from beginning to end, and return the report.

    Raises
    ------
    BakeError
        With a sentence for the user.
    Cancelled
        When `progress` raised it.
    """
    try:
        while not task.done:
            scene, settings, light = task.begin()
            task.take(light(scene, settings, progress))
        return task.finish()
    finally:
        task.leave()


Report = Callable[[set[str], str], None]
"""An operator's `report`."""


class Watch:
    """A task in the window: its thread and timer, what the window shows of it, and its end."""

    running: ClassVar["Watch | None"] = None
    """The one that runs; there is at most one, and the panel shows its progress."""

    def __init__(self, task: Task, report: Report) -> None:
        self._task: Task | None = task
        self._report = report
        self._job: BakeJob | None = None
        self._outcome: Finished | Failed | None = None
        self._timer: bpy.types.Timer | None = None
        self._workspaces: list[bpy.types.WorkSpace] = []

    @property
    def latest(self) -> Progress:
        """How far the bake is."""
        return self._job.latest

    def start(self, context: bpy.types.Context) -> bool:
        """Begin the first step and look after it from now on; returns False, and tells why, if that cannot be."""
        try:
            self._begin()
        except BakeError as error:
            self._task.leave()
            self._report({"ERROR"}, str(error))
            return False
        except BaseException:
            self._task.leave()
            raise
        Watch.running = self
        context.window_manager.progress_begin(0, 100)
        self._timer = context.window_manager.event_timer_add(POLL_SECONDS, window=context.window)
        self._show(context, self._job.latest)
        return True

    def modal(self, context: bpy.types.Context, event: bpy.types.Event) -> set[str]:
        """Show how far the bake is, go on with the next step, and store it all in the end: an operator's `modal`."""
        if Watch.running is not self:
            return {"CANCELLED"}
        if event.type == "ESC" and event.value == "PRESS":
            self._job.cancel()
        if self._job.cancelled:
            self._job.wait(_PATIENCE_SECONDS)
            return self._end(context, {"INFO"}, self._task.cancelled)
        if event.type != "TIMER":
            return {"PASS_THROUGH"}
        messages = self._job.messages()
        if messages and not isinstance(messages[-1], Progress):
            self._outcome = messages[-1]
        if self._outcome is None:
            if messages:
                self._show(context, self._job.latest)
            return {"PASS_THROUGH"}
        # Objects cannot be exchanged, another frame be read, nor the step of undo be made, in the middle of an edit.
        wait_for = way_to_rest(context) if isinstance(self._outcome, Finished) else None
        if wait_for is not None:
            self._job.latest = Progress(f"{wait_for} to {self._task.purpose}", self._job.latest.share)
            self._show(context, self._job.latest)
            return {"PASS_THROUGH"}
        return self._go_on(context)

    def cancel(self, context: bpy.types.Context, patience: float = 0.0) -> None:
        """Stop without a word, when Blender or the extension ends what runs; waits so many seconds for the thread."""
        if Watch.running is self:
            self._job.cancel()
            job = self._job
            self._leave(context)
            job.wait(patience)

    def ask_to_stop(self) -> None:
        """Have the bake end as Esc does, at the next turn."""
        self._job.cancel()

    def _begin(self) -> None:
        scene, settings, light = self._task.begin()
        self._outcome = None
        self._job = BakeJob(light, scene, settings)
        self._job.start()

    def _go_on(self, context: bpy.types.Context) -> set[str]:
        outcome, self._outcome = self._outcome, None
        try:
            if isinstance(outcome, Failed):
                raise outcome.error
            self._task.take(outcome.result)
            if not self._task.done:
                self._begin()
                return {"PASS_THROUGH"}
            report = self._task.finish()
        except Cancelled:
            return self._end(context, {"INFO"}, self._task.cancelled)
        except BakeError as error:
            return self._end(context, {"ERROR"}, str(error))
        except BaseException:
            self._leave(context)
            raise
        sentence = self._task.summary(report)
        self._leave(context)
        show_in_viewport(context, (bpy.data.objects[name] for name in report["objects"]))
        self._report({"WARNING" if report["warnings"] else "INFO"}, sentence)
        return {"FINISHED"}

    def _end(self, context: bpy.types.Context, kind: set[str], sentence: str) -> set[str]:
        self._leave(context)
        self._report(kind, sentence)
        return {"CANCELLED"}

    def _show(self, context: bpy.types.Context, progress: Progress) -> None:
        detail = f" ({progress.detail})" if progress.detail else ""
        self._tell(context, f"Radiosity  {progress.share:.0%}  {progress.stage}{detail}  |  Esc: Cancel")
        context.window_manager.progress_update(100.0 * progress.share)
        redraw_panels(context)

    def _tell(self, context: bpy.types.Context, sentence: str) -> None:
        """Show a sentence in the status bar, which belongs to the workspace: another one may be shown by now."""
        if [context.workspace] != self._workspaces:
            self._fall_silent()
            # There is none while Blender opens a file or closes a window.
            self._workspaces = [context.workspace] if context.workspace is not None else []
        for workspace in self._workspaces:
            workspace.status_text_set(sentence)

    def _fall_silent(self) -> None:
        for workspace in self._workspaces:
            # It may have been deleted.
            with suppress(ReferenceError):
                workspace.status_text_set(None)
        self._workspaces = []

    def _leave(self, context: bpy.types.Context) -> None:
        # Blender may keep the operator, and with it what this holds.
        task, self._task = self._task, None
        self._job, self._outcome, Watch.running = None, None, None
        try:
            task.leave()
        finally:
            if self._timer is not None:
                context.window_manager.event_timer_remove(self._timer)
                context.window_manager.progress_end()
                self._timer = None
            self._fall_silent()
            redraw_panels(context)


class TwoDoors:
    """An operator that bakes: blocking from a script, with progress and a way out from the window."""

    def task(self, context: bpy.types.Context) -> Task:
        """Return what is baked; raises `BakeError`."""
        raise NotImplementedError

    def execute(self, context):
        """Bake to the end: the door for scripts."""
        try:
            task = self.task(context)
        except BakeError as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}
        try:
            report = run_to_end(task)
        except Cancelled:
            self.report({"INFO"}, task.cancelled)
            return {"CANCELLED"}
        except BakeError as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}
        self.report({"WARNING" if report["warnings"] else "INFO"}, task.summary(report))
        return {"FINISHED"}

    def invoke(self, context, _event):
        """Begin in a thread, and watch it: the door for people."""
        try:
            self._watch = Watch(self.task(context), self.report)
        except BakeError as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}
        if not self._watch.start(context):
            return {"CANCELLED"}
        context.window_manager.modal_handler_add(self)
        return {"RUNNING_MODAL"}

    def modal(self, context, event):
        """Look after the bake."""
        return self._watch.modal(context, event)

    def cancel(self, context):
        """Stop when Blender ends the operator itself, as it does when another file is opened."""
        self._watch.cancel(context)


class RADIOSITY_OT_cancel(bpy.types.Operator):
    """Ask the running bake to stop."""

    bl_idname = "radiosity.cancel"
    bl_label = "Cancel Bake"
    bl_description = "Stop the bake that is running; nothing is changed. Esc does the same"
    bl_options = {"INTERNAL"}  # noqa: RUF012 - Blender reads it from the class

    @classmethod
    def poll(cls, _context):
        """Return whether a bake is running."""
        return Watch.running is not None

    def execute(self, _context):
        """Ask the running bake to stop."""
        Watch.running.ask_to_stop()
        return {"FINISHED"}


def stop_running_bake() -> None:
    """End a running bake at once, if there is one, and what the window shows of it."""
    if Watch.running is not None:
        Watch.running.cancel(bpy.context, _PATIENCE_AT_THE_END)


def way_to_rest(context: bpy.types.Context) -> str | None:
    """Return what to do before objects may be exchanged, to begin a sentence with, or None when they may."""
    if context.mode != "OBJECT":
        return way_to_object_mode(context)
    for window in context.window_manager.windows:
        # Of an operator whose add-on was just disabled, there is none left.
        if any(operator and operator.bl_idname.startswith(_EDITING) for operator in window.modal_operators):
            return "Confirm or cancel what you are doing"
    return None


def way_to_object_mode(context: bpy.types.Context) -> str:
    """Return what to do to get into object mode, to begin a sentence with."""
    return "Leave edit mode" if "EDIT" in context.mode else "Switch to object mode"


def redraw_panels(context: bpy.types.Context) -> None:
    """Redraw the sidebars of the 3D viewports; drawing a heavy scene as well would delay Esc."""
    for window in context.window_manager.windows:
        for area in window.screen.areas:
            if area.type == "VIEW_3D":
                for region in area.regions:
                    if region.type == "UI":
                        region.tag_redraw()
