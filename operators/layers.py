# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The data layers of a mesh (UV maps, vertex groups, marks, any attribute), carried over to its subdivision."""

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from typing import Any

import bpy
import numpy as np
from numpy.typing import NDArray

from ..core.scene import Floats, Ints
from .local_mesh import LocalMesh

_STORED_OTHERWISE = {"position", "material_index", "sharp_face", "custom_normal"}
"""Attributes that a refined mesh gets from its vertices, slots and shading."""
_INTERPOLATED = {"FLOAT", "FLOAT2", "FLOAT4", "FLOAT_VECTOR", "FLOAT_COLOR", "BYTE_COLOR"}
"""Types of which a mean means something; of all others the nearest value is taken."""
_MARKS = (("edges", "use_seam"), ("edges", "use_freestyle_mark"), ("polygons", "use_freestyle_mark"))
"""Marks that some versions of Blender keep in no public attribute."""
_ON_EDGE = 1e-9
"""Below this a barycentric coordinate counts as 0, as those of vertices on an edge are but for rounding."""
_KINDS = {"FLOAT": np.float32, "INT": np.int32, "BOOLEAN": np.bool_}
"""Of arrays that Blender's properties are read into; what is not here is read one by one."""


@dataclass(frozen=True, eq=False)
class Layer:
    """One attribute.

    Attributes
    ----------
    name : str
    data_type, domain : str
        Blender's names of them.
    values : (n, width) array
        Of each element of the domain; of strings (n, 1) objects.
    """

    name: str
    data_type: str
    domain: str
    values: NDArray[Any]


@dataclass(frozen=True, eq=False)
class VertexGroup:
    """The weights of one vertex group.

    Attributes
    ----------
    name : str
    locked : bool
    member : (v,) bool
    weight : (v,) float
        0 for those that are no members.
    """

    name: str
    locked: bool
    member: NDArray[np.bool_]
    weight: Floats


@dataclass(frozen=True, eq=False)
class Layers:
    """Everything of a mesh that is not its shape, as arrays.

    Attributes
    ----------
    attributes : tuple of Layer
    marks : tuple of (str, str, array)
        Collection of the mesh, property, and its values.
    groups : tuple of VertexGroup
    active_group : int
    active_uv, render_uv, clone_uv : str
        Empty for none.
    edges : (e, 2) int
        Vertices of each edge.
    face_of_triangle : (t,) int
    """

    attributes: tuple[Layer, ...]
    marks: tuple[tuple[str, str, NDArray[np.bool_]], ...]
    groups: tuple[VertexGroup, ...]
    active_group: int
    active_uv: str
    render_uv: str
    clone_uv: str
    edges: Ints
    face_of_triangle: Ints


@dataclass(frozen=True, eq=False)
class Subdivision:
    """Where the elements of a subdivided mesh lie in the mesh that was subdivided.

    Attributes
    ----------
    triangles : (s, 3) int
        Vertices of the subdivision; the first of them are all those of the mesh that was subdivided.
    parent : (s,) int
        Triangle of the mesh that each lies in.
    weights : (s, 3, 3) float
        Barycentric coordinates of each corner in it.
    parent_vertices, parent_corners : (t, 3) int
        Vertices and face corners of the mesh's triangles.
    """

    triangles: Ints
    parent: Ints
    weights: Floats
    parent_vertices: Ints
    parent_corners: Ints


def layers_of(obj: bpy.types.Object, mesh: bpy.types.Mesh) -> Layers:
    """Return the layers of `mesh`, whose vertex groups are those of `obj`."""
    mesh.calc_loop_triangles()
    edges = np.empty((len(mesh.edges), 2), dtype=np.int32)
    mesh.edges.foreach_get("vertices", edges.reshape(-1))
    faces = np.empty(len(mesh.loop_triangles), dtype=np.int32)
    mesh.loop_triangles.foreach_get("polygon_index", faces)
    maps = mesh.uv_layers
    return Layers(
        attributes=tuple(
            Layer(attribute.name, attribute.data_type, attribute.domain, _values(attribute))
            for attribute in mesh.attributes
            if not (attribute.is_internal or attribute.is_required or attribute.name in _STORED_OTHERWISE)
        ),
        marks=tuple(_marks(mesh)),
        groups=_vertex_groups(obj, mesh),
        active_group=obj.vertex_groups.active_index,
        active_uv=maps.active.name if maps.active else "",
        render_uv=next((layer.name for layer in maps if layer.active_render), ""),
        clone_uv=next((layer.name for layer in maps if layer.active_clone), ""),
        edges=edges.astype(np.int64),
        face_of_triangle=faces.astype(np.int64),
    )


