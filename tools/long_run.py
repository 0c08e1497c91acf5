# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Bake again and again in one process, and tell whether memory or data blocks grow.

    .venv/main/bin/python -m tools.long_run               two hundred bakes
    .venv/main/bin/python -m tools.long_run --bakes 1000  as many as that
    .venv/main/bin/python -m tools.long_run --evaluated   with a procedural texture, which Cycles evaluates

A turn bakes a small room in every way: refined, refined again, relit, in place, with light groups, in bytes, with
textures, over frames, to an error, to a cancelled end; then everything is restored. After each turn there must be as
many data blocks as before the first, and as much of Python's objects as after the turn before; memory may grow by no
more than `ALLOWED_GROWTH`. What Cycles evaluates is left out of the default: each bake of `bpy.ops.object.bake` takes a
few kilobytes that Blender itself does not give back.
"""

from __future__ import annotations

import argparse
import ctypes
import gc
import sys
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

import bpy
import numpy as np

from .package import load_package

PAGE_BYTES = 4096
TURNS_TO_WARM_UP = 3
"""Turns whose memory is not counted: modules are imported, pools of memory filled."""
ALLOWED_GROWTH = 4096.0
"""Bytes a bake: a page. What one bake of this room keeps for a relight is hundreds of times that."""
ALLOWED_OBJECTS = 2.0
"""Objects a turn: what is noted of the turn itself."""


@dataclass(frozen=True)
class Turn:
    """What there was after one turn.

    Attributes
    ----------
    bakes : int
        Bakes so far.
    resident : int
        Memory of the process, bytes.
    python_objects : int
        Lists, dictionaries, instances and whatever else of Python's can hold others.
    datablocks : dict of str to int
        How many there are of each kind.
    """

    bakes: int
    resident: int
    python_objects: int
    datablocks: dict[str, int]


def make_room(evaluated: bool = False) -> list[bpy.types.Object]:
    """Make a floor with a texture, two shelves of one mesh, procedural if asked, and lamps; no camera."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    image = bpy.data.images.new("Boards", 8, 8)
    image.pixels.foreach_set(np.random.default_rng(0).random(8 * 8 * 4, dtype=np.float32))
    floor = _square("Floor", 3.0, 0.0, _material("Boards", "ShaderNodeTexImage", image))
    shelf = _square("Shelf", 0.8, 1.0, _material("Marble", "ShaderNodeTexNoise" if evaluated else "ShaderNodeRGB"))
    twin = bpy.data.objects.new("Twin", shelf.data)
    twin.location = (0.6, -1.2, 0.4)
    bpy.context.scene.collection.objects.link(twin)
    for name, group, colour in (("Lamp", "Ceiling", (1.0, 0.2, 0.2)), ("Candle", "Table", (0.2, 0.2, 1.0))):
        data = bpy.data.lights.new(name, "POINT")
        data.energy, data.color = 60.0, colour
        lamp = bpy.data.objects.new(name, data)
        lamp.location = (0.4, 0.3 if group == "Table" else -0.6, 2.5)
        bpy.context.scene.collection.objects.link(lamp)
        bpy.context.view_layer.lightgroups.add(name=group)
        lamp.lightgroup = group
    scene = bpy.context.scene
    scene.frame_start, scene.frame_end = 1, 2
    light = bpy.data.lights["Candle"]
    for frame in (1, 2):
        light.energy = 30.0 * frame
        light.keyframe_insert("energy", frame=frame)
    settings = scene.radiosity
    settings.quality, settings.minimum_size, settings.threads = "DRAFT", 0.5, 1
    return [floor, shelf, twin]


def _square(name: str, size: float, height: float, material: bpy.types.Material) -> bpy.types.Object:
    mesh = bpy.data.meshes.new(name)
    half = 0.5 * size
    mesh.from_pydata([(-half, -half, 0), (half, -half, 0), (half, half, 0), (-half, half, 0)], [], [(0, 1, 2, 3)])
    mesh.uv_layers.new(name="UVMap")
    mesh.materials.append(material)
    obj = bpy.data.objects.new(name, mesh)
    obj.location.z = height
    bpy.context.scene.collection.objects.link(obj)
    return obj


def _material(name: str, texture: str, image: bpy.types.Image | None = None) -> bpy.types.Material:
    """Return a material whose diffuse colour comes out of a texture."""
    material = bpy.data.materials.new(name)
    if bpy.app.version < (5, 0, 0):
        material.use_nodes = True
    nodes, links = material.node_tree.nodes, material.node_tree.links
    nodes.clear()
    colour, shader = nodes.new(texture), nodes.new("ShaderNodeBsdfDiffuse")
    if image is not None:
        colour.image = image
    links.new(next(each for each in colour.outputs if each.type == "RGBA"), shader.inputs["Color"])
    links.new(shader.outputs[0], nodes.new("ShaderNodeOutputMaterial").inputs["Surface"])
    return material


def _select(objects: Sequence[bpy.types.Object]) -> None:
    """Select what stands for the objects now: themselves, or their refined meshes."""
    bpy.context.view_layer.update()
    for obj in bpy.context.view_layer.objects:
        shown = obj.radiosity.source if obj.radiosity.kind == "OUTPUT" else obj
        obj.select_set(shown in objects and obj.visible_get())


def _baked(**settings: object) -> Callable[[], None]:
    def bake() -> None:
        for name, value in settings.items():
            setattr(bpy.context.scene.radiosity, name, value)
        _must(bpy.ops.radiosity.bake())
        for name in settings:
            bpy.context.scene.radiosity.property_unset(name)

    return bake


