# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""What is baked: an object with the meshes that it shows, and their values as one.

A mesh object shows its own mesh; a text or a curve the mesh that it renders as; an object that makes instances those,
too. Rays meet them as separate meshes, as they do in a rendering; the artist gets one object for each that was
selected.
"""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, fields, replace
from typing import Any, TypeVar

import bpy
import numpy as np

from ..core.result import BakedMesh, BakeResult, GroupLight
from ..core.scene import Floats, Ints, Scene
from ..core.settings import BakeSettings
from .layers import Layers
from .local_mesh import LocalMesh, inverse_of, placed

_Light = TypeVar("_Light", BakedMesh, GroupLight)

SURFACE_TYPES = {"MESH", "CURVE", "SURFACE", "FONT", "META"}
"""Types of objects that render as faces."""


@dataclass(frozen=True, eq=False)
class Target:
    """An object that is baked: how to find it again, and what its baked values have to be fitted to.

    Attributes
    ----------
    uid : int
        `session_uid` of the object, which survives renaming and undo.
    name : str
    meshes : tuple of int
        Indices into `Scene.meshes`: its own mesh and those of the instances that it makes.
    matrix : (4, 4) float
        From the object's space to the world's, when it was read.
    shown : (4, 4) float
        Where it was seen then: the transform of its refined object if it had one.
    flipped : bool
        Whether the triangles were turned over, because the matrix mirrors.
    local : LocalMesh
        The evaluated meshes as one; its triangles and corners in the order (and winding) of `Scene.meshes`.
    fingerprint : bytes
        Of the object's own data, to notice that it was edited during the bake.
    same_corners : bool
        Whether the evaluated mesh has the very face corners of the object's own mesh.
    materials : tuple of str or None
        Full names of the materials that the slots of `local` stand for, None for a slot without one.
    layers : Layers or None
        Of the evaluated meshes, joined like them; None for colours in place, which need none.
    glow : (t, 3) float or None
        Emitted radiance of each triangle that lights nothing and is to be seen all the same.
    """

    uid: int
    name: str
    meshes: tuple[int, ...]
    matrix: Floats
    shown: Floats
    flipped: bool
    local: LocalMesh
    fingerprint: bytes
    same_corners: bool
    materials: tuple[str | None, ...] = ()
    layers: Layers | None = None
    glow: Floats | None = None


@dataclass(frozen=True, eq=False)
class Part:
    """One of the meshes that an object shows.

    Attributes
    ----------
    mesh : int
        Index into `Scene.meshes`.
    local : LocalMesh
        Wound as it is there.
    materials : tuple of Material or None
        That its slots stand for.
    matrix : (4, 4) float
        From its space to the world's.
    layers : Layers or None
        Its data layers, where they are wanted.
    glow : (t, 3) float or None
        As in `Target`.
    """

    mesh: int
    local: LocalMesh
    materials: tuple[Any, ...]
    matrix: Floats
    layers: Layers | None = None
    glow: Floats | None = None


def shows_surfaces(obj: bpy.types.Object) -> bool:
    """Return whether `obj` is of a kind that can have faces, of its own or of the collection that it instances."""
    return obj.type in SURFACE_TYPES or (obj.instance_type == "COLLECTION" and obj.instance_collection is not None)


def joined_mesh(parts: Sequence[Part], matrix: Floats) -> LocalMesh:
    """Return the meshes of an object as one in the space of `matrix`, or in the world's where that flattens.

    The slots of the first stay as they are; materials that only others have come after.
    """
    first = parts[0]
    if len(parts) == 1 and np.array_equal(first.matrix, matrix):
        return first.local
    materials = list(first.materials) or [None]
    # A face whose slot does not exist takes the last one, which is no longer the last below.
    own = np.clip(first.local.slots, 0, len(materials) - 1)
    slots = [own, *(_slots_among(part, materials) for part in parts[1:])]
    shapes = [_in_space_of(matrix, part) for part in parts]
    vertex = _starts([len(part.local.vertices) for part in parts])
    corner = _starts([len(part.local.vertex_of_corner) for part in parts])
    return LocalMesh(
        vertices=np.concatenate([vertices for vertices, _ in shapes]),
        triangles=np.concatenate([part.local.triangles + start for part, start in zip(parts, vertex, strict=True)]),
        corners=np.concatenate([part.local.corners + start for part, start in zip(parts, corner, strict=True)]),
        normals=np.concatenate([normals for _, normals in shapes]),
        slots=np.concatenate(slots),
        vertex_of_corner=np.concatenate(
            [part.local.vertex_of_corner + start for part, start in zip(parts, vertex, strict=True)]
        ),
        materials=tuple(materials),
    )


def _starts(counts: Sequence[int]) -> Ints:
    """Return where each of several runs begins that follow one another."""
    return np.cumsum([0, *counts[:-1]])


def _in_space_of(matrix: Floats, part: Part) -> tuple[Floats, Floats]:
    """Return vertices and corner normals of a part in the space of `matrix`, or the world's where that flattens."""
    if np.array_equal(part.matrix, matrix):
        return part.local.vertices, part.local.normals
    vertices, normals = placed(part.local, part.matrix)
    inverse = inverse_of(matrix)
    if inverse is None:
        return vertices, normals
    # Normals went out by the inverse transpose, so they come back by the transpose.
    normals = normals @ matrix[:3, :3]
    length = np.linalg.norm(normals, axis=-1, keepdims=True)
    return vertices @ inverse[:3, :3].T + inverse[:3, 3], np.divide(
        normals, length, out=np.zeros_like(normals), where=length > 0.0
    )


