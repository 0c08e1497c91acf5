# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""What a material means for radiosity: its reflectance and emission, read from its nodes.

They are constants, or vary over the mesh as far as they follow from images and colour attributes. What needs any other
node is named, for Blender to evaluate it.
"""

from collections.abc import Iterable
from dataclasses import dataclass, field, replace
from typing import NamedTuple

import bpy
import numpy as np
from mathutils import Euler
from numpy.typing import NDArray

from ..core.textures import sampled
from .display import is_display
from .gloss import index_at_level, mean_gloss, mean_sheen
from .images import UnreadableImageError, read_image
from .light_paths import FACING, mean_facing, seen_by_diffuse_rays
from .varying import Points, Value, Varying, combined, luminance, varies

Colour = NDArray[np.float64]

GREY = 0.8
"""Reflectance of a mesh without a material: what Blender's own default shows."""

_GLOSS_WITHOUT_MATERIAL = (0.5, 1.5)
"""Its roughness and index of refraction from Blender 5 on: those of a new Principled BSDF."""

_DIFFUSE_LIKE = {
    "SUBSURFACE_SCATTERING": "scatters light below the surface",
    "BSDF_TOON": "is no physical shader",
}
GLOSSY = {"BSDF_GLOSSY": "Color", "BSDF_METALLIC": "Base Color"}
"""Shaders that mirror, and the inputs by which they colour what they mirror."""

NOT_DIFFUSE = {
    "BSDF_GLOSSY",
    "BSDF_METALLIC",
    "BSDF_GLASS",
    "BSDF_REFRACTION",
    "BSDF_TRANSPARENT",
    "BSDF_HAIR",
    "BSDF_HAIR_PRINCIPLED",
    "HOLDOUT",
}
_MIRRORS = "shows no diffuse light and is black itself; what it mirrors lights others, evenly from all sides"

_DEEPEST_NESTING = 64
"""Node trees have no cycles that render; this only ends a walk through a broken one."""


@dataclass(frozen=True, eq=False)
class Surface:
    """What a material does to light.

    Attributes
    ----------
    reflectance : (3,) float or Varying, 0..1
        Diffuse albedo, linear RGB.
    emission : (3,) float or Varying, W m^-2 sr^-1
        Emitted radiance, linear RGB.
    notes : tuple of str
        What was skipped or guessed, each a clause to follow the material's name and a colon.
    through : (3,) float or Varying, 0..1
        Share of the light that goes straight through it, linear RGB.
    refraction : float
        Index of refraction where that is through glass, which reflects a part of it; else 1.
    clear : bool
        Whether all of it goes through, as if the material were not there.
    front_only : bool
        Whether it emits from its front alone.
    translucence : (3,) float or Varying, 0..1
        Share of the light on one side that leaves the other evenly in all directions, linear RGB.
    mirrored : (3,) float or Varying, 0..1
        Share of the light that gloss sends on, linear RGB; its own colours do not show it.
    covered : float or Varying, 0..1
        Share of what is diffuse that others do not get, as gloss lies above it.
    unread : tuple of str
        Nodes that only Blender can evaluate, in the words of its Add menu: where there is one, the colours are guesses.
    """

    reflectance: Colour | Varying
    emission: Colour | Varying
    notes: tuple[str, ...] = ()
    unread: tuple[str, ...] = ()
    through: Colour | Varying = field(default_factory=lambda: np.zeros(3))
    refraction: float = 1.0
    clear: bool = False
    front_only: bool = False
    translucence: Colour | Varying = field(default_factory=lambda: np.zeros(3))
    mirrored: Colour | Varying = field(default_factory=lambda: np.zeros(3))
    covered: float | Varying = 0.0

    @property
    def is_glossy(self) -> bool:
        """Whether others get other light from it than what it shows."""
        return varies(self.mirrored, self.covered) or bool(np.any(self.mirrored) or self.covered)

    def sent_on(self) -> Colour | Varying:
        """Return the share of the light that others get."""
        if not self.is_glossy:
            return self.reflectance
        return combined(_with_gloss, self.reflectance, self.mirrored, self.covered)

    @property
    def is_bare(self) -> bool:
        """Whether it has no light of its own to show: it is clear, or glass, tinted or not, and nothing else."""
        own = self.reflectance, self.emission, self.translucence
        dark = not self.unread and not varies(*own) and not np.any(own)
        return self.clear or (dark and bool(varies(self.through) or np.any(self.through)))

    def colours(self) -> tuple[Colour | Varying, ...]:
        """Return all that may vary."""
        return self.reflectance, self.emission, self.through, self.translucence, self.mirrored, self.covered


