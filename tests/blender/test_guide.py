# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The guide tells of everything that a user can set, press and read."""

import ast
import dataclasses
import re
from pathlib import Path

import bpy
import pytest
from radiosity_bake.core.settings import BakeSettings
from radiosity_bake.operators.command import _parser

from tests.blender.making import add_cube, add_lamp_mesh, bake_selected, report

GUIDE = (Path(__file__).resolve().parents[2] / "docs" / "guide.md").read_text(encoding="utf-8")


@pytest.mark.parametrize("name", [field.name for field in dataclasses.fields(BakeSettings)])
def test_every_setting_is_explained_and_shown_in_the_script(name):
    shown = bpy.context.scene.radiosity.bl_rna.properties[name].name.removesuffix(" (MiB)")
    assert f"| **{shown}** |" in GUIDE
    assert re.search(rf"^settings\.{name} = ", GUIDE, re.MULTILINE)


def test_the_script_changes_no_default_and_names_every_choice():
    block = GUIDE.partition("## From a script")[2].partition("```python")[2].partition("```")[0]
    given = dict(re.findall(r"^settings\.(\w+) = (.*)$", block, re.MULTILINE))
    properties = bpy.context.scene.radiosity.bl_rna.properties
    for field in dataclasses.fields(BakeSettings):
        value, _, comment = given[field.name].partition("#")
        assert ast.literal_eval(value.strip()) == field.default, field.name
        if properties[field.name].type == "ENUM":
            choices = re.findall(r"[A-Z]{4,}|[A-Z]{3}\b", comment)
            assert choices == [item.identifier for item in properties[field.name].enum_items], field.name


def test_every_operator_is_named():
    operators = dir(bpy.ops.radiosity)
    assert "bake" in operators
    assert [name for name in operators if f"bpy.ops.radiosity.{name}()" not in GUIDE] == []


def test_every_option_of_the_command_is_named():
    options = {option for action in _parser()._actions for option in action.option_strings if option.startswith("--")}
    assert [option for option in sorted(options) if option not in GUIDE] == []


def test_every_key_of_the_report_is_explained():
    add_cube(select=True)
    add_lamp_mesh()
    bpy.context.scene.radiosity.quality = "DRAFT"
    bake_selected()
    explained = GUIDE.partition("## The report")[2].partition("\n## ")[0]
    keys = [*report(), *report()["energy"], *report()["profile"], *report()["rays_by_kind"]]
    assert [key for key in keys if f"`{key}`" not in explained] == []
