# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Everything that a dependency graph shows, read once: meshes, lamps, and which of them carry colours."""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Any, NamedTuple

import bpy
import numpy as np

from ..core.scene import Floats, Lamp, LightGroup, PointLamp, SurfaceMesh
from .appearance import Appearance, Colouring
from .display import is_display
from .lamp_profiles import NoProfileError, Profiles, profiles_of, unturned, with_profile
from .lamps import ReadLamp, lamp_of
from .layers import Layers, joined_layers, layers_of
from .linking import light_linking, linked_objects
from .local_mesh import LocalMesh, fingerprint, local_mesh, placed, turned_over
from .naming import named
from .object_random import object_random
from .object_settings import Role, role_of
from .participants import Participants
from .places import Outputs
from .record import BAKED_IN_PLACE
from .targets import Part, Target, joined_glow, joined_mesh

UNSUPPORTED_TYPES = {"CURVES", "POINTCLOUD", "VOLUME", "GREASEPENCIL", "GPENCIL"}
"""Types of objects that show something in renders which is no mesh."""


@dataclass(frozen=True, eq=False)
class _Entry:
    """A mesh that the dependency graph shows.

    Attributes
    ----------
    order : tuple
        By which entries are sorted.
    original : Object
        That the mesh is of.
    owner : Object or None
        That is to carry its colours.
    role : Role
    local : LocalMesh
    materials : tuple of Material or None
    matrix : (4, 4) float
    layers : Layers or None
    light_group : str
        Empty for none.
    makers : tuple of Object
        What makes an instance, and what it is of; or the object alone.
    random : float, 0..1
        That an Object Info node tells.
    """

    order: tuple[Any, ...]
    original: bpy.types.Object
    owner: bpy.types.Object | None
    role: Role
    local: LocalMesh
    materials: tuple[Any, ...]
    matrix: Floats
    layers: Layers | None
    light_group: str
    makers: tuple[bpy.types.Object, ...]
    random: float


class _LampEntry(NamedTuple):
    """A lamp that the dependency graph shows: its object, what was read of it, its place, and as of `_Entry`."""

    original: bpy.types.Object
    read: ReadLamp
    matrix: Floats
    light_group: str
    makers: tuple[bpy.types.Object, ...]


