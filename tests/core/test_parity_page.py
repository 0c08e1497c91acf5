# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The page of parity with Cycles: what counts as met, and that it says what does not."""

import pytest

from bench.parity.page import met, page

CASE = {
    "topic": "lamps",
    "title": "Sun",
    "cycles": [0.2, 0.3, 0.4],
    "ours": [0.2, 0.3, 0.41],
    "difference_of_mean": 0.003,
    "difference": 0.012,
    "difference_with_rims": 0.05,
    "noise": 0.001,
    "warnings": [],
    "picture": "sun.jpg",
}
ROOM = {
    "topic": "rooms",
    "title": "A bedroom",
    "objects": 12,
    "vertices": 9000,
    "processor_seconds": 30.0,
    "brightest": 2.0,
    "warnings": ["World: its texture was left out"],
    "left": [],
    "file_changed": False,
    "picture": "bedroom.jpg",
    "picture_difference": 0.02,
    "picture_difference_of_mean": -0.004,
}


@pytest.mark.parametrize(
    ("difference", "noise", "expected"), [(0.02, 0.0, True), (0.021, 0.0, False), (0.024, 0.005, True)]
)
def test_a_row_is_met_within_two_percent_and_the_noise(difference, noise, expected):
    assert met({**CASE, "difference": difference, "noise": noise}) == expected


@pytest.mark.parametrize(("picture_difference", "expected"), [(0.02, True), (0.03, False)])
def test_a_row_whose_picture_counts_is_met_within_two_percent_of_that_too(picture_difference, expected):
    row = {**CASE, "picture_difference": picture_difference}
    assert met(row) == expected
    assert f"differ by {picture_difference:.2%}" in page({"sun": row})


@pytest.mark.parametrize(
    "change",
    [
        {"brightest": 0.0},
        {"processor_seconds": 120.0},
        {"left": ["/objects/Box: was moved"]},
        {"file_changed": True},
        {"said": "Nothing in the scene emits light"},
        {"failed": "its process ended with code -11"},
        {"picture_difference": 0.03},
        {"picture_difference_of_mean": 0.015},
        {"picture_difference_of_mean": -0.015},
    ],
)
def test_a_room_that_is_black_slow_changed_unlike_or_not_baked_is_not_met(change):
    assert met(ROOM)
    assert not met({**ROOM, **change})


def test_the_noise_of_cycles_picture_is_not_held_against_a_room_nor_is_a_camera_that_is_missing():
    assert met({**ROOM, "picture_difference": 0.03, "picture_noise": 0.008})
    assert not met({**ROOM, "picture_difference": 0.03, "picture_noise": 0.006})
    assert met({name: value for name, value in ROOM.items() if not name.startswith("picture")})


def test_a_file_with_nothing_to_bake_is_met_if_it_is_left_as_it_was():
    said = {**ROOM, "topic": "files", "said": "Nothing in it renders as faces"}
    assert met(said)
    assert not met({**said, "left": ["/objects: changed"]})


def test_the_page_counts_what_is_met_shows_pictures_and_tells_what_failed():
    failed = {"topic": "world", "title": "Sky Texture", "failed": "RuntimeError: no sky"}
    unmet = {**CASE, "title": "Spot", "difference": 0.5, "warnings": ["its texture was left out"], "picture": None}
    noted = {**CASE, "note": "its disk is seen", "blender": "4.2.1"}
    text = page({"sun": noted, "spot": {**unmet, "blender": "5.2.3"}, "sky": failed, "bedroom": ROOM})
    assert "- Sun: its disk is seen" in text
    assert "Measured in Blender 4.2.1 (1 rows), 5.2.3 (1 rows)." in text
    assert "**2 of 4 rows are met.**" in text
    assert "**Spot** is not met: its texture was left out." in text
    assert "**Sky Texture** is not met: RuntimeError: no sky." in text
    assert "A bedroom: its picture differs" not in text
    assert "A bedroom: its picture differs" in page({"bedroom": {**ROOM, "picture_difference": 0.03}})
    assert "images/parity/sun.jpg" in text and "images/parity/bedroom.jpg" in text
    assert "World: its texture was left out" in text
