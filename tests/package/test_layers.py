# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The rules of who may import what."""

from __future__ import annotations

import re
import subprocess
import sys

from tools.environments import ROOT

IMPORT_WITHOUT_BLENDER = """
import importlib, sys
sys.path.insert(0, "tests")
for name in ("bpy", "bmesh", "mathutils", "gpu"):
    sys.modules[name] = None  # importing it fails
import conftest
for module in sys.argv[1:]:
    importlib.import_module(module)
"""


def core_files():
    return sorted((ROOT / "core").glob("*.py"))


def test_core_can_be_imported_without_blender():
    modules = [f"radiosity_bake.core.{path.stem}" for path in core_files()]
    command = [sys.executable, "-c", IMPORT_WITHOUT_BLENDER, *modules]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr


def test_one_file_imports_the_ray_library():
    importing = [path.name for path in core_files() if re.search(r"^\s*(from|import) embreex", path.read_text(), re.M)]
    assert importing == ["visibility.py"]
