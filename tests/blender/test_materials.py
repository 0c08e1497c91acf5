# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""What each kind of material does to light, and what is said about the rest."""

import math

import bpy
import numpy as np
import pytest
from radiosity_bake.operators.materials import material_surface
from radiosity_bake.operators.shaders import GREY

from tests.blender.making import (
    diffuse_material,
    emission_material,
    link_surface,
    node_material,
    node_tree,
    socket_of,
    use_image,
)


def assert_surface(material, reflectance, emission=(0.0, 0.0, 0.0)):
    surface = material_surface(material)
    assert surface.reflectance == pytest.approx(np.broadcast_to(reflectance, 3), abs=1e-6)
    assert surface.emission == pytest.approx(np.broadcast_to(emission, 3), rel=1e-6)
    return surface.notes


def principled(**inputs):
    return node_material("Plastic", "ShaderNodeBsdfPrincipled", **inputs)


def test_no_material_is_grey():
    assert assert_surface(None, GREY) == ()


def test_a_material_without_nodes_has_its_viewport_colour():
    material = bpy.data.materials.new("Plain")
    if bpy.app.version >= (5, 0, 0):
        pytest.skip("from Blender 5.0 on every material has nodes")
    material.diffuse_color = (0.1, 0.2, 0.3, 1.0)
    assert assert_surface(material, (0.1, 0.2, 0.3)) == ()


def test_principled_reflects_its_base_colour():
    assert assert_surface(principled(Base_Color=(0.1, 0.5, 0.9, 1.0)), (0.1, 0.5, 0.9)) == ()


def test_metal_and_glass_take_from_the_diffuse_reflectance():
    assert_surface(principled(Base_Color=(0.8, 0.8, 0.4, 1.0), Metallic=0.75), (0.2, 0.2, 0.1))
    assert_surface(principled(Base_Color=(0.8, 0.8, 0.4, 1.0), Transmission_Weight=0.5), (0.4, 0.4, 0.2))
    assert_surface(principled(Metallic=1.0), 0.0)


def test_principled_emission_is_colour_times_strength_and_not_clamped():
    material = principled(Emission_Color=(1.0, 0.5, 0.25, 1.0), Emission_Strength=40.0, Metallic=1.0)
    assert_surface(material, 0.0, (40.0, 20.0, 10.0))


def test_diffuse_and_emission_shaders_are_read():
    assert assert_surface(diffuse_material(colour=(0.2, 0.4, 0.6, 1.0)), (0.2, 0.4, 0.6)) == ()
    assert assert_surface(emission_material(colour=(1.0, 0.5, 0.0, 1.0), strength=12.0), 0.0, (12.0, 6.0, 0.0)) == ()


def test_a_mix_of_shaders_is_weighted_by_its_factor():
    material = bpy.data.materials.new("Mixed")
    tree = node_tree(material)
    mix = tree.nodes.new("ShaderNodeMixShader")
    mix.inputs[0].default_value = 0.25
    diffuse, emission = tree.nodes.new("ShaderNodeBsdfDiffuse"), tree.nodes.new("ShaderNodeEmission")
    diffuse.inputs["Color"].default_value = (0.8, 0.4, 0.0, 1.0)
    emission.inputs["Strength"].default_value = 8.0
    tree.links.new(diffuse.outputs[0], mix.inputs[1])
    tree.links.new(emission.outputs[0], mix.inputs[2])
    link_surface(tree, mix)
    assert assert_surface(material, (0.6, 0.3, 0.0), 2.0) == ()


def test_added_shaders_add_up():
    material = bpy.data.materials.new("Added")
    tree = node_tree(material)
    add = tree.nodes.new("ShaderNodeAddShader")
    diffuse, emission = tree.nodes.new("ShaderNodeBsdfDiffuse"), tree.nodes.new("ShaderNodeEmission")
    diffuse.inputs["Color"].default_value = (0.5, 0.5, 0.5, 1.0)
    emission.inputs["Strength"].default_value = 3.0
    tree.links.new(diffuse.outputs[0], add.inputs[0])
    tree.links.new(emission.outputs[0], add.inputs[1])
    link_surface(tree, add)
    assert assert_surface(material, 0.5, 3.0) == ()


