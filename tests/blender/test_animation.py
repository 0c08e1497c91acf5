# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""A range of frames: what is traced, what is only lit again, where the light is kept, and that nothing else changes."""

import json
import time
from pathlib import Path

import bpy
import numpy as np
import pytest
from radiosity_bake.core.errors import UnsolvableError
from radiosity_bake.core.settings import BakeSettings
from radiosity_bake.operators.animation import RADIOSITY_OT_bake_frames, bake_frames
from radiosity_bake.operators.command import main
from radiosity_bake.operators.restore import restore

from tests.blender.making import (
    add_cube,
    add_object,
    add_plane,
    bake_selected,
    colours_of,
    diffuse_material,
    position_bake,
    report,
    select_also,
)
from tests.blender.state import differences, file_state
from tests.blender.test_modal import ESC, MOUSE, TIMER, assert_left, begun, until_it_ends

ROUNDING = 1e-5
"""Of the largest value, as in the tests of relighting."""


@pytest.fixture
def room():
    """A floor below a box and a lamp whose colour goes from red to blue over the frames 1 to 3, at frame 2."""
    floor = add_plane("Floor", materials=[diffuse_material("Boards", (0.7, 0.6, 0.5, 1.0))])
    floor.scale = (3.0, 3.0, 1.0)
    box = add_cube("Box", materials=[diffuse_material("Paint", (0.2, 0.6, 0.7, 1.0))])
    box.location, box.scale = (0.5, 0.3, 0.6), (0.4, 0.5, 0.5)
    light = bpy.data.lights.new("Lamp", "POINT")
    light.energy = 100.0
    add_object("Lamp", light).location = (0.3, -0.4, 2.5)
    for frame, colour in ((1, (1.0, 0.2, 0.2)), (3, (0.2, 0.2, 1.0))):
        light.color = colour
        light.keyframe_insert("color", frame=frame)
    select_also(box, floor)
    scene = bpy.context.scene
    scene.frame_start, scene.frame_end = 1, 3
    scene.frame_set(2)
    scene.radiosity.quality, scene.radiosity.minimum_size, scene.radiosity.output = "DRAFT", 0.8, "ORIGINAL"
    return floor, box


def move_the_box(box):
    """Have the box stand elsewhere at frame 3 than at frames 1 and 2."""
    for frame, x in ((1, 0.5), (2, 0.5), (3, -0.8)):
        box.location.x = x
        box.keyframe_insert("location", frame=frame)
    bpy.context.scene.frame_set(2)


def bake_range(frame_output="ATTRIBUTES"):
    assert bpy.ops.radiosity.bake_frames(frame_output=frame_output) == {"FINISHED"}
    return [frame["traced"] for frame in report()["frames"]]


def fresh(floor, frame):
    """The floor's radiosity of an ordinary bake at a frame."""
    bpy.context.scene.frame_set(frame)
    bake_selected()
    return colours_of(floor.data)


def alone(floor, frame):
    """The floor's radiosity of a range of one frame."""
    scene = bpy.context.scene
    scene.frame_start, scene.frame_end = frame, frame
    bake_range()
    return colours_of(floor.data)


def test_a_lamp_that_changes_colour_is_traced_once_and_lit_like_fresh_bakes(room):
    floor, _ = room
    assert bake_range() == [True, False, False]
    sets = {frame: colours_of(floor.data, f"Radiosity.{frame:04d}") for frame in (1, 2, 3)}
    assert not np.allclose(sets[1], sets[3])
    for frame, values in sets.items():
        expected = fresh(floor, frame)
        assert np.abs(values - expected).max() <= ROUNDING * expected.max()


def test_an_object_that_moves_is_traced_again(room):
    floor, box = room
    move_the_box(box)
    assert bake_range() == [True, False, True]
    values = colours_of(floor.data, "Radiosity.0003")
    np.testing.assert_array_equal(values, alone(floor, 3))


def rays_of_frames():
    return [(frame["rays"], frame["rays_known"]) for frame in report()["frames"]]


def test_rays_are_traced_again_where_an_object_moved_and_not_elsewhere(room):
    floor, box = room
    move_the_box(box)
    bake_range()
    (_, none), relit, (again, known) = rays_of_frames()
    assert none == 0
    assert relit == (0, 0)
    assert known > 0
    alone(floor, 3)
    assert again + known == report()["rays"]


