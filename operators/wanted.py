# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Which of the objects asked for can be baked, and why the others cannot."""

from collections.abc import Iterable
from dataclasses import dataclass

import bpy

from .naming import named
from .record import source_of
from .scene_reader import UNSUPPORTED_TYPES, SceneReader
from .targets import shows_surfaces


@dataclass(frozen=True, eq=False)
class Reason:
    """Why an object cannot be baked, to follow "it" and several names."""

    singular: str
    plural: str


_NOTHING_TO_COLOUR = Reason("is not a mesh", "are not meshes")
"""Of lamps, cameras, empties and the like, which are selected along with meshes and nobody takes for such."""
_NOT_A_MESH = Reason("is not a mesh", "are not meshes")
_LINKED = Reason(
    "is linked from another file; Refined Mesh bakes it, or make it local",
    "are linked from another file; Refined Mesh bakes them, or make them local",
)
_OF_LINKED_COLLECTION = Reason(
    "is in a collection that is linked from another file; make a library override of it to bake it",
    "are in collections that are linked from another file; make library overrides of them to bake them",
)
_WITHOUT_A_MESH = Reason(
    "has no mesh of its own; Refined Mesh bakes it",
    "have no meshes of their own; Refined Mesh bakes them",
)
_WITHOUT_FACES = Reason("has no faces", "have no faces")
_CLEAR = Reason("is transparent all over", "are transparent all over")
_NOT_RECEIVING = Reason("does not receive light by its own settings", "do not receive light by their own settings")
_NOT_RENDERED = Reason("is not shown in renders", "are not shown in renders")


def wanted_objects(
    scene: bpy.types.Scene,
    objects: Iterable[bpy.types.Object],
    output: str,
    skipped: dict[Reason, list[str]],
) -> list[bpy.types.Object]:
    """Return those of `objects` that can be baked to an output; the others are put down as `skipped`, by the reason."""
    wanted = []
    linked_collections = {collection for collection in scene.collection.children_recursive if collection.library}
    for obj in dict.fromkeys(_that_makes_the_faces(source_of(obj)) for obj in objects):
        if not shows_surfaces(obj):
            why = _NOT_A_MESH if obj.type in UNSUPPORTED_TYPES else _NOTHING_TO_COLOUR
            skipped.setdefault(why, []).append(obj.name)
        elif not obj.radiosity_settings.receives:
            skipped.setdefault(_NOT_RECEIVING, []).append(obj.name)
        elif obj.library is not None and output == "ORIGINAL":
            skipped.setdefault(_LINKED, []).append(obj.name)
        elif obj.library is not None and linked_collections.intersection(obj.users_collection):
            skipped.setdefault(_OF_LINKED_COLLECTION, []).append(obj.name)
        elif output == "ORIGINAL" and obj.type != "MESH":
            skipped.setdefault(_WITHOUT_A_MESH, []).append(obj.name)
        else:
            wanted.append(obj)
    return wanted


def _that_makes_the_faces(obj: bpy.types.Object) -> bpy.types.Object:
    """Return the object whose mesh shows `obj`: of metaballs whose names differ in the number alone, the first."""
    if obj.type != "META":
        return obj
    family = [other for other in bpy.data.objects if other.type == "META" and _stem(other.name) == _stem(obj.name)]
    return min((other for other in family if set(other.users_scene) & set(obj.users_scene)), key=_number, default=obj)


def _stem(name: str) -> str:
    stem, _, number = name.rpartition(".")
    return stem if number.isdigit() else name


def _number(obj: bpy.types.Object) -> int:
    return int(obj.name.rpartition(".")[2]) if _stem(obj.name) != obj.name else -1


def skip_missing(wanted: list[bpy.types.Object], reader: SceneReader, skipped: dict[Reason, list[str]]) -> None:
    """Put down as `skipped` what was wanted and not read."""
    found = {target.uid for target in reader.targets}
    for obj in wanted:
        if obj.session_uid not in found:
            why = _WITHOUT_FACES if obj in reader.shown else _NOT_RENDERED
            why = _CLEAR if obj in reader.clear else why
            skipped.setdefault(why, []).append(obj.name)


def nothing_to_bake(skipped: dict[Reason, list[str]]) -> str:
    """Return why nothing can be baked."""
    if not skipped:
        return "Select the meshes to bake"
    # What nobody takes for a mesh is told only if there was nothing else.
    skipped = {why: names for why, names in skipped.items() if why is not _NOTHING_TO_COLOUR} or skipped
    clauses = [f"{named(names)} {why.singular if len(names) == 1 else why.plural}" for why, names in skipped.items()]
    return f"None of the selected objects can be baked: {', and '.join(clauses)}"


def skipped_sentences(skipped: dict[Reason, list[str]]) -> list[str]:
    """Return a sentence for each reason for which something that could have been meant was not baked."""
    return [
        f"{named(names)} {'was skipped: it' if len(names) == 1 else 'were skipped: they'} "
        f"{why.singular if len(names) == 1 else why.plural}"
        for why, names in skipped.items()
        if why is not _NOTHING_TO_COLOUR
    ]
