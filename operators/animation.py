# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""A range of frames, each baked: transport is traced again only when something moved, else the light alone is new.

The light of all frames ends in one set of attributes a frame (`Radiosity.0001`, `Irradiance.0001`, ...), or each
frame in a file of its own. The scene goes back to the frame where it was.
"""

import json
import time
from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import bpy
import numpy as np

from ..core.errors import BakeError, Cancelled
from ..core.progress import Progress, ProgressCallback, no_progress
from ..core.relight import ChangedSceneError, KeptTransport, NotKept, relight
from ..core.result import BakeResult
from ..core.scene import Floats, Scene
from ..core.settings import BakeSettings
from .attributes import Attributes, attributes_of, attributes_to_be
from .bake import (
    POLL_SECONDS,
    RADIOSITY_OT_bake,
    counted,
    reason_not_to_bake,
    redraw_panels,
    shown_report,
    trace,
    way_to_object_mode,
)
from .extraction import Extraction, extract
from .files import check_writable, is_whole_blend, replaced
from .in_place import values_in_place
from .job import Bake, BakeJob, Failed
from .journal import Journal
from .record import source_of
from .refined import values_of_corners
from .sets import add_sets
from .settings import bake_settings
from .store import check_storable, scene_of, store
from .targets import baked_targets
from .transports import remember

Sets = dict[int, dict[str, np.ndarray]]
"""Colours (c, 3) float32 of one object's face corners by frame and attribute."""

FRAME_OUTPUTS = ("ATTRIBUTES", "FILES")
FRAME_OUTPUT_ITEMS = (
    (
        "ATTRIBUTES",
        "Attributes",
        "Keep all frames in this file: colour attributes Radiosity.0001, Radiosity.0002 and so on, beside those "
        "that are shown",
    ),
    ("FILES", "Files", "Write a copy of this file for each frame, with that frame's light, beside it"),
)


class FrameError(BakeError):
    """A frame of the range cannot be baked, or the range cannot be kept."""


@dataclass(frozen=True, eq=False)
class LitFrame:
    """One frame with its light.

    Attributes
    ----------
    frame : int
    extraction : Extraction
    result : BakeResult
        Its `kept` is the transport that lit it, which an earlier frame may have traced.
    read : float
        Seconds that the extraction took.
    """

    frame: int
    extraction: Extraction
    result: BakeResult
    read: float


