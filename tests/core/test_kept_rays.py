# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""What rays met in the frame before is not traced again, and the light is the same to the last bit."""

from collections.abc import Callable
from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from radiosity_bake.core import bake as bake_module
from radiosity_bake.core.bake import bake
from radiosity_bake.core.errors import Cancelled
from radiosity_bake.core.kept_rays import MOVED, Changes, KeptRays, RowsToKeep
from radiosity_bake.core.result import BakeResult
from radiosity_bake.core.scene import PointLamp, Scene, SunLamp, SurfaceMesh
from radiosity_bake.core.settings import BakeSettings
from radiosity_bake.core.visibility import RayScene

from tests.core.building import DARK, block, mean_over, room_with_block
from tests.core.test_bake import same_bytes
from tests.scenes import exact

COARSE = BakeSettings(quality="DRAFT", minimum_size=0.4)
ROWS, EACH = 60, 16


def with_mesh(scene: Scene, name: str, change: Callable[[SurfaceMesh], SurfaceMesh]) -> Scene:
    """The scene with one of its meshes changed."""
    return replace(scene, meshes=tuple(change(mesh) if mesh.name == name else mesh for mesh in scene.meshes))


def shifted(*way: float) -> Callable[[SurfaceMesh], SurfaceMesh]:
    return lambda mesh: replace(mesh, vertices=mesh.vertices + way)


def furnished() -> Scene:
    """The room with a block, with a shelf and a small cube by its walls and two lamps."""
    shelf, cube = block("shelf", (1.6, 0.2, 1.0), (1.95, 1.8, 1.05)), block("cube", (0.2, 1.6, 0.0), (0.4, 1.8, 0.2))
    lamps = (
        PointLamp("bulb", np.array([1.5, 0.4, 1.2]), 0.05, np.full(3, 0.4)),
        PointLamp("candle", np.array([0.3, 0.4, 0.6]), 0.0, np.array([0.2, 0.1, 0.05])),
    )
    scene = room_with_block()
    return replace(scene, meshes=(*scene.meshes, shelf, cube), lamps=lamps)


def open_scene() -> Scene:
    """Two blocks on a floor in the sun, and the sky."""
    floor = exact.rectangle("floor", (-1, -1, 0), (4, 0, 0), (0, 4, 0), reflectance=(0.6, 0.4, 0.2))
    blocks = (block("cube", (0.1, 0.2, 0.0), (0.6, 0.7, 0.9)), block("other", (1.2, 1.0, 0.0), (1.7, 1.6, 0.5)))
    sun = SunLamp("sun", np.array([-0.6, 0.0, -0.8]), 0.01, np.full(3, 2.0))
    return Scene((floor, *blocks), np.array([0.5, 0.7, 1.0]), lamps=(sun,))


def with_pane(share: float = 0.4) -> Scene:
    """The furnished room with a red curtain in its middle that lets some of the light through."""
    curtain = exact.rectangle("curtain", (1.3, 0.2, 0.1), (0, 1.2, 0), (0, 0, 1.4), reflectance=0.3)
    through = np.broadcast_to([share, 0.1, 0.1], (2, 3))
    scene = furnished()
    return replace(scene, meshes=(*scene.meshes, replace(curtain, transmittance=through)))


def lamp_moved(scene: Scene) -> Scene:
    bulb, candle = scene.lamps
    return replace(scene, lamps=(replace(bulb, centre=bulb.centre + [0.1, 0.2, 0.1]), candle))


