# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The extension comes and goes without a trace, with the defaults of `core`."""

import dataclasses

import bpy
import pytest
import radiosity_bake
from radiosity_bake.core.settings import BakeSettings
from radiosity_bake.operators import settings as settings_module
from radiosity_bake.operators.settings import bake_settings


def test_registering_adds_operators_settings_and_panels():
    assert hasattr(bpy.types, "RADIOSITY_OT_bake")
    assert hasattr(bpy.types, "VIEW3D_PT_radiosity")
    assert bpy.types.VIEW3D_PT_radiosity.bl_category == "Radiosity"
    assert bpy.context.scene.radiosity is not None


def test_unregistering_removes_them_and_registering_brings_them_back():
    radiosity_bake.unregister()
    try:
        assert not hasattr(bpy.types, "RADIOSITY_OT_bake")
        assert not hasattr(bpy.types, "VIEW3D_PT_radiosity")
        assert not hasattr(bpy.types.Scene, "radiosity")
        assert not hasattr(bpy.types.Object, "radiosity")
    finally:
        radiosity_bake.register()
    assert hasattr(bpy.types, "RADIOSITY_OT_bake")


def test_defaults_are_those_of_core():
    assert bake_settings(bpy.context.scene.radiosity) == BakeSettings()


def test_every_setting_of_core_can_be_set_in_the_scene():
    properties = bpy.context.scene.radiosity
    properties.threshold, properties.minimum_size = 0.05, 0.125
    properties.method, properties.quality, properties.output = "UNIFORM", "HIGH", "ORIGINAL"
    properties.seed, properties.threads, properties.memory_limit = 7, 2, 512
    properties.patch_limit = 999
    expected = BakeSettings(0.05, 0.125, "UNIFORM", "HIGH", "ORIGINAL", 7, 2, 512, 999)
    assert bake_settings(properties) == expected


def test_choices_are_those_of_core():
    from radiosity_bake.core import settings as core

    for items, names in (
        (settings_module.METHOD_ITEMS, core.METHODS),
        (settings_module.QUALITY_ITEMS, core.QUALITIES),
        (settings_module.OUTPUT_ITEMS, core.OUTPUTS),
        (settings_module.MATERIAL_ITEMS, core.MATERIALS),
        (settings_module.LIGHT_ITEMS, core.LIGHTS),
        (settings_module.DOMAIN_ITEMS, core.DOMAINS),
        (settings_module.DATA_TYPE_ITEMS, core.DATA_TYPES),
    ):
        assert tuple(item[0] for item in items) == names


@pytest.mark.parametrize("name", [field.name for field in dataclasses.fields(BakeSettings)])
def test_every_setting_has_a_tooltip_that_ends_without_a_full_stop(name):
    description = bpy.context.scene.radiosity.bl_rna.properties[name].description
    assert len(description) > 20
    assert not description.endswith(".")
