#!/usr/bin/env python3
# This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
# SPDX-License-Identifier: Apache-2.0

"""Reference values for domes, computed with 60 digits (python3-mpmath).

    test/reference/make_dome_reference.py       # writes dome.json beside itself

Independent of the library: light goes out by Snell's law in its vector form, sphere by sphere, each met by the quadratic equation;
no moment, no angle. All else as make_wedge_reference.py has it.

dome.json: a list of cases (one lens, one dome), each with
  points      X (camera frame) -> pixel; the same pixel, rounded to double -> a point of its ray outside, and the direction
  unseen      points X that no light reaches the camera from (total reflection)
  unseeing    pixels whose ray is totally reflected
  posed       one object point with rvec, tvec: pixel and its jacobian (columns as refractiveProjectPoints' jacobian)
"""
import random

from make_reference import along, dot, exact, mp, mpf, unit
from make_wedge_reference import LENSES, Window, make_point, make_posed, refracted, write_cases
from round_windows import TILTS, dark, reflected

SEED = 20261126

DOMES = [  # name, center, radius, thickness, index, inner, outer
    ("thin dome in air", (1.0, -2.0, 3.0), 50, [1.5], [1.5168], 1, 1),
    ("thick dome in air", (8.0, 5.0, -20.0), 50, [20], [1.7], 1, 1),
    ("dome in water", (0.5, -0.25, 1.0), 55, [7], [1.5168], 1, 1.333),
    ("far off the centre, in water", (18.0, -6.0, -23.0), 50, [4], [1.49], 1, 1.333),
    ("ahead of the centre, in water", (-3.0, 2.0, -29.0), 50, [25], [1.8], 1, 1.333),
    ("centre beside the camera", (25.0, 10.0, 0.0), 50, [6], [1.52], 1, 1.333),
    ("centred", (0.0, 0.0, 0.0), 50, [6], [1.52], 1, 1.333),
    ("camera in water", (10.0, 5.0, 22.0), 60, [8], [1.5], 1.333, 1),
    ("bowl", (30.0, 10.0, 45.0), 60, [], [], 1.333, 1),
    ("ball of glass", (2.0, 3.0, 20.0), 40, [], [], 1.5, 1.333),
    ("three layers", (-5.0, 3.0, 15.0), 70, [6, 0.76, 6], [1.52, 1.48, 1.52], 1, 1.333),
    ("gap between domes", (5.0, -9.0, 20.0), 70, [5, 10, 5], [1.52, 1, 1.52], 1.333, 1.333),
    ("flat but for 1e6", (1e5, -5e4, -9.9e5), 1e6, [20], [1.52], 1, 1.333),
]



class Dome(Window):
    """Parameters: center (3), radius, thickness[], index[], inner, outer."""

    def __init__(self, p):
        layers = (len(p) - 6) // 2
        self.center, self.normal = tuple(p[:3]), (mpf(0), mpf(0), mpf(1))
        self.media = [p[4 + 2 * layers]] + list(p[4 + layers:4 + 2 * layers]) + [p[5 + 2 * layers]]
        self.radii = [p[3]]
        for thickness in p[4:4 + layers]:
            self.radii.append(self.radii[-1] + thickness)

    def trace_out(self, w):
        """A point on the outgoing line and its direction, or None."""
        point, direction = (mpf(0),) * 3, unit(w)
        for i, radius in enumerate(self.radii):
            off = tuple(a - b for a, b in zip(point, self.center))
            ahead = dot(off, direction)
            point = along(point, -ahead + mp.sqrt(ahead**2 - dot(off, off) + radius**2), direction)
            m = tuple((a - b) / radius for a, b in zip(point, self.center))
            direction = refracted(direction, m, self.media[i], self.media[i + 1])
            if direction is None:
                return None
        return point, direction


def images(dome, x):
    """How many directions see a point: behind a caustic there are several, of which the library finds one."""
    if dot(dome.center, dome.center) == 0:
        return 1
    axis = unit(tuple(-c for c in dome.center))
    across = unit(tuple(a - dot(axis, x) * b for a, b in zip(x, axis)))
    found, last = 0, None
    for i in range(1441):
        angle = mp.pi * i / 1440
        traced = dome.trace_out(tuple(mp.cos(angle) * a + mp.sin(angle) * b for a, b in zip(axis, across)))
        miss = None
        if traced is not None:
            way = tuple(a - b for a, b in zip(x, traced[0]))
            if dot(way, traced[1]) > 0:
                miss = dot(way, across) * dot(traced[1], axis) - dot(way, axis) * dot(traced[1], across)
        if miss is not None and last is not None and (miss > 0) != (last > 0):
            found += 1
        last = miss
    return found


def make_case(rng, lens, given):
    model, core, coefficients, half_field = lens
    name, center, radius, thickness, index, inner, outer = given
    parameters = exact(list(core) + coefficients)
    window_parameters = exact(list(center) + [radius] + thickness + index + [inner, outer])
    dome = Dome(window_parameters)
    made = [p for p in (make_point(rng, dome, model, parameters, half_field, d) for d in TILTS) if p]
    if inner > outer:
        made = [p for p in made if images(dome, exact(p[0]["X"])) <= 1]
    moderate = [p for p in made if p[0]["X"][2] < 5000] or made
    point, direction = moderate[len(moderate) // 2]
    return {"lens": model, "core": list(core), "coefficients": coefficients,
            "window": {"name": name, "shape": "dome", "center": list(center), "radius": radius, "thickness": thickness,
                       "index": index, "inner_index": inner, "outer_index": outer},
            "points": [p[0] for p in made], "unseen": dark(dome, dome.center, lambda a: unit((a[1], -a[0], mpf(0)))),
            "unseeing": reflected(rng, dome, model, parameters, half_field),
            "posed": make_posed(rng, model, parameters, window_parameters, exact(point["X"]), direction, Dome)}


def main():
    rng = random.Random(SEED)
    write_cases("dome", [make_case(rng, lens, dome) for lens in LENSES for dome in DOMES], "points", "unseen", "unseeing")


if __name__ == "__main__":
    main()
