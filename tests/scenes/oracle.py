# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Slow, exact form factors that share no code with `core`: what its fast ones are tested against.

Two planar polygons see each other only through the part of each that lies in front of the other's plane, and that part
does not depend on the point it is seen from. So both are clipped once, and the rest is the double contour integral

    F_12 = 1 / (2 pi A_1) * sum over edges i of 1, j of 2 of (d_i . d_j) * int int ln |p(s) - q(t)| ds dt

(Sparrow 1963; Schroeder & Hanrahan 1993, "On the form factor between two polygons"), the inner integral in closed form,
the outer one by tanh-sinh quadrature, which does not mind the logarithms where edges touch.
"""

from __future__ import annotations

from itertools import pairwise

import numpy as np
from numpy.typing import ArrayLike, NDArray

Floats = NDArray[np.float64]

# Lengths below this share of the larger polygon's extent count as zero when polygons are clipped and edges compared.
RELATIVE_TOLERANCE = 1e-12


def tanh_sinh_rule(levels: int = 5, reach: float = 3.4) -> tuple[Floats, Floats, Floats]:
    """Nodes of the double-exponential rule on [0, 1].

    Both distances to the ends are returned because `1 - x` loses every digit near 1.

    Returns
    -------
    x, one_minus_x, weight : (n,) float
    """
    step = 2.0**-levels
    t = np.arange(-reach, reach + 0.5 * step, step)
    u = 0.5 * np.pi * np.sinh(t)
    x = 1.0 / (1.0 + np.exp(-2.0 * u))
    one_minus_x = 1.0 / (1.0 + np.exp(2.0 * u))
    weight = step * 0.25 * np.pi * np.cosh(t) / np.cosh(u) ** 2
    return x, one_minus_x, weight


def polygon_area_vector(polygon: ArrayLike) -> Floats:
    """Return the area times the unit normal of a planar polygon.

    Parameters
    ----------
    polygon : (k, 3) array_like, counterclockwise seen from the front
    """
    p = np.asarray(polygon, dtype=np.float64)
    q = p - p[0]
    return 0.5 * np.cross(q, np.roll(q, -1, axis=0)).sum(axis=0)


def clip_to_front(polygon: ArrayLike, point: ArrayLike, normal: ArrayLike) -> Floats:
    """Return the part of a convex polygon in front of a plane (Sutherland & Hodgman 1974).

    Returns
    -------
    (k, 3) float
        Empty where nothing is in front.
    """
    p = np.asarray(polygon, dtype=np.float64)
    if len(p) == 0:
        return p
    height = (p - np.asarray(point)) @ np.asarray(normal)
    height[np.abs(height) <= RELATIVE_TOLERANCE * max(np.ptp(p, axis=0).max(), np.abs(height).max())] = 0.0
    if height.max() <= 0.0:
        return np.empty((0, 3))
    kept = []
    for k in range(len(p)):
        a, b = height[k - 1], height[k]
        if (a < 0.0 < b) or (b < 0.0 < a):
            kept.append(p[k - 1] + (p[k] - p[k - 1]) * (a / (a - b)))
        if b >= 0.0:
            kept.append(p[k])
    return np.array(kept)


def _log_distance_integral(points: Floats, start: Floats, end: Floats) -> Floats:
    """Return the integral of ln |p - q| for q along a segment, for each p in `points` (n, 3)."""
    length = np.linalg.norm(end - start)
    along = (end - start) / length
    a = (start - points) @ along
    b = (end - points) @ along
    foot = points + a[:, None] * along - start
    distance_squared = np.einsum("ij,ij->i", foot, foot)
    distance = np.sqrt(distance_squared)

    def primitive(x: Floats) -> Floats:
        r_squared = x * x + distance_squared
        logarithm = np.log(np.where(r_squared > 0.0, r_squared, 1.0))
        return 0.5 * x * logarithm - x + distance * np.arctan2(x, distance)

    return primitive(b) - primitive(a)


def _breaks(start: Floats, end: Floats, other: Floats) -> Floats:
    """Return where along an edge the other polygon comes close: its corners' feet and its edges' nearest points."""
    d = end - start
    dd = d @ d
    found = [0.0, 1.0, *((other - start) @ d / dd)]
    for k in range(len(other)):
        e = other[k] - other[k - 1]
        w = start - other[k - 1]
        ee, de = e @ e, d @ e
        determinant = dd * ee - de * de
        if determinant > 1e-12 * dd * ee:
            found.append((de * (e @ w) - ee * (d @ w)) / determinant)
    inside = np.unique(np.clip(found, 0.0, 1.0))
    return inside[np.concatenate(([True], np.diff(inside) > 1e-9))]


def contour_integral(polygon_1: Floats, polygon_2: Floats) -> float:
    """Return A_1 F_12 of two polygons that lie wholly in front of each other, nothing between them.

    Parameters
    ----------
    polygon_1 : (k, 3) float
    polygon_2 : (l, 3) float
    """
    x, one_minus_x, weight = tanh_sinh_rule()
    total = 0.0
    for i in range(len(polygon_1)):
        start, end = polygon_1[i - 1], polygon_1[i]
        length = np.linalg.norm(end - start)
        if length == 0.0:
            continue
        breaks = _breaks(start, end, polygon_2)
        for s, t in pairwise(breaks):
            p, q = start + s * (end - start), start + t * (end - start)
            nodes = np.where(x[:, None] < 0.5, p + x[:, None] * (q - p), q - one_minus_x[:, None] * (q - p))
            weights = weight * (t - s)
            for j in range(len(polygon_2)):
                edge = polygon_2[j] - polygon_2[j - 1]
                edge_length = np.linalg.norm(edge)
                cosine = (end - start) @ edge
                if edge_length == 0.0 or cosine == 0.0:
                    continue
                inner = _log_distance_integral(nodes, polygon_2[j - 1], polygon_2[j])
                total += cosine / edge_length * float(weights @ inner)
    return total / (2.0 * np.pi)


def form_factor(polygon_1: ArrayLike, polygon_2: ArrayLike) -> float:
    """Return the unoccluded form factor from the front of one convex polygon to the front of another.

    Accurate to about 1e-11, also for polygons that touch, share an edge, or cut each other's plane.

    Parameters
    ----------
    polygon_1, polygon_2 : (k, 3) array_like, scene units
        Counterclockwise seen from the front; triangles included.
    """
    p1, p2 = np.asarray(polygon_1, dtype=np.float64), np.asarray(polygon_2, dtype=np.float64)
    scale = max(np.ptp(p1, axis=0).max(), np.ptp(p2, axis=0).max())
    origin = p1.mean(axis=0)
    p1, p2 = (p1 - origin) / scale, (p2 - origin) / scale
    n1, n2 = polygon_area_vector(p1), polygon_area_vector(p2)
    area = float(np.linalg.norm(n1))
    n1, n2 = n1 / area, n2 / np.linalg.norm(n2)
    seen_1 = clip_to_front(p1, p2[0], n2)
    seen_2 = clip_to_front(p2, p1[0], n1)
    if len(seen_1) < 3 or len(seen_2) < 3:
        return 0.0
    return contour_integral(seen_1, seen_2) / area


def point_to_polygon(point: ArrayLike, normal: ArrayLike, polygon: ArrayLike) -> float:
    """Return the form factor from a point to the front of a convex polygon, clipped to the point's horizon.

    Lambert's formula (1760): the sum over edges of the angle they are seen under, projected on the normal.

    Parameters
    ----------
    point, normal : (3,) array_like
    polygon : (k, 3) array_like
    """
    p, n = np.asarray(point, dtype=np.float64), np.asarray(normal, dtype=np.float64)
    area_vector = polygon_area_vector(polygon)
    if (p - np.asarray(polygon, dtype=np.float64)[0]) @ area_vector <= 0.0:
        return 0.0
    r = clip_to_front(polygon, p, n) - p
    if len(r) < 3:
        return 0.0
    s = np.roll(r, -1, axis=0)
    axis = np.cross(s, r)
    sine = np.linalg.norm(axis, axis=1)
    angle = np.arctan2(sine, np.einsum("ij,ij->i", r, s))
    return float((np.divide(angle, sine, out=np.zeros_like(sine), where=sine > 0.0)[:, None] * axis).sum(0) @ n) / (
        2.0 * np.pi
    )


def segment_is_blocked(start: Floats, end: Floats, triangles: Floats) -> NDArray[np.bool_]:
    """Return whether any triangle lies strictly between the ends of each segment (Moeller & Trumbore 1997).

    Parameters
    ----------
    start, end : (n, 3) float
    triangles : (t, 3, 3) float
    """
    blocked = np.zeros(len(start), dtype=bool)
    direction = end - start
    for a, b, c in triangles:
        e1, e2 = b - a, c - a
        h = np.cross(direction, e2)
        determinant = h @ e1
        with np.errstate(divide="ignore", invalid="ignore"):
            f = 1.0 / determinant
            s = start - a
            u = f * np.einsum("ij,ij->i", s, h)
            q = np.cross(s, e1)
            v = f * np.einsum("ij,ij->i", direction, q)
            t = f * (q @ e2)
            blocked |= (u >= 0.0) & (v >= 0.0) & (u + v <= 1.0) & (t > 1e-9) & (t < 1.0 - 1e-9)
    return blocked


def _triangle_points(triangle: Floats, n: int) -> Floats:
    """Return n*n equal-weight points: the centroids of the triangle's n*n equal parts."""
    i, j = (a.ravel() for a in np.meshgrid(np.arange(n), np.arange(n), indexing="ij"))
    up = i + j < n
    upright = np.stack([i[up] + 1.0 / 3.0, j[up] + 1.0 / 3.0], axis=1)
    down = i + j < n - 1
    turned = np.stack([i[down] + 2.0 / 3.0, j[down] + 2.0 / 3.0], axis=1)
    uv = np.concatenate([upright, turned]) / n
    return triangle[0] + uv[:, :1] * (triangle[1] - triangle[0]) + uv[:, 1:] * (triangle[2] - triangle[0])


