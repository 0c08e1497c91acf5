# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The extension in the window of a real Blender, used by mouse and keyboard; screenshots stay in out/window."""

from __future__ import annotations

from tools.environments import ROOT
from tools.window import play

SCRIPTS = ROOT / "tests" / "window"
PICTURES = ROOT / "out" / "window"


def test_bake_cancel_and_restore_by_mouse_and_keyboard(real_blender, linux_zip):
    pictures = PICTURES / real_blender.suite
    script = SCRIPTS / "bake_by_hand.py"
    done = play(script, pictures, blender=real_blender, extension=linux_zip, timeout=480, capture=True)
    assert done.returncode == 0, f"see {pictures}\n{done.stdout}\n{done.stderr}"
    assert (pictures / "5_restored.png").exists()
