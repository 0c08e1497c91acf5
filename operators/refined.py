# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The refined mesh of a bake as an object of its own, in place of its hidden original."""

import re

import bpy
import numpy as np
from mathutils import Matrix

from ..core.result import BakedMesh
from ..core.scene import Floats
from .attachments import take_properties
from .attributes import Attributes
from .changes import (
    in_view_layer,
    link,
    make_active,
    remember_record,
    remove_mesh_if_unused,
    select,
    set_eye,
)
from .colours import write_colours
from .display import is_display
from .journal import Journal
from .layers import Subdivision, carry, carry_vertex_groups
from .likeness import take_after
from .local_mesh import inverse_of
from .places import (
    follow,
    homes_of,
    is_bent_by_parent,
    remember_place,
    show_again,
    shows_place,
    take_out,
    take_transform,
)
from .record import HIDDEN_SOURCE, REFINED_OUTPUT, forget, is_output
from .targets import Target
from .textured import Displays

_ADDED_TO_NAME = re.compile(r" Radiosity(\.\d+)?$")
_FLAT_COSINE = 1.0 - 1e-6
"""A corner is flat when its normal is that of the triangle, to single precision (0.08 degrees)."""


def store_refined(
    source: bpy.types.Object,
    target: Target,
    baked: BakedMesh,
    attributes: Attributes,
    displays: Displays,
    view_layer: bpy.types.ViewLayer,
    journal: Journal,
    kept: bpy.types.Object | None = None,
) -> bpy.types.Object:
    """Make the refined object of `source`, show it and hide `source`; return it.

    Parameters
    ----------
    kept : Object, optional
        The refined object of an earlier bake, which stays with all that is attached to it and gets a new mesh.
    """
    inverse = inverse_of(target.matrix)
    if kept is not None:
        # Its name is free for the new one.
        journal.set(kept.data, "name", f"{kept.data.name} (discarded)"[:60])
    mesh = _refined_mesh(output_name(source), target, baked, attributes, inverse, journal)
    _give_slots(mesh, source, target, baked, displays)
    if kept is None:
        output = _object_like(source, mesh, keep_transform=inverse is not None, journal=journal)
    else:
        output = kept
        _renew(output, source, mesh, journal)
    if target.layers is not None:
        carry_vertex_groups(output, target.layers, _subdivision(target, baked))
    # Last of all that is done to the mesh, because it may drop faces that Blender cannot hold (a corner used twice)
    # with all that belongs to them.
    mesh.validate()
    if kept is None:
        for collection in homes_of(source, view_layer.id_data):
            link(output, collection, journal)
        _take_place(source, output, view_layer, journal)
    else:
        _keep_place(source, output, view_layer, journal)
    return output


def refined_to_keep(source: bpy.types.Object, target: Target) -> bpy.types.Object | None:
    """Return the refined object that stands for `source` and can be given the mesh of a new bake, or None.

    One that has its original's transform cannot stand for an object that is flattened by now, nor the other way round.
    """
    # Asked for one object after the other: who stands in a scene is looked up for its own refined objects alone.
    outputs = [obj for obj in bpy.data.objects if is_output(obj) and obj.radiosity.source == source]
    outputs = [obj for obj in outputs if obj.users_scene]
    if len(outputs) != 1 or shows_place(outputs[0]) != (inverse_of(target.matrix) is not None):
        return None
    return outputs[0]


def _renew(output: bpy.types.Object, source: bpy.types.Object, mesh: bpy.types.Mesh, journal: Journal) -> None:
    """Give a refined object the mesh of a new bake, and what `source` got meanwhile."""
    before = output.data
    take_properties(mesh, before, journal, over=False)
    for index, material in enumerate(before.materials):
        # What the artist gave it stays.
        if material is not None and not is_display(material) and index < len(mesh.materials):
            mesh.materials[index] = material
    journal.on_failure(_set_slots, output, [(slot.link, slot.material) for slot in output.material_slots])
    journal.set(output, "data", mesh)
    journal.later(remove_mesh_if_unused, before)
    stem = _ADDED_TO_NAME.sub("", output.name)
    if stem != output.name and f"{stem} Radiosity" != output_name(source):
        journal.set(output, "name", output_name(source))
    take_properties(output, source, journal, over=False)
    if shows_place(output):
        follow(source, [output], journal)
        take_transform(output, source, journal)


