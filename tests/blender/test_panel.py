# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""What the panel shows of the settings and of a report."""

import types

import bpy
import pytest
from radiosity_bake.core.settings import BakeSettings
from radiosity_bake.ui import panel
from radiosity_bake.ui.panel import _rows


@pytest.mark.parametrize(("imbalance", "shown"), [(0.004, "99.6%"), (-0.004, "99.6%"), (3.0, "0.0%")])
def test_the_energy_balance_stands_beside_the_estimated_error(imbalance, shown):
    rows = _rows({"seconds": {"total": 1.0}, "estimated_error": 0.012, "energy": {"imbalance": imbalance}})
    assert rows[-2:] == [("Estimated Error", "1.2%"), ("Energy Balance", shown)]


def test_a_report_without_energy_is_shown_without_its_balance():
    assert _rows({"seconds": {"total": 1.0}}) == [("Time", "1.0 s")]


class Layout:
    """Writes down what is drawn, in its order, whatever rows and columns it is in."""

    def __init__(self, drawn):
        self._drawn = drawn

    def __getattr__(self, name):
        return lambda *arguments, **options: self

    def prop(self, owner, name, **options):
        self._drawn.append(name)

    def operator(self, name, **options):
        self._drawn.append(name)


def drawn_by(kind):
    """Return the settings and operators that a panel draws."""
    context = types.SimpleNamespace(
        scene=bpy.context.scene,
        mode="OBJECT",
        selected_objects=[],
        region=types.SimpleNamespace(width=300),
        # Without a window its scale is 0.
        preferences=types.SimpleNamespace(system=types.SimpleNamespace(ui_scale=1.0)),
    )
    drawn = []
    kind.draw(types.SimpleNamespace(layout=Layout(drawn)), context)
    return drawn


def test_above_the_bake_button_stands_only_what_every_bake_asks_for():
    drawn = drawn_by(panel.VIEW3D_PT_radiosity)
    assert drawn[: drawn.index("radiosity.bake")] == ["quality", "output"]


def test_every_setting_stands_in_one_panel():
    panels = [getattr(panel, name) for name in dir(panel) if name.startswith("VIEW3D_PT")]
    bpy.context.scene.radiosity.data_type = "BYTE"
    drawn = [name for kind in panels if kind is not panel.VIEW3D_PT_radiosity_result for name in drawn_by(kind)]
    settings = [name for name in drawn if not name.startswith("radiosity.")]
    assert sorted(settings) == sorted(BakeSettings.__dataclass_fields__)
