# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The built zip, installed as a user installs it, in Blenders that have no ray library of their own."""

from __future__ import annotations

import json

import pytest

from tools.environments import present_environments
from tools.installed import run_with_installed


@pytest.fixture(scope="module", params=present_environments(), ids=lambda each: each.name)
def told(request, linux_zip, tmp_path_factory):
    """What the process in tests/package/bake_installed.py found."""
    result = tmp_path_factory.mktemp("installed") / "result.json"
    done = run_with_installed(
        request.param, "tests.package.bake_installed", [str(linux_zip), str(result)], capture=True
    )
    assert done.returncode == 0, done.stdout + done.stderr
    return json.loads(result.read_text(encoding="utf-8"))


def test_the_bake_finishes_and_leaves_a_report(told):
    assert told["outcome"] == ["FINISHED"]
    assert told["report"]["rays"] > 0


def test_the_ray_library_comes_out_of_the_zip(told):
    assert told["ray_library"].startswith(told["user_folder"])


def test_every_surface_carries_both_attributes_and_is_lit(told):
    assert len(told["baked"]) == 8
    for name, colours in told["baked"].items():
        assert min(colours["Radiosity"]) > 0.0, name
        assert min(colours["Irradiance"]) >= 0.0, name


def test_coloured_walls_are_lit_in_their_colour(told):
    red, green, _ = next(v["Radiosity"] for k, v in told["baked"].items() if k.startswith("Left Wall"))
    assert red > 3.0 * green
    red, green, _ = next(v["Radiosity"] for k, v in told["baked"].items() if k.startswith("Right Wall"))
    assert green > 1.5 * red


def test_disabling_the_extension_leaves_nothing_behind(told):
    assert told["left_after_disabling"] == []
