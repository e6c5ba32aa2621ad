#!/usr/bin/env python3
# This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
# SPDX-License-Identifier: Apache-2.0

"""Reference values for bent panes, computed with 60 digits (python3-mpmath).

    test/reference/make_bent_reference.py       # writes bent.json beside itself

Independent of the library: light goes out by Snell's law in its vector form, sphere by sphere, each by its centre and its radius.
All else as make_wedge_reference.py has it.

bent.json: a list of cases (one lens, one pane), each with
  points      X (camera frame) -> pixel; the same pixel, rounded to double -> a point of its ray outside, and the direction
  unseeing    pixels whose ray is totally reflected
  missing     pixels whose ray does not meet a face, or meets another one before it
  posed       one object point with rvec, tvec: pixel and its jacobian (columns as refractiveProjectPoints' jacobian)
"""
import random

from make_reference import along, dot, exact, in_field, make_window, mp, mpf, project_lens, rounded, unit
from make_wedge_reference import (ARC_MINUTE, DEGREE, LENSES, Window, directions_at, make_point, make_posed, refracted,
                                  write_cases)

SEED = 20261128

PANES = [  # name, normal, distance, thickness, index, inner, outer, wedge, curvature
    ("bow of 1 mm a metre", (-0.2483, 0.0961, 1), 50, [20], [1.5437], 1, 1, [], 8e-6),
    ("bow towards the camera", (0.1, 0.05, 1), 30, [12], [1.5168], 1, 1, [], -2.4e-5),
    ("port of 1 m in water", (0.08, 0.12, 1), 40, [10], [1.49], 1, 1.333, [], 1e-3),
    ("laminate, bent and leaning", (0.1, -0.05, 1), 30, [6, 0.76, 6], [1.52, 1.48, 1.52], 1, 1,
     [(ARC_MINUTE, 0.0), (-2 * ARC_MINUTE, 3 * ARC_MINUTE), (0.0, 5 * ARC_MINUTE)], 2e-5),
    ("bent prism in water", (0.02, -0.1, 1), 60, [15], [1.52], 1, 1.333, [(2 * DEGREE, 4 * DEGREE)], -3e-5),
    ("ball ahead, in air", (0, 0, 1), 50, [6], [1.5], 1, 1, [], -1.0 / 128),
    ("camera in water", (0.1, 0.05, 1), 60, [12], [1.5], 1.333, 1, [], 1e-4),
    ("glass on the lens", (0.02, -0.03, 1), 0, [8], [1.52], 1, 1.333, [], 5e-5),
    ("curvature of 1e-12", (0.1, 0.2, 1), 25, [10, 4], [1.5, 1.6], 1, 1.2, [], 1e-12),
]

INCIDENCE = (0, 1e-7, 10, 30, 50, 70, 80)       # degrees at the first face


class Bent(Window):
    """Parameters: those of Window, wedge[] (2 a layer) only where there is one, and the curvature."""

    def __init__(self, p):
        layers, flat = self.layers, p[:-1]
        if len(flat) == 6 + 2 * layers:
            flat = list(flat) + [mpf(0)] * (2 * layers)
        super().__init__(flat)
        self.spheres = []
        for m, height in self.faces:
            radius = 1 / p[-1] + height - p[3]
            self.spheres.append((along(tuple(height * n for n in self.normal), -radius, m), radius))

    def trace_out(self, w):
        """A point on the outgoing line and its direction, or None: is_reflected says why."""
        point, direction = (mpf(0),) * 3, unit(w)
        self.is_reflected = False
        if dot(self.normal, direction) <= 0:
            return None
        for i, (center, radius) in enumerate(self.spheres):
            off = tuple(a - b for a, b in zip(point, center))
            ahead = dot(off, direction)
            square = ahead**2 - dot(off, off) + radius**2
            if square <= 0:
                return None
            s = -ahead + (mp.sqrt(square) if radius > 0 else -mp.sqrt(square))
            if s < -mpf(10)**-40:       # a face through the camera is at 0 but for rounding
                return None
            point = along(point, s, direction)
            m = tuple((a - b) / radius for a, b in zip(point, center))
            direction = refracted(direction, m, self.media[i], self.media[i + 1])
            self.is_reflected = direction is None
            if self.is_reflected:
                return None
        return point, direction


def without_way_out(rng, pane, lens, parameters, half_field):
    """Pixels whose light is reflected, and those whose light misses a face."""
    pixels = {True: [], False: []}
    for _ in range(200):
        w = next(directions_at(rng, pane, rng.uniform(0, 88)))
        if in_field(w, half_field) and pane.trace_out(w) is None and len(pixels[pane.is_reflected]) < 4:
            pixels[pane.is_reflected].append(rounded(project_lens(lens, parameters, w)))
    return pixels[True], pixels[False]


def make_case(rng, lens, given):
    model, core, coefficients, half_field = lens
    name, normal, distance, thickness, index, inner, outer, wedge, curvature = given
    parameters = exact(list(core) + coefficients)
    window_parameters = exact(make_window(normal, distance, thickness, index, inner, outer) + [a for pair in wedge for a in pair]
                              + [curvature])
    shape = type("Bent", (Bent,), {"layers": len(thickness)})
    pane = shape(window_parameters)
    made = [p for p in (make_point(rng, pane, model, parameters, half_field, d) for d in INCIDENCE) if p]
    moderate = [p for p in made if p[0]["X"][2] < 5000] or made
    point, direction = moderate[len(moderate) // 2]
    unseeing, missing = without_way_out(rng, pane, model, parameters, half_field)
    return {"lens": model, "core": list(core), "coefficients": coefficients,
            "window": {"name": name, "shape": "bent", "normal": rounded(window_parameters[:3]), "distance": distance,
                       "thickness": thickness, "index": index, "inner_index": inner, "outer_index": outer, "wedge": wedge,
                       "curvature": curvature},
            "points": [p[0] for p in made], "unseeing": unseeing, "missing": missing,
            "posed": make_posed(rng, model, parameters, window_parameters, exact(point["X"]), direction, shape)}


def main():
    rng = random.Random(SEED)
    write_cases("bent", [make_case(rng, lens, pane) for lens in LENSES for pane in PANES], "points", "unseeing", "missing")


if __name__ == "__main__":
    main()
