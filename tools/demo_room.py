# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The part of the demo that runs in Blender: build one room, path trace it, bake it with the installed zip, render it.

python -m tools.demo_room ROOM ZIP FOLDER      in the environment that tools/installed.py describes
"""

from __future__ import annotations

import json
import sys
import time
from pathlib import Path

import bpy

from .blend_rooms import build_room
from .installed import install_zip

# The baked colours are all that is rendered, so that samples only smooth the edges of things.
SAMPLES_OF_BAKED = 64


def render(path: Path) -> float:
    """Render to a PNG and return the seconds that it took."""
    started = time.perf_counter()
    bpy.context.scene.render.filepath = str(path)
    bpy.ops.render.render(write_still=True)
    return time.perf_counter() - started


def save(path: Path) -> None:
    """Save the open file; an older one of the name is replaced, not kept as a backup beside it."""
    bpy.context.preferences.filepaths.save_version = 0
    bpy.ops.wm.save_as_mainfile(filepath=str(path), compress=True)


def bake(objects: list[bpy.types.Object]) -> dict[str, object]:
    """Bake as a user does, through the operator, and return its report."""
    for thing in objects:
        thing.select_set(True)
    bpy.context.view_layer.objects.active = objects[0]
    if bpy.ops.radiosity.bake() != {"FINISHED"}:
        raise RuntimeError("the bake did not finish")
    report: dict[str, object] = json.loads(bpy.context.scene.radiosity.report)
    return report


def main(room: str, zip_path: Path, folder: Path) -> None:
    install_zip(zip_path)
    objects = build_room(room)
    save(folder / f"{room}.blend")
    cycles = bpy.context.scene.cycles
    denoised = cycles.use_denoising
    seconds_traced = render(folder / f"{room}_path_traced.png")
    report = bake(objects)
    cycles.samples, cycles.use_denoising = SAMPLES_OF_BAKED, False
    seconds_rendered = render(folder / f"{room}_baked.png")
    save(folder / f"{room}_baked.blend")
    pictures = {
        "path_traced": round(seconds_traced, 2),
        "denoised": denoised,
        "rendered_from_baked": round(seconds_rendered, 2),
    }
    (folder / f"{room}.json").write_text(json.dumps({**report, "pictures": pictures}, indent=2), encoding="utf-8")


if __name__ == "__main__":
    main(sys.argv[1], Path(sys.argv[2]), Path(sys.argv[3]))