def test_a_lamp_that_moves_leaves_what_rays_between_surfaces_meet(room):
    floor, _ = room
    lamp = bpy.data.objects["Lamp"]
    for frame, x in ((1, 0.3), (2, 0.5), (3, 0.7)):
        lamp.location.x = x
        lamp.keyframe_insert("location", frame=frame)
    assert bake_range() == [True, True, True]
    values, last = colours_of(floor.data, "Radiosity.0003"), report()["frames"][2]
    np.testing.assert_array_equal(values, alone(floor, 3))
    rays = report()["rays_by_kind"]
    # None of the patches' rays to each other are traced.
    assert last["rays"] <= sum(rays.values()) - rays["form_factors"]


def test_a_camera_and_an_empty_that_move_are_nothing_that_moves(room):
    for name, data in (("Eye", bpy.data.cameras.new("Eye")), ("Axes", None)):
        thing = add_object(name, data)
        for frame in (1, 2, 3):
            thing.location.x = frame
            thing.keyframe_insert("location", frame=frame)
    assert bake_range() == [True, False, False]


def test_where_what_rays_met_is_too_much_to_keep_a_sentence_says_so(room, monkeypatch):
    _, box = room
    move_the_box(box)
    monkeypatch.setattr("radiosity_bake.core.bake.KEPT_RAYS_SHARE", 1e-6)
    bake_range()
    assert rays_of_frames()[2][1] == 0
    assert [text for text in report()["warnings"] if "traced anew at each frame" in text]


def test_the_frame_that_the_scene_is_at_is_shown(room):
    floor, _ = room
    bpy.context.scene.frame_set(2, subframe=0.25)
    bake_range()
    assert (bpy.context.scene.frame_current, bpy.context.scene.frame_subframe) == (2, 0.25)
    assert floor.data.color_attributes.active_color_name == "Radiosity"
    for name in ("Radiosity", "Irradiance"):
        np.testing.assert_array_equal(colours_of(floor.data, name), colours_of(floor.data, f"{name}.0002"))


@pytest.mark.parametrize("output", ["ORIGINAL", "REFINED"])
def test_restore_leaves_everything_as_before(room, output):
    bpy.context.scene.radiosity.output = output
    before = file_state()["objects"], file_state()["meshes"]
    bake_range()
    restore(room, bpy.context.view_layer)
    assert not differences(before[0], file_state()["objects"])
    assert not differences(before[1], file_state()["meshes"])


def test_refined_meshes_carry_all_frames_while_nothing_moves(room):
    bpy.context.scene.radiosity.output = "REFINED"
    assert bake_range() == [True, False, False]
    mesh = bpy.data.objects["Floor Radiosity"].data
    np.testing.assert_array_equal(colours_of(mesh), colours_of(mesh, "Radiosity.0002"))
    assert not np.allclose(colours_of(mesh, "Radiosity.0001"), colours_of(mesh, "Radiosity.0003"))


def test_refined_meshes_that_differ_from_frame_to_frame_are_refused_before_a_ray_is_traced(room, quick_bake):
    move_the_box(room[1])
    bpy.context.scene.radiosity.output = "REFINED"
    before = file_state()
    with pytest.raises(
        RuntimeError, match=r'Frame 3: "Box" moved or changed its shape since frame 1; .* Original Mesh'
    ):
        bake_range()
    assert not quick_bake
    assert not differences(before, file_state())
    assert bpy.context.scene.frame_current == 2


def test_what_is_hidden_at_a_frame_is_refused_for_refined_meshes_before_a_ray_is_traced(room, quick_bake):
    for frame, hidden in ((1, False), (3, True)):
        room[1].hide_render = hidden
        room[1].keyframe_insert("hide_render", frame=frame)
    bpy.context.scene.radiosity.output = "REFINED"
    with pytest.raises(RuntimeError, match="Frame 3: objects or lamps were added, removed or hidden since frame 1"):
        bpy.ops.radiosity.bake_frames()
    assert not quick_bake


def switched(name, *energies):
    """Have a lamp of these powers at the frames 1, 2, 3 beside the room's."""
    light = bpy.data.lights.get(name) or bpy.data.lights.new(name, "POINT")
    if name not in bpy.data.objects:
        add_object(name, light).location = (-1.0, 0.5, 2.0)
    for frame, energy in enumerate(energies, 1):
        light.energy = energy
        light.keyframe_insert("energy", frame=frame)
    bpy.context.scene.frame_set(2)


