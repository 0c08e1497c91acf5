# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Single changes to objects and meshes that know how to be taken back."""

import bpy
import numpy as np

from .journal import Journal
from .record import forget


def clear_record(obj: bpy.types.Object, journal: Journal) -> None:
    """Empty the record of `obj`."""
    journal.on_failure(_rewrite_record, obj, _as_dictionary(obj.radiosity))
    forget(obj)


def remember_record(obj: bpy.types.Object, journal: Journal) -> None:
    """Have the record of `obj` as it is now written back if anything fails."""
    journal.on_failure(_rewrite_record, obj, _as_dictionary(obj.radiosity))


def _as_dictionary(group: bpy.types.PropertyGroup) -> dict:
    values = {}
    for name, item in group.bl_rna.properties.items():
        if name == "rna_type" or not group.is_property_set(name):
            continue
        value = getattr(group, name)
        values[name] = [_as_dictionary(element) for element in value] if item.type == "COLLECTION" else value
    return values


def _rewrite_record(obj: bpy.types.Object, values: dict) -> None:
    forget(obj)
    _write_group(obj.radiosity, values)


def _write_group(group: bpy.types.PropertyGroup, values: dict) -> None:
    for name, value in values.items():
        if isinstance(value, list):
            for element in value:
                _write_group(getattr(group, name).add(), element)
        else:
            setattr(group, name, value)


def in_view_layer(obj: bpy.types.Object, view_layer: bpy.types.ViewLayer) -> bool:
    """Return whether `view_layer` shows or could show `obj`."""
    found = view_layer.objects.get(obj.name)
    # A library override may have the name of what it overrides, and stand beside it.
    return found == obj or (found is not None and any(other == obj for other in view_layer.objects))


def link(obj: bpy.types.Object, collection: bpy.types.Collection, journal: Journal) -> None:
    """Put `obj` into `collection`."""
    collection.objects.link(obj)
    journal.on_failure(collection.objects.unlink, obj)


def set_eye(obj: bpy.types.Object, hidden: bool, view_layer: bpy.types.ViewLayer, journal: Journal) -> None:
    """Hide or show `obj` in the view layer, as its eye in the outliner does."""
    if in_view_layer(obj, view_layer) and obj.hide_get(view_layer=view_layer) != hidden:
        obj.hide_set(hidden, view_layer=view_layer)
        journal.on_failure(_set_eye_back, obj, not hidden, view_layer)


def _set_eye_back(obj: bpy.types.Object, hidden: bool, view_layer: bpy.types.ViewLayer) -> None:
    obj.hide_set(hidden, view_layer=view_layer)


def select(obj: bpy.types.Object, state: bool, view_layer: bpy.types.ViewLayer, journal: Journal) -> None:
    """Select or deselect `obj`."""
    if in_view_layer(obj, view_layer):
        journal.on_failure(_select_back, obj, obj.select_get(view_layer=view_layer), view_layer)
        obj.select_set(state, view_layer=view_layer)


def _select_back(obj: bpy.types.Object, state: bool, view_layer: bpy.types.ViewLayer) -> None:
    obj.select_set(state, view_layer=view_layer)


def make_active(obj: bpy.types.Object, view_layer: bpy.types.ViewLayer, journal: Journal) -> None:
    """Make `obj` the active object."""
    journal.set(view_layer.objects, "active", obj)


def remove_mesh_if_unused(mesh: bpy.types.Mesh) -> None:
    """Remove a mesh that no object shows."""
    if mesh.users == 0:
        bpy.data.meshes.remove(mesh)


def remove_attribute(mesh: bpy.types.Mesh, name: str, journal: Journal) -> None:
    """Remove a colour attribute, keeping its values until all else went well."""
    attribute = mesh.color_attributes[name]
    values = np.empty(4 * len(attribute.data), dtype=np.float32)
    attribute.data.foreach_get("color", values)
    journal.on_failure(_recreate_attribute, mesh, name, attribute.data_type, attribute.domain, values)
    mesh.color_attributes.remove(attribute)


def _recreate_attribute(mesh: bpy.types.Mesh, name: str, data_type: str, domain: str, values: np.ndarray) -> None:
    mesh.color_attributes.new(name, data_type, domain).data.foreach_set("color", values)


def rename_attribute(mesh: bpy.types.Mesh, name: str, new_name: str, journal: Journal) -> str:
    """Rename an attribute and return the name that it got, which Blender makes unique."""
    attribute = mesh.attributes[name]
    attribute.name = new_name
    journal.on_failure(_rename_back, mesh, attribute.name, name)
    return attribute.name


def _rename_back(mesh: bpy.types.Mesh, name: str, old_name: str) -> None:
    mesh.attributes[name].name = old_name


def active_attributes(mesh: bpy.types.Mesh) -> tuple[str, str, str]:
    """Return the names of the active attribute, the active colour and the rendered colour; empty for none."""
    active = mesh.attributes.active
    colours = mesh.color_attributes
    return (active.name if active else "", colours.active_color_name, colours.default_color_name)


def set_active_attributes(mesh: bpy.types.Mesh, active: str, active_color: str, default_color: str) -> None:
    """Make the attributes of those names active again, as `active_attributes` returned them."""
    mesh.color_attributes.active_color_name = active_color
    mesh.color_attributes.default_color_name = default_color
    index = mesh.attributes.find(active)
    # Without an active attribute Blender counts -1 or 0, depending on its version; both mean none.
    mesh.attributes.active_index = index if index >= 0 else mesh.attributes.active_index


def remember_active_attributes(mesh: bpy.types.Mesh, journal: Journal) -> None:
    """Have the active attributes set back last of all that happens to the attributes of `mesh` from here on."""
    journal.on_failure(set_active_attributes, mesh, *active_attributes(mesh))