class SceneReader:
    """Goes once over everything that a dependency graph shows."""

    def __init__(
        self,
        depsgraph: bpy.types.Depsgraph,
        participants: Participants,
        wanted: set[bpy.types.Object],
        outputs: Outputs,
        output: str,
    ) -> None:
        self._depsgraph = depsgraph
        self._participants = participants
        self._wanted = wanted
        self._outputs = outputs
        self._output = output
        self._local_meshes: dict[int, LocalMesh | None] = {}
        self._layers_of_mesh: dict[int, Layers] = {}
        self._colouring = Colouring()
        self._left_out: dict[str, None] = {}
        self._users_of_lamp_note: dict[str, dict[str, None]] = {}
        self.meshes: list[SurfaceMesh] = []
        self._lamp_entries: list[_LampEntry] = []
        self._profiles: dict[Any, Profiles] = {}
        self._evaluated_lamps: dict[str, None] = {}
        self.lamps: list[Lamp] = []
        self._groups_of_meshes: list[str] = []
        self._groups_of_lamps: list[str] = []
        self._makers_of_lamps: list[tuple[bpy.types.Object, ...]] = []
        self.targets: list[Target] = []
        self._parts: dict[bpy.types.Object, list[Part]] = {}
        self._matrices: dict[bpy.types.Object, Floats] = {}
        self._unbaked_instances: dict[str, None] = {}
        self._instanced_lamps: dict[str, None] = {}
        self._shown_elsewhere: dict[tuple[str, str], None] = {}
        self._hairy: dict[str, None] = {}
        self._unreceiving: dict[tuple[str, str], None] = {}
        self.shown: set[bpy.types.Object] = set()
        self.clear: set[bpy.types.Object] = set()

    def read(self) -> None:
        """Fill `meshes`, `lamps` and `targets`, in an order that does not depend on how the graph was built."""
        entries = sorted(self._entries(), key=lambda entry: entry.order)
        self._read_lamps()
        colours = self._colouring.appearances([(e.original, e.local, e.materials, e.matrix, e.random) for e in entries])
        for entry, appearance in zip(entries, colours, strict=True):
            self._add(entry, appearance)
        self._link_lights([entry.makers for entry in entries])
        self.targets = [self._target(owner, parts) for owner, parts in self._parts.items()]

    def light_groups(self, world: bpy.types.World | None, suns: int) -> tuple[LightGroup, ...]:
        """Return the light groups that something which gives light is in, in the order of their names.

        Parameters
        ----------
        suns : int
            Lamps after those that were read, which stand for parts of the world.
        """
        of_world = world.lightgroup if world is not None else ""
        groups_of_lamps = [*self._groups_of_lamps, *[of_world] * suns]
        named = {group for group, mesh in zip(self._groups_of_meshes, self.meshes, strict=True) if mesh.emits()}
        return tuple(
            LightGroup(
                name,
                frozenset(index for index, group in enumerate(self._groups_of_meshes) if group == name),
                frozenset(index for index, group in enumerate(groups_of_lamps) if group == name),
                of_world == name,
            )
            for name in sorted(named.union(self._groups_of_lamps, [of_world]) - {""})
        )

    def warnings(self) -> list[str]:
        """Return a sentence for everything that was left out or guessed."""
        sentences = self._notes_on_materials()
        sentences += [f"Lamp {named(users)}: {note}" for note, users in self._users_of_lamp_note.items()]
        if self._left_out:
            names = named(self._left_out, most=None)
            sentences.append(f"{names} left out: only objects that render as meshes take part")
        if self._hairy:
            sentences.append(
                f"The hair of {named(self._hairy, most=None)} was left out: only what renders as meshes takes part"
            )
        sentences += [
            f'The instances of "{name}" that "{owner}" makes will show the light of "{name}" itself; '
            f'bake "{owner}", too, with Refined Mesh'
            for name, owner in self._shown_elsewhere
        ]
        sentences += [
            f'The instances that "{name}" makes have no mesh of their own and were not baked; Refined Mesh bakes them'
            for name in self._unbaked_instances
        ]
        sentences += [
            f'The lamps that "{name}" instances are hidden together with it; their light is in the colours'
            for name in self._instanced_lamps
        ]
        sentences += [
            f'The instances of "{name}" do not receive light and are hidden together with "{owner}"'
            for name, owner in self._unreceiving
        ]
        return sentences

    def _notes_on_materials(self) -> list[str]:
        """Return one sentence for each note, however many materials it is on: copies have the same."""
        materials: dict[str, dict[str, None]] = {}
        users: dict[str, dict[str, None]] = {}
        for (material, note), of_both in self._colouring.users_of_note.items():
            materials.setdefault(note, {})[material] = None
            users.setdefault(note, {}).update(of_both)
        return [
            f"Material{'s' if len(of_note) > 1 else ''} {named(of_note)} of {named(users[note])}: {note}"
            for note, of_note in materials.items()
        ]

    def evaluated(self) -> list[str]:
        """Return a sentence for each material that Blender evaluated, and one on lamps."""
        sentences = [
            f'Material "{material}" of {named(users)}: {nodes}'
            for (material, nodes), users in self._colouring.users_of_evaluated.items()
        ]
        if self._evaluated_lamps:
            sentences.append(f"The directions in which {named(self._evaluated_lamps)} shines")
        return sentences

    def _entries(self) -> Iterator[_Entry]:
        lamps: list[tuple[Any, _LampEntry]] = []
        for instance in self._depsgraph.object_instances:
            if not self._participants.include(instance):
                continue
            obj = instance.object
            original = obj.original
            if obj.type in UNSUPPORTED_TYPES:
                self._left_out[original.name] = None
            if _has_hair(original):
                self._hairy[original.name] = None
            parent = instance.parent.original if instance.is_instance else None
            order = (
                original.name_full,
                parent.name_full if parent else "",
                tuple(instance.persistent_id) if parent else (),
            )
            matrix = np.array(instance.matrix_world, dtype=np.float64)
            if parent is not None and self._shows_what_is_baked(original, parent):
                self._shown_elsewhere[(original.name, parent.name)] = None
            role = role_of([original] if parent in (None, original) else [original, parent])
            owner = self._owner(instance, matrix, role)
            # As Cycles has it: what makes an instance may name the group for it.
            light_group = original.lightgroup or (parent.lightgroup if parent else "")
            makers = (original,) if parent is None else (parent, original)
            if obj.type == "LIGHT":
                if role.seen:
                    lamps.append((order, _LampEntry(original, lamp_of(obj, matrix), matrix, light_group, makers)))
                if owner is not None:
                    self._instanced_lamps[owner.name] = None
            if obj.type != "MESH":
                continue
            local = self._local_mesh(obj)
            if local is not None:
                layers = self._layers(obj) if owner is not None and self._output == "REFINED" else None
                materials = self._materials(obj, local)
                self._colouring.read(obj, local, materials)
                random = object_random(instance)
                yield _Entry(
                    order, original, owner, role, local, materials, matrix, layers, light_group, makers, random
                )
        self._lamp_entries = [entry for _, entry in sorted(lamps, key=lambda found: found[0])]

    def _read_lamps(self) -> None:
        """Fill `lamps` with what each lamp does, now that the graph was read: nodes may have to be evaluated."""
        for entry in self._lamp_entries:
            for lamp in self._lamps_of(entry):
                self.lamps.append(lamp)
                self._groups_of_lamps.append(entry.light_group)
                self._makers_of_lamps.append(entry.makers)

    def _lamps_of(self, entry: _LampEntry) -> tuple[Lamp, ...]:
        lamp, notes, unread, factor = entry.read
        found = () if lamp is None else (lamp,)
        if unread and isinstance(lamp, PointLamp):
            light = entry.original.data
            try:
                axes = entry.matrix[:3, :3]
                found = with_profile(lamp, self._profiles_of(light, unturned(light, axes)), axes)
                self._evaluated_lamps[entry.original.name] = None
            except NoProfileError as error:
                notes = (*notes, *unread, f"its nodes could not be evaluated ({error})")
                found = (replace(lamp, strength=lamp.strength * factor),)
        for note in notes:
            self._users_of_lamp_note.setdefault(note, {})[entry.original.name] = None
        return found

    def _profiles_of(self, light: bpy.types.Light, axes: Floats) -> Profiles:
        key = light, axes.tobytes()
        if key not in self._profiles:
            self._profiles[key] = profiles_of(light, axes)
        return self._profiles[key]

    def _link_lights(self, makers_of_meshes: list[tuple[bpy.types.Object, ...]]) -> None:
        """Tell all that gives light which meshes it is for."""
        everything = {maker for makers in (*makers_of_meshes, *self._makers_of_lamps) for maker in makers}
        linked = {obj for obj in everything if linked_objects(obj)}
        linked.update(*(linked_objects(obj) for obj in linked))
        if not linked:
            return

        # As Cycles has it: what makes an instance is linked for it, if it is linked at all.
        def linked_by(makers: tuple[bpy.types.Object, ...]) -> bpy.types.Object:
            return makers[0] if makers[0] in linked else makers[-1]

        owners = [linked_by(makers) for makers in makers_of_meshes]
        self.lamps = [
            replace(lamp, linking=light_linking(linked_by(makers), owners))
            for lamp, makers in zip(self.lamps, self._makers_of_lamps, strict=True)
        ]
        self.meshes = [
            replace(mesh, linking=light_linking(owner, owners)) if mesh.emits() else mesh
            for mesh, owner in zip(self.meshes, owners, strict=True)
        ]

    def _shows_what_is_baked(self, original: bpy.types.Object, parent: bpy.types.Object) -> bool:
        """Return whether an instance that `parent` makes of `original` will show the colours that `original` gets.

        Colours in place are on the mesh that is instanced. A refined mesh is in the collections of its original, while
        objects that are instanced one by one stay the originals.
        """
        if original not in self._wanted or parent is original or parent in self._wanted:
            return False
        return self._output == "ORIGINAL" or parent.instance_type == "COLLECTION"

    def _owner(
        self, instance: bpy.types.DepsgraphObjectInstance, matrix: Floats, role: Role
    ) -> bpy.types.Object | None:
        """Return the object that is to carry the colours of an instance, or of an object itself; None for nobody."""
        owner = (instance.parent if instance.is_instance else instance.object).original
        if owner not in self._wanted:
            return None
        self.shown.add(owner)
        self._matrices[owner] = np.array(instance.parent.matrix_world) if instance.is_instance else matrix
        if self._output == "ORIGINAL" and instance.is_instance:
            self._unbaked_instances[owner.name] = None
            return None
        if not role.receives:
            if instance.is_instance and owner.radiosity_settings.receives:
                self._unreceiving[(instance.object.original.name, owner.name)] = None
            return None
        return owner

    def _materials(self, obj: bpy.types.Object, local: LocalMesh) -> tuple[Any, ...]:
        override = self._participants.view_layer.material_override
        return _slot_materials(obj, local) if override is None else (override,)

    def _local_mesh(self, obj: bpy.types.Object) -> LocalMesh | None:
        key = obj.data.as_pointer()
        if key not in self._local_meshes:
            # Not `obj.data`: with subdivision on the graphics card that is still the coarse mesh.
            mesh = obj.to_mesh()
            self._local_meshes[key] = local_mesh(mesh) if mesh is not None and len(mesh.polygons) else None
            obj.to_mesh_clear()
        return self._local_meshes[key]

    def _layers(self, obj: bpy.types.Object) -> Layers:
        key = obj.data.as_pointer()
        if key not in self._layers_of_mesh:
            self._layers_of_mesh[key] = layers_of(obj, obj.to_mesh())
            obj.to_mesh_clear()
        return self._layers_of_mesh[key]

    def _add(self, entry: _Entry, appearance: Appearance) -> None:
        local, role, matrix = entry.local, entry.role, entry.matrix
        if np.linalg.det(matrix[:3, :3]) < 0.0:
            local = turned_over(local)
        if role.reflectance is not None:
            appearance = appearance.painted(role.reflectance)
        glow = None
        if not role.lights:
            appearance, glow = appearance.without_light()
        owner = entry.owner
        if owner is not None and appearance.bare:
            # Colours on it would hide what is seen through it.
            self.clear.add(owner)
            owner = None
        if owner is not None:
            part = Part(len(self.meshes), local, entry.materials, matrix, entry.layers, glow)
            self._parts.setdefault(owner, []).append(part)
        vertices, normals = placed(local, matrix)
        self._groups_of_meshes.append(entry.light_group)
        self.meshes.append(
            SurfaceMesh(
                name=entry.original.name,
                vertices=vertices,
                triangles=local.triangles,
                corner_normals=normals,
                reflectance=appearance.reflectance,
                emission=appearance.emission,
                reflectance_texture=appearance.reflectance_texture,
                own_reflectance=appearance.own_reflectance,
                own_reflectance_texture=appearance.own_reflectance_texture,
                emission_texture=appearance.emission_texture,
                clear=appearance.clear,
                translucence=appearance.translucence,
                translucence_texture=appearance.translucence_texture,
                transmittance=appearance.transmittance,
                transmittance_texture=appearance.transmittance_texture,
                refraction=appearance.refraction,
                front_only=appearance.front_only,
                baked=owner is not None,
                seen=role.seen,
                shadow=role.shadow,
                grazing=role.grazing,
            )
        )

    def _target(self, owner: bpy.types.Object, parts: list[Part]) -> Target:
        matrix = self._matrices[owner]
        # Its own mesh first, so that its slots stay as they are.
        parts = sorted(parts, key=lambda part: not np.array_equal(part.matrix, matrix))
        local = joined_mesh(parts, matrix)
        materials = local.materials if len(parts) > 1 else parts[0].materials
        return Target(
            uid=owner.session_uid,
            name=owner.name,
            meshes=tuple(part.mesh for part in parts),
            matrix=matrix,
            shown=np.array(self._outputs.get(owner, [owner])[0].matrix_world),
            flipped=bool(np.linalg.det(matrix[:3, :3]) < 0.0),
            local=local,
            fingerprint=fingerprint(owner.data),
            same_corners=owner.type == "MESH" and _has_corners_of(owner.data, local),
            materials=tuple(material and material.name_full for material in materials),
            layers=joined_layers([part.layers for part in parts], [part.local for part in parts]),
            glow=joined_glow(parts),
        )