def test_nothing_linked_to_the_output_is_black_as_in_a_rendering():
    material = bpy.data.materials.new("Open")
    node_tree(material)
    assert assert_surface(material, 0.0) == ()


def test_reroutes_and_constant_nodes_are_followed():
    material = principled()
    tree = material.node_tree
    shader = next(node for node in tree.nodes if node.type == "BSDF_PRINCIPLED")
    colour, reroute = tree.nodes.new("ShaderNodeRGB"), tree.nodes.new("NodeReroute")
    colour.outputs[0].default_value = (0.3, 0.2, 0.1, 1.0)
    tree.links.new(colour.outputs[0], reroute.inputs[0])
    tree.links.new(reroute.outputs[0], socket_of(shader, "Base Color"))
    assert assert_surface(material, (0.3, 0.2, 0.1)) == ()


def grouped_material(colour):
    """Return a material whose Diffuse BSDF is in a group, its colour an input of the group node."""
    group = bpy.data.node_groups.new("My Paint", "ShaderNodeTree")
    group.interface.new_socket("Paint", in_out="INPUT", socket_type="NodeSocketColor")
    group.interface.new_socket("Shader", in_out="OUTPUT", socket_type="NodeSocketShader")
    inputs, outputs = group.nodes.new("NodeGroupInput"), group.nodes.new("NodeGroupOutput")
    diffuse = group.nodes.new("ShaderNodeBsdfDiffuse")
    group.links.new(inputs.outputs[0], diffuse.inputs["Color"])
    group.links.new(diffuse.outputs[0], outputs.inputs[0])
    material = bpy.data.materials.new("Grouped")
    tree = node_tree(material)
    node = tree.nodes.new("ShaderNodeGroup")
    node.node_tree = group
    node.inputs[0].default_value = colour
    link_surface(tree, node)
    return material


def test_a_group_of_nodes_is_entered_and_its_inputs_count():
    assert assert_surface(grouped_material((0.7, 0.1, 0.2, 1.0)), (0.7, 0.1, 0.2)) == ()


def test_a_muted_mix_passes_its_first_shader_on():
    material = diffuse_material(colour=(0.2, 0.4, 0.6, 1.0))
    tree = material.node_tree
    diffuse = next(node for node in tree.nodes if node.type == "BSDF_DIFFUSE")
    mix = tree.nodes.new("ShaderNodeMixShader")
    tree.links.new(diffuse.outputs[0], mix.inputs[1])
    mix.mute = True
    link_surface(tree, mix)
    assert_surface(material, (0.2, 0.4, 0.6))


def test_what_cannot_be_read_is_left_to_blender_with_its_sockets_colour_until_then():
    material = principled(Base_Color=(0.6, 0.5, 0.4, 1.0))
    use_image(material)
    assert_surface(material, (0.6, 0.5, 0.4))
    assert material_surface(material).unread == ("Image Texture",)


def test_a_texture_on_an_input_that_plays_no_part_is_not_mentioned():
    material = principled()
    use_image(material, "Roughness")
    assert material_surface(material).notes == ()


def test_a_glossy_shader_reflects_no_diffuse_light_and_is_named():
    (note,) = assert_surface(node_material("Mirror", "ShaderNodeBsdfAnisotropic"), 0.0)
    assert "Glossy" in note


def test_what_metal_and_glossy_shaders_mirror_lights_others_in_their_colours():
    gold = (0.9, 0.6, 0.2, 1.0)
    glossy = material_surface(node_material("Gold", "ShaderNodeBsdfAnisotropic", Color=gold))
    assert glossy.sent_on() == pytest.approx(gold[:3], abs=1e-6)
    metal = material_surface(principled(Base_Color=gold, Metallic=1.0))
    assert metal.sent_on() == pytest.approx(gold[:3], abs=1e-6) and not metal.reflectance.any()
    assert not material_surface(diffuse_material()).is_glossy
    assert not material_surface(principled(Specular_IOR_Level=0.0)).is_glossy


