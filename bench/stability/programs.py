# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""What each program says of the cases of a sweep."""

from __future__ import annotations

import json
import resource
import subprocess
import sys
import tempfile
from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
from radiosity_bake.core.bake import bake
from radiosity_bake.core.errors import BakeError
from radiosity_bake.core.result import BakedMesh
from radiosity_bake.core.scene import Floats, SurfaceMesh, surface_mesh
from radiosity_bake.core.settings import BakeSettings

from tests.core.building import mean_over
from tools.package import ROOT

from .. import form_factors
from .cases import CYCLES, OURS, PYVIEWFACTOR, RAYSTRACK, ROWS, Case, Sweep

# Of ours by rows, and of raystrack.
RAYS = 4**9

# Triangles are split into four so many times for pyViewFactor; its pairs do not get better by it.
LEVEL = 1

# Seconds of processor time and bytes that raystrack and pyViewFactor have for a case.
PATIENCE = 60
MOST_MEMORY = 6 * 2**30

# Of Cycles at each vertex, and the most bounces that it has.
SAMPLES = 1024
BOUNCES = 1024

# Gauss nodes along each edge of the receiver, at which Cycles bakes: a vertex each. In rooms, vertices along an edge.
NODES = 16
ALONG_WALL = 17

Found = dict[str, Any]
"""`said`, in the unit of the truth, or `failed`, a sentence."""


def answers(sweep: Sweep, cases: Sequence[Case], programs: Sequence[str]) -> dict[str, list[Found]]:
    """Return what each program says of the cases of a sweep."""
    found: dict[str, list[Found]] = {}
    if OURS in programs:
        found[OURS] = [attempted(lambda case=case: baked(sweep, case)) for case in cases]
    if ROWS in programs:
        found[ROWS] = [attempted(lambda case=case: counted(case)) for case in cases]
    if CYCLES in programs:
        found[CYCLES] = [attempted(lambda case=case: baked_by_cycles(sweep, case)) for case in cases]
    wanted = [name for name in (RAYSTRACK, PYVIEWFACTOR) if name in programs]
    python = form_factors.peer_python()
    if wanted and python is not None:
        found |= {name: [by_form_factor_program(name, case, python) for case in cases] for name in wanted}
    return found


def attempted(run: Callable[[], Found]) -> Found:
    """Return what `run` returns, or how it failed."""
    try:
        return run()
    except (BakeError, ArithmeticError, ValueError, subprocess.SubprocessError) as error:
        return {"failed": f"{type(error).__name__}: {str(error).splitlines()[0][:200]}"}


# ---------------------------------------------------------------------------------------------------------------- ours


def baked(sweep: Sweep, case: Case, quality: str = "GOOD") -> Found:
    """Return what our bake says."""
    result = bake(case.scene, BakeSettings(quality=quality, keep_transport=False))
    mesh = result.meshes[case.receiver]
    report = {key: result.report[key] for key in ("vertices", "patches", "rays", "estimated_error", "warnings")}
    return {"said": light_of(sweep, mesh, result.meshes[case.emitter]), **report}


def light_of(sweep: Sweep, mesh: BakedMesh, bright: BakedMesh) -> float:
    """Return the mean of a receiver, and where there should be none, relative to that of the bright side."""
    light = float(mean_over([mesh])[0])
    return light if sweep.kind == "mean" else light / float(mean_over([bright])[0])


def counted(case: Case, rays: int = RAYS) -> Found:
    """Return the form factor by the rays of the patches of the receiver."""
    scene, _ = form_factors.reflecting((case.scene, {}))
    given = form_factors.Case("", scene, case.receiver, case.emitter, case.truth, "")
    factor, traced = form_factors.traced_factor(given, rays, 0)
    return {"said": factor, "rays": traced}


# --------------------------------------------------------------------------------------------------------------- peers


def by_form_factor_program(name: str, case: Case, python: str) -> Found:
    """Return what raystrack or pyViewFactor says of a case, from a process of its own, with limits.

    Rays go from the smaller of the two surfaces, where few would be lost; reciprocity turns the factor round.
    """
    areas = [total_area(case.scene.meshes[k]) for k in (case.receiver, case.emitter)]
    backward = areas[1] < areas[0]
    sender, receiver = (case.emitter, case.receiver) if backward else (case.receiver, case.emitter)
    arrays = form_factors.case_arrays(form_factors.Case("", case.scene, sender, receiver, case.truth, ""))
    levels = arrays["levels"]
    arrays |= {"rays": np.array([RAYS]), "seeds": np.array([0]), "levels": levels[levels <= LEVEL][-1:]}
    script = Path(form_factors.__file__).with_name("form_factor_programs.py")
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "case.npz"
        np.savez(path, **arrays)
        command = [python, str(script), name, str(path)]
        done = subprocess.run(command, capture_output=True, text=True, check=False, preexec_fn=limit_itself)
    if done.returncode < 0:
        return {"failed": f"no answer in {PATIENCE} s of processor time"}
    if done.returncode != 0:
        told = done.stderr.strip().splitlines()
        return {"failed": told[-1][:200] if told else "no answer"}
    return {"said": json.loads(done.stdout)[-1]["factors"][0] * (areas[1] / areas[0] if backward else 1.0)}


