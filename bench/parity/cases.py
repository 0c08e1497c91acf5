# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The list of all cases, in the order in which the page shows them."""

from __future__ import annotations

import importlib
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

# Files of cases, each a section of the page.
TOPICS = {
    "lamps": "Lamps",
    "world": "World",
    "materials": "Materials",
    "geometry": "Geometry",
    "output": "Output",
}

SAMPLES = 1024


@dataclass(frozen=True)
class Case:
    """A feature, and the scene that shows it.

    Attributes
    ----------
    name : str
        By which it is asked for.
    topic : str
        A key of `TOPICS`.
    title : str
        Of its row.
    build : callable
        Builds the scene in an empty file and returns the mesh objects whose light is compared.
    samples : int
        Of Cycles, for each face corner and each of two seeds.
    quantity : str
        The attribute that is compared: `'Irradiance'` with Cycles' DIFFUSE bake without Color, `'Radiosity'` with the
        sum of its DIFFUSE bake with Color and its EMIT bake; `'Irradiance Back'` and `'Radiosity Back'` with what
        Cycles bakes on the same meshes turned over.
    settings : dict
        Of `scene.radiosity`, for both bakes of ours.
    ours : callable or None
        Takes the objects once Cycles has baked them, bakes them in a way of its own and returns (c, 3) the colours of
        each; None bakes the scene as it is.
    faces : bool
        Whether the picture is judged too, as what counts lies between the vertices.
    note : str
        What there is to know of the row's difference.
    """

    name: str
    topic: str
    title: str
    build: Callable[[], list[Any]]
    samples: int
    quantity: str
    settings: dict[str, Any]
    ours: Callable[[list[Any]], list[Any]] | None
    faces: bool
    note: str


_cases: dict[str, Case] = {}


def case(
    title: str,
    *,
    samples: int = SAMPLES,
    quantity: str = "Irradiance",
    ours: Callable[[list[Any]], list[Any]] | None = None,
    faces: bool = False,
    note: str = "",
    **settings: Any,
) -> Callable[[Callable[[], list[Any]]], Callable[[], list[Any]]]:
    """Return a decorator that puts the function which builds a scene on the list; its name is the row's."""

    def listed(build: Callable[[], list[Any]]) -> Callable[[], list[Any]]:
        topic = build.__module__.rpartition(".")[2]
        if build.__name__ in _cases:
            raise ValueError(f"There are two cases {build.__name__}")
        _cases[build.__name__] = Case(
            build.__name__, topic, title, build, samples, quantity, settings, ours, faces, note
        )
        return build

    return listed


def all_cases() -> dict[str, Case]:
    """Return every case by its name, topic after topic."""
    for topic in TOPICS:
        importlib.import_module(f"{__package__}.{topic}")
    order = list(TOPICS)
    return dict(sorted(_cases.items(), key=lambda item: order.index(item[1].topic)))
