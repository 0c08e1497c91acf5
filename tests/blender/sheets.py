# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Sheets with materials that vary over them, and their colours by Cycles and by us."""

import bpy
import numpy as np
from radiosity_bake.core.textures import mean_colours
from radiosity_bake.operators.extraction import extract

from tests.blender.making import (
    add_mesh,
    colours_of,
    node_material,
    select_also,
    socket_of,
)

CELLS = 6


def add_sheet(material, cells=CELLS):
    """Return a bent square sheet of quads with UV maps "First" (to render) and "Second", and a colour attribute."""
    side = np.linspace(-1.0, 1.0, cells + 1)
    row = cells + 1
    quads = [(a, a + 1, a + row + 1, a + row) for j in range(cells) for a in range(j * row, j * row + cells)]
    sheet = add_mesh("Sheet", [(x, y, 0.2 * x * x) for y in side for x in side], quads, materials=[material])
    mesh = sheet.data
    corners = np.array([mesh.vertices[loop.vertex_index].co[:2] for loop in mesh.loops])
    for name, uv in (("First", corners * 0.5 + 0.5), ("Second", corners[:, ::-1] * 0.9 + 0.1)):
        layer = mesh.uv_layers.new(name=name)
        layer.uv.foreach_set("vector", uv.astype(np.float32).reshape(-1))
    mesh.uv_layers["First"].active_render = True
    colours = mesh.color_attributes.new("Paint", "FLOAT_COLOR", "POINT")
    values = np.column_stack([np.random.default_rng(5).random((len(mesh.vertices), 3)), np.ones(len(mesh.vertices))])
    colours.data.foreach_set("color", values.astype(np.float32).reshape(-1))
    mesh.color_attributes.render_color_index = 0
    return sheet


def smooth_image(name="Picture", size=(32, 24), space="sRGB", is_float=False, **settings):
    """Return an image of colours that change slowly, so that a place and its surroundings are about the same."""
    image = bpy.data.images.new(name, *size, alpha=True, float_buffer=is_float)
    image.colorspace_settings.name = space
    x, y = np.meshgrid(np.arange(size[0]) / size[0] * 2 * np.pi, np.arange(size[1]) / size[1] * 2 * np.pi)
    channels = [0.5 + 0.4 * np.sin(x), 0.5 + 0.4 * np.cos(y), 0.5 + 0.3 * np.sin(x + y), np.ones_like(x)]
    image.pixels.foreach_set(np.stack(channels, axis=-1).astype(np.float32).reshape(-1))
    for key, value in settings.items():
        setattr(image, key, value)
    return image


def painted(build, shader="ShaderNodeBsdfDiffuse", socket="Color", **inputs):
    """Return a material one input of which is what `build`, given the node tree, returns."""
    material = node_material("Painted", shader, **inputs)
    tree = material.node_tree
    node = next(n for n in tree.nodes if n.bl_idname == shader)
    tree.links.new(build(tree), socket_of(node, socket))
    return material


def shader_of(material):
    return next(n for n in material.node_tree.nodes if n.type.startswith(("BSDF", "EMISSION")))


def image_node(tree, image=None, vector=None, **settings):
    node = tree.nodes.new("ShaderNodeTexImage")
    node.image = image or smooth_image()
    for key, value in settings.items():
        setattr(node, key, value)
    if vector is not None:
        tree.links.new(vector, node.inputs["Vector"])
    return node.outputs["Color"]


def mapping(tree, kind="POINT", source=None):
    node = tree.nodes.new("ShaderNodeMapping")
    node.vector_type = kind
    for name, value in (("Location", (0.1, 0.25, 0.0)), ("Rotation", (0.0, 0.0, 0.5)), ("Scale", (0.7, 1.6, 1.0))):
        socket = socket_of(node, name)
        if socket.enabled:
            socket.default_value = value
    tree.links.new(source or tree.nodes.new("ShaderNodeTexCoord").outputs["UV"], node.inputs["Vector"])
    return node.outputs[0]


