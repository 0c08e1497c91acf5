# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Drivers that fail: what they drive stays as it was, and is not what the artist made it to be."""

from collections.abc import Iterable, Iterator

import bpy


def failing_drivers(objects: Iterable[bpy.types.Object], others: Iterable[bpy.types.ID | None]) -> list[str]:
    """Return a sentence for each datablock that has some: of `objects`, of what they are made of, and of `others`."""
    owners = dict.fromkeys(owner for obj in sorted(objects, key=lambda obj: obj.name) for owner in _parts(obj))
    owners.update(dict.fromkeys(owner for other in others if other is not None for owner in _with_nodes(other)))
    sentences = []
    for owner in owners:
        animation = getattr(owner, "animation_data", None)
        paths = [curve.data_path for curve in animation.drivers if not curve.driver.is_valid] if animation else []
        if paths:
            names = ", ".join(dict.fromkeys(paths))
            sentences.append(f'"{owner.name}" has drivers that fail ({names}): what they drive was taken as it is')
    return sentences


def _parts(obj: bpy.types.Object) -> Iterator[bpy.types.ID]:
    yield obj
    if obj.data is not None:
        yield from _with_nodes(obj.data)
        keys = getattr(obj.data, "shape_keys", None)
        if keys is not None:
            yield keys
    for slot in obj.material_slots:
        if slot.material is not None:
            yield from _with_nodes(slot.material)


def _with_nodes(owner: bpy.types.ID) -> Iterator[bpy.types.ID]:
    yield owner
    tree = getattr(owner, "node_tree", None)
    if tree is not None:
        yield tree
