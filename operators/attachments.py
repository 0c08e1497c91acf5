# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""What artists attach to refined objects: children, constraints, properties, whatever points to them."""

from contextlib import suppress

import bpy

from .display import is_display
from .journal import Journal
from .naming import named
from .places import shows_place

_OURS = {"radiosity", "radiosity_settings"}


def take_properties(obj: bpy.types.ID, model: bpy.types.ID, journal: Journal, *, over: bool) -> None:
    """Give `obj` the custom properties of `model`; those that it has itself only if `over`."""
    registered = {*_OURS, *(item.identifier for item in obj.bl_rna.properties)}
    for key in model.keys():  # noqa: SIM118 - an ID is no dict
        if key in registered or (key in obj.keys() and not over):  # noqa: SIM118
            continue
        value = _plain(model[key])
        if key in obj.keys():  # noqa: SIM118
            if _plain(obj[key]) == value:
                continue
            journal.on_failure(obj.__setitem__, key, _plain(obj[key]))
        else:
            journal.on_failure(obj.__delitem__, key)
        obj[key] = value
        # A group of properties has no limits and no tooltip.
        with suppress(TypeError):
            obj.id_properties_ui(key).update_from(model.id_properties_ui(key))


def _plain(value: object) -> object:
    """Return the value of a custom property as what can be compared and written to another."""
    if hasattr(value, "to_dict"):
        return value.to_dict()
    return value.to_list() if hasattr(value, "to_list") else value


def hand_over(output: bpy.types.Object, heir: bpy.types.Object, journal: Journal) -> list[str]:
    """Have all that points to a refined object point to `heir` when all else went well; say what cannot.

    Children, targets of constraints, modifiers and drivers, and whatever else the file has. Their settings stay as they
    are, so that what follows the refined object follows `heir`, which stands in its place.
    """
    left = _cannot_follow(output, heir)
    journal.later(_remap, output, heir, left)
    if not left:
        return []
    names = named(child.name for child in left)
    return [f'{names} cannot be parented to "{heir.name}" as to "{output.name}", and stayed in place without a parent']


def _cannot_follow(output: bpy.types.Object, heir: bpy.types.Object) -> list[bpy.types.Object]:
    """Return the children of `output` that cannot be those of `heir`.

    `heir` may hang on them, and one that is flattened would flatten its children, which its refined object did not.
    """
    return [child for child in output.children if not shows_place(output) or heir in {child, *child.children_recursive}]


def _remap(output: bpy.types.Object, heir: bpy.types.Object, left: list[bpy.types.Object]) -> None:
    for child in left:
        place = child.matrix_world.copy()
        child.parent = None
        child.matrix_world = place
    output.user_remap(heir)


def lost_with(output: bpy.types.Object, source: bpy.types.Object) -> list[str]:
    """Return a sentence for all that the artist added to a refined object and that its original does not take over."""
    lost = []
    if output.modifiers:
        lost.append(f"the modifiers {named(modifier.name for modifier in output.modifiers)}")
    own = {slot.material for slot in source.material_slots}
    materials = {slot.material: None for slot in output.material_slots if slot.material not in own}
    given = [material.name for material in materials if material is not None and not is_display(material)]
    if given:
        lost.append(f"the materials {named(given)}")
    if source.library is not None:
        return _gone(output, lost) + _not_written(output, source)
    if _nla_tracks(output) - _nla_tracks(source):
        lost.append("its NLA tracks")
    return _gone(output, lost)


def _gone(output: bpy.types.Object, lost: list[str]) -> list[str]:
    return [f'What was added to "{output.name}" went with it: {" and ".join(lost)}'] if lost else []


def _not_written(output: bpy.types.Object, source: bpy.types.Object) -> list[str]:
    """Return a sentence if an original of another file has not got what was added to its refined object."""
    keys = {*output.keys()} - {*source.keys()} - _OURS
    constraints = {*output.constraints.keys()} - {*source.constraints.keys()}
    if not keys | constraints:
        return []
    return [f'"{source.name}" is linked from another file, so {named(sorted(keys | constraints))} could not be kept']


def _nla_tracks(obj: bpy.types.Object) -> set[str]:
    return set() if obj.animation_data is None else {track.name for track in obj.animation_data.nla_tracks}
