# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The extension in the window of a real Blender, used by mouse and keyboard; screenshots stay in out/window."""

from __future__ import annotations

from tools.environments import ROOT
from tools.window import play

SCRIPTS = ROOT / "tests" / "window"
PICTURES = ROOT / "out" / "window"


MEANT_TO_FAIL = "RuntimeError: meant to fail"
"""What a handler of the traps says, for which Blender prints a traceback."""


def test_bake_cancel_and_restore_by_mouse_and_keyboard(real_blender, linux_zip):
    pictures = PICTURES / real_blender.suite
    script = SCRIPTS / "bake_by_hand.py"
    done = play(script, pictures, blender=real_blender, extension=linux_zip, timeout=480, capture=True)
    assert done.returncode == 0, f"see {pictures}\n{done.stdout}\n{done.stderr}"
    assert (pictures / "5_restored.png").exists()


def test_whatever_happens_while_a_bake_runs_ends_in_a_sentence_and_a_usable_file(real_blender, linux_zip):
    pictures = PICTURES / real_blender.suite
    done = play(SCRIPTS / "traps.py", pictures, blender=real_blender, extension=linux_zip, timeout=900, capture=True)
    told = f"{done.stdout}\n{done.stderr}"
    assert done.returncode == 0, f"see {pictures}\n{told}"
    assert told.count("Traceback") == told.count(MEANT_TO_FAIL), told


def test_blender_ends_well_in_the_middle_of_a_bake(real_blender, linux_zip):
    pictures = PICTURES / real_blender.suite
    done = play(
        SCRIPTS / "quit.py",
        pictures,
        blender=real_blender,
        extension=linux_zip,
        arguments=["frames"],
        timeout=240,
        capture=True,
    )
    told = f"{done.stdout}\n{done.stderr}"
    assert done.returncode == 0, told
    assert "quitting" in told and "Traceback" not in told and "crash" not in told, told