FRAMES = {
    "a cube moves": (furnished(), with_mesh(furnished(), "cube", shifted(0.31, -0.13, 0.0))),
    "a shelf goes up": (furnished(), with_mesh(furnished(), "shelf", shifted(0.0, 0.0, 0.2))),
    "an emitter moves": (furnished(), with_mesh(furnished(), "lamp", shifted(0.2, 0.0, 0.0))),
    "a lamp moves": (furnished(), lamp_moved(furnished())),
    "a cube is hidden": (
        furnished(),
        replace(furnished(), meshes=tuple(mesh for mesh in furnished().meshes if mesh.name != "cube")),
    ),
    "a cube appears": (
        replace(furnished(), meshes=tuple(mesh for mesh in furnished().meshes if mesh.name != "cube")),
        furnished(),
    ),
    "a cube loses its shadow": (furnished(), with_mesh(furnished(), "cube", lambda mesh: replace(mesh, shadow=False))),
    "diffuse rays pass a cube": (furnished(), with_mesh(furnished(), "cube", lambda mesh: replace(mesh, seen=False))),
    "a cube moves in the sun": (open_scene(), with_mesh(open_scene(), "cube", shifted(0.2, 0.1, 0.0))),
    "a cube moves behind a curtain": (with_pane(), with_mesh(with_pane(), "cube", shifted(0.31, -0.13, 0.0))),
    "a curtain moves": (with_pane(), with_mesh(with_pane(), "curtain", shifted(0.1, 0.1, 0.0))),
    "a curtain lets more light through": (with_pane(), with_pane(0.7)),
}


REFINED = ("a cube moves", "a lamp moves", "a cube moves behind a curtain")


@cache
def kept_of(name: str, output: str = "REFINED") -> KeptRays:
    """What the rays of the first frame met; nothing changes it."""
    return bake(FRAMES[name][0], replace(COARSE, output=output), keep_rays=True).kept_rays


@cache
def fresh_bake(name: str, output: str = "REFINED") -> BakeResult:
    """A bake of the second frame alone."""
    return bake(FRAMES[name][1], replace(COARSE, output=output), keep_rays=True)


@pytest.mark.parametrize("name, output", [*((name, "ORIGINAL") for name in FRAMES), *((n, "REFINED") for n in REFINED)])
def test_the_light_is_that_of_a_bake_of_the_frame_alone_and_fewer_rays_are_traced(name, output):
    fresh = fresh_bake(name, output)
    found = bake(FRAMES[name][1], replace(COARSE, output=output), before=kept_of(name, output))
    assert same_bytes(found, fresh)
    assert found.report["rays"] < fresh.report["rays"]
    assert found.report["rays"] + found.report["rays_known"] == fresh.report["rays"]


def traced(result: BakeResult) -> int:
    """Rays that were traced, but for those that find the sides that light reaches: they go one by one."""
    return result.report["rays"] - result.report["rays_by_kind"]["walks"]


def test_at_most_half_of_the_rays_are_traced_where_a_small_thing_moves():
    name = "a cube moves"
    found = bake(FRAMES[name][1], COARSE, before=kept_of(name))
    assert traced(found) <= 0.5 * traced(fresh_bake(name))


def test_where_nothing_moved_all_rows_are_known():
    found = bake(furnished(), COARSE, before=kept_of("a cube moves"))
    # A few rays are in no rows.
    assert traced(found) <= 0.05 * found.report["rays_known"]


def test_what_is_kept_through_two_frames_is_known_in_the_third():
    first, second = FRAMES["a cube moves"]
    rays = kept_of("a cube moves")
    again = bake(second, COARSE, before=rays, keep_rays=True).kept_rays
    third = with_mesh(first, "cube", shifted(0.53, -0.21, 0.0))
    found = bake(third, COARSE, before=again)
    assert same_bytes(found, bake(third, COARSE, keep_rays=True))
    assert found.report["rays_known"] > traced(found)


def test_the_result_and_the_counts_do_not_depend_on_the_threads():
    first, second = FRAMES["a cube moves"]

    def after(threads):
        settings = replace(COARSE, threads=threads, output="ORIGINAL")
        return bake(second, settings, before=bake(first, settings, keep_rays=True).kept_rays)

    one, three = after(1), after(3)
    assert same_bytes(one, three)
    assert one.report["rays_known"] == three.report["rays_known"]


