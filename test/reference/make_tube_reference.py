#!/usr/bin/env python3
# This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
# SPDX-License-Identifier: Apache-2.0

"""Reference values for tubes, computed with 60 digits (python3-mpmath).

    test/reference/make_tube_reference.py       # writes tube.json beside itself

Independent of the library: light goes out by Snell's law in its vector form, cylinder by cylinder, each met by the quadratic equation;
nothing that is conserved, no cross-section. All else as make_wedge_reference.py has it.

tube.json: a list of cases (one lens, one tube), each with
  points      X (camera frame) -> pixel; the same pixel, rounded to double -> a point of its ray outside, and the direction
  inside      points X inside of the tube, or of its wall
  unseen      points X that no light reaches the camera from (total reflection)
  unseeing    pixels whose ray is totally reflected
  posed       one object point with rvec, tvec: pixel and its jacobian (columns as refractiveProjectPoints' jacobian)
"""
import random

from make_reference import along, dot, exact, mp, mpf, rounded, unit
from make_wedge_reference import LENSES, Window, make_point, make_posed, refracted, write_cases
from round_windows import TILTS, dark, reflected

SEED = 20261127

TUBES = [  # name, center, axis (any length), radius, thickness, index, inner, outer
    ("thin tube in air", (2.0, -1.0, 1.0), (0.05, 1, 0.02), 23, [2], [1.49], 1, 1),
    ("thick tube in air", (8.0, 5.0, -20.0), (1, 0.2, -0.3), 50, [25], [1.7], 1, 1),
    ("tube in water", (0.5, -0.25, 1.0), (1, 0, 0), 55, [7], [1.5168], 1, 1.333),
    ("far off the axis, in water", (18.0, -3.0, -23.0), (0.4, 1, 0.2), 50, [4], [1.49], 1, 1.333),
    ("ahead of the axis, in water", (-3.0, 2.0, -29.0), (-0.2, 1, -0.3), 50, [25], [1.8], 1, 1.333),
    ("axis beside the camera", (25.0, 10.0, 3.0), (0, 1, 0.5), 50, [6], [1.52], 1, 1.333),
    ("on the axis", (0.0, 0.0, 0.0), (1, 1, 0.2), 50, [6], [1.52], 1, 1.333),
    ("camera in water", (10.0, 5.0, 22.0), (1, 0.3, 0), 60, [8], [1.5], 1.333, 1),
    ("bare tube", (25.0, 10.0, 45.0), (0.1, 1, 0.1), 60, [], [], 1.333, 1),
    ("looking along the axis", (3.0, -2.0, 5.0), (0.05, 0.02, 1), 40, [5], [1.5], 1, 1.333),
    ("three layers", (-5.0, 3.0, 15.0), (1, 0.5, 0.4), 70, [6, 0.76, 6], [1.52, 1.48, 1.52], 1, 1.333),
    ("flat but for 1e6", (1e5, -5e4, -9.9e5), (1, 2, 0), 1e6, [20], [1.52], 1, 1.333),
]

TOO_NEAR = mpf("0.02")                          # sine of the angle with the axis, at which light goes far within the tube


class Tube(Window):
    """Parameters: center (3), axis (3), radius, thickness[], index[], inner, outer."""

    def __init__(self, p):
        layers = (len(p) - 9) // 2
        self.center, self.axis, self.normal = tuple(p[:3]), unit(p[3:6]), (mpf(0), mpf(0), mpf(1))
        self.media = [p[7 + 2 * layers]] + list(p[7 + layers:7 + 2 * layers]) + [p[8 + 2 * layers]]
        self.radii = [p[6]]
        for thickness in p[7:7 + layers]:
            self.radii.append(self.radii[-1] + thickness)

    def across(self, v):
        return along(v, -dot(v, self.axis), self.axis)

    def trace_out(self, w):
        """A point on the outgoing line and its direction, or None."""
        point, direction = (mpf(0),) * 3, unit(w)
        for i, radius in enumerate(self.radii):
            off, flat = self.across(tuple(a - b for a, b in zip(point, self.center))), self.across(direction)
            a, b, c = dot(flat, flat), dot(off, flat), dot(off, off) - radius**2
            point = along(point, (-b + mp.sqrt(b**2 - a * c)) / a, direction)
            m = tuple(x / radius for x in self.across(tuple(a - b for a, b in zip(point, self.center))))
            direction = refracted(direction, m, self.media[i], self.media[i + 1])
            if direction is None:
                return None
        return point, direction


def has_one_image(tube, x, w):
    """Whether searches from around the direction that a point was made from find it again: behind a caustic they find others."""
    for angle in (mpf("0.03"), mpf("0.1"), mpf("0.3")):
        for k in range(6):
            side = unit(tuple(mpf(c) for c in (mp.cos(k), mp.sin(k), mp.sin(2 * k))))
            try:
                found = tube.solve_in(x, unit(along(w, angle, side)))
                point, direction = tube.trace_out(found)
            except (TypeError, ValueError, ZeroDivisionError):
                continue        # it left what gets out of the tube
            if dot(direction, tuple(a - b for a, b in zip(x, point))) > 0 and 1 - dot(found, w) > mpf(10)**-20:
                return False
    return True


def dark_level(tube):
    """Level with the camera: light that goes along the axis is never level again."""
    a = tube.axis
    return dark(tube, tube.across(tube.center),
                lambda b: (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]))


def inside(rng, tube):
    points = []
    for radius in (mpf("0.5") * tube.radii[0], (tube.radii[0] + tube.radii[-1]) / 2):
        side = unit(tube.across(tuple(mpf(rng.uniform(-1, 1)) for _ in range(3))))
        x = rounded(along(along(tube.center, radius * mpf("0.999"), side), rng.uniform(-50, 50), tube.axis))
        if x[2] > 1:
            points.append(x)
    return points


def make_case(rng, lens, given):
    model, core, coefficients, half_field = lens
    name, center, axis, radius, thickness, index, inner, outer = given
    parameters = exact(list(core) + coefficients)
    axis = rounded(unit(exact(axis)))
    window_parameters = exact(list(center) + list(axis) + [radius] + thickness + index + [inner, outer])
    tube = Tube(window_parameters)
    made = []
    for degrees in TILTS:
        point = make_point(rng, tube, model, parameters, half_field, degrees)
        if point and dot(tube.across(point[1]), tube.across(point[1])) > TOO_NEAR**2:
            made.append(point)
    if inner > outer:
        made = [p for p in made if has_one_image(tube, exact(p[0]["X"]), p[1])]
    moderate = [p for p in made if p[0]["X"][2] < 5000] or made
    point, direction = moderate[len(moderate) // 2]
    return {"lens": model, "core": list(core), "coefficients": coefficients,
            "window": {"name": name, "shape": "tube", "center": list(center), "axis": list(axis), "radius": radius,
                       "thickness": thickness, "index": index, "inner_index": inner, "outer_index": outer},
            "points": [p[0] for p in made], "inside": inside(rng, tube), "unseen": dark_level(tube),
            "unseeing": reflected(rng, tube, model, parameters, half_field),
            "posed": make_posed(rng, model, parameters, window_parameters, exact(point["X"]), direction, Tube)}


def main():
    rng = random.Random(SEED)
    write_cases("tube", [make_case(rng, lens, tube) for lens in LENSES for tube in TUBES], "points", "inside", "unseen", "unseeing")


if __name__ == "__main__":
    main()
