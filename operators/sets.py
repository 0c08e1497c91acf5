# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Sets of colour attributes beside the ones that are shown: one for each frame of an animation."""

from collections.abc import Mapping

import bpy
import numpy as np

from .attributes import Attributes
from .changes import remember_active_attributes, remember_record, remove_attribute
from .colours import write_colours
from .in_place import is_of_frame, make_room
from .journal import Journal
from .record import BAKED_IN_PLACE


def name_of_set(name: str, frame: int) -> str:
    """Return the name of an attribute at a frame: `Radiosity.0012`."""
    return f"{name}.{frame:04d}"


def add_sets(
    obj: bpy.types.Object, sets: Mapping[int, Mapping[str, np.ndarray]], attributes: Attributes, journal: Journal
) -> None:
    """Write the attributes of every frame on the mesh of a baked object, in place of those of an earlier range.

    Parameters
    ----------
    sets : mapping of int to mapping of str to (c, 3) float
        The colours of the face corners by frame and attribute.
    """
    if obj.radiosity.kind == BAKED_IN_PLACE:
        remove_sets(obj, journal)
    values = {name_of_set(name, frame): part for frame, parts in sets.items() for name, part in parts.items()}
    if not values:
        return
    if obj.radiosity.kind == BAKED_IN_PLACE:
        remember_record(obj, journal)
        remember_active_attributes(obj.data, journal)
        make_room(obj, values, journal)
    write_colours(obj.data, values, attributes)


def without_sets(obj: bpy.types.Object, _uid: int, journal: Journal) -> None:
    """Remove what tells of an earlier range of frames from an object that is baked anew."""
    if obj.radiosity.kind == BAKED_IN_PLACE:
        remove_sets(obj, journal)


def remove_sets(obj: bpy.types.Object, journal: Journal) -> None:
    """Remove the sets of an earlier range from an object that was baked in place."""
    mesh = obj.data
    names = [remembered.name for remembered in obj.radiosity.attributes if is_of_frame(remembered.name)]
    for name in names:
        if name in mesh.color_attributes:
            remove_attribute(mesh, name, journal)
