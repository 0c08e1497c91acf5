# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Colours and numbers that reach the inputs of nodes."""

import numpy as np
from mathutils import Euler

from ..core.textures import sampled
from .blackbody import blackbody
from .images import UnreadableImageError, read_image
from .light_paths import FACING, mean_facing, seen_by_diffuse_rays
from .node_links import input_of, source_of, title_of, value_of
from .varying import Points, Value, Varying, combined, luminance, varies

_STRETCHED = 4.0
"""Times that an image may be stretched until the longer way decides how much of it is averaged."""


class ValueReader:
    """Reads what reaches the inputs of nodes: constants, and what follows from images and colour attributes.

    Parameters
    ----------
    with_textures : bool
        Whether colours may vary. If not, whatever is no constant is named in the notes.
    back : bool
        Whether the surface is seen from behind, as the Geometry node tells.

    Attributes
    ----------
    asked_for_side : bool
        Whether something depends on that.
    notes : list of str
        What was skipped or guessed.
    unread : list of str
        Nodes that only Blender can evaluate.
    """

    def __init__(self, with_textures: bool = False, back: bool = False) -> None:
        self.with_textures = with_textures
        self.back = back
        self.asked_for_side = False
        self.notes: list[str] = []
        self.unread: list[str] = []

    def leave(self, name: str, note: str) -> None:
        """Leave a node to Blender, or say what is made of it."""
        if self.with_textures:
            self.unread.append(name)
        else:
            self.notes.append(note)

    def colour(self, node, identifier: str, groups) -> Value:
        """Return the colour that reaches an input."""
        value = self._constant(node, identifier, groups)
        return np.full(3, value) if isinstance(value, float) else value

    def value(self, node, identifier: str, groups) -> Value:
        """Return the number that reaches an input."""
        return combined(number_of, self._constant(node, identifier, groups))

    def share(self, node, identifier: str, groups) -> Value:
        """Return the number that reaches an input, 0 to 1."""
        return combined(lambda value: np.clip(value, 0.0, 1.0), self.value(node, identifier, groups))

    def _constant(self, node, identifier: str, groups) -> Value:
        """Return what reaches an input; what cannot be read counts as its socket's value."""
        socket = input_of(node, identifier)
        output, outer = source_of(socket, groups)
        if output is None:
            # An open input inside a group may have led out to the group node, whose own socket then has the value.
            return value_of(outer)
        if output.node.type in {"VALUE", "RGB"}:
            return value_of(output)
        if self.with_textures and output.node.type == "NEW_GEOMETRY" and output.identifier == "Backfacing":
            self.asked_for_side = True
            return float(self.back)
        if self.with_textures and output.node.type == "LIGHT_PATH":
            return seen_by_diffuse_rays(output.identifier)
        if self.with_textures and output.node.type in FACING:
            found = mean_facing(output.node, output.identifier)
            if found is not None:
                self.notes.append(f"{title_of(output.node)} counts as its mean over all angles")
                return found
        if self.with_textures or output.node.type in _OF_CONSTANTS:
            found = self._texture(output, outer)
            if found is not None:
                return found
        title = title_of(output.node)
        self.leave(
            title,
            f"{socket.name} comes from {title}, which is not supported; "
            f"the {'value' if socket.type == 'VALUE' else 'colour'} set on its socket was used instead",
        )
        return value_of(socket)

    def _texture(self, output, groups) -> Value | None:
        """Return what an output gives that varies over the mesh, or None."""
        node = output.node
        if node.type == "TEX_IMAGE":
            return self._image(node, output, groups)
        if node.type == "VERTEX_COLOR":
            return _attribute(node.layer_name, output.identifier)
        if node.type == "ATTRIBUTE" and node.attribute_type == "GEOMETRY" and node.attribute_name:
            return _attribute(node.attribute_name, output.identifier)
        if node.type == "MIX" and node.data_type in {"RGBA", "FLOAT"}:
            kind = {"RGBA": "Color", "FLOAT": "Float"}[node.data_type]
            blend = node.blend_type if node.data_type == "RGBA" else "MIX"
            names = "Factor_Float", f"A_{kind}", f"B_{kind}"
            return self._blend(node, blend, names, groups, node.clamp_factor, node.clamp_result)
        if node.type == "BLACKBODY" and not input_of(node, "Temperature").is_linked:
            return blackbody(value_of(input_of(node, "Temperature")))
        if (
            node.type == "LIGHT_FALLOFF"
            and output.identifier == "Quadratic"
            and value_of(input_of(node, "Smooth")) == 0.0
        ):
            # As light falls off by itself.
            return self.value(node, "Strength", groups)
        if node.type == "MATH" and node.operation in _SUMS:
            return self._sum(node, groups)
        if node.type == "MIX_RGB":
            return self._blend(node, node.blend_type, ("Fac", "Color1", "Color2"), groups, True, node.use_clamp)
        return None

    def _blend(self, node, blend: str, names, groups, clamp_factor: bool, clamp_result: bool) -> Value | None:
        if blend not in _BLENDS:
            return None
        factor = self.share(node, names[0], groups) if clamp_factor else self.value(node, names[0], groups)
        first, second = (self.colour(node, name, groups) for name in names[1:])

        def blended(share, a, b):
            result = mixed(share, a, _BLENDS[blend](a, b))
            return np.clip(result, 0.0, 1.0) if clamp_result else result

        return combined(blended, factor, first, second)

    def _sum(self, node, groups) -> Value:
        function, count = _SUMS[node.operation]
        result = combined(function, *[self.value(node, name, groups) for name in _OPERANDS[:count]])
        if node.use_clamp:
            result = combined(lambda value: np.clip(value, 0.0, 1.0), result)
        return result if varies(result) else float(result)

    def _image(self, node, output, groups) -> Value | None:
        if node.image is None or node.projection != "FLAT":
            return None
        where = self._place(node, groups)
        if where is None:
            return None
        alpha = next(socket for socket in node.outputs if socket.identifier == "Alpha")
        try:
            image = read_image(node.image, node.extension, node.interpolation == "Closest", alpha.is_linked)
        except UnreadableImageError:
            return None
        height, width = image.levels[0].shape[:2]
        channels = slice(3, 4) if output.identifier == "Alpha" else slice(0, 3)

        def read(points: Points):
            uv = where.at(points)[:, :, :2]
            along, across = (uv[:, 1:] - uv[:, :1]).transpose(1, 0, 2) * (width, height)
            # A part is half of the parallelogram of these two; in a stretched one the longer way still counts.
            area = np.sqrt(np.abs(along[:, 0] * across[:, 1] - along[:, 1] * across[:, 0]) / 2.0)
            longest = np.maximum(np.linalg.norm(along, axis=1), np.linalg.norm(across, axis=1))
            return sampled(image, uv[:, 0], np.maximum(area, longest / _STRETCHED))[:, channels]

        return Varying(read)

    def _place(self, node, groups) -> Varying | None:
        """Return the vectors that are linked to a node's input Vector; without a link those of the UV map."""
        output, groups = source_of(input_of(node, "Vector"), groups)
        if output is None:
            return _uv_map("")
        source = output.node
        if source.type == "UVMAP" and not source.from_instancer:
            return _uv_map(source.uv_map)
        if source.type == "TEX_COORD" and output.identifier == "UV" and not source.from_instancer:
            return _uv_map("")
        if source.type == "ATTRIBUTE" and source.attribute_type == "GEOMETRY" and output.identifier == "Vector":
            return _uv_map(source.attribute_name)
        if source.type == "MAPPING" and source.vector_type in {"POINT", "TEXTURE", "VECTOR"}:
            return self._mapped(source, groups)
        return None

    def _mapped(self, node, groups) -> Varying | None:
        inner = self._place(node, groups)
        names = ("Rotation", "Scale") if node.vector_type == "VECTOR" else ("Rotation", "Scale", "Location")
        values = [self._constant(node, name, groups) for name in names]
        if inner is None or varies(*values):
            return None
        turn, scale = np.array(Euler(values[0]).to_matrix()), values[1]
        offset = values[2] if len(values) > 2 else np.zeros(3)
        if node.vector_type == "TEXTURE":
            # As Cycles divides: by 0 gives 0.
            inverse = np.divide(1.0, scale, out=np.zeros(3), where=scale != 0.0)
            return Varying(lambda points: ((inner.at(points) - offset) @ turn) * inverse)
        return Varying(lambda points: (inner.at(points) * scale) @ turn.T + offset)


