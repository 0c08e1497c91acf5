# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Bringing the originals back exactly as they were before a bake."""

from collections.abc import Iterable
from typing import NamedTuple

import bpy
from mathutils import Matrix

from . import display
from .attachments import hand_over, lost_with, take_properties
from .changes import (
    clear_record,
    in_view_layer,
    make_active,
    remember_active_attributes,
    remove_attribute,
    remove_mesh_if_unused,
    rename_attribute,
    select,
    set_active_attributes,
    set_eye,
)
from .journal import Journal
from .places import follow, follow_collections, outputs_by_source, same_place, show_again, shows_place, stand_in_place
from .record import BAKED_IN_PLACE, HIDDEN_SOURCE, is_output, source_of
from .refined import output_name


class RADIOSITY_OT_restore(bpy.types.Operator):
    """Bring back what was there before the bake."""

    bl_idname = "radiosity.restore"
    bl_label = "Restore Originals"
    bl_description = (
        "Remove the baked light and bring the original meshes and materials back: "
        "of the selected objects if any of them is baked, else of the whole scene"
    )
    bl_options = {"REGISTER", "UNDO"}  # noqa: RUF012 - Blender reads it from the class

    @classmethod
    def poll(cls, context):
        """Return whether there is anything to restore; the tooltip says why not."""
        if context.mode != "OBJECT":
            cls.poll_message_set("Leave edit mode to restore")
            return False
        if not any(is_baked(obj) for obj in context.scene.objects):
            cls.poll_message_set("Nothing in this scene is baked")
            return False
        return True

    def execute(self, context):
        """Restore and say how many objects came back."""
        baked = baked_objects(context.selected_objects) or baked_objects(context.scene.objects)
        baked = list(dict.fromkeys([*baked, *orphans(context.scene.objects)]))
        shown = {obj: shown_place(obj) for obj in baked}
        cautions = restore(baked, context.view_layer)
        context.view_layer.update()
        elsewhere = [obj for obj in baked if shown[obj] is not None and not same_place(shown[obj], obj.matrix_world)]
        if not any(is_baked(obj) for obj in context.scene.objects):
            context.scene.radiosity.property_unset("report")
            display.show_as_before(context)
        sentence = f"Restored {len(baked)} {'object' if len(baked) == 1 else 'objects'}"
        if elsewhere:
            names = ", ".join(f'"{obj.name}"' for obj in elsewhere)
            cautions.append(f"{names} went back to where its animation or constraints put it")
        self.report({"WARNING" if cautions else "INFO"}, "; ".join([sentence, *cautions]))
        return {"FINISHED"}


def is_baked(obj: bpy.types.Object) -> bool:
    """Return whether `obj` is part of a bake: a refined output, its hidden source, or baked in place."""
    if obj.library is not None:
        return False
    return is_output(obj) or obj.radiosity.kind in {HIDDEN_SOURCE, BAKED_IN_PLACE}


def baked_objects(objects: Iterable[bpy.types.Object]) -> list[bpy.types.Object]:
    """Return the originals of those of `objects` that are baked, each once."""
    return list(dict.fromkeys(source_of(obj) for obj in objects if is_baked(obj)))


def orphans(objects: Iterable[bpy.types.Object]) -> list[bpy.types.Object]:
    """Return those of `objects` that are hidden behind a refined object which was deleted."""
    outputs = outputs_by_source()
    return [obj for obj in objects if is_baked(obj) and obj.radiosity.kind == HIDDEN_SOURCE and obj not in outputs]


def shown_place(source: bpy.types.Object) -> Matrix | None:
    """Return the transform at which the refined object of `source` is shown, or None if there is none."""
    outputs = [obj for obj in outputs_of(source) if shows_place(obj)]
    return outputs[0].matrix_world.copy() if len(outputs) == 1 and outputs[0].visible_get() else None


def restore(objects: Iterable[bpy.types.Object], view_layer: bpy.types.ViewLayer) -> list[str]:
    """Bring back what `objects` were before their bake, all of them or none; return sentences on what is lost by it."""
    with Journal() as journal:
        cautions = [caution for obj in objects for caution in restore_object(obj, view_layer, journal)]
        journal.later(display.remove_unused_display_materials)
    return cautions


def restore_object(obj: bpy.types.Object, view_layer: bpy.types.ViewLayer, journal: Journal) -> list[str]:
    """Bring back what `obj`, an original, was before its bake; nothing happens if it was not baked.

    What the artist attached to a refined object goes over to `obj`; sentences tell what cannot.
    """
    outputs = outputs_of(obj)
    if outputs or obj.radiosity.kind == HIDDEN_SOURCE:
        return _restore_source(obj, outputs, view_layer, journal)
    if obj.radiosity.kind == BAKED_IN_PLACE:
        _restore_in_place(obj, journal)
    return []


def outputs_of(source: bpy.types.Object) -> list[bpy.types.Object]:
    """Return the refined meshes that stand for `source`: one, or more if the user duplicated it, copies last."""

    def is_likely_made_later(output: bpy.types.Object) -> tuple[bool, int]:
        return output.name != output_name(source), output.session_uid

    found = [obj for obj in bpy.data.objects if is_output(obj) and obj.radiosity.source == source]
    return sorted(found, key=is_likely_made_later)


# ---------------------------------------------------------------------------------------------------------------------
# Refined: the source is hidden, its output shown