def test_a_tinted_coat_dims_what_is_below_it():
    inputs = {"Emission_Strength": 2.0, "Coat_Weight": 0.5, "Coat_Tint": (0.2, 0.6, 1.0, 1.0)}
    material = principled(Base_Color=(0.5, 0.5, 0.5, 1.0), Emission_Color=(1.0, 1.0, 1.0, 1.0), **inputs)
    assert assert_surface(material, (0.3, 0.4, 0.5), (1.2, 1.6, 2.0)) == ()


def test_a_diffuse_shader_that_is_rough_is_named():
    (note,) = assert_surface(node_material("Clay", "ShaderNodeBsdfDiffuse", Roughness=0.5), 0.8)
    assert "Roughness" in note


def test_light_that_scatters_below_the_surface_is_named():
    notes = assert_surface(principled(Base_Color=(0.5, 0.4, 0.3, 1.0), Subsurface_Weight=0.3), (0.5, 0.4, 0.3))
    assert notes == ("light that scatters below its surface counts as diffuse",)


def test_the_part_of_a_principled_shader_that_is_metal_is_named():
    (note,) = material_surface(principled(Metallic=0.5)).notes
    assert "Metallic shows no diffuse light" in note


def test_a_translucent_shader_sends_light_to_the_other_side():
    surface = material_surface(node_material("Paper", "ShaderNodeBsdfTranslucent", Color=(0.8, 0.6, 0.4, 1.0)))
    assert surface.translucence == pytest.approx([0.8, 0.6, 0.4]) and surface.notes == ()
    assert not surface.reflectance.any() and not surface.through.any() and not surface.is_bare


def test_glass_lets_light_through_and_refracts_it():
    glass = material_surface(node_material("Pane", "ShaderNodeBsdfGlass", Color=(0.8, 0.8, 0.8, 1.0), IOR=1.5))
    assert glass.through == pytest.approx(np.full(3, 0.8)) and glass.refraction == pytest.approx(1.5)
    assert glass.is_bare and not glass.clear and glass.notes == ()
    grey = principled(Base_Color=(0.64, 0.64, 0.64, 1.0), Transmission_Weight=0.5, Alpha=0.5, IOR=1.4)
    surface = material_surface(grey)
    # Half of it is not there; of the other half, half is glass, and two surfaces of it make a pane.
    assert surface.through == pytest.approx(np.full(3, 0.5 + 0.5 * 0.5 * 0.8))
    assert surface.reflectance == pytest.approx(np.full(3, 0.16)) and not surface.is_bare


def test_displacement_is_named_by_what_it_does_to_the_surface():
    material = principled()
    tree = material.node_tree
    node = tree.nodes.new("ShaderNodeDisplacement")
    tree.links.new(node.outputs[0], tree.get_output_node("CYCLES").inputs["Displacement"])
    material.displacement_method = "BUMP"
    assert material_surface(material).notes == ("its bump is left out; the mesh's own normals count",)
    material.displacement_method = "DISPLACEMENT"
    (note,) = material_surface(material).notes
    assert "displacement" in note


@pytest.mark.parametrize(
    ("kind", "output", "notes"),
    [
        ("ShaderNodeNormalMap", "Normal", ("its normal map is left out; the mesh's own normals count",)),
        ("ShaderNodeBump", "Normal", ("its bump is left out; the mesh's own normals count",)),
        ("ShaderNodeVectorMath", "Vector", ("its normals by nodes are left out; the mesh's own normals count",)),
        ("ShaderNodeNewGeometry", "Normal", ()),
    ],
)
@pytest.mark.parametrize("shader", ["ShaderNodeBsdfPrincipled", "ShaderNodeBsdfDiffuse"])
def test_what_turns_the_normals_of_a_shader_is_named(shader, kind, output, notes):
    material = node_material("Rough", shader)
    tree = material.node_tree
    lit = next(node for node in tree.nodes if node.bl_idname == shader)
    tree.links.new(tree.nodes.new(kind).outputs[output], lit.inputs["Normal"])
    assert material_surface(material).notes == notes


