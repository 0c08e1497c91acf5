# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Display materials with the original's textures: its colours times the baked irradiance, plus what it emits.

Each is a copy of the original material whose shaders are exchanged for one emission shader, so that the images and all
other nodes that colours come from stay as they are.
"""

from dataclasses import dataclass, replace

import bpy
import numpy as np

from . import display
from .attributes import IRRADIANCE, Attributes
from .display import Shown
from .journal import Journal
from .materials import material_surface, uses_nodes
from .shaders import GREY, NOT_DIFFUSE
from .varying import varies

_DIFFUSE = {"BSDF_DIFFUSE", "SUBSURFACE_SCATTERING", "BSDF_SHEEN", "BSDF_TOON"}
"""Shaders whose colour counts as that of a diffuse surface, as in the bake."""
_BLACK = (0.0, 0.0, 0.0)
_GREY = (GREY, GREY, GREY)
_WHITE = (1.0, 1.0, 1.0)
_ABOVE = 400.0
"""Where new nodes begin, above those that the material had."""

Value = tuple[float, float, float] | bpy.types.NodeSocket
"""A colour that is known, or the socket that it comes out of."""


class UnsupportedShaderError(Exception):
    """A material has a shader that cannot be exchanged."""


@dataclass(frozen=True)
class _Look:
    """What a shader does to light, where it is opaque, and how opaque it is."""

    reflected: Value = _BLACK
    emitted: Value = _BLACK
    alpha: Value = _WHITE


class Displays:
    """The display materials of one bake, made as they are asked for."""

    def __init__(self, attributes: Attributes, journal: Journal) -> None:
        self._attributes, self._journal = attributes, journal
        self._made: dict[tuple[bpy.types.Material | None, bool], bpy.types.Material] = {}
        self._has_textures: dict[bpy.types.Material | None, bool] = {}
        self.cautions: list[str] = []
        """Sentences on materials that could not be shown with their textures."""

    def of(self, original: bpy.types.Material | None, both_sides: bool) -> bpy.types.Material:
        """Return the material that shows the bake on a surface with the material `original`."""
        if display.is_display(original) or not self._shows_textures(original):
            return self._plain(both_sides)
        key = (original, both_sides)
        if key not in self._made:
            try:
                self._made[key] = self._textured(original, both_sides)
            except UnsupportedShaderError:
                # Its colours are in the radiosity, one for each vertex.
                self._made[key] = self._plain(both_sides)
                sentence = (
                    f'Material "{original.name}" mixes shaders in a way that cannot be shown with textures: '
                    "it shows one colour for each vertex"
                )
                if sentence not in self.cautions:
                    self.cautions.append(sentence)
        return self._made[key]

    def _shows_textures(self, original: bpy.types.Material | None) -> bool:
        settings = self._attributes.settings
        if settings.material != "AUTOMATIC":
            return settings.material == "TEXTURED"
        if original not in self._has_textures:
            surface = material_surface(original)
            # What is seen through it, one colour for each vertex would hide.
            self._has_textures[original] = bool(surface.unread or varies(*surface.colours()) or np.any(surface.through))
        # Lighting alone is asked for to be seen without colours.
        return self._has_textures[original] and settings.light != "IRRADIANCE"

    def _shown(self, quantity: str, both_sides: bool) -> Shown:
        named = self._attributes
        back = named.name(quantity, back=True) if both_sides else None
        emits = named.settings.light != "INDIRECT"
        return Shown(named.name(quantity), back, named.maxima[quantity], emits)

    def _plain(self, both_sides: bool) -> bpy.types.Material:
        return display.display_material(self._shown(self._attributes.quantity_shown(), both_sides), self._journal)

    def _textured(self, original: bpy.types.Material | None, both_sides: bool) -> bpy.types.Material:
        shown = self._shown(IRRADIANCE, both_sides)
        if original is None:
            material = display.new_material(_name(original), self._journal)
            show_on_grey(material, shown)
        else:
            material = original.copy()
            self._journal.on_failure(_remove_with_groups, material)
            material.name = _name(original)
            try:
                exchange_shaders(material, shown)
            except UnsupportedShaderError:
                self._journal.take_back_last()
                raise
        display.mark(material, "TEXTURED")
        return material

    def take_names(self) -> None:
        """Give the materials their names once those of an earlier bake are gone."""
        for (original, _), material in self._made.items():
            if material.get(display.MARK) == "TEXTURED":
                material.name = _name(original)


def _name(original: bpy.types.Material | None) -> str:
    return f"{'Grey' if original is None else original.name} Radiosity"


def _remove_with_groups(material: bpy.types.Material) -> None:
    bpy.data.materials.remove(material)
    display.remove_unused_groups()


def exchange_shaders(material: bpy.types.Material, shown: Shown) -> None:
    """Exchange the shaders of `material`, a copy of an original, for one that shows baked irradiance.

    Raises
    ------
    UnsupportedShaderError
        When they let light through in a way that one mix cannot show, or come into a group from outside.
    """
    if not uses_nodes(material):
        colour = tuple(material.diffuse_color[:3])
        material.use_nodes = True
        material.node_tree.nodes.clear()
        _show(_Nodes(material.node_tree), _Look(reflected=colour), shown, None)
        return
    tree = material.node_tree
    output = tree.get_output_node("CYCLES")
    if output is None:
        raise UnsupportedShaderError
    nodes = _Nodes(tree)
    look = nodes.look(output.inputs["Surface"])
    displacement = _source(output.inputs["Displacement"])
    for node in [node for node in tree.nodes if node.type == "OUTPUT_MATERIAL"]:
        tree.nodes.remove(node)
    _show(nodes, look, shown, displacement)
    for group in nodes.groups:
        _remove_shaders(group)
    _remove_unused(tree, "OUTPUT_MATERIAL")


def show_on_grey(material: bpy.types.Material, shown: Shown) -> None:
    """Have `material` show baked irradiance on the grey that a mesh without a material has."""
    material.node_tree.nodes.clear()
    _show(_Nodes(material.node_tree), _Look(reflected=_GREY), shown, None)


def _show(nodes: "_Nodes", look: _Look, shown: Shown, displacement: bpy.types.NodeSocket | None) -> None:
    """Make the shaders and outputs that show `look`.

    The glTF exporter of Blender knows an unlit material by the switch for camera rays, and its vertex colours by one
    multiplication. Where that cannot hold all there is to see, the renderers get outputs of their own.
    """
    if not shown.emits:
        look = replace(look, emitted=_BLACK)
    front = irradiance = nodes.attribute(shown.front)
    if shown.back is not None:
        irradiance = nodes.mix(nodes.backfacing(), front, nodes.attribute(shown.back))
    outputs = []
    if look.emitted != _BLACK:
        # The exporter takes no colour above 1, but any strength, of the first emission shader that there is.
        strength = max(1.0, *look.emitted) if _known(look.emitted) else 1.0
        lamp = nodes.emission(nodes.multiply(look.emitted, (1.0 / strength,) * 3), strength)
        outputs.append(nodes.output(nodes.behind(look.alpha, lamp), "ALL"))
    elif irradiance is not front:
        one_sided = nodes.emission(nodes.multiply(look.reflected, front), shown.strength)
        outputs.append(nodes.output(nodes.behind(look.alpha, nodes.camera_switch(one_sided)), "ALL"))
    emitted = nodes.multiply(look.emitted, (1.0 / shown.strength,) * 3)
    seen = nodes.emission(nodes.add(nodes.multiply(look.reflected, irradiance), emitted), shown.strength)
    shader = nodes.behind(look.alpha, nodes.camera_switch(seen))
    outputs += [nodes.output(shader, target) for target in (("CYCLES", "EEVEE") if outputs else ("ALL",))]
    for output in outputs:
        if displacement is not None:
            nodes.tree.links.new(displacement, output.inputs["Displacement"])


class _Nodes:
    """Makes nodes in a tree, but none for what is known without."""

    def __init__(self, tree: bpy.types.NodeTree) -> None:
        self.tree = tree
        self.groups: list[bpy.types.NodeTree] = []
        """Copies of node groups whose shaders give colours instead."""
        self._made = 0

    def look(self, socket: bpy.types.NodeSocket) -> _Look:
        """Return what is linked to a shader socket; an open one is black."""
        output = _source(socket)
        if output is None:
            return _Look()
        node = output.node
        if output.type == "RGBA":
            return _Look(emitted=output)
        if node.type == "BSDF_PRINCIPLED":
            reflected = self.multiply(self.input(node, "Base Color"), self.rest(self.input(node, "Metallic")))
            emitted = self.multiply(self.input(node, "Emission Color"), self.input(node, "Emission Strength"))
            alpha, not_glass = self.input(node, "Alpha"), self.rest(self.input(node, "Transmission Weight"))
            if emitted == _BLACK:
                return _Look(reflected, emitted, self.multiply(alpha, not_glass))
            return _Look(self.multiply(reflected, not_glass), emitted, alpha)
        if node.type == "EMISSION":
            return _Look(emitted=self.multiply(self.input(node, "Color"), self.input(node, "Strength")))
        if node.type in {"BSDF_TRANSPARENT", "BSDF_GLASS", "BSDF_REFRACTION"}:
            return _Look(alpha=_BLACK)
        if node.type in _DIFFUSE:
            return _Look(self.input(node, "Color"))
        if node.type == "MIX_SHADER":
            return self._mixed(self.input(node, "Fac"), self.look(node.inputs[1]), self.look(node.inputs[2]))
        if node.type == "ADD_SHADER":
            return self._added(self.look(node.inputs[0]), self.look(node.inputs[1]))
        if node.type == "GROUP":
            return self._look_inside(node, output)
        if node.type == "GROUP_INPUT":
            raise UnsupportedShaderError
        if node.type == "BSDF_TRANSLUCENT":
            # It shows light of both sides.
            raise UnsupportedShaderError
        return _Look() if node.type in NOT_DIFFUSE else _Look(_GREY)

    def _look_inside(self, node: bpy.types.Node, output: bpy.types.NodeSocket) -> _Look:
        """Return what a group's shader does, as colours that a copy of the group gives."""
        if node.node_tree is None:
            return _Look()
        # Another output of the same node may have been looked at before.
        if display.MARK not in node.node_tree:
            node.node_tree = node.node_tree.copy()
        group = node.node_tree
        group[display.MARK] = "GROUP"
        inside = next((each for each in group.nodes if each.type == "GROUP_OUTPUT" and each.is_active_output), None)
        if inside is None:
            return _Look()
        nodes = _Nodes(group)
        look = nodes.look(next(socket for socket in inside.inputs if socket.identifier == output.identifier))
        self.groups += [*nodes.groups, group]

        def handed_out(name: str, value: Value) -> Value:
            if _known(value):
                return value
            item = group.interface.new_socket(name, in_out="OUTPUT", socket_type="NodeSocketColor")
            group.links.new(value, next(each for each in inside.inputs if each.identifier == item.identifier))
            return next(each for each in node.outputs if each.identifier == item.identifier)

        return _Look(
            handed_out("Reflected", look.reflected),
            handed_out("Emitted", look.emitted),
            handed_out("Opaque", look.alpha),
        )

    def _mixed(self, share: Value, first: _Look, second: _Look) -> _Look:
        alpha = self.mix(share, first.alpha, second.alpha)
        if first.alpha == _BLACK:
            return _Look(second.reflected, second.emitted, alpha)
        if second.alpha == _BLACK:
            return _Look(first.reflected, first.emitted, alpha)
        if first.alpha != _WHITE or second.alpha != _WHITE:
            raise UnsupportedShaderError
        return _Look(
            self.mix(share, first.reflected, second.reflected), self.mix(share, first.emitted, second.emitted), alpha
        )

    def _added(self, first: _Look, second: _Look) -> _Look:
        if first.alpha != _WHITE or second.alpha != _WHITE:
            raise UnsupportedShaderError
        return _Look(self.add(first.reflected, second.reflected), self.add(first.emitted, second.emitted))

    def input(self, node: bpy.types.Node, identifier: str) -> Value:
        """Return what reaches an input of a node; a number as a grey."""
        socket = next(socket for socket in node.inputs if socket.identifier == identifier)
        source = _source(socket)
        if source is not None:
            return source
        value = socket.default_value
        return (value,) * 3 if isinstance(value, float | int) else tuple(value[:3])

    def multiply(self, a: Value, b: Value) -> Value:
        if _BLACK in (a, b):
            return _BLACK
        if _WHITE in (a, b):
            return b if a == _WHITE else a
        if _known(a) and _known(b):
            return tuple(x * y for x, y in zip(a, b, strict=True))
        return self._mix_node("MULTIPLY", _WHITE, a, b)

    def add(self, a: Value, b: Value) -> Value:
        if _BLACK in (a, b):
            return b if a == _BLACK else a
        if _known(a) and _known(b):
            return tuple(x + y for x, y in zip(a, b, strict=True))
        return self._mix_node("ADD", _WHITE, a, b)

    def mix(self, share: Value, a: Value, b: Value) -> Value:
        """Return `a` where the share is 0 and `b` where it is 1."""
        if a == b:
            return a
        if _known(share):
            return self.add(self.multiply(self.rest(share), a), self.multiply(share, b))
        return self._mix_node("MIX", share, a, b)

    def rest(self, share: Value) -> Value:
        """Return what a share leaves of 1."""
        if _known(share):
            return tuple(1.0 - min(max(x, 0.0), 1.0) for x in share)
        return self._mix_node("SUBTRACT", _WHITE, _WHITE, share)

    def attribute(self, name: str) -> bpy.types.NodeSocket:
        node = self._new("ShaderNodeVertexColor")
        node.layer_name = name
        return node.outputs["Color"]

    def backfacing(self) -> bpy.types.NodeSocket:
        return self._new("ShaderNodeNewGeometry").outputs["Backfacing"]

    def emission(self, colour: Value, strength: float = 1.0) -> bpy.types.NodeSocket:
        node = self._new("ShaderNodeEmission")
        self._set(node.inputs["Color"], colour)
        node.inputs["Strength"].default_value = strength
        return node.outputs[0]

    def behind(self, alpha: Value, shader: bpy.types.NodeSocket) -> bpy.types.NodeSocket:
        """Return a shader that lets through what `alpha` leaves."""
        if alpha == _WHITE:
            return shader
        node = self._new("ShaderNodeMixShader")
        self._set(node.inputs[0], alpha)
        self.tree.links.new(self._new("ShaderNodeBsdfTransparent").outputs[0], node.inputs[1])
        self.tree.links.new(shader, node.inputs[2])
        return node.outputs[0]

    def camera_switch(self, shader: bpy.types.NodeSocket) -> bpy.types.NodeSocket:
        """Return the shader for camera rays and for all others."""
        node = self._new("ShaderNodeMixShader")
        self.tree.links.new(self._new("ShaderNodeLightPath").outputs["Is Camera Ray"], node.inputs[0])
        self.tree.links.new(shader, node.inputs[1])
        self.tree.links.new(shader, node.inputs[2])
        return node.outputs[0]

    def output(self, shader: bpy.types.NodeSocket, target: str) -> bpy.types.Node:
        node = self._new("ShaderNodeOutputMaterial")
        node.target = target
        # Renderers take their own output, active or not; the exporter takes the active one.
        node.is_active_output = target == "ALL"
        self.tree.links.new(shader, node.inputs["Surface"])
        return node

    def _mix_node(self, kind: str, share: Value, a: Value, b: Value) -> bpy.types.NodeSocket:
        node = self._new("ShaderNodeMix")
        node.data_type, node.blend_type = "RGBA", kind
        for identifier, value in (("Factor_Float", share), ("A_Color", a), ("B_Color", b)):
            self._set(next(socket for socket in node.inputs if socket.identifier == identifier), value)
        return next(socket for socket in node.outputs if socket.identifier == "Result_Color")

    def _set(self, socket: bpy.types.NodeSocket, value: Value) -> None:
        if not _known(value):
            self.tree.links.new(value, socket)
        elif socket.type == "VALUE":
            socket.default_value = value[0]
        else:
            socket.default_value = (*value, 1.0)

    def _new(self, kind: str) -> bpy.types.Node:
        node = self.tree.nodes.new(kind)
        node.location = (200.0 * self._made, _ABOVE)
        self._made += 1
        return node


