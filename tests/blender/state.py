# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Everything of the open file that a bake could change, as plain data that can be compared."""

import bpy
import numpy as np

_NOT_STATE = {
    # Numbers of the moment, not of the file.
    "rna_type",
    "id_data",
    "original",
    "tag",
    "is_evaluated",
    "animation_data",
    # Computed by the last evaluation, which skips hidden objects.
    "bound_box",
    "dimensions",
    # Whether a linked datablock was asked for directly; counted anew whenever the file is saved.
    "is_library_indirect",
    # True for ever from Blender 5.0 on, where asking warns.
    "use_nodes",
    "preview",
}


def file_state():
    """Return a nested dictionary of objects, meshes, materials, collections and scenes."""
    bpy.context.view_layer.update()
    return {
        "objects": {obj.name_full: _object(obj) for obj in bpy.data.objects},
        "meshes": {mesh.name_full: _mesh(mesh) for mesh in bpy.data.meshes},
        "materials": {material.name_full: _simple(material) for material in bpy.data.materials},
        "collections": {c.name_full: (_simple(c), sorted(o.name for o in c.objects)) for c in bpy.data.collections},
        "scenes": {scene.name_full: _scene(scene) for scene in bpy.data.scenes},
        "other": {
            name: sorted(item.name_full for item in getattr(bpy.data, name)) for name in ("images", "node_groups")
        },
    }


def differences(before, after, path=""):
    """Return a line for everything in which two states differ."""
    if isinstance(before, dict) and isinstance(after, dict):
        found = []
        for key in {**before, **after}:
            found += differences(before.get(key, "missing"), after.get(key, "missing"), f"{path}/{key}")
        return found
    return [] if before == after else [f"{path}: {before} became {after}"]


def _simple(struct):
    """Return the properties of a struct that hold plain values or point to datablocks."""
    values = {}
    for item in struct.bl_rna.properties:
        name = item.identifier
        if name in _NOT_STATE or name == "radiosity":
            continue
        value = getattr(struct, name)
        if item.type == "POINTER":
            values[name] = value.name_full if isinstance(value, bpy.types.ID) else None
        elif item.type == "COLLECTION":
            values[name] = len(value)
        elif getattr(item, "is_array", False):
            values[name] = np.array(value).tolist()
        else:
            values[name] = sorted(value) if isinstance(value, set) else value
    return values


def _object(obj):
    state = _simple(obj)
    state["slots"] = [(slot.link, slot.material and slot.material.name_full) for slot in obj.material_slots]
    state["modifiers"] = [_simple(modifier) for modifier in obj.modifiers]
    state["baked"] = obj.radiosity.kind
    state["custom"] = sorted(key for key in obj.keys() if key != "radiosity")  # noqa: SIM118
    state["collections"] = sorted(collection.name for collection in obj.users_collection)
    shown = bpy.context.view_layer.objects.get(obj.name) == obj
    state["eye"] = shown and obj.hide_get()
    state["selected"] = shown and obj.select_get()
    return state


def _mesh(mesh):
    state = _simple(mesh)
    # Counts of what is kept elsewhere; -1 and 0 both mean that there is none.
    state["materials"] = [material and material.name_full for material in mesh.materials]
    state["attributes"] = [_attribute(attribute) for attribute in mesh.attributes]
    colours = mesh.color_attributes
    state["colours"] = [attribute.name for attribute in colours]
    state["active"] = (
        mesh.attributes.active and mesh.attributes.active.name,
        colours.active_color_name,
        colours.default_color_name,
        colours.active_color_index,
        colours.render_color_index,
    )
    normals = np.empty(3 * len(mesh.loops), dtype=np.float32)
    mesh.corner_normals.foreach_get("vector", normals)
    state["normals"] = normals.tobytes()
    return state


def _attribute(attribute):
    names = {"FLOAT_VECTOR": "vector", "FLOAT2": "vector", "FLOAT_COLOR": "color", "BYTE_COLOR": "color"}
    values = [getattr(item, names.get(attribute.data_type, "value")) for item in attribute.data]
    plain = [tuple(value) if hasattr(value, "__len__") else value for value in values]
    return attribute.name, attribute.data_type, attribute.domain, plain


def _scene(scene):
    return {
        "objects": sorted(obj.name_full for obj in scene.collection.all_objects),
        "layers": {layer.name: _layer(layer) for layer in scene.view_layers},
        "report": scene.radiosity.report,
        "simplify": scene.render.simplify_subdivision,
    }


def _layer(layer):
    collections, pending = {}, [layer.layer_collection]
    while pending:
        current = pending.pop()
        pending.extend(current.children)
        collections[current.name] = (current.exclude, current.hide_viewport)
    active = layer.objects.active
    return active and active.name_full, collections
