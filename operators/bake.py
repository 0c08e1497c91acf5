# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The bake: one operator with two doors, and the use case behind both."""

import json
import time
from collections.abc import Iterable
from typing import Any, ClassVar

import bpy

from ..core.errors import BakeError, Cancelled
from ..core.progress import Progress, ProgressCallback, no_progress
from ..core.result import BakeResult
from ..core.scene import Scene
from ..core.settings import BakeSettings
from .attributes import attributes_of, attributes_to_be
from .display import show_in_viewport
from .extraction import Extraction, extract
from .job import BakeJob, Failed, Finished
from .record import source_of
from .sets import without_sets
from .settings import bake_settings
from .store import check_storable, scene_of, store
from .targets import shows_surfaces
from .transports import remember

POLL_SECONDS = 0.1
_PATIENCE_SECONDS = 0.3
"""How long Esc waits for the thread. It stops at its next message anyway, and what it finds then is thrown away."""


def bake_objects(
    context: bpy.types.Context,
    objects: Iterable[bpy.types.Object],
    settings: BakeSettings,
    progress: ProgressCallback = no_progress,
) -> dict[str, Any]:
    """Bake `objects` from beginning to end, and return the report.

    Raises
    ------
    BakeError
        With a sentence for the user; nothing was changed.
    Cancelled
        When `progress` raised it; nothing was changed.
    """
    began = time.perf_counter()
    extraction = extract(context, objects, settings.output)
    check_storable(extraction, attributes_to_be(settings, extraction.scene))
    read = time.perf_counter() - began
    return finish(extraction, trace(extraction.scene, settings, progress), settings, read)


def finish(extraction: Extraction, result: BakeResult, settings: BakeSettings, read: float) -> dict[str, Any]:
    """Store `result`, then write and return the report; `read` is the seconds that the extraction took."""
    began = time.perf_counter()
    scene = scene_of(extraction)
    attributes, exposure = attributes_of(settings, extraction, result)
    objects, cautions = store(scene, extraction, result, attributes, without_sets)
    remember(scene, extraction, settings, result, objects)
    report = shown_report(extraction, result, objects, cautions, exposure, read, time.perf_counter() - began)
    scene.radiosity.report = json.dumps(report)
    return report


def shown_report(
    extraction: Extraction,
    result: BakeResult,
    objects: list[bpy.types.Object],
    cautions: list[str],
    exposure: dict[str, Any] | None,
    read: float,
    stored: float,
) -> dict[str, Any]:
    """Return the report of the core with what the Blender side adds; `read` and `stored` are its seconds."""
    seconds = {"extract": read, **result.report.get("seconds", {}), "store": stored}
    seconds["total"] = seconds.get("total", 0.0) + seconds["extract"] + seconds["store"]
    return {
        **result.report,
        "seconds": {stage: round(value, 4) for stage, value in seconds.items()},
        "profile": profile(seconds, result.report),
        "objects": [obj.name for obj in objects],
        "evaluated_by_blender": list(extraction.evaluated),
        "exposure": exposure,
        "warnings": [*extraction.warnings, *result.report.get("warnings", ()), *cautions],
    }


def profile(seconds: dict[str, float], told: dict[str, Any]) -> dict[str, float]:
    """Return where the time went: shares of the total inside the ray library, in arrays, and in Blender.

    The ray library's seconds are those of all threads, so their mean is what it took of the clock.
    """
    total = max(seconds["total"], 1e-9)
    rays = told.get("seconds_in_ray_library", 0.0) / max(told.get("threads", 1), 1) / total
    blender = (seconds["extract"] + seconds["store"]) / total
    shares = {"ray_library": rays, "arrays": max(0.0, 1.0 - rays - blender), "blender": blender}
    return {name: round(share, 4) for name, share in shares.items()}


def trace(scene: Scene, settings: BakeSettings, progress: ProgressCallback) -> BakeResult:
    """Return the bake of a scene."""
    return _core_bake()(scene, settings, progress)


def _core_bake():
    from ..core.bake import bake

    return bake


def ray_library_problem() -> str | None:
    """Return why no rays can be traced on this computer, or None."""
    from ..core import visibility

    return visibility.ray_library_problem()


def reason_not_to_bake(context: bpy.types.Context) -> str | None:
    """Return a sentence that says why the bake button is grey, or None when it is not."""
    if RADIOSITY_OT_bake.job is not None:
        return "A bake is running; wait for it or press Esc"
    problem = ray_library_problem()
    if problem is not None:
        return problem
    if context.mode != "OBJECT":
        return f"{way_to_object_mode(context)} to bake"
    if context.scene.library is not None:
        return "This scene is linked from another file; make it local to bake"
    meshes = [obj for obj in context.selected_objects if shows_surfaces(source_of(obj))]
    if not meshes:
        return "Select the meshes to bake"
    in_place = context.scene.radiosity.output == "ORIGINAL"
    if in_place and all(source_of(obj).library is not None for obj in meshes):
        return "The selected objects are linked from another file; choose Refined Mesh, or make them local to bake"
    return None


def way_to_object_mode(context: bpy.types.Context) -> str:
    """Return what to do to get into object mode, to begin a sentence with."""
    return "Leave edit mode" if "EDIT" in context.mode else "Switch to object mode"


def counted(number: int, noun: str) -> str:
    """Return "1 object" or "3 objects"."""
    return f"{number:,} {noun}" if number == 1 else f"{number:,} {noun}s"


def stop_running_job() -> None:
    """Ask a running bake to stop, if there is one."""
    if RADIOSITY_OT_bake.job is not None:
        RADIOSITY_OT_bake.job.cancel()


