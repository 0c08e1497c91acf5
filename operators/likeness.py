# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Objects that take after others of another type, where Blender has no copy: a mesh object in place of a text."""

import bpy

_PLAIN = {"BOOLEAN", "INT", "FLOAT", "STRING", "ENUM"}
_OWN = {"name", "mode", "instance_type", "parent_type", "parent_vertices", "parent_bone", "data", "dimensions"}
"""Not to be copied as plain values: what names an object, depends on its type or is computed."""


def take_after(obj: bpy.types.Object, model: bpy.types.Object) -> None:
    """Give `obj` the parent, transform, constraints, animation and plain settings of `model`."""
    obj.parent = model.parent
    for name in ("parent_type", "parent_bone", "parent_vertices"):
        setattr(obj, name, getattr(model, name))
    for item in obj.bl_rna.properties:
        name = item.identifier
        computed = name.startswith("matrix_") and name != "matrix_parent_inverse"
        if item.type in _PLAIN and not item.is_readonly and not computed and name not in _OWN:
            setattr(obj, name, getattr(model, name))
    for constraint in model.constraints:
        obj.constraints.copy(constraint)
    _animate_alike(obj, model)


def _animate_alike(obj: bpy.types.Object, model: bpy.types.Object) -> None:
    animation = model.animation_data
    if animation is None:
        return
    copied = obj.animation_data_create()
    copied.action = animation.action
    if hasattr(animation, "action_slot") and animation.action is not None:
        copied.action_slot = animation.action_slot
    for driver in animation.drivers:
        copied.drivers.from_existing(src_driver=driver)
