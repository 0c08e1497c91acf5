# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Run inside a Blender by the tests of the real one: save an example room as a .blend file.

blender --background --python save_room.py -- CHECKOUT ROOM FILE
"""

from __future__ import annotations

import sys

import bpy

checkout, room, path = sys.argv[sys.argv.index("--") + 1 :]
sys.path.insert(0, checkout)

from tools.blend_rooms import build_room  # noqa: E402

build_room(room)
bpy.ops.wm.save_as_mainfile(filepath=path)
