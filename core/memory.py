# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""How the memory limit is shared out between traced rays, cells and vertices, by what each of them takes."""

from __future__ import annotations

from dataclasses import dataclass

from .rows import BYTES_PER_RAY

BYTES_PER_CELL, BYTES_PER_KEPT_CELL = 400, 200
"""Of what is seen of its two sides, and where these lie on the faces: with the working copies made of them when rays
are looked up again, and while faces are split and cut."""

CELLS_SHARE = 0.2
"""Share of the memory that cells may take."""

BYTES_OF_BATCHES = 16 * 2**20
"""Of the rays that are on their way."""

BYTES_PER_VERTEX, BYTES_PER_KEPT_VERTEX = 3072, 2400
"""Of the receivers, faces and values of a vertex, but without what its rays met: with the working copies made of them
while faces are split and cut, and when rays are looked up again."""

BYTES_PER_PLACE = 4
"""Kept for every gather ray: the place it met."""

BYTES_PER_TRIANGLE = 600
"""Of the scene, in the ray library too."""

BYTES_PER_SORTED_RAY = 72
"""Of a traced ray while light is gathered: itself, its part in the form factors, and what sorting left in pieces."""

WORKING_COPIES = 6
"""Times the traced rays are in memory while they are sorted into form factors: hits, sorted hits, marks and keys."""

LEAST_RAYS_SHARE = 0.25
"""Share of the memory that traced rays may take in any case: else what the scene's own vertices leave of it."""

LEAST_VERTICES_SHARE = 0.25
"""Share of the memory that vertices may take in any case: else what rays and cells leave of it."""

WITHIN = 1.1
"""Share of the memory limit that a bake may take without a word."""


@dataclass(frozen=True)
class Memory:
    """The memory limit and how many rays share it out.

    Attributes
    ----------
    limit : int
        Bytes.
    rays_per_patch, rays_per_vertex : int
        As the quality wants them.
    """

    limit: int
    rays_per_patch: int
    rays_per_vertex: int

    def most_traced_rays(self, vertices: int, refined: bool) -> int:
        """Rays of patches that there may be beside the scene's own vertices, and one for each patch if it is refined.

        What sorting takes is given back, but not all of it can be used again.
        """
        per_vertex = BYTES_PER_VERTEX + BYTES_PER_PLACE * self.rays_per_vertex
        left = max(self.limit - per_vertex * vertices, int(LEAST_RAYS_SHARE * self.limit))
        with_vertices = per_vertex // self.rays_per_patch if refined else 0
        return left // (BYTES_PER_RAY * WORKING_COPIES + with_vertices)

    def most_cells(self) -> int:
        """Cells that there may be."""
        return int(CELLS_SHARE * self.limit) // BYTES_PER_CELL

    def most_places_kept(self) -> int:
        """Rays of one gather up to which the places that they met are kept."""
        return self.limit // (2 * BYTES_PER_PLACE)

    def room(self, rays: int, cells: int) -> Room:
        """For vertices beside so many traced rays and cells."""
        least = BYTES_OF_BATCHES + BYTES_PER_SORTED_RAY * rays + BYTES_PER_CELL * cells
        return Room(max(self.limit, least + int(LEAST_VERTICES_SHARE * self.limit)), rays, cells)


@dataclass(frozen=True)
class Room:
    """What vertices may take.

    Attributes
    ----------
    limit : int
        Bytes of all together.
    rays, cells : int
        Traced rays and cells that there are.
    """

    limit: int
    rays: int
    cells: int

    def taken(self, vertices: int, met: int) -> int:
        """Bytes that all takes with so many vertices, whose rays have met so many bytes."""
        looking_again = BYTES_PER_CELL * self.cells + BYTES_PER_KEPT_VERTEX * vertices
        splitting = BYTES_PER_KEPT_CELL * self.cells + BYTES_PER_VERTEX * vertices
        return BYTES_OF_BATCHES + BYTES_PER_SORTED_RAY * self.rays + met + max(looking_again, splitting)

    def holds(self, vertices: int, met: int, more: int) -> bool:
        """Whether there is room for more vertices, whose rays meet as many bytes as those of each that there is."""
        return self.taken(vertices + more, met + more * met // max(vertices, 1)) <= self.limit