def number_of(value):
    """Return the number that Blender makes of a number or a colour."""
    return value if isinstance(value, float) else luminance(value)


def mixed(share, first, second):
    """Return a mix of two colours."""
    return (1.0 - share) * first + share * second


def _uv_map(name: str) -> Varying:
    return Varying(lambda points: points.vectors(name or points.attributes.uv, 3))


def _attribute(name: str, output: str) -> Value | None:
    """Return a colour attribute; without a name that of renders."""
    if output not in {"Color", "Alpha"}:
        return None
    channels = slice(3, 4) if output == "Alpha" else slice(0, 3)
    return Varying(lambda points: points.colours(name or points.attributes.colour)[:, channels])


_BLENDS = {
    "MIX": lambda _, b: b,
    "MULTIPLY": np.multiply,
    "ADD": np.add,
    "SUBTRACT": np.subtract,
    "DARKEN": np.minimum,
    "LIGHTEN": np.maximum,
    "SCREEN": lambda a, b: 1.0 - (1.0 - a) * (1.0 - b),
}
"""What a Mix node makes of its second colour where its factor is 1."""

_OF_CONSTANTS = {"BLACKBODY", "LIGHT_FALLOFF", "MATH", "MIX", "MIX_RGB"}
"""Nodes that make constants of constants."""

_OPERANDS = "Value", "Value_001", "Value_002"

_SUMS = {
    "ADD": (np.add, 2),
    "SUBTRACT": (np.subtract, 2),
    "MULTIPLY": (np.multiply, 2),
    "MULTIPLY_ADD": (lambda a, b, c: a * b + c, 3),
    "MINIMUM": (np.minimum, 2),
    "MAXIMUM": (np.maximum, 2),
    "GREATER_THAN": (lambda a, b: np.float64(1.0) * (a > b), 2),
    "LESS_THAN": (lambda a, b: np.float64(1.0) * (a < b), 2),
}
"""What a Math node makes of how many of its operands."""