def blocked_form_factor(triangle_1: ArrayLike, triangle_2: ArrayLike, blockers: ArrayLike, n: int = 24) -> float:
    """Return the form factor of two separated triangles with triangles between them, by the midpoint rule.

    The error falls as 1/n (shadow edges); the same rule without blockers tells how large it is. Not for pairs that
    touch.

    Parameters
    ----------
    triangle_1, triangle_2 : (3, 3) array_like
    blockers : (t, 3, 3) array_like
    n : int
        Points along an edge: n^4 pairs are tried against every blocker.
    """
    t1, t2 = np.asarray(triangle_1, dtype=np.float64), np.asarray(triangle_2, dtype=np.float64)
    n1, n2 = polygon_area_vector(t1), polygon_area_vector(t2)
    area_2 = np.linalg.norm(n2)
    n1, n2 = n1 / np.linalg.norm(n1), n2 / area_2
    to = _triangle_points(t2, n)
    solid = np.asarray(blockers, dtype=np.float64).reshape(-1, 3, 3)
    total, count = 0.0, 0
    for p in _triangle_points(t1, n):
        d = to - p
        r_squared = np.einsum("ij,ij->i", d, d)
        kernel = np.maximum(d @ n1, 0.0) * np.maximum(-(d @ n2), 0.0) / (np.pi * r_squared**2)
        kernel[segment_is_blocked(np.broadcast_to(p, to.shape), to, solid)] = 0.0
        total += float(kernel.mean())
        count += 1
    return total / count * float(area_2)
