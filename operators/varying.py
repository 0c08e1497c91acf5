# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Colours and numbers that vary over a mesh, as what reads them at places of it."""

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

import bpy
import numpy as np
from numpy.typing import NDArray

from ..core.scene import Floats, Ints

LUMINANCE = np.array([0.2126, 0.7152, 0.0722])
"""What Blender makes a number of a colour by."""


@dataclass(frozen=True, eq=False)
class Attributes:
    """UV maps and colour attributes of a mesh.

    Attributes
    ----------
    values : dict of str to (t, 3, width) float
        At the corners of its triangles; colours are linear RGBA.
    uv, colour : str
        The names of those that renders take by default; empty for none.
    """

    values: dict[str, Floats]
    uv: str
    colour: str

    def turned_over(self) -> "Attributes":
        """Those of the mesh with its triangles wound the other way."""
        return Attributes({name: at[:, [0, 2, 1]] for name, at in self.values.items()}, self.uv, self.colour)


_SIZES = {"FLOAT2": 2, "FLOAT_VECTOR": 3, "FLOAT_COLOR": 4, "BYTE_COLOR": 4, "FLOAT": 1}


def read_attributes(mesh: bpy.types.Mesh) -> Attributes:
    """Return the attributes of an evaluated mesh that a material may be made of."""
    mesh.calc_loop_triangles()
    count = len(mesh.loop_triangles)
    of_domain = {}
    for domain, name, shape in (
        ("POINT", "vertices", (count, 3)),
        ("CORNER", "loops", (count, 3)),
        ("FACE", "polygon_index", (count,)),
    ):
        index = np.empty(shape, dtype=np.int32)
        mesh.loop_triangles.foreach_get(name, index.reshape(-1))
        of_domain[domain] = np.broadcast_to(index.reshape(count, -1), (count, 3))
    values = {}
    for attribute in mesh.attributes:
        size = _SIZES.get(attribute.data_type)
        if size is None or attribute.domain not in of_domain or attribute.is_internal or attribute.is_required:
            continue
        name = {1: "value", 4: "color"}.get(size, "vector")
        flat = np.empty(len(attribute.data) * size, dtype=np.float32)
        attribute.data.foreach_get(name, flat)
        values[attribute.name] = flat.reshape(-1, size)[of_domain[attribute.domain]]
    return Attributes(
        values,
        next((layer.name for layer in mesh.uv_layers if layer.active_render), ""),
        mesh.color_attributes.default_color_name if len(mesh.color_attributes) else "",
    )


@dataclass(frozen=True, eq=False)
class Points:
    """Places on the triangles of a mesh, each the middle of a small part of its triangle.

    Attributes
    ----------
    attributes : Attributes
    triangle : (n,) int
    weights : (n, 3, 3) float
        Barycentric coordinates of the place, and of the two that lie beside it where the next parts begin.
    """

    attributes: Attributes
    triangle: Ints
    weights: Floats
    known: dict[Any, Any] = field(default_factory=dict)

    def vectors(self, name: str, width: int) -> Floats:
        """An attribute at the places and the two beside each, (n, 3, width); 0 where the mesh has none of that name."""
        values = self.attributes.values.get(name)
        if values is None:
            return np.zeros((len(self.triangle), 3, width))
        at = np.einsum("npk,nkw->npw", self.weights, values[self.triangle])[:, :, :width]
        return np.concatenate([at, np.zeros((*at.shape[:2], width - at.shape[2]))], axis=2)

    def colours(self, name: str) -> Floats:
        """A colour attribute at the places, (n, 4), opaque where it has no alpha; 0 where there is none of the name."""
        values = self.attributes.values.get(name)
        if values is None:
            return np.zeros((len(self.triangle), 4))
        at = np.einsum("nk,nkw->nw", self.weights[:, 0], values[self.triangle])
        width = at.shape[1]
        if width == 1:
            at = np.repeat(at, 3, axis=1)
        rest = [np.zeros((len(at), 1))] * (3 - at.shape[1]) + [np.ones((len(at), 1))]
        return at if width == 4 else np.concatenate([at, *rest], axis=1)


@dataclass(frozen=True, eq=False)
class Varying:
    """A colour (n, 3), number (n, 1) or vector (n, 3, 3), the last at three places each, that varies over a mesh.

    Attributes
    ----------
    read : callable
        Gives it at `Points`.
    """

    read: Callable[[Points], Floats]

    def at(self, points: Points) -> Floats:
        """Return it at places; asked for twice it is read once."""
        if self not in points.known:
            points.known[self] = self.read(points)
        return points.known[self]


Value = NDArray[np.float64] | float | Varying
"""Of a socket: a constant colour (3,) or number, or one that varies."""


def combined(function: Callable[..., Any], *values: Value) -> Any:
    """Return what `function` makes of the values, which varies if one of them does."""
    if not any(isinstance(value, Varying) for value in values):
        return function(*values)
    return Varying(lambda points: function(*(at(value, points) for value in values)))


def at(value: Value, points: Points) -> Any:
    """Return a value at places."""
    return value.at(points) if isinstance(value, Varying) else value


def varies(*values: Value) -> bool:
    """Return whether one of the values varies."""
    return any(isinstance(value, Varying) for value in values)


def luminance(colour: Any) -> Any:
    """Return the number that Blender makes of a colour (3,) or (n, 3): a float or (n, 1)."""
    if np.ndim(colour) == 1:
        return float(colour @ LUMINANCE)
    return colour if colour.shape[1] == 1 else (colour @ LUMINANCE)[:, None]
