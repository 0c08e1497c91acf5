# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Sheets lit from both sides by different colours, beside what Cycles makes of them."""

import bpy
import numpy as np
import pytest

from tests.blender.making import (
    add_cube,
    add_mesh,
    add_object,
    bake_selected,
    colours_of,
    diffuse_material,
    report,
    select_also,
)

SAMPLES = 256
PIXELS = 8


def add_sheet(name="Sheet", height=0.0, turned=False, paint=None):
    """Return a square of 64 faces that looks up, or down if turned."""
    side = np.linspace(-1.0, 1.0, 9)
    corners = [a for j in range(8) for a in range(9 * j, 9 * j + 8)]
    quads = [(a, a + 1, a + 10, a + 9) for a in corners]
    faces = [quad[::-1] for quad in quads] if turned else quads
    paint = paint or diffuse_material(colour=(0.8, 0.8, 0.8, 1.0))
    return add_mesh(name, [(x, y, height) for y in side for x in side], faces, materials=[paint])


def add_lamps():
    """Shine red from above and, more weakly, blue from below."""
    for name, height, colour, energy in (
        ("Above", 2.0, (1.0, 0.1, 0.1), 100.0),
        ("Below", -2.0, (0.1, 0.1, 1.0), 60.0),
    ):
        light = bpy.data.lights.new(name, "POINT")
        light.color, light.energy, light.shadow_soft_size = colour, energy, 0.3
        add_object(name, light).location.z = height


def set_cycles(samples):
    scene = bpy.context.scene
    scene.render.engine = "CYCLES"
    for key, value in {
        "device": "CPU",
        "samples": samples,
        "use_adaptive_sampling": False,
        "use_denoising": False,
        "sample_clamp_indirect": 0.0,
        "light_sampling_threshold": 0.0,
        "max_bounces": 16,
        "diffuse_bounces": 16,
    }.items():
        setattr(scene.cycles, key, value)


def by_cycles(sheet, turned):
    """Return (3,) the mean of Cycles' DIFFUSE bake without colour, of the sheet turned over if asked."""
    set_cycles(SAMPLES)
    if turned:
        sheet.data.flip_normals()
    attribute = sheet.data.color_attributes.new("Cycles", "FLOAT_COLOR", "CORNER")
    sheet.data.color_attributes.active_color = attribute
    bpy.ops.object.bake(type="DIFFUSE", pass_filter={"DIRECT", "INDIRECT"}, target="VERTEX_COLORS")
    mean = colours_of(sheet.data, "Cycles")[:, :3].mean(axis=0)
    sheet.data.color_attributes.remove(sheet.data.color_attributes["Cycles"])
    if turned:
        sheet.data.flip_normals()
    return mean


def photograph(folder, from_above, samples):
    """Return (pixels, 3) what a camera sees from straight above or below."""
    scene = bpy.context.scene
    camera = bpy.data.objects.get("Camera") or add_object("Camera", bpy.data.cameras.new("Camera"))
    camera.data.type, camera.data.ortho_scale = "ORTHO", 1.6
    camera.location = (0.0, 0.0, 1.0 if from_above else -1.0)
    camera.rotation_euler = (0.0 if from_above else np.pi, 0.0, 0.0)
    scene.camera = camera
    set_cycles(samples)
    scene.render.resolution_x = scene.render.resolution_y = PIXELS
    scene.render.resolution_percentage = 100
    scene.render.image_settings.file_format, scene.render.image_settings.color_depth = "OPEN_EXR", "32"
    scene.render.filepath = str(folder / "seen.exr")
    bpy.ops.render.render(write_still=True)
    image = bpy.data.images.load(scene.render.filepath)
    seen = np.array(image.pixels[:]).reshape(PIXELS * PIXELS, -1)[:, :3]
    bpy.data.images.remove(image)
    return seen


def mean_of(thing, name):
    return colours_of(thing.data, name)[:, :3].mean(axis=0)


@pytest.mark.parametrize("scale", [(1.0, 1.0, 1.0), (1.0, -1.0, 1.0), (0.8, 1.0, -2.0)])
def test_each_side_of_a_sheet_gets_the_light_that_cycles_bakes_on_it(scale):
    sheet = add_sheet()
    sheet.scale = scale
    add_lamps()
    select_also(sheet)
    front, back = by_cycles(sheet, False), by_cycles(sheet, True)
    bake_selected("ORIGINAL")
    # Two lamps in the open, no light but theirs: Cycles' mean over 256 corners of 256 samples has an error of 0.2%.
    assert mean_of(sheet, "Irradiance") == pytest.approx(front, rel=0.01)
    assert mean_of(sheet, "Irradiance Back") == pytest.approx(back, rel=0.01)
    assert report()["warnings"] == []


@pytest.mark.parametrize("scale", [(1.0, 1.0, 1.0), (-1.0, 1.0, 1.0)])
def test_a_camera_sees_on_both_sides_of_the_baked_sheet_what_it_saw_before(tmp_path, scale):
    sheet = add_sheet()
    sheet.scale = scale
    add_lamps()
    bpy.context.view_layer.update()
    before = [photograph(tmp_path, above, 64) for above in (True, False)]
    select_also(sheet)
    bake_selected("REFINED")
    for lamp in ("Above", "Below"):
        bpy.data.objects.remove(bpy.data.objects[lamp])
    after = [photograph(tmp_path, above, 4) for above in (True, False)]
    for seen, shown in zip(before, after, strict=True):
        # 64 samples leave some 3% at a pixel and an eighth of that in the mean of 64; a bake has no noise to speak of.
        assert shown.mean(axis=0) == pytest.approx(seen.mean(axis=0), rel=0.015)
    assert after[0][:, 0].mean() > 4 * after[0][:, 2].mean() and after[1][:, 2].mean() > 4 * after[1][:, 0].mean()


@pytest.mark.parametrize("gap", [0.0, 0.001])
@pytest.mark.parametrize("joined", [True, False])
def test_sheets_back_to_back_keep_the_light_of_their_own_side(gap, joined):
    paint = diffuse_material(colour=(0.8, 0.8, 0.8, 1.0))
    up, down = add_sheet("Up", gap / 2, paint=paint), add_sheet("Down", -gap / 2, turned=True, paint=paint)
    add_lamps()
    select_also(down, up)
    if joined:
        bpy.ops.object.join()
    bake_selected("ORIGINAL")
    sheets = [up] if joined else [up, down]
    normals, colours = [], []
    for sheet in sheets:
        normals += [corner.z for corner in (n.vector for n in sheet.data.corner_normals)]
        colours.append(colours_of(sheet.data, "Irradiance")[:, :3])
    normals, colours = np.array(normals), np.concatenate(colours)
    above, below = colours[normals > 0.5], colours[normals < -0.5]
    assert len(above) == len(below) == 256
    # Each lamp has a tenth of the other's colour, and nothing of it comes round.
    assert above[:, 2] == pytest.approx(0.1 * above[:, 0], rel=1e-4) and above[:, 0].min() > 0.0
    assert below[:, 0] == pytest.approx(0.1 * below[:, 2], rel=1e-4) and below[:, 2].min() > 0.0


def test_a_closed_mesh_has_no_back():
    cube = add_cube(select=True)
    add_lamps()
    bake_selected("ORIGINAL")
    assert "Irradiance Back" not in cube.data.color_attributes
