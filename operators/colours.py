# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Baked values as colour attributes of a mesh."""

from collections.abc import Mapping

import bpy
import numpy as np

from ..core.errors import BakeError
from ..core.scene import Floats
from .attributes import Attributes
from .changes import remember_active_attributes
from .journal import Journal


class AttributeNameError(BakeError):
    """The name of an attribute is taken by something that cannot be moved aside."""


LONGEST_NAME = 67
"""Bytes of an attribute's name in Blender before 5.0."""

TYPES = {"FLOAT": "FLOAT_COLOR", "BYTE": "BYTE_COLOR"}


def check_lengths(attributes: Attributes, ending: str) -> None:
    """Refuse names that are longer than Blender allows when `ending` is added to them.

    Raises
    ------
    AttributeNameError
    """
    longest = max((name + ending for name in attributes.names()), key=lambda name: len(name.encode()))
    if bpy.app.version < (5, 0, 0) and len(longest.encode()) > LONGEST_NAME:
        raise AttributeNameError(
            f'The name "{longest}" of an attribute would be longer than the {LONGEST_NAME} bytes that Blender allows; '
            "shorten the prefix or the name of the light group"
        )


def write_colours(mesh: bpy.types.Mesh, values: Mapping[str, Floats | None], attributes: Attributes) -> None:
    """Write colours on `mesh`, making the attributes that it has not, and show the one that is to be shown.

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
            attribute = _new(mesh, name, attributes)
        # Taken names are refused by some versions of Blender and numbered by others.
        if attribute is None or attribute.name != name:
            if attribute is not None:
                mesh.color_attributes.remove(attribute)
            raise AttributeNameError(
                f'The mesh "{mesh.name}" cannot have a colour attribute "{name}"; '
                "rename what has that name already, then bake again"
            )
        _write(mesh, attribute, colours)
    shown = attributes.shown()
    mesh.color_attributes.active_color_name = shown
    mesh.color_attributes.default_color_name = shown
    mesh.attributes.active_index = mesh.attributes.find(shown)


def rewrite_colours(
    mesh: bpy.types.Mesh, values: Mapping[str, Floats | None], attributes: Attributes, journal: Journal
) -> None:
    """Write other values on a mesh that has been written on, whichever of its attributes is shown now.

    An attribute that gets none turns black; one that is missing is made.
    """
    remember_active_attributes(mesh, journal)
    for name, colours in values.items():
        attribute = mesh.color_attributes.get(name)
        if attribute is None and colours is None:
            continue
        if attribute is None:
            attribute = _new(mesh, name, attributes)
            journal.on_failure(remove_if_there, mesh, name)
        else:
            before = np.empty(4 * len(attribute.data), dtype=np.float32)
            attribute.data.foreach_get("color", before)
            journal.on_failure(_write_back, mesh, name, before)
        _write(mesh, attribute, np.zeros((len(mesh.loops), 3)) if colours is None else colours)
    # Written values alone do not reach the viewport.
    mesh.update_tag()


def _new(mesh: bpy.types.Mesh, name: str, attributes: Attributes) -> bpy.types.Attribute:
    settings = attributes.settings
    return mesh.color_attributes.new(name, TYPES[settings.data_type], settings.domain)


def _write(mesh: bpy.types.Mesh, attribute: bpy.types.Attribute, colours: Floats) -> None:
    """Write the colours (c, 3) of face corners, on vertices their mean; Blender makes sRGB of bytes itself."""
    if attribute.domain == "POINT":
        colours = of_vertices(mesh, colours)
    opaque = np.ones((len(colours), 4), dtype=np.float32)
    opaque[:, :3] = colours
    attribute.data.foreach_set("color", opaque.reshape(-1))


def _write_back(mesh: bpy.types.Mesh, name: str, values: np.ndarray) -> None:
    mesh.color_attributes[name].data.foreach_set("color", values)


def remove_if_there(mesh: bpy.types.Mesh, name: str) -> None:
    """Remove a colour attribute that may not be there any more."""
    if name in mesh.color_attributes:
        mesh.color_attributes.remove(mesh.color_attributes[name])


def of_vertices(mesh: bpy.types.Mesh, colours: Floats) -> Floats:
    """Return (v, 3) the mean of the corners (c, 3) that meet in each vertex, by their angles; black where none does.

    Counting corners instead would give a face more weight for being cut into triangles.
    """
    vertex, angle = _corners(mesh)
    count = len(mesh.vertices)
    weight = np.bincount(vertex, weights=angle, minlength=count)
    sums = [np.bincount(vertex, weights=angle * colours[:, k], minlength=count) for k in range(3)]
    return np.divide(np.stack(sums, axis=1), weight[:, None], out=np.zeros((count, 3)), where=weight[:, None] > 0.0)


def _corners(mesh: bpy.types.Mesh) -> tuple[np.ndarray, Floats]:
    """Return the vertex (c,) of each face corner and its angle (c,) in radians, at least a little."""
    vertex = np.empty(len(mesh.loops), dtype=np.int32)
    mesh.loops.foreach_get("vertex_index", vertex)
    places = np.empty((len(mesh.vertices), 3), dtype=np.float32)
    mesh.vertices.foreach_get("co", places.reshape(-1))
    start, total = (np.empty(len(mesh.polygons), dtype=np.int32) for _ in range(2))
    mesh.polygons.foreach_get("loop_start", start)
    mesh.polygons.foreach_get("loop_total", total)
    first, count = np.repeat(start, total), np.repeat(total, total)
    # The corners of faces follow one another.
    corner = np.arange(len(vertex))
    step = corner - first
    here = places[vertex[corner]].astype(np.float64)
    to = [places[vertex[first + (step + turn) % count]] - here for turn in (1, -1)]
    length = np.linalg.norm(to[0], axis=1) * np.linalg.norm(to[1], axis=1)
    cosine = np.divide(np.einsum("ij,ij->i", *to), length, out=np.ones(len(corner)), where=length > 0.0)
    angle = np.empty(len(vertex))
    # A corner without an angle still has a colour, and may be all that its vertex has.
    angle[corner] = np.maximum(np.arccos(np.clip(cosine, -1.0, 1.0)), 1e-6)
    return vertex, angle