def _surface(
    reflectance: object = 0.0,
    emission: object = 0.0,
    notes: Iterable[str] = (),
    unread: Iterable[str] = (),
    through: object = 0.0,
    refraction: float = 1.0,
    translucence: object = 0.0,
    mirrored: object = 0.0,
    covered: float | Varying = 0.0,
) -> Surface:
    def colour(value: object) -> Colour | Varying:
        if isinstance(value, Varying):
            return value
        return np.array(np.broadcast_to(np.asarray(value, dtype=np.float64), (3,)))

    clear = not varies(through) and refraction == 1.0 and bool(np.all(np.asarray(through) >= _CLEAR))
    return Surface(
        colour(reflectance),
        colour(emission),
        tuple(notes),
        tuple(unread),
        colour(0.0 if clear else through),
        refraction,
        clear,
        translucence=colour(translucence),
        mirrored=colour(mirrored),
        covered=covered,
    )


def uses_nodes(owner: bpy.types.Material | bpy.types.World | bpy.types.Light) -> bool:
    """Return whether a material, world or lamp is made of nodes."""
    # From Blender 5.0 on nodes are always used, and asking warns that the property goes away.
    return owner.node_tree is not None and (bpy.app.version >= (5, 0, 0) or owner.use_nodes)


def material_surface(material: bpy.types.Material | None) -> Surface:
    """Return what `material` does to light; None is the grey of a mesh without a material."""
    if material is None:
        share = mean_gloss(*_GLOSS_WITHOUT_MATERIAL) if bpy.app.version >= (5, 0, 0) else 0.0
        return _surface(GREY, mirrored=share, covered=share)
    if is_display(material):
        return _surface(GREY, notes=["it shows an earlier bake; plain grey was used instead"])
    if not uses_nodes(material):
        return _surface(np.clip(material.diffuse_color[:3], 0.0, 1.0))
    shader = _sided(material.node_tree)
    if _is_displaced(material):
        shader = replace(shader, notes=(*shader.notes, "its displacement is left out; a Displace modifier takes part"))
    if varies(shader.reflectance):
        return shader
    reflectance = np.clip(shader.reflectance, 0.0, 1.0)
    if np.any(reflectance != shader.reflectance):
        notes = (*shader.notes, "its colour is brighter than white; white was used instead")
        return replace(shader, reflectance=reflectance, notes=notes)
    return shader


def _sided(tree: bpy.types.NodeTree) -> Surface:
    """Return what a material does to light; of what its back does otherwise, only to be dark is understood."""
    reader = _ShaderReader(tree, with_textures=True)
    front = reader.surface()
    if not reader.asked_for_side or front.clear:
        return front
    back = _ShaderReader(tree, with_textures=True, back=True).surface()
    front_only = not varies(back.emission) and not np.any(back.emission)
    same = front_only or _alike(front.emission, back.emission)
    if same and (_alike(front.reflectance, back.reflectance) or back.clear):
        return replace(front, front_only=front_only)
    note = "it looks otherwise from behind; its front counts, but for emission that ends there"
    return replace(front, front_only=front_only, notes=(*front.notes, note))


def _is_displaced(material: bpy.types.Material) -> bool:
    """Return whether Cycles moves the surface itself."""
    output = material.node_tree.get_output_node("CYCLES")
    return material.displacement_method != "BUMP" and output is not None and output.inputs["Displacement"].is_linked


def _alike(first: Colour | Varying, second: Colour | Varying) -> bool:
    return not varies(first, second) and np.array_equal(first, second)


def constant_emission(owner: bpy.types.World | bpy.types.Light) -> tuple[Colour, tuple[str, ...]]:
    """Return what the nodes of a world or lamp emit as far as they are constants, and what was skipped of them.

    Returns
    -------
    emission : (3,) float
    notes : tuple of str
    """
    shader = _ShaderReader(owner.node_tree).surface()
    return shader.emission, shader.notes


class _Shares(NamedTuple):
    """What happens to the light that meets a shader, as of `Surface`, and what it emits."""

    reflectance: Value = np.zeros(3)
    emission: Value = np.zeros(3)
    through: Value = np.zeros(3)
    translucence: Value = np.zeros(3)
    mirrored: Value = np.zeros(3)
    covered: Value = np.zeros(3)


