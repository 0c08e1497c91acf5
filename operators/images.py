# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Images as Cycles sees them: in the colours of the scene, and transparent where they are."""

from collections.abc import Iterator

import bpy
import numpy as np
from mathutils import Color

from ..core.sampling import Singles
from ..core.textures import Image, halved, image_of

MOST_PIXELS = 2048
"""Along an edge: larger images are made smaller, which the cells of a mesh are finer than in no scene."""

MOST_SMOOTHED = 512
"""Along an edge: of larger images, what lies between two pixels is taken for the mean of their light."""

MOST_DIVIDED = 128
"""Along an edge: smaller images may be seen magnified, so what lies between two pixels is kept in steps."""

_AS_THEY_ARE = {"Non-Color", "Raw", "Generic Data"}


class UnreadableImageError(Exception):
    """An image that Blender has to evaluate itself; the text says what it is."""


def read_image(image: bpy.types.Image, extension: str, closest: bool, alpha_used: bool) -> Image:
    """Return the pixels of an image, linear RGBA in the colours of the scene, as Cycles makes them.

    Parameters
    ----------
    extension : str
        Of the texture node.
    closest : bool
        Whether pixels are shown with sharp edges.
    alpha_used : bool
        Whether the node's Alpha is linked, too: Cycles multiplies the colour by it otherwise.

    Raises
    ------
    UnreadableImageError
    """
    if image.source not in {"FILE", "GENERATED"}:
        raise UnreadableImageError(f'"{image.name}" is a {image.source.lower()}')
    width, height = image.size
    if not (width and height and image.channels):
        raise UnreadableImageError(f'"{image.name}" has no pixels')
    by_file = image.source == "FILE" and image.packed_file is None and image.channels == 4
    if by_file and image.alpha_mode == ("STRAIGHT" if image.is_float else "PREMUL"):
        # Cycles goes by the kind of file, Blender by the setting, and has changed the pixels.
        raise UnreadableImageError(f'the alpha of "{image.name}" is not of the kind that its file has')
    flat = np.empty(width * height * image.channels, dtype=np.float32)
    image.pixels.foreach_get(flat)
    pixels = _with_four_channels(flat.reshape(height, width, image.channels))
    plain = image.colorspace_settings.is_data or image.colorspace_settings.name in _AS_THEY_ARE
    if image.alpha_mode == "NONE":
        pixels[..., 3] = 1.0
    elif image.alpha_mode != "CHANNEL_PACKED":
        # Blender has bytes without the alpha in them, and floats with it.
        if image.is_float and alpha_used and not plain:
            pixels[..., :3] /= np.where(pixels[..., 3:] == 0.0, 1.0, pixels[..., 3:])
        elif not image.is_float and (plain or not alpha_used):
            pixels[..., :3] *= pixels[..., 3:]
    if not (image.is_float or plain):
        if image.colorspace_settings.name != "sRGB":
            raise UnreadableImageError(f'"{image.name}" is in the colour space {image.colorspace_settings.name}')
        # What fades out at the border of a clipped image fades over half of its own pixels.
        most_divided = MOST_DIVIDED if extension != "CLIP" else 0
        if not closest and max(width, height) <= most_divided:
            pixels = _divided(pixels, extension == "REPEAT")
        if closest or not most_divided < max(width, height) <= MOST_SMOOTHED:
            pixels[..., :3] = _from_srgb(pixels[..., :3])
        else:
            pixels[..., :3] = _averaged_from_srgb(pixels[..., :3], extension == "REPEAT")
    while max(pixels.shape[:2]) > MOST_PIXELS:
        pixels = halved(pixels)
    return image_of(pixels, extension, closest)


def _with_four_channels(pixels: Singles) -> Singles:
    channels = pixels.shape[2]
    if channels == 4:
        return pixels
    opaque = np.ones((*pixels.shape[:2], 4), dtype=np.float32)
    opaque[..., :3] = pixels[..., :3] if channels == 3 else pixels[..., :1]
    if channels == 2:
        opaque[..., 3] = pixels[..., 1]
    return opaque


def _averaged_from_srgb(pixels: Singles, repeated: bool) -> Singles:
    """Return the mean light over each pixel of an sRGB image, by sixteen places in it.

    Cycles passes from pixel to pixel in sRGB, where the way between black and white is darker than their mean.
    """
    light = np.zeros_like(pixels)
    for line in _between(pixels, 1, repeated):
        for place in _between(line, 0, repeated):
            light += _from_srgb(place)
    return light / 16.0


def _divided(pixels: Singles, repeated: bool) -> Singles:
    """Return an image with four pixels in place of each along both axes, as it is seen magnified."""
    for axis in (0, 1):
        parts = np.stack(list(_between(pixels, axis, repeated)), axis=axis + 1)
        shape = list(pixels.shape)
        shape[axis] *= parts.shape[axis + 1]
        pixels = parts.reshape(shape)
    return pixels


def _between(pixels: Singles, axis: int, repeated: bool) -> Iterator[Singles]:
    """Give what lies 3/8 and 1/8 of a pixel to both sides of the middles of all, along one axis and in its order."""
    for way, share in ((1, 0.375), (1, 0.125), (-1, 0.125), (-1, 0.375)):
        neighbour = np.roll(pixels, way, axis=axis)
        if not repeated:
            border = (slice(None),) * axis + (0 if way == 1 else -1,)
            neighbour[border] = pixels[border]
        yield (1.0 - share) * pixels + share * neighbour


def _from_srgb(pixels: Singles) -> Singles:
    """Return sRGB colours in the scene's own linear space, by Blender's colour management."""
    grey = np.array([Color((k / 255.0,) * 3).from_srgb_to_scene_linear() for k in range(256)], dtype=np.float64)
    primaries = np.array([Color(axis).from_srgb_to_scene_linear() for axis in np.eye(3)], dtype=np.float64)
    linear = np.interp(pixels.reshape(-1), np.arange(256) / 255.0, grey.mean(axis=1)).astype(np.float32)
    linear = linear.reshape(-1, 3)
    if not np.allclose(primaries, np.eye(3), atol=1e-4):
        linear = linear @ primaries.astype(np.float32)
    return linear.reshape(pixels.shape)