def test_other_settings_know_of_each_other_no_more_than_rays_that_are_the_same():
    rays = kept_of("a cube moves")
    for settings in (replace(COARSE, seed=1), replace(COARSE, threshold=0.1)):
        assert same_bytes(bake(furnished(), settings, before=rays), bake(furnished(), settings, keep_rays=True))


def test_what_leaves_the_coordinates_has_all_rays_traced():
    rays = kept_of("a cube moves in the sun")
    far = with_mesh(open_scene(), "cube", shifted(6.0, 0.0, 0.0))
    found = bake(far, COARSE, before=rays)
    assert found.report["rays_known"] == 0
    assert same_bytes(found, bake(far, COARSE, keep_rays=True))


def test_what_moves_within_the_coordinates_leaves_them_as_they_are():
    # The highest thing that there is goes up and down, as a ball does that is bounced.
    high = with_mesh(open_scene(), "cube", shifted(0.0, 0.0, 0.5))
    rays = kept_of("a cube moves in the sun")
    found, fresh = bake(high, COARSE, before=rays, keep_rays=True), bake(high, COARSE, keep_rays=True)
    assert found.report["rays_known"] > traced(found) / 3
    assert (found.kept_rays.centre == rays.centre).all()
    for one, other in zip(found.meshes, fresh.meshes, strict=True):
        assert one.radiosity.mean() == pytest.approx(other.radiosity.mean(), rel=0.01)


def test_nothing_is_kept_where_it_is_more_than_its_share_of_the_memory(monkeypatch):
    kept = kept_of("a cube moves")
    monkeypatch.setattr(bake_module, "KEPT_RAYS_SHARE", 0.5 * kept.bytes() / (COARSE.memory_limit * 2**20))
    assert bake(furnished(), COARSE, keep_rays=True).kept_rays is None


def test_a_frame_is_as_good_as_an_ordinary_bake():
    frame, ordinary = fresh_bake("a cube moves"), bake(FRAMES["a cube moves"][1], COARSE)
    # Over eight seeds the mean has a standard deviation of 0.33%, the difference of two 0.47%: three of these.
    assert mean_over(frame.meshes) == pytest.approx(mean_over(ordinary.meshes), rel=0.015)


def test_nothing_is_kept_unless_it_is_asked_for():
    assert bake(room_with_block(), COARSE).kept_rays is None


def test_a_bake_that_is_cancelled_leaves_what_was_kept_as_it_was():
    second, rays = FRAMES["a cube moves"][1], kept_of("a cube moves")

    def stop(message):
        if message.stage == "Gathering":
            raise Cancelled

    with pytest.raises(Cancelled):
        bake(second, COARSE, stop, before=rays, keep_rays=True)
    assert same_bytes(bake(second, COARSE, before=rays), fresh_bake("a cube moves"))


# ------------------------------------------------------------------------------------------- at the door of the rays


def many_triangles(seed: int, count: int = 200) -> np.ndarray:
    """Corners of random triangles in a cube, (count, 3, 3)."""
    drawn = np.random.default_rng(seed)
    return drawn.random((count, 1, 3)) + 0.2 * drawn.random((count, 3, 3))


def ray_scene(corners: np.ndarray, before: KeptRays | None = None) -> RayScene:
    return RayScene(
        corners.reshape(-1, 3), np.arange(3 * len(corners)).reshape(-1, 3), 1, before=before, most_kept=2**24
    )


def rays_of_rows(seed: int = 0) -> tuple[np.ndarray, np.ndarray]:
    """Origins of rows (n, 3) and directions (n, r, 3), from within the cube."""
    drawn = np.random.default_rng(seed)
    directions = drawn.normal(size=(ROWS, EACH, 3))
    return (drawn.random((ROWS, 3)) - 0.5).astype(np.float32), (0.3 * directions).astype(np.float32)