class FrameRange:
    """The bake of some frames, one step at a time: `begin`, then the light in whatever thread, then `take`.

    `finish` stores what was taken. `leave`, in any case, goes back to the frame where the scene was.
    """

    def __init__(
        self,
        context: bpy.types.Context,
        objects: Iterable[bpy.types.Object],
        settings: BakeSettings,
        frames: range,
        files: Path | None = None,
    ) -> None:
        """Prepare to bake `objects` at `frames`; `files` is the .blend whose name those of the frames are made of.

        Raises
        ------
        FrameError
            When there are no frames.
        FileError
            When a file cannot be written.
        """
        if not len(frames):
            raise FrameError("The range of frames is empty: its last frame comes before its first")
        self._context = context
        self._uids = [source_of(obj).session_uid for obj in objects]
        self._settings = settings
        self._frames = frames
        self._files = files
        self._next = 0
        self._kept: KeptTransport | NotKept | None = None
        self._frame: tuple[Extraction, float] | None = None
        self._told: list[dict[str, Any]] = []
        self._sets: dict[int, Sets] = {}
        self._shown: LitFrame | None = None
        scene = context.scene
        self._before = scene.frame_current, scene.frame_subframe
        self._shown_frame = self._before[0] if self._before[0] in frames else frames[0]
        for frame in frames if files is not None else ():
            check_writable(file_of(files, frame), "The frame")

    @property
    def done(self) -> bool:
        """Whether all frames were taken."""
        return self._next == len(self._frames)

    def begin(self) -> tuple[Scene, BakeSettings, Bake]:
        """Go to the next frame, and return what lights it.

        Raises
        ------
        BakeError
            As the extraction raises it.
        """
        began = time.perf_counter()
        frame = self._frames[self._next]
        self._context.scene.frame_set(frame)
        by_uid = {obj.session_uid: obj for obj in bpy.data.objects}
        objects = [by_uid[uid] for uid in self._uids if uid in by_uid]
        with named(frame):
            extraction = extract(self._context, objects, self._settings.output)
            check_storable(extraction, attributes_to_be(self._settings, extraction.scene))
        self._frame = extraction, time.perf_counter() - began
        settings = replace(self._settings, keep_transport=True)
        return extraction.scene, settings, _light(self._kept, frame, self._next, len(self._frames))

    def take(self, result: BakeResult) -> None:
        """Keep the light of the frame that was begun.

        Raises
        ------
        BakeError
            When it cannot be kept.
        """
        frame = self._frames[self._next]
        extraction, read = self._frame
        traced = not result.report.get("relit", False)
        if traced and self._next and self._files is None and self._settings.output == "REFINED":
            raise FrameError(
                f"Frame {frame}: something moved since the frame before, so that the refined meshes of the two differ; "
                "choose Original Mesh as the output, or a file for each frame"
            )
        self._kept = result.kept
        lit = LitFrame(frame, extraction, result, read)
        self._told.append(
            {
                "frame": frame,
                "traced": traced,
                "rays": result.report.get("rays", 0),
                "seconds": round(read + result.report.get("seconds", {}).get("total", 0.0), 4),
            }
        )
        if self._files is None:
            self._keep_colours(lit)
        else:
            self._write(lit)
        if frame == self._shown_frame:
            self._shown = lit
        self._next += 1

    def _keep_colours(self, lit: LitFrame) -> None:
        """Keep the colours alone: whole results of many frames would take gigabytes."""
        by_uid = {obj.session_uid: obj for obj in bpy.data.objects}
        attributes = self._attributes_of_sets(lit)
        for target, baked in baked_targets(lit.extraction.scene, lit.extraction.targets, lit.result, self._settings):
            if self._settings.output == "REFINED":
                values = values_of_corners(target, baked, attributes)
            else:
                values = values_in_place(by_uid[target.uid].data, target, baked, attributes)
            self._sets.setdefault(target.uid, {})[lit.frame] = _single(values)

    def _attributes_of_sets(self, lit: LitFrame) -> Attributes:
        # Bytes of another exposure for each frame could not be compared.
        return attributes_to_be(replace(self._settings, data_type="FLOAT"), lit.extraction.scene)

    def _write(self, lit: LitFrame) -> None:
        self._store(lit)
        path = file_of(self._files, lit.frame)
        with replaced(path) as temporary:
            try:
                bpy.ops.wm.save_as_mainfile(filepath=str(temporary), copy=True, check_existing=False)
            except RuntimeError as error:
                raise FrameError(f"{path} could not be written: {error}") from error
            if not is_whole_blend(temporary):
                raise FrameError(f"{path} could not be written to its end; look whether the disk is full")

    def finish(self) -> dict[str, Any]:
        """Store what was taken, and return the report: that of the frame which is shown, and a line for each."""
        lit = self._shown
        self._context.scene.frame_set(lit.frame)
        # With one file a frame, the last of them is what the scene shows until here.
        return self._store(lit)

    def _store(self, lit: LitFrame) -> dict[str, Any]:
        began = time.perf_counter()
        scene = scene_of(lit.extraction)

        def beside(obj: bpy.types.Object, uid: int, journal: Journal) -> None:
            add_sets(obj, self._sets.get(uid, {}), self._attributes_of_sets(lit), journal)

        attributes, exposure = attributes_of(self._settings, lit.extraction, lit.result)
        objects, cautions = store(scene, lit.extraction, lit.result, attributes, beside)
        kept = lit.result.kept if self._settings.keep_transport else None
        remember(scene, lit.extraction, self._settings, replace(lit.result, kept=kept), objects)
        stored = time.perf_counter() - began
        report = shown_report(lit.extraction, lit.result, objects, cautions, exposure, lit.read, stored)
        report["frames"] = self._told
        scene.radiosity.report = json.dumps(report)
        return report

    def leave(self) -> None:
        """Go back to the frame where the scene was."""
        frame, part = self._before
        self._context.scene.frame_set(frame, subframe=part)


