# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Objects, materials and bakes made in one line each, for the tests of the Blender side."""

import json
from contextlib import contextmanager

import bpy
import numpy as np
import pytest
from radiosity_bake.core.errors import NoLightError
from radiosity_bake.core.progress import Progress, no_progress
from radiosity_bake.core.result import BakedMesh, BakeResult
from radiosity_bake.operators import store

CUBE_VERTICES = [(x, y, z) for x in (-1.0, 1.0) for y in (-1.0, 1.0) for z in (-1.0, 1.0)]
CUBE_FACES = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]


def add_mesh(name, vertices, faces, *, materials=(), collection=None, select=False):
    """Return a new object, linked to `collection` or the scene's own."""
    mesh = bpy.data.meshes.new(name)
    mesh.from_pydata(vertices, [], faces)
    for material in materials:
        mesh.materials.append(material)
    return add_object(name, mesh, collection=collection, select=select)


def add_object(name, data, *, collection=None, select=False):
    obj = bpy.data.objects.new(name, data)
    (collection or bpy.context.scene.collection).objects.link(obj)
    if select:
        select_also(obj)
    return obj


def select_also(*objects):
    """Add objects to the selection, the last of them active."""
    for obj in objects:
        obj.select_set(True)
    bpy.context.view_layer.objects.active = objects[-1]


def add_cube(name="Cube", **options):
    return add_mesh(name, CUBE_VERTICES, CUBE_FACES, **options)


def add_plane(name="Plane", **options):
    """Return a square of edge 2 in the plane z = 0 that faces up."""
    return add_mesh(name, [(-1, -1, 0), (1, -1, 0), (1, 1, 0), (-1, 1, 0)], [(0, 1, 2, 3)], **options)


def add_lamp_mesh(name="Lamp Mesh", strength=5.0, **options):
    """Return a square above the scene that shines."""
    lamp = add_plane(name, materials=[emission_material(strength=strength)], **options)
    lamp.location.z = 3.0
    return lamp


def add_collection(name, parent=None):
    collection = bpy.data.collections.new(name)
    (parent or bpy.context.scene.collection).children.link(collection)
    return collection


def linked_from_library(folder, kind, name):
    """Return a datablock of the open file, which becomes a library in `folder`, linked into an empty file."""
    path = str(folder / "library.blend")
    bpy.ops.wm.save_as_mainfile(filepath=path)
    bpy.ops.wm.read_factory_settings(use_empty=True)
    with bpy.data.libraries.load(path, link=True) as (_, wanted):
        setattr(wanted, kind, [name])
    (linked,) = getattr(wanted, kind)
    return linked


def node_material(name, node_type, **inputs):
    """Return a material whose surface is one shader node; inputs are given by identifier, `_` standing for a space."""
    material = bpy.data.materials.new(name)
    tree = node_tree(material)
    node = tree.nodes.new(node_type)
    for identifier, value in inputs.items():
        socket_of(node, identifier.replace("_", " ")).default_value = value
    link_surface(tree, node)
    return material


def node_tree(owner):
    """Return the emptied node tree of a material, world or lamp, with an output node in it."""
    if bpy.app.version < (5, 0, 0):
        owner.use_nodes = True
    tree = owner.node_tree
    tree.nodes.clear()
    kinds = {bpy.types.World: "World", bpy.types.Light: "Light", bpy.types.Material: "Material"}
    tree.nodes.new(next(f"ShaderNodeOutput{name}" for kind, name in kinds.items() if isinstance(owner, kind)))
    return tree


def link_surface(tree, node):
    output = next(n for n in tree.nodes if n.type in {"OUTPUT_MATERIAL", "OUTPUT_WORLD"})
    tree.links.new(node.outputs[0], output.inputs["Surface"])


def socket_of(node, identifier):
    return next(socket for socket in node.inputs if socket.identifier == identifier)


def emission_material(name="Shine", colour=(1.0, 1.0, 1.0, 1.0), strength=5.0):
    return node_material(name, "ShaderNodeEmission", Color=colour, Strength=strength)


def diffuse_material(name="Paint", colour=(0.2, 0.4, 0.6, 1.0)):
    return node_material(name, "ShaderNodeBsdfDiffuse", Color=colour)