CHANGED_TRIANGLES = {
    "none": lambda corners: corners,
    "some moved": lambda corners: np.concatenate([corners[:190], corners[190:] + [0.05, 0.1, 0.0]]),
    "most moved": lambda corners: np.concatenate([corners[:10], corners[10:] * [1.0, 0.9, 1.0]]),
    "all moved": lambda corners: corners * [1.0, 0.9, 1.0],
    "some gone": lambda corners: corners[20:],
    "in another order": lambda corners: corners[::-1],
    "more": lambda corners: np.concatenate([corners, 0.3 + 0.5 * many_triangles(7, 40)]),
}


@pytest.mark.parametrize("change", CHANGED_TRIANGLES)
def test_known_rays_meet_what_traced_ones_meet(change):
    corners = many_triangles(1)
    # Two far ones, so that all scenes have the same coordinates.
    ends = np.stack([np.zeros((3, 3)), np.full((3, 3), 1.3)])
    earlier = ray_scene(np.concatenate([ends, corners]))
    later = np.concatenate([ends, CHANGED_TRIANGLES[change](corners)])
    origins, directions = rays_of_rows()
    starts, ways = np.repeat(origins, EACH, axis=0), directions.reshape(-1, 3)
    earlier.first_hits(starts, ways, each=EACH)
    earlier.visible(origins, directions)
    rays = earlier.kept()
    known, fresh = ray_scene(later, rays), ray_scene(later)
    for name in ("triangle", "u", "v", "distance", "back"):
        one, other = (getattr(scene.first_hits(starts, ways, each=EACH), name) for scene in (known, fresh))
        np.testing.assert_array_equal(one, other, err_msg=name)
    np.testing.assert_array_equal(known.visible(origins, directions), fresh.visible(origins, directions))
    assert known.rays + known.known == fresh.rays
    assert known.known > 0
    if change in ("none", "in another order"):
        assert known.rays == 0


def test_triangles_in_one_place_are_told_apart_by_their_order():
    one, two, three = (np.full((3, 3), k, dtype=np.float32) for k in (1, 2, 3))
    changes = Changes.between(np.stack([one, two, one, one]), np.stack([three, one, two, one]))
    np.testing.assert_array_equal(changes.now, [1, 2, 3, MOVED])
    np.testing.assert_array_equal(changes.gone, [3])
    np.testing.assert_array_equal(changes.came, [0])


def test_rows_that_differ_in_the_signs_of_their_directions_are_different():
    origins, directions = rays_of_rows()
    scene = ray_scene(many_triangles(1))
    scene.visible(origins, directions)
    mirrored = [directions * signs for signs in ([-1, 1, 1], [1, -1, 1], [1, 1, -1], [-1, -1, -1])]
    again = ray_scene(many_triangles(1), scene.kept())
    for ways in mirrored:
        again.visible(origins, ways.astype(np.float32))
    assert again.known == 0


def test_too_many_rows_are_not_kept_whichever_comes_first():
    keys, answers = np.zeros(2, np.uint64), np.zeros((2, 8), np.int32)
    room = keys.nbytes + answers.nbytes
    for most, too_many in ((2 * room, False), (2 * room - 1, True)):
        rows = RowsToKeep(most)
        for _ in range(2):
            rows.add("hits", 8, keys, answers)
        assert rows.are_too_many == too_many


def test_a_scene_without_light_for_rays_keeps_none():
    # One triangle, which sees nothing: there are rows, and all left the scene.
    lone = exact.rectangle("floor", (0, 0, 0), (1, 0, 0), (0, 1, 0), reflectance=0.5)
    scene = Scene((lone,), np.ones(3))
    rays = bake(scene, COARSE, keep_rays=True).kept_rays
    moved = Scene((replace(lone, vertices=lone.vertices + [0, 0, 0.5]),), DARK + 1.0)
    assert same_bytes(bake(moved, COARSE, before=rays), bake(moved, COARSE, keep_rays=True))
