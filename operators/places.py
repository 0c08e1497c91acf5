# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Where refined objects are now: artists move what they see, and the hidden originals have to follow."""

from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager

import bpy
import numpy as np

from .changes import link
from .journal import Journal
from .likeness import take_animation, take_constraints
from .record import is_output, source_of

_PARENTING = ("parent", "parent_type", "parent_bone", "parent_vertices")
_CHANNELS = (
    "matrix_parent_inverse",
    "rotation_mode",
    "location",
    "rotation_euler",
    "rotation_quaternion",
    "rotation_axis_angle",
    "scale",
    "delta_location",
    "delta_rotation_euler",
    "delta_rotation_quaternion",
    "delta_scale",
)


def same_place(first: object, second: object) -> bool:
    """Return whether two matrices are the same to single precision."""
    return bool(np.allclose(np.array(first), np.array(second), rtol=1e-5, atol=1e-6))


Outputs = Mapping[bpy.types.Object, list[bpy.types.Object]]
"""The refined meshes that stand in a scene for each source."""


def outputs_by_source() -> Outputs:
    """Return the refined meshes that stand in a scene for each source: one, or more if the user duplicated it."""
    found: dict[bpy.types.Object, list[bpy.types.Object]] = {}
    for obj in bpy.data.objects:
        if is_output(obj) and obj.users_scene:
            found.setdefault(obj.radiosity.source, []).append(obj)
    return found


@contextmanager
def sources_shown(outputs: Outputs) -> Iterator[None]:
    """Have originals that were deleted from their scene back in it for a while."""
    journal = Journal()
    try:
        for source, of_source in outputs.items():
            show_again(source, of_source, journal)
        yield
    finally:
        journal.take_back()


@contextmanager
def sources_in_place(outputs: Outputs, view_layer: bpy.types.ViewLayer) -> Iterator[None]:
    """Have originals stand for a while where their refined objects are seen; they must be visible."""
    journal = Journal()
    try:
        moved = [follow(source, of_source, journal) for source, of_source in outputs.items()]
        if any(moved):
            view_layer.update()
        yield
    finally:
        journal.take_back()
        if any(moved):
            view_layer.update()


def homes_of(source: bpy.types.Object, scene: bpy.types.Scene) -> list[bpy.types.Collection]:
    """Return the collections that can hold a refined object of `source`: its own, or the next above in the scene.

    Nothing can be put into a collection of another file, nor into a library override of one.
    """
    above: dict[bpy.types.Collection, list[bpy.types.Collection]] = {}
    for parent in (scene.collection, *scene.collection.children_recursive):
        for child in parent.children:
            above.setdefault(child, []).append(parent)
    found: dict[bpy.types.Collection, None] = {}
    pending = [collection for collection in source.users_collection if collection.library is None]
    while pending:
        collection = pending.pop(0)
        if collection.library is None and collection.override_library is None:
            found[collection] = None
        else:
            pending.extend(above.get(collection, ()))
    return list(found)


def remember_place(output: bpy.types.Object) -> None:
    """Remember where a new refined object is, to tell later whether it was moved."""
    output.radiosity.place = np.array(output.matrix_basis).reshape(-1)


def shows_place(output: bpy.types.Object) -> bool:
    """Return whether a refined object has its original's transform; one that was flattened is in world space."""
    return output.radiosity.is_property_set("place")


def follow(source: bpy.types.Object, outputs: Iterable[bpy.types.Object], journal: Journal) -> bool:
    """Give `source` the transform of its refined object, and the parent, if that was moved since the bake; say if so.

    A copy that was moved away from a refined object which was not is no move. What is animated stays where the
    animation puts it. What the refined object was animated or constrained by since, `source` is by then, too.
    """
    outputs = list(outputs)
    was_animated = is_animated(source)
    taken = len(outputs) == 1 and _take_what_moves(source, outputs[0], journal)
    if was_animated or not outputs or not all(_was_moved(output, source) for output in outputs):
        return taken
    if not taken and is_animated(outputs[0]):
        return False
    journal.on_failure(_set_transform, source, _transform(source))
    stand_in_place(source, outputs[0])
    return True


def stand_in_place(source: bpy.types.Object, output: bpy.types.Object) -> None:
    """Give an original, or a copy of it, the transform and the parent of a refined object."""
    if not shows_place(output):
        # Its mesh is in world space, and it is where it was moved from there.
        source.matrix_world = output.matrix_world @ source.matrix_world
        return
    values = _transform(output)
    values["parent"] = _original_parent(source, output)
    if is_bent_by_parent(source) and values["parent"] == source.parent:
        values["parent_type"] = source.parent_type
    _set_transform(source, values)


def _original_parent(source: bpy.types.Object, output: bpy.types.Object) -> bpy.types.Object | None:
    """Return the parent of a refined object as `source` can have it: an original, unless that hangs on `source`."""
    if output.parent is None:
        return None
    parent = source_of(output.parent)
    return output.parent if source in {parent, *_ancestors(parent)} else parent


