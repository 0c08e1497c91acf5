# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Materials that only Blender can evaluate: Cycles bakes their colours into an image, a texel for each cell of a mesh.

It happens in a scratch scene, on a copy of the mesh in which each triangle has a place of its own in the image.
"""

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from typing import Any

import bpy
import numpy as np
from mathutils import Matrix

from ..core.errors import BakeError
from ..core.sampling import Singles
from ..core.scene import Floats, Ints
from ..core.textures import cell_centres
from .layers import Layers, Subdivision, carry, layers_of
from .light_paths import as_diffuse_rays_see, as_seen_from_all_sides
from .local_mesh import LocalMesh
from .object_random import asks_for_random, with_random
from .scratch import bake_in, scratch_scene
from .shaders import GLOSSY

TEXELS_PER_CELL = 3
"""Along an edge: then the middle of a cell, a third of its way, is the middle of a texel in all of them."""

_ATLAS = "Radiosity Scratch"

_WITHOUT_GLOSS = ("Specular IOR Level", "Coat Weight", "Sheen Weight")
"""Layers of the Principled BSDF that take light from the diffuse one below. They give it to the room all the same, so
the base colour is the better albedo."""

_LET_THROUGH = {"BSDF_TRANSPARENT", "BSDF_GLASS", "BSDF_REFRACTION"}

_DEPENDS_ON_PLACE = {"NEW_GEOMETRY", "CAMERA", "PARTICLE_INFO", "BEVEL", "AMBIENT_OCCLUSION"}
"""Nodes that may look different on another object of the same mesh."""


class NotEvaluatedError(Exception):
    """Blender could not evaluate a material; the text says why, in brackets."""


@dataclass(frozen=True, eq=False)
class Evaluation:
    """Colours of cells.

    Attributes
    ----------
    triangle : (k,) int
        Ascending.
    reflectance, emission : (cells, 3) float32
        Of the cells of one triangle after the other, in the order of `cell_centres`.
    transmittance : (cells, 3) float32 or None
        What goes straight through them; None where nothing does.
    mirrored : (cells, 3) float32 or None
        What metal and glossy shaders send on; None where there are none.
    """

    triangle: Ints
    reflectance: Singles
    emission: Singles
    transmittance: Singles | None = None
    mirrored: Singles | None = None

    def turned_over(self, along: Ints) -> "Evaluation":
        """The same colours for triangles wound the other way, with so many cells along the edges of each, (t,)."""
        cells = along[self.triangle]
        first = np.cumsum(cells**2) - cells**2
        order = np.concatenate([begin + _mirrored(int(count)) for begin, count in zip(first, cells, strict=True)])

        def turned(colours: Singles | None) -> Singles | None:
            return None if colours is None else colours[order]

        return Evaluation(
            self.triangle,
            self.reflectance[order],
            self.emission[order],
            turned(self.transmittance),
            turned(self.mirrored),
        )


@dataclass(frozen=True, eq=False)
class Template:
    """What is copied of a mesh to evaluate materials on it.

    Attributes
    ----------
    layers : Layers
    location, size : (3,) float
        The box that generated coordinates go through.
    """

    layers: Layers
    location: Floats
    size: Floats

    def place_of(
        self, obj: bpy.types.Object, matrix: Floats, random: float, materials: Iterable[bpy.types.Material]
    ) -> Any:
        """Return what else than the mesh materials may depend on: the object, where it is, and its number."""
        nodes = [node for material in materials for node in _nodes(material.node_tree)]
        return (
            (obj.name_full, matrix.tobytes()) if any(map(_depends_on_place, nodes)) else None,
            (tuple(obj.color), obj.pass_index) if any(node.type == "OBJECT_INFO" for node in nodes) else None,
            random if any(map(asks_for_random, nodes)) else None,
        )


def read_template(obj: bpy.types.Object) -> Template:
    """Return the layers and the texture space of an evaluated object."""
    mesh = obj.to_mesh()
    layers = layers_of(obj, mesh)
    obj.to_mesh_clear()
    data = obj.original.data
    if not isinstance(data, bpy.types.Mesh):
        corners = np.array(obj.bound_box)
        low, high = corners.min(axis=0), corners.max(axis=0)
        return Template(layers, (low + high) / 2.0, (high - low) / 2.0)
    return Template(layers, np.array(data.texspace_location), np.array(data.texspace_size))


def evaluate(
    obj: bpy.types.Object,
    template: Template,
    local: LocalMesh,
    materials: tuple[Any, ...],
    matrix: Floats,
    random: float,
    slot: Ints,
    wanted: np.ndarray,
    along: Ints,
) -> Evaluation:
    """Return the colours that Cycles bakes for some triangles of a mesh.

    Parameters
    ----------
    obj : Object
        The original that shows the mesh.
    materials : tuple of Material or None
        Of the slots.
    random : float, 0..1
        What an Object Info node tells.
    slot : (t,) int
    wanted : (t,) bool
    along : (t,) int
        Cells along the edge of each.

    Raises
    ------
    NotEvaluatedError
    """
    triangle = np.flatnonzero(wanted)
    corner, width, height = _places(along[triangle])
    try:
        with scratch_scene() as scene:
            image = bpy.data.images.new(_ATLAS, width, height, float_buffer=True)
            image.colorspace_settings.name = "Non-Color"
            mesh = _triangulated(template, local, slot)
            _spread(mesh, triangle, corner, along[triangle], width, height)
            for number in range(max(len(materials), 1)):
                known = number < len(materials) and np.any(slot[triangle] == number)
                mesh.materials.append(_bakeable(materials[number] if known else None, random, image))
            scratch = _object_like(obj, mesh, matrix)
            scene.collection.objects.link(scratch)
            _look_as(scene, bpy.context.scene)

            def colours(kind: str, **passes: Any) -> Singles:
                bake_in(
                    scene,
                    scratch,
                    type=kind,
                    target="IMAGE_TEXTURES",
                    margin=0,
                    use_clear=True,
                    uv_layer=_ATLAS,
                    **passes,
                )
                pixels = np.empty(4 * width * height, dtype=np.float32)
                image.pixels.foreach_get(pixels)
                return _of_cells(pixels.reshape(height, width, 4)[..., :3], corner, along[triangle])

            reflectance, emission = colours("DIFFUSE", pass_filter={"COLOR"}), colours("EMIT")
            transmittance = mirrored = None
            trees = [made.node_tree for made in mesh.materials]
            if any(_mirrors(node) for tree in trees for node in _nodes(tree)):
                mirrored = colours("GLOSSY", pass_filter={"COLOR"})
            if any(_lets_through(node) for tree in trees for node in _nodes(tree)):
                for tree in trees:
                    show_what_goes_through(tree)
                transmittance = colours("EMIT")
    except (BakeError, RuntimeError) as error:
        raise NotEvaluatedError(str(error).removeprefix("Error: ").strip().rstrip(".")) from error
    return Evaluation(triangle, reflectance, emission, transmittance, mirrored)


def _places(along: Ints) -> tuple[Ints, int, int]:
    """Return the lowest texel (k, 2) of a square for each triangle, and the size of an image that holds all."""
    side = TEXELS_PER_CELL * along + 1
    width = max(int(np.ceil(np.sqrt((side**2).sum()))), int(side.max()))
    corner = np.empty((len(along), 2), dtype=np.int64)
    height = 0
    for size in np.unique(side)[::-1]:
        same = np.flatnonzero(side == size)
        each = width // size
        row, column = np.divmod(np.arange(len(same)), each)
        corner[same] = np.stack([column * size, height + row * size], axis=1)
        height += int(size) * (int(row[-1]) + 1)
    return corner, width, height


def _triangulated(template: Template, local: LocalMesh, slot: Ints) -> bpy.types.Mesh:
    """Return the mesh cut into the very triangles of `local`, with all its layers and normals."""
    count = len(local.triangles)
    mesh = bpy.data.meshes.new(_ATLAS)
    mesh.vertices.add(len(local.vertices))
    mesh.vertices.foreach_set("co", local.vertices.astype(np.float32).reshape(-1))
    mesh.loops.add(3 * count)
    mesh.loops.foreach_set("vertex_index", local.triangles.astype(np.int32).reshape(-1))
    mesh.polygons.add(count)
    mesh.polygons.foreach_set("loop_start", np.arange(0, 3 * count, 3, dtype=np.int32))
    mesh.polygons.foreach_set("material_index", slot.astype(np.int32))
    mesh.update(calc_edges=True)
    itself = Subdivision(
        triangles=local.triangles,
        parent=np.arange(count),
        weights=np.tile(np.eye(3), (count, 1, 1)),
        parent_vertices=local.triangles,
        parent_corners=local.corners,
    )
    carry(mesh, template.layers, itself, lambda name: name)
    mesh.polygons.foreach_set("use_smooth", np.ones(count, dtype=bool))
    mesh.normals_split_custom_set(local.normals.astype(np.float32).reshape(-1, 3))
    mesh.use_auto_texspace = False
    mesh.texspace_location, mesh.texspace_size = template.location, template.size
    return mesh


def _spread(mesh: bpy.types.Mesh, triangle: Ints, corner: Ints, along: Ints, width: int, height: int) -> None:
    """Give each wanted triangle its place in the image, by a UV map of its own; the others lie outside as points."""
    layer = mesh.uv_layers.new(name=_ATLAS, do_init=False)
    if layer is None:
        raise NotEvaluatedError("the mesh has as many UV maps as a mesh can have")
    uv = np.full((len(mesh.polygons), 3, 2), -1.0)
    legs = TEXELS_PER_CELL * along[:, None, None] * np.array([(0, 0), (1, 0), (0, 1)])
    # The middle of the first cell, a third of its way, is that of the second texel.
    uv[triangle] = (corner[:, None] + 0.5 + legs) / (width, height)
    layer.uv.foreach_set("vector", uv.astype(np.float32).reshape(-1))


def _of_cells(texels: Singles, corner: Ints, along: Ints) -> Singles:
    """Return the colours of the cells (cells, 3) of one triangle after the other."""
    first = np.cumsum(along**2) - along**2
    colours = np.empty((int((along**2).sum()), 3), dtype=np.float32)
    for count in np.unique(along):
        same = np.flatnonzero(along == count)
        step = np.floor(cell_centres(int(count)).astype(np.float64) * TEXELS_PER_CELL * count + 0.75).astype(np.int64)
        at = corner[same, None] + step
        colours[first[same, None] + np.arange(count**2)] = texels[at[..., 1], at[..., 0]]
    return colours


def _mirrored(along: int) -> Ints:
    """Return which cell of a triangle lies at the place of each when corners 1 and 2 are exchanged."""
    u, v = cell_centres(along).T
    order = np.lexsort([np.round(v * 3 * along), np.round(u * 3 * along)])
    mirrored = np.lexsort([np.round(u * 3 * along), np.round(v * 3 * along)])
    result = np.empty(along**2, dtype=np.int64)
    result[order] = mirrored
    return result


def _bakeable(material: bpy.types.Material | None, random: float, image: bpy.types.Image) -> bpy.types.Material:
    """Return a copy of a material that bakes into an image, its colour not dimmed by gloss; or one that is empty."""
    if material is None:
        made = bpy.data.materials.new(_ATLAS)
        if bpy.app.version < (5, 0, 0):
            made.use_nodes = True
    else:
        made = material.original.copy()
        _copy_groups(made.node_tree)
        for node in _nodes(made.node_tree):
            if node.type == "BSDF_PRINCIPLED":
                for name in _WITHOUT_GLOSS:
                    _set_constant(node, name, 0.0)
            if node.type == "OUTPUT_MATERIAL":
                for link in node.inputs["Displacement"].links:
                    link.id_data.links.remove(link)
        trees = list(_trees(made.node_tree))
        as_diffuse_rays_see(trees)
        as_seen_from_all_sides(trees)
        with_random(trees, random)
    tree = made.node_tree
    target = tree.nodes.new("ShaderNodeTexImage")
    target.image = image
    tree.nodes.active = target
    return made


def _lets_through(node: bpy.types.Node) -> bool:
    if node.type == "BSDF_PRINCIPLED":
        sockets = {name: _socket(node, name) for name in ("Alpha", "Transmission Weight")}
        return any(
            socket.is_linked or socket.default_value != (1.0 if name == "Alpha" else 0.0)
            for name, socket in sockets.items()
        )
    return node.type in _LET_THROUGH


def _mirrors(node: bpy.types.Node) -> bool:
    if node.type == "BSDF_PRINCIPLED":
        metal = _socket(node, "Metallic")
        return metal.is_linked or metal.default_value > 0.0
    return node.type in GLOSSY


def left_out_of(tree: bpy.types.NodeTree) -> list[str]:
    """Return clauses on nodes that tell something else on a copy of an object which stands alone."""
    return list(dict.fromkeys(clause for node in _nodes(tree) for clause in _left_out(node)))


def _left_out(node: bpy.types.Node) -> Iterator[str]:
    linked = {socket.identifier for socket in node.outputs if socket.is_linked}
    if linked and (getattr(node, "from_instancer", False) or getattr(node, "attribute_type", "") == "INSTANCER"):
        yield f"{node.bl_label} asks for the instancer, which is left out; the object's own counts"
    if linked and node.type == "AMBIENT_OCCLUSION":
        yield "Ambient Occlusion sees the object alone"
    if linked.intersection({"TEX_COORD": {"Reflection"}, "NEW_GEOMETRY": {"Incoming"}}.get(node.type, ())):
        yield "what depends on where it is seen from counts as seen head on"


def show_what_goes_through(tree: bpy.types.NodeTree) -> None:
    """Exchange the shaders of a tree, and of the groups in it, for emission of the share of light they let through."""
    for node in list(tree.nodes):
        if node.type == "GROUP" and node.node_tree is not None:
            show_what_goes_through(node.node_tree)
        shaders = [socket for socket in node.outputs if socket.type == "SHADER"]
        if not shaders or node.type in {"MIX_SHADER", "ADD_SHADER", "GROUP", "GROUP_INPUT"}:
            continue
        emission = tree.nodes.new("ShaderNodeEmission")
        emission.inputs["Color"].default_value = (0.0, 0.0, 0.0, 1.0)
        if node.type in _LET_THROUGH:
            _feed(tree, emission.inputs["Color"], _socket(node, "Color"))
        elif node.type == "BSDF_PRINCIPLED":
            _feed(tree, emission.inputs["Color"], _through_principled(tree, node))
        for link in list(shaders[0].links):
            tree.links.new(emission.outputs[0], link.to_socket)


def _through_principled(tree: bpy.types.NodeTree, node: bpy.types.Node) -> bpy.types.NodeSocket:
    """Return 1 - alpha (1 - (1 - metallic) transmission sqrt(colour)), as `materials` has it."""
    root = tree.nodes.new("ShaderNodeGamma")
    _feed(tree, root.inputs["Color"], _socket(node, "Base Color"))
    root.inputs["Gamma"].default_value = 0.5
    black, white = (0.0, 0.0, 0.0, 1.0), (1.0, 1.0, 1.0, 1.0)
    glass = _between(tree, _socket(node, "Transmission Weight"), black, root.outputs[0])
    bright = _between(tree, _socket(node, "Metallic"), glass, black)
    return _between(tree, _socket(node, "Alpha"), white, bright)


def _between(tree: bpy.types.NodeTree, share: bpy.types.NodeSocket, first: Any, second: Any) -> bpy.types.NodeSocket:
    """Return a colour that goes from the first to the second as the share does from 0 to 1."""
    mix = tree.nodes.new("ShaderNodeMix")
    mix.data_type = "RGBA"
    _feed(tree, _socket(mix, "Factor_Float"), share)
    for name, colour in (("A_Color", first), ("B_Color", second)):
        if isinstance(colour, tuple):
            _socket(mix, name).default_value = colour
        else:
            tree.links.new(colour, _socket(mix, name))
    return next(socket for socket in mix.outputs if socket.identifier == "Result_Color")


def _feed(tree: bpy.types.NodeTree, socket: bpy.types.NodeSocket, source: bpy.types.NodeSocket) -> None:
    """Give a socket what another input or output has, or is linked to."""
    if source.is_output:
        tree.links.new(source, socket)
    elif source.is_linked:
        tree.links.new(source.links[0].from_socket, socket)
    else:
        socket.default_value = source.default_value


def _socket(node: bpy.types.Node, identifier: str) -> bpy.types.NodeSocket:
    return next(socket for socket in node.inputs if socket.identifier == identifier)


def _set_constant(node: bpy.types.Node, name: str, value: float) -> None:
    socket = next((found for found in node.inputs if found.identifier == name), None)
    if socket is not None:
        for link in socket.links:
            node.id_data.links.remove(link)
        socket.default_value = value


def _look_as(scene: bpy.types.Scene, shown: bpy.types.Scene) -> None:
    """Give a scratch scene what nodes may ask another for: its frame, its camera, and properties of the user's own."""
    scene.frame_current, scene.camera = shown.frame_current, shown.camera
    for owner, model in ((scene, shown), (scene.view_layers[0], bpy.context.view_layer)):
        _copy_own_properties(owner, model)
    for name in ("resolution_x", "resolution_y", "resolution_percentage", "pixel_aspect_x", "pixel_aspect_y"):
        setattr(scene.render, name, getattr(shown.render, name))


