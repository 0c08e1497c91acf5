# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Use the built zip as a user does: install it into a fresh Blender user folder and bake with it.

The process must run in an environment without embreex (`.venv/py313-user`) and with BLENDER_USER_RESOURCES set to a
folder of its own before bpy is imported; `run_with_installed` starts such a process.
"""

from __future__ import annotations

import os
import subprocess
import tempfile
from collections.abc import Sequence
from pathlib import Path

from .environments import ROOT, Environment

REPOSITORY = "user_default"
MODULE = f"bl_ext.{REPOSITORY}.radiosity_bake"


def linux_zip(folder: Path) -> Path:
    """Return the zip for this platform in a folder of built ones."""
    (path,) = folder.glob("radiosity_bake-*-linux_x64.zip")
    return path


def install_zip(path: Path) -> None:
    """Install and enable the zip in this process; Blender answers FINISHED even to a zip that it refused."""
    import bpy

    bpy.ops.extensions.package_install_files(filepath=str(path), repo=REPOSITORY, enable_on_install=True)
    if MODULE not in bpy.context.preferences.addons:
        raise RuntimeError(f"Blender {bpy.app.version_string} did not enable {path.name}")


def run_with_installed(
    environment: Environment, module: str, arguments: Sequence[str], *, capture: bool = False
) -> subprocess.CompletedProcess[str]:
    """Run `python -m module` in the twin without embreex, under a fresh Blender user folder."""
    with tempfile.TemporaryDirectory(prefix="blender-user-") as user_folder:
        variables = {**os.environ, "BLENDER_USER_RESOURCES": user_folder}
        variables.pop("PYTHONPATH", None)
        command = [str(environment.user_python), "-m", module, *arguments]
        return subprocess.run(command, cwd=ROOT, env=variables, capture_output=capture, text=True, check=False)
