# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The bake of the selected objects: the use case, and its operator."""

import json
import time
from collections.abc import Iterable
from functools import partial
from typing import Any

import bpy

from ..core.errors import NoLightError
from ..core.progress import ProgressCallback, no_progress
from ..core.result import BakeResult
from ..core.scene import Scene
from ..core.settings import BakeSettings
from .attributes import attributes_of, attributes_to_be
from .doors import TwoDoors, Watch, run_to_end, way_to_object_mode
from .extraction import Extraction, extract
from .job import Bake
from .naming import joined, named
from .participants import lamps_out_of_renders
from .record import source_of
from .sets import without_sets
from .settings import bake_settings
from .store import check_storable, scene_of, store
from .targets import shows_surfaces
from .transports import remember


class SingleBake:
    """The bake of some objects as they are now: a task of one step."""

    purpose = "finish the bake"
    cancelled = "Bake cancelled; nothing was changed"

    def __init__(self, context: bpy.types.Context, objects: Iterable[bpy.types.Object], settings: BakeSettings) -> None:
        """Prepare to bake `objects`."""
        self._context = context
        self._objects = list(objects)
        self._settings = settings
        self._extraction: Extraction | None = None
        self._read = 0.0
        self._result: BakeResult | None = None

    @property
    def done(self) -> bool:
        """Whether the light was taken."""
        return self._result is not None

    def begin(self) -> tuple[Scene, BakeSettings, Bake]:
        """Read the scene, and return what lights it.

        Raises
        ------
        BakeError
            As the extraction raises it.
        """
        began = time.perf_counter()
        self._extraction = extract(self._context, self._objects, self._settings.output)
        # Pointers do not survive an undo.
        self._objects.clear()
        check_storable(self._extraction, attributes_to_be(self._settings, self._extraction.scene))
        self._read = time.perf_counter() - began
        return self._extraction.scene, self._settings, partial(_trace, unlit=lamps_out_of_renders(self._context))

    def take(self, result: BakeResult) -> None:
        """Keep the light."""
        self._result = result

    def finish(self) -> dict[str, Any]:
        """Store the light, and return the report."""
        return finish(self._extraction, self._result, self._settings, self._read)

    def leave(self) -> None:
        """Nothing was changed that is to be put back."""

    def summary(self, report: dict[str, Any]) -> str:
        """Return one sentence about the bake."""
        sentence = f"Baked {counted(len(report['objects']), 'object')} in {report['seconds']['total']:.1f} s"
        warnings = len(report["warnings"])
        return f"{sentence}, with {counted(warnings, 'warning')}: see the Radiosity panel" if warnings else sentence


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
    return run_to_end(SingleBake(context, objects, settings), progress)


def finish(extraction: Extraction, result: BakeResult, settings: BakeSettings, read: float) -> dict[str, Any]:
    """Store `result`, then write and return the report; `read` is the seconds that the extraction took."""
    began = time.perf_counter()
    scene = scene_of(extraction.scene_uid)
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
    names = {part.name for part in (*extraction.scene.meshes, *extraction.scene.lamps)}
    return {
        **result.report,
        "seconds": {stage: round(value, 4) for stage, value in seconds.items()},
        "profile": profile(seconds, result.report),
        "objects": [obj.name for obj in objects],
        "evaluated_by_blender": list(extraction.evaluated),
        "exposure": exposure,
        "warnings": [*extraction.warnings, *joined(result.report.get("warnings", ()), names), *cautions],
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


def _trace(scene: Scene, settings: BakeSettings, progress: ProgressCallback, *, unlit: list[str]) -> BakeResult:
    """Return the bake of a scene; where nothing emits light, lamps that do not render are named."""
    try:
        return trace(scene, settings, progress)
    except NoLightError as error:
        if not unlit:
            raise
        raise NoLightError(f"{error}. {named(unlit)} {'is' if len(unlit) == 1 else 'are'} hidden in renders") from error


def trace(scene: Scene, settings: BakeSettings, progress: ProgressCallback, **options: Any) -> BakeResult:
    """Return the bake of a scene, with options that the core's has beside the settings."""
    return _core_bake()(scene, settings, progress, **options)


def _core_bake():
    from ..core.bake import bake

    return bake


def ray_library_problem() -> str | None:
    """Return why no rays can be traced on this computer, or None."""
    from ..core import ray_library

    return ray_library.ray_library_problem()


def reason_not_to_bake(context: bpy.types.Context) -> str | None:
    """Return a sentence that says why the bake button is grey, or None when it is not."""
    if Watch.running is not None:
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


def counted(number: int, noun: str) -> str:
    """Return "1 object" or "3 objects"."""
    return f"{number:,} {noun}" if number == 1 else f"{number:,} {noun}s"


class RADIOSITY_OT_bake(TwoDoors, bpy.types.Operator):
    """Bake the selected meshes."""

    bl_idname = "radiosity.bake"
    bl_label = "Bake Radiosity"
    bl_description = (
        "Compute how light spreads between all that renders, and store it in the vertex colours of the selected meshes"
    )
    bl_options = {"REGISTER", "UNDO"}  # noqa: RUF012 - Blender reads it from the class

    @classmethod
    def poll(cls, context):
        """Return whether the selection can be baked; the tooltip says why not."""
        reason = reason_not_to_bake(context)
        if reason is not None:
            cls.poll_message_set(reason)
        return reason is None

    def task(self, context):
        """Return the bake of what is selected."""
        return SingleBake(context, context.selected_objects, bake_settings(context.scene.radiosity))
