# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The scene as `core` takes it: everything that renders, as plain arrays in world space, copied out of Blender."""

from collections.abc import Iterable
from dataclasses import dataclass

import bpy
import numpy as np

from ..core.errors import NothingToBakeError
from ..core.scene import Scene
from .drivers import failing_drivers
from .missing_links import missing_links
from .participants import shown_as_rendered
from .places import Outputs, outputs_by_source, same_place, shows_place, sources_in_place, sources_shown
from .record import HIDDEN_SOURCE
from .scene_reader import SceneReader
from .targets import Target
from .wanted import Reason, nothing_to_bake, skip_missing, skipped_sentences, wanted_objects
from .world import rendered_world, world_light


@dataclass(frozen=True, eq=False)
class Extraction:
    """What was read from Blender: the scene for `core`, where to write its values, and what was skipped.

    Attributes
    ----------
    scene : Scene
    targets : tuple of Target
    warnings : tuple of str
    evaluated : tuple of str
        Materials that Blender evaluated, and the nodes that made it.
    scene_uid : int
        `session_uid` of the Blender scene.
    view_layer : str
        Name of the view layer that was read.
    """

    scene: Scene
    targets: tuple[Target, ...]
    warnings: tuple[str, ...]
    evaluated: tuple[str, ...]
    scene_uid: int
    view_layer: str


# What is no number in a file goes on to the core, which names it; numpy has nothing to add on the console.
@np.errstate(all="ignore")
def extract(context: bpy.types.Context, objects: Iterable[bpy.types.Object], output: str = "REFINED") -> Extraction:
    """Read everything that renders, with `objects` marked to be baked.

    A refined object from an earlier bake means its original. Nothing of the file is changed.

    Parameters
    ----------
    output : str
        `'REFINED'` bakes all that the objects show, instances as well; `'ORIGINAL'` their own meshes alone.

    Raises
    ------
    NothingToBakeError
        When none of `objects` has faces that render and can be baked.
    """
    warnings = missing_links()
    skipped: dict[Reason, list[str]] = {}
    wanted = wanted_objects(context.scene, objects, output, skipped)
    outputs = outputs_by_source()
    view_layer = context.view_layer
    with sources_shown(outputs), shown_as_rendered(context) as (depsgraph, participants):
        reader = SceneReader(depsgraph, participants, set(wanted), outputs, output)
        with sources_in_place(outputs, view_layer):
            reader.read()
        warnings += _misplaced(reader.targets, outputs, view_layer)
        warnings += _orphaned(participants.objects.difference(wanted), outputs)
        world = rendered_world(view_layer)
        warnings += failing_drivers(participants.everything(), (context.scene, world))
    targets = tuple(reader.targets)
    skip_missing(wanted, reader, skipped)
    if not targets:
        raise NothingToBakeError(nothing_to_bake(skipped))
    warnings += skipped_sentences(skipped)
    sky = world_light(world if view_layer.use_sky else None, context.scene.frame_current)
    warnings += reader.warnings()
    warnings += [f'World "{world.name}": {note}' for note in sky.notes]
    return Extraction(
        Scene(
            tuple(reader.meshes),
            sky.radiance,
            (*reader.lamps, *sky.suns),
            reader.light_groups(world, len(sky.suns)),
        ),
        targets,
        tuple(warnings),
        tuple(reader.evaluated()),
        context.scene.session_uid,
        view_layer.name,
    )


def _misplaced(targets: list[Target], outputs: Outputs, view_layer: bpy.types.ViewLayer) -> list[str]:
    """Return a sentence for each object whose refined object was moved to where it cannot go."""
    sentences = []
    shown = {output.radiosity.source.session_uid: output for (output, *others) in outputs.values() if not others}
    for target in targets:
        output = shown.get(target.uid)
        if output is None or not shows_place(output) or not output.visible_get(view_layer=view_layer):
            continue
        if not same_place(output.matrix_world, target.matrix):
            what = "its own file puts it" if output.radiosity.source.library else "its animation or constraints put it"
            sentences.append(
                f'"{output.name}" was moved, but "{target.name}" is where {what}; '
                "it was baked there. Move the original instead"
            )
    return sentences


def _orphaned(objects: Iterable[bpy.types.Object], outputs: Outputs) -> list[str]:
    """Return a sentence for each original that shapes the light unseen, as what stood for it was deleted."""
    return [
        f'"{obj.name}" takes part in the light though its refined object was deleted; '
        "Restore shows it again, then delete it if it shall be gone"
        for obj in sorted(objects, key=lambda obj: obj.name_full)
        if obj.radiosity.kind == HIDDEN_SOURCE and obj not in outputs
    ]
