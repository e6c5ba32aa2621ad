#!/usr/bin/env python3
# This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
# SPDX-License-Identifier: Apache-2.0

"""Reference values for windows whose faces are not parallel, computed with 60 digits (python3-mpmath).

    test/reference/make_wedge_reference.py      # writes wedge.json beside itself

Independent of the library: every face's normal is the first one's, turned by Rodrigues' formula; light goes out by Snell's law in
its vector form, face by face; a point is projected by shooting, with a secant method that starts from the direction that the point
was made from. Derivatives are central differences with a step of 1e-22. Lenses, vectors and rounding: make_reference.py.

wedge.json: a list of cases (one lens, one window), each with
  points      X (camera frame) -> pixel; the same pixel, rounded to double -> a point of its ray outside, and the direction
  posed       one object point with rvec, tvec: pixel and its jacobian (columns as refractiveProjectPoints' jacobian)
"""
import json
import os
import random

from make_reference import along, dot, exact, in_field, make_window, mp, mpf, project_lens, rotate, rounded, unit, unproject_lens

SEED = 20261125

LENSES = [  # model, camera matrix, coefficients, half field of view in degrees where the model is one-to-one
    ("opencv", (1000.0, 1010.0, 640.0, 480.5), [], 60),
    ("opencv", (1200.0, 1195.0, 700.25, 512.75), [-0.28, 0.09, 7e-4, -4e-4], 40),
    ("fisheye", (400.0, 410.0, 640.0, 512.0), [-0.02, 0.004, -0.001, 0.0001], 85),
]

ARC_MINUTE, DEGREE = float(mp.pi / 10800), float(mp.pi / 180)

WINDOWS = [  # name, normal, distance, thickness, index, inner, outer, wedge
    ("pane of one arc minute", (-0.2483, 0.0961, 1), 50, [20], [1.5437], 1, 1, [(0.7 * ARC_MINUTE, -0.7 * ARC_MINUTE)]),
    ("pane of half a degree", (0.1, 0.05, 1), 30, [12], [1.5168], 1, 1, [(0.3 * DEGREE, 0.4 * DEGREE)]),
    ("prism of five degrees", (-0.1, 0.2, 1), 40, [25], [1.52], 1, 1, [(4.0 * DEGREE, -3.0 * DEGREE)]),
    ("port of three minutes in water", (0.08, 0.12, 1), 40, [10], [1.49], 1, 1.333, [(-3 * ARC_MINUTE, 0.5 * ARC_MINUTE)]),
    ("prism in water", (0.02, -0.1, 1), 60, [15], [1.52], 1, 1.333, [(2 * DEGREE, 4 * DEGREE)]),
    ("camera in water", (0.1, 0.05, 1), 60, [12], [1.5], 1.333, 1, [(-1 * DEGREE, 0.2 * DEGREE)]),
    ("laminate", (0.1, -0.05, 1), 30, [6, 0.76, 6], [1.52, 1.48, 1.52], 1, 1,
     [(ARC_MINUTE, 0.0), (-2 * ARC_MINUTE, 3 * ARC_MINUTE), (0.0, 5 * ARC_MINUTE)]),
    ("double glazing in water", (-0.05, 0.1, 1), 35, [5, 10, 5], [1.52, 1, 1.52], 1.333, 1.333,
     [(0.1 * DEGREE, 0.0), (-2 * DEGREE, 1 * DEGREE), (0.5 * DEGREE, 0.0)]),
    ("two layers", (1.0, 0.3, 1), 20, [15, 8], [1.6, 1.4], 1, 1.333, [(0.2 * DEGREE, 0.1 * DEGREE), (0.0, -0.4 * DEGREE)]),
    ("glass on the lens", (0.02, -0.03, 1), 0, [8], [1.52], 1, 1.333, [(10 * ARC_MINUTE, -20 * ARC_MINUTE)]),
    ("wedge of 0", (0.1, 0.2, 1), 25, [10, 4], [1.5, 1.6], 1, 1.2, [(0.0, 0.0), (0.0, 0.0)]),
]

