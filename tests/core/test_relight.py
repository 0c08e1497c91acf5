# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Relighting: other colours on the transport of a bake give what a fresh bake gives, without tracing a ray."""

from contextlib import nullcontext
from dataclasses import replace
from unittest.mock import patch

import numpy as np
import pytest
from radiosity_bake.core import bake as bake_module
from radiosity_bake.core.bake import bake
from radiosity_bake.core.direct_light import DirectLight
from radiosity_bake.core.errors import Cancelled, NoLightError, UnsolvableError
from radiosity_bake.core.relight import ChangedSceneError, KeptTransport, NotKept, keep, relight, size_of
from radiosity_bake.core.scene import Scene, surface_mesh
from radiosity_bake.core.settings import BakeSettings

from tests.core.building import DARK, block, grid, mean_over, moved, room_with_block
from tests.core.test_bake import same_bytes
from tests.scenes import exact

COARSE = {"quality": "DRAFT", "minimum_size": 0.4}
VALUES = ("radiosity", "irradiance")

ROUNDING = 1e-5
"""Of the largest value: what sums in another order and a balance solved to a residual of 1e-5 may differ by."""


def recoloured(scene, *, emission=1.0, reflectance=1.0, world=1.0):
    """The same meshes with colours times numbers, which may be given by mesh name."""

    def times(colours, factor, name):
        return colours * np.asarray(factor.get(name, 1.0) if isinstance(factor, dict) else factor)

    meshes = tuple(
        replace(
            mesh,
            emission=times(mesh.emission, emission, mesh.name),
            reflectance=times(mesh.reflectance, reflectance, mesh.name),
        )
        for mesh in scene.meshes
    )
    return Scene(meshes, scene.world * np.asarray(world))


def room_with_two_lamps():
    """A block between a warm lamp on one side and a cold one on the other."""
    lamps = (
        exact.rectangle("warm", (0.3, 0.8, 1.95), (0, 0.4, 0), (0.4, 0, 0), emission=(8.0, 4.0, 2.0)),
        exact.rectangle("cold", (1.4, 0.8, 1.95), (0, 0.4, 0), (0.3, 0, 0), emission=(1.0, 3.0, 9.0)),
    )
    walls = exact.box_walls((2, 2, 2), reflectance=0.6)
    return Scene((*walls, *lamps, block("block", (0.7, 0.7, 0.0), (1.2, 1.2, 0.8), turned=25.0)), DARK)


def room_with_many_lamps():
    """A block under a grid of 128 small emitting triangles."""
    lamp = grid("lamps", 8)
    shine = surface_mesh("lamps", lamp.vertices * [1, 1, 0] + [0.5, 0.5, 1.9], lamp.triangles[:, ::-1], emission=4.0)
    walls = exact.box_walls((2, 2, 2), reflectance=0.5)
    return Scene((*walls, shine, block("block", (0.5, 0.6, 0.0), (1.1, 1.2, 0.8), turned=25.0)), DARK)


def open_scene():
    """Two blocks on a floor under a bright world, and a lamp."""
    lamp = exact.rectangle("lamp", (0.7, 0.7, 1.5), (0, 0.6, 0), (0.6, 0, 0), emission=2.0)
    floor = exact.rectangle("floor", (-1, -1, 0), (4, 0, 0), (0, 4, 0), reflectance=(0.6, 0.4, 0.2))
    blocks = (block("one", (0.1, 0.2, 0.0), (0.6, 0.7, 0.9)), block("other", (1.2, 1.0, 0.0), (1.7, 1.6, 0.5)))
    return Scene((floor, lamp, *blocks), np.array([0.5, 0.7, 1.0]))


SCENES = {
    "one lamp": room_with_block,
    "two lamps": room_with_two_lamps,
    "many lamps": room_with_many_lamps,
    "open": open_scene,
}


def without_more_rays():
    """Bakes that take the rays of their quality however noisy the light is: how noisy depends on its colours."""
    return patch.object(bake_module, "enough_rays", lambda rays, *found: rays)


@pytest.fixture(scope="module")
def kept_bakes():
    """Bakes with their transport, made once each."""
    made = {}

    def make(name, more_rays=True, **settings):
        key = (name, more_rays, *settings.items())
        if key not in made:
            with nullcontext() if more_rays else without_more_rays():
                made[key] = bake(SCENES[name](), BakeSettings(**(COARSE | settings)))
        return made[key], made[key].kept

    return make


def largest_difference(one, other):
    """Of any value, relative to the largest value of its attribute on all meshes."""
    worst = 0.0
    for name in VALUES:
        largest = max(getattr(mesh, name).max() for mesh in one.meshes)
        for a, b in zip(one.meshes, other.meshes, strict=True):
            assert a.triangles.shape == b.triangles.shape
            worst = max(worst, float(np.abs(getattr(a, name) - getattr(b, name)).max()) / largest)
    return worst