@pytest.mark.parametrize("output", ["ORIGINAL", "REFINED"])
@pytest.mark.parametrize("dark", [(1,), (2,), (3,), (1, 2)])
def test_a_frame_without_light_is_black_and_the_others_are_as_ever(room, output, dark):
    floor, _ = room
    bpy.context.scene.radiosity.output = output
    switched("Lamp", *(0.0 if frame in dark else 100.0 for frame in (1, 2, 3)))
    assert sum(bake_range()) == 1
    told = report()
    assert [frame["frame"] for frame in told["frames"] if frame["dark"]] == list(dark)
    assert [warning for warning in told["warnings"] if "Nothing emits light at frame" in warning]
    mesh = floor.data if output == "ORIGINAL" else bpy.data.objects["Floor Radiosity"].data
    for frame in (1, 2, 3):
        values = colours_of(mesh, f"Radiosity.{frame:04d}")
        assert values[:, :3].any() == (frame not in dark)
    np.testing.assert_array_equal(colours_of(mesh), colours_of(mesh, "Radiosity.0002"))


def test_a_dark_frame_and_one_with_a_dark_light_group_have_all_attributes_of_the_others(room):
    bpy.context.view_layer.lightgroups.add(name="Key")
    switched("Other", 0.0, 0.0, 80.0)
    bpy.data.objects["Other"].lightgroup = "Key"
    settings = bpy.context.scene.radiosity
    settings.light_groups, settings.data_type = True, "BYTE"
    switched("Lamp", 0.0, 100.0, 100.0)
    bake_range()
    names = [attribute.name.rpartition(".") for attribute in room[0].data.color_attributes]
    of_frames = [{name for name, _, frame in names if frame == number} for number in ("0001", "0002", "0003")]
    assert of_frames[0] == of_frames[1] == of_frames[2] and {"Radiosity Key", "Radiosity Ungrouped"} <= of_frames[0]


@pytest.mark.parametrize("output", ["ORIGINAL", "REFINED"])
@pytest.mark.parametrize("maximum", [0.0, 0.5])
def test_bytes_of_all_frames_have_one_exposure(room, output, maximum):
    switched("Lamp", 100.0, 50.0, 200.0)
    settings = bpy.context.scene.radiosity
    settings.output = output
    bake_range()
    name = "Floor" if output == "ORIGINAL" else "Floor Radiosity"
    floats = {frame: colours_of(bpy.data.objects[name].data, f"Radiosity.{frame:04d}") for frame in (1, 2, 3)}
    brightest = max(
        colours_of(obj.data, "Radiosity.0003")[:, :3].max()
        for obj in bpy.context.scene.objects
        if obj.type == "MESH" and "Radiosity.0003" in obj.data.color_attributes
    )
    settings.data_type, settings.byte_maximum = "BYTE", maximum
    bake_range()
    mesh = bpy.data.objects[name].data
    assert {attribute.data_type for attribute in mesh.color_attributes} == {"BYTE_COLOR"}
    exposure = report()["exposure"]["Radiosity"]
    assert exposure["maximum"] == pytest.approx(maximum or brightest, rel=1e-6)
    assert (exposure["clipped"] > 0) == (maximum > 0.0)
    for frame, values in floats.items():
        # Half a step of 8 bits in sRGB is at most 0.0046 in linear light, where it is steepest.
        expected = np.clip(values[:, :3] / exposure["maximum"], 0.0, 1.0)
        np.testing.assert_allclose(colours_of(mesh, f"Radiosity.{frame:04d}")[:, :3], expected, atol=0.0046)
    np.testing.assert_array_equal(colours_of(mesh), colours_of(mesh, "Radiosity.0002"))


@pytest.mark.parametrize("maximum", [0.0, 2.0])
def test_files_of_bytes_with_exposures_of_their_own_are_warned_of(room, tmp_path, monkeypatch, maximum):
    settings = bpy.context.scene.radiosity
    settings.data_type, settings.byte_maximum = "BYTE", maximum
    saved(tmp_path, monkeypatch)
    bake_range("FILES")
    assert any("an exposure of their own" in warning for warning in report()["warnings"]) == (maximum == 0.0)


