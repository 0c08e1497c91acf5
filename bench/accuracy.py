# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""How far a baked surface is from the reference, defined once.

    relative RMS error = sqrt(mean over probes and channels of (E_baked - E_ref)^2) / (mean over both of E_ref)

with E the irradiance over pi in linear RGB, at area-uniform probes, emitters left out. Nothing is subtracted but the
reference's own noise: the mean of its squared standard error is taken off the mean square (`rms`); `rms_raw` keeps it.
"""

from __future__ import annotations

from dataclasses import asdict, dataclass
from typing import Any

import numpy as np
from radiosity_bake.core.result import BakedMesh, BakeResult
from radiosity_bake.core.scene import Floats, Ints, Scene

from .probes import Probes, faces_of
from .reference import Reference

LUMINANCE = np.array([0.2126, 0.7152, 0.0722])

# Pairs of probe and triangle looked at in one go: about 200 MB.
PAIRS_AT_ONCE = 4_000_000

# Slack of the boxes around output triangles, in barycentric coordinates of the input triangle.
SLACK = 1e-9

# Faces with fewer probes than this are put together as the mesh's rest: their means say little.
FEWEST_PROBES = 12


@dataclass(frozen=True)
class FaceError:
    """One flat face (or the rest of a mesh): how far its mean and its points are off.

    `bias` is (mean baked - mean reference) / mean reference of the face, over all channels; `bias_sigma` its one-sigma
    uncertainty from the reference's noise; `share` the face's part of the total squared error.
    """

    name: str
    probes: int
    mean_reference: float
    bias: float
    bias_sigma: float
    rms: float
    share: float


@dataclass(frozen=True)
class Accuracy:
    """Errors over all probes (see the module), and of every face.

    `lit_rms` is `rms` over the probes that any light reaches: without the floor that a block stands on, which is black
    and which nobody sees, so that the step at the block's foot does not count. `luminance_rms` is `rms` with both
    turned to luminance first; `bias` is that of the mean over everything; `p95` is the 95th percentile of the absolute
    error over the mean reference.
    """

    rms: float
    rms_raw: float
    lit_rms: float
    reference_noise: float
    luminance_rms: float
    bias: float
    p95: float
    probes: int
    faces: tuple[FaceError, ...]

    def as_json(self) -> dict[str, Any]:
        """Return what JSON can hold."""
        return asdict(self)


def containing_triangle(baked: BakedMesh, triangle: Ints, barycentric: Floats) -> tuple[Ints, Floats]:
    """Return the output triangle that each point lies in, and its barycentric coordinates there.

    Parameters
    ----------
    triangle : (n,) int
        Input triangles.
    barycentric : (n, 3) float
        Coordinates in them.

    Returns
    -------
    output : (n,) int
    weights : (n, 3) float
        Not negative, sum 1.

    Raises
    ------
    ValueError
        An input triangle with a point has no output triangle.
    """
    children = np.argsort(baked.parent_triangle, kind="stable")
    sorted_parents = baked.parent_triangle[children]
    output = np.full(len(triangle), -1)
    weights = np.zeros((len(triangle), 3))
    for parent in np.unique(triangle):
        start, stop = np.searchsorted(sorted_parents, [parent, parent + 1])
        if start == stop:
            raise ValueError(f"No output triangle lies in input triangle {parent} of mesh {baked.mesh}")
        own = children[start:stop]
        rows = np.flatnonzero(triangle == parent)
        step = max(1, PAIRS_AT_ONCE // len(own))
        for first in range(0, len(rows), step):
            some = rows[first : first + step]
            found, weight = _locate(baked.barycentric[own][:, :, 1:], barycentric[some, 1:])
            output[some], weights[some] = own[found], weight
    return output, weights


def _locate(corners: Floats, points: Floats) -> tuple[Ints, Floats]:
    """Return which plane triangle (c, 3, 2) holds each point (n, 2) best, and the point's coordinates in it."""
    low, high = corners.min(axis=1) - SLACK, corners.max(axis=1) + SLACK
    near = np.all((points[:, None] >= low) & (points[:, None] <= high), axis=2)
    lost = ~near.any(axis=1)
    near[lost] = True
    point, triangle = np.nonzero(near)
    c, p = corners[triangle], points[point]
    e1, e2, d = c[:, 1] - c[:, 0], c[:, 2] - c[:, 0], p - c[:, 0]
    determinant = e1[:, 0] * e2[:, 1] - e1[:, 1] * e2[:, 0]
    with np.errstate(divide="ignore", invalid="ignore"):
        u = (d[:, 0] * e2[:, 1] - d[:, 1] * e2[:, 0]) / determinant
        v = (e1[:, 0] * d[:, 1] - e1[:, 1] * d[:, 0]) / determinant
    weight = np.stack([1.0 - u - v, u, v], axis=1)
    inside = np.where(np.isfinite(weight).all(axis=1), weight.min(axis=1), -np.inf)
    order = np.lexsort((inside, point))
    last = np.append(np.flatnonzero(np.diff(point[order])), len(order) - 1)
    best = order[last]
    clipped = np.maximum(weight[best], 0.0)
    return triangle[best], clipped / clipped.sum(axis=1, keepdims=True)


