# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The settings: the contract's defaults, and a sentence for every value out of range."""

import dataclasses

import pytest
from radiosity_bake.core.errors import BakeError, SettingsError
from radiosity_bake.core.settings import METHODS, OUTPUTS, QUALITIES, BakeSettings


def test_the_defaults_are_those_of_the_contract():
    settings = BakeSettings()
    assert settings.threshold == 0.02
    assert settings.minimum_size == 0.0
    assert settings.method == "ADAPTIVE"
    assert settings.quality == "GOOD"
    assert settings.output == "REFINED"


def test_the_choices_are_those_of_the_contract():
    assert METHODS == ("ADAPTIVE", "UNIFORM")
    assert QUALITIES == ("DRAFT", "GOOD", "HIGH")
    assert set(OUTPUTS) == {"REFINED", "ORIGINAL"}


def test_settings_cannot_be_changed_once_made():
    with pytest.raises(dataclasses.FrozenInstanceError):
        BakeSettings().threshold = 0.5


@pytest.mark.parametrize(
    ("values", "words"),
    [
        ({"threshold": 0.0}, ("Threshold", "above 0")),
        ({"threshold": -1.0}, ("Threshold", "above 0")),
        ({"threshold": 1.5}, ("Threshold", "up to 1")),
        ({"threshold": float("nan")}, ("Threshold", "choose")),
        ({"minimum_size": -0.1}, ("Minimum size", "positive")),
        ({"minimum_size": float("nan")}, ("Minimum size", "positive")),
        ({"minimum_size": float("inf")}, ("Minimum size", "positive")),
        ({"method": "RANDOM"}, ("Method", "ADAPTIVE, UNIFORM")),
        ({"quality": "good"}, ("Quality", "DRAFT, GOOD, HIGH")),
        ({"output": ""}, ("Output", "REFINED")),
        ({"light": "SUN"}, ("Light", "ALL, IRRADIANCE, DIRECT, INDIRECT")),
        ({"domain": "FACE"}, ("Domain", "CORNER, POINT")),
        ({"data_type": "INT"}, ("Data type", "FLOAT, BYTE")),
        ({"byte_maximum": -1.0}, ("byte maximum", "positive")),
        ({"prefix": ".hidden"}, ("prefix", "no dot")),
        ({"prefix": "x" * 33}, ("prefix", "32 characters")),
        ({"material": "GLASS"}, ("Material", "PLAIN, TEXTURED")),
        ({"seed": -1}, ("Seed", "choose 0 to")),
        ({"threads": -2}, ("Threads", "0 for all cores")),
        ({"memory_limit": 1}, ("Memory limit", "64 MiB or more")),
        ({"patch_limit": -1}, ("Patch limit", "0 for none")),
    ],
)
def test_a_value_out_of_range_is_refused_with_what_to_do(values, words):
    with pytest.raises(SettingsError) as caught:
        BakeSettings(**values)
    for word in words:
        assert word in str(caught.value)
    assert "choose" in str(caught.value) and not str(caught.value).endswith(".")
    assert isinstance(caught.value, BakeError)


@pytest.mark.parametrize(
    "values", [{"threshold": 1.0}, {"threshold": 1e-9}, {"minimum_size": 1e-30}, {"memory_limit": 64}]
)
def test_the_ends_of_the_ranges_are_allowed(values):
    BakeSettings(**values)
