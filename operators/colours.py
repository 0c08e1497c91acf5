# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Baked values as colour attributes of a mesh."""

from collections.abc import Mapping

import bpy
import numpy as np

from ..core.errors import BakeError
from ..core.scene import Floats
from .changes import remember_active_attributes
from .display import RADIOSITY
from .journal import Journal


class AttributeNameError(BakeError):
    """The name of an attribute is taken by something that cannot be moved aside."""


def write_colours(mesh: bpy.types.Mesh, values: Mapping[str, Floats | None]) -> None:
    """Write colours on the corners of `mesh`, making the attributes that it has not, and show the radiosity.

    Parameters
    ----------
    values : mapping of str to (c, 3) float or None
        Linear colour of each face corner by attribute name; None is left out.

    Raises
    ------
    AttributeNameError
        When Blender refuses one of the names.
    """
    for name, colours in values.items():
        if colours is None:
            continue
        attribute = mesh.color_attributes.get(name)
        if attribute is None:
            attribute = mesh.color_attributes.new(name, "FLOAT_COLOR", "CORNER")
        # Taken names are refused by some versions of Blender and numbered by others.
        if attribute is None or attribute.name != name:
            if attribute is not None:
                mesh.color_attributes.remove(attribute)
            raise AttributeNameError(
                f'The mesh "{mesh.name}" cannot have a colour attribute "{name}"; '
                "rename what has that name already, then bake again"
            )
        _write(attribute, colours)
    mesh.color_attributes.active_color_name = RADIOSITY
    mesh.color_attributes.default_color_name = RADIOSITY
    mesh.attributes.active_index = mesh.attributes.find(RADIOSITY)


def rewrite_colours(mesh: bpy.types.Mesh, values: Mapping[str, Floats | None], journal: Journal) -> None:
    """Write other values on the corners of a mesh that has been written on, whichever of them is shown now.

    An attribute that gets none turns black; one that is missing is made.
    """
    remember_active_attributes(mesh, journal)
    for name, colours in values.items():
        attribute = mesh.color_attributes.get(name)
        if attribute is None and colours is None:
            continue
        if attribute is None:
            attribute = mesh.color_attributes.new(name, "FLOAT_COLOR", "CORNER")
            journal.on_failure(remove_if_there, mesh, name)
        else:
            before = np.empty(4 * len(attribute.data), dtype=np.float32)
            attribute.data.foreach_get("color", before)
            journal.on_failure(_write_back, mesh, name, before)
        _write(attribute, np.zeros((len(mesh.loops), 3)) if colours is None else colours)
    # Written values alone do not reach the viewport.
    mesh.update_tag()


def _write(attribute: bpy.types.Attribute, colours: Floats) -> None:
    opaque = np.ones((len(colours), 4), dtype=np.float32)
    opaque[:, :3] = colours
    attribute.data.foreach_set("color", opaque.reshape(-1))


def _write_back(mesh: bpy.types.Mesh, name: str, values: np.ndarray) -> None:
    mesh.color_attributes[name].data.foreach_set("color", values)


def remove_if_there(mesh: bpy.types.Mesh, name: str) -> None:
    """Remove a colour attribute that may not be there any more."""
    if name in mesh.color_attributes:
        mesh.color_attributes.remove(mesh.color_attributes[name])