def _marks(mesh: bpy.types.Mesh) -> Iterable[tuple[str, str, NDArray[np.bool_]]]:
    for collection, name in _MARKS:
        elements = getattr(mesh, collection)
        if len(elements) and name in elements[0].bl_rna.properties:
            values = np.empty(len(elements), dtype=bool)
            elements.foreach_get(name, values)
            if values.any():
                yield collection, name, values


def _value_property(attribute: bpy.types.Attribute) -> bpy.types.Property:
    """Return the property that holds the value of one element of an attribute."""
    properties = attribute.bl_rna.properties["data"].fixed_type.properties
    return next(properties[name] for name in ("value", "vector", "color") if name in properties)


def _values(attribute: bpy.types.Attribute) -> NDArray[Any]:
    item = _value_property(attribute)
    if item.type not in _KINDS:
        return np.array([getattr(element, item.identifier) for element in attribute.data], dtype=object)[:, None]
    values = np.empty((len(attribute.data), max(item.array_length, 1)), dtype=_KINDS[item.type])
    attribute.data.foreach_get(item.identifier, values.reshape(-1))
    return values


def _vertex_groups(obj: bpy.types.Object, mesh: bpy.types.Mesh) -> tuple[VertexGroup, ...]:
    groups = list(obj.vertex_groups)
    if not groups:
        return ()
    found = [(element.group, vertex.index, element.weight) for vertex in mesh.vertices for element in vertex.groups]
    table = np.array(found, dtype=np.float64).reshape(-1, 3)
    group, vertex = table[:, 0].astype(np.int64), table[:, 1].astype(np.int64)
    made = []
    for index, vertex_group in enumerate(groups):
        of_group = group == index
        member = np.zeros(len(mesh.vertices), dtype=bool)
        weight = np.zeros(len(mesh.vertices))
        member[vertex[of_group]] = True
        weight[vertex[of_group]] = table[of_group, 2]
        made.append(VertexGroup(vertex_group.name, vertex_group.lock_weight, member, weight))
    return tuple(made)


def joined_layers(parts: Sequence[Layers | None], meshes: Sequence[LocalMesh]) -> Layers | None:
    """Return the layers of several meshes as those of the mesh that joins them; None if any has none.

    What only some of them have is 0, or empty, on the others. Of two layers of one name and different kinds, the first
    is kept.
    """
    if any(part is None for part in parts) or len(parts) == 1:
        return parts[0] if len(parts) == 1 else None
    known = [part for part in parts if part is not None]
    sizes = [_sizes(part, mesh) for part, mesh in zip(known, meshes, strict=True)]
    kinds: dict[str, Layer] = {}
    for layer in (layer for part in known for layer in part.attributes):
        kinds.setdefault(layer.name, layer)
    first_vertex = np.cumsum([0, *(size["POINT"] for size in sizes[:-1])])
    first_face = np.cumsum([0, *(size["FACE"] for size in sizes[:-1])])
    groups: dict[str, VertexGroup] = {}
    for group in (group for part in known for group in part.groups):
        groups.setdefault(group.name, group)
    return Layers(
        attributes=tuple(
            Layer(kind.name, kind.data_type, kind.domain, _joined_values(kind, known, sizes)) for kind in kinds.values()
        ),
        marks=_joined_marks(known, sizes),
        groups=tuple(_joined_group(group, known, sizes) for group in groups.values()),
        active_group=known[0].active_group,
        active_uv=next((part.active_uv for part in known if part.active_uv), ""),
        render_uv=next((part.render_uv for part in known if part.render_uv), ""),
        clone_uv=next((part.clone_uv for part in known if part.clone_uv), ""),
        edges=np.concatenate([part.edges + first for part, first in zip(known, first_vertex, strict=True)]),
        face_of_triangle=np.concatenate(
            [part.face_of_triangle + first for part, first in zip(known, first_face, strict=True)]
        ),
    )


def _sizes(layers: Layers, mesh: LocalMesh) -> dict[str, int]:
    """Return how many elements each domain of a mesh has."""
    return {
        "POINT": len(mesh.vertices),
        "EDGE": len(layers.edges),
        "FACE": int(layers.face_of_triangle.max(initial=-1)) + 1,
        "CORNER": len(mesh.vertex_of_corner),
    }


