# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""What a material means for radiosity: one reflectance and one emission, read from the constants of its nodes."""

from collections.abc import Iterable
from dataclasses import dataclass

import bpy
import numpy as np
from numpy.typing import NDArray

from .display import is_display

Colour = NDArray[np.float64]

GREY = 0.8
"""Reflectance of a mesh without a material: what Blender's own default shows."""

_DIFFUSE_LIKE = {
    "SUBSURFACE_SCATTERING": "scatters light below the surface",
    "BSDF_SHEEN": "reflects at grazing angles",
    "BSDF_TOON": "is no physical shader",
}
NOT_DIFFUSE = {
    "BSDF_GLOSSY",
    "BSDF_METALLIC",
    "BSDF_GLASS",
    "BSDF_REFRACTION",
    "BSDF_TRANSPARENT",
    "BSDF_TRANSLUCENT",
    "BSDF_HAIR",
    "BSDF_HAIR_PRINCIPLED",
    "HOLDOUT",
}
_DEEPEST_NESTING = 64
"""Node trees have no cycles that render; this only ends a walk through a broken one."""


@dataclass(frozen=True, eq=False)
class Surface:
    """What a material does to light.

    Attributes
    ----------
    reflectance : (3,) float, 0..1
        Diffuse albedo, linear RGB.
    emission : (3,) float, W m^-2 sr^-1
        Emitted radiance, linear RGB.
    notes : tuple of str
        What was skipped or guessed, each a clause to follow the material's name and a colon.
    """

    reflectance: Colour
    emission: Colour
    notes: tuple[str, ...] = ()


def _surface(reflectance: object = 0.0, emission: object = 0.0, notes: Iterable[str] = ()) -> Surface:
    def colour(value: object) -> Colour:
        return np.array(np.broadcast_to(np.asarray(value, dtype=np.float64), (3,)))

    return Surface(colour(reflectance), colour(emission), tuple(notes))


def uses_nodes(owner: bpy.types.Material | bpy.types.World | bpy.types.Light) -> bool:
    """Return whether a material, world or lamp is made of nodes."""
    # From Blender 5.0 on nodes are always used, and asking warns that the property goes away.
    return owner.node_tree is not None and (bpy.app.version >= (5, 0, 0) or owner.use_nodes)


def material_surface(material: bpy.types.Material | None) -> Surface:
    """Return what `material` does to light; None is the grey of a mesh without a material."""
    if material is None:
        return _surface(GREY)
    if is_display(material):
        return _surface(GREY, notes=["it shows an earlier bake; plain grey was used instead"])
    if not uses_nodes(material):
        return _surface(np.clip(material.diffuse_color[:3], 0.0, 1.0))
    shader = _ShaderReader(material.node_tree).surface()
    reflectance = np.clip(shader.reflectance, 0.0, 1.0)
    if np.any(reflectance != shader.reflectance):
        return _surface(
            reflectance, shader.emission, [*shader.notes, "its colour is brighter than white; white was used instead"]
        )
    return shader


def world_radiance(world: bpy.types.World | None) -> tuple[Colour, tuple[str, ...]]:
    """Return the radiance of a constant world, and what was skipped of any other.

    Returns
    -------
    radiance : (3,) float, W m^-2 sr^-1
        Zero for a scene without a world and for a world with textures.
    notes : tuple of str
    """
    if world is None:
        return np.zeros(3), ()
    if not uses_nodes(world):
        return np.array(world.color[:3], dtype=np.float64), ()
    shader = _ShaderReader(world.node_tree).surface()
    if shader.notes:
        return np.zeros(3), tuple(f"{note.split(';')[0]}; the world was left dark" for note in shader.notes)
    return shader.emission, ()


def lamp_factor(light: bpy.types.Light) -> tuple[Colour, tuple[str, ...]]:
    """Return what a lamp's nodes multiply its colour and power by, and what was skipped of them.

    Returns
    -------
    factor : (3,) float
    notes : tuple of str
    """
    if not uses_nodes(light):
        return np.ones(3), ()
    shader = _ShaderReader(light.node_tree).surface()
    return shader.emission, shader.notes