@contextmanager
def named(frame: int) -> Iterator[None]:
    """Have a named error say at which frame it happened."""
    try:
        yield
    except BakeError as error:
        raise FrameError(f"Frame {frame}: {error}") from error


def bake_frames(
    context: bpy.types.Context,
    objects: Iterable[bpy.types.Object],
    settings: BakeSettings,
    frames: range,
    files: Path | None = None,
    progress: ProgressCallback = no_progress,
) -> dict[str, Any]:
    """Bake `objects` at each of `frames` from beginning to end, and return the report.

    Parameters
    ----------
    files : Path or None
        The .blend whose name those of the frames are made of; None keeps all frames in the open file.

    Raises
    ------
    BakeError
        With a sentence for the user. Without `files` nothing was changed; with them, the frames before were written.
    Cancelled
        When `progress` raised it, likewise.
    """
    frame_range = FrameRange(context, objects, settings, frames, files)
    try:
        while not frame_range.done:
            scene, of_frame, light = frame_range.begin()
            frame_range.take(light(scene, of_frame, progress))
        return frame_range.finish()
    finally:
        frame_range.leave()


def _light(kept: KeptTransport | NotKept | None, frame: int, number: int, count: int) -> Bake:
    """Return what lights a frame, the `number`-th of `count`: relit if only colours changed, else traced."""

    def light(scene: Scene, settings: BakeSettings, progress: ProgressCallback) -> BakeResult:
        def told(message: Progress) -> None:
            share = (number + message.share) / count
            progress(Progress(f"Frame {frame}: {message.stage}", share, message.detail))

        with named(frame):
            if isinstance(kept, KeptTransport):
                try:
                    return replace(relight(kept, scene, told), kept=kept)
                except ChangedSceneError:
                    pass
            return trace(scene, settings, told)

    return light


def file_of(path: Path, frame: int) -> Path:
    """Return the file of a frame: `room_0012.blend` for `room.blend`."""
    return path.with_name(f"{path.stem}_{frame:04d}{path.suffix}")


def _single(values: Mapping[str, Floats | None]) -> dict[str, np.ndarray]:
    return {name: part.astype(np.float32) for name, part in values.items() if part is not None}


def files_of_open_file() -> Path:
    """Return the .blend that is open, beside which frames are written.

    Raises
    ------
    FrameError
        When it was never saved.
    """
    if not bpy.data.filepath:
        raise FrameError("Save the file first: the files of the frames are written beside it")
    return Path(bpy.data.filepath)


