# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The tab "Radiosity" in the sidebar of the 3D viewport."""

import json
import textwrap
from collections.abc import Sequence

import bpy

from ..operators.bake import reason_not_to_bake
from ..operators.doors import Watch

_CHARACTER_WIDTH = 7.0
"""Average width of a letter in pixels at a scale of 1, to break sentences where the panel ends."""


class _InSidebar:
    bl_space_type = "VIEW_3D"
    bl_region_type = "UI"
    bl_category = "Radiosity"


class VIEW3D_PT_radiosity(_InSidebar, bpy.types.Panel):
    """The settings that every bake asks for, its button or its progress, and the way back."""

    bl_label = "Radiosity Bake"

    def draw(self, context):
        """Draw the panel."""
        layout = self.layout
        layout.use_property_split = True
        layout.use_property_decorate = False
        settings = context.scene.radiosity
        running = Watch.running

        column = layout.column()
        column.active = running is None
        column.prop(settings, "quality")
        column.prop(settings, "output")

        if running is not None:
            _draw_progress(layout, running.latest)
            return
        row = layout.row()
        row.scale_y = 1.5
        row.operator("radiosity.bake", icon="LIGHT_AREA")
        reason = reason_not_to_bake(context)
        if reason is not None:
            _draw_sentence(layout, context, reason, "INFO")
        layout.operator_menu_enum("radiosity.bake_frames", "frame_output", icon="RENDER_ANIMATION")
        layout.operator("radiosity.relight", icon="SHADING_RENDERED")
        layout.operator("radiosity.restore", icon="LOOP_BACK")


class VIEW3D_PT_radiosity_subdivision(_InSidebar, bpy.types.Panel):
    """How surfaces are split, for those whom the quality alone does not serve."""

    bl_label = "Subdivision"
    bl_parent_id = "VIEW3D_PT_radiosity"
    bl_options = {"DEFAULT_CLOSED"}  # noqa: RUF012 - Blender reads it from the class

    def draw(self, context):
        """Draw the panel."""
        _draw_settings(self.layout, context, ("minimum_size", "method", "threshold"))


class VIEW3D_PT_radiosity_sampling(_InSidebar, bpy.types.Panel):
    """Settings that are seldom needed."""

    bl_label = "Sampling"
    bl_parent_id = "VIEW3D_PT_radiosity"
    bl_options = {"DEFAULT_CLOSED"}  # noqa: RUF012 - Blender reads it from the class

    def draw(self, context):
        """Draw the panel."""
        _draw_settings(self.layout, context, ("seed", "threads", "memory_limit", "patch_limit", "keep_transport"))


class VIEW3D_PT_radiosity_output(_InSidebar, bpy.types.Panel):
    """What is written, and how it is shown."""

    bl_label = "Attributes and Material"
    bl_parent_id = "VIEW3D_PT_radiosity"
    bl_options = {"DEFAULT_CLOSED"}  # noqa: RUF012 - Blender reads it from the class

    def draw(self, context):
        """Draw the panel."""
        maximum = ("byte_maximum",) if context.scene.radiosity.data_type == "BYTE" else ()
        names = ("material", "light", "light_groups", "domain", "data_type", *maximum, "prefix")
        _draw_settings(self.layout, context, names)


class VIEW3D_PT_radiosity_result(_InSidebar, bpy.types.Panel):
    """What came of the last bake."""

    bl_label = "Last Bake"
    bl_parent_id = "VIEW3D_PT_radiosity"

    @classmethod
    def poll(cls, context):
        """Return whether there was a bake."""
        return bool(context.scene.radiosity.report)

    def draw(self, context):
        """Draw the panel."""
        report = json.loads(context.scene.radiosity.report)
        layout = self.layout
        grid = layout.column(align=True)
        for name, value in _rows(report):
            split = grid.split(factor=0.45)
            left = split.row()
            left.alignment = "RIGHT"
            left.label(text=name)
            split.label(text=value)
        for warning in report.get("warnings", ()):
            _draw_sentence(layout, context, warning, "ERROR")


def _rows(report: dict) -> list[tuple[str, str]]:
    rows = [
        (name, f"{report[key]:,}")
        for name, key in (("Patches", "patches"), ("Vertices", "vertices"), ("Rays", "rays"))
        if key in report
    ]
    if report.get("minimum_size"):
        rows.append(("Minimum Size", f"{report['minimum_size']:.3g}"))
    rows.append(("Time", f"{report['seconds']['total']:.1f} s"))
    if report.get("estimated_error") is not None:
        rows.append(("Estimated Error", f"{report['estimated_error']:.1%}"))
    if "energy" in report:
        accounted_for = 1.0 - abs(report["energy"]["imbalance"])
        rows.append(("Energy Balance", f"{max(accounted_for, 0.0):.1%}"))
    return rows


def _draw_settings(layout, context, names: Sequence[str]) -> None:
    """Draw settings of the scene below each other, greyed while a bake runs."""
    layout.use_property_split = True
    layout.use_property_decorate = False
    layout.active = Watch.running is None
    for name in names:
        layout.prop(context.scene.radiosity, name)


def _draw_progress(layout, progress) -> None:
    column = layout.column(align=True)
    row = column.row(align=True)
    row.scale_y = 1.5
    row.progress(factor=progress.share, text=f"{progress.stage}  {progress.share:.0%}")
    row.operator("radiosity.cancel", text="", icon="X")
    if progress.detail:
        column.label(text=progress.detail)


def _draw_sentence(layout, context, sentence: str, icon: str) -> None:
    """Draw a sentence over as many lines as the width of the panel asks for."""
    scale = context.preferences.system.ui_scale
    width = max(int(context.region.width / (_CHARACTER_WIDTH * scale)) - 6, 16)
    column = layout.column(align=True)
    column.scale_y = 0.8
    for number, line in enumerate(textwrap.wrap(sentence, width)):
        column.label(text=line, icon=icon if number == 0 else "BLANK1")
