# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Ways in which Blender makes surfaces."""

from __future__ import annotations

import math
from typing import Any

import bpy

from . import stage
from .cases import case


def lit_room() -> Any:
    """Return the floor of a room with a lamp and a little light from all around."""
    floor = stage.room()
    stage.lamp("AREA", shape="DISK", size=0.4)
    stage.world((0.5, 0.6, 0.8), 0.3)
    return floor


@case("Negative scale")
def negative_scale() -> list[Any]:
    """The floor and a box are mirrored."""
    floor = lit_room()
    floor.scale = (-1.0, 1.0, 1.0)
    stage.box("Box", (0, 0, 0), (0.4, 0.4, 0.5), stage.paint("Blue", (0.2, 0.3, 0.7)), location=(-0.3, -0.5, 0.13))
    bpy.data.objects["Box"].scale = (-1.0, 1.0, 1.5)
    return [floor]


@case("Non-uniform scale and turns")
def sheared() -> list[Any]:
    """A box below a scaled and turned parent is sheared."""
    floor = lit_room()
    parent = stage.add("Parent", None, (0.2, 0.3, 0.3), (0.3, 0.2, 0.4), (2.0, 0.7, 1.0))
    child = stage.box("Box", (-0.1, -0.2, -0.1), (0.1, 0.2, 0.1), stage.paint("Blue", (0.2, 0.3, 0.7)))
    child.rotation_euler = (0.5, 0.4, 0.3)
    child.parent = parent
    return [floor]


@case("Modifiers")
def modifiers() -> list[Any]:
    """An array, a bevel and a subdivision throw the shadow."""
    floor = lit_room()
    thing = stage.box("Post", (-0.08, -0.08, 0), (0.08, 0.08, 0.5), stage.paint("Blue", (0.2, 0.3, 0.7)))
    thing.location = (-0.5, -0.5, 0.13)
    array = thing.modifiers.new("Array", "ARRAY")
    array.count, array.use_relative_offset, array.use_constant_offset = 3, False, True
    array.constant_offset_displace = (0.4, 0.1, 0.0)
    thing.modifiers.new("Bevel", "BEVEL").width = 0.02
    thing.modifiers.new("Subdivision", "SUBSURF").render_levels = 2
    return [floor]


@case("Collection instances")
def collection_instances() -> list[Any]:
    """Two turned instances of a collection with a box and a mesh that shines."""
    floor = stage.room()
    parts = bpy.data.collections.new("Parts")
    box = stage.box("Box", (-0.1, -0.1, 0.1), (0.1, 0.1, 0.6), stage.paint("Blue", (0.2, 0.3, 0.7)))
    panel = stage.grid("Panel", 0.3, 0.3, 1, stage.glow(), location=(0.0, 0.0, 1.4))
    for thing in (box, panel):
        bpy.context.scene.collection.objects.unlink(thing)
        parts.objects.link(thing)
    for place, turn in (((-0.5, -0.4, 0.0), 0.4), ((0.55, 0.5, 0.1), 1.2)):
        instance = stage.add("Instance", None, place, (0.0, 0.1, turn), (1.0, 1.3, 1.0))
        instance.instance_type, instance.instance_collection = "COLLECTION", parts
    return [floor]


@case("Shared mesh data")
def shared_mesh() -> list[Any]:
    """Three floors of one mesh in different light, each compared."""
    floor = lit_room()
    others = [stage.add(f"Floor {k}", floor.data, (0.0, 2.2 * k, 0.1 * k), (0.2 * k, 0.0, 0.5)) for k in (1, 2)]
    return [floor, *others]


@case("Text, curves, NURBS surfaces and metaballs")
def curves() -> list[Any]:
    """One of each stands on the floor and throws its shadow."""
    floor = lit_room()
    blue, green = stage.paint("Blue", (0.2, 0.3, 0.7)), stage.paint("Green", (0.2, 0.6, 0.3))
    text = bpy.data.curves.new("Text", "FONT")
    text.body, text.extrude, text.size = "Abc", 0.05, 0.5
    text.materials.append(blue)
    stage.add("Text", text, (-0.8, 0.7, 0.25), (1.2, 0.0, 0.0))
    pipe = bpy.data.curves.new("Pipe", "CURVE")
    pipe.dimensions, pipe.bevel_depth = "3D", 0.04
    spline = pipe.splines.new("BEZIER")
    spline.bezier_points.add(1)
    for point, place in zip(spline.bezier_points, [(-0.7, -0.7, 0.2), (0.7, -0.7, 0.35)], strict=True):
        point.co, point.handle_left_type, point.handle_right_type = place, "AUTO", "AUTO"
    pipe.materials.append(green)
    stage.add("Pipe", pipe)
    ball = bpy.data.metaballs.new("Ball")
    ball.elements.new().radius, ball.resolution, ball.render_resolution = 0.4, 0.1, 0.1
    ball.elements.new().co = (0.25, 0.0, 0.0)
    ball.elements[1].radius = 0.3
    ball.materials.append(blue)
    stage.add("Ball", ball, (-0.5, -0.1, 0.35))
    bpy.ops.surface.primitive_nurbs_surface_sphere_add(radius=0.2, location=(0.7, 0.45, 0.3))
    bpy.context.object.data.materials.append(green)
    return [floor]


