# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""What Blender's world means for radiosity: one colour where it has one, else what Cycles makes of its nodes."""

from collections.abc import Iterable
from dataclasses import dataclass, replace

import bpy
import numpy as np

from ..core.errors import BakeError
from ..core.scene import Floats, SunLamp
from ..core.world import WHOLE_FACES, SkyCube, SkySamples, split_sky, window_corners
from .light_paths import as_diffuse_rays_see
from .materials import constant_emission, uses_nodes
from .node_links import all_trees, own_trees
from .scratch import bake_in, scratch_scene

FACE, LARGEST_FACE = 256, 1024
"""Texels along an edge of a cube around the viewer: a third of a degree, in which the disc of a sky's sun cannot hide;
more where an image has more."""

ZOOMED = 224
"""Texels along the edge of a window that is looked at closer: an eightieth of a degree; 1,500 lie in the sun."""

EVEN = 1e-4
"""Relative deviation up to which a world counts as one of a single colour."""

SMALLEST_SUN = np.radians(0.5)
"""The disc of a Sky Texture is made no smaller, or it might be missed: its light is the same."""


@dataclass(frozen=True, eq=False)
class WorldLight:
    """What the world sends.

    Attributes
    ----------
    radiance : (3,) float or a map of `core.world`, W m^-2 sr^-1
    suns : tuple of SunLamp
        What is too bright and too small for the map.
    notes : tuple of str
        What was skipped or guessed, each a clause to follow the world's name and a colon.
    """

    radiance: Floats
    suns: tuple[SunLamp, ...] = ()
    notes: tuple[str, ...] = ()


def rendered_world(view_layer: bpy.types.ViewLayer) -> bpy.types.World | None:
    """Return the world that a view layer renders: from Blender 5 on it may have one of its own."""
    return getattr(view_layer, "world_override", None) or view_layer.id_data.world


def world_light(world: bpy.types.World | None, frame: int = 1) -> WorldLight:
    """Return the light of a world; nothing of the file is changed.

    Parameters
    ----------
    frame : int
        For image sequences.
    """
    if world is None or not _visible_to_diffuse_rays(world):
        return WorldLight(np.zeros(3))
    if not uses_nodes(world):
        return WorldLight(np.array(world.color[:3], dtype=np.float64))
    colour, unread = constant_emission(world)
    fog = ("its volume is left out",) if _has_volume(world) else ()
    if not unread:
        return WorldLight(colour, (), fog)
    try:
        sky = evaluated(world, frame)
    except (BakeError, RuntimeError) as error:
        why = str(error).removeprefix("Error: ").strip().rstrip(".")
        return WorldLight(np.zeros(3), (), (*fog, f"its nodes could not be evaluated ({why}); it was left dark"))
    notes = fog
    if sky.radiance.min() < 0.0:
        notes = (*fog, "its emission is negative in places; it was taken for zero there")
        sky = replace(sky, radiance=np.maximum(sky.radiance, 0.0))
    mean = sky.solid_angles @ sky.radiance / sky.solid_angles.sum()
    if np.abs(sky.radiance - mean).max() <= EVEN * mean.max():
        return WorldLight(mean, (), notes)
    return WorldLight(*split_sky(sky, world.name), notes)


def _visible_to_diffuse_rays(world: bpy.types.World) -> bool:
    visibility = getattr(world, "cycles_visibility", None)
    return visibility is None or bool(visibility.diffuse)


def _has_volume(world: bpy.types.World) -> bool:
    output = world.node_tree.get_output_node("CYCLES")
    return output is not None and output.inputs["Volume"].is_linked


def evaluated(world: bpy.types.World, frame: int = 1) -> SkySamples:
    """Return the radiance of a world in all directions, finer where it is bright and small.

    Raises
    ------
    NoCyclesError
    RuntimeError
        When Blender cannot bake.
    """
    with scratch_scene() as scene:
        scene.frame_current = frame
        scene.world = world.copy()
        # No map to sample it by is needed.
        scene.world.cycles.sampling_method = "NONE"
        trees = list(own_trees(scene.world.node_tree))
        _with_suns_of_some_size(trees)
        as_diffuse_rays_see(trees)
        size = _face_size(scene.world.node_tree)
        cube = SkyCube(_baked(scene, WHOLE_FACES, size))
        windows = cube.bright_windows()
        near = _baked(scene, windows, ZOOMED) if len(windows) else np.zeros((0, ZOOMED, ZOOMED, 3))
    return cube.with_windows(windows, near)


def _with_suns_of_some_size(trees: Iterable[bpy.types.NodeTree]) -> None:
    """Widen the suns of sky textures in copied trees to what is not missed."""
    for tree in trees:
        for node in tree.nodes:
            if node.type == "TEX_SKY" and getattr(node, "sun_disc", False):
                node.sun_size = max(node.sun_size, SMALLEST_SUN)


def _face_size(tree: bpy.types.NodeTree) -> int:
    """Return how many texels a face of the cube needs for the images of a tree: as fine as theirs, within reason."""
    images = [
        node.image.size[0]
        for part in all_trees(tree)
        for node in part.nodes
        if node.type in {"TEX_ENVIRONMENT", "TEX_IMAGE"} and node.image is not None
    ]
    size = FACE
    while size < LARGEST_FACE and 4 * size < max(images, default=0):
        size *= 2
    return size


def _baked(scene: bpy.types.Scene, windows: Floats, texels: int) -> Floats:
    """Return what windows of the cube show, (k, texels, texels, 3): a square each, side by side in one image."""
    count = len(windows)
    across = int(np.ceil(np.sqrt(count)))
    down = -(-count // across)
    image = bpy.data.images.new("Radiosity Scratch", across * texels, down * texels, float_buffer=True, is_data=True)
    mesh = bpy.data.meshes.new("Radiosity Scratch")
    mesh.from_pydata(window_corners(windows).reshape(-1, 3).tolist(), [], np.arange(4 * count).reshape(-1, 4).tolist())
    place = np.stack([np.arange(count) % across, np.arange(count) // across], axis=1)
    corners = (place[:, None] + [(0, 0), (1, 0), (1, 1), (0, 1)]) / [across, down]
    mesh.uv_layers.new().data.foreach_set("uv", corners.astype(np.float32).ravel())
    material = bpy.data.materials.new("Radiosity Scratch")
    if not uses_nodes(material):
        material.use_nodes = True
    node = material.node_tree.nodes.new("ShaderNodeTexImage")
    node.image = image
    material.node_tree.nodes.active = node
    mesh.materials.append(material)
    obj = bpy.data.objects.new("Radiosity Scratch", mesh)
    scene.collection.objects.link(obj)
    bake_in(scene, obj, type="ENVIRONMENT", target="IMAGE_TEXTURES", margin=0, use_clear=True)
    pixels = np.empty(4 * across * down * texels**2, dtype=np.float32)
    image.pixels.foreach_get(pixels)
    scene.collection.objects.unlink(obj)
    tiles = pixels.reshape(down, texels, across, texels, 4)[..., :3].transpose(0, 2, 1, 3, 4)
    return np.nan_to_num(tiles.reshape(-1, texels, texels, 3)[:count], posinf=0.0, neginf=0.0)
