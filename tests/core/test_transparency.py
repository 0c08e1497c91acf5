# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Triangles that light goes through."""

from dataclasses import replace

import numpy as np
import pytest
from radiosity_bake.core.bake import bake
from radiosity_bake.core.relight import ChangedSceneError, relight, shape_of
from radiosity_bake.core.scene import Scene
from radiosity_bake.core.settings import BakeSettings

from tests.core.building import DARK, mean_over
from tests.scenes import exact

COARSE = BakeSettings(quality="GOOD", minimum_size=0.5, output="ORIGINAL", keep_transport=True)


def room(*boards):
    """A room with a lamp below its ceiling, and boards across it."""
    lamp = exact.rectangle("lamp", (0.7, 0.7, 1.9), (0, 0.6, 0), (0.6, 0, 0), emission=5.0)
    return Scene((*exact.box_walls((2, 2, 2), reflectance=0.5), lamp, *boards), DARK)


def board(clear):
    """A dark board from wall to wall at half the height, of two triangles."""
    made = exact.rectangle("board", (0, 0, 1), (2, 0, 0), (0, 2, 0), reflectance=0.0)
    return replace(made, baked=False, clear=None if clear is None else np.array(clear))


def floor_light(scene):
    return mean_over(bake(scene, COARSE).meshes[:1])[0]


def test_light_goes_through_clear_faces_as_if_they_were_not_there():
    # Patches and rays of the walls are the same with the board and without, and so is nearly all that they meet.
    assert floor_light(room(board([True, True]))) == pytest.approx(floor_light(room()), rel=0.01)


def test_a_face_of_a_mesh_may_be_clear_and_the_next_one_not():
    half, none = floor_light(room(board([True, False]))), floor_light(room(board([True, True])))
    assert 0.1 * none < half < 0.9 * none
    assert floor_light(room(board(None))) < 0.01 * none


def test_relighting_refuses_what_became_clear():
    kept = bake(room(board(None)), COARSE).kept
    with pytest.raises(ChangedSceneError, match="board"):
        relight(kept, room(board([True, False])))
    assert shape_of(board([False, False])) == shape_of(board(None))