@case("Instances by geometry nodes")
def geometry_nodes() -> list[Any]:
    """Boxes on the vertices of a sheet above the floor, instances of a mesh that the nodes make."""
    floor = lit_room()
    sheet = stage.grid("Sheet", 1.2, 1.2, 3, stage.paint("Blue", (0.2, 0.3, 0.7)), location=(-0.1, -0.1, 0.3))
    tree = bpy.data.node_groups.new("Boxes", "GeometryNodeTree")
    for way in ("INPUT", "OUTPUT"):
        tree.interface.new_socket("Geometry", in_out=way, socket_type="NodeSocketGeometry")
    nodes, links = tree.nodes, tree.links
    points, box = nodes.new("GeometryNodeInstanceOnPoints"), nodes.new("GeometryNodeMeshCube")
    box.inputs["Size"].default_value = (0.1, 0.15, 0.2)
    links.new(nodes.new("NodeGroupInput").outputs[0], points.inputs["Points"])
    links.new(box.outputs[0], points.inputs["Instance"])
    links.new(points.outputs[0], nodes.new("NodeGroupOutput").inputs[0])
    sheet.modifiers.new("Boxes", "NODES").node_group = tree
    return [floor]


@case("Instances that differ in colour, by the Random of an Object Info node")
def random_of_instances() -> list[Any]:
    """Pillars from red to blue, each an instance of one collection."""
    floor = lit_room()
    made = bpy.data.materials.new("Random")
    tree = stage.node_tree(made)
    info, ramp = tree.nodes.new("ShaderNodeObjectInfo"), tree.nodes.new("ShaderNodeValToRGB")
    ramp.color_ramp.elements[0].color, ramp.color_ramp.elements[1].color = (0.9, 0.1, 0.1, 1), (0.1, 0.2, 0.9, 1)
    tree.links.new(info.outputs["Random"], ramp.inputs[0])
    stage.show(tree, stage.shader(tree, "ShaderNodeBsdfDiffuse", Color=ramp.outputs["Color"]))
    pillar = stage.box("Pillar", (-0.08, -0.08, 0.02), (0.08, 0.08, 0.6), made)
    pillars = bpy.data.collections.new("Pillars")
    pillars.objects.link(pillar)
    bpy.context.scene.collection.objects.unlink(pillar)
    for number in range(6):
        instance = stage.add(f"Instance {number}", None, (-0.75 + 0.3 * number, 0.6 * (number % 2) - 0.5, 0.0))
        instance.instance_type, instance.instance_collection = "COLLECTION", pillars
    return [floor]


@case("Instances on faces, scaled by them")
def face_instances() -> list[Any]:
    """A box on each face of a sheet, whose own faces do not render."""
    floor = lit_room()
    sheet = stage.grid("Sheet", 1.4, 1.0, 3, location=(-0.1, -0.1, 0.3), rotation=(0.2, 0.1, 0.4))
    box = stage.box("Box", (-0.2, -0.3, 0.0), (0.2, 0.3, 0.4), stage.paint("Blue", (0.2, 0.3, 0.7)))
    box.parent, sheet.instance_type = sheet, "FACES"
    sheet.use_instance_faces_scale, sheet.show_instancer_for_render = True, False
    box.hide_render = False
    return [floor]


@case("Shape keys and armatures at the current frame")
def posed() -> list[Any]:
    """A box whose shape key is half on, bent by a bone."""
    floor = lit_room()
    post = stage.box("Post", (-0.1, -0.1, 0.0), (0.1, 0.1, 0.3), stage.paint("Blue", (0.2, 0.3, 0.7)))
    post.location = (-0.5, -0.4, 0.12)
    post.shape_key_add(name="Basis")
    wide = post.shape_key_add(name="Wide")
    for point in wide.data:
        point.co.x *= 3.0
    wide.value = 0.5
    rig = stage.add("Rig", bpy.data.armatures.new("Rig"), (-0.5, -0.4, 0.12))
    bpy.context.view_layer.objects.active = rig
    bpy.ops.object.mode_set(mode="EDIT")
    rig.data.edit_bones.new("Bone").tail = (0.0, 0.0, 0.3)
    bpy.ops.object.mode_set(mode="OBJECT")
    post.vertex_groups.new(name="Bone").add([1, 3, 5, 7], 1.0, "REPLACE")
    post.modifiers.new("Armature", "ARMATURE").object = rig
    rig.pose.bones["Bone"].location = (0.2, 0.3, 0.1)
    return [floor]


@case("Ray visibility: no Diffuse")
def passed_by_diffuse_rays() -> list[Any]:
    """The wall reflects nothing, the board throws its shadow all the same, a shining square gives no light."""
    floor = lit_room()
    stage.grid("Panel", 0.3, 0.3, 1, stage.glow(), location=(0.6, 0.6, 0.8))
    for name in ("Wall", "Board", "Panel"):
        bpy.data.objects[name].visible_diffuse = False
    return [floor]