def limit_itself() -> None:
    """Let this process have so much time and memory: a program that asks for all ends others with it."""
    resource.setrlimit(resource.RLIMIT_CPU, (PATIENCE, PATIENCE))
    resource.setrlimit(resource.RLIMIT_AS, (MOST_MEMORY, MOST_MEMORY))


def total_area(mesh: SurfaceMesh) -> float:
    """Return the area of a mesh."""
    a, b, c = (mesh.vertices[mesh.triangles[:, k]] for k in range(3))
    return float(np.linalg.norm(np.cross(b - a, c - a), axis=1).sum() / 2.0)


# -------------------------------------------------------------------------------------------------------------- Cycles


def baked_by_cycles(sweep: Sweep, case: Case) -> Found:
    """Return what Cycles' vertex bake says: its mean over Gauss nodes, or over the vertices of a room."""
    meshes = list(case.scene.meshes)
    weights = None
    if case.place is not None:
        meshes[case.receiver], weights = at_nodes(case)
    else:
        meshes = [divided(mesh) for mesh in meshes]
    asked = sorted({case.receiver, case.emitter} if weights is None else {case.receiver})
    arrays: dict[str, np.ndarray] = {"samples": np.array(SAMPLES), "bounces": np.array(BOUNCES), "world": np.zeros(3)}
    for k, mesh in enumerate(meshes):
        arrays |= {
            f"vertices_{k}": mesh.vertices,
            f"triangles_{k}": mesh.triangles,
            f"reflectance_{k}": mesh.reflectance,
            f"emission_{k}": mesh.emission,
            f"baked_{k}": np.array(k in asked),
            f"smooth_{k}": np.array(False),
        }
    with tempfile.TemporaryDirectory() as folder:
        given, answered = Path(folder) / "scene.npz", Path(folder) / "baked.npz"
        np.savez(given, **arrays)
        script = Path(form_factors.__file__).with_name("cycles_bake.py")
        command = [sys.executable, str(script), str(given), str(answered)]
        subprocess.run(command, cwd=ROOT, check=True, capture_output=True)
        with np.load(answered) as found:
            light = {k: found[f"irradiance_{k}"][:, 0] for k in asked}
    own = light[case.receiver]
    if weights is not None:
        return {"said": float(weights @ own)}
    inner = inner_vertices(meshes[case.receiver])
    if sweep.kind == "mean":
        return {"said": float(own[inner].mean())}
    other = light[case.emitter][inner_vertices(meshes[case.emitter])]
    return {"said": float(own[inner].mean() / other.mean())}


def at_nodes(case: Case) -> tuple[SurfaceMesh, Floats]:
    """Return the receiver with a vertex at every node of a Gauss rule, and the weights of all its vertices."""
    place = case.place
    assert place is not None
    node, weight = np.polynomial.legendre.leggauss(NODES)
    along = np.concatenate([[0.0], 0.5 + 0.5 * node, [1.0]])
    share = np.concatenate([[0.0], 0.5 * weight, [0.0]])
    s, t = (x.ravel() for x in np.meshgrid(along, along))
    mesh = surface_mesh("receiver", place.corner + s[:, None] * place.u + t[:, None] * place.v, squares(len(along)))
    # What is black Cycles bakes as dark; a flat receiver before a black emitter sees no light of its own.
    return replace(mesh, reflectance=np.full_like(mesh.reflectance, 0.5)), np.outer(share, share).ravel()


def squares(along: int) -> list[tuple[int, int, int]]:
    """Return the triangles of a net of so many by so many vertices."""
    first = [j * along + i for j in range(along - 1) for i in range(along - 1)]
    return [t for a in first for t in ((a, a + 1, a + along + 1), (a, a + along + 1, a + along))]


def divided(mesh: SurfaceMesh) -> SurfaceMesh:
    """Return a box of twelve triangles, two a wall, with a net of vertices on each wall."""
    vertices, triangles = [], []
    s, t = (x.ravel()[:, None] for x in np.meshgrid(*2 * [np.linspace(0.0, 1.0, ALONG_WALL)]))
    for first, second in zip(mesh.triangles[::2], mesh.triangles[1::2], strict=True):
        a, b, _, d = mesh.vertices[[*first, second[2]]]
        triangles += (np.array(squares(ALONG_WALL)) + len(vertices) * ALONG_WALL**2).tolist()
        vertices.append(a + s * (b - a) + t * (d - a))
    colours = {"reflectance": mesh.reflectance[0], "emission": mesh.emission[0]}
    return replace(surface_mesh(mesh.name, np.concatenate(vertices), triangles, **colours), baked=mesh.baked)


def inner_vertices(mesh: SurfaceMesh) -> np.ndarray:
    """Return which vertices of such a box lie on no edge of it, where Cycles' rays begin on two walls at once."""
    inner = np.zeros((ALONG_WALL, ALONG_WALL), dtype=bool)
    inner[1:-1, 1:-1] = True
    return np.tile(inner.ravel(), len(mesh.vertices) // ALONG_WALL**2)
