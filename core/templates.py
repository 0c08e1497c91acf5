# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""How a triangle is cut when its edges have a vertex on them: red-green closure (Bank, Sherman & Weiser 1983)."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from .scene import Floats, Ints

# By the edges that have a vertex (bit 0: 0-1, bit 1: 1-2, bit 2: 2-0). Points 0 to 2 are the corners, 3 to 5 the
# vertices on 0-1, 1-2, 2-0. Two of them leave a quadrilateral, cut along either diagonal.
_M01, _M12, _M20 = 3, 4, 5
Piece = tuple[int, int, int]
TEMPLATES: dict[int, tuple[Piece, ...]] = {
    0: ((0, 1, 2),),
    1: ((0, _M01, 2), (_M01, 1, 2)),
    2: ((1, _M12, 0), (_M12, 2, 0)),
    4: ((2, _M20, 1), (_M20, 0, 1)),
    3: ((_M01, 1, _M12), (0, _M01, _M12), (0, _M12, 2)),
    6: ((_M12, 2, _M20), (1, _M12, _M20), (1, _M20, 0)),
    5: ((_M20, 0, _M01), (2, _M20, _M01), (2, _M01, 1)),
    7: ((0, _M01, _M20), (_M01, 1, _M12), (_M20, _M12, 2), (_M12, _M20, _M01)),
}
OTHER_DIAGONAL: dict[int, tuple[Piece, ...]] = {
    3: ((_M01, 1, _M12), (0, _M01, 2), (_M01, _M12, 2)),
    6: ((_M12, 2, _M20), (1, _M12, 0), (_M12, _M20, 0)),
    5: ((_M20, 0, _M01), (2, _M20, 1), (_M20, _M01, 1)),
}
DIAGONALS = {3: ((0, _M12), (_M01, 2)), 6: ((1, _M20), (_M12, 0)), 5: ((2, _M01), (_M20, 1))}


def cut(points: Floats, six: Ints, present: NDArray[np.bool_]) -> tuple[Ints, Ints]:
    """Cut triangles at the vertices on their edges, quadrilaterals along the shorter diagonal.

    Parameters
    ----------
    points : (v, 3) float
    six : (m, 6) int
        Corners, then the vertices on the edges 0-1, 1-2, 2-0 (anything where there is none).
    present : (m, 3) bool
        Which edges have one.

    Returns
    -------
    member : (s,) int
        The triangle each piece comes from, ascending.
    piece : (s, 3) int
        Its corners as columns of `six`.
    """
    code = present @ np.array([1, 2, 4])
    members, pieces = [], []
    for bits, template in TEMPLATES.items():
        chosen = np.flatnonzero(code == bits)
        groups = [(chosen, template)]
        if bits in OTHER_DIAGONAL:
            (a, b), (c, d) = DIAGONALS[bits]
            first = np.linalg.norm(points[six[chosen, a]] - points[six[chosen, b]], axis=1)
            second = np.linalg.norm(points[six[chosen, c]] - points[six[chosen, d]], axis=1)
            shorter = second < first
            groups = [(chosen[~shorter], template), (chosen[shorter], OTHER_DIAGONAL[bits])]
        for group, template in groups:
            members.append(np.repeat(group, len(template)))
            pieces.append(np.tile(np.array(template, dtype=np.int64), (len(group), 1)))
    member, piece = np.concatenate(members), np.concatenate(pieces)
    order = np.argsort(member, kind="stable")
    return member[order], piece[order]
