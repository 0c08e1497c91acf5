# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""What the panel shows of a report."""

import pytest
from radiosity_bake.ui.panel import _rows


@pytest.mark.parametrize(("imbalance", "shown"), [(0.004, "99.6%"), (-0.004, "99.6%"), (3.0, "0.0%")])
def test_the_energy_balance_stands_beside_the_estimated_error(imbalance, shown):
    rows = _rows({"seconds": {"total": 1.0}, "estimated_error": 0.012, "energy": {"imbalance": imbalance}})
    assert rows[-2:] == [("Estimated Error", "1.2%"), ("Energy Balance", shown)]


def test_a_report_without_energy_is_shown_without_its_balance():
    assert _rows({"seconds": {"total": 1.0}}) == [("Time", "1.0 s")]
