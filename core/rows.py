# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Rows of traced rays, and the form factors that follow from counting where they ended."""

from __future__ import annotations

from dataclasses import dataclass, fields

import numpy as np
from numpy.typing import NDArray

from .sampling import Singles
from .scene import Floats, Ints

ESCAPED = -1
"""Hit of a ray that left the scene."""

BURIED = -2
"""Hit of a ray that started inside a solid: it met a side of a mesh that no light reaches."""

BYTES_PER_RAY = 20
"""Kept for every ray: element and coarse patch (int32), two barycentric weights and the distance (float32)."""

COVER_GAP = 0.25
"""A point of a patch is covered when its rays end within this share of the patch's size, so close that nothing but what
covers it can see it: a ceiling above a lamp that hangs a millimetre below."""


@dataclass(frozen=True, eq=False)
class Rows:
    """Rows of equally many rays.

    Attributes
    ----------
    element : (k,) int
    hits : (k, r) int32
        Element that each ray met, `ESCAPED` or `BURIED`.
    root : (k, r) int32
        Coarse patch of each hit; cell of the world's map, if there is one, of each ray that left the scene.
    weights : (k, r, 2) float32
        Where on the coarse patch.
    distance : (k, r) float32
        In the ray library's units.
    valid : (k,) int
        Rays that did not start inside a solid.
    """

    element: Ints
    hits: NDArray[np.int32]
    root: NDArray[np.int32]
    weights: Singles
    distance: Singles
    valid: Ints

    @staticmethod
    def none(rays: int) -> Rows:
        """No rows of so many rays."""
        return Rows(
            np.zeros(0, np.int64),
            np.zeros((0, rays), np.int32),
            np.zeros((0, rays), np.int32),
            np.zeros((0, rays, 2), np.float32),
            np.zeros((0, rays), np.float32),
            np.zeros(0, np.int64),
        )

    def taken(self, which: NDArray[np.bool_] | Ints | slice) -> Rows:
        """Some of the rows."""
        return Rows(*(getattr(self, field.name)[which] for field in fields(self)))

    @staticmethod
    def stacked(parts: list[Rows]) -> Rows:
        """Rows below each other."""
        return Rows(*(np.concatenate([getattr(p, field.name) for p in parts]) for field in fields(Rows)))

    def continued(self, more: Rows) -> Rows:
        """The same elements with the rays of `more` behind their own."""
        return Rows(
            self.element,
            np.concatenate([self.hits, more.hits], axis=1),
            np.concatenate([self.root, more.root], axis=1),
            np.concatenate([self.weights, more.weights], axis=1),
            np.concatenate([self.distance, more.distance], axis=1),
            self.valid + more.valid,
        )


@dataclass(frozen=True, eq=False)
class Shares:
    """Form factors as shares of rays, one entry for each pair that exchanges any; a receiver's entries are together.

    Attributes
    ----------
    receiver, source : (p,) int
        Elements; `source` may be `ESCAPED`.
    share : (p,) float
        Form factor from receiver to source: share of the receiver's valid rays.
    rays : (p,) int
        Valid rays of the receiver.
    """

    receiver: Ints
    source: Ints
    share: Floats
    rays: Ints

    def standard_error(self) -> Floats:
        """Binomial standard error of each share, with one hit added so that a share of 0 or 1 keeps one, (p,)."""
        count = self.rays
        padded = (self.share * count + 1.0) / (count + 2.0)
        return np.sqrt(padded * (1.0 - padded) / count)


@dataclass(frozen=True, eq=False)
class Cover:
    """Elements that are covered in part, as two elements each: one for far rays, a twin for short ones.

    Whatever lies close above a patch sees its covered part only, and what is far only the rest; one value for both
    would let the light in between leak out.

    Attributes
    ----------
    element : (k,) int
        Elements that are covered in part; their twins are numbered on from 2 * nodes.
    points, normals : (k, COVER_POINTS, 3) float
        Where they were tested.
    short : (k, points) float
        Share of the rays from there that are short: a point belongs to either part by so much.
    first_twin : int
    twin : (2 * nodes,) int32
        -1 for an element without one.
    reach : (2 * nodes,) float32
        Length of a short ray, in the ray library's units.
    """

    element: Ints
    points: Floats
    normals: Floats
    short: Floats
    first_twin: int
    twin: NDArray[np.int32]
    reach: Singles

    def base_of(self, element: Ints) -> Ints:
        """The element itself, or the one that it is a twin of, (n,)."""
        return np.concatenate([np.arange(self.first_twin), self.element])[element]

    def tell_apart(self, element: NDArray[np.int32], distance: Singles) -> None:
        """Replace elements met by short rays by their twins, in place; shapes alike."""
        flat, length = element.reshape(-1), distance.reshape(-1)
        short = np.flatnonzero((length < self.reach[flat]) & (self.twin[flat] >= 0))
        flat[short] = self.twin[flat[short]]


def joined(parts: list[Shares]) -> Shares:
    """Entries of several lists in one; no receiver may be in two of them."""
    return Shares(*(np.concatenate([getattr(p, field.name) for p in parts]) for field in fields(Shares)))


def all_shares(table: Rows) -> Shares:
    """Count equal hits in each row."""
    ordered = np.sort(table.hits, axis=1)
    change = np.ones(ordered.shape, dtype=bool)
    np.not_equal(ordered[:, 1:], ordered[:, :-1], out=change[:, 1:])
    starts = np.flatnonzero(change)
    count = np.diff(np.append(starts, ordered.size))
    row = starts // ordered.shape[1]
    source = ordered.ravel()[starts].astype(np.int64)
    some = source != BURIED
    row, source, count = row[some], source[some], count[some]
    return Shares(table.element[row], source, count / table.valid[row], table.valid[row])


def split_shares(table: Rows, cover: Cover) -> Shares:
    """Count equal hits in each row, its far rays for the element and its short ones for the twin."""
    short = table.distance < cover.reach[table.element][:, None]
    receiver = np.where(short, cover.twin[table.element][:, None], table.element[:, None]).astype(np.int64)
    seen = table.hits != BURIED
    key, count = np.unique((receiver[seen] << 32) + (table.hits[seen] + 2), return_counts=True)
    receiver, source = key >> 32, (key & 0xFFFFFFFF) - 2
    valid = np.bincount(receiver, weights=count, minlength=cover.first_twin + len(cover.element)).astype(np.int64)
    return Shares(receiver, source, count / valid[receiver], valid[receiver])


def shares_to(table: Rows, wanted: NDArray[np.bool_]) -> Shares:
    """Count equal hits in each row, of wanted elements alone."""
    place = np.flatnonzero(wanted[table.hits])
    key = np.sort((place // table.hits.shape[1] << 32) | table.hits.ravel()[place])
    starts = np.flatnonzero(np.diff(key, prepend=-1))
    count = np.diff(np.append(starts, len(key)))
    row, source = key[starts] >> 32, key[starts] & 0xFFFFFFFF
    return Shares(table.element[row], source, count / table.valid[row], table.valid[row])