@pytest.mark.skipif(bpy.app.version >= (5, 0, 0), reason="names may be of any length there")
def test_a_name_that_only_the_frame_makes_too_long_is_refused_before_a_ray_is_traced(room, quick_bake):
    bpy.context.view_layer.lightgroups.add(name="k" * 50)
    bpy.data.objects["Lamp"].lightgroup = "k" * 50
    bpy.context.scene.radiosity.light_groups = True
    assert bpy.ops.radiosity.bake() == {"FINISHED"}
    quick_bake.clear()
    with pytest.raises(RuntimeError, match=r"kkk Back\.0001.*shorten the prefix or the name of the light group"):
        bake_range()
    assert not quick_bake


def test_each_dark_frame_has_a_file_once_another_has_light(room, tmp_path, monkeypatch):
    switched("Lamp", 0.0, 100.0, 0.0)
    bpy.context.scene.radiosity.output = "REFINED"
    saved(tmp_path, monkeypatch)
    assert sum(bake_range("FILES")) == 1
    for frame in (1, 2, 3):
        bpy.ops.wm.open_mainfile(filepath=str(tmp_path / f"room_{frame:04d}.blend"))
        values = colours_of(bpy.data.objects["Floor Radiosity"].data)
        assert values[:, :3].any() == (frame == 2)


@pytest.mark.parametrize("output", ["ORIGINAL", "REFINED"])
@pytest.mark.parametrize("frame_output", ["ATTRIBUTES", "FILES"])
def test_a_range_of_darkness_is_a_mistake_and_nothing_is_written(room, tmp_path, monkeypatch, output, frame_output):
    switched("Lamp", 0.0, 0.0, 0.0)
    bpy.context.scene.radiosity.output = output
    saved(tmp_path, monkeypatch)
    with pytest.raises(RuntimeError, match="Frames 1 to 3: Nothing in the scene emits light"):
        bake_range(frame_output)
    assert [path.name for path in tmp_path.iterdir()] == ["room.blend"]
    assert not room[0].data.color_attributes


def test_refined_meshes_are_traced_at_the_frame_that_has_all_lights_on(room):
    switched("Lamp", 100.0, 100.0, 0.0)
    switched("Other", 0.0, 80.0, 80.0)
    bpy.context.scene.radiosity.output = "REFINED"
    assert bake_range() == [False, True, False]
    mesh = bpy.data.objects["Floor Radiosity"].data
    assert all(colours_of(mesh, f"Radiosity.{frame:04d}")[:, :3].any() for frame in (1, 2, 3))


def test_refined_meshes_of_frames_with_other_lights_on_are_refused_before_a_ray_is_traced(room, quick_bake):
    switched("Lamp", 100.0, 100.0, 0.0)
    switched("Other", 0.0, 0.0, 80.0)
    bpy.context.scene.radiosity.output = "REFINED"
    with pytest.raises(RuntimeError, match='"Other" shines at frame 3 and not at frame 1'):
        bpy.ops.radiosity.bake_frames()
    assert not quick_bake


def test_refined_meshes_are_refused_where_the_first_frame_could_not_be_kept(room):
    bpy.context.scene.radiosity.output = "REFINED"
    bpy.context.scene.radiosity.memory_limit = 64
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("radiosity_bake.core.relight.size_of", lambda _: 2**40)
        with pytest.raises(RuntimeError, match=r"Frame 2: .* larger than the memory limit of 64 MiB"):
            bake_range()


def failing_at_the_third(bakes=2):
    """Return a bake without rays that fails when it was done so often."""
    done = []

    def bake(scene, settings, progress, **_):
        if len(done) == bakes:
            raise UnsolvableError("Light is trapped")
        done.append(scene)
        return position_bake(scene, settings, progress)

    return bake


def test_an_error_names_its_frame_and_changes_nothing(room, run_instead):
    run_instead(failing_at_the_third())
    before = file_state()
    with pytest.raises(RuntimeError, match=r"Frame 3: Light is trapped$"):
        bake_range()
    assert not differences(before, file_state())


def test_an_error_tells_of_the_files_that_were_written_before(room, run_instead, tmp_path, monkeypatch, capsys):
    run_instead(failing_at_the_third())
    saved(tmp_path, monkeypatch)
    assert main(["--frames", "1:3", "--frames-to", "FILES", "--output", "baked.blend"]) == 1
    assert "Frame 3: Light is trapped; 2 files of frames before were written" in capsys.readouterr().err
    assert sorted(path.name for path in tmp_path.iterdir()) == ["baked_0001.blend", "baked_0002.blend", "room.blend"]


