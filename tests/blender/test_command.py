# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The shell command: its files, its exit codes and its sentences."""

import json
import subprocess
import sys
from pathlib import Path

import bpy
import pytest
from radiosity_bake.core.settings import BakeSettings
from radiosity_bake.operators import command
from radiosity_bake.operators.command import main
from radiosity_bake.operators.settings import bake_settings

from tests.blender.making import add_cube, add_lamp_mesh, add_object, add_plane, colours_of, dark_bake

ROOT = Path(__file__).resolve().parents[2]


@pytest.fixture
def room(tmp_path, monkeypatch):
    """Save a small lit scene as room.blend in a folder of its own, go there, and open it."""
    add_cube()
    add_plane("Floor").location.z = -1.0
    add_lamp_mesh()
    path = tmp_path / "room.blend"
    bpy.ops.wm.save_as_mainfile(filepath=str(path))
    monkeypatch.chdir(tmp_path)
    return path


def names():
    return sorted(path.name for path in Path().iterdir())


def opened(path):
    bpy.ops.wm.open_mainfile(filepath=str(Path(path).resolve()))
    return bpy.data.objects


@pytest.mark.usefixtures("quick_bake")
def test_all_meshes_that_render_are_baked_into_another_file(room, capsys):
    before = room.read_bytes()
    assert main(["--output", "baked.blend", "--report", "room.json"]) == 0
    assert room.read_bytes() == before
    assert names() == ["baked.blend", "room.blend", "room.json"]
    report = json.loads(Path("room.json").read_text())
    assert report["objects"] == ["Cube Radiosity", "Floor Radiosity", "Lamp Mesh Radiosity"]
    objects = opened("baked.blend")
    assert len(colours_of(objects["Cube Radiosity"].data)) == 72
    output = capsys.readouterr().out
    assert " 25%  Form factors: no rays at all" in output
    assert "Baked 3 objects" in output


@pytest.mark.usefixtures("quick_bake")
@pytest.mark.parametrize("mode", ["EDIT", "SCULPT", "VERTEX_PAINT"])
def test_a_file_that_was_saved_in_another_mode_is_baked(room, mode):
    bpy.context.view_layer.objects.active = bpy.data.objects["Cube"]
    bpy.ops.object.mode_set(mode=mode)
    bpy.ops.wm.save_mainfile()
    assert main(["--output", "baked.blend"], str(room)) == 0
    assert "Cube Radiosity" in opened("baked.blend")


@pytest.mark.usefixtures("quick_bake")
def test_only_the_objects_asked_for_are_baked(room):
    assert main(["--output", "baked.blend", "--object", "Cube", "--object", "Floor"]) == 0
    assert {name for name in opened("baked.blend").keys() if "Radiosity" in name} == {  # noqa: SIM118
        "Cube Radiosity",
        "Floor Radiosity",
    }


def test_settings_come_from_the_options_and_else_from_the_file(room, quick_bake):
    bpy.context.scene.radiosity.seed = 11
    options = "--output b.blend --threshold 0.05 --minimum-size 0.1 --quality HIGH --method UNIFORM --bake-to ORIGINAL"
    assert main([*options.split(), "--threads", "1", "--memory-limit", "256", "--patch-limit", "999"]) == 0
    ((_, settings),) = quick_bake
    assert (settings.threshold, settings.minimum_size, settings.seed) == (0.05, 0.1, 11)
    assert (settings.quality, settings.method, settings.output) == ("HIGH", "UNIFORM", "ORIGINAL")
    assert (settings.threads, settings.memory_limit, settings.patch_limit) == (1, 256, 999)


@pytest.mark.usefixtures("quick_bake")
def test_the_output_keeps_the_settings_that_it_was_baked_with(room):
    options = "--threshold 0.05 --minimum-size 0.1 --quality HIGH --method UNIFORM --bake-to ORIGINAL --seed 7"
    assert main(["--output", "baked.blend", *options.split(), "--threads", "1", "--memory-limit", "256"]) == 0
    opened("baked.blend")
    assert bake_settings(bpy.context.scene.radiosity) == BakeSettings(
        0.05, 0.1, "UNIFORM", "HIGH", "ORIGINAL", seed=7, threads=1, memory_limit=256
    )
    opened(room)
    assert bake_settings(bpy.context.scene.radiosity) == BakeSettings()