def _restore_source(source, outputs, view_layer, journal: Journal) -> list[str]:
    show_again(source, outputs, journal)
    follow(source, outputs[:1], journal)
    for output in outputs[:1]:
        follow_collections(source, output, journal)
    shown = [_Shown.of(output, view_layer) for output in outputs]
    journal.on_failure(_select_again, view_layer, view_layer.objects.active, _selected(outputs, view_layer))
    _show_as_before(source, view_layer, journal)
    cautions = []
    for number, (output, state) in enumerate(zip(outputs, shown, strict=True)):
        heir = source if number == 0 else _copy_at(source, output, journal)
        cautions += lost_with(output, source)
        if heir.library is None:
            take_properties(heir, output, journal, over=True)
        cautions += hand_over(output, heir, journal)
        discard_output(output, journal)
        if state.selected:
            select(heir, True, view_layer, journal)
        if state.active and in_view_layer(heir, view_layer):
            make_active(heir, view_layer, journal)
    return cautions


class _Shown(NamedTuple):
    """How a refined object was, before it is taken out of the scene."""

    selected: bool
    active: bool

    @classmethod
    def of(cls, output: bpy.types.Object, view_layer: bpy.types.ViewLayer) -> "_Shown":
        return cls(bool(_selected([output], view_layer)), view_layer.objects.active == output)


def _copy_at(source: bpy.types.Object, output: bpy.types.Object, journal: Journal) -> bpy.types.Object:
    """Return a copy of `source` in the place of a refined object that the user duplicated, linked as that one is."""
    copy = source.copy()
    journal.on_failure(bpy.data.objects.remove, copy)
    stand_in_place(copy, output)
    for collection in output.users_collection:
        collection.objects.link(copy)
    return copy


def _show_as_before(source: bpy.types.Object, view_layer: bpy.types.ViewLayer, journal: Journal) -> None:
    record = source.radiosity
    if record.kind == HIDDEN_SOURCE:
        hide_render, hide_viewport, hide_eye = record.hide_render, record.hide_viewport, record.hide_eye
        clear_record(source, journal)
        journal.set(source, "hide_render", hide_render)
        journal.set(source, "hide_viewport", hide_viewport)
        set_eye(source, hide_eye, view_layer, journal)


def _selected(objects, view_layer) -> list[bpy.types.Object]:
    return [obj for obj in objects if in_view_layer(obj, view_layer) and obj.select_get(view_layer=view_layer)]


def _select_again(view_layer, active, selected) -> None:
    """Select and activate objects that are back in the view layer after they were unlinked."""
    for obj in selected:
        obj.select_set(True, view_layer=view_layer)
    view_layer.objects.active = active


def discard_output(output: bpy.types.Object, journal: Journal) -> None:
    """Take a refined object out of the scene now, and remove it with its mesh when all else went well."""
    # Its name is free again for the next bake's output.
    journal.set(output.data, "name", f"{output.data.name} (discarded)"[:60])
    journal.set(output, "name", f"{output.name} (discarded)"[:60])
    for collection in output.users_collection:
        journal.on_failure(collection.objects.link, output)
        collection.objects.unlink(output)
    journal.later(_remove_with_mesh, output)


def _remove_with_mesh(obj: bpy.types.Object) -> None:
    mesh = obj.data
    bpy.data.objects.remove(obj)
    remove_mesh_if_unused(mesh)


# ---------------------------------------------------------------------------------------------------------------------
# In place: slots, attributes and maybe the mesh were changed


def _restore_in_place(obj: bpy.types.Object, journal: Journal) -> None:
    record = obj.radiosity
    if record.shared_mesh is not None:
        copy = obj.data
        _restore_slots(obj, journal, of_object_only=True)
        journal.set(obj, "data", record.shared_mesh)
        journal.later(remove_mesh_if_unused, copy)
    else:
        _restore_slots(obj, journal)
        restore_attributes(obj, journal)
    clear_record(obj, journal)


def _restore_slots(obj: bpy.types.Object, journal: Journal, of_object_only: bool = False) -> None:
    """Give back the remembered materials of the slots that still show a bake."""
    remembered = list(obj.radiosity.slots)
    for index, slot in enumerate(obj.material_slots):
        before = remembered[index] if index < len(remembered) else None
        if of_object_only and (before is None or before.link != "OBJECT"):
            continue
        if before is not None and slot.link != before.link:
            journal.set(slot, "link", before.link)
        if display.is_display(slot.material):
            journal.set(slot, "material", before.material if before is not None else None)
    if obj.radiosity.slot_added and not of_object_only and len(obj.data.materials) == 1:
        materials = obj.data.materials
        journal.on_failure(materials.append, materials[0])
        materials.clear()


def restore_attributes(obj: bpy.types.Object, journal: Journal) -> None:
    """Remove our attributes from the mesh of `obj` and give the user's their names and places back."""
    mesh, record = obj.data, obj.radiosity
    before = (record.active_attribute, record.active_color, record.default_color)
    remember_active_attributes(mesh, journal)
    # Backwards, so that taking it back makes them in their order.
    ours = [attribute.name for attribute in record.attributes]
    for name in sorted(ours, key=mesh.attributes.find, reverse=True):
        attribute = record.attributes[name]
        if attribute.name in mesh.color_attributes:
            remove_attribute(mesh, attribute.name, journal)
        if attribute.aside and attribute.aside in mesh.attributes:
            rename_attribute(mesh, attribute.aside, attribute.name, journal)
    set_active_attributes(mesh, *before)
