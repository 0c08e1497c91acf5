# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Relighting: the objects of the last bake with the colours that their materials have now, in place."""

import json
import time
from dataclasses import replace
from typing import Any

import bpy

from ..core.errors import BakeError
from ..core.progress import ProgressCallback, no_progress
from ..core.relight import KeptTransport, NotKept, relight
from ..core.result import BakedMesh, BakeResult
from ..core.settings import BakeSettings
from . import display
from .attributes import Attributes, attributes_of
from .bake import counted, shown_report
from .colours import rewrite_colours
from .doors import Watch, way_to_object_mode
from .extraction import Extraction, extract
from .journal import Journal
from .local_mesh import fingerprint
from .places import outputs_by_source
from .record import BAKED_IN_PLACE
from .refined import original_materials, values_of_corners
from .settings import bake_settings
from .store import store
from .targets import Target, baked_targets
from .textured import Displays
from .transports import RememberedBake, remembered_bake


class NotRelightableError(BakeError):
    """What is in memory does not fit the scene."""


def relight_scene(context: bpy.types.Context, progress: ProgressCallback = no_progress) -> dict[str, Any]:
    """Light the last bake of the scene again, and return the report.

    Raises
    ------
    BakeError
        With a sentence for the user; nothing was changed.
    """
    began = time.perf_counter()
    scene = context.scene
    bake = remembered_bake(scene)
    reason = reason_of_memory(context) if bake is None else _reason_of_transport(bake)
    if bake is None or not isinstance(bake.transport, KeptTransport):
        raise NotRelightableError(reason)
    if _without_effect(bake_settings(scene.radiosity)) != _without_effect(bake.settings):
        raise NotRelightableError("The settings were changed since the bake; bake again, or set them back to relight")
    extraction = extract(context, _originals(bake), bake.settings.output)
    uids = [target.uid for target in extraction.targets]
    if uids != [obj.uid for obj in bake.objects]:
        raise NotRelightableError("Objects were added, removed or hidden since the bake; bake again")
    read = time.perf_counter() - began
    result = relight(bake.transport, extraction.scene, progress)
    began = time.perf_counter()
    attributes, exposure = attributes_of(bake.settings, extraction, result)
    if bake.settings.output == "ORIGINAL":
        objects, cautions = store(scene, extraction, result, attributes)
    else:
        objects, cautions = _store_in_refined(bake, extraction, result, attributes)
    report = shown_report(extraction, result, objects, cautions, exposure, read, time.perf_counter() - began)
    scene.radiosity.report = json.dumps(report)
    return report


def _without_effect(settings: BakeSettings) -> BakeSettings:
    """The settings without those that a relight need not share with its bake.

    These are how it is computed and in which memory, and the report of the bake says what that left out.
    """
    default = BakeSettings()
    return replace(
        settings,
        threads=default.threads,
        memory_limit=default.memory_limit,
        keep_transport=default.keep_transport,
    )


def _originals(bake: RememberedBake) -> list[bpy.types.Object]:
    by_uid = {obj.session_uid: obj for obj in bpy.data.objects}
    return [by_uid[obj.uid] for obj in bake.objects]


def _store_in_refined(
    bake: RememberedBake, extraction: Extraction, result: BakeResult, attributes: Attributes
) -> tuple[list[bpy.types.Object], list[str]]:
    """Write the values on the corners of the refined meshes; returns the refined objects and warnings.

    Raises
    ------
    NotRelightableError
        When one of the meshes was edited.
    """
    outputs = outputs_by_source()
    found: list[tuple[bpy.types.Object, Target, BakedMesh]] = []
    pairs = baked_targets(extraction.scene, extraction.targets, result, bake.settings)
    for source, baked_object, (target, baked) in zip(_originals(bake), bake.objects, pairs, strict=True):
        for output in outputs[source]:
            if output.mode != "OBJECT" or fingerprint(output.data) != baked_object.fingerprint:
                raise NotRelightableError(f'The mesh of "{output.name}" was edited since the bake; bake again')
            found.append((output, target, baked))
    with Journal() as journal:
        displays = Displays(attributes, journal)
        for output, target, baked in found:
            rewrite_colours(output.data, values_of_corners(target, baked, attributes), attributes, journal)
            _show(output, target, attributes, displays, journal)
        journal.later(display.remove_unused_display_materials)
        journal.later(displays.take_names)
    return [output for output, _, _ in found], displays.cautions


def _show(
    output: bpy.types.Object, target: Target, attributes: Attributes, displays: Displays, journal: Journal
) -> None:
    """Have the materials show the backs once they have colours, and the originals' colours as they are now."""
    both_sides = attributes.name(attributes.quantity_shown(), back=True) in output.data.color_attributes
    originals = original_materials(target, len(output.material_slots))
    for slot, original in zip(output.material_slots, originals, strict=True):
        if display.is_display(slot.material):
            journal.set(slot, "material", displays.of(original, both_sides))


def reason_not_to_relight(context: bpy.types.Context) -> str | None:
    """Return a sentence that says why the button is grey, or None when it is not."""
    if Watch.running is not None:
        return "A bake is running; wait for it or press Esc"
    if context.mode != "OBJECT":
        return f"{way_to_object_mode(context)} to relight"
    bake = remembered_bake(context.scene)
    return reason_of_memory(context) if bake is None else _reason_of_transport(bake)


def reason_of_memory(context: bpy.types.Context) -> str:
    """Return why there is no transport in memory."""
    settings = context.scene.radiosity
    if not settings.report:
        return "Bake first: Relight gives a bake the colours that the materials have now"
    if not settings.keep_transport:
        return "Turn on Keep for Relighting and bake again to relight"
    return (
        "What the rays of this bake met is not in memory: it is let go of when a file is opened, when another scene is "
        "baked and when the bake is undone; bake again to relight"
    )


def _reason_of_transport(bake: RememberedBake) -> str | None:
    if isinstance(bake.transport, NotKept):
        return bake.transport.why
    by_uid = {obj.session_uid: obj for obj in bpy.data.objects}
    refined = outputs_by_source() if bake.settings.output == "REFINED" else {}
    for baked in bake.objects:
        obj = by_uid.get(baked.uid)
        if obj is None or (obj not in refined and obj.radiosity.kind != BAKED_IN_PLACE):
            return f'"{baked.name}" is not baked any more; bake again to relight'
    return None


class RADIOSITY_OT_relight(bpy.types.Operator):
    """Light the last bake again, without tracing."""

    bl_idname = "radiosity.relight"
    bl_label = "Relight"
    bl_description = (
        "Give the last bake the colours that lamps, materials and World have now, in a small share of its time. "
        "The lamps' powers, emission and base colours may change; for everything else, bake again"
    )
    bl_options = {"REGISTER", "UNDO"}  # noqa: RUF012 - Blender reads it from the class

    @classmethod
    def poll(cls, context):
        """Return whether the last bake can be lit again; the tooltip says why not."""
        reason = reason_not_to_relight(context)
        if reason is not None:
            cls.poll_message_set(reason)
        return reason is None

    def execute(self, context):
        """Relight to the end."""
        try:
            report = relight_scene(context)
        except BakeError as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}
        sentence = f"Relit {counted(len(report['objects']), 'object')} in {report['seconds']['total']:.1f} s"
        self.report({"INFO"}, sentence)
        return {"FINISHED"}