@pytest.mark.usefixtures("quick_bake")
def test_the_input_is_overwritten_only_when_asked(room, capsys):
    before = room.read_bytes()
    assert main(["--output", "room.blend"]) == 1
    assert "--overwrite" in capsys.readouterr().err
    assert room.read_bytes() == before
    assert main(["--output", "room.blend", "--overwrite"]) == 0
    assert "Cube Radiosity" in opened(room)
    assert main(["--overwrite"]) == 0


@pytest.mark.usefixtures("quick_bake")
def test_a_frame_that_would_be_the_input_is_refused_unless_it_may_be_overwritten(room, capsys):
    path = Path("room_0001.blend")
    bpy.ops.wm.save_as_mainfile(filepath=str(path.resolve()))
    before = path.read_bytes()
    arguments = ["--output", "room.blend", "--frames", "1:2", "--frames-to", "FILES"]
    assert "room_0001.blend is the file that was read" in fails(arguments, capsys)
    assert path.read_bytes() == before
    assert main([*arguments, "--overwrite"]) == 0
    assert names() == ["room.blend", "room_0001.blend", "room_0002.blend"]


@pytest.fixture
def linking_room(room):
    """The file main.blend, which shows the cube of room.blend from there and has a lamp of its own."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    with bpy.data.libraries.load(str(room), link=True) as (_, wanted):
        wanted.objects = ["Cube"]
    bpy.context.scene.collection.objects.link(wanted.objects[0])
    add_lamp_mesh()
    bpy.ops.wm.save_as_mainfile(filepath=str(room.with_name("main.blend")))
    return room


@pytest.mark.usefixtures("quick_bake")
@pytest.mark.parametrize(
    "arguments",
    [
        "--output room.blend",
        "--output room.blend --overwrite",
        "--output other.blend --report room.blend",
        "--output link.blend",
    ],
)
def test_a_library_is_never_written_over(linking_room, capsys, arguments):
    Path("link.blend").symlink_to("room.blend")
    before = linking_room.read_bytes()
    assert "would replace a file that the scene is read from" in fails(arguments.split(), capsys)
    assert linking_room.read_bytes() == before


@pytest.mark.usefixtures("quick_bake")
def test_a_library_is_not_written_over_by_a_frame(linking_room, capsys):
    linking_room.rename("room_0002.blend")
    bpy.data.libraries[0].filepath = "//room_0002.blend"
    arguments = ["--output", "room.blend", "--frames", "1:2", "--frames-to", "FILES"]
    assert "room_0002.blend would replace" in fails(arguments, capsys)


@pytest.mark.usefixtures("quick_bake")
def test_an_image_is_not_written_over_by_the_report(room, capsys):
    image = bpy.data.images.new("Bricks", 1, 1)
    image.filepath_raw, image.file_format = str(Path("bricks.png").resolve()), "PNG"
    image.save()
    assert "would replace" in fails(["--output", "baked.blend", "--report", "bricks.png"], capsys)


@pytest.fixture
def two_scenes(room):
    """Save another scene in room.blend, with a cube of its own and the settings of a high quality."""
    second = bpy.data.scenes.new("Second")
    cube = bpy.data.objects.new("Other Cube", bpy.data.objects["Cube"].data)
    second.collection.objects.link(cube)
    second.radiosity.quality = "HIGH"
    bpy.data.scenes.new("Notes")
    bpy.ops.wm.save_mainfile()
    return room


def test_the_scene_that_is_asked_for_is_baked_and_shown(two_scenes, quick_bake, capsys):
    assert main(["--output", "baked.blend", "--scene", "Second"], str(two_scenes)) == 0
    ((_, settings),) = quick_bake
    assert settings.quality == "HIGH"
    opened("baked.blend")
    assert bpy.context.scene.name == "Second"
    assert "Other Cube Radiosity" in bpy.context.scene.objects
    assert "Cube Radiosity" not in bpy.data.objects
    assert 'Only the scene "Second" was baked; the file also has "Scene": --scene NAME' in capsys.readouterr().out


@pytest.mark.usefixtures("quick_bake")
def test_scenes_that_were_not_baked_are_named_unless_there_is_nothing_to_bake_in_them(two_scenes, capsys):
    assert main(["--output", "baked.blend"], str(two_scenes)) == 0
    assert 'the file also has "Second": --scene NAME bakes another' in capsys.readouterr().out
    assert main(["--output", "baked.blend", "--frames", "1:1"], str(two_scenes)) == 0
    assert 'the file also has "Second": --scene NAME bakes another' in capsys.readouterr().out
    bpy.data.scenes.remove(bpy.data.scenes["Second"])
    assert main(["--output", "baked.blend"]) == 0
    assert "--scene" not in capsys.readouterr().out


@pytest.mark.usefixtures("quick_bake")
def test_a_scene_that_is_not_there_is_a_sentence(two_scenes, capsys):
    sentence = fails(["--output", "baked.blend", "--scene", "Third"], capsys)
    assert 'There is no scene "Third"' in sentence and '"Notes", "Scene", "Second"' in sentence


def fails(arguments, capsys):
    """Return the sentence of a run that must fail before it bakes, and leaves no file behind."""
    before = names()
    assert main(arguments) == 1
    assert names() == before
    output = capsys.readouterr()
    assert "Form factors" not in output.out
    (line,) = output.err.strip().splitlines()
    return line


@pytest.mark.usefixtures("quick_bake")
@pytest.mark.parametrize(
    ("arguments", "sentence"),
    [
        ("", "--output FILE"),
        ("--output missing/baked.blend", "there is no folder"),
        ("--output baked.txt", "does not end in .blend"),
        ("--output baked.blend --report missing/room.json", "there is no folder"),
        ("--output baked.blend --report baked.blend", "would replace a .blend file"),
        ("--output baked.blend --report room.blend", "would replace a file that the scene is read from"),
        ("--output baked.blend --object Nobody", 'no object "Nobody"'),
        ("--output baked.blend --threshold 0", "Threshold is 0"),
        ("--output baked.blend --seed 99999999999999999999", "Seed is 99999999999999999999"),
        ("--output baked.blend --memory-limit 99999999999999999999", "Memory limit is 99999999999999999999"),
        ("--output baked.blend --threads 99999999999999999999", "Threads is 99999999999999999999"),
        ("--output baked.blend --threshold much", "invalid float value"),
        ("--output baked.blend --quality BEST", "invalid choice"),
        ("--output baked.blend --nonsense", "unrecognized arguments"),
        (f"--output {'n' * 300}.blend", "File name too long"),
        (f"--output baked.blend --report {'n' * 300}.json", "File name too long"),
        ("--output baked.blend --frames-to FILES", "say which to bake with --frames"),
    ],
)
def test_what_cannot_be_done_is_said_in_one_line_before_the_bake(room, capsys, arguments, sentence):
    assert sentence in fails(arguments.split(), capsys)


@pytest.mark.usefixtures("quick_bake")
def test_an_object_that_is_no_mesh_is_a_sentence(room, capsys):
    add_object("Empty", None)
    assert '"Empty" is not a mesh' in fails(["--output", "baked.blend", "--object", "Empty"], capsys)


@pytest.mark.usefixtures("quick_bake")
def test_a_read_only_output_is_a_sentence(room, capsys):
    Path("baked.blend").write_bytes(b"old")
    Path("baked.blend").chmod(0o444)
    assert "is read-only" in fails(["--output", "baked.blend"], capsys)
    assert Path("baked.blend").read_bytes() == b"old"


def test_a_scene_without_meshes_is_a_sentence(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    assert "nothing with faces" in fails(["--output", "baked.blend"], capsys)


def test_a_file_that_is_no_blend_file_is_a_sentence(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    Path("room.blend").write_text("not a blend file")
    assert main(["--output", "baked.blend"], "room.blend") == 1
    assert "room.blend could not be read" in capsys.readouterr().err
    assert main(["--output", "baked.blend"], "missing.blend") == 1
    assert "There is no file missing.blend" in capsys.readouterr().err
    assert main(["--output", "baked.blend"], "n" * 300) == 1
    assert "File name too long" in capsys.readouterr().err
    assert main(["--output", "baked.blend"], ".") == 1
    assert ". is not a file" in capsys.readouterr().err


def test_a_file_of_a_newer_blender_is_said_to_be_one(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    path = Path("room.blend")
    for header, said in (
        (b"BLENDER17-01v9902", "it was saved by Blender 99.2; this is"),
        (b"BLENDER-v999", "it was saved by Blender 9.99; this is"),
        # What a compressed one is of, the module cannot tell; whole, it can only be newer.
        (b"\x28\xb5\x2f\xfd" + bytes(64) + b"\xb1\xea\x92\x8f", "it was saved by a newer Blender; this is"),
    ):
        path.write_bytes(header + bytes(200) if header.startswith(b"B") else header)
        assert main(["--output", "baked.blend"], "room.blend") == 1
        assert said in capsys.readouterr().err
    for broken in (b"", b"BLENDER-v300", b"\x28\xb5\x2f\xfd" + bytes(64)):
        path.write_bytes(broken)
        assert main(["--output", "baked.blend"], "room.blend") == 1
        assert "saved by" not in capsys.readouterr().err


@pytest.mark.usefixtures("quick_bake")
def test_the_longest_name_that_there_is_can_be_written(room):
    name = "n" * 249 + ".blend"
    assert main(["--output", name]) == 0
    assert names() == [name, "room.blend"]
    assert "Cube Radiosity" in opened(name)


def test_a_failed_bake_writes_nothing(room, run_instead, capsys):
    run_instead(dark_bake)
    assert "Nothing in the scene emits light" in fails(["--output", "baked.blend"], capsys)


@pytest.mark.usefixtures("quick_bake")
def test_a_report_that_cannot_be_written_leaves_no_output_either(room, monkeypatch, capsys):
    def full(*arguments, **options):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(Path, "write_text", full)
    before = names()
    assert main(["--output", "baked.blend", "--report", "room.json"]) == 1
    assert "No space left on device" in capsys.readouterr().err
    assert names() == before


def test_help_explains_every_option(capsys):
    assert main(["--help"]) == 0
    text = capsys.readouterr().out
    for option in ("--output", "--report", "--overwrite", "--object", "--bake-to", "--threshold", "--minimum-size"):
        assert option in text
    assert "blender --background room.blend --command radiosity_bake" in text
    assert "Exit code" in text


def test_the_command_is_registered_once_and_withdrawn():
    assert len(command._handles) == 1
    command.unregister()
    assert command._handles == []
    command.register()


def shell(*arguments):
    """Run `tools/bake.py` as a shell would."""
    return subprocess.run(
        [sys.executable, str(ROOT / "tools" / "bake.py"), *arguments], capture_output=True, text=True, timeout=120
    )


has_module = pytest.mark.skipif(
    bool(bpy.app.binary_path), reason="inside Blender, Python itself cannot import bpy: --command is tested instead"
)


@has_module
def test_the_module_bakes_a_file_from_the_shell(room):
    run = shell("room.blend", "--output", "baked.blend", "--report", "room.json", "--quality", "DRAFT")
    assert run.returncode == 0, run.stderr
    assert "Baked 3 objects" in run.stdout
    assert json.loads(Path("room.json").read_text())["rays"] > 0
    assert "Cube Radiosity" in opened("baked.blend")


@has_module
def test_the_module_fails_with_exit_code_1_and_a_sentence(room):
    run = shell("missing.blend", "--output", "baked.blend")
    assert run.returncode == 1
    assert "radiosity_bake: There is no file missing.blend" in run.stderr
    assert "Traceback" not in run.stderr
    run = shell()
    assert run.returncode == 1
    assert "Give the .blend file" in run.stderr
