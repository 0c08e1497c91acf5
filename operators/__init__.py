# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The Blender side: settings, extraction, the bake in its thread, storing, restoring and the command."""

import bpy

from . import (
    animation,
    bake,
    command,
    doors,
    object_settings,
    overrides,
    record,
    relight,
    restore,
    settings,
    transports,
)

_register_classes, _unregister_classes = bpy.utils.register_classes_factory(
    (
        settings.RadiositySettings,
        record.RememberedSlot,
        record.RememberedAttribute,
        record.ObjectRecord,
        object_settings.ObjectSettings,
        bake.RADIOSITY_OT_bake,
        doors.RADIOSITY_OT_cancel,
        animation.RADIOSITY_OT_bake_frames,
        relight.RADIOSITY_OT_relight,
        restore.RADIOSITY_OT_restore,
    )
)


def register() -> None:
    """Register the classes, then the properties and the command that use them."""
    _register_classes()
    bpy.types.Scene.radiosity = bpy.props.PointerProperty(type=settings.RadiositySettings)
    bpy.types.Object.radiosity = bpy.props.PointerProperty(type=record.ObjectRecord, override={"LIBRARY_OVERRIDABLE"})
    bpy.types.Object.radiosity_settings = bpy.props.PointerProperty(
        type=object_settings.ObjectSettings, override={"LIBRARY_OVERRIDABLE"}
    )
    transports.register()
    overrides.register()
    command.register()


def unregister() -> None:
    """Unregister in reverse; a bake that still runs is ended."""
    doors.stop_running_bake()
    command.unregister()
    overrides.unregister()
    transports.unregister()
    del bpy.types.Object.radiosity_settings
    del bpy.types.Object.radiosity
    del bpy.types.Scene.radiosity
    _unregister_classes()