class RADIOSITY_OT_bake(bpy.types.Operator):
    """Bake the selected meshes: blocking from a script, with progress and a way out from the window."""

    bl_idname = "radiosity.bake"
    bl_label = "Bake Radiosity"
    bl_description = (
        "Compute how light spreads between all that renders, and store it in the vertex colours of the selected meshes"
    )
    bl_options = {"REGISTER", "UNDO"}  # noqa: RUF012 - Blender reads it from the class

    job: ClassVar[BakeJob | None] = None
    """The bake that runs in the window; there is at most one, and the panel shows its progress."""

    @classmethod
    def poll(cls, context):
        """Return whether the selection can be baked; the tooltip says why not."""
        reason = reason_not_to_bake(context)
        if reason is not None:
            cls.poll_message_set(reason)
        return reason is None

    def execute(self, context):
        """Bake to the end: the door for scripts."""
        try:
            report = bake_objects(context, context.selected_objects, bake_settings(context.scene.radiosity))
        except (BakeError, Cancelled) as error:
            return self._gave_up(error)
        return self._done(report)

    def invoke(self, context, _event):
        """Start the bake in its thread and watch it: the door for people."""
        began = time.perf_counter()
        try:
            self._settings = bake_settings(context.scene.radiosity)
            self._extraction = extract(context, context.selected_objects, self._settings.output)
            check_storable(self._extraction, attributes_to_be(self._settings, self._extraction.scene))
        except BakeError as error:
            return self._gave_up(error)
        self._read = time.perf_counter() - began
        self._outcome = None
        job = RADIOSITY_OT_bake.job = BakeJob(_core_bake(), self._extraction.scene, self._settings)
        window_manager = context.window_manager
        self._timer = window_manager.event_timer_add(POLL_SECONDS, window=context.window)
        window_manager.progress_begin(0, 100)
        window_manager.modal_handler_add(self)
        job.start()
        self._show(context, job.latest)
        return {"RUNNING_MODAL"}

    def modal(self, context, event):
        """Show how far the bake is; store it when it is done."""
        job = RADIOSITY_OT_bake.job
        if event.type == "ESC" and event.value == "PRESS":
            job.cancel()
        if job.cancelled:
            job.wait(_PATIENCE_SECONDS)
            self._leave(context)
            return self._gave_up(Cancelled())
        if event.type != "TIMER":
            return {"PASS_THROUGH"}
        messages = job.messages()
        if messages and not isinstance(messages[-1], Progress):
            self._outcome = messages[-1]
        if self._outcome is not None and not self._must_wait(context):
            # Blender may keep the operator, and with it what it holds.
            outcome, self._outcome = self._outcome, None
            self._leave(context)
            return self._end(context, outcome)
        if self._outcome is not None:
            # Objects cannot be exchanged, nor the step of undo be made, in the middle of an edit.
            job.latest = Progress(f"{way_to_object_mode(context)} to finish the bake", 1.0)
        if messages:
            self._show(context, job.latest)
        return {"PASS_THROUGH"}

    def cancel(self, context):
        """Stop the bake when Blender ends the operator itself, as it does when another file is opened."""
        stop_running_job()
        self._leave(context)

    def _must_wait(self, context) -> bool:
        return isinstance(self._outcome, Finished) and context.mode != "OBJECT"

    def _end(self, context, message: Finished | Failed):
        try:
            if isinstance(message, Failed):
                raise message.error
            report = finish(self._extraction, message.result, self._settings, self._read)
        except (BakeError, Cancelled) as error:
            return self._gave_up(error)
        show_in_viewport(context, (bpy.data.objects[name] for name in report["objects"]))
        return self._done(report)

    def _done(self, report):
        warnings = len(report["warnings"])
        sentence = f"Baked {counted(len(report['objects']), 'object')} in {report['seconds']['total']:.1f} s"
        if warnings:
            sentence += f", with {counted(warnings, 'warning')}: see the Radiosity panel"
        self.report({"WARNING" if warnings else "INFO"}, sentence)
        return {"FINISHED"}

    def _gave_up(self, error: BakeError | Cancelled):
        if isinstance(error, Cancelled):
            self.report({"INFO"}, "Bake cancelled; nothing was changed")
        else:
            self.report({"ERROR"}, str(error))
        return {"CANCELLED"}

    def _show(self, context, progress: Progress) -> None:
        detail = f" ({progress.detail})" if progress.detail else ""
        context.workspace.status_text_set(f"Radiosity  {progress.share:.0%}  {progress.stage}{detail}  |  Esc: Cancel")
        context.window_manager.progress_update(100.0 * progress.share)
        redraw_panels(context)

    def _leave(self, context) -> None:
        RADIOSITY_OT_bake.job = None
        context.window_manager.event_timer_remove(self._timer)
        context.window_manager.progress_end()
        if context.workspace is not None:
            context.workspace.status_text_set(None)
        redraw_panels(context)


class RADIOSITY_OT_cancel(bpy.types.Operator):
    """Ask the running bake to stop."""

    bl_idname = "radiosity.cancel"
    bl_label = "Cancel Bake"
    bl_description = "Stop the bake that is running; nothing is changed. Esc does the same"
    bl_options = {"INTERNAL"}  # noqa: RUF012 - Blender reads it from the class

    @classmethod
    def poll(cls, _context):
        """Return whether a bake is running."""
        return RADIOSITY_OT_bake.job is not None

    def execute(self, _context):
        """Ask the running bake to stop."""
        stop_running_job()
        return {"FINISHED"}


def redraw_panels(context: bpy.types.Context) -> None:
    """Redraw the sidebars of the 3D viewports; drawing a heavy scene as well would delay Esc."""
    for window in context.window_manager.windows:
        for area in window.screen.areas:
            if area.type == "VIEW_3D":
                for region in area.regions:
                    if region.type == "UI":
                        region.tag_redraw()
