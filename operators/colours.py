# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Baked values as colour attributes of a mesh."""

from collections.abc import Mapping

import bpy
import numpy as np

from ..core.errors import BakeError
from ..core.scene import Floats
from .display import RADIOSITY


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
        opaque = np.ones((len(colours), 4), dtype=np.float32)
        opaque[:, :3] = colours
        attribute.data.foreach_set("color", opaque.reshape(-1))
    mesh.color_attributes.active_color_name = RADIOSITY
    mesh.color_attributes.default_color_name = RADIOSITY
    mesh.attributes.active_index = mesh.attributes.find(RADIOSITY)