def _slots_among(part: Part, materials: list[Any]) -> Ints:
    """Return the slot of each triangle (t,) of a part among `materials`, which are made longer where needed."""
    last = max(len(part.materials) - 1, 0)
    own = np.clip(part.local.slots, 0, last)
    slots = np.zeros(last + 1, dtype=np.int64)
    for slot in np.unique(own):
        material = part.materials[slot] if part.materials else None
        if material not in materials:
            materials.append(material)
        slots[slot] = materials.index(material)
    return slots[own]


def joined_glow(parts: Sequence[Part]) -> Floats | None:
    """Return the glow of each triangle of all parts (t, 3), or None where nothing glows."""
    if all(part.glow is None for part in parts):
        return None
    return np.concatenate(
        [np.zeros((len(part.local.triangles), 3)) if part.glow is None else part.glow for part in parts]
    )


def baked_targets(
    scene: Scene, targets: Iterable[Target], result: BakeResult, settings: BakeSettings
) -> list[tuple[Target, BakedMesh]]:
    """Return each target with its baked values, those of several meshes joined as `Target.local` joins them."""
    baked = {mesh.mesh: mesh for mesh in result.meshes}
    joined = [(target, _joined_values(scene, target, [baked[mesh] for mesh in target.meshes])) for target in targets]
    # What is emitted is no indirect light, whether it lights others or not.
    glows = settings.light != "INDIRECT"
    return [(target, _glowing(values, target.glow if glows else None)) for target, values in joined]


def _glowing(baked: BakedMesh, glow: Floats | None) -> BakedMesh:
    """Return the values with the glow of triangles (t, 3) added on both sides, as emission shows on both."""
    if glow is None:
        return baked
    added = glow[baked.parent_triangle][:, None]

    def more(light: _Light) -> _Light:
        back = None if light.radiosity_back is None else light.radiosity_back + added
        return replace(light, radiosity=light.radiosity + added, radiosity_back=back)

    # It lights nothing, so it is in no light group.
    groups = tuple(group if group.name else more(group) for group in baked.groups)
    return replace(more(baked), groups=groups)


def _joined_values(scene: Scene, target: Target, baked: list[BakedMesh]) -> BakedMesh:
    if len(baked) == 1:
        return baked[0]
    known = [len(scene.meshes[mesh].vertices) for mesh in target.meshes]
    # The vertices that were there before come first, those of all parts.
    first_known = _starts(known)
    first_added = sum(known) + _starts([len(mesh.vertices) - count for mesh, count in zip(baked, known, strict=True)])
    first_triangle = _starts([len(scene.meshes[mesh].triangles) for mesh in target.meshes])
    joined: dict[str, Any] = {
        "mesh": target.meshes[0],
        "vertices": np.concatenate(
            [mesh.vertices[:count] for mesh, count in zip(baked, known, strict=True)]
            + [mesh.vertices[count:] for mesh, count in zip(baked, known, strict=True)]
        ),
        "triangles": np.concatenate(
            [
                np.where(mesh.triangles < count, mesh.triangles + old, mesh.triangles - count + new)
                for mesh, count, old, new in zip(baked, known, first_known, first_added, strict=True)
            ]
        ),
        "parent_triangle": np.concatenate(
            [mesh.parent_triangle + first for mesh, first in zip(baked, first_triangle, strict=True)]
        ),
    }
    for field in fields(BakedMesh):
        if field.name not in {*joined, "groups"}:
            joined[field.name] = _joined_corners([getattr(mesh, field.name) for mesh in baked], baked)
    return BakedMesh(**joined, groups=_joined_groups(baked))


def _joined_groups(baked: list[BakedMesh]) -> tuple[GroupLight, ...]:
    """Return the light groups of several meshes, which all have the same."""
    of_group = zip(*(mesh.groups for mesh in baked), strict=True)
    return tuple(
        GroupLight(
            groups[0].name,
            *(
                _joined_corners([getattr(group, field.name) for group in groups], baked)
                for field in fields(GroupLight)[1:]
            ),
        )
        for groups in of_group
    )


def _joined_corners(values: list[Floats | None], baked: list[BakedMesh]) -> Floats | None:
    """Return values of corners one part after the other; where only some have a back, that of the others is black."""
    if all(part is None for part in values):
        return None
    blank = [np.zeros((len(mesh.triangles), 3, 3)) for mesh in baked]
    return np.concatenate([none if part is None else part for part, none in zip(values, blank, strict=True)])
