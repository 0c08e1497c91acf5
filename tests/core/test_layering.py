# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Core stands alone: no Blender, nothing beyond numpy, and the ray library behind one door."""

import ast
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
CORE = sorted((ROOT / "core").glob("**/*.py"))
ALLOWED = set(sys.stdlib_module_names) | {"numpy", "__future__"}


def imported(path: Path) -> set[str]:
    """The top-level names of the modules that a file imports absolutely, wherever in the file."""
    names = set()
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            names |= {alias.name.partition(".")[0] for alias in node.names}
        elif isinstance(node, ast.ImportFrom) and node.level == 0:
            names.add(str(node.module).partition(".")[0])
    return names


def relative_depths(path: Path) -> set[int]:
    tree = ast.parse(path.read_text(encoding="utf-8"))
    return {node.level for node in ast.walk(tree) if isinstance(node, ast.ImportFrom)}


def test_core_imports_the_standard_library_numpy_and_the_ray_library_only():
    assert CORE
    for path in CORE:
        assert imported(path) - ALLOWED <= {"embreex"}, path.name


def test_one_module_alone_imports_the_ray_library():
    assert [path.name for path in CORE if "embreex" in imported(path)] == ["ray_library.py"]


def test_core_imports_nothing_of_the_package_above_it():
    for path in CORE:
        assert relative_depths(path) <= {0, 1}, path.name


def run(code: str) -> subprocess.CompletedProcess:
    prelude = f"import sys; sys.path.insert(0, {str(ROOT)!r}); from tools.package import load_package; "
    return subprocess.run([sys.executable, "-c", prelude + code], capture_output=True, text=True, timeout=120)


ROOM = (
    "from tests.scenes.exact import furnace; from radiosity_bake.core.bake import bake; "
    "from radiosity_bake.core.settings import BakeSettings; "
)


def test_a_bake_runs_where_blender_cannot_be_imported():
    code = "sys.modules.update(dict.fromkeys(('bpy', 'bmesh', 'mathutils', 'gpu'))); load_package(); " + ROOM
    code += "print(len(bake(furnace()[0], BakeSettings(quality='DRAFT', minimum_size=0.5)).meshes))"
    done = run(code)
    assert done.returncode == 0, done.stderr
    assert done.stdout.strip() == "1"


def test_without_the_ray_library_a_bake_says_what_to_install():
    code = "sys.modules['embreex'] = None; load_package(); " + ROOM
    code += "from radiosity_bake.core.ray_library import ray_library_problem; print(ray_library_problem()); "
    code += "bake(furnace()[0], BakeSettings(quality='DRAFT'))"
    done = run(code)
    assert "embreex cannot be loaded" in done.stdout and "install" in done.stdout
    assert "RayLibraryError" in done.stderr


def test_there_is_no_problem_with_the_ray_library_here():
    from radiosity_bake.core.ray_library import ray_library_problem

    assert ray_library_problem() is None


@pytest.mark.parametrize("path", CORE, ids=lambda p: p.name)
def test_every_module_of_core_says_under_which_licence_it_is(path):
    head = path.read_text(encoding="utf-8").splitlines()[:2]
    assert head[0].startswith("# SPDX-FileCopyrightText:") and head[1] == "# SPDX-License-Identifier: GPL-3.0-or-later"
