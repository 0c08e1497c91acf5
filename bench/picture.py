# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Pictures of baked meshes: one ray a pixel, the colours interpolated between the vertices, the mesh's edges if wanted.

So a picture shows just what was baked, and needs no Blender.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from radiosity_bake.core.result import BakeResult
from radiosity_bake.core.scene import Floats, Ints
from radiosity_bake.core.visibility import RayScene

from tools.rooms import CAMERAS, Camera

# Rays along a pixel's side; their displayed colours are averaged.
RAYS_ALONG_PIXEL = 3

# Brightness of what is neither black nor the lamp, and the darkness and width in pixels of an edge.
MIDDLE_GREY = 0.35
EDGE_WIDTH = 0.9
EDGE_DARKNESS = 0.75

# Pixels of a triangle's lowest altitude below which its edges fade, so that far floors do not turn black.
FULL_ALTITUDE = 7.0

# Rays at once: 200 MB of working arrays.
RAYS_AT_ONCE = 1 << 18

BACKGROUND = 0.06

# From a little above, so that the furniture does not hide itself.
CAMERAS_OF_SCENES = {
    "paper_scene_1": CAMERAS["paper_scene_1"],
    "paper_scene_2": Camera((0.0, -5.2, 2.1), (0.0, 2.0, 1.35), 45.0, 36.0, 0.75),
    "paper_scene_3": Camera((0.0, -5.2, 2.1), (0.0, 2.0, 1.35), 45.0, 36.0, 0.75),
    "cornell_box": CAMERAS["cornell_box"],
    "cornell_box_hung": CAMERAS["cornell_box"],
}

Image = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Soup:
    """All baked triangles of a result.

    Attributes
    ----------
    corners : (t, 3, 3) float, m
    radiosity : (t, 3, 3) float, W m^-2 sr^-1
    """

    corners: Floats
    radiosity: Floats

    @staticmethod
    def of(result: BakeResult) -> Soup:
        """Gather the triangles of all meshes."""
        corners = [mesh.vertices[mesh.triangles] for mesh in result.meshes]
        return Soup(np.concatenate(corners), np.concatenate([mesh.radiosity for mesh in result.meshes]))


def camera_rays(camera: Camera, width: int) -> tuple[Floats, Floats, tuple[int, int]]:
    """Return the direction of each ray, what one pixel adds to it to the right and down, and the picture's shape.

    Returns
    -------
    directions : (h, w, 3) float
        Not of unit length; several for each pixel of the picture.
    steps : (2, 3) float
    shape : height and width in rays
    """
    forward = np.subtract(camera.target, camera.location)
    forward /= np.linalg.norm(forward)
    right = np.cross(forward, (0.0, 0.0, 1.0))
    right /= np.linalg.norm(right)
    down = np.cross(forward, right)
    columns = width * RAYS_ALONG_PIXEL
    rows = round(columns * camera.aspect / RAYS_ALONG_PIXEL) * RAYS_ALONG_PIXEL
    pixel = camera.sensor_width / camera.lens / columns
    x = (np.arange(columns) + 0.5 - columns / 2) * pixel
    y = (np.arange(rows) + 0.5 - rows / 2) * pixel
    directions = forward + x[None, :, None] * right + y[:, None, None] * down
    return directions, np.stack([right, down]) * pixel * RAYS_ALONG_PIXEL, (rows, columns)


