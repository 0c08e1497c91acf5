# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""How a bake can end otherwise: cancelled, refused with a sentence, or done in spite of ugly input."""

import numpy as np
import pytest
from radiosity_bake.core.bake import bake
from radiosity_bake.core.errors import BakeError, Cancelled, NoLightError, NothingToBakeError
from radiosity_bake.core.scene import PointLamp, Scene, SurfaceMesh, surface_mesh
from radiosity_bake.core.settings import BakeSettings

from tests.core.building import DARK, room_with_block
from tests.scenes import exact

COARSE = BakeSettings(quality="DRAFT", minimum_size=0.5)
FLOOR = exact.rectangle("floor", (-1, -1, 0), (2, 0, 0), (0, 2, 0), reflectance=0.5)
LAMP = exact.rectangle("lamp", (-0.5, -0.5, 1.5), (0, 1, 0), (1, 0, 0), emission=3.0)


class Listener:
    """Takes messages, and asks to stop at the one numbered `stop`."""

    def __init__(self, stop=None):
        self.messages, self.stop = [], stop

    def __call__(self, message):
        self.messages.append(message)
        if len(self.messages) - 1 == self.stop:
            raise Cancelled("enough")


@pytest.fixture(scope="module")
def messages():
    listener = Listener()
    bake(room_with_block(), BakeSettings(quality="DRAFT", minimum_size=0.15), listener)
    return listener.messages


def test_progress_never_goes_back_and_ends_at_one(messages):
    share = [message.share for message in messages]
    assert share == sorted(share)
    assert share[0] >= 0.0 and share[-1] == 1.0
    assert messages[-1].stage == "Done"


def test_progress_names_every_stage_in_its_order(messages):
    stages = list(dict.fromkeys(message.stage for message in messages))
    expected = ["Preparing", "Coarse patches", "Form factors", "Solving", "Gathering", "Reconstructing", "Done"]
    assert [stage for stage in stages if stage in expected] == expected


def test_progress_moves_within_the_long_stages(messages):
    for stage in ("Form factors", "Gathering"):
        shares = {message.share for message in messages if message.stage == stage}
        assert len(shares) > 3


def test_progress_is_told_by_the_thread_that_called(monkeypatch):
    import threading

    seen = set()
    bake(room_with_block(), COARSE, lambda message: seen.add(threading.current_thread()))
    assert seen == {threading.current_thread()}


@pytest.mark.parametrize("share", [0.0, 0.1, 0.25, 0.4, 0.55, 0.7, 0.85, 0.95, 0.999])
def test_a_bake_can_be_cancelled_at_any_message(messages, share):
    k = int(share * (len(messages) - 1))
    listener = Listener(stop=k)
    with pytest.raises(Cancelled, match="enough"):
        bake(room_with_block(), BakeSettings(quality="DRAFT", minimum_size=0.15), listener)
    # Nothing is said after it was asked to stop.
    assert len(listener.messages) == k + 1


