# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The colours of meshes: what their materials make of each triangle, and of each small cell of those that vary."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Any

import bpy
import numpy as np

from ..core.geometry import largest_edges
from ..core.scene import Floats, Ints, Texture
from ..core.textures import cell_centres, with_means
from .evaluation import Evaluation, NotEvaluatedError, Template, evaluate, left_out_of, read_template
from .local_mesh import LocalMesh, placed
from .materials import material_surface
from .surface import Surface
from .varying import Attributes, Points, read_attributes, varies

MOST_CELLS = 2**19
"""Cells of all meshes of a scene together: 12 MB of colours, and about a second to fill them."""

MOST_ALONG = 256
"""Cells along the edge of a triangle."""

_LARGEST_RATIO = 64.0
"""Of a large triangle's edges to those of a small one that may still have as many cells."""

WHITE = 1.001
"""Reflectance up to which a colour is white: the rounding of textures may add a little."""

POINTS_AT_ONCE = 2**17
"""Places at which a material is evaluated together."""


@dataclass(frozen=True, eq=False)
class Appearance:
    """Colours of a mesh of t triangles, as `core.scene.SurfaceMesh` takes them.

    Attributes
    ----------
    reflectance, emission : (t, 3) float
    reflectance_texture, emission_texture : Texture or None
    own_reflectance : (t, 3) float or None
    own_reflectance_texture : Texture or None
    translucence, transmittance : (t, 3) float or None
    translucence_texture, transmittance_texture : Texture or None
    refraction : (t,) float or None
    clear, front_only : (t,) bool or None
    bare : bool
        Whether it has no colours of its own.
    """

    reflectance: Floats
    emission: Floats
    reflectance_texture: Texture | None = None
    emission_texture: Texture | None = None
    own_reflectance: Floats | None = None
    own_reflectance_texture: Texture | None = None
    translucence: Floats | None = None
    translucence_texture: Texture | None = None
    transmittance: Floats | None = None
    transmittance_texture: Texture | None = None
    refraction: Floats | None = None
    clear: np.ndarray | None = None
    bare: bool = False
    front_only: np.ndarray | None = None

    def painted(self, reflectance: Floats) -> "Appearance":
        """The same with one reflectance (3,) all over."""
        return replace(
            self,
            reflectance=np.broadcast_to(reflectance, self.reflectance.shape),
            reflectance_texture=None,
            own_reflectance=None,
            own_reflectance_texture=None,
        )

    def without_light(self) -> "tuple[Appearance, Floats | None]":
        """The same without emission, and the emission (t, 3) of each triangle in the mean, None where there is none."""
        emission = with_means(self.emission, self.emission_texture)
        if not emission.any():
            return self, None
        return replace(self, emission=np.zeros_like(emission), emission_texture=None), emission