def use_image(material, identifier="Base Color"):
    """Feed one input of the material's shader from an image."""
    tree = material.node_tree
    shader = next(node for node in tree.nodes if socket_or_none(node, identifier) is not None)
    image = tree.nodes.new("ShaderNodeTexImage")
    tree.links.new(image.outputs[0], socket_or_none(shader, identifier))


def socket_or_none(node, identifier):
    return next((socket for socket in node.inputs if socket.identifier == identifier), None)


def bake_selected(output=None):
    """Bake what is selected, to the output that is given, if any."""
    if output is not None:
        bpy.context.scene.radiosity.output = output
    assert bpy.ops.radiosity.bake() == {"FINISHED"}


def report():
    """Return the report of the last bake."""
    return json.loads(bpy.context.scene.radiosity.report)


@contextmanager
def full_disk():
    """Have the last thing that storing does fail, after all objects were changed; and expect the bake to fail of it."""

    class Later(store.Journal):
        def __exit__(self, kind, error, trace):
            if error is not None:
                return super().__exit__(kind, error, trace)
            full = OSError("the disk is full")
            super().__exit__(OSError, full, None)
            raise full

    with pytest.MonkeyPatch.context() as patch, pytest.raises(RuntimeError, match="the disk is full"):
        patch.setattr(store, "Journal", Later)
        yield


def dark_bake(scene, settings, progress=no_progress):
    """Bake a scene that has no light."""
    raise NoLightError("Nothing in the scene emits light")


def position_bake(scene, settings, progress=no_progress, *, back=False):
    """Bake without light: radiosity is the world position of each corner, irradiance the half of it.

    `'REFINED'` cuts every triangle in two at the middle of its first edge.
    """
    progress(Progress("Form factors", 0.25, "no rays at all"))
    baked = tuple(
        _position_mesh(index, mesh, settings.output == "REFINED", back)
        for index, mesh in enumerate(scene.meshes)
        if mesh.baked
    )
    progress(Progress("Gathering", 1.0))
    triangles = sum(len(mesh.triangles) for mesh in baked)
    report = {"patches": 1, "vertices": 2, "rays": 3, "triangles": triangles, "seconds": {"total": 0.0}, "warnings": []}
    return BakeResult(baked, report)


def _position_mesh(index, mesh, refine, back):
    count = len(mesh.triangles)
    vertices, triangles = mesh.vertices.copy(), mesh.triangles.copy()
    parents, weights = np.arange(count), np.broadcast_to(np.eye(3), (count, 3, 3)).copy()
    if refine:
        middle = np.arange(count) + len(vertices)
        a, b, c = triangles.T
        vertices = np.concatenate([vertices, 0.5 * (vertices[a] + vertices[b])])
        triangles = np.concatenate([np.stack([a, middle, c], 1), np.stack([middle, b, c], 1)])
        first, second = np.eye(3), np.eye(3)
        first[1] = second[0] = (0.5, 0.5, 0.0)
        weights = np.repeat(np.stack([first, second]), count, axis=0)
        parents = np.concatenate([parents, parents])
    normals = np.einsum("skj,sjc->skc", weights, mesh.corner_normals[parents])
    length = np.linalg.norm(normals, axis=-1, keepdims=True)
    normals = np.divide(normals, length, out=np.zeros_like(normals), where=length > 0.0)
    colours = vertices[triangles]
    backs = (-colours, -0.5 * colours) if back else (None, None)
    return BakedMesh(index, vertices, triangles, parents, weights, normals, colours, 0.5 * colours, *backs)


def colours_of(mesh, name="Radiosity"):
    """Return (c, 4) the values of a colour attribute at the face corners."""
    attribute = mesh.color_attributes[name]
    values = np.empty(4 * len(attribute.data), dtype=np.float32)
    attribute.data.foreach_get("color", values)
    return values.reshape(-1, 4)


def corner_positions(obj):
    """Return (c, 3) the world position of each face corner."""
    mesh = obj.data
    vertices = np.empty(3 * len(mesh.vertices), dtype=np.float32)
    corners = np.empty(len(mesh.loops), dtype=np.int32)
    mesh.vertices.foreach_get("co", vertices)
    mesh.loops.foreach_get("vertex_index", corners)
    matrix = np.array(obj.matrix_world)
    return (vertices.reshape(-1, 3) @ matrix[:3, :3].T + matrix[:3, 3])[corners]