class _ShaderReader:
    """Follows the links of one node tree, in and out of groups, from its output to constants and textures.

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
    """

    def __init__(self, tree: bpy.types.NodeTree, with_textures: bool = False, back: bool = False) -> None:
        self.tree = tree
        self.with_textures = with_textures
        self.back = back
        self.asked_for_side = False
        self.refraction = 1.0
        self.notes: list[str] = []
        self.unread: list[str] = []

    def surface(self) -> Surface:
        output = self.tree.get_output_node("CYCLES")
        if output is None:
            return _surface()
        if self.with_textures and _input(output, "Volume").is_linked:
            self.notes.append("its volume is left out")
            if not _input(output, "Surface").is_linked:
                return _surface(notes=self.notes, through=1.0)
        reflectance, emission, through, translucence, mirrored, covered = self._shader(_input(output, "Surface"), ())
        if not varies(through):
            through = np.clip(through, 0.0, 1.0)
        if not varies(emission) and np.any(emission < 0.0):
            self.notes.append("its emission is negative; it was taken for zero")
            emission = np.maximum(emission, 0.0)
        notes, unread = dict.fromkeys(self.notes), dict.fromkeys(self.unread)
        covered = combined(_number, covered)
        return _surface(reflectance, emission, notes, unread, through, self.refraction, translucence, mirrored, covered)

    def _shader(self, socket, groups) -> "_Shares":
        """Return what happens to light at whatever is linked to a shader socket; an open one is black."""
        output, groups = self._source(socket, groups)
        if output is None:
            return _Shares()
        node = output.node
        if node.type == "BSDF_PRINCIPLED":
            return self._principled(node, groups)
        if node.type in {"EMISSION", "BACKGROUND"}:
            colour, strength = self._colour(node, "Color", groups), self._value(node, "Strength", groups)
            return _Shares(emission=combined(np.multiply, colour, strength))
        if node.type == "BSDF_DIFFUSE":
            self._tell_roughness(node, "Roughness")
            return _Shares(self._colour(node, "Color", groups))
        if node.type == "BSDF_SHEEN":
            share = mean_sheen(self._plain(node, "Roughness"))
            return _Shares(combined(lambda colour: share * colour, self._colour(node, "Color", groups)))
        if node.type == "BSDF_TRANSLUCENT":
            return _Shares(translucence=self._colour(node, "Color", groups))
        if node.type == "BSDF_TRANSPARENT":
            return _Shares(through=self._colour(node, "Color", groups))
        if node.type in {"BSDF_GLASS", "BSDF_REFRACTION"}:
            if node.type == "BSDF_GLASS":
                self._refract(node, groups)
            return _Shares(through=self._colour(node, "Color", groups))
        if node.type == "MIX_SHADER":
            share = self._share(node, "Fac", groups)
            if not varies(share) and share in (0.0, 1.0):
                return self._shader(node.inputs[1 + int(share)], groups)
            first, second = self._shader(node.inputs[1], groups), self._shader(node.inputs[2], groups)
            return _Shares(*(_mix(share, a, b) for a, b in zip(first, second, strict=True)))
        if node.type == "ADD_SHADER":
            first, second = self._shader(node.inputs[0], groups), self._shader(node.inputs[1], groups)
            return _Shares(*(combined(np.add, a, b) for a, b in zip(first, second, strict=True)))
        return self._unsupported(node, groups)

    def _principled(self, node, groups) -> "_Shares":
        opaque = self._share(node, "Alpha", groups)
        metal, glass = (self._share(node, name, groups) for name in ("Metallic", "Transmission Weight"))
        mirrored = np.zeros(3)
        if varies(metal) or metal > 0.0:
            self.notes.append(f"Metallic {_MIRRORS}")
            mirrored = combined(
                np.multiply, self._colour(node, "Base Color", groups), combined(np.multiply, opaque, metal)
            )
        diffuse = combined(lambda alpha, m, g: alpha * (1.0 - m) * (1.0 - g), opaque, metal, glass)
        reflectance = np.zeros(3)
        if varies(diffuse) or diffuse > 0.0:
            reflectance = combined(np.multiply, self._colour(node, "Base Color", groups), diffuse)
        through = combined(lambda alpha: (1.0 - alpha) * np.ones(3), opaque)
        if varies(glass) or glass > 0.0:
            self._refract(node, groups)
            colour = self._colour(node, "Base Color", groups)
            through = combined(_through_glass, through, opaque, metal, glass, colour)
        strength = combined(np.multiply, self._value(node, "Emission Strength", groups), opaque)
        emission = np.zeros(3)
        if varies(strength) or strength != 0.0:
            emission = combined(np.multiply, self._colour(node, "Emission Color", groups), strength)
        coat = self._coat(node)
        if np.any(coat != 1.0):
            reflectance, emission, mirrored = (
                combined(np.multiply, colour, coat) for colour in (reflectance, emission, mirrored)
            )
        self._tell_roughness(node, "Diffuse Roughness")
        covered = combined(lambda share: self._layers(node) * share * np.ones(3), diffuse)
        return _Shares(reflectance, emission, through, mirrored=combined(np.add, mirrored, covered), covered=covered)

    def _coat(self, node) -> Colour:
        """Return the share of light that the tint of a coat lets through to what is below, and back."""
        weight = np.clip(self._plain(node, "Coat Weight"), 0.0, 1.0)
        return _mixed(weight, np.ones(3), np.array(_input(node, "Coat Tint").default_value[:3]))

    def _tell_roughness(self, node, identifier: str) -> None:
        socket = next((socket for socket in node.inputs if socket.identifier == identifier), None)
        if socket is not None and (socket.is_linked or socket.default_value > 0.0):
            self.notes.append(f"the roughness of its diffuse reflection ({identifier}) is left out")

    def _layers(self, node) -> float:
        """Return the share that the clear layers and the sheen of a Principled BSDF mirror."""

        def plain(name: str) -> float:
            return self._plain(node, name)

        index = index_at_level(plain("IOR"), plain("Specular IOR Level"))
        passed = 1.0 - mean_gloss(plain("Roughness"), index)
        passed *= 1.0 - plain("Coat Weight") * mean_gloss(plain("Coat Roughness"), plain("Coat IOR"))
        passed *= 1.0 - plain("Sheen Weight") * mean_sheen(plain("Sheen Roughness"))
        return 1.0 - passed

    @staticmethod
    def _plain(node, identifier: str) -> float:
        """Return the number set on an input, whatever is linked to it, which is near enough for gloss."""
        return float(_input(node, identifier).default_value)

    def _refract(self, node, groups) -> None:
        index = self._value(node, "IOR", groups)
        self.refraction = max(self.refraction, 1.0 if varies(index) else float(index))

    def _unsupported(self, node, groups) -> "_Shares":
        name = _title(node)
        if node.type in _DIFFUSE_LIKE:
            self.notes.append(f"{name} {_DIFFUSE_LIKE[node.type]}; it counts as diffuse")
            return _Shares(self._colour(node, "Color", groups))
        if node.type in GLOSSY:
            self.notes.append(f"{name} {_MIRRORS}")
            return _Shares(mirrored=self._colour(node, GLOSSY[node.type], groups))
        if node.type in NOT_DIFFUSE:
            self.notes.append(f"{name} reflects no diffuse light; that part counts as black")
            return _Shares()
        self._leave(name, f"{name} is not supported; that part counts as grey")
        return _Shares(np.full(3, GREY))

    def _leave(self, name: str, note: str) -> None:
        """Leave a node to Blender, or say what is made of it."""
        if self.with_textures:
            self.unread.append(name)
        else:
            self.notes.append(note)

    def _colour(self, node, identifier: str, groups) -> Value:
        value = self._constant(node, identifier, groups)
        return np.full(3, value) if isinstance(value, float) else value

    def _value(self, node, identifier: str, groups) -> Value:
        return combined(_number, self._constant(node, identifier, groups))

    def _share(self, node, identifier: str, groups) -> Value:
        return combined(lambda value: np.clip(value, 0.0, 1.0), self._value(node, identifier, groups))

    def _constant(self, node, identifier: str, groups) -> Value:
        """Return what reaches an input; what cannot be read counts as its socket's value."""
        socket = _input(node, identifier)
        output, outer = self._source(socket, groups)
        if output is None:
            # An open input inside a group may have led out to the group node, whose own socket then has the value.
            return _default(outer)
        if output.node.type in {"VALUE", "RGB"}:
            return _default(output)
        if self.with_textures and output.node.type == "NEW_GEOMETRY" and output.identifier == "Backfacing":
            self.asked_for_side = True
            return float(self.back)
        if self.with_textures and output.node.type == "LIGHT_PATH":
            return seen_by_diffuse_rays(output.identifier)
        if self.with_textures and output.node.type in FACING:
            found = mean_facing(output.node, output.identifier)
            if found is not None:
                self.notes.append(f"{_title(output.node)} counts as its mean over all angles")
                return found
        if self.with_textures:
            found = self._texture(output, outer)
            if found is not None:
                return found
        title = _title(output.node)
        self._leave(
            title,
            f"{socket.name} comes from {title}, which is not supported; "
            f"the {'value' if socket.type == 'VALUE' else 'colour'} set on its socket was used instead",
        )
        return _default(socket)

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
        if node.type == "MATH" and node.operation in _SUMS:
            return self._sum(node, groups)
        if node.type == "MIX_RGB":
            return self._blend(node, node.blend_type, ("Fac", "Color1", "Color2"), groups, True, node.use_clamp)
        return None

    def _blend(self, node, blend: str, names, groups, clamp_factor: bool, clamp_result: bool) -> Value | None:
        if blend not in _BLENDS:
            return None
        factor = self._share(node, names[0], groups) if clamp_factor else self._value(node, names[0], groups)
        first, second = (self._colour(node, name, groups) for name in names[1:])

        def blended(share, a, b):
            result = _mixed(share, a, _BLENDS[blend](a, b))
            return np.clip(result, 0.0, 1.0) if clamp_result else result

        return combined(blended, factor, first, second)

    def _sum(self, node, groups) -> Value:
        function, count = _SUMS[node.operation]
        result = combined(function, *[self._value(node, name, groups) for name in _OPERANDS[:count]])
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
        output, groups = self._source(_input(node, "Vector"), groups)
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

    def _source(self, socket, groups):
        """Return the output socket that feeds `socket`, through reroutes, muted nodes and groups, and where it is.

        Without a source the second value is the socket, maybe on a group node outside, whose own value counts.
        """
        for _ in range(_DEEPEST_NESTING):
            link = next((link for link in socket.links if link.is_valid and not link.is_muted), None)
            if link is None:
                return None, socket
            output, node = link.from_socket, link.from_node
            if node.type == "REROUTE":
                socket = node.inputs[0]
            elif node.mute:
                inner = next((inner for inner in node.internal_links if inner.to_socket == output), None)
                if inner is None:
                    return None, socket
                socket = inner.from_socket
            elif node.type == "GROUP" and node.node_tree is not None:
                group_output = next(
                    (n for n in node.node_tree.nodes if n.type == "GROUP_OUTPUT" and n.is_active_output), None
                )
                if group_output is None:
                    return None, socket
                socket, groups = _input(group_output, output.identifier), (*groups, node)
            elif node.type == "GROUP_INPUT" and groups:
                socket, groups = _input(groups[-1], output.identifier), groups[:-1]
            else:
                return output, groups
        return None, socket


