# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Whatever is put in, a bake ends in sound values that add up, or in a sentence: random ugly scenes.

A hundred of them, always the same, belong to the tests; `make nightly` tries others for as long as it is told.
"""

import json
import os
import re
import signal
from contextlib import contextmanager

import numpy as np
from hypothesis import HealthCheck, given, settings
from radiosity_bake.core.bake import bake
from radiosity_bake.core.errors import NoLightError, NothingToBakeError, UnsolvableError
from radiosity_bake.core.lighting import LARGEST_IMBALANCE

from tests.scenes.ugly import UglyScene, ugly_scenes

NIGHTLY_SCENES = int(os.environ.get("UGLY_SCENES", "0"))
"""How many scenes `make nightly` asks for, each time others."""

MOST_SECONDS = 60.0
"""Of processor time, where the slowest take two: a bake that needs more hangs."""


@contextmanager
def limited(seconds: float):
    """Raise where the block takes more processor time, however busy the machine is."""

    def hangs(number, frame):
        raise AssertionError(f"the bake took more than {seconds:g} s of processor time")

    before = signal.signal(signal.SIGPROF, hangs)
    signal.setitimer(signal.ITIMER_PROF, seconds)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_PROF, 0.0)
        signal.signal(signal.SIGPROF, before)


def baked(ugly: UglyScene):
    """Return the bake, or None where it was refused with a sentence that is true."""
    try:
        with limited(MOST_SECONDS):
            return bake(ugly.scene, ugly.settings)
    except (NothingToBakeError, NoLightError) as error:
        assert not ugly.in_company, error
        refused = str(error)
    except UnsolvableError as error:
        assert any((mesh.reflectance >= 1.0).any() or mesh.reflectance_texture for mesh in ugly.scene.meshes), error
        refused = str(error)
    assert refused[0].isupper() and not refused.endswith(".")
    return None


def check_values(ugly: UglyScene, result) -> None:
    """Nothing is negative or not a number, in values and in the report."""
    json.dumps(result.report, allow_nan=False)
    for mesh in result.meshes:
        for name in ("radiosity", "irradiance", "radiosity_back", "irradiance_back"):
            values = getattr(mesh, name)
            if values is not None:
                assert np.isfinite(values).all() and (values >= 0.0).all(), (ugly.scene.meshes[mesh.mesh].name, name)
        assert np.isfinite(mesh.barycentric).all()
        # On original meshes they are the input's own.
        assert ugly.settings.output == "ORIGINAL" or np.isfinite(mesh.corner_normals).all()


def check_energy(ugly: UglyScene, result) -> None:
    """What leaves is what is emitted and reflected: it is absorbed, escapes, or is said to be missing.

    Where light passes through what also receives it, it is there twice, and no balance is expected.
    """
    energy = result.report["energy"]
    assert all(energy[name] >= 0.0 for name in energy if name != "imbalance"), energy
    said = any("unaccounted" in warning for warning in result.report["warnings"])
    lets_pass = any(mesh.seen and not mesh.shadow for mesh in ugly.scene.meshes)
    assert said or lets_pass or abs(energy["imbalance"]) <= LARGEST_IMBALANCE, energy


def check_company(ugly: UglyScene, result) -> None:
    """The room is whole, and lit."""
    if ugly.in_company:
        room = next(mesh for mesh in result.meshes if ugly.scene.meshes[mesh.mesh].name == "room")
        assert len(np.unique(room.parent_triangle)) == 12, result.report["warnings"]
        assert room.irradiance.mean() > 0.0 or (
            room.irradiance_back is not None and room.irradiance_back.mean() > 0.0
        ), result.report


def check_named(ugly: UglyScene, result) -> None:
    """Triangles that have no values are counted in warnings that begin with the mesh's name."""
    if ugly.settings.output == "ORIGINAL":
        return
    for mesh in result.meshes:
        given_mesh = ugly.scene.meshes[mesh.mesh]
        dropped = len(given_mesh.triangles) - len(np.unique(mesh.parent_triangle))
        pattern = re.compile(re.escape(given_mesh.name) + r": (\d+) triangles? .*left out")
        told = sum(int(found[1]) for found in map(pattern.match, result.report["warnings"]) if found)
        assert told == dropped, given_mesh.name


@settings(
    max_examples=NIGHTLY_SCENES or 100,
    derandomize=not NIGHTLY_SCENES,
    database=None,
    deadline=None,
    suppress_health_check=list(HealthCheck),
)
@given(ugly_scenes())
def test_any_scene_ends_in_sound_values_or_in_a_sentence(ugly):
    result = baked(ugly)
    if result is not None:
        check_values(ugly, result)
        check_energy(ugly, result)
        check_company(ugly, result)
        check_named(ugly, result)
