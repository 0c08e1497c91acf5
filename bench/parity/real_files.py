# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Whole files, in a process of their own: rooms like an artist's, and every .blend that ships with Blender.

`python -m bench.parity.real_files room bedroom ANSWER.json PICTURE.jpg`, or `file PATH` in place of `room NAME`.
"""

from __future__ import annotations

import json
import sys
import tempfile
import time
import warnings
from pathlib import Path
from typing import Any

import bpy
import numpy as np

from tests.blender.state import differences, file_state
from tools.package import load_package

from . import cycles, pictures, rooms
from .cycles import Floats
from .measure import processor_seconds

WIDTH, HEIGHT = 320, 200

# Few, and denoised: so do the pictures of `tools.blend_rooms`, for the same reason.
SAMPLES = 256

FACTORY = "factory settings"

# Parts of a file's state that Restore brings back; the report of the bake stays, on purpose.
KEPT = ("objects", "meshes", "materials", "collections", "other")


def measure_room(name: str, picture: Path) -> dict[str, Any]:
    """Return the row of a room: it is built, saved, opened again, rendered, baked, shown and restored."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / f"{name}.blend"
        bpy.ops.wm.read_factory_settings(use_empty=True)
        rooms.module_of(name).build()
        bpy.ops.wm.save_as_mainfile(filepath=str(path))
        bpy.ops.wm.open_mainfile(filepath=str(path))
        before = path.read_bytes()
        row = measured(picture)
        row["file_changed"] = path.read_bytes() != before
    return {"topic": "rooms", "title": rooms.title_of(name), **row}


def measure_file(path: str, picture: Path) -> dict[str, Any]:
    """Return the row of a .blend, or of the scene that Blender starts with."""
    if path == FACTORY:
        bpy.ops.wm.read_factory_settings()
        row = measured(picture)
    else:
        bpy.ops.wm.open_mainfile(filepath=path)
        before = Path(path).read_bytes()
        row = measured(picture)
        row["file_changed"] = Path(path).read_bytes() != before
    return {"topic": "files", "title": title_of(path), **row}


def title_of(path: str) -> str:
    """Return the end of a path, which tells the file."""
    return "The scene that Blender starts with" if path == FACTORY else "/".join(Path(path).parts[-2:])


def shipped_files() -> list[str]:
    """Return every .blend that ships with Blender."""
    return [FACTORY, *sorted(str(path) for path in Path(bpy.utils.resource_path("LOCAL")).rglob("*.blend"))]


def measured(picture: Path) -> dict[str, Any]:
    """Bake everything that renders in the open file, compare it with Cycles in a picture, and put it back."""
    from radiosity_bake.operators.participants import rendered_objects
    from radiosity_bake.operators.targets import shows_surfaces

    view_layer = bpy.context.view_layer
    things = sorted((thing for thing in rendered_objects(view_layer) if shows_surfaces(thing)), key=lambda t: t.name)
    row: dict[str, Any] = {"objects": len(things), "blender": bpy.app.version_string, "warnings": [], "picture": None}
    if not things:
        return {**row, "said": "Nothing in it renders as faces"}
    seen = bpy.context.scene.camera is not None
    theirs, again = (cycles.picture(WIDTH, HEIGHT, True, SAMPLES, seed) if seen else None for seed in (0, 1))
    cycles.select(things)
    before = state()
    # As it looks in the end: light in vertices, colours from the materials' own textures.
    bpy.context.scene.radiosity.material = "TEXTURED"
    try:
        start, used = time.perf_counter(), processor_seconds()
        bpy.ops.radiosity.bake()
        row["seconds"] = round(time.perf_counter() - start, 2)
        row["processor_seconds"] = round(processor_seconds() - used, 2)
    except RuntimeError as error:
        if "Traceback" in str(error):
            raise  # no sentence for the user, but a mistake of ours
        return {**row, "said": str(error).strip().removeprefix("Error: "), "left": differences(before, state())[:5]}
    report = json.loads(bpy.context.scene.radiosity.report)
    row |= {key: report[key] for key in ("vertices", "warnings")}
    row["brightest"] = max(brightness(thing) for thing in view_layer.objects if "Radiosity" in colours(thing))
    ours = cycles.picture(WIDTH, HEIGHT, False) if theirs is not None else None
    bpy.ops.radiosity.restore()
    row["left"] = differences(before, state())[:5]
    if theirs is not None and again is not None and ours is not None:
        pictures.write(picture, theirs, ours)
        noise = likeness(theirs, again)["picture_difference"] / np.sqrt(2.0)
        row |= {"picture": picture.name, **likeness(theirs, ours), "picture_noise": round(float(noise), 4)}
    return row


def state() -> dict[str, Any]:
    """Return what Restore has to bring back, as plain data."""
    found = file_state()
    return {name: found[name] for name in KEPT}


def colours(thing: Any) -> Any:
    """Return the colour attributes of an object, none if it cannot have any."""
    return getattr(thing.data, "color_attributes", ()) if thing.data is not None else ()


def brightness(thing: Any) -> float:
    """Return the largest baked value of an object."""
    return float(cycles.corner_colours(thing.data, "Radiosity").max(initial=0.0))


def likeness(theirs: Floats, ours: Floats) -> dict[str, float]:
    """Return how far our picture is from Cycles': of display values, root mean square and mean."""
    first, second = pictures.exposed(theirs, ours)
    return {
        "picture_difference": round(float(np.sqrt(np.mean((second - first) ** 2))), 4),
        "picture_difference_of_mean": round(float(np.mean(second - first)), 4),
    }


def main(kind: str, name: str, answer: str, picture: str) -> None:
    """Measure one file and write its row."""
    warnings.simplefilter("ignore", DeprecationWarning)
    load_package().register()
    row = (measure_room if kind == "room" else measure_file)(name, Path(picture))
    Path(answer).write_text(json.dumps(row), encoding="utf-8")


if __name__ == "__main__":
    main(*sys.argv[1:])