def _nothing(values: NDArray[Any], count: int) -> NDArray[Any]:
    """Return so many values of the kind of `values` (n, width) that say nothing: 0, or an empty text."""
    empty = b"" if values.dtype == object else 0
    return np.full((count, values.shape[1]), empty, dtype=values.dtype)


def _joined_values(kind: Layer, parts: Sequence[Layers], sizes: Sequence[dict[str, int]]) -> NDArray[Any]:
    found = []
    for part, size in zip(parts, sizes, strict=True):
        alike = (
            layer.values
            for layer in part.attributes
            if (layer.name, layer.data_type, layer.domain) == (kind.name, kind.data_type, kind.domain)
        )
        found.append(next(alike, _nothing(kind.values, size[kind.domain])))
    return np.concatenate(found)


def _joined_marks(
    parts: Sequence[Layers], sizes: Sequence[dict[str, int]]
) -> tuple[tuple[str, str, NDArray[np.bool_]], ...]:
    made = []
    for collection, name in dict.fromkeys((mark[0], mark[1]) for part in parts for mark in part.marks):
        domain = "EDGE" if collection == "edges" else "FACE"
        values = []
        for part, size in zip(parts, sizes, strict=True):
            own = (mark[2] for mark in part.marks if mark[:2] == (collection, name))
            values.append(next(own, np.zeros(size[domain], dtype=bool)))
        made.append((collection, name, np.concatenate(values)))
    return tuple(made)


def _joined_group(group: VertexGroup, parts: Sequence[Layers], sizes: Sequence[dict[str, int]]) -> VertexGroup:
    member, weight = [], []
    for part, size in zip(parts, sizes, strict=True):
        own = next((other for other in part.groups if other.name == group.name), None)
        member.append(np.zeros(size["POINT"], dtype=bool) if own is None else own.member)
        weight.append(np.zeros(size["POINT"]) if own is None else own.weight)
    return VertexGroup(group.name, group.locked, np.concatenate(member), np.concatenate(weight))


def carry(mesh: bpy.types.Mesh, layers: Layers, where: Subdivision, name_of: Callable[[str], str]) -> None:
    """Give `mesh`, a subdivision of what `layers` are of, all of them but the vertex groups.

    Parameters
    ----------
    name_of : callable
        Gives the name that an attribute shall have, as its own may be taken.
    """
    parent_edge = _parent_edges(mesh, layers, where)
    vertex = _vertices(where, len(mesh.vertices))
    for layer in layers.attributes:
        attribute = mesh.attributes.new(name_of(layer.name), layer.data_type, layer.domain)
        carried = _carried(layer, layers, where, parent_edge, vertex)
        item = _value_property(attribute)
        if item.type in _KINDS:
            attribute.data.foreach_set(item.identifier, np.ascontiguousarray(carried, _KINDS[item.type]).reshape(-1))
        else:
            for element, value in zip(attribute.data, carried[:, 0], strict=True):
                setattr(element, item.identifier, value)
    for collection, name, values in layers.marks:
        if collection == "edges":
            carried = _of_edges(values[:, None], parent_edge)[:, 0]
        else:
            carried = values[layers.face_of_triangle[where.parent]]
        getattr(mesh, collection).foreach_set(name, carried)
    for name, flag in (
        (layers.active_uv, "active"),
        (layers.render_uv, "active_render"),
        (layers.clone_uv, "active_clone"),
    ):
        if name:
            setattr(mesh.uv_layers[name_of(name)], flag, True)


def carry_vertex_groups(obj: bpy.types.Object, layers: Layers, where: Subdivision) -> None:
    """Give `obj`, whose mesh is a subdivision of what `layers` are of, its vertex groups."""
    corners, shares = _vertices(where, len(obj.data.vertices))
    for group in layers.groups:
        made = obj.vertex_groups.new(name=group.name)
        member = np.flatnonzero((group.member[corners] & (shares > _ON_EDGE)).any(axis=1))
        weight = np.einsum("nk,nk->n", shares[member], group.weight[corners[member]]).astype(np.float32)
        # One call for each weight that there is.
        order = np.argsort(weight, kind="stable")
        for alike in np.split(order, 1 + np.flatnonzero(np.diff(weight[order]))):
            if len(alike):
                made.add(member[alike].tolist(), float(weight[alike[0]]), "REPLACE")
        made.lock_weight = group.locked
    if layers.groups:
        obj.vertex_groups.active_index = layers.active_group