INCIDENCE = (0, 1e-7, 10, 30, 50, 70, 80, 85)   # degrees at the first face


def refracted(direction, m, before, after):
    """Snell's law at a face with the unit normal m; None: total reflection."""
    ratio, cosine = before / after, dot(m, direction)
    square = 1 - ratio**2 * (1 - cosine**2)
    if square <= 0:
        return None
    return tuple(ratio * d + (mp.sqrt(square) - ratio * cosine) * n for d, n in zip(direction, m))


class Window:
    """Parameters: normal (3, any length), distance, thickness[], index[], inner, outer, wedge[] (2 a layer)."""

    def __init__(self, p):
        layers = (len(p) - 6) // 4
        n = unit(p[:3])
        e1 = unit(tuple(a - n[0] * b for a, b in zip((mpf(1), mpf(0), mpf(0)), n)))
        e2 = (n[1] * e1[2] - n[2] * e1[1], n[2] * e1[0] - n[0] * e1[2], n[0] * e1[1] - n[1] * e1[0])
        self.normal, self.media = n, [p[4 + 2 * layers]] + list(p[4 + layers:4 + 2 * layers]) + [p[5 + 2 * layers]]
        height, w1, w2 = p[3], mpf(0), mpf(0)
        self.faces = [(n, height)]
        for i in range(layers):
            height += p[4 + i]
            w1 += p[6 + 2 * layers + 2 * i]
            w2 += p[7 + 2 * layers + 2 * i]
            turned = rotate(tuple(w1 * b - w2 * a for a, b in zip(e1, e2)), n)     # n towards e1: about e2
            self.faces.append((turned, height))

    def trace_out(self, w):
        """A point on the outgoing line and its direction, or None."""
        point, direction = (mpf(0),) * 3, unit(w)
        for i, (m, height) in enumerate(self.faces):
            on_axis = tuple(height * n for n in self.normal)
            s = (dot(m, on_axis) - dot(m, point)) / dot(m, direction)
            if dot(m, direction) <= 0 or s < 0:
                return None
            point = along(point, s, direction)
            direction = refracted(direction, m, self.media[i], self.media[i + 1])
            if direction is None:
                return None
        return point, direction

    def solve_in(self, x, start):
        """Direction in the inner medium towards the point, from one near to it."""
        a = unit((start[1], -start[0], mpf(0)) if abs(start[2]) < 0.9 else (start[2], mpf(0), -start[0]))
        b = (start[1] * a[2] - start[2] * a[1], start[2] * a[0] - start[0] * a[2], start[0] * a[1] - start[1] * a[0])

        def direction(p, q):
            return tuple(start[i] + p * a[i] + q * b[i] for i in range(3))

        def miss(p, q):
            point, out = self.trace_out(direction(p, q))
            s = dot(out, tuple(u - v for u, v in zip(x, point)))
            off = tuple(v + s * d - u for u, v, d in zip(x, point, out))
            return dot(off, a), dot(off, b)
        return unit(direction(*mp.findroot(miss, (mpf(0), mpf(0)), tol=mpf(10)**-80, maxsteps=40)))


def directions_at(rng, window, degrees):
    n = window.normal
    across = unit((n[2], mpf(0), -n[0]))
    third = (n[1] * across[2] - n[2] * across[1], n[2] * across[0] - n[0] * across[2], n[0] * across[1] - n[1] * across[0])
    c, s = mp.cos(mp.radians(mpf(degrees))), mp.sin(mp.radians(mpf(degrees)))
    while True:
        azimuth = mpf(rng.uniform(0, 6.28))
        yield tuple(c * n[i] + s * (mp.cos(azimuth) * across[i] + mp.sin(azimuth) * third[i]) for i in range(3))


