# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Which objects take part in the light: all that a rendering of the view layer shows, whatever the viewport hides."""

from collections.abc import Iterator
from contextlib import contextmanager
from itertools import chain

import bpy

from .journal import Journal
from .record import hidden_in_render, is_output


def rendered_objects(view_layer: bpy.types.ViewLayer) -> set[bpy.types.Object]:
    """Return the objects that a rendering of `view_layer` shows, as if nothing had been baked yet.

    An object renders when any collection that holds it does, with all the collections above that one.
    """
    found = set()
    for layer_collection in _rendered_layer_collections(view_layer):
        found.update(layer_collection.collection.objects)
    return {obj for obj in found if not hidden_in_render(obj) and not is_output(obj)}


def lamps_out_of_renders(context: bpy.types.Context) -> list[str]:
    """Return the names of lamps with some power that the scene has and a rendering of the view layer does not show."""
    shown = rendered_objects(context.view_layer)
    return [obj.name for obj in context.scene.objects if obj.type == "LIGHT" and obj not in shown and obj.data.energy]


def is_stamp(obj: bpy.types.Object) -> bool:
    """Return whether `obj` is there to be instanced on its parent's vertices or faces, and does not render itself."""
    return obj.parent is not None and obj.parent.instance_type in {"VERTS", "FACES"}


def _rendered_layer_collections(view_layer: bpy.types.ViewLayer) -> Iterator[bpy.types.LayerCollection]:
    pending = [view_layer.layer_collection]
    while pending:
        layer_collection = pending.pop()
        if layer_collection.collection.hide_render:
            continue
        pending.extend(layer_collection.children)
        # A child may be included again below an excluded collection, so exclusion does not end the descent.
        if not layer_collection.exclude:
            yield layer_collection


def _rendered_collections(collection: bpy.types.Collection) -> Iterator[bpy.types.Collection]:
    pending = [collection]
    while pending:
        current = pending.pop()
        if not current.hide_render:
            yield current
            pending.extend(current.children)


def _layers_behind(scene: bpy.types.Scene) -> Iterator[bpy.types.ViewLayer]:
    """Yield the view layers of a scene's background scene, and of that one's: they render with it."""
    seen = {scene}
    while (scene := scene.background_set) is not None and scene not in seen:
        seen.add(scene)
        yield next((layer for layer in scene.view_layers if layer.use), scene.view_layers[0])


class Participants:
    """The objects and instances of a view layer that take part in the light transport."""

    def __init__(self, view_layer: bpy.types.ViewLayer) -> None:
        self.view_layer = view_layer
        self.layers = (view_layer, *_layers_behind(view_layer.id_data))
        self.objects = set().union(*(rendered_objects(layer) for layer in self.layers))
        self.instanced_collections: set[bpy.types.Collection] = set()
        self._members: dict[bpy.types.Collection, set[bpy.types.Object]] = {}
        self._everyone: dict[bpy.types.Collection, set[bpy.types.Object]] = {}
        pending = list(self.objects)
        while pending:
            collection = self._instanced_by(pending.pop())
            if collection is not None and collection not in self._members:
                parts = list(_rendered_collections(collection))
                self.instanced_collections.update(parts)
                members = {obj for part in parts for obj in part.objects if not hidden_in_render(obj)}
                self._members[collection] = {obj for obj in members if not is_output(obj)}
                self._everyone[collection] = set(collection.all_objects)
                pending.extend(members)

    @staticmethod
    def _instanced_by(obj: bpy.types.Object) -> bpy.types.Collection | None:
        return obj.instance_collection if obj.instance_type == "COLLECTION" else None

    def everything(self) -> set[bpy.types.Object]:
        """Return the participating objects and those inside the collections that they instance."""
        return self.objects.union(*self._members.values())

    def include(self, instance: bpy.types.DepsgraphObjectInstance) -> bool:
        """Return whether one entry of `Depsgraph.object_instances` takes part."""
        original = instance.object.original
        if is_output(original) or not instance.show_self:
            return False
        if not instance.is_instance:
            return original in self.objects and not is_stamp(original)
        parent = instance.parent.original
        if parent not in self.objects:
            return False
        collection = self._instanced_by(parent)
        if original in self._everyone.get(collection, ()):
            return original in self._members[collection]
        # Geometry nodes instance an object whether it renders itself or not; the children of instancers must render.
        return parent.instance_type == "NONE" or not hidden_in_render(original)