def _known(value: Value) -> bool:
    return isinstance(value, tuple)


def _source(socket: bpy.types.NodeSocket) -> bpy.types.NodeSocket | None:
    """Return the output that feeds `socket`, through reroutes and muted nodes, if there is one."""
    while True:
        link = next((link for link in socket.links if link.is_valid and not link.is_muted), None)
        if link is None:
            return None
        if link.from_node.type == "REROUTE":
            socket = link.from_node.inputs[0]
        elif link.from_node.mute:
            inner = next((i for i in link.from_node.internal_links if i.to_socket == link.from_socket), None)
            if inner is None:
                return None
            socket = inner.from_socket
        else:
            return link.from_socket


def _remove_shaders(group: bpy.types.NodeTree) -> None:
    """Remove the shaders that a group gave, which nothing uses any more."""
    for item in list(group.interface.items_tree):
        if item.item_type == "SOCKET" and item.in_out == "OUTPUT" and item.socket_type == "NodeSocketShader":
            group.interface.remove(item)
    _remove_unused(group, "GROUP_OUTPUT")


def _remove_unused(tree: bpy.types.NodeTree, outputs: str) -> None:
    """Remove the nodes that no output shows: exporters read shaders that are linked to nothing, too."""
    used: set[bpy.types.Node] = set()
    pending = [node for node in tree.nodes if node.type == outputs]
    while pending:
        node = pending.pop()
        if node not in used:
            used.add(node)
            pending += [link.from_node for socket in node.inputs for link in socket.links]
    for node in [node for node in tree.nodes if node not in used and node.type != "FRAME"]:
        tree.nodes.remove(node)