def test_an_unknown_shader_is_left_to_blender_and_grey_until_then():
    material = node_material("Hair", "ShaderNodeEeveeSpecular")
    assert_surface(material, GREY)
    assert material_surface(material).unread == ("Specular BSDF",)


def test_a_colour_brighter_than_white_is_white():
    (note,) = assert_surface(diffuse_material(colour=(2.0, 0.5, -1.0, 1.0)), (1.0, 0.5, 0.0))
    assert "white" in note


@pytest.mark.parametrize("strength", ["Strength", "Emission_Strength"])
def test_a_negative_emission_counts_as_none_and_is_named(strength):
    node = "ShaderNodeEmission" if strength == "Strength" else "ShaderNodeBsdfPrincipled"
    colour = "Color" if strength == "Strength" else "Emission_Color"
    material = node_material("Hole", node, **{strength: -2.0, colour: (1.0, 0.5, 0.0, 1.0)})
    surface = material_surface(material)
    assert surface.emission.tolist() == [0.0, 0.0, 0.0]
    assert surface.notes == ("its emission is negative; it was taken for zero",)


def test_a_transparent_material_lets_light_through_and_one_in_part_a_part_of_it():
    veil = principled(Alpha=0.0)
    assert_surface(veil, 0.0)
    assert material_surface(veil).clear
    assert material_surface(node_material("Air", "ShaderNodeBsdfTransparent")).clear
    half = principled(Base_Color=(0.8, 0.4, 0.2, 1.0), Alpha=0.5)
    assert assert_surface(half, (0.4, 0.2, 0.1)) == ()
    surface = material_surface(half)
    assert surface.through == pytest.approx(np.full(3, 0.5)) and not surface.clear


def test_a_transparent_shader_lets_its_colour_through():
    surface = material_surface(node_material("Pane", "ShaderNodeBsdfTransparent", Color=(0.9, 0.2, 0.2, 1.0)))
    assert surface.through == pytest.approx([0.9, 0.2, 0.2]) and surface.notes == ()
    assert surface.is_bare and not surface.clear


def mixed_by(socket_of_tree, first, second):
    """Return a material that mixes two shader nodes, (type, inputs), by an output that a function makes."""
    material = bpy.data.materials.new("Mixed")
    tree = node_tree(material)
    mix = tree.nodes.new("ShaderNodeMixShader")
    tree.links.new(socket_of_tree(tree), mix.inputs[0])
    for place, (kind, inputs) in ((1, first), (2, second)):
        node = tree.nodes.new(kind)
        for name, value in inputs.items():
            socket_of(node, name).default_value = value
        tree.links.new(node.outputs[0], mix.inputs[place])
    link_surface(tree, mix)
    return material


def sided_material(front, back):
    """Return a material whose two sides are two shader nodes, mixed by Backfacing; each is (type, inputs)."""
    return mixed_by(lambda tree: tree.nodes.new("ShaderNodeNewGeometry").outputs["Backfacing"], front, back)


def test_emission_may_end_behind():
    shine = ("ShaderNodeEmission", {"Strength": 3.0})
    dark = sided_material(shine, ("ShaderNodeBsdfDiffuse", {"Color": (0.0, 0.0, 0.0, 1.0)}))
    assert assert_surface(dark, 0.0, 3.0) == ()
    assert material_surface(dark).front_only
    assert not material_surface(sided_material(shine, shine)).front_only


def test_a_back_of_another_colour_counts_as_the_front_and_is_named():
    red, blue = (("ShaderNodeBsdfDiffuse", {"Color": colour}) for colour in ((1, 0, 0, 1), (0, 0, 1, 1)))
    (note,) = assert_surface(sided_material(red, blue), (1.0, 0.0, 0.0))
    assert "from behind" in note


RED, BLUE = (("ShaderNodeBsdfDiffuse", {"Color": colour}) for colour in ((0.9, 0.0, 0.0, 1.0), (0.0, 0.0, 0.9, 1.0)))