def render(result: BakeResult, camera: Camera, width: int, edges: bool = False) -> Image:
    """Return the picture of a baked result: (h, width, 3) float, display colours 0..1."""
    soup = Soup.of(result)
    directions, steps, (rows, columns) = camera_rays(camera, width)
    flat = directions.reshape(-1, 3)
    eye = np.array(camera.location)
    triangle = first_triangles(soup, eye, flat)
    seen = np.flatnonzero(triangle >= 0)
    shown = np.full((len(flat), 3), BACKGROUND)
    light, line = np.empty((len(seen), 3)), np.zeros(len(seen))
    # From the eye, the corners of each triangle span a frame in which a direction's parts are barycentric coordinates.
    frames = np.linalg.pinv(np.swapaxes(soup.corners - eye, 1, 2))
    for first in range(0, len(seen), RAYS_AT_ONCE):
        part = slice(first, first + RAYS_AT_ONCE)
        frame, toward = frames[triangle[seen[part]]], flat[seen[part]]
        weights = barycentric(frame, toward)
        light[part] = np.einsum("nk,nkc->nc", weights, soup.radiosity[triangle[seen[part]]])
        if edges:
            change = np.hypot(*(barycentric(frame, toward + step) - weights for step in steps))
            altitudes = 1.0 / np.maximum(change, 1e-12)
            away, least = (np.abs(weights) * altitudes).min(axis=1), altitudes.min(axis=1)
            covered = np.clip((EDGE_WIDTH / 2 - away) * RAYS_ALONG_PIXEL + 0.5, 0.0, 1.0)
            line[part] = covered * np.minimum(least / FULL_ALTITUDE, 1.0)
    shown[seen] = displayed(light) * (1.0 - EDGE_DARKNESS * line[:, None])
    blocks = shown.reshape(rows // RAYS_ALONG_PIXEL, RAYS_ALONG_PIXEL, columns // RAYS_ALONG_PIXEL, RAYS_ALONG_PIXEL, 3)
    picture: Image = blocks.mean(axis=(1, 3))
    return picture


def first_triangles(soup: Soup, eye: Floats, directions: Floats) -> Ints:
    """Return the triangle that each ray from the eye meets, (n,); -1 for none."""
    scene = RayScene(soup.corners.reshape(-1, 3), np.arange(3 * len(soup.corners)).reshape(-1, 3))
    start = scene.local(eye[None])
    found = np.empty(len(directions), dtype=np.int64)
    for first in range(0, len(directions), RAYS_AT_ONCE):
        part = slice(first, first + RAYS_AT_ONCE)
        unit = directions[part] / np.linalg.norm(directions[part], axis=1, keepdims=True)
        found[part] = scene.first_hits(np.repeat(start, len(unit), axis=0), unit.astype(np.float32)).triangle
    return found


def barycentric(frames: Floats, directions: Floats) -> Floats:
    """Return the barycentric coordinates at which rays meet the planes of triangles: (n, 3) for frames (n, 3, 3)."""
    parts = np.einsum("nkx,nx->nk", frames, directions)
    weights: Floats = parts / parts.sum(axis=1, keepdims=True)
    return weights


def displayed(light: Floats) -> Floats:
    """Return radiance as display colours: exposed for its median, bright parts bent so that none burns out."""
    exposure = -np.log(1.0 - MIDDLE_GREY) / max(float(np.median(light.max(axis=1))), 1e-12)
    linear = 1.0 - np.exp(-exposure * np.maximum(light, 0.0))
    # The sRGB curve.
    return np.where(linear <= 0.0031308, 12.92 * linear, 1.055 * linear ** (1.0 / 2.4) - 0.055)


def side_by_side(pictures: Sequence[Image], captions: Sequence[str], path: Path) -> Path:
    """Write pictures of one height next to each other, a caption under each; returns the path."""
    from PIL import Image as Pillow
    from PIL import ImageDraw, ImageFont

    gap, foot = 8, 26
    height = max(picture.shape[0] for picture in pictures)
    width = sum(picture.shape[1] for picture in pictures) + gap * (len(pictures) - 1)
    sheet = Pillow.new("RGB", (width, height + foot), "white")
    draw, font = ImageDraw.Draw(sheet), ImageFont.load_default(15)
    left = 0
    for picture, caption in zip(pictures, captions, strict=True):
        pixels: Any = np.round(np.clip(picture, 0.0, 1.0) * 255.0).astype(np.uint8)
        sheet.paste(Pillow.fromarray(pixels), (left, 0))
        draw.text((left + picture.shape[1] / 2, height + foot / 2), caption, fill="black", font=font, anchor="mm")
        left += picture.shape[1] + gap
    path.parent.mkdir(parents=True, exist_ok=True)
    # Every colour is kept: a palette would take a third of the bytes, but show smooth walls in steps.
    sheet.save(path, optimize=True)
    return path
