# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Subdivision of the scene by form factors: Kulyasov & Nikulin 2010, steps 2 to 6, and the uniform one beside it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import asdict, dataclass

import numpy as np
from numpy.typing import NDArray

from .patches import PatchTree
from .rows import Shares
from .scene import Floats, Ints
from .settings import LARGEST
from .transport import Transport

THRESHOLD_MET = "every form factor is below the threshold"
SIZE_MET = "every fragment whose form factor is above the threshold is at the minimum size"
UNIFORM_MET = "every fragment is at the minimum size"
ROWS_THAT_TELL = 64
"""Rows that are asked first whether any form factor is above the threshold."""

LEAST_AREA = 0.5
"""Area below which patches are not split, in squares of the minimum size n: that of a triangle of size 2n which is four
times as long as wide. Right isosceles ones have twice as much."""

LIMIT_MET = "the memory limit allows no more fragments"
PATCHES_MET = "the patch limit allows no more fragments"


@dataclass(frozen=True)
class Round:
    """What one round of the loop did.

    Attributes
    ----------
    fragments : int
        Leaves at the start of the round.
    new_rows : int
        Elements traced in it: only new receivers.
    rays : int
        Rays traced in it.
    split : int
        Fragments split at its end.
    rays_moved : int
        Rays that met a split fragment and moved to a child without being traced.
    largest_form_factor : float
        Over all pairs whose source could still be split and that no round before has judged; 0 if there is none.
    """

    fragments: int
    new_rows: int
    rays: int
    split: int
    rays_moved: int
    largest_form_factor: float


@dataclass(frozen=True)
class Refinement:
    """How the loop went and why it ended."""

    rounds: tuple[Round, ...]
    ended: str

    def as_report(self) -> list[dict[str, float]]:
        """The rounds as JSON takes them."""
        return [asdict(entry) for entry in self.rounds]


Seeds = Callable[[], Ints]
"""Gives the elements that must be traced whether a ray meets them or not, for the leaves as they are."""


def trace_all(transport: Transport, seeds: Seeds, report: Callable[[float], None]) -> int:
    """Trace every seed, then every element that rays met, until none is missing; returns the rows added."""
    before = transport.row_count()
    wanted = seeds()
    # Where only patches were split that are not baked themselves, no seed is missing, but what rays met is.
    wanted = np.union1d(wanted[~transport.has_row()[wanted]], transport.met_but_untraced())
    while len(wanted):
        transport.trace(wanted, report)
        wanted = transport.met_but_untraced()
    return transport.row_count() - before


def refine(
    transport: Transport,
    seeds: Seeds,
    threshold: float,
    smallest: float,
    most_rays: int,
    report: Callable[[float], None] = lambda share: None,
    most_patches: int = LARGEST,
) -> Refinement:
    """Split fragments by the form factors to them until all are small or weakly coupled.

    A fragment is split when it receives more than `threshold` of the energy that leaves some element, and its size is
    m = 2n or more. Fragments that are not split keep their rays; rays that met a split one move to the right child.
    So the rays that there are name the next fragments to split, too, and new ones are traced only when they name none:
    what a split fragment sees is the mean of what its parts see, and one of them sees as much or more.

    Parameters
    ----------
    smallest : float
        The minimum size n, scene units.
    most_rays : int
        Rays that memory allows.
    most_patches : int
        Fragments that there may be. Where not all can be split that should be, those are that receive the most.
    """
    tree, ended = transport.tree, ""
    rounds: list[Round] = []
    large = fresh = _large(tree, smallest)
    unmet = 0
    while True:
        fragments, rays_before, rows = len(tree.patches()), transport.rays.rays, 0
        trace = not (rounds and fresh.any())
        if trace:
            if rounds:
                transport.drop_split_rows()
            known = transport.row_count()
            rows = trace_all(transport, seeds, report)
            unmet = int(np.count_nonzero(_untraced(transport)[tree.patches()]))
            pairs = transport.shares_to(np.repeat(large, 2), known)
        else:
            pairs = transport.shares_to(np.repeat(fresh, 2))
        highest = _highest_factors(transport, pairs, threshold)
        flagged = np.flatnonzero(highest > threshold)
        if not ended:
            fitting = _those_that_fit(tree, flagged, highest, most_patches - fragments)
            ended = PATCHES_MET if len(fitting) < len(flagged) else ""
            flagged = fitting
            if len(flagged) and _rays_after(transport, flagged, unmet) > most_rays:
                ended, flagged = LIMIT_MET, flagged[:0]
        else:
            flagged = flagged[:0]
        moved = 0
        if len(flagged):
            tree.divide(flagged)
            moved = transport.move_rays()
        rays, largest = transport.rays.rays - rays_before, float(highest.max(initial=0.0))
        rounds.append(Round(fragments, rows, rays, len(flagged), moved, largest))
        if trace and len(flagged) == 0:
            return Refinement(tuple(rounds), ended or _why_ended(transport, threshold))
        # The rays that there are have told all they can of the patches from before.
        before, large = np.append(large, np.zeros(len(tree) - len(large), dtype=bool)), _large(tree, smallest)
        fresh = large & ~before