def ray(name):
    return lambda tree: tree.nodes.new("ShaderNodeLightPath").outputs[name]


def test_what_only_the_camera_sees_does_not_travel():
    assert assert_surface(mixed_by(ray("Is Camera Ray"), RED, BLUE), (0.9, 0.0, 0.0)) == ()
    assert assert_surface(mixed_by(ray("Is Diffuse Ray"), RED, BLUE), (0.0, 0.0, 0.9)) == ()
    lit = emission_material()
    tree = lit.node_tree
    shine = next(node for node in tree.nodes if node.type == "EMISSION")
    tree.links.new(ray("Is Camera Ray")(tree), shine.inputs["Strength"])
    assert assert_surface(lit, 0.0, 0.0) == ()


def test_glass_that_is_clear_to_shadow_and_diffuse_rays_is_clear():
    def either(tree):
        most = tree.nodes.new("ShaderNodeMath")
        most.operation = "MAXIMUM"
        path = tree.nodes.new("ShaderNodeLightPath")
        for name, socket in zip(("Is Shadow Ray", "Is Diffuse Ray"), most.inputs, strict=False):
            tree.links.new(path.outputs[name], socket)
        return most.outputs[0]

    surface = material_surface(mixed_by(either, ("ShaderNodeBsdfGlass", {}), ("ShaderNodeBsdfTransparent", {})))
    assert surface.clear and surface.notes == () and surface.unread == ()


def test_a_shader_of_which_nothing_is_mixed_in_says_nothing():
    glossy = ("ShaderNodeBsdfGlossy", {})
    assert assert_surface(mixed_by(ray("Is Camera Ray"), RED, glossy), (0.9, 0.0, 0.0)) == ()


def test_what_depends_on_the_angle_counts_as_its_mean_and_is_named():
    def fresnel(tree):
        node = tree.nodes.new("ShaderNodeFresnel")
        node.inputs["IOR"].default_value = 1.5
        return node.outputs[0]

    # Of even light, the share that a smooth surface mirrors: Fresnel's formula, integrated by Walsh 1926.
    n = 1.5
    mirrored = 0.5 + (n - 1.0) * (3.0 * n + 1.0) / (6.0 * (n + 1.0) ** 2)
    mirrored += n**2 * (n**2 - 1.0) ** 2 / (n**2 + 1.0) ** 3 * math.log((n - 1.0) / (n + 1.0))
    mirrored -= 2.0 * n**3 * (n**2 + 2.0 * n - 1.0) / ((n**2 + 1.0) * (n**4 - 1.0))
    mirrored += 8.0 * n**4 * (n**4 + 1.0) / ((n**2 + 1.0) * (n**4 - 1.0) ** 2) * math.log(n)
    (note,) = assert_surface(mixed_by(fresnel, RED, BLUE), (0.9 * (1.0 - mirrored), 0.0, 0.9 * mirrored))
    assert "Fresnel" in note and "mean" in note

    def facing(tree):
        return tree.nodes.new("ShaderNodeLayerWeight").outputs["Facing"]

    # At its blend of 0.5 it is one less the cosine, whose mean over even light is a third.
    assert_surface(mixed_by(facing, RED, BLUE), (0.6, 0.0, 0.3))


def test_a_box_of_smoke_is_clear_and_its_smoke_is_named():
    material = bpy.data.materials.new("Smoke")
    tree = node_tree(material)
    output = next(node for node in tree.nodes if node.type == "OUTPUT_MATERIAL")
    tree.links.new(tree.nodes.new("ShaderNodeVolumePrincipled").outputs[0], output.inputs["Volume"])
    surface = material_surface(material)
    assert surface.clear and "volume" in surface.notes[0]
    diffuse = tree.nodes.new("ShaderNodeBsdfDiffuse")
    tree.links.new(diffuse.outputs[0], output.inputs["Surface"])
    surface = material_surface(material)
    assert not surface.clear and "volume" in surface.notes[0]