def _has_hair(obj: bpy.types.Object) -> bool:
    """Return whether particles of `obj` render as strands."""
    return any(
        system.settings.type == "HAIR" and system.settings.render_type == "PATH" for system in obj.particle_systems
    )


def _has_corners_of(mesh: bpy.types.Mesh, local: LocalMesh) -> bool:
    corners = np.empty(len(mesh.loops), dtype=np.int32)
    mesh.loops.foreach_get("vertex_index", corners)
    return len(mesh.vertices) == len(local.vertices) and np.array_equal(corners, local.vertex_of_corner)


def _slot_materials(obj: bpy.types.Object, local: LocalMesh) -> tuple[Any, ...]:
    """Return the material of each index: the object's where its slot says so, else the evaluated mesh's own.

    An object that was baked in place shows the display material; the ones that it remembers count.
    """
    materials = list(local.materials)
    record = obj.original.radiosity
    own = obj.original.material_slots
    for index, slot in enumerate(obj.material_slots):
        if slot.link == "OBJECT":
            # Where it is empty, an evaluated slot tells the mesh's material, which is not rendered.
            materials[index : index + 1] = [own[index].material if index < len(own) else slot.material]
        elif index >= len(materials):
            materials.append(slot.material)
    if record.kind == BAKED_IN_PLACE:
        for index, material in enumerate(materials):
            if is_display(material):
                materials[index] = record.slots[index].material if index < len(record.slots) else None
    return tuple(material and material.original for material in materials)