def _input(node, identifier: str):
    """Return the input socket of that identifier, which unlike its name does not change between versions."""
    return next(socket for socket in node.inputs if socket.identifier == identifier)


def _title(node) -> str:
    """Return what kind of node it is, in the words of Blender's Add menu; a group's own name."""
    return node.node_tree.name if node.type == "GROUP" and node.node_tree else node.bl_label


def _default(socket) -> Value:
    value = socket.default_value
    return float(value) if isinstance(value, float | int) else np.array(value[:3], dtype=np.float64)


def _number(value):
    return value if isinstance(value, float) else luminance(value)


def _mix(share: Value, first: Value, second: Value) -> Value:
    """Return a mix of two colours, which does not vary where both are the same."""
    return first if _alike(first, second) else combined(_mixed, share, first, second)


def _mixed(share, first, second):
    return (1.0 - share) * first + share * second


def _with_gloss(reflectance, mirrored, covered):
    """Return the share that others get of light on something diffuse below something that mirrors."""
    return np.clip(reflectance * (1.0 - covered) + mirrored, 0.0, 1.0)


def _through_glass(through, opaque, metal, glass, colour):
    """Return what goes through one surface of a Principled BSDF; both of a pane multiply to its base colour."""
    return through + opaque * (1.0 - metal) * glass * np.sqrt(np.clip(colour, 0.0, 1.0))


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

_CLEAR = 0.999
"""Share of the light that is let through from which on a material counts as not being there."""

_STRETCHED = 4.0
"""Times that an image may be stretched until the longer way decides how much of it is averaged."""
