# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Light linking: which objects the light of a lamp or of an emitting object is for, and which hide it, as in Cycles."""

from collections.abc import Sequence

import bpy

from ..core.scene import LightLinking

States = dict[bpy.types.Object, str]


def linked_objects(obj: bpy.types.Object) -> set[bpy.types.Object]:
    """Return the objects that the light of `obj` names, for itself or against."""
    linking = obj.light_linking
    return {*_states(linking.receiver_collection), *_states(linking.blocker_collection)}


def light_linking(obj: bpy.types.Object, owners: Sequence[bpy.types.Object]) -> LightLinking:
    """Return what the light linking of `obj` means for meshes.

    Parameters
    ----------
    owners : sequence of Object
        The object that each mesh is linked by.
    """
    linking = obj.light_linking
    return LightLinking(
        _chosen(_states(linking.receiver_collection), owners), _chosen(_states(linking.blocker_collection), owners)
    )


def _states(collection: bpy.types.Collection | None) -> States:
    """Return whether objects of a collection are included or excluded."""
    states: States = {}
    if collection is None:
        return states
    # What is in a collection within it has the state of that collection, but its own where it is linked directly.
    for child, link in zip(collection.children, collection.collection_children, strict=True):
        states.update(dict.fromkeys(child.all_objects, link.light_linking.link_state))
    for obj, link in zip(collection.objects, collection.collection_objects, strict=True):
        states[obj] = link.light_linking.link_state
    return states


def _chosen(states: States, owners: Sequence[bpy.types.Object]) -> frozenset[int] | None:
    """Return the numbers of the meshes that are included, or else of all but the excluded; None for all."""
    usual = "EXCLUDE" if "INCLUDE" in states.values() else "INCLUDE"
    chosen = frozenset(number for number, owner in enumerate(owners) if states.get(owner, usual) == "INCLUDE")
    return None if len(chosen) == len(owners) else chosen
