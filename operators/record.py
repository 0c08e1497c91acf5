# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""What a baked object remembers, so that one click brings everything back (`object.radiosity`).

Datablocks are remembered by pointer, not by name: Blender keeps them in the file and follows their renaming.
"""

import bpy

NOT_BAKED = "NONE"
HIDDEN_SOURCE = "SOURCE"
REFINED_OUTPUT = "OUTPUT"
BAKED_IN_PLACE = "ORIGINAL"


_OVERRIDABLE = {"LIBRARY_OVERRIDABLE"}
"""Of a library override Blender saves only what is declared to differ, so all that is remembered has to be."""
_OVERRIDABLE_LIST = {"LIBRARY_OVERRIDABLE", "USE_INSERTION"}


class RememberedSlot(bpy.types.PropertyGroup):
    """One material slot as it was before the display material took it."""

    material: bpy.props.PointerProperty(type=bpy.types.Material, override=_OVERRIDABLE)
    link: bpy.props.StringProperty(override=_OVERRIDABLE)


class RememberedAttribute(bpy.types.PropertyGroup):
    """One attribute of ours (`name`), and what a user's attribute of that name is called meanwhile (`aside`)."""

    aside: bpy.props.StringProperty(override=_OVERRIDABLE)


class ObjectRecord(bpy.types.PropertyGroup):
    """The part an object plays in a bake, and its state before.

    `kind` says which of the other properties mean something: a hidden source has its visibility, a refined output its
    source and where it was put, an object that was baked in place its slots, attributes and, if its mesh was shared,
    that mesh.
    """

    kind: bpy.props.EnumProperty(
        items=(
            (NOT_BAKED, "Not Baked", ""),
            (HIDDEN_SOURCE, "Source", "Hidden while its refined copy shows the baked light"),
            (REFINED_OUTPUT, "Refined", "Made by a bake"),
            (BAKED_IN_PLACE, "In Place", "Carries baked light on its own mesh"),
        ),
        default=NOT_BAKED,
        override=_OVERRIDABLE,
    )
    source: bpy.props.PointerProperty(type=bpy.types.Object, override=_OVERRIDABLE)
    place: bpy.props.FloatVectorProperty(size=16, override=_OVERRIDABLE)
    hide_render: bpy.props.BoolProperty(override=_OVERRIDABLE)
    hide_viewport: bpy.props.BoolProperty(override=_OVERRIDABLE)
    hide_eye: bpy.props.BoolProperty(override=_OVERRIDABLE)
    shared_mesh: bpy.props.PointerProperty(type=bpy.types.Mesh, override=_OVERRIDABLE)
    slots: bpy.props.CollectionProperty(type=RememberedSlot, override=_OVERRIDABLE_LIST)
    slot_added: bpy.props.BoolProperty(override=_OVERRIDABLE)
    attributes: bpy.props.CollectionProperty(type=RememberedAttribute, override=_OVERRIDABLE_LIST)
    active_attribute: bpy.props.StringProperty(override=_OVERRIDABLE)
    active_color: bpy.props.StringProperty(override=_OVERRIDABLE)
    default_color: bpy.props.StringProperty(override=_OVERRIDABLE)


def forget(obj: bpy.types.Object) -> None:
    """Empty the record of `obj`; the datablocks it pointed to lose a user."""
    obj.property_unset("radiosity")
    # Until Blender 5.0 the group lives among the object's custom properties and would stay there, empty.
    if "radiosity" in obj.keys():  # noqa: SIM118 - an ID is no dict
        del obj["radiosity"]


def is_output(obj: bpy.types.Object) -> bool:
    """Return whether `obj` is a refined mesh that a bake made."""
    return obj.radiosity.kind == REFINED_OUTPUT and obj.radiosity.source is not None


def source_of(obj: bpy.types.Object) -> bpy.types.Object:
    """Return the object that a bake of `obj` means: the hidden source of a refined output, else `obj` itself."""
    return obj.radiosity.source if is_output(obj) else obj


def hidden_in_render(obj: bpy.types.Object) -> bool:
    """Return whether `obj` would be left out of a rendering had nothing been baked."""
    if obj.radiosity.kind == HIDDEN_SOURCE:
        return obj.radiosity.hide_render
    return obj.hide_render