# --------------------------------------------------------------------------------------------- as a fresh bake would


@pytest.mark.parametrize("output", ["ORIGINAL", "REFINED"])
@pytest.mark.parametrize("name", SCENES)
def test_the_same_colours_give_the_same_bytes(kept_bakes, name, output):
    result, kept = kept_bakes(name, output=output)
    again = relight(kept, SCENES[name]())
    assert same_bytes(result, again)
    for key in ("estimated_error", "energy", "residual", "iterations", "vertices", "patches", "warnings"):
        assert again.report[key] == result.report[key]


def test_the_threads_do_not_matter(kept_bakes):
    result, _ = kept_bakes("one lamp", output="REFINED")
    _, kept = kept_bakes("one lamp", output="REFINED", threads=1)
    assert same_bytes(result, relight(kept, room_with_block()))


# Where vertices do not depend on light, and all emitters change alike, rays are shared out among them as before.
@pytest.mark.parametrize("settings", [{"output": "ORIGINAL"}, {"output": "REFINED", "method": "UNIFORM"}])
@pytest.mark.parametrize("name", SCENES)
@pytest.mark.parametrize(
    "change",
    [
        {"emission": 3.0},
        {"reflectance": (0.5, 1.2, 0.9)},
        {"emission": 0.2, "reflectance": 0.3, "world": (2.0, 1.0, 0.1)},
    ],
    ids=["emission", "reflectance", "all"],
)
def test_other_colours_give_what_a_fresh_bake_gives(kept_bakes, name, settings, change):
    _, kept = kept_bakes(name, more_rays=False, **settings)
    other = recoloured(SCENES[name](), **change)
    with without_more_rays():
        fresh = bake(other, BakeSettings(**(COARSE | settings)))
    relit = relight(kept, other)
    assert largest_difference(fresh, relit) < ROUNDING
    assert relit.report["estimated_error"] == pytest.approx(fresh.report["estimated_error"], rel=1e-4)
    assert relit.report["energy"] == pytest.approx(fresh.report["energy"], rel=1e-4, abs=1e-5)


def test_another_colour_of_a_lamp_gives_what_a_fresh_bake_gives(kept_bakes):
    _, kept = kept_bakes("one lamp", output="ORIGINAL")
    other = recoloured(room_with_block(), emission=(0.1, 0.4, 4.0))
    fresh = bake(other, BakeSettings(**COARSE, output="ORIGINAL"))
    assert largest_difference(fresh, relight(kept, other)) < ROUNDING


@pytest.mark.parametrize("strengths", [{"warm": 0.0}, {"cold": 0.0}, {"warm": 0.3, "cold": 3.0}], ids=str)
def test_lamps_may_go_dark_and_change_against_each_other(kept_bakes, strengths):
    _, kept = kept_bakes("two lamps", output="REFINED", method="UNIFORM")
    other = recoloured(room_with_two_lamps(), emission=strengths)
    fresh = bake(other, BakeSettings(**COARSE, method="UNIFORM"))
    relit = relight(kept, other)
    # The shadow rays are shared out by other strengths, so penumbrae differ by their noise: of the estimate's parts the
    # one that interpolation misses is the same for both.
    for a, b in zip(fresh.meshes, relit.meshes, strict=True):
        missed = np.sqrt(((a.irradiance - b.irradiance) ** 2).mean())
        assert missed < fresh.report["estimated_error"] * mean_over(fresh.meshes).mean()
    np.testing.assert_allclose(mean_over(relit.meshes), mean_over(fresh.meshes), rtol=0.01)


def test_a_refined_mesh_has_the_light_of_a_fresh_bake_within_both_errors(kept_bakes):
    _, kept = kept_bakes("two lamps", output="REFINED")
    other = recoloured(room_with_two_lamps(), emission={"warm": (0.2, 0.5, 1.0)}, reflectance=0.6)
    fresh, relit = bake(other, BakeSettings(**COARSE)), relight(kept, other)
    allowed = np.hypot(fresh.report["estimated_error"], relit.report["estimated_error"])
    for a, b in zip(fresh.meshes, relit.meshes, strict=True):
        # Faces lie elsewhere; over a whole mesh their errors cancel in part.
        np.testing.assert_allclose(mean_over([a]), mean_over([b]), rtol=allowed)


def test_relighting_there_and_back_changes_nothing(kept_bakes):
    result, kept = kept_bakes("one lamp", output="REFINED")
    relight(kept, recoloured(room_with_block(), emission=(0.1, 0.4, 4.0), reflectance=0.4))
    assert same_bytes(result, relight(kept, room_with_block()))


def test_the_radiosity_has_the_new_emission_and_reflectance(kept_bakes):
    _, kept = kept_bakes("one lamp", output="REFINED")
    other = recoloured(room_with_block(), emission=2.0, reflectance=0.5)
    for mesh in relight(kept, other).meshes:
        given = other.meshes[mesh.mesh]
        parent = mesh.parent_triangle
        expected = given.emission[parent, None] + given.reflectance[parent, None] * mesh.irradiance
        np.testing.assert_allclose(mesh.radiosity, expected, rtol=1e-12)


