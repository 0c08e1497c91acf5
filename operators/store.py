# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The end of a bake: every baked object gets its values, all of them or none."""

from collections.abc import Callable

import bpy

from ..core.errors import BakeError
from ..core.result import BakeResult
from . import display
from .attributes import Attributes
from .changes import clear_record
from .colours import check_lengths
from .extraction import Extraction
from .in_place import check_names, keeps_names, store_in_place
from .journal import Journal
from .local_mesh import fingerprint
from .places import hang_together, outputs_by_source, same_place
from .refined import refined_to_keep, store_refined
from .restore import outputs_of, restore_object
from .targets import Target, baked_targets
from .textured import Displays

Beside = Callable[[bpy.types.Object, int, Journal], None]


class ChangedMeanwhileError(BakeError):
    """An object is no longer what it was when the bake began."""


def store(
    scene: bpy.types.Scene,
    extraction: Extraction,
    result: BakeResult,
    attributes: Attributes,
    beside: Beside | None = None,
) -> tuple[list[bpy.types.Object], list[str]]:
    """Write `result` into the file in place of any earlier bake of the same objects.

    Parameters
    ----------
    attributes : Attributes
    beside : callable, optional
        Writes more on each object that carries the colours, given with the `session_uid` of its original.

    Returns
    -------
    objects : list of Object
        Those that carry the baked colours now.
    warnings : list of str

    Raises
    ------
    ChangedMeanwhileError
        When an object was deleted, edited or is being edited; nothing is changed then.
    AttributeNameError
        See `check_storable`.
    """
    output = attributes.settings.output
    view_layer = view_layer_of(scene, extraction.view_layer)
    check_storable(extraction, attributes)
    pairs = baked_targets(extraction.scene, extraction.targets, result, attributes.settings)
    found = _find([target for target, _ in pairs], view_layer)
    warnings = [sentence for target, obj in found for sentence in _cautions(target, obj, output)]
    baked_objects = []
    with Journal() as journal:
        displays = Displays(attributes, journal)
        warnings += [_set_free(copy, journal) for _, obj in found for copy in _copies(obj)]
        for (target, obj), (_, baked) in zip(found, pairs, strict=True):
            # A second bake in place only needs new values; what the first one remembers stays true.
            kept = refined_to_keep(obj, target) if output == "REFINED" else None
            if kept is None and not (output == "ORIGINAL" and keeps_names(obj, attributes)):
                warnings += restore_object(obj, view_layer, journal)
            if output == "REFINED":
                baked_objects.append(store_refined(obj, target, baked, attributes, displays, view_layer, journal, kept))
            else:
                store_in_place(obj, target, baked, attributes, displays, journal)
                baked_objects.append(obj)
            if beside is not None:
                beside(baked_objects[-1], target.uid, journal)
        hang_together(outputs_by_source(), journal)
        journal.later(display.remove_unused_display_materials)
        journal.later(displays.take_names)
    return baked_objects, warnings + displays.cautions


def check_storable(extraction: Extraction, attributes: Attributes, ending: str = "") -> None:
    """Refuse what could not be stored in the end, before time is spent on it.

    Parameters
    ----------
    extraction : Extraction
    attributes : Attributes
    ending : str
        The longest that is added to their names.

    Raises
    ------
    AttributeNameError
        When a name is longer than Blender allows, or when an object that shall be baked in place has a vertex group
        with the name of one of our attributes.
    """
    check_lengths(attributes, ending)
    if attributes.settings.output != "ORIGINAL":
        return
    uids = {target.uid for target in extraction.targets}
    for obj in bpy.data.objects:
        if obj.session_uid in uids:
            check_names(obj, attributes)


def check_unchanged(extraction: Extraction) -> None:
    """Refuse what is no longer there as it was read.

    Raises
    ------
    ChangedMeanwhileError
        When the scene, its view layer or an object was deleted, or an object edited.
    """
    _find(list(extraction.targets), view_layer_of(scene_of(extraction.scene_uid), extraction.view_layer))


def scene_of(uid: int) -> bpy.types.Scene:
    """Return the scene of a `session_uid`, which need not be the one that the window shows by now.

    Raises
    ------
    ChangedMeanwhileError
        When it was deleted.
    """
    for scene in bpy.data.scenes:
        if scene.session_uid == uid:
            return scene
    raise ChangedMeanwhileError("The scene was deleted during the bake; nothing was stored")


def view_layer_of(scene: bpy.types.Scene, name: str) -> bpy.types.ViewLayer:
    """Return the view layer of a name.

    Raises
    ------
    ChangedMeanwhileError
        When it was deleted.
    """
    view_layer = scene.view_layers.get(name)
    if view_layer is None:
        raise ChangedMeanwhileError(
            f'The view layer "{name}" was removed or renamed during the bake; nothing was stored'
        )
    return view_layer


def _find(targets: list[Target], view_layer: bpy.types.ViewLayer) -> list[tuple[Target, bpy.types.Object]]:
    """Return each target with its object, looked up anew: pointers do not survive an undo during the bake."""
    by_uid = {obj.session_uid: obj for obj in bpy.data.objects}
    shown = set(view_layer.objects)
    found = []
    for target in targets:
        obj = by_uid.get(target.uid)
        if obj is None or (obj not in shown and obj.users_scene == () and not outputs_of(obj)):
            raise ChangedMeanwhileError(f'"{target.name}" was deleted during the bake; nothing was stored')
        for replaced in (obj, *outputs_of(obj)):
            if replaced.mode != "OBJECT":
                raise ChangedMeanwhileError(
                    f'"{replaced.name}" is in {replaced.mode.replace("_", " ").lower()} mode; '
                    "nothing was stored. Leave the mode and bake again"
                )
        if fingerprint(obj.data) != target.fingerprint:
            raise ChangedMeanwhileError(
                f'The mesh of "{obj.name}" was edited during the bake; nothing was stored. Bake again'
            )
        found.append((target, obj))
    return found


def _copies(source: bpy.types.Object) -> list[bpy.types.Object]:
    """Return what the user duplicated of the refined mesh of `source`: all that stand for it but one."""
    return outputs_of(source)[1:]


def _set_free(copy: bpy.types.Object, journal: Journal) -> str:
    """Have a duplicate be an object of its own, which no bake replaces; return a sentence on it."""
    clear_record(copy, journal)
    return (
        f'"{copy.name}" is a copy of a refined object: it was kept as it is, with the light of the earlier bake. '
        "To bake it, restore and duplicate the original instead"
    )


def _cautions(target: Target, obj: bpy.types.Object, output: str) -> list[str]:
    sentences = []
    shown = next(iter(outputs_of(obj)), obj)
    if not same_place(shown.matrix_world, target.shown):
        sentences.append(f'"{obj.name}" was moved during the bake; its light is that of the place where it was')
    if output == "ORIGINAL" and not target.same_corners:
        sentences.append(
            f'"{obj.name}" has modifiers that change its faces; '
            "its corners got the light of the nearest point of the modified mesh"
        )
    return sentences