def _copy_own_properties(owner: Any, model: Any) -> None:
    """Copy the properties that the user gave something."""
    for name, value in model.items():
        # Before Blender 5, those of add-ons and engines are among them.
        if name not in model.bl_rna.properties:
            owner[name] = value


def _copy_groups(tree: bpy.types.NodeTree) -> None:
    """Give the groups of a tree trees of their own, which may be changed."""
    for node in tree.nodes:
        if node.type == "GROUP" and node.node_tree is not None:
            node.node_tree = node.node_tree.copy()
            _copy_groups(node.node_tree)


def _trees(tree: bpy.types.NodeTree | None) -> Iterator[bpy.types.NodeTree]:
    """Yield a tree and those of the groups in it."""
    if tree is None:
        return
    yield tree
    for node in tree.nodes:
        if node.type == "GROUP":
            yield from _trees(node.node_tree)


def _nodes(tree: bpy.types.NodeTree | None) -> Iterator[bpy.types.Node]:
    """Yield all nodes of a tree and of the groups in it."""
    for part in _trees(tree):
        yield from part.nodes


def _depends_on_place(node: bpy.types.Node) -> bool:
    if node.type == "TEX_COORD":
        return any(socket.is_linked and socket.identifier not in {"UV", "Generated"} for socket in node.outputs)
    if node.type == "OBJECT_INFO":
        return any(socket.is_linked and socket.identifier == "Location" for socket in node.outputs)
    return node.type in _DEPENDS_ON_PLACE or (node.type == "ATTRIBUTE" and node.attribute_type != "GEOMETRY")


def _object_like(obj: bpy.types.Object, mesh: bpy.types.Mesh, matrix: Floats) -> bpy.types.Object:
    """Return an object that shows `mesh` where `obj` was, with its colour, index and custom properties."""
    if obj.type == "MESH":
        made = obj.copy()
        made.animation_data_clear()
        made.constraints.clear()
        made.modifiers.clear()
        made.parent = None
        for slot in made.material_slots:
            slot.link = "DATA"
        made.data = mesh
    else:
        made = bpy.data.objects.new(_ATLAS, mesh)
        made.color, made.pass_index = obj.color, obj.pass_index
        _copy_own_properties(made, obj)
    made.hide_render = made.hide_viewport = made.is_holdout = False
    made.matrix_world = Matrix(matrix)
    return made
