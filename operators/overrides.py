# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""What library overrides need so that the file keeps what is set and remembered of them."""

import bpy
from bpy.app.handlers import persistent


@persistent
def _make_groups_of_references(*_: object) -> None:
    """Make our groups of properties on what is overridden, if its own file has none.

    Blender 5 compares an override with what it overrides before it saves. Where that has no group it takes the whole
    group for what differs, and cannot read that back (RNA_property_pointer_set: expected ID type). Reading a group
    makes it.
    """
    for obj in bpy.data.objects:
        reference = obj.override_library.reference if obj.override_library is not None else None
        if reference is not None:
            _ = reference.radiosity, reference.radiosity_settings


def register() -> None:
    """Look after overrides before each save."""
    bpy.app.handlers.save_pre.append(_make_groups_of_references)


def unregister() -> None:
    """Stop looking after them."""
    bpy.app.handlers.save_pre.remove(_make_groups_of_references)