def _ancestors(obj: bpy.types.Object) -> Iterator[bpy.types.Object]:
    while obj.parent is not None:
        obj = obj.parent
        yield obj


def hang_together(outputs: Outputs, journal: Journal) -> None:
    """Have refined objects hang on that of their original's parent, so that what is seen moves as it did."""
    for source, of_source in outputs.items():
        for output in of_source:
            parent = outputs.get(output.parent, ())
            if output.parent_type != "OBJECT" or len(parent) != 1 or not shows_place(parent[0]):
                continue
            if output in {parent[0], *_ancestors(parent[0])} or source.library is not None:
                continue
            before = _transform(output)
            journal.on_failure(_set_transform, output, before)
            _set_transform(output, before | {"parent": parent[0]})


def _take_what_moves(source: bpy.types.Object, output: bpy.types.Object, journal: Journal) -> bool:
    """Give `source` the constraints of its refined object that it lacks, an animation if it has none; say if so."""
    if source.library is not None or not shows_place(output):
        return False
    taken = take_constraints(source, output, journal)
    if is_animated(output) and not is_animated(source) and not output.animation_data.nla_tracks:
        take_animation(source, output, journal)
        return True
    return taken


def take_transform(output: bpy.types.Object, source: bpy.types.Object, journal: Journal) -> None:
    """Have a refined object stand where its original is, by the same parent, animation and constraints."""
    values = _transform(source)
    if is_bent_by_parent(source):
        values["parent_type"] = "OBJECT"
    journal.on_failure(_set_transform, output, _transform(output))
    _set_transform(output, values)
    take_constraints(output, source, journal)
    if is_animated(source):
        take_animation(output, source, journal)
    journal.set(output.radiosity, "place", tuple(output.radiosity.place))
    remember_place(output)


def follow_collections(source: bpy.types.Object, output: bpy.types.Object, journal: Journal) -> None:
    """Move `source` into the collections that the artist moved its refined object to."""
    scenes = output.users_scene
    if source.library is not None or not scenes:
        return
    before, now = homes_of(source, scenes[0]), output.users_collection
    for collection in now:
        if collection not in before and source.name_full not in {obj.name_full for obj in collection.objects}:
            link(source, collection, journal)
    for collection in source.users_collection:
        if collection in before and collection not in now:
            journal.on_failure(collection.objects.link, source)
            collection.objects.unlink(source)


def is_bent_by_parent(obj: bpy.types.Object) -> bool:
    """Return whether the parent of `obj` bends its mesh; a refined mesh is bent already."""
    return obj.parent_type in {"ARMATURE", "LATTICE"}


def show_again(source: bpy.types.Object, outputs: Iterable[bpy.types.Object], journal: Journal) -> None:
    """Put `source` beside its refined objects if it is in no scene, where only our pointer keeps it.

    It was deleted, or is of another file and can be hidden in no other way.
    """
    if source.library is None and source.users_collection:
        return
    for collection in {collection for output in outputs for collection in output.users_collection}:
        if source.name_full not in {obj.name_full for obj in collection.objects}:
            link(source, collection, journal)


def take_out(source: bpy.types.Object, journal: Journal) -> None:
    """Take `source`, of another file, out of the scenes of this one: nothing of it may be written."""
    for collection in source.users_collection:
        if collection.library is None:
            journal.on_failure(collection.objects.link, source)
            collection.objects.unlink(source)


def _was_moved(output: bpy.types.Object, source: bpy.types.Object) -> bool:
    if source.library is not None or not shows_place(output):
        return False
    if _parent_meant(output) != _parent_meant(source):
        return True
    if not same_place(output.matrix_parent_inverse, source.matrix_parent_inverse):
        return True
    return not same_place(np.array(output.radiosity.place).reshape(4, 4), output.matrix_basis)


def _parent_meant(obj: bpy.types.Object) -> bpy.types.Object | None:
    return None if obj.parent is None else source_of(obj.parent)


def is_animated(obj: bpy.types.Object) -> bool:
    """Return whether anything of `obj` is keyed or driven."""
    animation = obj.animation_data
    return animation is not None and bool(animation.action or len(animation.drivers) or len(animation.nla_tracks))


def _transform(obj: bpy.types.Object) -> dict[str, object]:
    values = {name: getattr(obj, name) for name in (*_PARENTING, *_CHANNELS)}
    # Blender hands out vectors and matrices that change with the object.
    return {
        name: value.copy() if hasattr(value, "copy") and name in _CHANNELS else value for name, value in values.items()
    } | {name: tuple(values[name]) for name in ("parent_vertices", "rotation_axis_angle")}


def _set_transform(obj: bpy.types.Object, values: dict[str, object]) -> None:
    for name, value in values.items():
        if getattr(obj, name) != value:
            setattr(obj, name, value)
