# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""What a bake hands back."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from .scene import Floats, Ints

if TYPE_CHECKING:
    from .kept_rays import KeptRays
    from .relight import KeptTransport, NotKept


@dataclass(frozen=True, eq=False)
class GroupLight:
    """The baked values of one light group on one mesh.

    Attributes
    ----------
    name : str
        Empty for the light of no group.
    radiosity, irradiance : (s, 3, 3) float, W m^-2 sr^-1
    radiosity_back, irradiance_back : (s, 3, 3) float or None
        As of `BakedMesh`, of this light alone.
    """

    name: str
    radiosity: Floats
    irradiance: Floats
    radiosity_back: Floats | None = None
    irradiance_back: Floats | None = None


@dataclass(frozen=True, eq=False)
class BakedMesh:
    """The baked values of one mesh, for each corner of its output triangles.

    With `output='ORIGINAL'` the triangles are the input's own, in the same order. With `'REFINED'` they are the
    conforming subdivision: `vertices[:v]` are the input's vertices, and every output triangle lies in one of the
    input's; triangles without area are left out.

    Attributes
    ----------
    mesh : int
        Index into `Scene.meshes`.
    vertices : (w, 3) float, scene units
    triangles : (s, 3) int
    parent_triangle : (s,) int
        The input triangle that each output triangle lies in (material, polygon).
    barycentric : (s, 3, 3) float
        Barycentric coordinates of each output corner in its parent triangle: whatever was stored for the input's
        corners can be carried over by these weights.
    corner_normals : (s, 3, 3) float, unit
        Shading normal of each output corner, interpolated from the input's.
    radiosity, irradiance : (s, 3, 3) float, W m^-2 sr^-1
        Outgoing radiance L and irradiance over pi, linear RGB, of the front side.
    radiosity_back, irradiance_back : (s, 3, 3) float or None
        The same for the back side, where light reaches it; None where it is unlit or the inside of a solid.
    groups : tuple of GroupLight
        The same light by light groups, where it was asked for; they sum up to the values above.
    """

    mesh: int
    vertices: Floats
    triangles: Ints
    parent_triangle: Ints
    barycentric: Floats
    corner_normals: Floats
    radiosity: Floats
    irradiance: Floats
    radiosity_back: Floats | None = None
    irradiance_back: Floats | None = None
    groups: tuple[GroupLight, ...] = ()


@dataclass(frozen=True, eq=False)
class BakeResult:
    """All baked meshes and the report.

    `report` holds only what JSON can: `relit` (whether `relight` made it), `patches`, `vertices`, `triangles`, `rays`
    (total), `rays_known` (not traced: those of another bake had met what they meet), `rays_by_kind` (`walks` that find
    the lit sides, `form_factors`, `patches` for covers and direct light, `gather`), `seconds` (by stage, with `total`),
    `seconds_in_ray_library` (summed over `threads`), `iterations`, `residual`, `converged`, `estimated_error` (relative
    RMS), `form_factor_standard_error` (of a form factor as large as the threshold, in the median), `energy` (`emitted`,
    `from_world`, `from_lamps`, `reflected`, `absorbed`, `escaped` in W, and `imbalance`), `minimum_size`,
    `minimum_face_size` (None where faces are not split), `rounds` (a list, one entry a refinement round), `ended` (why
    refinement ended), `settings` and `warnings` (sentences).

    `kept` is what `relight` needs, or why it is not there; None where it was not asked for. `kept_rays` is what the
    bake of the next frame takes; None where it was not asked for, or would take more than its share of the memory.
    """

    meshes: tuple[BakedMesh, ...]
    report: dict[str, Any]
    kept: KeptTransport | NotKept | None = None
    kept_rays: KeptRays | None = None