def test_ctrl_c_tells_of_the_files_that_were_written_before(room, run_instead, tmp_path, monkeypatch, capsys):
    done = []

    def interrupted(*arguments, **_):
        if done:
            raise KeyboardInterrupt
        done.append(arguments)
        return position_bake(*arguments)

    run_instead(interrupted)
    saved(tmp_path, monkeypatch)
    assert main(["--frames", "1:3", "--frames-to", "FILES", "--output", "baked.blend"]) == 1
    assert "cancelled; 1 file of frames before was written" in capsys.readouterr().err


def test_a_shorter_range_and_an_ordinary_bake_leave_no_sets_of_an_earlier_one(room):
    floor, _ = room
    bake_range()
    bpy.context.scene.frame_end = 2
    bake_range()
    names = {attribute.name for attribute in floor.data.color_attributes}
    assert names == {f"{name}{end}" for name in ("Radiosity", "Irradiance") for end in ("", ".0001", ".0002")}
    bake_selected()
    assert {attribute.name for attribute in floor.data.color_attributes} == {"Radiosity", "Irradiance"}


@pytest.mark.usefixtures("quick_bake")
def test_frames_before_zero_are_baked_and_restored_as_others(room):
    floor, _ = room
    settings = BakeSettings(output="ORIGINAL")
    bake_frames(bpy.context, room, settings, range(-1, 1))
    assert {"Radiosity.-001", "Radiosity.0000"} <= {attribute.name for attribute in floor.data.color_attributes}
    bake_frames(bpy.context, room, settings, range(1))
    assert "Radiosity.-001" not in floor.data.color_attributes
    restore(room, bpy.context.view_layer)
    assert not floor.data.color_attributes


def test_an_attribute_of_the_artists_with_the_name_of_a_set_comes_back(room):
    floor, _ = room
    floor.data.color_attributes.new("Radiosity.0002", "FLOAT_COLOR", "POINT")
    bake_range()
    assert floor.data.color_attributes["Radiosity.0002"].domain == "CORNER"
    restore(room, bpy.context.view_layer)
    assert floor.data.color_attributes["Radiosity.0002"].domain == "POINT"


def test_the_last_bake_can_be_relit_afterwards(room):
    bake_range()
    bpy.data.lights["Lamp"].animation_data_clear()
    bpy.data.lights["Lamp"].color = (0.0, 1.0, 0.0)
    assert bpy.ops.radiosity.relight() == {"FINISHED"}


def test_progress_counts_over_all_frames(room):
    told = []
    settings = BakeSettings(quality="DRAFT", minimum_size=0.8, output="ORIGINAL")
    bake_frames(bpy.context, room, settings, range(1, 3), progress=told.append)
    shares = [message.share for message in told]
    assert shares == sorted(shares) and 0.0 <= shares[0] < 0.1 and shares[-1] == pytest.approx(1.0)
    assert told[0].stage.startswith("Frame 1: ") and told[-1].stage.startswith("Frame 2: ")


def saved(tmp_path, monkeypatch):
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "room.blend"))
    monkeypatch.chdir(tmp_path)


def test_each_frame_can_have_a_file_of_its_own(room, tmp_path, monkeypatch):
    move_the_box(room[1])
    bpy.context.scene.radiosity.output = "REFINED"
    saved(tmp_path, monkeypatch)
    assert bake_range("FILES") == [True, False, True]
    assert bpy.context.scene.frame_current == 2
    shown = colours_of(bpy.data.objects["Floor Radiosity"].data)
    for frame in (1, 2, 3):
        bpy.ops.wm.open_mainfile(filepath=str(tmp_path / f"room_{frame:04d}.blend"))
        assert bpy.context.scene.frame_current == frame
        mesh = bpy.data.objects["Floor Radiosity"].data
        assert {attribute.name for attribute in mesh.color_attributes} == {"Radiosity", "Irradiance"}
        if frame == 2:
            np.testing.assert_array_equal(colours_of(mesh), shown)


def test_a_library_is_not_written_over_by_a_frame(room, tmp_path):
    library = tmp_path / "room_0002.blend"
    bpy.ops.wm.save_as_mainfile(filepath=str(library), copy=True)
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "room.blend"))
    with bpy.data.libraries.load(str(library), link=True) as (_, wanted):
        wanted.materials = ["Paint"]
    before = library.read_bytes()
    with pytest.raises(RuntimeError, match=r"room_0002\.blend would replace a file that the scene is read from"):
        bake_range("FILES")
    assert library.read_bytes() == before
    assert not (tmp_path / "room_0001.blend").exists()


