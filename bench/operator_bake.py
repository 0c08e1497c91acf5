# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Our operator from end to end, in a process of its own: `python operator_bake.py [--cold] SCENE.npz QUALITY...`.

The core's time leaves out what reads Blender's scene and what stores the meshes in it; here all of
`bpy.ops.radiosity.bake` is timed. Reads plain arrays and prints JSON. Unless the start is to be cold, a bake that does
not count comes first.
"""

from __future__ import annotations

import json
import os
import resource
import sys
import time
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import bpy
import numpy as np
from blender_scene import make_object, set_world

# A script finds what lies beside it, not the checkout that it belongs to.
sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

from tools.package import load_package


def bake(quality: str) -> dict[str, Any]:
    """Bake everything that is selected, and put the originals back; returns what it took and the bake's own counts."""
    settings = bpy.context.scene.radiosity
    settings.quality = quality
    start, used = time.perf_counter(), sum(os.times()[:2])
    bpy.ops.radiosity.bake()
    seconds, processor_seconds = time.perf_counter() - start, sum(os.times()[:2]) - used
    report = json.loads(settings.report)
    bpy.ops.radiosity.restore()
    counts = {key: report[key] for key in ("patches", "vertices", "rays")}
    counts["warnings"] = report["warnings"]
    # Of the whole process so far, Blender and the scene included.
    counts["peak_bytes"] = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * 1024
    return {"quality": quality, "seconds": seconds, "processor_seconds": processor_seconds, **counts}


def main(given: str, qualities: Sequence[str], cold: bool) -> None:
    """Bake the scene of a file with each quality."""
    load_package().register()
    bpy.ops.wm.read_factory_settings(use_empty=True)
    with np.load(given) as file:
        arrays = dict(file)
    set_world(arrays["world"])
    count = sum(name.startswith("vertices_") for name in arrays)
    for k in range(count):
        make_object(arrays, k).select_set(True)
    if not cold:
        bake("DRAFT")  # the first bake of a process also pays for loading libraries
    found = [bake(quality) for quality in qualities]
    # Blender itself writes to the standard output as well: ours is the last line.
    print(json.dumps(found), flush=True)


if __name__ == "__main__":
    words = [word for word in sys.argv[1:] if word != "--cold"]
    main(words[0], words[1:], "--cold" in sys.argv)