class RADIOSITY_OT_bake_frames(bpy.types.Operator):
    """Bake the scene's range of frames: blocking from a script, frame by frame with a way out from the window."""

    bl_idname = "radiosity.bake_frames"
    bl_label = "Bake Frames"
    bl_description = (
        "Bake the selected meshes at every frame of the scene's range. Where only lamps and colours change from "
        "frame to frame, the light alone is computed again, in a small share of the time"
    )
    bl_options = {"REGISTER", "UNDO"}  # noqa: RUF012 - Blender reads it from the class

    frame_output: bpy.props.EnumProperty(
        name="Frames To",
        description="Where the light of each frame is kept",
        items=FRAME_OUTPUT_ITEMS,
        default="ATTRIBUTES",
    )

    @classmethod
    def poll(cls, context):
        """Return whether the selection can be baked; the tooltip says why not."""
        reason = reason_not_to_bake(context)
        if reason is not None:
            cls.poll_message_set(reason)
        return reason is None

    def execute(self, context):
        """Bake all frames to the end: the door for scripts."""
        try:
            frame_range = self._frame_range(context)
            try:
                while not frame_range.done:
                    scene, settings, light = frame_range.begin()
                    frame_range.take(light(scene, settings, no_progress))
                report = frame_range.finish()
            finally:
                frame_range.leave()
        except (BakeError, Cancelled) as error:
            return self._gave_up(error)
        return self._done(report)

    def invoke(self, context, _event):
        """Begin the first frame in a thread, and watch it: the door for people."""
        self._timer = None
        try:
            self._range = self._frame_range(context)
        except BakeError as error:
            return self._gave_up(error)
        try:
            self._begin()
        except BakeError as error:
            self._range.leave()
            return self._gave_up(error)
        context.window_manager.progress_begin(0, 100)
        self._timer = context.window_manager.event_timer_add(POLL_SECONDS, window=context.window)
        context.window_manager.modal_handler_add(self)
        return {"RUNNING_MODAL"}

    def modal(self, context, event):
        """Take each frame when it is done and begin the next."""
        job = RADIOSITY_OT_bake.job
        if event.type == "ESC" and event.value == "PRESS":
            job.cancel()
        if job.cancelled:
            self._leave(context)
            return self._gave_up(Cancelled())
        if event.type != "TIMER":
            return {"PASS_THROUGH"}
        self._messages += job.messages()
        if not self._messages:
            return {"PASS_THROUGH"}
        last = self._messages[-1]
        if isinstance(last, Progress):
            self._messages.clear()
        elif context.mode != "OBJECT":
            # Neither can another frame be read in the middle of an edit, nor the light be stored.
            job.latest = Progress(f"{way_to_object_mode(context)} to go on with the frames", job.latest.share)
        else:
            self._messages.clear()
            return self._go_on(context, last)
        self._show(context, job.latest)
        return {"PASS_THROUGH"}

    def cancel(self, context):
        """Stop when Blender ends the operator itself, as it does when another file is opened."""
        RADIOSITY_OT_bake.job.cancel()
        self._leave(context)

    def _frame_range(self, context) -> FrameRange:
        scene = context.scene
        files = files_of_open_file() if self.frame_output == "FILES" else None
        frames = range(scene.frame_start, scene.frame_end + 1, scene.frame_step)
        return FrameRange(context, context.selected_objects, bake_settings(scene.radiosity), frames, files)

    def _begin(self) -> None:
        scene, settings, light = self._range.begin()
        self._messages = []
        RADIOSITY_OT_bake.job = BakeJob(light, scene, settings)
        RADIOSITY_OT_bake.job.start()

    def _go_on(self, context, message):
        try:
            if isinstance(message, Failed):
                raise message.error
            self._range.take(message.result)
            if not self._range.done:
                self._begin()
                return {"PASS_THROUGH"}
            report = self._range.finish()
        except (BakeError, Cancelled) as error:
            self._leave(context)
            return self._gave_up(error)
        except BaseException:
            self._leave(context)
            raise
        self._leave(context)
        return self._done(report)

    def _done(self, report):
        self.report({"WARNING" if report["warnings"] else "INFO"}, summary_of(report))
        return {"FINISHED"}

    def _gave_up(self, error: BakeError | Cancelled):
        if isinstance(error, Cancelled):
            self.report({"INFO"}, "Bake of the frames cancelled")
        else:
            self.report({"ERROR"}, str(error))
        return {"CANCELLED"}

    def _show(self, context, progress: Progress) -> None:
        context.workspace.status_text_set(f"Radiosity  {progress.share:.0%}  {progress.stage}  |  Esc: Cancel")
        context.window_manager.progress_update(100.0 * progress.share)
        redraw_panels(context)

    def _leave(self, context) -> None:
        RADIOSITY_OT_bake.job = None
        self._range.leave()
        if self._timer is not None:
            context.window_manager.event_timer_remove(self._timer)
            context.window_manager.progress_end()
            context.workspace.status_text_set(None)
        redraw_panels(context)


def summary_of(report: dict[str, Any]) -> str:
    """Return one sentence about a range of frames."""
    frames = report["frames"]
    traced = sum(frame["traced"] for frame in frames)
    seconds = sum(frame["seconds"] for frame in frames)
    return f"Baked {counted(len(frames), 'frame')} in {seconds:.1f} s, {traced:,} of them traced"
