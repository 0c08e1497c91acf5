# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""What the open file links from libraries that are gone; Blender has placeholders for it, which show nothing."""

import bpy

from .naming import named


def missing_links() -> list[str]:
    """Return a sentence for each library of which something could not be read."""
    missing: dict[bpy.types.Library, list[str]] = {}
    for found in bpy.data.user_map():
        if found.is_missing and found.library is not None:
            missing.setdefault(found.library, []).append(found.name)
    return [_sentence(library, sorted(names)) for library, names in sorted(missing.items(), key=lambda i: i[0].name)]


def _sentence(library: bpy.types.Library, names: list[str]) -> str:
    what = f"so {named(names)} from it {'is' if len(names) == 1 else 'are'} left out"
    if library.is_missing:
        return f'The linked file "{library.filepath}" could not be read, {what}'
    return f'The linked file "{library.filepath}" has changed, {what}'
