# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""What the artist sees; it shows what the operators know and computes nothing."""

import bpy

from . import object_panel, panel

register, unregister = bpy.utils.register_classes_factory(
    (
        panel.VIEW3D_PT_radiosity,
        panel.VIEW3D_PT_radiosity_output,
        panel.VIEW3D_PT_radiosity_subdivision,
        panel.VIEW3D_PT_radiosity_sampling,
        object_panel.VIEW3D_PT_radiosity_object,
        panel.VIEW3D_PT_radiosity_result,
        object_panel.OBJECT_PT_radiosity,
    )
)