# --------------------------------------------------------------------------------------------------------- its costs


def test_no_ray_is_traced(kept_bakes, monkeypatch):
    _, kept = kept_bakes("two lamps", output="REFINED")

    def refuse(*_):
        raise AssertionError("rays are wanted")

    monkeypatch.setattr("radiosity_bake.core.ray_library.library", refuse)
    report = relight(kept, recoloured(room_with_two_lamps(), emission=2.0)).report
    assert report["relit"]
    assert report["rays"] == 0
    assert not any(report["rays_by_kind"].values())
    assert report["seconds_in_ray_library"] == 0.0


def test_what_is_kept_stays_below_the_memory_limit(monkeypatch):
    settings = BakeSettings(quality="DRAFT", minimum_size=0.02, method="UNIFORM", memory_limit=64)
    kept = bake(room_with_block(), settings).kept
    assert isinstance(kept, KeptTransport) and size_of(kept) <= 64 * 2**20
    # What of a bake is larger than that is only the scene itself, which would take a minute to bake.
    monkeypatch.setattr("radiosity_bake.core.relight.size_of", lambda _: 64 * 2**20 + 1)
    let_go = keep(kept)
    assert isinstance(let_go, NotKept)
    assert "memory limit of 64 MiB" in let_go.why


def test_the_size_counts_every_array_once(kept_bakes):
    values = np.zeros(100)
    assert size_of((values, [values, values[:10]], replace(DirectLight.none(3), weight=values))) == values.nbytes
    _, kept = kept_bakes("one lamp", output="REFINED")
    assert size_of(kept) > sum(table.places.nbytes for table in kept.shown.gathered.places.tables)


# ----------------------------------------------------------------------------------------------------- what is refused


def refused(kept, scene, sentence):
    with pytest.raises(ChangedSceneError, match=sentence):
        relight(kept, scene)


def test_other_shapes_are_refused_with_the_name_of_the_mesh(kept_bakes):
    _, kept = kept_bakes("one lamp", output="ORIGINAL")
    scene = room_with_block()
    *others, last = scene.meshes
    nudged = last.vertices.copy()
    nudged[3, 1] += 1e-6
    for changed in (
        replace(last, vertices=nudged),
        replace(last, triangles=last.triangles[::-1]),
        replace(last, corner_normals=-last.corner_normals),
        replace(last, baked=False),
    ):
        refused(kept, Scene((*others, changed), scene.world), '"block" was changed or moved')
    refused(kept, moved(scene, 2.0), "was changed or moved")
    refused(kept, Scene(tuple(others), scene.world), "added, removed or hidden")


def test_a_new_name_is_no_change(kept_bakes):
    result, kept = kept_bakes("one lamp", output="ORIGINAL")
    scene = room_with_block()
    renamed = Scene(tuple(replace(mesh, name=f"my {mesh.name}") for mesh in scene.meshes), scene.world)
    assert same_bytes(result, relight(kept, renamed))


def test_light_from_what_gave_none_is_refused(kept_bakes):
    _, kept = kept_bakes("one lamp", output="ORIGINAL")
    scene = room_with_block()
    *others, last = scene.meshes
    glowing = replace(last, emission=np.ones_like(last.emission))
    refused(kept, Scene((*others, glowing), scene.world), '"block" gave no light')
    refused(kept, Scene(scene.meshes, np.ones(3)), "World gave no light")


def test_no_light_and_trapped_light_are_errors_as_in_a_bake(kept_bakes):
    _, kept = kept_bakes("one lamp", output="ORIGINAL")
    with pytest.raises(NoLightError):
        relight(kept, recoloured(room_with_block(), emission=0.0))
    scene = room_with_block()
    white = tuple(replace(mesh, reflectance=np.ones_like(mesh.reflectance)) for mesh in scene.meshes)
    with pytest.raises(UnsolvableError):
        relight(kept, Scene(white, scene.world))


def test_progress_grows_and_can_stop_it(kept_bakes):
    _, kept = kept_bakes("one lamp", output="REFINED")
    messages = []
    relight(kept, room_with_block(), messages.append)
    shares = [message.share for message in messages]
    assert shares == sorted(shares)
    assert shares[-1] == 1.0

    def stop(message):
        if message.stage == "Gathering":
            raise Cancelled

    with pytest.raises(Cancelled):
        relight(kept, room_with_block(), stop)


def test_nothing_is_kept_where_it_is_not_asked_for(kept_bakes):
    result, kept = kept_bakes("one lamp", output="ORIGINAL")
    assert isinstance(kept, KeptTransport)
    without = bake(room_with_block(), BakeSettings(**COARSE, output="ORIGINAL", keep_transport=False))
    assert without.kept is None
    assert same_bytes(result, without)
