# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Whether anything can see the backs of emitting meshes, which Mitsuba would otherwise sample in vain."""

from __future__ import annotations

import numpy as np
from radiosity_bake.core.scene import Scene, SurfaceMesh


def back_can_be_seen(scene: Scene, index: int) -> bool:
    """Return whether light from the back of an emitting mesh could reach anything else.

    Not for a closed mesh with its front outward that has nothing within its bounds (a lamp), nor for one with its front
    inward that holds everything (a room), nor for a flat one that has nothing behind its planes (a panel in a ceiling);
    `True` where in doubt.
    """
    mesh = scene.meshes[index]
    low, high = mesh.vertices.min(axis=0), mesh.vertices.max(axis=0)
    others = [m for k, m in enumerate(scene.meshes) if k != index]
    if is_closed(mesh.triangles):
        if not is_outward(mesh):
            return any(np.any((m.vertices < low) | (m.vertices > high)) for m in others)
        # Boxes of triangles, so that a large one that passes through is not missed.
        boxes = [m.vertices[m.triangles] for m in others]
        return any(
            bool(np.any(np.all((t.min(axis=1) < high) & (t.max(axis=1) > low), axis=1))) for t in boxes if len(t)
        )
    corners = mesh.vertices[mesh.triangles[np.any(mesh.emission > 0.0, axis=1)]]
    if len(corners) > 16:
        return True
    everything = np.concatenate([m.vertices for m in scene.meshes])
    slack = 1e-6 * float(np.ptp(everything, axis=0).max())
    for a, b, c in corners:
        normal = np.cross(b - a, c - a)
        length = np.linalg.norm(normal)
        if length > 0.0 and np.any((everything - a) @ normal < -slack * length):
            return True
    return False


def is_outward(mesh: SurfaceMesh) -> bool:
    """Return whether a closed mesh encloses a positive volume."""
    a, b, c = (mesh.vertices[mesh.triangles[:, k]] - mesh.vertices.mean(axis=0) for k in range(3))
    return float(np.einsum("ij,ij->i", a, np.cross(b, c)).sum()) > 0.0


def is_closed(triangles: np.ndarray) -> bool:
    """Return whether every edge is used once in each direction."""
    edges = triangles[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2)
    forward, counts = np.unique(edges, axis=0, return_counts=True)
    backward = np.unique(edges[:, ::-1], axis=0)
    return bool(np.all(counts == 1)) and len(forward) == len(backward) and bool(np.array_equal(forward, backward))
