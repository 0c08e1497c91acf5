# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""A full disk, a folder that is read-only, a process that is killed while it saves: what was there stays whole."""

import subprocess
import sys
from contextlib import contextmanager
from pathlib import Path

import bpy
import pytest
from radiosity_bake.operators.command import main

from tests.blender.making import add_cube, add_lamp_mesh

resource = pytest.importorskip("resource", reason="limits of a process are those of Unix")

ROOT = Path(__file__).resolve().parents[2]

LARGEST_FILE = 4_000
"""Bytes; a .blend file of the smallest scene has more, compressed too."""


@pytest.fixture
def room(tmp_path, monkeypatch):
    """Save a small lit scene as room.blend and an earlier output beside it, in a folder of their own, and go there."""
    add_cube()
    add_lamp_mesh()
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "room.blend"))
    (tmp_path / "baked.blend").write_bytes((tmp_path / "room.blend").read_bytes())
    assert (tmp_path / "room.blend").stat().st_size > LARGEST_FILE
    monkeypatch.chdir(tmp_path)
    return tmp_path


@contextmanager
def full_disk():
    """Let no file grow beyond a limit, as a full disk does; the signal that says so is ignored by Python.

    Not a fixture: between a test and the end of its fixtures pytest writes how the test went, and its own output may be
    a file that is longer than the limit.
    """
    before = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (LARGEST_FILE, before[1]))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, before)


def contents(folder):
    return {path.name: path.read_bytes() for path in folder.iterdir()}


@pytest.mark.usefixtures("quick_bake")
@pytest.mark.parametrize("output", ["baked.blend", "new.blend", "room.blend"])
def test_a_disk_that_is_full_while_the_output_is_saved_leaves_every_file_as_it_was(room, capsys, output):
    before = contents(room)
    with full_disk():
        code = main(["--output", output, "--overwrite", "--report", "room.json"])
    assert code == 1
    (line,) = capsys.readouterr().err.strip().splitlines()[-1:]
    assert f"{output} could not be written" in line and "disk is full" in line
    assert contents(room) == before


KILLED = f"""
import os, runpy, signal, sys
import bpy
bpy.app.handlers.save_post.append(bpy.app.handlers.persistent(lambda *_: os.kill(os.getpid(), signal.SIGKILL)))
sys.argv = ["bake.py", "room.blend", "--output", sys.argv[1], "--overwrite", "--quality", "DRAFT"]
runpy.run_path({str(ROOT / "tools" / "bake.py")!r}, run_name="__main__")
"""
"""Blender is ended when it has written what it saves, and before that has its name: no `finally` runs."""


@pytest.mark.skipif(bool(bpy.app.binary_path), reason="inside Blender, Python itself cannot import bpy")
@pytest.mark.parametrize("output", ["baked.blend", "room.blend"])
def test_a_process_that_is_killed_while_it_saves_leaves_the_input_and_the_earlier_output_whole(room, output):
    before = contents(room)
    run = subprocess.run([sys.executable, "-c", KILLED, output], capture_output=True, text=True, timeout=300)
    assert run.returncode < 0, run.stderr
    assert "Form factors" in run.stdout
    after = contents(room)
    assert all(after[name] == before[name] for name in before)
