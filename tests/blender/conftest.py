# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Every test starts in an empty file of factory settings, with the extension registered once for the session."""

import importlib.util
import os
import sys

import pytest

if "bpy" not in sys.modules and importlib.util.find_spec("bpy") is None:
    collect_ignore_glob = ["test_*.py"]
else:
    import bpy
    import radiosity_bake

    ended = pytest.StashKey[int]()

    def pytest_sessionfinish(session, exitstatus):
        session.config.stash[ended] = int(exitstatus)

    def pytest_unconfigure(config):
        # When Python takes the module of Blender 4.2 down at its end, that may crash, though only pytest was imported
        # and no test was run: it depends on what else there is to free.
        if not bpy.app.binary_path and ended in config.stash:
            sys.stdout.flush()
            sys.stderr.flush()
            os._exit(config.stash[ended])

    @pytest.fixture(scope="session", autouse=True)
    def registered():
        radiosity_bake.register()
        yield
        radiosity_bake.unregister()

    @pytest.fixture(autouse=True)
    def empty_file(registered):
        bpy.ops.wm.read_factory_settings(use_empty=True)
        yield
        assert radiosity_bake.operators.doors.Watch.running is None, "a bake was left running"

    @pytest.fixture
    def run_instead(monkeypatch):
        """Return a function that has bakes run another function in place of the core's."""

        def replace(function):
            monkeypatch.setattr("radiosity_bake.operators.bake._core_bake", lambda: function)

        return replace

    @pytest.fixture
    def quick_bake(run_instead):
        """Have bakes hand back the position of each corner as its colour, without tracing a ray.

        Returns the list of the (scene, settings) that bakes are then given.
        """
        from tests.blender.making import position_bake

        given = []

        def bake(scene, settings, progress, **_):
            given.append((scene, settings))
            return position_bake(scene, settings, progress)

        run_instead(bake)
        return given

    @pytest.fixture
    def refused_settings(monkeypatch):
        """Have the settings be refused, and return the sentence."""
        from radiosity_bake.core.errors import SettingsError

        sentence = "Threshold is 0; choose a value above 0 and up to 1"

        def refuse(properties):
            raise SettingsError(sentence)

        monkeypatch.setattr("radiosity_bake.operators.bake.bake_settings", refuse)
        return sentence
