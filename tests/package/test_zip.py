# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""What is in the zips that users get, and nothing else."""

from __future__ import annotations

import hashlib
import subprocess
import tomllib
import zipfile

import pytest

from tools.build import ROOT, validate
from tools.environments import present_environments
from tools.fetch_wheels import pinned_wheels

PACKAGES = {"core", "operators", "ui"}
TOP_LEVEL = {"LICENSE", "__init__.py", "blender_manifest.toml", "wheels", *PACKAGES}

PYTHONS_AND_PLATFORM_TAG = {
    "windows_x64": ({"cp311", "cp313"}, "win_amd64"),
    "linux_x64": ({"cp311", "cp313", "cp314"}, "manylinux_2_27_x86_64.manylinux_2_28_x86_64"),
    "macos_arm64": ({"cp311", "cp313"}, "macosx_13_0_arm64"),
    "macos_x64": ({"cp311", "cp313"}, "macosx_13_0_x86_64"),
}


@pytest.fixture(params=PYTHONS_AND_PLATFORM_TAG)
def platform(request):
    return request.param


@pytest.fixture
def archive(platform, zips):
    (path,) = (path for path in zips if path.name.endswith(f"-{platform}.zip"))
    with zipfile.ZipFile(path) as opened:
        yield opened


def test_there_is_one_zip_a_platform(zips):
    assert len(zips) == len(PYTHONS_AND_PLATFORM_TAG)


def test_a_zip_holds_what_users_need_and_nothing_else(archive):
    names = archive.namelist()
    assert {name.split("/")[0] for name in names} == TOP_LEVEL
    assert all(name.endswith(".py") for name in names if name.split("/")[0] in PACKAGES)


def test_a_zip_holds_every_module_of_the_extension(archive):
    listed = subprocess.run(["git", "ls-files", "*.py"], cwd=ROOT, capture_output=True, text=True, check=True)
    modules = {name for name in listed.stdout.split() if name == "__init__.py" or name.split("/")[0] in PACKAGES}
    assert modules
    assert modules <= set(archive.namelist())


def test_a_zip_holds_the_ray_library_for_its_platform_and_every_python(platform, archive):
    pythons, tag = PYTHONS_AND_PLATFORM_TAG[platform]
    wheels = {name for name in archive.namelist() if name.endswith(".whl")}
    assert wheels == {f"wheels/embreex-4.4.0.post1-{python}-{python}-{tag}.whl" for python in pythons}


def test_wheels_are_bundled_unmodified(archive):
    pinned = {f"wheels/{wheel.file_name}": wheel.sha256 for wheel in pinned_wheels()}
    for name in archive.namelist():
        if name.endswith(".whl"):
            assert hashlib.sha256(archive.read(name)).hexdigest() == pinned[name]


def test_the_manifest_lists_exactly_the_pinned_wheels():
    manifest = tomllib.loads((ROOT / "blender_manifest.toml").read_text(encoding="utf-8"))
    assert sorted(manifest["wheels"]) == sorted(f"./wheels/{wheel.file_name}" for wheel in pinned_wheels())


@pytest.mark.parametrize("environment", present_environments(), ids=lambda each: each.name)
def test_every_blender_finds_the_zips_valid(environment, zips):
    for path in zips:
        validate(path, environment.python)
