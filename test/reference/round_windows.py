# This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
# SPDX-License-Identifier: Apache-2.0

"""What the references of domes and tubes have in common: what no light reaches the camera from, or the camera's light does not reach."""
from make_reference import along, dot, in_field, mp, mpf, project_lens, rounded
from make_wedge_reference import directions_at

TILTS = (0, 1e-7, 10, 30, 50, 70, 80, 88)       # degrees from the optical axis


def reflected(rng, window, lens, parameters, half_field):
    """Pixels whose light stays inside."""
    pixels = []
    for _ in range(200):
        w = next(directions_at(rng, window, rng.uniform(0, 88)))
        if in_field(w, half_field) and window.trace_out(w) is None and len(pixels) < 4:
            pixels.append(rounded(project_lens(lens, parameters, w)))
    return pixels


def dark(window, center, side_of):
    """Points outside, in a plane with the camera and the center, that no direction sees: all that stay in the plane pass them by.

    side_of: from the unit vector from the center to the camera, the one across it in the plane
    """
    e = mp.sqrt(dot(center, center))
    if min(n * r for n, r in zip(window.media[1:], window.radii)) >= window.media[0] * e:
        return []
    ahead = tuple(-c / e for c in center)
    side = side_of(ahead)
    seen, radius = [], 3 * window.radii[-1]
    for i in range(721):
        angle = mp.pi * i / 720
        traced = window.trace_out(tuple(mp.cos(angle) * u + mp.sin(angle) * v for u, v in zip(ahead, side)))
        if traced is None:
            continue
        off = tuple(p - c for p, c in zip(traced[0], center))
        way = dot(off, traced[1])
        x = along(off, -way + mp.sqrt(way**2 - dot(off, off) + radius**2), traced[1])
        seen.append(mp.atan2(dot(x, side), dot(x, ahead)))
    seen.sort()
    gap, low, high = max((b - a, a, b) for a, b in zip(seen, seen[1:]))
    if gap < mpf(10) * mp.pi / 720:
        return []
    return [rounded(c + radius * (mp.cos(a) * u + mp.sin(a) * v) for c, u, v in zip(center, ahead, side))
            for a in (low + gap / 4, low + gap / 2, high - gap / 4)]