def _relit() -> None:
    _baked()()
    light = bpy.data.lights["Lamp"]
    light.color = tuple(light.color)[::-1]
    _must(bpy.ops.radiosity.relight())


def _frames(output: str) -> Callable[[], None]:
    def bake() -> None:
        bpy.context.scene.radiosity.output = output
        _must(bpy.ops.radiosity.bake_frames())
        bpy.context.scene.radiosity.property_unset("output")

    return bake


def _restored() -> None:
    _must(bpy.ops.radiosity.restore())


def _failed() -> None:
    """Bake a scene without light, which is refused when all of it was read."""
    lamps = [obj for obj in bpy.context.scene.objects if obj.type == "LIGHT"]
    for lamp in lamps:
        lamp.hide_render = True
    try:
        bpy.ops.radiosity.bake()
    except RuntimeError as error:
        if "emits light" not in str(error):
            raise
    else:
        raise AssertionError("a bake without light ended well")
    finally:
        for lamp in lamps:
            lamp.hide_render = False


def _cancelled() -> None:
    """Cancel a bake in its middle, which leaves what is baked as it is."""
    package = load_package()
    told = []

    def stop(message: object) -> None:
        told.append(message)
        if len(told) > 5:
            raise package.core.errors.Cancelled

    settings = package.operators.settings.bake_settings(bpy.context.scene.radiosity)
    try:
        package.operators.bake.bake_objects(bpy.context, bpy.context.selected_objects, settings, stop)
    except package.core.errors.Cancelled:
        return
    raise AssertionError("a cancelled bake ended well")


def _must(state: set[str]) -> None:
    if state != {"FINISHED"}:
        raise AssertionError(f"an operator ended with {state}")


WAYS: tuple[Callable[[], None], ...] = (
    _baked(),
    _baked(material="PLAIN"),
    _relit,
    _cancelled,
    _baked(output="ORIGINAL"),
    _relit,
    _baked(output="ORIGINAL", data_type="BYTE", domain="POINT", prefix="low_"),
    _failed,
    _baked(light_groups=True, light="DIRECT"),
    _restored,
    _frames("REFINED"),
    _frames("ORIGINAL"),
    _baked(keep_transport=False),
    _restored,
)


def turns(bakes: int, evaluated: bool = False) -> list[Turn]:
    """Bake a room so many times, and return what there was before the first turn and after each."""
    objects = make_room(evaluated)
    seen = [_turn(0)]
    while seen[-1].bakes < bakes:
        for way in WAYS:
            _select(objects)
            way()
        seen.append(_turn(seen[-1].bakes + len(WAYS) - WAYS.count(_restored)))
        print(
            f"{seen[-1].bakes:5} bakes  {seen[-1].resident / 2**20:8.2f} MiB  {seen[-1].python_objects:,} objects",
            flush=True,
        )
    return seen


def _turn(bakes: int) -> Turn:
    gc.collect()
    # What was freed goes back to the system, or the pools of C would hide what grows (glibc).
    ctypes.CDLL(None).malloc_trim(0)
    return Turn(bakes, resident_bytes(), len(gc.get_objects()), datablocks())


def resident_bytes() -> int:
    """Memory of this process that is in use (Linux)."""
    return int(Path("/proc/self/statm").read_text(encoding="ascii").split()[1]) * PAGE_BYTES


def datablocks() -> dict[str, int]:
    """How many data blocks there are of each kind."""
    kinds = {name: getattr(bpy.data, name) for name in dir(bpy.data)}
    collections = {name: kind for name, kind in kinds.items() if isinstance(kind, bpy.types.bpy_prop_collection)}
    return {name: len(kind) for name, kind in collections.items()}


def growth(seen: Sequence[Turn]) -> float:
    """Bytes that a bake leaves in memory: the slope of a line through the turns after the first few.

    It is the median of the slopes between any two (Theil 1950; Sen, J. Am. Stat. Assoc. 63, 1968, eq. 2.1), as single
    turns may take a page or a thousand more than others.
    """
    counted = seen[TURNS_TO_WARM_UP:]
    bakes, bytes_ = (np.array([getattr(turn, name) for turn in counted]) for name in ("bakes", "resident"))
    first, second = np.triu_indices(len(counted), 1)
    return float(np.median((bytes_[second] - bytes_[first]) / (bakes[second] - bakes[first])))


def objects_a_turn(seen: Sequence[Turn]) -> float:
    """Python's objects that a turn leaves in memory, after the first few."""
    first, last = seen[min(TURNS_TO_WARM_UP, len(seen) - 2)], seen[-1]
    return (last.python_objects - first.python_objects) / (len(seen) - 1 - seen.index(first))


def left_behind(seen: Sequence[Turn]) -> dict[str, int]:
    """Return of which kinds there are more data blocks at the end than before, and how many."""
    before, after = seen[0].datablocks, seen[-1].datablocks
    return {name: count - before[name] for name, count in after.items() if count != before[name]}


def main(arguments: Sequence[str]) -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--bakes", type=int, default=200)
    parser.add_argument("--evaluated", action="store_true")
    options = parser.parse_args(arguments)
    load_package().register()
    began = time.process_time()
    seen = turns(options.bakes, options.evaluated)
    slope, left, objects = growth(seen), left_behind(seen), objects_a_turn(seen)
    print(
        f"long run: {seen[-1].bakes} bakes in {time.process_time() - began:.0f} s of processor time, "
        f"{slope:+.0f} bytes a bake, {objects:+.1f} of Python's objects a turn, {left or 'no data block'} left behind"
    )
    return 1 if left or slope > ALLOWED_GROWTH or objects > ALLOWED_OBJECTS else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