def test_files_of_frames_need_a_file_to_lie_beside(room):
    with pytest.raises(RuntimeError, match="Save the file first"):
        bake_range("FILES")


def test_the_command_bakes_a_range_into_one_file(room, tmp_path, monkeypatch, capsys):
    saved(tmp_path, monkeypatch)
    assert main(["--frames", "1:2", "--output", "baked.blend", "--report", "report.json"]) == 0
    assert "2 frames" in capsys.readouterr().out
    frames = json.loads(Path("report.json").read_text())["frames"]
    assert [(frame["frame"], frame["traced"]) for frame in frames] == [(1, True), (2, False)]
    bpy.ops.wm.open_mainfile(filepath=str(tmp_path / "baked.blend"))
    names = {attribute.name for attribute in bpy.data.objects["Floor"].data.color_attributes}
    assert {"Radiosity.0001", "Radiosity.0002"} <= names


@pytest.mark.usefixtures("quick_bake")
def test_the_command_writes_a_file_for_each_frame(room, tmp_path, monkeypatch):
    saved(tmp_path, monkeypatch)
    assert main(["--frames", "1:2", "--frames-to", "FILES", "--output", "baked.blend"]) == 0
    assert sorted(path.name for path in tmp_path.iterdir()) == ["baked_0001.blend", "baked_0002.blend", "room.blend"]


@pytest.mark.usefixtures("quick_bake")
def test_the_command_takes_frames_before_zero(room, tmp_path, monkeypatch):
    saved(tmp_path, monkeypatch)
    assert main(["--frames", "-1:0", "--frames-to", "FILES", "--output", "baked.blend"]) == 0
    assert sorted(path.name for path in tmp_path.iterdir()) == ["baked_-001.blend", "baked_0000.blend", "room.blend"]


@pytest.mark.parametrize(("frames", "sentence"), [("1-3", "not a range"), ("3:1", "empty")])
def test_the_command_refuses_what_is_no_range(room, tmp_path, monkeypatch, capsys, frames, sentence):
    saved(tmp_path, monkeypatch)
    assert main(["--frames", frames, "--output", "baked.blend"]) == 1
    assert sentence in capsys.readouterr().err
    assert [path.name for path in tmp_path.iterdir()] == ["room.blend"]


# ---------------------------------------------------------------------------------------------------------------------
# From the window


def begun_frames():
    return begun(RADIOSITY_OT_bake_frames, frame_output="ATTRIBUTES")


def test_from_the_window_frames_are_baked_one_after_the_other(room):
    floor, _ = room
    operator, window = begun_frames()
    assert operator.modal(window, MOUSE) == {"PASS_THROUGH"}
    assert until_it_ends(operator, window) == {"FINISHED"}
    assert_left(window)
    assert [frame["traced"] for frame in report()["frames"]] == [True, False, False]
    assert "Radiosity.0003" in floor.data.color_attributes
    assert bpy.context.scene.frame_current == 2


def test_esc_leaves_the_frames_and_changes_nothing(room):
    before = file_state()
    operator, window = begun_frames()
    assert operator.modal(window, ESC) == {"CANCELLED"}
    assert_left(window)
    assert not differences(before, file_state())
    assert bpy.context.scene.frame_current == 2


@pytest.mark.usefixtures("quick_bake")
def test_a_frame_that_ends_in_edit_mode_waits_until_the_mode_is_left(room):
    floor, _ = room
    operator, window = begun_frames()
    bpy.ops.object.mode_set(mode="EDIT")
    began = time.monotonic()
    while "Leave edit mode to go on with the frames" not in (window.status or ""):
        assert operator.modal(window, TIMER) == {"PASS_THROUGH"}
        assert time.monotonic() - began < 10.0
        time.sleep(0.01)
    bpy.ops.object.mode_set(mode="OBJECT")
    assert until_it_ends(operator, window) == {"FINISHED"}
    assert "Radiosity.0003" in floor.data.color_attributes


def test_an_error_from_the_window_is_told_with_its_frame(room):
    bpy.data.lights["Lamp"].energy = 0.0
    operator, window = begun_frames()
    assert until_it_ends(operator, window) == {"CANCELLED"}
    assert_left(window)
    ((kind, sentence),) = operator.reports
    assert kind == "ERROR" and sentence.startswith("Frames 1 to 3: Nothing in the scene emits light")
