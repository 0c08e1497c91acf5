# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Gather rays are looked up again in the light of the vertices until that settles."""

import numpy as np
import pytest
from radiosity_bake.core import lighting
from radiosity_bake.core.bake import bake
from radiosity_bake.core.settings import BakeSettings

from bench.scenes import SCENES


@pytest.fixture
def changes(monkeypatch):
    """How far each look of the bakes to come changes the light of the seen vertices, relative to their mean."""
    found, look_again = [], lighting.look_again

    def watched(workers, radiance, gathered):
        after = look_again(workers, radiance, gathered)
        seen = ~after.hidden
        difference = after.irradiance[seen] - gathered.irradiance[seen]
        found.append(float(np.sqrt((difference**2).mean()) / after.irradiance[seen].mean()))
        return after

    monkeypatch.setattr(lighting, "look_again", watched)
    return found


def test_light_that_goes_to_and_fro_is_looked_at_until_it_settles(changes):
    # Behind a corner all light has been reflected, so the second look still changes it by a percent or two.
    bake(SCENES["corridor"](), BakeSettings(quality="DRAFT"))
    assert len(changes) > lighting.FEWEST_LOOKS
    assert all(change > lighting.SETTLED for change in changes[lighting.FEWEST_LOOKS - 1 : -1])
    assert changes[-1] <= lighting.SETTLED


def test_looks_end_where_light_never_settles(changes, monkeypatch):
    monkeypatch.setattr(lighting, "SETTLED", 0.0)
    monkeypatch.setattr(lighting, "MOST_LOOKS", 5)
    bake(SCENES["corridor"](), BakeSettings(quality="DRAFT"))
    assert len(changes) == lighting.MOST_LOOKS