def irradiance_at_probes(result: BakeResult, probes: Probes) -> Floats:
    """Return the baked irradiance over pi at the probes, interpolated linearly in the output triangles: (n, 3)."""
    values = np.full((len(probes), 3), np.nan)
    for baked in result.meshes:
        rows = np.flatnonzero(probes.mesh == baked.mesh)
        if len(rows):
            output, weights = containing_triangle(baked, probes.triangle[rows], probes.barycentric[rows])
            values[rows] = np.einsum("nk,nkc->nc", weights, baked.irradiance[output])
    return values


def face_names(scene: Scene, probes: Probes) -> list[str]:
    """Return the name of the face that each probe lies on: the mesh's, numbered where it has several."""
    names = np.empty(len(probes), dtype=object)
    for index in np.unique(probes.mesh):
        mesh = scene.meshes[index]
        rows = np.flatnonzero(probes.mesh == index)
        face = faces_of(mesh)[probes.triangle[rows]]
        several = len(np.unique(face)) > 1
        for number in np.unique(face):
            some = rows[face == number]
            rest = several and len(some) < FEWEST_PROBES
            names[some] = f"{mesh.name} rest" if rest else f"{mesh.name} {number}" if several else mesh.name
    return [str(name) for name in names]


def compare(scene: Scene, probes: Probes, values: Floats, reference: Reference) -> Accuracy:
    """Return the errors of values at probes against the reference.

    Parameters
    ----------
    values : (n, 3) float, W m^-2 sr^-1
        Irradiance over pi by the method that is judged.
    """
    truth, noise = reference.irradiance, reference.standard_error
    difference = values - truth
    squared, variance = difference**2, noise**2
    scale = float(truth.mean())
    names = np.array(face_names(scene, probes))
    faces = tuple(
        _face_error(name, difference[names == name], truth[names == name], variance[names == name], squared.sum())
        for name in dict.fromkeys(names.tolist())
    )
    lit = truth.max(axis=1) > 0.0
    luminance = (difference @ LUMINANCE) ** 2
    luminance_noise = variance @ LUMINANCE**2
    return Accuracy(
        rms=_root(squared.mean() - variance.mean()) / scale,
        rms_raw=_root(squared.mean()) / scale,
        lit_rms=_root(squared[lit].mean() - variance[lit].mean()) / float(truth[lit].mean()),
        reference_noise=reference.noise,
        luminance_rms=_root(luminance.mean() - luminance_noise.mean()) / float((truth @ LUMINANCE).mean()),
        bias=float(difference.mean()) / scale,
        p95=float(np.percentile(np.abs(difference), 95.0)) / scale,
        probes=len(probes),
        faces=faces,
    )


def _root(x: float) -> float:
    """Return the square root of a mean square that noise may have made negative."""
    return float(np.sqrt(max(float(x), 0.0)))


def _face_error(name: str, difference: Floats, truth: Floats, variance: Floats, total: float) -> FaceError:
    """Return the errors of one face from its probes' rows."""
    mean = float(truth.mean())
    scale = mean if mean > 0.0 else 1.0
    return FaceError(
        name=name,
        probes=len(difference),
        mean_reference=mean,
        bias=float(difference.mean()) / scale,
        bias_sigma=_root(variance.sum()) / variance.size / scale,
        rms=_root((difference**2).mean() - variance.mean()) / scale,
        share=float((difference**2).sum() / total) if total > 0.0 else 0.0,
    )


def table_of_faces(accuracy: Accuracy) -> str:
    """Return the faces as text, those with the largest part of the squared error first."""
    lines = [f"{'face':<22}{'probes':>7}{'mean ref':>10}{'bias':>9}{'+-':>7}{'rms':>8}{'share':>8}"]
    lines += [
        f"{f.name:<22}{f.probes:>7}{f.mean_reference:>10.4f}{f.bias:>9.2%}{f.bias_sigma:>7.2%}{f.rms:>8.2%}{f.share:>8.1%}"
        for f in sorted(accuracy.faces, key=lambda f: -f.share)
    ]
    return "\n".join(lines)
