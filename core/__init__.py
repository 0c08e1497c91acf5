# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The numerics of Radiosity Bake: arrays in, arrays out, without Blender.

`bake.bake` is the whole of it from top to bottom; `docs/theory.md` names the equations that each module implements.
"""
