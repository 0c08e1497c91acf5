# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""After one click the viewport shows the light, and after restoring what it showed before."""

from types import SimpleNamespace

import bpy
import pytest
from radiosity_bake.operators.display import show_as_before, show_in_viewport


def viewport(kind="SOLID", color_type="MATERIAL", light="STUDIO"):
    """Return a context whose window has one viewport; there is none without a screen."""
    shading = SimpleNamespace(type=kind, color_type=color_type, light=light)
    return SimpleNamespace(scene=bpy.context.scene, space_data=SimpleNamespace(shading=shading, local_view=None))


def shown(context):
    shading = context.space_data.shading
    return shading.color_type, shading.light


def test_a_solid_viewport_shows_the_colours_unshaded():
    context = viewport()
    show_in_viewport(context, ())
    assert shown(context) == ("VERTEX", "FLAT")


def test_restoring_shows_what_was_shown_before():
    context = viewport(color_type="OBJECT", light="MATCAP")
    show_in_viewport(context, ())
    show_in_viewport(context, ())
    show_as_before(context)
    assert shown(context) == ("OBJECT", "MATCAP")
    assert context.scene.radiosity.shading_before == ""


def test_what_the_artist_chose_since_the_bake_is_kept():
    context = viewport()
    show_in_viewport(context, ())
    context.space_data.shading.color_type = "RANDOM"
    show_as_before(context)
    assert shown(context) == ("RANDOM", "FLAT")


@pytest.mark.parametrize("kind", ["MATERIAL", "RENDERED", "WIREFRAME"])
def test_other_kinds_of_shading_are_left_alone(kind):
    context = viewport(kind)
    show_in_viewport(context, ())
    assert shown(context) == ("MATERIAL", "STUDIO")


def test_a_bake_from_elsewhere_than_a_viewport_changes_no_viewport():
    context = SimpleNamespace(scene=bpy.context.scene, space_data=None)
    show_in_viewport(context, ())
    show_as_before(context)
    assert context.scene.radiosity.shading_before == ""


def test_in_local_view_the_new_objects_come_in():
    context, seen = viewport(), []
    context.space_data.local_view = object()
    show_in_viewport(context, [SimpleNamespace(local_view_set=lambda space, state: seen.append(state))])
    assert seen == [True]
