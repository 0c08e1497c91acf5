# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""A range of frames, each baked: rays are traced again only where something moved, else the light alone is new.

The light of all frames ends in one set of attributes a frame (`Radiosity.0001`, `Irradiance.0001`, ...), or each
frame in a file of its own. The scene goes back to the frame where it was.
"""

import json
import time
from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager, suppress
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import bpy
import numpy as np

from ..core.darkness import darkness
from ..core.errors import BakeError, Cancelled, NoLightError
from ..core.kept_rays import KeptRays
from ..core.progress import Progress, ProgressCallback, no_progress
from ..core.relight import ChangedSceneError, KeptTransport, NotKept, relight
from ..core.result import BakedMesh, BakeResult
from ..core.scene import Floats, Scene
from ..core.settings import BakeSettings
from .attributes import attributes_of, attributes_to_be
from .bake import counted, reason_not_to_bake, shown_report, trace
from .doors import TwoDoors, run_to_end
from .extraction import Extraction, extract
from .files import check_spared, check_writable, files_in_use, is_whole_blend, replaced
from .in_place import values_in_place
from .job import Bake
from .journal import Journal
from .record import source_of
from .refined import values_of_corners
from .sets import add_sets, name_of_set
from .settings import bake_settings
from .store import ChangedMeanwhileError, check_storable, check_unchanged, scene_of, store, view_layer_of
from .survey import Survey, UnlikeFramesError
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


_NAMED = 5
"""Frames that a sentence names at most."""


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


@dataclass(frozen=True, eq=False)
class TracedFrame:
    """What the frames that come after a traced one take from it.

    Attributes
    ----------
    kept : KeptTransport or NotKept or None
    rays : KeptRays or None
        What they met.
    meshes : tuple of BakedMesh
    """

    kept: KeptTransport | NotKept | None
    rays: KeptRays | None
    meshes: tuple[BakedMesh, ...]


class FrameRange:
    """The bake of some frames: a task of a step for each.

    `leave`, in any case, goes back to the frame where the scene was.
    """

    purpose = "go on with the frames"

    @property
    def cancelled(self) -> str:
        """The sentence on a bake that was cancelled."""
        return f"Bake of the frames cancelled{files_before(self._written)}"

    def __init__(
        self,
        context: bpy.types.Context,
        objects: Iterable[bpy.types.Object],
        settings: BakeSettings,
        frames: range,
        files: Iterable[Path] | None = None,
    ) -> None:
        """Prepare to bake `objects` at `frames`; `files` are the .blend files that these are written to, if any.

        Raises
        ------
        FrameError
            When there are no frames.
        FileError
            When a file cannot be written, or is one that the scene is read from.
        """
        if not len(frames):
            raise FrameError("The range of frames is empty: its last frame comes before its first")
        # The window may show another scene, or none, by the time of a later frame; pointers do not survive an undo.
        self._scene_uid, self._view_layer = context.scene.session_uid, context.view_layer.name
        self._names = {source_of(obj).session_uid: source_of(obj).name for obj in objects}
        self._settings = settings
        self._frames = frames
        self._files = None if files is None else dict(zip(frames, files, strict=True))
        # Refined meshes in one file are those of one tracing.
        self._one_tracing = files is None and settings.output == "REFINED"
        self._survey = Survey()
        self._first_look: Extraction | None = None
        self._to_look_at = list(frames) if self._one_tracing and len(frames) > 1 else []
        self._to_light = list(frames)
        self._dark: list[int] = []
        self._traced: TracedFrame | None = None
        self._traced_anew = False
        self._read: tuple[Extraction, float] | None = None
        self._told: dict[int, dict[str, Any]] = {}
        self._written = 0
        self._sets: dict[int, Sets] = {}
        self._shown: LitFrame | None = None
        scene = context.scene
        self._before = scene.frame_current, scene.frame_subframe
        self._shown_frame = self._before[0] if self._before[0] in frames else frames[0]
        for path in (self._files or {}).values():
            check_writable(path, "The frame")
            check_spared(path, "The frame", files_in_use())

    @property
    def done(self) -> bool:
        """Whether all frames were taken."""
        return not self._to_light

    def begin(self) -> tuple[Scene, BakeSettings, Bake]:
        """Go to the next frame, and return what lights it, or what looks at it alone.

        Raises
        ------
        BakeError
            As the extraction raises it, or where the frames cannot share one tracing that they must share.
        """
        began = time.perf_counter()
        frame = (self._to_look_at or self._to_light)[0]
        with named(frame, self._written):
            extraction = self._extracted(frame)
        self._read = extraction, time.perf_counter() - began
        settings = replace(self._settings, keep_transport=True)
        if self._to_look_at:
            return extraction.scene, settings, _looking(frame)
        share = len(self._told) / len(self._frames), 1.0 / len(self._frames)
        return extraction.scene, settings, self._light(frame, share)

    def _extracted(self, frame: int) -> Extraction:
        scene = scene_of(self._scene_uid)
        view_layer = view_layer_of(scene, self._view_layer)
        scene.frame_set(frame)
        objects = self._objects()
        with bpy.context.temp_override(scene=scene, view_layer=view_layer):
            extraction = extract(bpy.context, objects, self._settings.output)
        ending = max((name_of_set("", frame) for frame in self._frames), key=len) if self._files is None else ""
        check_storable(extraction, attributes_to_be(self._settings, extraction.scene), ending)
        return extraction

    def _objects(self) -> list[bpy.types.Object]:
        by_uid = {obj.session_uid: obj for obj in bpy.data.objects}
        for uid, name in self._names.items():
            if uid not in by_uid:
                raise ChangedMeanwhileError(f'"{name}" was deleted during the bake; nothing more was stored')
        return [by_uid[uid] for uid in self._names]

    def take(self, result: BakeResult) -> None:
        """Keep the light of the frame that was begun.

        Raises
        ------
        BakeError
            When it cannot be kept.
        """
        extraction, read = self._read
        if self._to_look_at:
            frame = self._to_look_at.pop(0)
            self._first_look = self._first_look or extraction
            with named(frame):
                try:
                    self._survey.look(frame, extraction.scene)
                except UnlikeFramesError:
                    # A mesh that was edited meanwhile did not move from frame to frame.
                    check_unchanged(self._first_look)
                    raise
            if not self._to_look_at:
                self._to_light = self._survey.order()
            return
        frame = self._to_light.pop(0)
        dark = result.report.get("dark", False)
        traced = not dark and not result.report.get("relit", False)
        if dark and not any(not told["dark"] for told in self._told.values()):
            self._put_aside(frame, result.report["ended"])
            return
        if traced:
            self._traced_anew |= self._keeps_rays() and result.kept_rays is None
            self._traced = TracedFrame(result.kept, result.kept_rays, result.meshes)
            result = replace(result, kept_rays=None)
            # What is dark was left until there is light: a range of nothing else is a mistake.
            self._to_light, self._dark = [*self._dark, *self._to_light], []
        lit = LitFrame(frame, extraction, result, read)
        self._told[frame] = {
            "frame": frame,
            "traced": traced,
            "dark": dark,
            "rays": result.report.get("rays", 0),
            "rays_known": result.report.get("rays_known", 0),
            "seconds": round(read + result.report.get("seconds", {}).get("total", 0.0), 4),
        }
        if self._files is None:
            self._keep_colours(lit)
        else:
            self._write(lit)
        if frame == self._shown_frame:
            self._shown = lit

    def _light(self, frame: int, share: tuple[float, float]) -> Bake:
        """Return what lights a frame: relit if only colours changed since the one that was traced, else traced.

        Of the rays, those are traced that may meet something else than they did then.

        Parameters
        ----------
        frame : int
        share : (float, float)
            How much of the range is done before, and how much this is of it.
        """
        before, one_tracing, written = self._traced, self._one_tracing, self._written
        rays = before.rays if before is not None else None
        keep_rays = self._keeps_rays()

        def light(scene: Scene, settings: BakeSettings, progress: ProgressCallback) -> BakeResult:
            def told(message: Progress) -> None:
                done, part = share
                progress(Progress(f"Frame {frame}: {message.stage}", done + part * message.share, message.detail))

            with named(frame, written):
                if before is not None and isinstance(before.kept, KeptTransport):
                    try:
                        return replace(relight(before.kept, scene, told), kept=before.kept)
                    except ChangedSceneError:
                        pass
                    except NoLightError as why:
                        return replace(darkness(scene, settings, why, before.meshes), kept=before.kept)
                if before is not None and one_tracing:
                    raise FrameError(_why_not_relit(before.kept))
                try:
                    return trace(scene, settings, told, before=rays, keep_rays=keep_rays)
                except NoLightError as why:
                    return darkness(scene, settings, why)

        return light

    def _keeps_rays(self) -> bool:
        """Whether frames may be traced after one another; those of a shorter range are the same as of a longer one."""
        return not self._one_tracing

    def _put_aside(self, frame: int, why: str) -> None:
        self._dark.append(frame)
        if not self._to_light:
            first, last = self._frames[0], self._frames[-1]
            which = f"Frame {first}" if first == last else f"Frames {first} to {last}"
            raise FrameError(f"{which}: {why}")

    def _keep_colours(self, lit: LitFrame) -> None:
        """Keep the colours alone: whole results of many frames would take gigabytes."""
        with named(lit.frame, self._written):
            check_unchanged(lit.extraction)
        by_uid = {obj.session_uid: obj for obj in bpy.data.objects}
        # Of bytes the exposure is known when all frames are lit.
        attributes = attributes_to_be(replace(self._settings, data_type="FLOAT"), lit.extraction.scene)
        for target, baked in baked_targets(lit.extraction.scene, lit.extraction.targets, lit.result, self._settings):
            if self._settings.output == "REFINED":
                values = values_of_corners(target, baked, attributes)
            else:
                values = values_in_place(by_uid[target.uid].data, target, baked, attributes)
            sets = self._sets.setdefault(target.uid, {})
            sets[lit.frame] = _single(values)
            if len({len(part) for values_of_frame in sets.values() for part in values_of_frame.values()}) > 1:
                raise FrameError(
                    f'Frame {lit.frame}: the mesh of "{target.name}" has other faces than in the frame before; '
                    "nothing was stored"
                )

    def _write(self, lit: LitFrame) -> None:
        path = self._files[lit.frame]
        with named(lit.frame, self._written):
            self._store(lit)
            with replaced(path) as temporary:
                try:
                    bpy.ops.wm.save_as_mainfile(filepath=str(temporary), copy=True, check_existing=False)
                except RuntimeError as error:
                    raise FrameError(f"{path} could not be written: {error}") from error
                if not is_whole_blend(temporary):
                    raise FrameError(f"{path} could not be written to its end; look whether the disk is full")
        self._written += 1

    def finish(self) -> dict[str, Any]:
        """Store what was taken, and return the report: that of the frame which is shown, and a line for each."""
        lit = self._shown
        scene_of(self._scene_uid).frame_set(lit.frame)
        self._sets = {uid: with_missing(sets) for uid, sets in self._sets.items()}
        # With one file a frame, the last of them is what the scene shows until here.
        return self._store(lit)

    def _store(self, lit: LitFrame) -> dict[str, Any]:
        began = time.perf_counter()
        scene = scene_of(lit.extraction.scene_uid)

        others = [
            values for sets in self._sets.values() for frame, values in sets.items() if frame != self._shown_frame
        ]
        # Bytes of another exposure for each frame could not be compared.
        attributes, exposure = attributes_of(self._settings, lit.extraction, lit.result, others)

        def beside(obj: bpy.types.Object, uid: int, journal: Journal) -> None:
            sets = {frame: attributes.as_stored(values) for frame, values in self._sets.get(uid, {}).items()}
            add_sets(obj, sets, attributes, journal)

        objects, cautions = store(scene, lit.extraction, lit.result, attributes, beside)
        kept = lit.result.kept if self._settings.keep_transport else None
        remember(scene, lit.extraction, self._settings, replace(lit.result, kept=kept), objects)
        stored = time.perf_counter() - began
        report = shown_report(lit.extraction, lit.result, objects, cautions, exposure, lit.read, stored)
        report["warnings"] += self._warnings()
        report["frames"] = [self._told[frame] for frame in sorted(self._told)]
        scene.radiosity.report = json.dumps(report)
        return report

    def _warnings(self) -> list[str]:
        dark = [str(frame) for frame in sorted(self._told) if self._told[frame]["dark"]]
        others = [f"{len(dark) - _NAMED:,} more"] if len(dark) > _NAMED else []
        warnings = []
        if dark:
            warnings.append(f"Nothing emits light at {_and('frame', [*dark[:_NAMED], *others])}; it is black there")
        if self._traced_anew and sum(told["traced"] for told in self._told.values()) > 1:
            warnings.append(
                "What the rays of a frame met was too much for the memory limit, so that all were traced anew at "
                "each frame; raise it"
            )
        if self._files is not None and self._settings.data_type == "BYTE" and self._settings.byte_maximum == 0.0:
            warnings.append("The bytes of each frame have an exposure of their own; set Byte Maximum to compare them")
        return warnings

    def leave(self) -> None:
        """Go back to the frame where the scene was, unless it was deleted."""
        frame, part = self._before
        with suppress(ChangedMeanwhileError):
            scene_of(self._scene_uid).frame_set(frame, subframe=part)

    def summary(self, report: dict[str, Any]) -> str:
        """Return one sentence about the frames."""
        return summary_of(report)


@contextmanager
def named(frame: int, written: int = 0) -> Iterator[None]:
    """Have a named error say at which frame it happened, and of how many frames before files were written."""
    try:
        yield
    except BakeError as error:
        raise FrameError(f"Frame {frame}: {error}{files_before(written)}") from error


def files_before(count: int) -> str:
    """Return what to add to a sentence on the end of a range, of which so many files were written."""
    return f"; {counted(count, 'file')} of frames before {'was' if count == 1 else 'were'} written" if count else ""


def _and(noun: str, names: list[str]) -> str:
    """Return "frame 1" or "frames 1, 2 and 3"."""
    if len(names) == 1:
        return f"{noun} {names[0]}"
    return f"{noun}s {', '.join(names[:-1])} and {names[-1]}"


def bake_frames(
    context: bpy.types.Context,
    objects: Iterable[bpy.types.Object],
    settings: BakeSettings,
    frames: range,
    files: Iterable[Path] | None = None,
    progress: ProgressCallback = no_progress,
) -> dict[str, Any]:
    """Bake `objects` at each of `frames` from beginning to end, and return the report.

    Parameters
    ----------
    files : iterable of Path, optional
        The .blend file of each frame; None keeps all frames in the open file.

    Raises
    ------
    BakeError
        With a sentence for the user. Without `files` nothing was changed; with them, the frames before were written.
    Cancelled
        When `progress` raised it, or by Ctrl+C, likewise.
    """
    task = FrameRange(context, objects, settings, frames, files)
    try:
        return run_to_end(task, progress)
    except KeyboardInterrupt:
        raise Cancelled(task.cancelled) from None


def _looking(frame: int) -> Bake:
    """Return what tells that a frame is looked at, and lights nothing."""

    def look(_scene: Scene, _settings: BakeSettings, progress: ProgressCallback) -> BakeResult:
        progress(Progress(f"Frame {frame}: Looking for what moves", 0.0))
        return BakeResult((), {})

    return look


def _why_not_relit(kept: KeptTransport | NotKept | None) -> str:
    if isinstance(kept, NotKept):
        return kept.why
    return (
        "its light cannot be told from what was traced for the other frames; "
        "choose Original Mesh as the output, or a file for each frame"
    )


def files_of(path: Path, frames: range) -> list[Path]:
    """Return the file of each frame: `room_0012.blend` for `room.blend`."""
    return [path.with_name(f"{path.stem}_{frame:04d}{path.suffix}") for frame in frames]


def with_missing(sets: Sets) -> Sets:
    """Return the sets with black for what a frame has not and others have: light groups and backs that were dark."""
    shapes = {name: part for values in sets.values() for name, part in values.items()}
    return {
        frame: {name: values.get(name, np.zeros_like(part)) for name, part in shapes.items()}
        for frame, values in sorted(sets.items())
    }


def _single(values: Mapping[str, Floats | None]) -> dict[str, np.ndarray]:
    return {name: part.astype(np.float32) for name, part in values.items() if part is not None}


def open_file() -> Path:
    """Return the .blend that is open, beside which frames are written.

    Raises
    ------
    FrameError
        When it was never saved.
    """
    if not bpy.data.filepath:
        raise FrameError("Save the file first: the files of the frames are written beside it")
    return Path(bpy.data.filepath)


class RADIOSITY_OT_bake_frames(TwoDoors, bpy.types.Operator):
    """Bake the scene's range of frames."""

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

    def task(self, context):
        """Return the bake of what is selected at every frame."""
        scene = context.scene
        frames = range(scene.frame_start, scene.frame_end + 1, scene.frame_step)
        files = files_of(open_file(), frames) if self.frame_output == "FILES" else None
        return FrameRange(context, context.selected_objects, bake_settings(scene.radiosity), frames, files)


def summary_of(report: dict[str, Any]) -> str:
    """Return one sentence about a range of frames."""
    frames = report["frames"]
    traced = sum(frame["traced"] for frame in frames)
    seconds = sum(frame["seconds"] for frame in frames)
    return f"Baked {counted(len(frames), 'frame')} in {seconds:.1f} s, {traced:,} of them traced"
