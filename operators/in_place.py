# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Baked values on the meshes that the objects have."""

import re
from collections.abc import Mapping

import bpy
import numpy as np

from ..core.result import BakedMesh
from ..core.scene import Floats
from . import display
from .attributes import Attributes
from .changes import (
    active_attributes,
    remember_active_attributes,
    remember_record,
    remove_attribute,
    rename_attribute,
)
from .colours import AttributeNameError, remove_if_there, write_colours
from .journal import Journal
from .local_mesh import local_mesh
from .record import BAKED_IN_PLACE
from .targets import Target
from .textured import Displays
from .transfer import nearest_corners

_FRAME = re.compile(r"\.(\d{4,}|-\d{3,})$")
"""How the name of an attribute of one frame ends."""

_SAME_NORMAL = 1.0 - 1e-6
"""Cosine between normals above which they are those of one plane, in single precision: 0.08 degrees."""


def check_names(obj: bpy.types.Object, attributes: Attributes) -> None:
    """Refuse an object whose vertex groups have names of ours; only attributes can be renamed for a while.

    Modifiers find vertex groups by name.

    Raises
    ------
    AttributeNameError
    """
    for name in attributes.names():
        if name in obj.vertex_groups:
            raise AttributeNameError(
                f'"{obj.name}" has a vertex group named "{name}", as a baked attribute is named; '
                "rename the vertex group, then bake again"
            )


def keeps_names(obj: bpy.types.Object, attributes: Attributes) -> bool:
    """Return whether `obj` was baked in place and all that it carries of that bake is written anew or a frame's."""
    names = {*attributes.names()}
    written = (remembered.name for remembered in obj.radiosity.attributes)
    return obj.radiosity.kind == BAKED_IN_PLACE and all(name in names or is_of_frame(name) for name in written)


def is_of_frame(name: str) -> bool:
    """Return whether an attribute of ours is that of one frame of a range."""
    return _FRAME.search(name) is not None


def store_in_place(
    obj: bpy.types.Object,
    target: Target,
    baked: BakedMesh,
    attributes: Attributes,
    displays: Displays,
    journal: Journal,
) -> None:
    """Write the values of `baked` on the corners of the mesh of `obj`, and show them."""
    remember_record(obj, journal)
    if obj.radiosity.kind != BAKED_IN_PLACE:
        obj.radiosity.kind = BAKED_IN_PLACE
        _own_mesh(obj, journal)
        obj.radiosity.active_attribute, obj.radiosity.active_color, obj.radiosity.default_color = active_attributes(
            obj.data
        )
    remember_active_attributes(obj.data, journal)
    values = values_in_place(obj.data, target, baked, attributes)
    make_room(obj, values, journal)
    write_colours(obj.data, values, attributes)
    _show(obj, baked.radiosity_back is not None, displays, journal)


def _own_mesh(obj: bpy.types.Object, journal: Journal) -> None:
    """Give `obj` a copy of a mesh that it shares with others or has from another file, and remember that mesh."""
    mesh = obj.data
    of_another_file = mesh.library is not None or mesh.override_library is not None
    if mesh.users - mesh.use_fake_user <= 1 and not of_another_file:
        return
    own = mesh.copy()
    if own.override_library is not None:
        # Attributes of an override are not saved, so the copy must not be one.
        own = own.make_local()
    journal.on_failure(bpy.data.meshes.remove, own)
    obj.radiosity.shared_mesh = mesh
    journal.set(obj, "data", own)


def values_in_place(
    mesh: bpy.types.Mesh, target: Target, baked: BakedMesh, attributes: Attributes
) -> dict[str, Floats | None]:
    """Return the values of a baked mesh for the corners of the object's own mesh, by the name of the attribute."""
    values = attributes.values(baked)
    if target.same_corners:
        return {name: _gather_corners(part, target, len(mesh.loops)) for name, part in values.items()}
    carried = nearest_corners(local_mesh(mesh), target.local, {k: v for k, v in values.items() if v is not None})
    return {name: carried.get(name) for name in values}


def _gather_corners(values: Floats | None, target: Target, count: int) -> Floats | None:
    """Return (c, 3) the mean over the triangles that meet in each face corner; a polygon's corner may have several.

    Those of a flat polygon that is not planar have several normals: there the first counts, as for Cycles' own bake.
    """
    if values is None:
        return None
    corners, normals = target.local.corners.reshape(-1), target.local.normals.reshape(-1, 3)
    _, first, corner = np.unique(corners, return_index=True, return_inverse=True)
    alike = np.flatnonzero(np.einsum("cx,cx->c", normals, normals[first[corner.ravel()]]) > _SAME_NORMAL)
    corners, colours = corners[alike], values.reshape(-1, 3)[alike]
    times = np.maximum(np.bincount(corners, minlength=count), 1)
    sums = [np.bincount(corners, weights=colours[:, k], minlength=count) for k in range(3)]
    return np.stack(sums, axis=1) / times[:, None]


def make_room(obj: bpy.types.Object, values: Mapping[str, Floats | None], journal: Journal) -> None:
    """Clear the names of our attributes: ours of an earlier bake go, a user's are renamed aside and remembered."""
    mesh, record = obj.data, obj.radiosity
    # Backwards, so that taking it back makes them in their order.
    for name, colours in reversed(list(values.items())):
        ours = name in record.attributes
        if ours and name in mesh.color_attributes:
            remove_attribute(mesh, name, journal)
        elif name in mesh.attributes:
            aside = rename_attribute(mesh, name, f"{name} (before bake)", journal)
            (record.attributes[name] if ours else _remember(record, name)).aside = aside
            ours = True
        if colours is not None:
            if not ours:
                _remember(record, name)
            journal.on_failure(remove_if_there, mesh, name)


def _remember(record, name: str):
    remembered = record.attributes.add()
    remembered.name = name
    return remembered


def _show(obj: bpy.types.Object, both_sides: bool, displays: Displays, journal: Journal) -> None:
    """Put display materials in all slots, remembering what was there."""
    record = obj.radiosity
    if not obj.material_slots:
        obj.data.materials.append(displays.of(None, both_sides))
        journal.on_failure(obj.data.materials.clear)
        record.slot_added = True
        return
    for index, slot in enumerate(obj.material_slots):
        if index >= len(record.slots):
            record.slots.add()
        # A refined object whose original is gone shows a display material before its first bake in place.
        unknown = not record.slots[index].link and not record.slot_added
        if unknown or not display.is_display(slot.material):
            record.slots[index].material, record.slots[index].link = slot.material, slot.link
        # A slot that the bake itself made had no material.
        original = None if record.slot_added else record.slots[index].material
        journal.set(slot, "material", displays.of(original, both_sides))
