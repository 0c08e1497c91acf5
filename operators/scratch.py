# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""A scene of its own in which Cycles evaluates something for us, and of which nothing is left afterwards."""

from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

import bpy

from ..core.errors import BakeError


class NoCyclesError(BakeError):
    """Cycles, which would evaluate nodes, is switched off."""


@contextmanager
def scratch_scene(samples: int = 1) -> Iterator[bpy.types.Scene]:
    """Give a scene to bake in with `bake_in`, and remove it with everything that was made meanwhile.

    The open scene, its selection and its Render Result stay as they are, and no undo step is made. Datablocks of the
    file may be used, as a material or a world is; none is removed, and no other must be changed.

    Parameters
    ----------
    samples : int
        Of Cycles, for each place that is baked.

    Raises
    ------
    NoCyclesError
        When Cycles is switched off in the preferences.

    Examples
    --------
    >>> with scratch_scene() as scene:
    ...     scene.collection.objects.link(obj)
    ...     bake_in(scene, obj, type="EMIT", target="VERTEX_COLORS")
    """
    if not hasattr(bpy.types.Scene, "cycles"):
        raise NoCyclesError("Turn on Cycles Render Engine in Preferences > Add-ons: it evaluates nodes for the bake")
    before = {block.session_uid for block in _datablocks()}
    try:
        scene = bpy.data.scenes.new("Radiosity Scratch")
        _make_plain(scene, samples)
        yield scene
    finally:
        made = [block for block in _datablocks() if block.session_uid not in before]
        # Scenes first, as they hold on to the rest.
        for block in made:
            if isinstance(block, bpy.types.Scene):
                bpy.data.scenes.remove(block)
        bpy.data.batch_remove([block for block in _datablocks() if block.session_uid not in before])


def bake_in(scene: bpy.types.Scene, obj: bpy.types.Object, **options: Any) -> None:
    """Bake one object of a scratch scene with `bpy.ops.object.bake`, whose options these are.

    Parameters
    ----------
    obj : Object
        A mesh that is linked to the scene. Its active colour attribute, or the active image node of each of its
        materials, takes what is baked.

    Raises
    ------
    RuntimeError
        With Blender's own sentence.
    """
    layer = scene.view_layers[0]
    # A selection in the scene too, as Blender asks once the one, once the other.
    for other in layer.objects:
        other.select_set(other == obj, view_layer=layer)
    layer.objects.active = obj
    with bpy.context.temp_override(
        scene=scene,
        view_layer=layer,
        active_object=obj,
        object=obj,
        selected_objects=[obj],
        selected_editable_objects=[obj],
    ):
        bpy.ops.object.bake("EXEC_DEFAULT", **options)


def _make_plain(scene: bpy.types.Scene, samples: int) -> None:
    """Have Cycles give plain numbers on every machine: on the processor, without clamping, denoising or a view."""
    scene.render.engine = "CYCLES"
    scene.view_settings.view_transform = "Standard"
    for name, value in {
        "device": "CPU",
        "samples": samples,
        "use_adaptive_sampling": False,
        "use_denoising": False,
        "sample_clamp_direct": 0.0,
        "sample_clamp_indirect": 0.0,
        "light_sampling_threshold": 0.0,
    }.items():
        setattr(scene.cycles, name, value)


def _datablocks() -> Iterator[bpy.types.ID]:
    """Every datablock of the file."""
    # Other collections than those of datablocks are there too, as that of all datablocks in newer versions.
    for name in dir(bpy.data):
        blocks = getattr(bpy.data, name)
        if isinstance(blocks, bpy.types.bpy_prop_collection) and name != "all_ids":
            yield from (block for block in blocks if isinstance(block, bpy.types.ID))
