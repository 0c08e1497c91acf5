# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Objects that take after others of another type, where Blender has no copy: a mesh object in place of a text."""

import bpy

from .journal import Journal

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
    # Nobody knows of `obj` yet: nothing is to be taken back.
    take_constraints(obj, model, Journal())
    take_animation(obj, model, Journal())


def take_constraints(obj: bpy.types.Object, model: bpy.types.Object, journal: Journal) -> bool:
    """Give `obj` the constraints of `model` that it has none of the same name for; say if there were any."""
    missing = [constraint for constraint in model.constraints if constraint.name not in obj.constraints]
    for constraint in missing:
        journal.on_failure(obj.constraints.remove, obj.constraints.copy(constraint))
    if missing:
        # A copy alone does not tell Blender that the object depends on others now; any switch of visibility does.
        obj.hide_viewport = obj.hide_viewport
    return bool(missing)


def take_animation(obj: bpy.types.Object, model: bpy.types.Object, journal: Journal) -> None:
    """Give `obj` the action of `model`, if it has one, and the drivers of all that is not driven already."""
    animation = model.animation_data
    if animation is None:
        return
    own = obj.animation_data
    if own is None:
        own = obj.animation_data_create()
        journal.on_failure(obj.animation_data_clear)
    if animation.action is not None and own.action != animation.action:
        journal.on_failure(_set_action, own, own.action, getattr(own, "action_slot", None))
        _set_action(own, animation.action, getattr(animation, "action_slot", None))
    driven = {(driver.data_path, driver.array_index) for driver in own.drivers}
    for driver in animation.drivers:
        if (driver.data_path, driver.array_index) not in driven:
            journal.on_failure(own.drivers.remove, own.drivers.from_existing(src_driver=driver))


def _set_action(animation: bpy.types.AnimData, action: bpy.types.Action | None, slot: object) -> None:
    animation.action = action
    if slot is not None and action is not None:
        animation.action_slot = slot
