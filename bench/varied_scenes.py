# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Scenes that nothing was tuned on, as different from each other as what artists bring: for `python -m bench.survey`.

Metres, z up, fronts to the side that is lit. Walls have a thickness and stand on the floor, furniture stands on it too,
things touch and stick in each other: as they are modelled, and not as a method would like them.
"""

from __future__ import annotations

from collections.abc import Callable

from radiosity_bake.core.scene import Scene

from .varied_buildings import attic, bedroom, cave, courtyard, doors, hangar, rotunda, staircase, window_room
from .varied_lamps import flush_lamps, low_lamp, narrow_gap, panel_hall, shaded_lamp
from .varied_places import greenhouse, shop, street, tent, theatre, tunnel
from .varied_things import chequered, matchbox, smooth_bodies, thin_things, tilted, touching_blocks

VARIED_SCENES: dict[str, Callable[[], Scene]] = {
    scene.__name__: scene
    for scene in (
        bedroom,
        attic,
        staircase,
        rotunda,
        cave,
        doors,
        thin_things,
        narrow_gap,
        panel_hall,
        low_lamp,
        flush_lamps,
        shaded_lamp,
        touching_blocks,
        tilted,
        smooth_bodies,
        chequered,
        matchbox,
        hangar,
        window_room,
        courtyard,
        shop,
        tunnel,
        tent,
        greenhouse,
        theatre,
        street,
    )
}
