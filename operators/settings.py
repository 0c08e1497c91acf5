# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The settings of a scene as the artist sees them; their defaults are those of `core`."""

from dataclasses import asdict

import bpy
import numpy as np

from ..core.settings import LONGEST_PREFIX, BakeSettings

DEFAULTS = BakeSettings()

METHOD_ITEMS = (
    (
        "ADAPTIVE",
        "Adaptive",
        "Split surfaces that receive much of the light that leaves others, then the faces on which the light changes",
    ),
    (
        "UNIFORM",
        "Uniform",
        "Split every surface down to the minimum size: simple and even, but slow; good to compare with",
    ),
)
QUALITY_ITEMS = (
    ("DRAFT", "Draft", "Seconds: enough to judge the light while you move things and change colours"),
    ("GOOD", "Good", "Smooth shadows without visible noise: right for most scenes"),
    ("HIGH", "High", "The cleanest shadows and corners, for the final bake; takes several times as long as Good"),
)
OUTPUT_ITEMS = (
    (
        "REFINED",
        "Refined Mesh",
        "Make new objects with as many vertices as the shadows need; the originals are kept, hidden, and come back "
        "with Restore",
    ),
    (
        "ORIGINAL",
        "Original Mesh",
        "Write the light on the corners that your meshes have now, without adding vertices. "
        "Shadows are as sharp as the meshes are fine",
    ),
)
MATERIAL_ITEMS = (
    (
        "AUTOMATIC",
        "Automatic",
        "With textures where a material has some, so that they stay sharp; plain where it is of one colour",
    ),
    ("PLAIN", "Plain", "One material shows the baked light and colours as they are, one colour for each vertex"),
    (
        "TEXTURED",
        "With Textures",
        "A copy of each of your materials multiplies the baked light with its colours and textures, which stay sharp "
        "in renders and in exported glTF files",
    ),
)
LIGHT_ITEMS = (
    ("ALL", "Everything", "All light: Radiosity with the surfaces' own colours, and Irradiance without them"),
    (
        "IRRADIANCE",
        "Lighting Only",
        "All light, but only Irradiance, without the surfaces' own colours: for textures of your own",
    ),
    ("DIRECT", "Direct Only", "Only the light that comes straight from lamps, glowing faces and the World"),
    ("INDIRECT", "Indirect Only", "Only the light that other surfaces reflect: to be added to lamps in a game engine"),
)
DOMAIN_ITEMS = (
    ("CORNER", "Face Corners", "A colour for each corner of each face, so that edges and material borders stay sharp"),
    (
        "POINT",
        "Vertices",
        "One colour for each vertex, the mean of its corners: smaller, but colours run over hard edges",
    ),
)
DATA_TYPE_ITEMS = (
    ("FLOAT", "Float", "32 bits a channel: light of any brightness, as it is"),
    (
        "BYTE",
        "Byte",
        "8 bits a channel: a quarter of the memory. Brightness is scaled to fit, and the report says by how much",
    ),
)


