# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Faces with the light that was gathered at them."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from .direct import LUMINANCE
from .error_estimate import DIM, Expected, Neighbours, interpolation_error, lit_area, neighbours
from .gather import Gathered, corner_values
from .geometry import triangle_areas
from .patches import PatchTree
from .receivers import Receivers
from .scene import Floats, Ints
from .subdivision import Faces
from .surfaces import Surfaces


@dataclass(frozen=True, eq=False)
class Lit:
    """Faces and the light gathered at them.

    Attributes
    ----------
    faces : Faces
    face, side : (f,) int
        Faces and sides (1: the back) with values: all fronts in order, then some backs.
    places : Receivers
        `of_corner` has a row for each face side.
    gathered : Gathered
        At the receivers.
    share : (faces,) float
        Part of each face's area that counts: less than 1 where it lies in a patch that is far larger than others.
    """

    faces: Faces
    face: Ints
    side: Ints
    places: Receivers
    gathered: Gathered
    share: Floats

    @cached_property
    def neighbours(self) -> Neighbours:
        """The face sides that share an edge."""
        return neighbours(self.faces.points[self.faces.corners[self.face]], self.places.of_corner)

    def corner_irradiance(self) -> Floats:
        """Irradiance over pi at the corners of the face sides, (f, 3, 3)."""
        return corner_values(self.gathered, self.places.of_corner)

    def weights(self, surfaces: Surfaces) -> Floats:
        """Area of each face side whose error counts, (f,): none of emitters and of what is hidden altogether."""
        emission = surfaces.emission_over(self.faces.triangle, self.faces.weights)
        dark = np.all(emission[self.face] == 0.0, axis=1)
        shown = np.any(~self.gathered.hidden[self.places.of_corner], axis=1)
        area = triangle_areas(self.faces.points[self.faces.corners[self.face]])
        return np.where(dark & shown, area * self.share[self.face], 0.0)

    def expected_error(self, surfaces: Surfaces) -> Expected:
        """What the light at the vertices lets expect of the error of the face sides."""
        corners = self.faces.points[self.faces.corners[self.face]]
        irradiance = self.corner_irradiance()
        return Expected(
            self.weights(surfaces),
            irradiance.mean(axis=(1, 2)),
            interpolation_error(corners, self.neighbours, irradiance) ** 2,
            (self._noise_of_channels()[self.places.of_corner] ** 2).mean(axis=1),
            self.side == 0,
        )

    def areas_of(self, surfaces: Surfaces, faces: Faces, face: Ints) -> Floats:
        """Area of sides of faces that these were cut into, (f,), as far as their error counts; hidden ones alike.

        Parameters
        ----------
        face : (f,) int
        """
        share = np.ones(int(self.faces.node.max(initial=0)) + 1)
        share[self.faces.node] = self.share
        emission = surfaces.emission_over(faces.triangle, faces.weights)
        area = triangle_areas(faces.points[faces.corners]) * share[faces.node]
        counted: Floats = np.where(np.all(emission == 0.0, axis=1), area, 0.0)[face]
        return counted

    def noise(self, surfaces: Surfaces, strict: Floats) -> float:
        """Noise of the hemisphere rays over the surface, relative to the mean of what has light.

        Where errors count for more, so does the area: a room that a picture is exposed for fills it.

        Parameters
        ----------
        strict : (faces, 2) float
            How many times more it counts, on each side of the faces.
        """
        weight, light = self.weights(surfaces), (self.corner_irradiance() @ LUMINANCE).mean(axis=1)
        _, mean = lit_area(weight, weight * light)
        if mean <= 0.0:
            return 0.0
        times = strict[self.face, self.side]
        square = (self.gathered.noise[self.places.of_corner] ** 2).mean(axis=1) * times**2
        weight *= times
        area = float((weight * np.minimum(light * times / (DIM * mean), 1.0)).sum())
        return math.sqrt(float(weight @ square) / area) / mean

    def _noise_of_channels(self) -> Floats:
        """Noise at the receivers, RMS over the channels, were it in each the same share of the light, (n,)."""
        light = self.gathered.irradiance
        luminance = light @ LUMINANCE
        square = self.gathered.noise**2 * (light**2).mean(axis=1)
        noise: Floats = np.sqrt(np.divide(square, luminance**2, out=np.zeros_like(square), where=luminance > 0.0))
        return noise

    def redrawn(self, corner: Ints | None) -> Lit:
        """The same light on faces whose diagonals were turned.

        A face may then lie in two leaves of the tree, and is still said to lie in one of them.

        Parameters
        ----------
        corner : (faces, 3) int or None
            Their corners, as numbers of the corners that there are, counted through all faces; None for the same.
        """
        if corner is None:
            return self
        faces, of_corner, count = self.faces, self.places.of_corner.ravel(), len(self.faces.triangle)
        row = np.zeros(count, dtype=np.int64)
        row[self.face[count:]] = np.arange(count, len(self.face))
        behind = (3 * row[corner // 3] + corner % 3)[self.face[count:]]
        drawn = replace(
            faces,
            corners=faces.corners.ravel()[corner],
            vertices=faces.vertices.ravel()[corner],
            weights=faces.weights.reshape(-1, 3)[corner],
        )
        places = replace(self.places, of_corner=np.concatenate([of_corner[corner], of_corner[behind]]))
        return replace(self, faces=drawn, places=places)

    def part(self, kept: NDArray[np.bool_]) -> Lit:
        """Some of the faces, (faces,) bool, which share no receiver with the others."""
        rows = np.flatnonzero(kept[self.face])
        receivers, of_corner = np.unique(self.places.of_corner[rows], return_inverse=True)
        return Lit(
            self.faces.taken(np.flatnonzero(kept)),
            (np.cumsum(kept) - 1)[self.face[rows]],
            self.side[rows],
            replace(self.places.taken(receivers), of_corner=of_corner.reshape(-1, 3)),
            self.gathered.taken(receivers),
            self.share[kept],
        )

    def with_others(self, kept: NDArray[np.bool_], others: Lit, tree: PatchTree) -> Lit:
        """Some of the faces, (faces,) bool, and all of `others`, in the order of the leaves of `tree` they lie in.

        None of the two shares a receiver with the other.
        """
        own, rows = np.flatnonzero(kept), np.flatnonzero(kept[self.face])
        order = np.argsort(np.concatenate([self.faces.node[own], others.faces.node]), kind="stable")
        number = np.empty_like(order)
        number[order] = np.arange(len(order))
        face = number[np.concatenate([(np.cumsum(kept) - 1)[self.face[rows]], len(own) + others.face])]
        side = np.concatenate([self.side[rows], others.side])
        of_corner = np.concatenate([self.places.of_corner[rows], len(self.places.codes) + others.places.of_corner])
        codes = np.concatenate([self.places.codes, others.places.codes])
        receivers = np.unique(of_corner)
        receivers = receivers[np.argsort(codes[receivers], kind="stable")]
        place = np.empty(len(codes), dtype=np.int64)
        place[receivers] = np.arange(len(receivers))
        sorted_sides = np.lexsort([face, side])
        return Lit(
            self.faces.taken(own).joined(others.faces, tree).taken(order),
            face[sorted_sides],
            side[sorted_sides],
            replace(self.places.joined(others.places, receivers), of_corner=place[of_corner[sorted_sides]]),
            self.gathered.joined(others.gathered, receivers),
            np.concatenate([self.share[own], others.share])[order],
        )