def _set_slots(obj: bpy.types.Object, slots: list[tuple[str, bpy.types.Material | None]]) -> None:
    for slot, (linked, material) in zip(obj.material_slots, slots, strict=True):
        slot.link = linked
        slot.material = material


def _keep_place(
    source: bpy.types.Object, output: bpy.types.Object, view_layer: bpy.types.ViewLayer, journal: Journal
) -> None:
    """Hide `source` again behind a refined object that stays, should it have been shown or deleted."""
    if view_layer.objects.active == source:
        make_active(output, view_layer, journal)
    if source.library is not None:
        take_out(source, journal)
        return
    show_again(source, [output], journal)
    if in_view_layer(source, view_layer):
        select(source, False, view_layer, journal)
    if source.radiosity.kind != HIDDEN_SOURCE:
        _remember_visibility(source, view_layer, journal)
    _hide(source, view_layer, journal)


def output_name(source: bpy.types.Object) -> str:
    """Return "Room Radiosity" for "Room", and for a refined object of that name whose own original is gone."""
    return f"{_ADDED_TO_NAME.sub('', source.name)} Radiosity"


def _refined_mesh(
    name: str,
    target: Target,
    baked: BakedMesh,
    attributes: Attributes,
    inverse: Floats | None,
    journal: Journal,
) -> bpy.types.Mesh:
    order = _corner_order(target)
    triangles = baked.triangles[:, order]
    vertices, normals = _in_local_space(target, baked, inverse)
    mesh = bpy.data.meshes.new(name)
    journal.on_failure(bpy.data.meshes.remove, mesh)
    count = len(triangles)
    mesh.vertices.add(len(vertices))
    mesh.vertices.foreach_set("co", vertices.astype(np.float32).reshape(-1))
    mesh.loops.add(3 * count)
    mesh.loops.foreach_set("vertex_index", triangles.astype(np.int32).reshape(-1))
    mesh.polygons.add(count)
    mesh.polygons.foreach_set("loop_start", np.arange(0, 3 * count, 3, dtype=np.int32))
    mesh.polygons.foreach_set("material_index", target.local.slots[baked.parent_triangle].astype(np.int32))
    mesh.update(calc_edges=True)
    if target.layers is not None:
        beside = {name: f"{name} (before bake)" for name in attributes.names()}
        carry(mesh, target.layers, _subdivision(target, baked), lambda name: beside.get(name, name))
    write_colours(mesh, values_of_corners(target, baked, attributes), attributes)
    _shade(mesh, vertices, triangles, normals[:, order])
    return mesh


def _subdivision(target: Target, baked: BakedMesh) -> Subdivision:
    order = _corner_order(target)
    return Subdivision(
        triangles=baked.triangles[:, order],
        parent=baked.parent_triangle,
        weights=baked.barycentric[:, order],
        parent_vertices=target.local.triangles,
        parent_corners=target.local.corners,
    )


def _corner_order(target: Target) -> list[int]:
    """Return the order of a refined triangle's corners on the mesh of its object."""
    # Blender turns the faces of a mirrored object over, as the extraction did; in local space they turn back.
    return [0, 2, 1] if target.flipped and inverse_of(target.matrix) is not None else [0, 1, 2]


def values_of_corners(target: Target, baked: BakedMesh, attributes: Attributes) -> dict[str, Floats | None]:
    """Return the values of a baked mesh for the corners of its refined object's mesh, by the name of the attribute."""
    order = _corner_order(target)
    return {
        name: None if values is None else values[:, order].reshape(-1, 3)
        for name, values in attributes.values(baked).items()
    }


def _in_local_space(target: Target, baked: BakedMesh, inverse: Floats | None) -> tuple[Floats, Floats]:
    """Return vertices and corner normals in the space of the output object, which is the world's without an inverse."""
    if inverse is None:
        return baked.vertices, baked.corner_normals
    vertices = baked.vertices @ inverse[:3, :3].T + inverse[:3, 3]
    # The vertices that were there before come first; taken as they were, they match their neighbours to the last bit.
    known = len(target.local.vertices)
    if len(vertices) >= known:
        vertices[:known] = target.local.vertices
    # Normals went out by the inverse transpose, so they come back by the transpose.
    normals = baked.corner_normals @ target.matrix[:3, :3]
    length = np.linalg.norm(normals, axis=-1, keepdims=True)
    return vertices, np.divide(normals, length, out=np.zeros_like(normals), where=length > 0.0)


