# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The settings of one object, in the sidebar and in the object's properties."""

import bpy

from ..operators.record import source_of
from ..operators.targets import shows_surfaces


class _OfObject:
    bl_label = "Object"
    bl_options = {"DEFAULT_CLOSED"}  # noqa: RUF012 - Blender reads it from the class

    @classmethod
    def poll(cls, context):
        """Return whether the active object takes part in the light as a surface."""
        return context.object is not None and shows_surfaces(source_of(context.object))

    def draw(self, context):
        """Draw the panel. The settings of a refined object are those of its original, which bakes read."""
        layout = self.layout
        layout.use_property_split = True
        layout.use_property_decorate = False
        obj = source_of(context.object)
        settings = obj.radiosity_settings
        if obj != context.object:
            layout.label(text=f"Of {obj.name}", icon="OBJECT_DATA")
        column = layout.column(heading="Reflectance", align=True)
        column.prop(settings, "use_reflectance", text="Override")
        colour = column.column()
        colour.active = settings.use_reflectance
        colour.prop(settings, "reflectance", text="")
        column = layout.column(heading="Light")
        column.prop(settings, "emits")
        column.prop(settings, "receives")
        column.prop(settings, "casts")


class VIEW3D_PT_radiosity_object(_OfObject, bpy.types.Panel):
    """The active object's settings, in the sidebar."""

    bl_space_type = "VIEW_3D"
    bl_region_type = "UI"
    bl_category = "Radiosity"
    bl_parent_id = "VIEW3D_PT_radiosity"


class OBJECT_PT_radiosity(_OfObject, bpy.types.Panel):
    """The same among the object's properties."""

    bl_label = "Radiosity Bake"
    bl_space_type = "PROPERTIES"
    bl_region_type = "WINDOW"
    bl_context = "object"
