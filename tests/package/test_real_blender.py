# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The built zip in a real Blender without a window: installed by Blender's command, used by its own."""

from __future__ import annotations

import hashlib
import json
from pathlib import Path

import pytest

from tools.environments import ROOT
from tools.window import install

SAVE_ROOM = ROOT / "tests" / "package" / "save_room.py"


def save_room(blender, path: Path) -> None:
    """Save the Cornell box as a .blend file of this Blender's version."""
    script = ["--background", "--factory-startup", "--python-exit-code", "1", "--python", str(SAVE_ROOM)]
    done = blender.run([*script, "--", str(ROOT), "cornell_box", str(path)], binds=[path.parent], capture=True)
    assert done.returncode == 0, done.stdout + done.stderr


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    return tmp_path_factory.mktemp("real")


@pytest.fixture(scope="module")
def command(real_blender, linux_zip, folder):
    """Run `blender --background [FILE] --command radiosity_bake ...` with the extension installed."""
    profile = folder / f"profile-{real_blender.suite}"
    installed = install(real_blender, linux_zip, profile)
    assert installed.returncode == 0, installed.stdout + installed.stderr

    def run(*arguments: str, blend: Path | None = None):
        start = ["--background", *([str(blend)] if blend else [])]
        whole = [*start, "--command", "radiosity_bake", *arguments]
        return real_blender.run(whole, profile=profile, binds=[folder], timeout=300, capture=True)

    return run


@pytest.fixture(scope="module")
def room(real_blender, folder):
    path = folder / f"room-{real_blender.suite}.blend"
    save_room(real_blender, path)
    return path


def test_help_explains_the_options(command):
    done = command("--help")
    assert done.returncode == 0
    for option in ("--threshold", "--minimum-size", "--quality", "--output", "--report", "--object"):
        assert option in done.stdout


def test_a_file_is_baked_by_one_command(command, room, folder):
    before = hashlib.sha256(room.read_bytes()).hexdigest()
    output, report = folder / "baked.blend", folder / "report.json"
    options = ("--quality", "DRAFT", "--threshold", "0.05", "--minimum-size", "0.1")
    done = command(*options, "--output", str(output), "--report", str(report), blend=room)
    assert done.returncode == 0, done.stdout + done.stderr
    assert output.stat().st_size > room.stat().st_size
    assert json.loads(report.read_text(encoding="utf-8"))["rays"] > 0
    assert hashlib.sha256(room.read_bytes()).hexdigest() == before, "the input file was changed"


def test_a_wrong_option_ends_in_a_sentence_and_exit_code_1(command, room, folder):
    output = folder / "never.blend"
    done = command("--object", "No Such Thing", "--output", str(output), blend=room)
    assert done.returncode == 1
    assert 'no object "No Such Thing"' in done.stderr
    assert not output.exists()