def second_map(tree):
    node = tree.nodes.new("ShaderNodeUVMap")
    node.uv_map = "Second"
    return node.outputs[0]


def attribute(tree, kind="ShaderNodeVertexColor"):
    node = tree.nodes.new(kind)
    if kind == "ShaderNodeVertexColor":
        node.layer_name = "Paint"
    else:
        node.attribute_name = "Paint"
    return node.outputs["Color"]


def mixed(tree, first, second, blend="MIX", factor=0.3):
    node = tree.nodes.new("ShaderNodeMix")
    node.data_type, node.blend_type = "RGBA", blend
    for identifier, value in (("Factor_Float", factor), ("A_Color", first), ("B_Color", second)):
        if isinstance(value, bpy.types.NodeSocket):
            tree.links.new(value, socket_of(node, identifier))
        else:
            socket_of(node, identifier).default_value = value
    return next(s for s in node.outputs if s.identifier == "Result_Color")


def by_cycles(obj, kind):
    """Return (c, 3) the colours that Cycles bakes at the face corners: DIFFUSE without light, or EMIT."""
    scene = bpy.context.scene
    scene.render.engine = "CYCLES"
    scene.cycles.device, scene.cycles.samples = "CPU", 1
    target = obj.data.color_attributes.new("Cycles", "FLOAT_COLOR", "CORNER")
    obj.data.color_attributes.active_color = target
    select_also(obj)
    passes = {"pass_filter": {"COLOR"}} if kind == "DIFFUSE" else {}
    bpy.ops.object.bake(type=kind, target="VERTEX_COLORS", **passes)
    values = colours_of(obj.data, "Cycles")[:, :3]
    obj.data.color_attributes.remove(obj.data.color_attributes["Cycles"])
    return values


def by_us(obj, kind):
    """Return (c, 3) our colours of a small part of the face at each corner, and the warnings.

    They are what it shows of the light, DIFFUSE; what others get of it, SENT; or what it emits.
    """
    bpy.context.view_layer.update()
    extraction = extract(bpy.context, [obj])
    (target,), mesh = extraction.targets, extraction.scene.meshes[extraction.targets[0].meshes[0]]
    name = {"DIFFUSE": "own_reflectance", "SENT": "reflectance"}.get(kind, "emission")
    if mesh.own_reflectance is None and kind == "DIFFUSE":
        name = "reflectance"
    texture, plain = getattr(mesh, f"{name}_texture"), getattr(mesh, name)
    corners = np.full((3, 3, 3), 0.0) + np.eye(3)[:, None, :] * 0.94 + 0.02
    corners += 0.04 * (np.eye(3)[None] - 1 / 3)
    count = len(mesh.triangles)
    triangle, parts = np.repeat(np.arange(count), 3), np.tile(corners, (count, 1, 1))
    found = mean_colours(plain, texture, triangle, parts)
    values = np.full((len(obj.data.loops), 3), np.nan)
    values[target.local.corners.reshape(-1)] = np.maximum(found, 0.0)
    return values, extraction.warnings


STEP = 0.03
"""Colours change by less from a corner to the middle of the cell there: a sixth of the sheet has at least 16 cells, the
steepest picture goes from 0.1 to 0.9 in a third of the sheet, and sRGB makes it at most 2.2 times as steep."""


SCALED = 2.0
"""Times that colours change faster at most where a mapping makes a picture smaller, and on the ramp of the noise."""


def assert_as_in_cycles(material, kind="DIFFUSE", step=STEP):
    sheet = add_sheet(material)
    ours, warnings = by_us(sheet, kind)
    theirs = by_cycles(sheet, kind)
    assert not warnings
    assert np.ptp(theirs, axis=0).max() > 0.2
    assert np.abs(ours - theirs).max() < step * max(1.0, theirs.max())
    # Without a sign on average.
    assert np.abs((ours - theirs).mean(axis=0)).max() < 0.2 * step * max(1.0, theirs.max())