@contextmanager
def shown_as_rendered(context: bpy.types.Context) -> Iterator[tuple[bpy.types.Depsgraph, Participants]]:
    """Lend a dependency graph of what renders, and put every switch back afterwards.

    Python can only ask for the viewport's graph, which leaves out what is hidden there and takes the viewport's
    modifiers. So for as long as the graph is read, the viewport shows what renders, and nothing is redrawn.
    """
    participants = Participants(context.view_layer)
    journal = Journal()
    try:
        _show_objects(journal, participants)
        _show_collections(journal, participants)
        _use_render_modifiers(journal, participants, context.scene)
        yield context.evaluated_depsgraph_get(), participants
    finally:
        journal.take_back()
        context.view_layer.update()


def _show_objects(journal: Journal, participants: Participants) -> None:
    for obj in participants.everything():
        if obj.hide_viewport:
            journal.set(obj, "hide_viewport", False)
        if obj.show_instancer_for_viewport != obj.show_instancer_for_render:
            journal.set(obj, "show_instancer_for_viewport", obj.show_instancer_for_render)
    for layer in participants.layers:
        for obj in participants.objects.intersection(layer.objects):
            if obj.hide_get(view_layer=layer):
                journal.on_failure(_hide, obj, layer)
                obj.hide_set(False, view_layer=layer)


def _hide(obj: bpy.types.Object, view_layer: bpy.types.ViewLayer) -> None:
    obj.hide_set(True, view_layer=view_layer)


def _show_collections(journal: Journal, participants: Participants) -> None:
    for layer_collection in chain.from_iterable(map(_rendered_layer_collections, participants.layers)):
        if layer_collection.hide_viewport:
            journal.set(layer_collection, "hide_viewport", False)
        if layer_collection.collection.hide_viewport:
            journal.set(layer_collection.collection, "hide_viewport", False)
    for collection in participants.instanced_collections:
        if collection.hide_viewport:
            journal.set(collection, "hide_viewport", False)


def _use_render_modifiers(journal: Journal, participants: Participants, scene: bpy.types.Scene) -> None:
    if scene.render.use_simplify:
        for name in ("simplify_subdivision", "simplify_child_particles"):
            _use_instead(journal, scene.render, name, f"{name}_render")
    everything = participants.everything()
    for obj in everything:
        for modifier in obj.modifiers:
            _use_instead(journal, modifier, "show_viewport", "show_render")
            for name, in_render in _LEVELS_OF_MODIFIERS.get(modifier.type, ()):
                _use_instead(journal, modifier, name, in_render)
        for system in obj.particle_systems:
            if system.settings.type == "HAIR":
                _use_instead(journal, system.settings, "child_percent", "rendered_child_count")
    for data in {obj.data for obj in everything}:
        if isinstance(data, bpy.types.MetaBall):
            _use_instead(journal, data, "resolution", "render_resolution")
        elif isinstance(data, bpy.types.Curve):
            _use_render_resolution(journal, data)


_LEVELS_OF_MODIFIERS = {
    "SUBSURF": (("levels", "render_levels"),),
    "MULTIRES": (("levels", "render_levels"),),
    "SCREW": (("steps", "render_steps"),),
    "OCEAN": (("viewport_resolution", "resolution"),),
}
"""Properties that count in the viewport, and those that count in renders."""


def _use_instead(journal: Journal, owner: object, name: str, in_render: str) -> None:
    """Give the property for the viewport the value of that for renders."""
    if getattr(owner, name) != getattr(owner, in_render):
        journal.set(owner, name, getattr(owner, in_render))


def _use_render_resolution(journal: Journal, curve: bpy.types.Curve) -> None:
    for name in ("resolution_u", "resolution_v"):
        in_render = getattr(curve, f"render_{name}")
        # At 0, renders take the viewport's.
        if in_render == 0:
            continue
        # A curve hands its resolution on to its splines, which may have others; they are taken back after it.
        for spline in curve.splines:
            journal.on_failure(setattr, spline, name, getattr(spline, name))
        journal.set(curve, name, in_render)
