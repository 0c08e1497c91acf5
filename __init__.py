# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Radiosity Bake: an extension that bakes the light of a scene into vertex colours.

Nothing here imports bpy before `register`, so that `core` can be used and tested without Blender.
"""

import atexit

_state = {"registered": False}


def register() -> None:
    """Add the settings, operators, panels and the command to Blender."""
    from . import operators, ui

    operators.register()
    ui.register()
    # Blender disables add-ons when it ends; the bpy module does not, and crashes over classes still registered.
    atexit.register(unregister)
    _state["registered"] = True


def unregister() -> None:
    """Take everything back out, in reverse order."""
    from . import operators, ui

    # At exit both the hook above and Blender come here.
    if not _state["registered"]:
        return
    _state["registered"] = False
    atexit.unregister(unregister)
    ui.unregister()
    operators.unregister()