class _ShaderReader:
    """Follows the links of one node tree, in and out of groups, from its output to constants."""

    def __init__(self, tree: bpy.types.NodeTree) -> None:
        self.tree = tree
        self.notes: list[str] = []

    def surface(self) -> Surface:
        output = self.tree.get_output_node("CYCLES")
        if output is None:
            return _surface()
        reflectance, emission = self._shader(_input(output, "Surface"), ())
        if np.any(emission < 0.0):
            self.notes.append("its emission is negative; it was taken for zero")
            emission = np.maximum(emission, 0.0)
        return _surface(reflectance, emission, dict.fromkeys(self.notes))

    def _shader(self, socket, groups) -> tuple[Colour, Colour]:
        """Return reflectance and emission of whatever is linked to a shader socket; an open one is black."""
        nothing = np.zeros(3), np.zeros(3)
        output, groups = self._source(socket, groups)
        if output is None:
            return nothing
        node = output.node
        if node.type == "BSDF_PRINCIPLED":
            return self._principled(node, groups)
        if node.type in {"EMISSION", "BACKGROUND"}:
            return np.zeros(3), self._colour(node, "Color", groups) * self._value(node, "Strength", groups)
        if node.type == "BSDF_DIFFUSE":
            return self._colour(node, "Color", groups), np.zeros(3)
        if node.type == "MIX_SHADER":
            share = min(max(self._value(node, "Fac", groups), 0.0), 1.0)
            first, second = self._shader(node.inputs[1], groups), self._shader(node.inputs[2], groups)
            return tuple((1.0 - share) * a + share * b for a, b in zip(first, second, strict=True))
        if node.type == "ADD_SHADER":
            first, second = self._shader(node.inputs[0], groups), self._shader(node.inputs[1], groups)
            return tuple(a + b for a, b in zip(first, second, strict=True))
        return self._unsupported(node, groups)

    def _principled(self, node, groups) -> tuple[Colour, Colour]:
        diffuse = 1.0 - min(max(self._value(node, "Metallic", groups), 0.0), 1.0)
        diffuse *= 1.0 - min(max(self._value(node, "Transmission Weight", groups), 0.0), 1.0)
        reflectance = self._colour(node, "Base Color", groups) * diffuse if diffuse > 0.0 else np.zeros(3)
        strength = self._value(node, "Emission Strength", groups)
        emission = self._colour(node, "Emission Color", groups) * strength if strength != 0.0 else np.zeros(3)
        if self._value(node, "Alpha", groups) < 1.0:
            self.notes.append("transparency (Alpha) is not supported yet; it counts as opaque")
        return reflectance, emission

    def _unsupported(self, node, groups) -> tuple[Colour, Colour]:
        name = _title(node)
        if node.type in _DIFFUSE_LIKE:
            self.notes.append(f"{name} {_DIFFUSE_LIKE[node.type]}; it counts as diffuse")
            return self._colour(node, "Color", groups), np.zeros(3)
        if node.type in NOT_DIFFUSE:
            self.notes.append(f"{name} reflects no diffuse light; that part counts as black")
            return np.zeros(3), np.zeros(3)
        self.notes.append(f"{name} is not supported; that part counts as grey")
        return np.full(3, GREY), np.zeros(3)

    def _colour(self, node, identifier: str, groups) -> Colour:
        value = self._constant(node, identifier, groups)
        return np.full(3, value) if isinstance(value, float) else np.array(value[:3], dtype=np.float64)

    def _value(self, node, identifier: str, groups) -> float:
        value = self._constant(node, identifier, groups)
        return value if isinstance(value, float) else float(np.mean(value[:3]))

    def _constant(self, node, identifier: str, groups) -> float | tuple[float, ...]:
        """Return the constant that reaches an input; one that varies over the surface counts as its socket's value."""
        socket = _input(node, identifier)
        output, outer = self._source(socket, groups)
        if output is None:
            # An open input inside a group may have led out to the group node, whose own socket then has the value.
            return _default(outer)
        if output.node.type in {"VALUE", "RGB"}:
            return _default(output)
        self.notes.append(
            f"{socket.name} comes from {_title(output.node)}, which is not supported yet; "
            f"the {'value' if socket.type == 'VALUE' else 'colour'} set on its socket was used instead"
        )
        return _default(socket)

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


def _default(socket) -> float | tuple[float, ...]:
    value = socket.default_value
    return float(value) if isinstance(value, float | int) else tuple(value)
