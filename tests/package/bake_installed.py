# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Run by test_installed.py in a Blender that has nothing of ours but the zip: install it, bake, tell what came of it.

python -m tests.package.bake_installed ZIP RESULT
"""

from __future__ import annotations

import json
import sys
from pathlib import Path

import bpy
import numpy as np

from tools.blend_rooms import build_room
from tools.installed import MODULE, install_zip


def mean_colour(thing: bpy.types.Object, attribute: str) -> list[float]:
    """Return the plain mean of a colour attribute over its corners or points."""
    data = thing.data.color_attributes[attribute].data
    values = np.empty(4 * len(data), np.float32)
    data.foreach_get("color", values)
    return [float(value) for value in values.reshape(-1, 4)[:, :3].mean(axis=0)]


def main(zip_path: Path, result: Path) -> None:
    install_zip(zip_path)
    for thing in build_room("cornell_box"):
        thing.select_set(True)
    settings = bpy.context.scene.radiosity
    settings.quality, settings.minimum_size = "DRAFT", 0.1
    outcome = bpy.ops.radiosity.bake()
    baked = {
        thing.name: {name: mean_colour(thing, name) for name in ("Radiosity", "Irradiance")}
        for thing in bpy.data.objects
        if thing.type == "MESH" and not thing.hide_render and "Radiosity" in thing.data.color_attributes
    }
    told = {
        "outcome": sorted(outcome),
        "baked": baked,
        "report": json.loads(settings.report),
        "ray_library": sys.modules["embreex"].__file__,
        "user_folder": bpy.utils.resource_path("USER"),
    }
    bpy.ops.preferences.addon_disable(module=MODULE)
    told["left_after_disabling"] = [
        name
        for name, owner in (("RADIOSITY_OT_bake", bpy.types), ("radiosity", bpy.types.Scene))
        if hasattr(owner, name)
    ]
    result.write_text(json.dumps(told), encoding="utf-8")


if __name__ == "__main__":
    main(Path(sys.argv[1]), Path(sys.argv[2]))