def _carried(
    layer: Layer, layers: Layers, where: Subdivision, parent_edge: Ints, vertex: tuple[Ints, Floats]
) -> NDArray[Any]:
    """Return the values of a layer on the subdivision."""
    smooth = layer.data_type in _INTERPOLATED
    if layer.domain == "POINT":
        return _mixed(layer.values, *vertex, smooth)
    if layer.domain == "CORNER":
        corners = np.repeat(where.parent_corners[where.parent], 3, axis=0)
        return _mixed(layer.values, corners, where.weights.reshape(-1, 3), smooth)
    if layer.domain == "EDGE":
        return _of_edges(layer.values, parent_edge)
    return layer.values[layers.face_of_triangle[where.parent]]


def _mixed(values: NDArray[Any], indices: Ints, shares: Floats, smooth: bool) -> NDArray[Any]:
    """Return the values (n, width) at `indices` (n, 3) by their shares (n, 3): the mean, or that of the largest."""
    if smooth:
        return sum(shares[:, k, None] * values[indices[:, k]] for k in range(3))
    return values[np.take_along_axis(indices, shares.argmax(axis=1)[:, None], axis=1)[:, 0]]


def _vertices(where: Subdivision, count: int) -> tuple[Ints, Floats]:
    """Return for each vertex the three vertices (n, 3) of the parent triangle, and its shares (n, 3) of them."""
    used, first = np.unique(where.triangles.reshape(-1), return_index=True)
    # What no triangle uses was there before, as itself.
    corners = np.repeat(np.arange(count)[:, None], 3, axis=1)
    shares = np.tile([1.0, 0.0, 0.0], (count, 1))
    corners[used] = where.parent_vertices[where.parent[first // 3]]
    shares[used] = where.weights.reshape(-1, 3)[first]
    return corners, shares


def _of_edges(values: NDArray[Any], parent_edge: Ints) -> NDArray[Any]:
    """Return the values of edges that lie on others; what lies within a face has none: 0, or an empty text."""
    nothing = np.array([[b""]], dtype=object) if values.dtype == object else np.zeros((1, values.shape[1]))
    inside = np.broadcast_to(nothing, (len(parent_edge), values.shape[1])).astype(values.dtype)
    inside[parent_edge >= 0] = values[parent_edge[parent_edge >= 0]]
    return inside


def _parent_edges(mesh: bpy.types.Mesh, layers: Layers, where: Subdivision) -> Ints:
    """Return the edge that each edge of `mesh` lies on, -1 for those within a face."""
    edges = np.empty((len(mesh.edges), 2), dtype=np.int32)
    mesh.edges.foreach_get("vertices", edges.reshape(-1))
    opposite = where.parent_vertices[:, [[1, 2], [2, 0], [0, 1]]]
    edge_opposite = _find_pairs(layers.edges, opposite.reshape(-1, 2)).reshape(-1, 3)
    pairs, parents = [], []
    zero = where.weights < _ON_EDGE
    for corner in range(3):
        following = (corner + 1) % 3
        triangle, side = np.nonzero(zero[:, corner] & zero[:, following])
        pairs.append(where.triangles[triangle][:, [corner, following]])
        parents.append(edge_opposite[where.parent[triangle], side])
    pair = _find_pairs(np.concatenate(pairs), edges)
    return np.where(pair >= 0, np.append(np.concatenate(parents), -1)[pair], -1)


def _find_pairs(known: Ints, wanted: Ints) -> Ints:
    """Return the index in `known` (n, 2) of each of the unordered pairs `wanted` (m, 2), or -1."""
    most = 1 + max(int(pairs.max(initial=0)) for pairs in (known, wanted))
    keys = known.astype(np.int64).min(axis=1) * most + known.max(axis=1)
    sought = wanted.astype(np.int64).min(axis=1) * most + wanted.max(axis=1)
    order = np.argsort(keys, kind="stable")
    place = np.minimum(np.searchsorted(keys[order], sought), max(len(keys) - 1, 0))
    if not len(keys):
        return np.full(len(sought), -1)
    found = order[place]
    return np.where(keys[found] == sought, found, -1)
