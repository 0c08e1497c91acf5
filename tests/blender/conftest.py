# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Every test starts in an empty file of factory settings, with the extension registered once for the session."""

import importlib.util
import sys

import pytest

if "bpy" not in sys.modules and importlib.util.find_spec("bpy") is None:
    collect_ignore_glob = ["test_*.py"]
else:
    import bpy
    import radiosity_bake

    @pytest.fixture(scope="session", autouse=True)
    def registered():
        radiosity_bake.register()
        yield
        radiosity_bake.unregister()

    @pytest.fixture(autouse=True)
    def empty_file(registered):
        bpy.ops.wm.read_factory_settings(use_empty=True)
        yield
        assert radiosity_bake.operators.bake.RADIOSITY_OT_bake.job is None, "a bake was left running"

    @pytest.fixture
    def quick_bake(monkeypatch):
        """Have bakes hand back the position of each corner as its colour, without tracing a ray."""
        from tests.blender.making import position_bake

        monkeypatch.setattr("radiosity_bake.operators.bake._core_bake", lambda: position_bake)
        return position_bake
