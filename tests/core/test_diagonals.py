# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Diagonals are turned along the light, and the faces still fit together."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pytest
from radiosity_bake.core.diagonals import turned
from radiosity_bake.core.geometry import triangle_cross
from radiosity_bake.core.scene import Floats, Ints

CELLS = 16
"""Squares along a side of the sheet, whose diagonals all run from the low left to the high right."""


@dataclass(frozen=True)
class Sheet:
    """A square cut into squares, each of two triangles."""

    points: Floats
    triangles: Ints

    def turned(self, light: Floats, group: Ints | None = None, least: float = 0.0) -> Ints:
        """The triangles when diagonals are turned for light at the points, (p, c)."""
        group = np.zeros(len(self.triangles), dtype=np.int64) if group is None else group
        corner = turned(self.points[self.triangles], light[self.triangles], self.triangles, group, least)
        result: Ints = self.triangles.ravel()[corner]
        return result


def even_sheet(cells: int) -> Sheet:
    x, y = (k.ravel() for k in np.meshgrid(np.arange(cells + 1), np.arange(cells + 1), indexing="ij"))
    i, j = (k.ravel() for k in np.meshgrid(np.arange(cells), np.arange(cells), indexing="ij"))
    a = i * (cells + 1) + j
    b, c, d = a + cells + 1, a + cells + 2, a + 1
    triangles = np.stack([a, b, c, a, c, d], axis=1).reshape(-1, 3)
    return Sheet(np.stack([x, y, 0 * x], axis=1) / cells, triangles)


@pytest.fixture
def sheet() -> Sheet:
    return even_sheet(CELLS)


def penumbra(points: Floats) -> Floats:
    """Light that falls off across a line from the high left to the low right, (p, 1)."""
    return np.tanh(8.0 * (points[:, :1] + points[:, 1:2] - 1.1))


def missed(points: Floats, triangles: Ints) -> float:
    """RMS error of interpolating the penumbra, at seven places of each triangle; all are alike in size."""
    shares = np.array([[1, 1, 1], [4, 1, 1], [1, 4, 1], [1, 1, 4], [1, 2, 2], [2, 1, 2], [2, 2, 1]], dtype=np.float64)
    shares /= shares.sum(axis=1, keepdims=True)
    shown = shares @ penumbra(points)[triangles]
    truth = penumbra((shares @ points[triangles]).reshape(-1, 3)).reshape(shown.shape)
    return float(np.sqrt(((shown - truth) ** 2).mean()))


def test_a_penumbra_that_crosses_all_diagonals_is_drawn_better_by_the_same_vertices(sheet: Sheet) -> None:
    triangles = sheet.turned(penumbra(sheet.points))
    # Across a square the wrong diagonal bridges twice the way over the penumbra that its sides do, the right one none.
    # Second differences go with the square of that; turning takes away most of the error.
    assert missed(sheet.points, triangles) < 0.5 * missed(sheet.points, sheet.triangles)


def test_turned_faces_cover_the_same_area_once(sheet: Sheet) -> None:
    triangles = sheet.turned(np.random.default_rng(1).random((len(sheet.points), 3)))
    assert (triangles != sheet.triangles).any()
    normal = triangle_cross(sheet.points, triangles)[:, 2]
    assert normal.min() > 0.0
    assert normal.sum() / 2.0 == pytest.approx(1.0)
    start, end = triangles.ravel(), np.roll(triangles, -1, axis=1).ravel()
    ways = set(zip(start.tolist(), end.tolist(), strict=True))
    assert len(ways) == 3 * len(triangles)
    alone = [(a, b) for a, b in ways if (b, a) not in ways]
    # The outline has four sides.
    assert len(alone) == 4 * CELLS


def test_only_diagonals_within_a_group_are_turned(sheet: Sheet) -> None:
    light = np.random.default_rng(2).random((len(sheet.points), 1))
    of_its_own = np.arange(len(sheet.triangles))
    assert np.array_equal(sheet.turned(light, of_its_own), sheet.triangles)


def test_faces_stay_within_their_group_while_those_around_them_are_turned() -> None:
    # Diagonals turn in many rounds, and the number of an edge that waits may then be that of another: on this sheet, of
    # one between two strips.
    cells, random = 8, np.random.default_rng(112)
    even = even_sheet(cells)
    points, triangles = even.points.copy(), even.triangles
    points[:, :2] += random.uniform(-0.3, 0.3, (len(points), 2)) / cells
    first = random.integers(0, 3, len(triangles))[:, None]
    triangles = np.take_along_axis(triangles, (first + np.arange(3)) % 3, axis=1)
    triangles = triangles[random.permutation(len(triangles))]
    strip = (even.points[triangles].mean(axis=1)[:, 0] * cells // 2).astype(np.int64)
    turned_triangles = Sheet(points, triangles).turned(random.random((len(points), 1)), strip)
    x = even.points[turned_triangles][..., 0] * cells
    assert (x >= 2.0 * strip[:, None]).all()
    assert (x <= 2.0 * strip[:, None] + 2.0).all()


def test_even_light_and_less_than_is_worth_it_turn_none(sheet: Sheet) -> None:
    plane = sheet.points @ np.array([[1.0], [2.0], [0.0]])
    # Rounding bends a plane by 1e-15.
    assert np.array_equal(sheet.turned(plane, least=1e-12), sheet.triangles)
    assert np.array_equal(sheet.turned(penumbra(sheet.points), least=10.0), sheet.triangles)