class Colouring:
    """Reads the materials of meshes, and gives each mesh its colours when all are known: they share the cells.

    Attributes
    ----------
    users_of_note, users_of_evaluated : dict of (str, str) to dict of str
        Objects by material and what is to be said of it; by material and the nodes that Blender evaluated.
    """

    def __init__(self) -> None:
        self._surfaces: dict[Any, Surface] = {}
        self._attributes: dict[int, Attributes] = {}
        self._templates: dict[int, Template] = {}
        self._evaluations: dict[Any, Evaluation] = {}
        self._known: dict[Any, Appearance] = {}
        self._too_bright: dict[Any, set[int]] = {}
        self.users_of_note: dict[tuple[str, str], dict[str, None]] = {}
        self.users_of_evaluated: dict[tuple[str, str], dict[str, None]] = {}

    def read(self, obj: bpy.types.Object, local: LocalMesh, materials: tuple[Any, ...]) -> None:
        """Copy what the materials of an evaluated object need of its mesh."""
        surfaces = [self._surface(material) for material in materials]
        if id(local) not in self._attributes and any(varies(*surface.colours()) for surface in surfaces):
            self._attributes[id(local)] = read_attributes(obj.to_mesh())
            obj.to_mesh_clear()
        if id(local) not in self._templates and any(surface.unread for surface in surfaces):
            self._templates[id(local)] = read_template(obj)

    def appearances(self, entries: Sequence[tuple[Any, ...]]) -> list[Appearance]:
        """Return the colours of meshes.

        Parameters
        ----------
        entries : sequence of (Object, LocalMesh, tuple of Material or None, (4, 4) float, float)
            The original that shows a mesh, the mesh, the materials of its slots, its place and its random number.
        """
        found = []
        for _, local, materials, matrix, _ in entries:
            # Like the renderers: a face whose slot does not exist takes the last one.
            slot = np.clip(local.slots, 0, max(len(materials) - 1, 0))
            surfaces = [self._surface(material) for material in materials] or [self._surface(None)]
            varied = np.array([varies(*surface.colours()) or bool(surface.unread) for surface in surfaces])
            longest = np.zeros(len(slot))
            if varied.any():
                longest = largest_edges(placed(local, matrix)[0], local.triangles) * varied[slot]
            found.append((surfaces, slot, longest))
        appearances = []
        along = cells_along([longest for *_, longest in found])
        for entry, (surfaces, slot, _), cells in zip(entries, found, along, strict=True):
            # A cell costs Cycles far more than it costs us.
            unread = np.array([bool(surface.unread) for surface in surfaces])[slot]
            cells = np.where(unread, np.maximum(cells // 2, 1), cells)
            appearances.append(self._appearance(*entry, surfaces, slot, cells))
        return appearances

    def _surface(self, material: bpy.types.Material | None) -> Surface:
        if material not in self._surfaces:
            self._surfaces[material] = material_surface(material)
        return self._surfaces[material]

    def _appearance(
        self,
        original: bpy.types.Object,
        local: LocalMesh,
        materials: tuple[Any, ...],
        matrix: Floats,
        random: float,
        surfaces: list[Surface],
        slot: Ints,
        along: Ints,
    ) -> Appearance:
        flipped = np.linalg.det(matrix[:3, :3]) < 0.0
        used = [int(number) for number in np.unique(slot) if number < len(materials) and materials[number] is not None]
        for number in used:
            for note in surfaces[number].notes:
                self._tell(self.users_of_note, materials[number], note, original)
        attributes = self._attributes.get(id(local))
        if attributes is not None and flipped:
            attributes = attributes.turned_over()
        evaluation = None
        unread = [number for number in used if surfaces[number].unread]
        if unread:
            evaluation = self._evaluated(original, local, materials, matrix, random, surfaces, slot, along, unread)
        if evaluation is not None and flipped:
            evaluation = evaluation.turned_over(along)
        # Instances of one mesh look alike.
        key = id(local), materials, along.tobytes(), flipped, id(evaluation)
        if key not in self._known:
            self._known[key] = appearance_of(surfaces, slot, attributes, along, evaluation)
            self._too_bright[key] = brighter_than_white(self._known[key])
        for number in self._too_bright[key].intersection(used):
            note = "its colour is brighter than white in places; white was used there"
            self._tell(self.users_of_note, materials[number], note, original)
        return self._known[key]

    def _evaluated(
        self,
        original: bpy.types.Object,
        local: LocalMesh,
        materials: tuple[Any, ...],
        matrix: Floats,
        random: float,
        surfaces: list[Surface],
        slot: Ints,
        along: Ints,
        unread: list[int],
    ) -> Evaluation | None:
        """Return what Blender makes of the materials that cannot be read; None if it fails, which a note then tells."""
        template = self._templates[id(local)]
        place = template.place_of(original, matrix, random, [materials[k] for k in unread])
        key = id(local), materials, along.tobytes(), place
        try:
            if key not in self._evaluations:
                wanted = np.isin(slot, unread)
                self._evaluations[key] = evaluate(
                    original, template, local, materials, matrix, random, slot, wanted, along
                )
        except NotEvaluatedError as error:
            for number in unread:
                nodes = ", ".join(surfaces[number].unread)
                note = f"{nodes} could not be evaluated ({error}); the values set on the sockets were used instead"
                self._tell(self.users_of_note, materials[number], note, original)
            return None
        for number in unread:
            for note in left_out_of(materials[number].node_tree):
                self._tell(self.users_of_note, materials[number], note, original)
            self._tell(self.users_of_evaluated, materials[number], ", ".join(surfaces[number].unread), original)
        return self._evaluations[key]

    @staticmethod
    def _tell(users: dict[tuple[str, str], dict[str, None]], material, note: str, original) -> None:
        users.setdefault((material.name, note), {})[original.name] = None


def appearance_of(
    surfaces: Sequence[Surface],
    slot_of_triangle: Ints,
    attributes: Attributes | None,
    along: Ints,
    evaluation: Evaluation | None = None,
) -> Appearance:
    """Return the colours of a mesh.

    Parameters
    ----------
    surfaces : sequence of Surface
        Of its slots.
    slot_of_triangle : (t,) int
    attributes : Attributes or None
        None where no surface varies.
    along : (t,) int
        Cells along the edges of triangles that vary, powers of two.
    evaluation : Evaluation or None
        What is taken for the triangles that it has, in place of what was read of their materials.
    """
    evaluated = np.zeros(len(slot_of_triangle), dtype=bool)
    if evaluation is not None:
        evaluated[evaluation.triangle] = True
    colours: dict[str, Any] = {}
    for name in ("clear", "front_only"):
        marks = np.array([getattr(surface, name) for surface in surfaces])
        if marks.any():
            colours[name] = marks[slot_of_triangle]
    colours["bare"] = all(surfaces[number].is_bare for number in np.unique(slot_of_triangle))
    refraction = np.array([surface.refraction for surface in surfaces])
    if (refraction > 1.0).any():
        colours["refraction"] = refraction[slot_of_triangle]
    glossy = any(surfaces[number].is_glossy for number in np.unique(slot_of_triangle)) or (
        evaluation is not None and evaluation.mirrored is not None
    )
    for name, read in _READ.items():
        if name == "own_reflectance" and not glossy:
            continue
        values = [read(surface) for surface in surfaces]
        constants = np.array([np.zeros(3) if varies(value) else value for value in values])
        # That of evaluated shaders counts as diffuse reflectance.
        known = None
        if evaluation is not None and name == "reflectance":
            known = _sent_on(evaluation, surfaces, slot_of_triangle, attributes, along)
        elif evaluation is not None and name != "translucence":
            known = evaluation.reflectance if name == "own_reflectance" else getattr(evaluation, name)
        if "reflectance" in name or name == "emission" or constants.any() or varies(*values) or known is not None:
            colours[name] = constants[slot_of_triangle]
        parts = []
        if known is not None:
            triangle = evaluation.triangle
            parts.append(Texture(triangle, slot_of_triangle[triangle], along[triangle], known))
        for slot, value in enumerate(values):
            triangle = np.flatnonzero((slot_of_triangle == slot) & ~evaluated)
            if varies(value) and len(triangle):
                cells = _cells(value, attributes, triangle, along[triangle])
                parts.append(Texture(triangle, np.full(len(triangle), slot), along[triangle], cells))
        if parts:
            colours[f"{name}_texture"] = _in_order(parts)
    return Appearance(**colours)


def brighter_than_white(appearance: Appearance) -> set[int]:
    """Return the slots with cells that would reflect more than all light, which the light transport does not have."""
    texture = appearance.own_reflectance_texture or appearance.reflectance_texture
    if texture is None:
        return set()
    cells = np.repeat(texture.part, texture.along**2)
    return set(np.unique(cells[(texture.colours > WHITE).any(axis=1)]).tolist())


_READ: dict[str, Callable[[Surface], Any]] = {
    "reflectance": Surface.sent_on,
    "own_reflectance": lambda surface: surface.reflectance,
    "emission": lambda surface: surface.emission,
    "translucence": lambda surface: surface.translucence,
    "transmittance": lambda surface: surface.through,
}
"""Where the colours of an `Appearance` come from."""


def _sent_on(
    evaluation: Evaluation, surfaces: Sequence[Surface], slot: Ints, attributes: Attributes | None, along: Ints
) -> np.ndarray:
    """Return what others get of the light on evaluated triangles, (cells, 3) float32: what is diffuse, and gloss."""
    triangle = evaluation.triangle
    cells = along[triangle] ** 2
    colours = evaluation.reflectance.copy()
    for number in np.unique(slot[triangle]):
        surface, own = surfaces[number], slot[triangle] == number
        if not (surface.is_glossy or evaluation.mirrored is not None):
            continue
        chosen = np.repeat(own, cells)

        def of_cells(value: Any, own=own) -> Any:
            return _cells(value, attributes, triangle[own], along[triangle[own]]) if varies(value) else value

        covered, mirrored = of_cells(surface.covered), of_cells(surface.mirrored)
        if evaluation.mirrored is not None:
            # Clear layers, which are not baked, mirror all that they keep from what is below.
            mirrored = evaluation.mirrored[chosen] + covered
        colours[chosen] = np.clip(colours[chosen] * (1.0 - covered) + mirrored, 0.0, 1.0)
    return colours


def cells_along(longest_edges: Sequence[Floats]) -> list[Ints]:
    """Return how many cells the triangles of meshes get along their edges, powers of two that make cells about equal.

    Parameters
    ----------
    longest_edges : sequence of (t,) float, scene units
        Of the triangles of each mesh; 0 for those that do not vary.
    """
    every = np.concatenate([np.zeros(0), *longest_edges])
    every = every[np.isfinite(every)]
    size = float(every.max(initial=0.0)) / (MOST_ALONG * _LARGEST_RATIO) or 1.0

    def along(edges: Floats) -> Ints:
        level = np.round(np.log2(np.clip(np.nan_to_num(edges, posinf=0.0) / size, 1.0, MOST_ALONG)))
        return 2 ** level.astype(np.int64)

    while (along(every) ** 2).sum() > MOST_CELLS and along(every).max() > 1:
        size *= 1.25
    return [along(edges) for edges in longest_edges]


def _cells(value, attributes: Attributes, triangle: Ints, along: Ints) -> np.ndarray:
    """Return the colours (cells, 3) float32 of triangles, one after the other."""
    first = np.cumsum(along**2) - along**2
    colours = np.empty((int((along**2).sum()), 3), dtype=np.float32)
    for count in np.unique(along):
        # A triangle of one cell is seen at four places of it.
        finer = int(count) * (2 if count == 1 else 1)
        u, v = cell_centres(finer).astype(np.float64).T
        step = 1.0 / finer
        places = np.stack([np.stack([u, v], 1), np.stack([u + step, v], 1), np.stack([u, v + step], 1)], axis=1)
        weights = np.concatenate([1.0 - places.sum(axis=2, keepdims=True), places], axis=2)
        same = np.flatnonzero(along == count)
        size = max(1, POINTS_AT_ONCE // len(u))
        for begin in range(0, len(same), size):
            some = same[begin : begin + size]
            points = Points(attributes, np.repeat(triangle[some], len(u)), np.tile(weights, (len(some), 1, 1)))
            found = np.broadcast_to(value.at(points), (len(points.triangle), 3))
            found = found.reshape(len(some), int(count) ** 2, -1, 3).mean(axis=2)
            colours[first[some, None] + np.arange(int(count) ** 2)] = found
    return colours


def _in_order(parts: list[Texture]) -> Texture:
    """Return one texture of several, its triangles in ascending order."""
    triangle, part, along = (
        np.concatenate([getattr(p, name) for p in parts]) for name in ("triangle", "part", "along")
    )
    colours = np.concatenate([p.colours for p in parts])
    order = np.argsort(triangle)
    count = along**2
    first = np.cumsum(count) - count
    cell = np.concatenate(
        [np.arange(begin, begin + many) for begin, many in zip(first[order], count[order], strict=True)]
    )
    return Texture(triangle[order], part[order], along[order], colours[cell])