def _those_that_fit(tree: PatchTree, nodes: Ints, strength: Floats, room: int) -> Ints:
    """The strongest of `nodes` (m,) that may be divided where there is room for so many more patches.

    Parameters
    ----------
    strength : (nodes,) float
        Of every node of the tree.
    """
    strongest_first = nodes[np.argsort(-strength[nodes], kind="stable")]
    made = np.cumsum(tree.parts(strongest_first) - 1)
    return np.sort(strongest_first[: np.searchsorted(made, room, side="right")])


def _untraced(transport: Transport) -> NDArray[np.bool_]:
    """Nodes neither side of which has a row, (nodes,)."""
    return ~transport.has_row().reshape(-1, 2).any(axis=1)


def _rays_after(transport: Transport, flagged: Ints, unmet: int) -> int:
    """Rays that are kept when the patches `flagged` have been split and all patches but the `unmet` have their rows."""
    untraced = _untraced(transport)
    waiting = np.count_nonzero(untraced[transport.tree.patches()]) - unmet - np.count_nonzero(untraced[flagged])
    return int(transport.kept_rays() + (waiting + 4 * len(flagged)) * transport.rays_per_row)


def refine_uniformly(
    transport: Transport,
    seeds: Seeds,
    smallest: float,
    most_rays: int,
    report: Callable[[float], None] = lambda share: None,
    most_patches: int = LARGEST,
) -> Refinement:
    """Split every leaf of size m = 2n or more, down to the minimum size n, then trace."""
    tree, rounds, ended = transport.tree, [], UNIFORM_MET
    while True:
        patches = tree.patches()
        large = patches[_may_be_split(tree, patches, smallest)]
        if len(large) == 0:
            break
        count = len(patches) + int((tree.parts(large) - 1).sum())
        if count > most_patches or count * transport.rays_per_row > most_rays:
            ended = PATCHES_MET if count > most_patches else LIMIT_MET
            break
        rounds.append(Round(len(patches), 0, 0, len(large), 0, 0.0))
        tree.divide(large)
    transport.follow_splits()
    before = transport.rays.rays
    rows = trace_all(transport, seeds, report)
    rounds.append(Round(len(tree.patches()), rows, transport.rays.rays - before, 0, 0, 0.0))
    return Refinement(tuple(rounds), ended)


def _large(tree: PatchTree, smallest: float) -> NDArray[np.bool_]:
    """Whether each node is a patch that may be split, (nodes,)."""
    large, patches = np.zeros(len(tree), dtype=bool), tree.patches()
    large[patches] = _may_be_split(tree, patches, smallest)
    return large


def _may_be_split(tree: PatchTree, nodes: Ints, smallest: float) -> NDArray[np.bool_]:
    """Whether nodes are of size m = 2n or more, and no thin slices that only become thinner, (m,)."""
    slender = tree.areas(nodes) < LEAST_AREA * smallest * smallest
    result: NDArray[np.bool_] = (tree.sizes(nodes) >= 2.0 * smallest) & ~slender
    return result


def _highest_factors(transport: Transport, shares: Shares, threshold: float) -> Floats:
    """The largest form factor from any element to each node, (nodes,).

    The counted share of rays decides where it is more than its standard error away from the threshold. Where the rays
    cannot tell, one pair is computed in closed form: of those with the largest share the one that couples most strongly
    by its distance and angles. Rays have met, so it is not hidden, and what hides a part of it makes the fragment one
    that is rather split.
    """
    highest = np.zeros(len(transport.tree))
    node = shares.source >> 1
    unsure = np.abs(shares.share - threshold) <= shares.standard_error()
    np.maximum.at(highest, node[~unsure], shares.share[~unsure])
    open_pairs = np.flatnonzero(unsure & (highest[node] <= threshold))
    largest = np.zeros(len(transport.tree))
    np.maximum.at(largest, node[open_pairs], shares.share[open_pairs])
    chosen = open_pairs[shares.share[open_pairs] == largest[node[open_pairs]]]
    receiver, source = shares.receiver[chosen], shares.source[chosen]
    strength = transport.coupling(receiver, source)
    # The strongest pair of each node comes last.
    order = np.lexsort((receiver, strength, source >> 1))
    last = order[np.flatnonzero(np.diff(source[order] >> 1, append=-1))]
    exact = transport.unoccluded_factors(receiver[last], source[last])
    np.maximum.at(highest, source[last] >> 1, exact)
    return highest


def _why_ended(transport: Transport, threshold: float) -> str:
    every = np.ones(2 * len(transport.tree), dtype=bool)
    # Where fragments touch there are pairs above it, so that a few rows tell nearly always.
    for few in (ROWS_THAT_TELL, None):
        shares = transport.shares_to(every, 0, few)
        if (shares.share - shares.standard_error() > threshold).any():
            return SIZE_MET
    return SIZE_MET if (_highest_factors(transport, shares, threshold) > threshold).any() else THRESHOLD_MET


def typical_standard_error(shares: Shares, threshold: float) -> float:
    """Standard error of a form factor as large as the threshold, for the median element."""
    rays = float(np.median(shares.rays)) if len(shares.rays) else 1.0
    return float(np.sqrt(threshold * (1.0 - threshold) / rays))