def test_cancelling_leaves_no_thread_behind(messages):
    import threading

    before = threading.active_count()
    with pytest.raises(Cancelled):
        bake(room_with_block(), COARSE, Listener(stop=len(messages) // 10))
    assert threading.active_count() == before


def test_a_cancelled_bake_can_be_repeated():
    scene = room_with_block()
    with pytest.raises(Cancelled):
        bake(scene, COARSE, Listener(stop=4))
    one, two = bake(scene, COARSE), bake(scene, COARSE)
    assert one.meshes[0].irradiance.tobytes() == two.meshes[0].irradiance.tobytes()


def test_an_error_of_the_callers_own_passes_through():
    def broken(message):
        raise ZeroDivisionError

    with pytest.raises(ZeroDivisionError):
        bake(room_with_block(), COARSE, broken)


def hidden(mesh: SurfaceMesh) -> SurfaceMesh:
    return SurfaceMesh(
        mesh.name, mesh.vertices, mesh.triangles, mesh.corner_normals, mesh.reflectance, mesh.emission, baked=False
    )


EMPTY = surface_mesh("empty", np.zeros((0, 3)), np.zeros((0, 3), int))
LOOSE = surface_mesh("loose", [(0, 0, 0), (1, 0, 0)], np.zeros((0, 3), int))
FLAT = surface_mesh("flat", [(0, 0, 0), (1, 0, 0), (2, 0, 0)], [(0, 1, 2)])
BROKEN = surface_mesh("broken", [(np.nan, 0, 0), (1, 0, 0), (0, 1, 0)], [(0, 1, 2)])


@pytest.mark.parametrize(
    "meshes",
    [(), (EMPTY,), (LOOSE,), (FLAT, hidden(LAMP)), (BROKEN, hidden(LAMP)), (hidden(FLOOR), hidden(LAMP))],
    ids=["no meshes", "empty", "loose", "no area", "not numbers", "none baked"],
)
def test_nothing_to_bake_is_refused_with_what_to_do(meshes):
    with pytest.raises(NothingToBakeError, match="select a mesh that has faces"):
        bake(Scene(tuple(meshes), np.ones(3)), COARSE)


def test_a_scene_without_light_is_refused_with_what_to_do():
    with pytest.raises(NoLightError, match=r"Emission.*World"):
        bake(Scene((FLOOR,), DARK), COARSE)


@pytest.mark.parametrize("strength", [0.0, -5.0])
def test_lamps_that_give_no_light_are_named_where_nothing_else_does(strength):
    lamps = [PointLamp(name, np.array([0.0, 0.0, 1.0]), 0.1, np.full(3, strength)) for name in ("Key", "Fill", "Rim")]
    with pytest.raises(NoLightError, match='"Key" gives none: its power or colour is zero or negative'):
        bake(Scene((FLOOR,), DARK, (lamps[0],)), COARSE)
    with pytest.raises(NoLightError, match='"Key" and 2 more give none: their power or colour'):
        bake(Scene((FLOOR,), DARK, tuple(lamps)), COARSE)


@pytest.mark.parametrize("world", [(-1.0, -1.0, -1.0), (np.nan, 0.0, 0.0)])
def test_light_that_is_no_light_counts_as_none(world):
    with pytest.raises(NoLightError):
        bake(Scene((FLOOR,), np.array(world)), COARSE)


def test_every_error_is_a_sentence_without_a_full_stop():
    for scene in (Scene((), DARK), Scene((FLOOR,), DARK)):
        with pytest.raises(BakeError) as caught:
            bake(scene, COARSE)
        text = str(caught.value)
        assert text[0].isupper() and not text.endswith(".") and len(text) < 160


@pytest.mark.parametrize("ugly", [EMPTY, LOOSE, FLAT, BROKEN], ids=lambda m: m.name)
@pytest.mark.parametrize("output", ["REFINED", "ORIGINAL"])
def test_an_ugly_mesh_beside_a_sound_one_does_not_disturb_it(ugly, output):
    settings = BakeSettings(quality="DRAFT", minimum_size=0.5, output=output)
    alone = bake(Scene((FLOOR, LAMP), DARK), settings)
    result = bake(Scene((FLOOR, LAMP, ugly), DARK), settings)
    assert [mesh.mesh for mesh in result.meshes] == [0, 1, 2]
    assert result.meshes[0].irradiance.tobytes() == alone.meshes[0].irradiance.tobytes()
    assert np.isfinite(result.meshes[2].irradiance).all()


@pytest.mark.parametrize(("ugly", "words"), [(FLAT, "without area"), (BROKEN, "not numbers")])
def test_triangles_that_were_left_out_are_named_in_a_warning(ugly, words):
    warnings = bake(Scene((FLOOR, LAMP, ugly), DARK), COARSE).report["warnings"]
    assert any(warning.startswith(f"{ugly.name}: 1 triangles") and words in warning for warning in warnings)


@pytest.mark.parametrize("output", ["REFINED", "ORIGINAL"])
def test_one_bad_triangle_among_good_ones_is_left_out_alone(output):
    vertices = np.concatenate([FLOOR.vertices, [(np.nan, 0, 0), (0, 0, 0)]])
    mixed = surface_mesh("mixed", vertices, [*FLOOR.triangles, (0, 1, 4), (0, 0, 1)], reflectance=0.5)
    settings = BakeSettings(quality="DRAFT", minimum_size=0.5, output=output)
    mesh = bake(Scene((mixed, LAMP), DARK), settings).meshes[0]
    assert np.isfinite(mesh.radiosity).all() and np.isfinite(mesh.irradiance).all()
    assert set(mesh.parent_triangle) == ({0, 1} if output == "REFINED" else {0, 1, 2, 3})
    assert mesh.irradiance[mesh.parent_triangle < 2].max() > 0


def test_duplicate_faces_end_with_finite_values():
    twice = surface_mesh("twice", FLOOR.vertices, [*FLOOR.triangles, *FLOOR.triangles], reflectance=0.5)
    mesh = bake(Scene((twice, LAMP), DARK), COARSE).meshes[0]
    assert np.isfinite(mesh.irradiance).all()


def test_of_coincident_sheets_the_lit_one_is_lit():
    under = exact.rectangle("under", (-1, -1, -1e-7), (2, 0, 0), (0, 2, 0), reflectance=0.5)
    result = bake(Scene((FLOOR, under, LAMP), DARK), COARSE)
    alone = bake(Scene((FLOOR, LAMP), DARK), COARSE)
    assert result.meshes[0].irradiance.mean() == pytest.approx(alone.meshes[0].irradiance.mean(), rel=0.05)


def test_back_to_back_sheets_are_lit_each_on_its_own_side():
    other = exact.rectangle("other", (-1, -1, 0), (0, 2, 0), (2, 0, 0), reflectance=0.5)
    result = bake(Scene((FLOOR, other, LAMP), DARK), COARSE)
    alone = bake(Scene((FLOOR, LAMP), DARK), COARSE)
    assert result.meshes[0].irradiance.mean() == pytest.approx(alone.meshes[0].irradiance.mean(), rel=0.05)


def test_a_single_triangle_that_glows_is_baked():
    triangle = surface_mesh("one", [(0, 0, 0), (1, 0, 0), (0, 1, 0)], [(0, 1, 2)], emission=2.0)
    mesh = bake(Scene((triangle,), DARK), COARSE).meshes[0]
    np.testing.assert_allclose(mesh.radiosity, 2.0)


def test_a_sliver_of_aspect_ten_thousand_is_baked():
    sliver = surface_mesh("sliver", [(-1, 0, 0.1), (1, 0, 0.1), (0, 2e-4, 0.1)], [(0, 1, 2)], reflectance=0.5)
    mesh = bake(Scene((FLOOR, LAMP, sliver), DARK), COARSE).meshes[2]
    assert np.isfinite(mesh.irradiance).all() and mesh.irradiance.max() > 0


def test_tiny_faces_beside_huge_ones_are_lit_as_they_should_be():
    tiny = exact.rectangle("tiny", (0.1, 0.1, 0.01), (1e-4, 0, 0), (0, 1e-4, 0), reflectance=0.5)
    huge = exact.rectangle("huge", (-50, -50, -1), (100, 0, 0), (0, 100, 0), reflectance=0.5)
    mesh = bake(Scene((tiny, LAMP, huge), DARK), COARSE).meshes[0]
    truth = exact.rectangle_seen_from_below([(0.1, 0.1, 0.01)], (-0.5, -0.5, 1.5), 1.0, 1.0)[0] * 3.0
    assert mesh.irradiance.mean() == pytest.approx(truth, rel=0.02)


def test_base_colours_outside_zero_to_one_are_limited_and_named():
    bright = exact.rectangle("bright", (-1, -1, 0), (2, 0, 0), (0, 2, 0), reflectance=1.7)
    result = bake(Scene((bright, LAMP), DARK), COARSE)
    assert any(warning.startswith("bright: a base colour outside") for warning in result.report["warnings"])


@pytest.mark.parametrize("value", [np.nan, np.inf, -1.0])
def test_emission_that_is_no_number_is_taken_as_none(value):
    odd = exact.rectangle("odd", (3, 3, 0), (1, 0, 0), (0, 1, 0), emission=value)
    result = bake(Scene((FLOOR, LAMP, odd), DARK), COARSE)
    for mesh in result.meshes:
        assert np.isfinite(mesh.irradiance).all() and mesh.irradiance.min() >= 0


def test_non_manifold_edges_are_baked():
    slopes = ((0.5, 0, 0.5), (-0.5, 0, 0.5), (0, 0, 0.7))
    fins = [exact.rectangle("fin", (0, -0.5, 0), (0, 1, 0), slope).vertices for slope in slopes]
    vertices = np.concatenate(fins)
    triangles = np.concatenate([np.array(exact.QUAD) + 4 * k for k in range(3)])
    mesh = bake(Scene((surface_mesh("fins", vertices, triangles, reflectance=0.5), LAMP), DARK), COARSE).meshes[0]
    assert np.isfinite(mesh.irradiance).all() and mesh.irradiance.max() > 0


def test_normals_that_are_missing_or_point_away_do_not_matter():
    normals = np.array([[[0, 0, -1.0]] * 3, [[np.nan] * 3] * 3])
    wrong = surface_mesh("floor", FLOOR.vertices, FLOOR.triangles, reflectance=0.5, corner_normals=normals)
    mesh = bake(Scene((wrong, LAMP), DARK), COARSE).meshes[0]
    right = bake(Scene((FLOOR, LAMP), DARK), COARSE).meshes[0]
    assert mesh.irradiance.tobytes() == right.irradiance.tobytes()


@pytest.mark.parametrize("gap", [1e-3, 1e-2])
def test_a_thin_wall_lets_no_light_through(gap):
    # A closed black box with thin walls in a lit room: the floor within gets nothing.
    outer = exact.closed_room((2, 2, 2), reflectance=0.5)
    lamp = exact.rectangle("lamp", (0.7, 0.7, 1.9), (0, 0.6, 0), (0.6, 0, 0), emission=5.0)
    inside = exact.box_walls((1, 1, 1), reflectance=0.5, origin=(0.5, 0.5, 0.2))
    shell = exact.box_walls((1 + 2 * gap,) * 3, reflectance=0.5, origin=(0.5 - gap, 0.5 - gap, 0.2 - gap))
    from tests.core.building import flipped

    result = bake(Scene((outer, lamp, *inside, *(flipped(w) for w in shell)), DARK), COARSE)
    for mesh in result.meshes[2:8]:
        assert mesh.irradiance.max() == 0.0
    for mesh in result.meshes[8:]:
        assert mesh.irradiance.max() > 0.0


def test_a_corner_where_walls_only_touch_lets_no_light_through():
    # Six separate walls in a bright world: what gets in comes through the seams.
    walls = exact.box_walls((2, 3, 1), reflectance=0.8)
    inner = exact.rectangle("table", (0.5, 0.5, 0.5), (1, 0, 0), (0, 1, 0), reflectance=0.8)
    settings = BakeSettings(quality="DRAFT", minimum_size=0.5, output="ORIGINAL")
    result = bake(Scene((*walls, inner), np.full(3, 1000.0)), settings)
    assert max(mesh.irradiance.max() for mesh in result.meshes[:6]) < 1e-3 * 1000.0
