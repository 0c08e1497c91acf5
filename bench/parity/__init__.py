# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""What an artist lights in Cycles, lit the same here: a row of `docs/parity.md` for every feature.

A feature is one small function in the file of its topic, marked with `@case`. It builds a scene in the open, empty file
and returns the objects whose light is compared:

    @case("Point lamp, radius 0")
    def point_without_radius():
        floor = stage.room()
        stage.lamp("POINT", shadow_soft_size=0.0)
        return [floor]

A scene with a camera also gets pictures. `python -m bench.parity point_without_radius` measures the row, keeps all
others, and writes the page.
"""