@case("Ray visibility: no Shadow")
def passed_by_shadow_rays() -> list[Any]:
    """The board throws no shadow and reflects all the same."""
    floor = stage.room()
    stage.lamp("AREA", shape="DISK", size=0.4)
    bpy.data.objects["Board"].visible_shadow = False
    return [floor]


@case("Holdouts, shadow catchers, objects that the camera does not see")
def seen_by_no_camera() -> list[Any]:
    """The wall is a holdout, the board a shadow catcher, a box hidden from the camera, another indirect only."""
    floor = lit_room()
    blue = stage.paint("Blue", (0.2, 0.3, 0.7))
    bpy.data.objects["Wall"].is_holdout = True
    bpy.data.objects["Board"].is_shadow_catcher = True
    stage.box("Box", (0.5, 0.4, 0.13), (0.8, 0.7, 0.5), blue).visible_camera = False
    box = stage.box("Other", (-0.8, -0.7, 0.13), (-0.5, -0.4, 0.5), blue)
    bpy.context.scene.collection.objects.unlink(box)
    some = bpy.data.collections.new("Some")
    bpy.context.scene.collection.children.link(some)
    some.objects.link(box)
    bpy.context.view_layer.layer_collection.children["Some"].indirect_only = True
    return [floor]


def sheet_between_lamps() -> Any:
    """Return a sheet with a red lamp above and a blue one below, each near a box of another colour."""
    sheet = stage.grid("Sheet", 2.0, 2.0, material=stage.paint(), rotation=(0.1, 0.0, 0.0))
    stage.lamp("POINT", (0.4, 0.3, 1.2), color=(1.0, 0.2, 0.1), energy=40.0, shadow_soft_size=0.2)
    stage.lamp("AREA", (-0.3, 0.2, -1.3), (3.14, 0.0, 0.0), color=(0.1, 0.3, 1.0), energy=30.0, size=0.5)
    green = stage.paint("Green", (0.2, 0.6, 0.3))
    stage.box("Upper", (-0.8, -0.6, 0.2), (-0.4, -0.2, 0.6), green)
    stage.box("Lower", (0.3, 0.1, -0.7), (0.7, 0.5, -0.3), green)
    stage.camera((1.8, -2.6, -1.2), (0.0, 0.0, 0.0), 40.0)
    return sheet


@case("Two sides: the front of a sheet between two lamps")
def front_of_sheet() -> list[Any]:
    """The side that the red lamp lights."""
    return [sheet_between_lamps()]


@case("Two sides: its back", quantity="Irradiance Back")
def back_of_sheet() -> list[Any]:
    """The side that the blue lamp lights; in the picture the camera looks at it."""
    return [sheet_between_lamps()]


@case("Two sides: the back of a mirrored sheet", quantity="Radiosity Back")
def back_of_mirrored_sheet() -> list[Any]:
    """The same, with a negative scale."""
    sheet = sheet_between_lamps()
    sheet.scale = (-1.0, 1.0, 1.0)
    return [sheet]


@case("Flat faces that are not planar")
def bent_faces() -> list[Any]:
    """A hilly ground, each face of which is two triangles that lean against each other, under a low sun and a sky."""
    ground = stage.grid("Ground", 2.0, 2.0, 8, stage.paint())
    for vertex in ground.data.vertices:
        x, y, _ = vertex.co
        vertex.co.z = 0.06 * (math.sin(5.0 * x) * math.cos(4.0 * y) + math.sin(17.0 * x * y))
    stage.lamp("SUN", turn=(0.6, 0.5, 0.0), angle=0.02)
    stage.world((0.5, 0.6, 0.8), 0.3)
    stage.camera((1.8, -1.8, 1.8), (0.0, 0.0, 0.0), 40.0)
    return [ground]


@case(
    "Smooth shading of few faces",
    faces=True,
    note="both are dark, as what a smooth face sends on is here the light on its flat triangles: a pale pillar's top "
    "would light the ball otherwise, by 6% of the row",
)
def smooth_faces() -> list[Any]:
    """A ball of 8 by 6 faces and a pillar of 8 under a low sun, which shade themselves across their faces."""
    paint = stage.paint(colour=(0.05, 0.05, 0.05))
    bpy.ops.mesh.primitive_uv_sphere_add(segments=8, ring_count=6, radius=1.0, location=(0.0, 0.0, 1.1))
    ball = bpy.context.object
    bpy.ops.mesh.primitive_cylinder_add(vertices=8, radius=1.0, depth=1.6, location=(0.0, 0.0, -1.0))
    for thing in (ball, bpy.context.object):
        thing.data.materials.append(paint)
        thing.data.shade_smooth()
    stage.lamp("SUN", turn=(1.233, 0.0, 1.212), angle=0.01)
    stage.world((0.5, 0.6, 0.8), 0.1)
    stage.camera((0.0, -6.0, 0.8), (0.0, 0.0, 0.0), 50.0)
    return [ball, bpy.context.object]