def make_point(rng, window, lens, parameters, half_field, degrees):
    for _, w in zip(range(40), directions_at(rng, window, degrees)):
        traced = window.trace_out(w) if in_field(w, half_field) else None
        if traced is None:
            continue
        x = exact(along(traced[0], mpf(10)**rng.uniform(0, 4), traced[1]))
        pixel = project_lens(lens, parameters, window.solve_in(x, w))
        seen = unproject_lens(lens, parameters, exact(pixel), w)
        point, direction = window.trace_out(seen)
        return {"X": rounded(x), "pixel": rounded(pixel), "point": rounded(point), "direction": rounded(direction)}, w
    return None


def make_posed(rng, lens, parameters, window_parameters, x, w, shape=Window):
    rvec, tvec = exact(rng.uniform(-0.6, 0.6) for _ in range(3)), exact(rng.uniform(-50, 50) for _ in range(3))
    object_point = exact(rotate(tuple(-r for r in rvec), tuple(a - t for a, t in zip(x, tvec))))
    values, of_lens = list(rvec + tvec) + list(parameters) + list(window_parameters), 6 + len(parameters)

    def project(v):
        at = tuple(a + b for a, b in zip(rotate(v[:3], object_point), v[3:6]))
        return project_lens(lens, v[6:of_lens], shape(v[of_lens:]).solve_in(at, w))
    step = mpf(10)**-22
    columns = []
    for i in range(len(values)):
        if i == of_lens + 3 and values[i] == 0:      # a distance that is 0 is one-sided
            ends = [project(values[:i] + [k * step] + values[i + 1:]) for k in (0, 1, 2)]
            columns.append([(4 * b - 3 * a - c) / (2 * step) for a, b, c in zip(*ends)])
            continue
        ends = [project(values[:i] + [values[i] + sign * step] + values[i + 1:]) for sign in (1, -1)]
        columns.append([(a - b) / (2 * step) for a, b in zip(*ends)])
    return {"object": rounded(object_point), "rvec": rounded(rvec), "tvec": rounded(tvec), "pixel": rounded(project(values)),
            "jacobian": [rounded(c[row] for c in columns) for row in range(2)]}


def make_case(rng, lens, window):
    model, core, coefficients, half_field = lens
    name, normal, distance, thickness, index, inner, outer, wedge = window
    parameters = exact(list(core) + coefficients)
    window_parameters = exact(make_window(normal, distance, thickness, index, inner, outer) + [a for pair in wedge for a in pair])
    w = Window(window_parameters)
    made = [p for p in (make_point(rng, w, model, parameters, half_field, d) for d in INCIDENCE) if p]
    moderate = [p for p in made if p[0]["X"][2] < 5000] or made
    point, direction = moderate[len(moderate) // 2]
    return {"lens": model, "core": list(core), "coefficients": coefficients,
            "window": {"name": name, "normal": rounded(window_parameters[:3]), "distance": distance, "thickness": thickness,
                       "index": index, "inner_index": inner, "outer_index": outer, "wedge": wedge},
            "points": [p[0] for p in made],
            "posed": make_posed(rng, model, parameters, window_parameters, exact(point["X"]), direction)}


def write_cases(name, cases, *kinds):
    """Writes NAME.json beside this file and says how many cases and values of each kind are in it."""
    path = os.path.join(os.path.dirname(os.path.abspath(__file__)), name + ".json")
    with open(path, "w", encoding="utf-8") as file:
        file.write("[\n" + ",\n".join(json.dumps(c) for c in cases) + "\n]\n")
    print(f"{path}: {len(cases)} cases" + "".join(f", {sum(len(c[kind]) for c in cases)} {kind}" for kind in kinds))


def main():
    rng = random.Random(SEED)
    write_cases("wedge", [make_case(rng, lens, window) for lens in LENSES for window in WINDOWS], "points")


if __name__ == "__main__":
    main()
