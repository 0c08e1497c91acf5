# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Whatever is put in, a bake ends in sound values that add up, or in a sentence: random ugly scenes.

`make nightly` tries them for as long as it is told; what it found stands below as tests of their own.
"""

import json
import os
import re
import signal
from contextlib import contextmanager

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from radiosity_bake.core.bake import bake
from radiosity_bake.core.coarse_patches import coarse_patches
from radiosity_bake.core.errors import NoLightError, NothingToBakeError, UnsolvableError
from radiosity_bake.core.lighting import LARGEST_IMBALANCE
from radiosity_bake.core.scene import AreaLamp, PointLamp, Scene, SunLamp, surface_mesh
from radiosity_bake.core.settings import BakeSettings
from radiosity_bake.core.surfaces import join

from tests.core.building import DARK, block, crosses, mesh_area
from tests.scenes import exact
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


COARSE = BakeSettings(quality="DRAFT", minimum_size=0.5)
FLOOR = exact.rectangle("floor", (-1, -1, 0), (2, 0, 0), (0, 2, 0), reflectance=0.5)
WHITE, UP = np.ones(3), np.array([0.0, 0.0, 1.0])
NOWHERE = np.array([np.nan, 0.0, 1.0])


@pytest.mark.parametrize(
    "lamp",
    [
        PointLamp("odd", NOWHERE, 0.1, WHITE),
        PointLamp("odd", UP, np.nan, WHITE),
        PointLamp("odd", 1e30 * UP, 0.1, WHITE),
        AreaLamp("odd", UP, np.full((2, 3), np.inf), -UP, WHITE),
        AreaLamp("odd", UP, np.eye(3)[:2], 0.0 * UP, WHITE),
        SunLamp("odd", NOWHERE, 0.1, WHITE),
        PointLamp("odd", UP, 0.1, np.nan * WHITE),
    ],
    ids=["nowhere", "no radius", "too far", "endless", "no normal", "no direction", "no power"],
)
def test_a_lamp_that_is_no_lamp_is_named_and_leaves_the_light_of_others(lamp):
    alone, beside = (bake(Scene((FLOOR,), WHITE, lamps), COARSE) for lamps in ((), (lamp,)))
    # Other receivers get other rays where there are lamps at all: the floor sees the whole sky by each of them.
    assert beside.meshes[0].irradiance == pytest.approx(alone.meshes[0].irradiance, rel=1e-6)
    assert any(warning.startswith("odd: ") for warning in beside.report["warnings"])


@pytest.mark.parametrize("far", [1e13, 1e30, 1e200, np.inf])
def test_a_vertex_too_far_away_takes_its_own_face_along_and_no_other(far):
    broken = surface_mesh("broken", [(0, 0, 1), (1, 0, 1), (0, far, 1)], [(0, 1, 2)])
    result = bake(Scene((FLOOR, broken), WHITE), COARSE)
    assert len(np.unique(result.meshes[0].parent_triangle)) == 2
    assert any(warning.startswith("broken: 1 triangles with coordinates") for warning in result.report["warnings"])


def test_what_is_too_large_for_the_rest_of_the_scene_is_named_where_nothing_is_left():
    vast = exact.rectangle("vast", (-1e11, -1e11, -5), (2e11, 0, 0), (0, 2e11, 0))
    hidden = surface_mesh(vast.name, vast.vertices, vast.triangles, baked=False)
    with pytest.raises(NothingToBakeError, match='too small beside "vast"'):
        bake(Scene((FLOOR, hidden), WHITE), COARSE)


def test_what_is_too_large_is_named_though_it_is_too_thin_to_be_left():
    # Their areas are nothing to speak of, either, and yet they are what the scene's size comes from.
    corners = [(0, 0, -5), (1e11, 0, -5), (0, 1e-7, -5)]
    long = surface_mesh("long", np.tile(corners, (3, 1)), np.arange(9).reshape(3, 3), baked=False)
    with pytest.raises(NothingToBakeError, match=r'too small beside "long", which reaches 1\.0e\+11 far'):
        bake(Scene((FLOOR, long), WHITE), COARSE)


def light_of_room(room, lamp):
    """Mean irradiance of a room's own twelve triangles, whatever else its mesh has."""
    result = bake(Scene((room, lamp), DARK), BakeSettings(quality="DRAFT", keep_transport=False))
    mesh = result.meshes[0]
    own = mesh.parent_triangle < 12
    return np.average(mesh.irradiance[own].mean(axis=(1, 2)), weights=mesh_area(mesh)[own]), result.report["warnings"]


@pytest.mark.parametrize("far", [1e4, 1e6, 1e9])
@pytest.mark.parametrize("kind", ["loose", "square to an axis", "slanted"])
def test_a_stray_vertex_far_away_leaves_the_light_of_its_own_mesh_as_it_is(far, kind):
    room = exact.closed_room((2, 2, 2), reflectance=0.5)
    lamp = exact.rectangle("lamp", (0.7, 0.7, 1.95), (0, 0.6, 0), (0.6, 0, 0), emission=5.0)
    away = [(3.0, 0.0, 0.0), (far, far, 0.0), (far, 0.0, far if kind == "slanted" else 0.0)]
    face = [] if kind == "loose" else [(8, 9, 10)]
    vertices, triangles = np.concatenate([room.vertices, away]), [*room.triangles.tolist(), *face]
    strayed = surface_mesh("room", vertices, triangles, reflectance=0.5)
    (alone, _), (beside, warnings) = (light_of_room(mesh, lamp) for mesh in (room, strayed))
    # Both are drawn with rays of their own where a face more is there: a few in a thousand at DRAFT.
    assert beside == pytest.approx(alone, rel=0.01)
    left_out = far > {"loose": np.inf, "square to an axis": 1e6, "slanted": 1e4}[kind]
    assert any("room: 1 triangles too large beside" in told for told in warnings) == left_out


@pytest.mark.parametrize("quality", ["DRAFT", "GOOD"])
def test_a_block_is_lit_alike_on_a_ground_however_wide(quality):
    sides = []
    for wide in (1e2, 1e6):
        ground = exact.rectangle("ground", (-wide, -wide, 0), (2 * wide, 0, 0), (0, 2 * wide, 0), reflectance=0.5)
        result = bake(Scene((ground, block("block", (0, 0, 0), (1, 1, 1))), WHITE), BakeSettings(quality=quality))
        mesh = result.meshes[1]
        upright = np.abs(crosses(mesh.vertices, mesh.triangles)[:, 2]) < mesh_area(mesh)
        sides.append(np.average(mesh.irradiance[upright].mean(axis=(1, 2)), weights=mesh_area(mesh)[upright]))
        assert abs(result.report["energy"]["imbalance"]) < 0.01
    # Half is of the sky, which is exact; of the other half each estimate is good for 2% at DRAFT.
    assert sides[1] == pytest.approx(sides[0], rel=0.02)
    # A plain without end gives back half, less what the block keeps from it.
    assert 0.7 < sides[1] < 0.75


def test_many_slivers_have_no_more_pieces_than_there_is_room_for(monkeypatch):
    monkeypatch.setattr("radiosity_bake.core.coarse_patches.MOST_PIECES", 1000)
    slivers = [surface_mesh(f"sliver {k}", [(0, 0, k), (1e4, 0, k), (1e4, 0.1, k)], [(0, 1, 2)]) for k in range(10)]
    tree = coarse_patches(join(Scene(tuple(slivers), DARK)), 1e-6)
    # The last halving may leave pieces up to half as long as they could be.
    assert 500 < len(tree.leaves()) <= 2 * 1080
