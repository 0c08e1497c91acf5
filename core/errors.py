# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""What can end a bake early; every text is a sentence fit for Blender's status bar."""


class BakeError(Exception):
    """A bake cannot be done as asked; the text says what is wrong and what to do."""


class NothingToBakeError(BakeError):
    """No mesh with faces is marked to be baked."""


class NoLightError(BakeError):
    """Nothing in the scene emits light."""


class UnsolvableError(BakeError):
    """The energy balance has no finite solution: light is trapped between surfaces of reflectance 1."""


class SettingsError(BakeError):
    """A setting lies outside its range."""


class RayLibraryError(BakeError):
    """The ray library (embreex) cannot be imported or used on this computer."""


class Cancelled(Exception):  # noqa: N818 - not an error: the user asked for it
    """The progress callback asked to stop; nothing was changed."""
