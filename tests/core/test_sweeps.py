# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Where methods fail: the ends of the sweeps of `bench.stability`, against exact answers."""

import pytest

from bench.stability.cases import SWEEPS
from bench.stability.programs import baked


@pytest.mark.parametrize(
    ("name", "value"),
    [
        ("gap", 1.0),
        ("gap", 1e-5),
        ("angle", 179.0),
        ("angle", 1.0),
        ("aspect", 10.0),
        ("scale", 1e-4),
        ("scale", 1e5),
        ("offset", 1e6),
        ("neighbour", 1e4),
        ("point", 1e-6),
        ("emitters", 8192.0),
        ("horizon", 0.0),
        ("horizon", -0.9),
        ("horizon", -0.99),
        ("reflectance", 0.999),
    ],
)
def test_the_light_is_right_where_methods_fail(name, value):
    sweep = SWEEPS[name]
    case = sweep.case_of(value)
    # What the page asks of every value, at the quality that it is measured at.
    assert baked(sweep, case)["said"] == pytest.approx(case.truth, rel=sweep.limit)


def test_the_light_on_the_longest_strip_is_right_in_few_vertices():
    sweep = SWEEPS["aspect"]
    case = sweep.case_of(1e5)
    found = baked(sweep, case, "DRAFT")
    assert found["said"] == pytest.approx(case.truth, rel=sweep.limit)
    # Two strips of 1,024 lengths and four widths, and as many again where the light asks for them.
    assert found["vertices"] < 2 * 2 * 1025 * 5


@pytest.mark.parametrize(
    ("name", "value"),
    [("wall", 1e-2), ("wall", 1e-6), ("wall", 0.0), ("through", 1.0), ("through", 1e-2), ("through", 1e-5)],
)
def test_no_light_gets_into_a_dark_room(name, value):
    sweep = SWEEPS[name]
    # What is asked of every leak.
    assert baked(sweep, sweep.case_of(value), "DRAFT")["said"] < sweep.limit
