# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""One row, in a process of its own: `python -m bench.parity.measure CASE ANSWER.json PICTURE.jpg`."""

from __future__ import annotations

import json
import os
import sys
import warnings
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import bpy
import numpy as np

from tools.package import load_package

from . import cycles, pictures
from .cases import Case, all_cases
from .cycles import Floats

WIDTH, HEIGHT = 320, 240

# Metres within which a vertex of a refined mesh is one of the original's.
SAME_PLACE = 1e-5


def measure(case: Case, picture: Path) -> dict[str, Any]:
    """Return the row of a case, and write its pictures if its scene has a camera."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    things = case.build()
    bpy.context.view_layer.update()
    used = processor_seconds()
    part = case.settings.get("light", "ALL")
    theirs = [cycles.light(things, case.quantity, case.samples, seed, part) for seed in (0, 1)]
    cycles_seconds = processor_seconds() - used
    seen = cycles.picture(WIDTH, HEIGHT, True) if bpy.context.scene.camera else None
    used = processor_seconds()
    ours, report = our_light(things, case)
    our_seconds = processor_seconds() - used
    if seen is not None:
        shown = our_picture(case)
        pictures.write(picture, seen, shown)
    backs = case.quantity.endswith("Back")
    found = compared(things, ours, *theirs, backs)
    if case.faces:
        one, other = pictures.exposed(seen, shown)
        found["picture_difference"] = round(root_mean_square(one - other), 5)
    return {
        "topic": case.topic,
        "title": case.title,
        "quantity": case.quantity,
        **found,
        **({"note": case.note} if case.note else {}),
        "samples": case.samples,
        "processor_seconds": {"cycles": round(cycles_seconds, 2), "ours": round(our_seconds, 2)},
        "warnings": report["warnings"],
        "picture": picture.name if seen is not None else None,
        "blender": bpy.app.version_string,
    }


def processor_seconds() -> float:
    """Return what this process has used of the processors."""
    return sum(os.times()[:2])


def our_light(things: Sequence[Any], case: Case) -> tuple[list[Floats], dict[str, Any]]:
    """Bake the objects with our operator and return (c, 3) the colours at their own face corners, and the report."""
    settings = bpy.context.scene.radiosity
    settings.output = "ORIGINAL"
    for name, value in case.settings.items():
        setattr(settings, name, value)
    cycles.select(things)
    if case.ours is not None:
        return case.ours(list(things)), json.loads(settings.report)
    if bpy.ops.radiosity.bake() != {"FINISHED"}:
        raise RuntimeError("The bake did not finish")
    report = json.loads(settings.report)
    if settings.output == "ORIGINAL":
        return [cycles.corner_colours(thing.data, case.quantity) for thing in things], report
    refined = {obj.radiosity.source: obj for obj in bpy.context.scene.objects if obj.radiosity.source}
    return [at_own_corners(thing, refined[thing], case.quantity) for thing in things], report


def at_own_corners(thing: Any, refined: Any, quantity: str) -> Floats:
    """Return (c, 3) the colours of a refined object at the vertices that the original has, by face corner."""
    place, colours = positions(refined), cycles.corner_colours(refined.data, quantity)
    corner = place[cycles.vertex_of_corner(refined.data)]
    values = np.empty((len(thing.data.vertices), 3))
    for vertex, point in enumerate(positions(thing)):
        near = np.abs(corner - point).max(axis=1) < SAME_PLACE
        values[vertex] = colours[near].mean(axis=0)
    return values[cycles.vertex_of_corner(thing.data)]


def positions(thing: Any) -> Floats:
    """Return (v, 3) the vertices in the world."""
    local = np.empty(3 * len(thing.data.vertices), dtype=np.float32)
    thing.data.vertices.foreach_get("co", local)
    matrix = np.array(thing.matrix_world)
    placed: Floats = local.reshape(-1, 3) @ matrix[:3, :3].T + matrix[:3, 3]
    return placed


def our_picture(case: Case) -> Floats:
    """Bake everything that can be baked to refined meshes and return what the camera sees of it."""
    from radiosity_bake.operators.targets import shows_surfaces

    bpy.context.scene.radiosity.output = "REFINED"
    shown = [obj for obj in bpy.context.view_layer.objects if shows_surfaces(obj) and not obj.hide_render]
    cycles.select(shown)
    bpy.ops.radiosity.bake()
    return cycles.picture(WIDTH, HEIGHT, False)


def compared(
    things: Sequence[Any], ours: Sequence[Floats], first: Sequence[Floats], second: Sequence[Floats], backs: bool
) -> dict[str, Any]:
    """Return how far our colours are from Cycles', relative to the root mean square of Cycles' light.

    Values of the face corners of one vertex that face one way are averaged. Vertices at the rim of a mesh and on its
    creases are left out of `difference`: there our light is gathered a little inside of the face, on purpose, and
    Cycles' rays start on the very edge. `difference_with_rims` has them.
    """
    a, b, c, inside = [], [], [], []
    for thing, *colours in zip(things, ours, first, second, strict=True):
        point_of_corner, judged = points(thing.data)
        # Cycles bakes the turned mesh, whose faces run through their corners the other way round.
        order = np.arange(len(point_of_corner))
        if backs:
            order = turned_corners(thing.data)
        count = np.bincount(point_of_corner)
        for found, corner_colours in zip((a, b, c), (colours[0], colours[1][order], colours[2][order]), strict=True):
            found.append(
                np.stack([np.bincount(point_of_corner, corner_colours[:, k]) / count for k in range(3)], axis=1)
            )
        inside.append(judged)
    own, one, two, judged = (np.concatenate(parts) for parts in (a, b, c, inside))
    reference = (one + two) / 2.0
    if not judged.any():
        judged[:] = True
    strength = max(root_mean_square(reference[judged]), 1e-12)
    difference = root_mean_square((own - reference)[judged]) / strength
    noise = root_mean_square((one - two)[judged]) / 2.0 / strength
    everywhere = root_mean_square(own - reference) / max(root_mean_square(reference), 1e-12)
    return {
        "points": int(judged.sum()),
        "cycles": [round(float(x), 6) for x in reference[judged].mean(axis=0)],
        "ours": [round(float(x), 6) for x in own[judged].mean(axis=0)],
        "difference_of_mean": round(float((own - reference)[judged].mean()) / strength, 5),
        "difference": round(difference, 5),
        "difference_with_rims": round(everywhere, 5),
        "noise": round(noise, 5),
    }


def root_mean_square(values: Floats) -> float:
    """Return the root of the mean of the squares."""
    return float(np.sqrt(np.mean(values**2)))


def points(mesh: Any) -> tuple[np.ndarray, np.ndarray]:
    """Return (c,) the point of each face corner, and (p,) whether a point is neither on the rim nor on a crease.

    Corners of one vertex whose normals agree are one point.
    """
    vertex = cycles.vertex_of_corner(mesh)
    normals = np.empty(3 * len(mesh.loops), dtype=np.float32)
    mesh.corner_normals.foreach_get("vector", normals)
    keys = np.column_stack([vertex, np.round(normals.reshape(-1, 3), 3)])
    kinds, of_corner = np.unique(keys, axis=0, return_inverse=True)
    vertex_of_point = kinds[:, 0].astype(int)
    edges = np.empty(len(mesh.loops), dtype=np.int32)
    mesh.loops.foreach_get("edge_index", edges)
    ends = np.empty(2 * len(mesh.edges), dtype=np.int32)
    mesh.edges.foreach_get("vertices", ends)
    on_rim = np.zeros(len(mesh.vertices), dtype=bool)
    on_rim[ends.reshape(-1, 2)[np.bincount(edges, minlength=len(mesh.edges)) < 2].ravel()] = True
    creased = np.bincount(vertex_of_point, minlength=len(mesh.vertices)) > 1
    return of_corner.ravel(), ~(on_rim | creased)[vertex_of_point]


def turned_corners(mesh: Any) -> np.ndarray:
    """Return (c,) where each face corner is found in the mesh turned over."""
    turned = mesh.copy()
    turned.flip_normals()
    before, after = cycles.vertex_of_corner(mesh), cycles.vertex_of_corner(turned)
    bpy.data.meshes.remove(turned)
    order = np.empty(len(before), dtype=np.int64)
    for face in mesh.polygons:
        part = slice(face.loop_start, face.loop_start + face.loop_total)
        found = {vertex: face.loop_start + k for k, vertex in enumerate(after[part])}
        order[part] = [found[vertex] for vertex in before[part]]
    return order


def main(name: str, answer: str, picture: str) -> None:
    """Measure one case and write its row."""
    # Blender 5 tells of properties that go away in 6.
    warnings.simplefilter("ignore", DeprecationWarning)
    load_package().register()
    Path(answer).write_text(json.dumps(measure(all_cases()[name], Path(picture))), encoding="utf-8")


if __name__ == "__main__":
    main(*sys.argv[1:])