def _shade(mesh: bpy.types.Mesh, vertices: Floats, triangles: np.ndarray, normals: Floats) -> None:
    """Shade each triangle flat or smooth as its corner normals say; smooth ones keep exactly those normals."""
    a, b, c = (vertices[triangles[:, k]] for k in range(3))
    own = np.cross(b - a, c - a)
    length = np.linalg.norm(own, axis=1, keepdims=True)
    own = np.divide(own, length, out=np.zeros_like(own), where=length > 0.0)
    smooth = np.any(np.einsum("tj,tkj->tk", own, normals) < _FLAT_COSINE, axis=1) & (length[:, 0] > 0.0)
    mesh.polygons.foreach_set("use_smooth", smooth)
    if np.any(smooth):
        mesh.normals_split_custom_set(normals.astype(np.float32).reshape(-1, 3))


def _give_slots(
    mesh: bpy.types.Mesh, source: bpy.types.Object, target: Target, baked: BakedMesh, displays: Displays
) -> None:
    used = int(target.local.slots.max(initial=0)) + 1
    originals = original_materials(target, max(used, len(source.material_slots)))
    for original in originals:
        mesh.materials.append(displays.of(original, baked.radiosity_back is not None))


def original_materials(target: Target, count: int) -> list[bpy.types.Material | None]:
    """Return the original's materials of the first `count` slots; like the renderers, beyond the last one that one."""
    by_name = {material.name_full: material for material in bpy.data.materials}
    names = target.materials or (None,)
    return [by_name.get(names[min(index, len(names) - 1)]) for index in range(count)]


def _object_like(
    source: bpy.types.Object, mesh: bpy.types.Mesh, keep_transform: bool, journal: Journal
) -> bpy.types.Object:
    """Return a copy of `source` with another mesh: same parent, transform, constraints and settings, no modifiers."""
    if source.type == "MESH":
        output = source.copy()
        journal.on_failure(bpy.data.objects.remove, output)
        output.name = mesh.name
        if output.override_library is not None:
            # It has nothing left of what its original overrides.
            output.make_local(clear_liboverride=True)
        forget(output)
        output.modifiers.clear()
        for slot in output.material_slots:
            slot.link = "DATA"
        output.data = mesh
    else:
        output = bpy.data.objects.new(mesh.name, mesh)
        journal.on_failure(bpy.data.objects.remove, output)
        take_after(output, source)
    output.instance_type = "NONE"
    if is_bent_by_parent(output):
        output.parent_type = "OBJECT"
    if not keep_transform:
        output.animation_data_clear()
        output.constraints.clear()
        output.parent = None
        _reset_transform(output)
    output.radiosity.kind = REFINED_OUTPUT
    output.radiosity.source = source
    if keep_transform:
        remember_place(output)
    return output


def _reset_transform(obj: bpy.types.Object) -> None:
    for name in ("location", "rotation_euler", "rotation_quaternion", "scale"):
        obj.property_unset(f"delta_{name}")
    obj.matrix_basis = Matrix.Identity(4)


def _take_place(
    source: bpy.types.Object, output: bpy.types.Object, view_layer: bpy.types.ViewLayer, journal: Journal
) -> None:
    """Show, select and activate `output` as `source` is, then hide `source` and remember how it was."""
    eye = in_view_layer(source, view_layer) and source.hide_get(view_layer=view_layer)
    set_eye(output, eye, view_layer, journal)
    if in_view_layer(source, view_layer):
        select(output, source.select_get(view_layer=view_layer), view_layer, journal)
        select(source, source.select_get(view_layer=view_layer), view_layer, journal)
    if view_layer.objects.active == source:
        make_active(output, view_layer, journal)
    if source.library is not None:
        take_out(source, journal)
        return
    _remember_visibility(source, view_layer, journal)
    _hide(source, view_layer, journal)


def _remember_visibility(source: bpy.types.Object, view_layer: bpy.types.ViewLayer, journal: Journal) -> None:
    remember_record(source, journal)
    record = source.radiosity
    record.kind = HIDDEN_SOURCE
    record.hide_render, record.hide_viewport = source.hide_render, source.hide_viewport
    record.hide_eye = in_view_layer(source, view_layer) and source.hide_get(view_layer=view_layer)


def _hide(source: bpy.types.Object, view_layer: bpy.types.ViewLayer, journal: Journal) -> None:
    set_eye(source, True, view_layer, journal)
    journal.set(source, "hide_render", True)
    journal.set(source, "hide_viewport", True)
