# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""What Blender's own exporter writes of a baked scene, read back with another library."""

import dataclasses
from functools import partial

import bpy
import numpy as np
import pytest

from tests.blender.making import (
    add_cube,
    add_mesh,
    add_plane,
    bake_selected,
    diffuse_material,
    emission_material,
    node_material,
    position_bake,
    select_also,
    use_image,
)

if bpy.app.binary_path:
    pytest.skip("the other library is not in a Blender's own Python", allow_module_level=True)
import pygltflib

_TYPES = {5121: np.uint8, 5123: np.uint16, 5125: np.uint32, 5126: np.float32}
_WIDTHS = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4}
BRIGHTEST = 5.0
"""What is added to positions from -1 to 1 for colours that are light, some of it far above 1."""


@pytest.fixture(autouse=True)
def bright_bake(run_instead):
    """Bake light that is the position of each corner, moved to where all of it is positive."""
    run_instead(partial(_bright_bake, back=False))


def _bright_bake(scene, settings, progress, back):
    result = position_bake(scene, settings, progress, back=back)
    meshes = tuple(
        dataclasses.replace(mesh, radiosity=mesh.radiosity + BRIGHTEST, irradiance=mesh.irradiance + BRIGHTEST)
        for mesh in result.meshes
    )
    return dataclasses.replace(result, meshes=meshes)


def light(places, share):
    """Return the radiosity (share 1) or irradiance (share 0.5) that the bake gives to places."""
    return share * places + BRIGHTEST


def exported(folder, *objects, material="PLAIN", output="REFINED"):
    """Bake, export and read back; returns the file."""
    bpy.context.scene.radiosity.material = material
    select_also(*objects)
    bake_selected(output)
    path = folder / "baked.glb"
    assert bpy.ops.export_scene.gltf(filepath=str(path), use_visible=True) == {"FINISHED"}
    return pygltflib.GLTF2().load(str(path))


def primitives(gltf):
    return [primitive for mesh in gltf.meshes for primitive in mesh.primitives]


def array(gltf, index):
    accessor = gltf.accessors[index]
    view = gltf.bufferViews[accessor.bufferView]
    start = (view.byteOffset or 0) + (accessor.byteOffset or 0)
    width = _WIDTHS[accessor.type]
    values = np.frombuffer(gltf.binary_blob(), _TYPES[accessor.componentType], width * accessor.count, start)
    return values.reshape(-1, width)


def places(gltf, primitive):
    """Return (n, 3) the vertices in Blender's axes."""
    x, y, z = array(gltf, primitive.attributes.POSITION).T
    return np.stack([x, -z, y], axis=1)


@pytest.mark.parametrize("output", ["REFINED", "ORIGINAL"])
@pytest.mark.parametrize("back", [False, True])
def test_every_vertex_carries_its_radiosity_as_linear_floats(tmp_path, run_instead, output, back):
    run_instead(partial(_bright_bake, back=back))
    gltf = exported(tmp_path, add_cube(), output=output)
    (primitive,) = primitives(gltf)
    assert gltf.accessors[primitive.attributes.COLOR_0].componentType == pygltflib.FLOAT
    colours = array(gltf, primitive.attributes.COLOR_0)[:, :3]
    where = places(gltf, primitive)
    assert len(where) >= 24
    assert colours == pytest.approx(light(where, 1.0), abs=1e-5)


def test_the_material_is_unlit_as_the_light_is_in_the_colours(tmp_path):
    gltf = exported(tmp_path, add_cube(materials=[diffuse_material()]))
    (material,) = gltf.materials
    assert "KHR_materials_unlit" in material.extensions
    assert material.pbrMetallicRoughness.baseColorFactor in (None, [1.0, 1.0, 1.0, 1.0])


def add_textured_plane():
    material = node_material("Wood", "ShaderNodeBsdfPrincipled")
    use_image(material)
    image = bpy.data.images.new("Grain", 4, 4)
    image.pixels = np.tile([0.5, 0.25, 0.125, 1.0], 16)
    image.pack()
    next(node for node in material.node_tree.nodes if node.type == "TEX_IMAGE").image = image
    plane = add_plane(materials=[material])
    layer = plane.data.uv_layers.new(name="Map")
    corners = np.array([plane.data.vertices[loop.vertex_index].co[:2] for loop in plane.data.loops])
    layer.data.foreach_set("uv", (0.5 + 0.5 * corners).reshape(-1))
    return plane


def test_with_textures_the_image_is_multiplied_with_the_irradiance(tmp_path):
    gltf = exported(tmp_path, add_textured_plane(), material="TEXTURED")
    (primitive,) = primitives(gltf)
    where = places(gltf, primitive)
    assert array(gltf, primitive.attributes.COLOR_0)[:, :3] == pytest.approx(light(where, 0.5), abs=1e-5)
    coordinates = array(gltf, primitive.attributes.TEXCOORD_0)
    # glTF counts v downwards.
    assert coordinates == pytest.approx(np.stack([0.5 + 0.5 * where[:, 0], 0.5 - 0.5 * where[:, 1]], 1), abs=1e-6)
    material = gltf.materials[primitive.material]
    assert "KHR_materials_unlit" in material.extensions
    texture = gltf.textures[material.pbrMetallicRoughness.baseColorTexture.index]
    assert gltf.images[texture.source].name == "Grain"


def test_with_textures_a_plain_colour_is_the_base_colour_factor(tmp_path):
    cube = add_cube(materials=[diffuse_material(colour=(0.25, 0.5, 0.75, 1.0))])
    gltf = exported(tmp_path, cube, material="TEXTURED")
    (primitive,) = primitives(gltf)
    (material,) = gltf.materials
    assert material.pbrMetallicRoughness.baseColorFactor == pytest.approx([0.25, 0.5, 0.75, 1.0])
    colours = array(gltf, primitive.attributes.COLOR_0)[:, :3]
    assert colours == pytest.approx(light(places(gltf, primitive), 0.5), abs=1e-5)


def test_with_textures_a_lamp_beside_other_faces_is_as_bright_as_it_emits(tmp_path):
    vertices = [(-1, -1, 0), (1, -1, 0), (1, 1, 0), (-1, 1, 0), (3, -1, 0), (3, 1, 0)]
    obj = add_mesh("Both", vertices, [(0, 1, 2, 3), (1, 4, 5, 2)], materials=[diffuse_material(), emission_material()])
    obj.data.polygons[1].material_index = 1
    gltf = exported(tmp_path, obj, material="TEXTURED")
    by_name = {material.name: material for material in gltf.materials}
    assert "KHR_materials_unlit" in by_name["Paint Radiosity"].extensions
    shine = by_name["Shine Radiosity"]
    strength = shine.extensions["KHR_materials_emissive_strength"]["emissiveStrength"]
    assert strength * np.array(shine.emissiveFactor) == pytest.approx([5.0, 5.0, 5.0])