class RadiositySettings(bpy.types.PropertyGroup):
    """What a bake is asked for, and the report of the last one (`scene.radiosity`)."""

    threshold: bpy.props.FloatProperty(
        name="Threshold",
        description=(
            "How finely surfaces that are near each other are split for the light that goes between them. "
            "Smaller: finer colours in corners, and a longer bake. It is the share of another surface's light above "
            "which one is split. Shadows are as fine as Quality makes them, whatever this is"
        ),
        default=DEFAULTS.threshold,
        min=0.000001,
        max=1.0,
        soft_min=0.002,
        soft_max=0.2,
        precision=3,
        step=0.1,
        options=set(),
    )
    minimum_size: bpy.props.FloatProperty(
        name="Minimum Size",
        description=(
            "No face is split into pieces shorter than this. Halve it for sharper shadows, double it for fewer "
            "vertices. 0 chooses it from the size of the scene and the quality"
        ),
        subtype="DISTANCE",
        unit="LENGTH",
        default=DEFAULTS.minimum_size,
        min=0.0,
        soft_max=10.0,
        precision=3,
        options=set(),
    )
    method: bpy.props.EnumProperty(
        name="Method",
        description="Whether vertices go where the light needs them, or everywhere alike",
        items=METHOD_ITEMS,
        default=DEFAULTS.method,
        options=set(),
    )
    quality: bpy.props.EnumProperty(
        name="Quality",
        description="How clean the light and how sharp the shadows are: more rays, more vertices and a longer bake",
        items=QUALITY_ITEMS,
        default=DEFAULTS.quality,
        options=set(),
    )
    output: bpy.props.EnumProperty(
        name="Output",
        description="Which mesh the baked light is written on",
        items=OUTPUT_ITEMS,
        default=DEFAULTS.output,
        options=set(),
    )
    seed: bpy.props.IntProperty(
        name="Seed",
        description="Changes the pattern of the remaining noise; the same seed always gives the same result",
        default=DEFAULTS.seed,
        min=0,
        options=set(),
    )
    threads: bpy.props.IntProperty(
        name="Threads",
        description="Processor cores that trace rays; 0 uses all of them. The result is the same for any number",
        default=DEFAULTS.threads,
        min=0,
        soft_max=64,
        options=set(),
    )
    memory_limit: bpy.props.IntProperty(
        name="Memory Limit (MiB)",
        description=(
            "Memory that the bake may use beside the scene itself, in MiB. "
            "A small limit means fewer patches, vertices and rays, and a warning"
        ),
        default=DEFAULTS.memory_limit,
        min=64,
        soft_max=65536,
        options=set(),
    )
    patch_limit: bpy.props.IntProperty(
        name="Patch Limit",
        description=(
            "Patches that may exchange light; 0 is no limit. What receives least of the light stays coarse, dense "
            "meshes are clustered more coarsely, and a warning says so. Vertices are added where shadows need them "
            "all the same"
        ),
        default=DEFAULTS.patch_limit,
        min=0,
        soft_max=1_000_000,
        options=set(),
    )
    keep_transport: bpy.props.BoolProperty(
        name="Keep for Relighting",
        description=(
            "Keep what the rays of the last bake met in memory, so that Relight can give it other colours. "
            "It takes some tens of megabytes for a room, never more than the memory limit, and is not saved in the file"
        ),
        default=DEFAULTS.keep_transport,
        options=set(),
    )
    light: bpy.props.EnumProperty(
        name="Light",
        description="Which part of the light is stored",
        items=LIGHT_ITEMS,
        default=DEFAULTS.light,
        options=set(),
    )
    light_groups: bpy.props.BoolProperty(
        name="Light Groups",
        description=(
            "Store the light of each of Blender's light groups in a colour attribute of its own, too, "
            "and that of everything without a group in one more; they sum up to the whole"
        ),
        default=DEFAULTS.light_groups,
        options=set(),
    )
    domain: bpy.props.EnumProperty(
        name="Domain",
        description="What the colours are stored on",
        items=DOMAIN_ITEMS,
        default=DEFAULTS.domain,
        options=set(),
    )
    data_type: bpy.props.EnumProperty(
        name="Data Type",
        description="How the colours are stored",
        items=DATA_TYPE_ITEMS,
        default=DEFAULTS.data_type,
        options=set(),
    )
    byte_maximum: bpy.props.FloatProperty(
        name="Byte Maximum",
        description=(
            "Brightness that bytes reach up to; what is brighter is cut off. "
            "0 takes the brightest that was baked, so that nothing is; set it to have several bakes alike"
        ),
        default=DEFAULTS.byte_maximum,
        min=0.0,
        soft_max=100.0,
        options=set(),
    )
    prefix: bpy.props.StringProperty(
        name="Prefix",
        description="What the names of the colour attributes begin with, such as 'Night ' for 'Night Radiosity'",
        default=DEFAULTS.prefix,
        maxlen=LONGEST_PREFIX,
        options=set(),
    )
    material: bpy.props.EnumProperty(
        name="Material",
        description="How the baked objects look; Restore brings your own materials back",
        items=MATERIAL_ITEMS,
        default=DEFAULTS.material,
        options=set(),
    )
    report: bpy.props.StringProperty(
        name="Report",
        description="What came of the last bake, as JSON",
        options={"HIDDEN"},
    )
    token: bpy.props.StringProperty(
        name="Token",
        description="Tells the bake that the scene shows from all others",
        options={"HIDDEN"},
    )
    shading_before: bpy.props.StringProperty(
        name="Shading Before",
        description="What the viewport's solid shading showed before the bake, so that Restore can set it back",
        options={"HIDDEN"},
    )


def _as_typed(value: float) -> float:
    """Return the shortest decimal that Blender rounds to the single-precision `value`: 0.02, not 0.0199999996."""
    return float(str(np.float32(value)))


def bake_settings(properties: RadiositySettings) -> BakeSettings:
    """Return the scene's settings in the form that `core` takes.

    Raises
    ------
    SettingsError
        When a value is outside its range.
    """
    return BakeSettings(
        threshold=_as_typed(properties.threshold),
        minimum_size=_as_typed(properties.minimum_size),
        method=properties.method,
        quality=properties.quality,
        output=properties.output,
        seed=properties.seed,
        threads=properties.threads,
        memory_limit=properties.memory_limit,
        patch_limit=properties.patch_limit,
        keep_transport=properties.keep_transport,
        light=properties.light,
        light_groups=properties.light_groups,
        domain=properties.domain,
        data_type=properties.data_type,
        byte_maximum=_as_typed(properties.byte_maximum),
        prefix=properties.prefix,
        material=properties.material,
    )


def keep_settings(properties: RadiositySettings, settings: BakeSettings) -> None:
    """Write `settings` into the scene's."""
    for name, value in asdict(settings).items():
        setattr(properties, name, value)
