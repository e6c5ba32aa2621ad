#!/usr/bin/env python3
# This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
# SPDX-License-Identifier: Apache-2.0

"""Reference values for the tests, computed with 60 digits (python3-mpmath).

    test/reference/make_reference.py            # writes projection.json beside itself

Independent of the library: it is written from Snell's law in its vector form, plane by plane, and from the formulas
in OpenCV's documentation of calib3d and fisheye. A point is projected by bisection on the ray invariant
p = index * sin(angle), not by Newton's method; derivatives are central differences with a step of 1e-22.
Inputs are doubles and taken as such; outputs are rounded once, at the end.

projection.json: a list of cases (one lens, one window), each with
  points      X (camera frame) -> pixel; the same pixel, rounded to double -> tau, direction
  unseen      points X that no light reaches the camera from (total reflection)
  unseeing    pixels whose ray is totally reflected
  posed       one object point with rvec, tvec: pixel and its jacobian (columns as refractiveProjectPoints' jacobian)
"""
import json
import os
import random

from mpmath import mp, mpf, matrix

mp.dps = 60
SEED = 20240607

LENSES = [  # model, camera matrix, coefficients, half field of view in degrees where the model is one-to-one
    ("opencv", (1000.0, 1010.0, 640.0, 480.5), [], 80),
    ("opencv", (2438.07, 2438.08, 643.98, 500.01), [-0.4082, 0.4359, 0.0, 0.0], 35),       # the paper's left camera
    ("opencv", (1200.0, 1195.0, 700.25, 512.75), [-0.28, 0.09, 7e-4, -4e-4], 40),
    ("opencv", (900.0, 905.0, 639.5, 359.5), [-0.3, 0.12, 1e-3, -5e-4, -0.01], 42),
    ("opencv", (2070.0, 2075.0, 3004.0, 1997.0), [0.5, 0.03, 1e-4, -2e-4, 1e-4, 0.8, 0.1, 0.002], 60),
    ("opencv", (1500.0, 1510.0, 960.0, 540.0), [0.4, 0.02, 2e-4, -1e-4, 1e-4, 0.7, 0.08, 0.001,
                                                1e-3, -2e-4, -8e-4, 1e-4], 45),
    ("opencv", (1500.0, 1490.0, 950.0, 550.0), [0.4, 0.02, 2e-4, -1e-4, 1e-4, 0.7, 0.08, 0.001,
                                                1e-3, -2e-4, -8e-4, 1e-4, 0.03, -0.02], 40),
    ("fisheye", (400.0, 410.0, 640.0, 512.0), [-0.02, 0.004, -0.001, 0.0001], 88),
]

WINDOWS = [  # name, normal, distance, thickness, index, inner, outer
    ("no window", (0, 0, 1), 0, [], [], 1, 1),
    ("pane in air", (-0.2483, 0.0961, 1), 50, [20], [1.5437], 1, 1),
    ("laminate", (0.1, -0.05, 1), 30, [6, 0.76, 6], [1.52, 1.48, 1.52], 1, 1),
    ("air glass water", (0.08, 0.12, 1), 40, [10], [1.49], 1, 1.333),
    ("bare water", (0.05, 0.02, 1), 120, [], [], 1, 1.333),
    ("glass on the lens, water", (0.02, -0.03, 1), 0, [8], [1.52], 1, 1.333),
    ("glass on the lens, air", (-0.02, 0.2, 1), 0, [8], [1.52], 1, 1),
    ("water glass air", (0.1, 0.05, 1), 60, [12], [1.5], 1.333, 1),
    ("double glazing in water", (-0.05, 0.1, 1), 35, [5, 10, 5], [1.52, 1, 1.52], 1.333, 1.333),
    ("steep pane", (1.5, 0.3, 1), 80, [15], [1.6], 1, 1),
    ("thin and dense", (0.1, 0.1, 1), 10, [1e-3], [4], 1, 1),
    ("thick and faint", (-0.3, 0.2, 1), 5, [1e3], [1.0001], 1, 1.333),
]

GRAZING = (0, 1e-7, 0.2, 0.6, 80, 89, 89.9)  # <= 1: share of the half field; else degrees in the rarest medium


# ---- lenses: direction -> pixel

def distort_opencv(a, b, k):
    """docs.opencv.org, calib3d: radial, tangential, rational, thin prism, tilt."""
    k1, k2, p1, p2, k3, k4, k5, k6, s1, s2, s3, s4, tx, ty = list(k) + [mpf(0)] * (14 - len(k))
    r2 = a * a + b * b
    radial = (1 + k1 * r2 + k2 * r2**2 + k3 * r2**3) / (1 + k4 * r2 + k5 * r2**2 + k6 * r2**3)
    x = a * radial + 2 * p1 * a * b + p2 * (r2 + 2 * a * a) + s1 * r2 + s2 * r2**2
    y = b * radial + p1 * (r2 + 2 * b * b) + 2 * p2 * a * b + s3 * r2 + s4 * r2**2
    rotation = (matrix([[mp.cos(ty), 0, -mp.sin(ty)], [0, 1, 0], [mp.sin(ty), 0, mp.cos(ty)]])
                * matrix([[1, 0, 0], [0, mp.cos(tx), mp.sin(tx)], [0, -mp.sin(tx), mp.cos(tx)]]))
    keystone = matrix([[rotation[2, 2], 0, -rotation[0, 2]], [0, rotation[2, 2], -rotation[1, 2]], [0, 0, 1]])
    v = keystone * rotation * matrix([x, y, 1])
    return v[0] / v[2], v[1] / v[2]


def distort_fisheye(a, b, k):
    """docs.opencv.org, fisheye."""
    r = mp.sqrt(a * a + b * b)
    if r == 0:
        return a, b
    theta = mp.atan(r)
    theta_d = theta * (1 + sum(c * theta**(2 * i + 2) for i, c in enumerate(k)))
    return theta_d / r * a, theta_d / r * b


def project_lens(model, parameters, w):
    fx, fy, cx, cy = parameters[:4]
    distort = {"opencv": distort_opencv, "fisheye": distort_fisheye}[model]
    x, y = distort(w[0] / w[2], w[1] / w[2], parameters[4:])
    return fx * x + cx, fy * y + cy


def unproject_lens(model, parameters, pixel, start):
    """Unit direction of the pixel, by Newton's method from a direction close to it."""
    def miss(a, b):
        u, v = project_lens(model, parameters, (a, b, mpf(1)))
        return u - pixel[0], v - pixel[1]
    a, b = mp.findroot(miss, (start[0] / start[2], start[1] / start[2]), tol=mpf(10)**-80, maxsteps=30)
    return unit((a, b, mpf(1)))


# ---- vectors

def dot(a, b):
    return sum(x * y for x, y in zip(a, b))


def unit(a):
    length = mp.sqrt(dot(a, a))
    return tuple(x / length for x in a)


def along(origin, s, direction):
    return tuple(o + s * d for o, d in zip(origin, direction))


def rotate(rvec, x):
    angle = mp.sqrt(dot(rvec, rvec))
    if angle == 0:
        return x
    k = tuple(r / angle for r in rvec)
    cross = (k[1] * x[2] - k[2] * x[1], k[2] * x[0] - k[0] * x[2], k[0] * x[1] - k[1] * x[0])
    c, s = mp.cos(angle), mp.sin(angle)
    return tuple(x[i] * c + cross[i] * s + k[i] * dot(k, x) * (1 - c) for i in range(3))


# ---- window: parameters are normal (3, any length), distance, thickness[], index[], inner, outer

class Window:
    def __init__(self, parameters):
        layers = (len(parameters) - 6) // 2
        self.normal = unit(parameters[:3])
        self.height = list(parameters[3:4 + layers])
        self.index = [parameters[-2]] + list(parameters[4 + layers:4 + 2 * layers])
        self.outer = parameters[-1]

    def trace_out(self, w):
        """Vector Snell, surface by surface: a point on the outgoing line and its direction, or None."""
        point, direction = (mpf(0),) * 3, w
        media = self.index + [self.outer]
        for i, height in enumerate(self.height):
            cosine = dot(self.normal, direction)
            point = along(point, height / cosine, direction)
            ratio = media[i] / media[i + 1]
            square = 1 - ratio**2 * (1 - cosine**2)
            if square <= 0:
                return None
            direction = tuple(ratio * d + (mp.sqrt(square) - ratio * cosine) * n
                              for d, n in zip(direction, self.normal))
        return point, direction

    def tau_direction(self, w):
        """Height at which the outgoing line meets the axis through the centre, and its direction."""
        traced = self.trace_out(w)
        if traced is None:
            return None
        point, direction = traced
        along_axis, across = self.split(point)
        tangent_part = self.split(direction)[1]
        size = dot(tangent_part, tangent_part)
        if size < mpf(10)**-60:    # on the axis: the limit, by the first-order (paraxial) form of Snell's law
            return sum(h * (1 - self.outer / n) for h, n in zip(self.height, self.index)), direction
        s = -dot(across, tangent_part) / size
        return along_axis + s * dot(self.normal, direction), direction

    def split(self, x):
        u = dot(self.normal, x)
        return u, tuple(a - u * n for a, n in zip(x, self.normal))

    def solve_in(self, x):
        """Direction in the inner medium towards the scene point, or None; bisection on p."""
        u, across = self.split(x)
        v = mp.sqrt(dot(across, across))
        heights = self.height + [u - sum(self.height)]
        media = self.index + [self.outer]
        if heights[-1] <= 0:
            return None
        if v == 0:
            return self.normal
        low, high = mpf(0), min(media)
        reached = [(h, n) for h, n in zip(heights, media) if h != 0]   # a derivative's step may make 0 negative

        def miss(p):
            return sum(h * p / mp.sqrt(n * n - p * p) for h, n in reached) - v
        if all(n > high for _, n in reached) and miss(high) < 0:
            return None
        for _ in range(230):
            middle = (low + high) / 2
            if miss(middle) < 0:
                low = middle
            else:
                high = middle
        sine = (low + high) / 2 / self.index[0]
        cosine = mp.sqrt(1 - sine**2)
        return tuple(cosine * n + sine * a / v for n, a in zip(self.normal, across))


# ---- cases

def exact(values):
    return tuple(mpf(float(v)) for v in values)


def rounded(values):
    return [float(v) for v in values]


def make_window(normal, distance, thickness, index, inner, outer):
    length = sum(x * x for x in normal)**0.5
    return rounded([x / length for x in normal] + [distance] + thickness + index + [inner, outer])


def direction_at(rng, window, angle):
    """Inner direction at an angle (cosine and sine given) from the normal, random azimuth."""
    n = window.normal
    helper = unit((n[1] - n[2], n[2] - n[0] + 1, n[0]))
    across = unit(window.split(helper)[1])
    third = (n[1] * across[2] - n[2] * across[1], n[2] * across[0] - n[0] * across[2],
             n[0] * across[1] - n[1] * across[0])
    azimuth = mpf(rng.uniform(0, 6.28))
    c, s = mp.cos(angle), mp.sin(angle)
    return tuple(c * n[i] + s * (mp.cos(azimuth) * across[i] + mp.sin(azimuth) * third[i]) for i in range(3))


def in_field(w, half_field):
    return w[2] > mp.cos(mp.radians(half_field)) * mp.sqrt(dot(w, w))


def make_point(rng, window, lens, parameters, half_field, grazing):
    """A point whose ray leaves at the wanted angle, if the lens can see it."""
    if grazing <= 1:
        angle = mp.radians(half_field) * grazing
    else:
        rarest = min(window.index + [window.outer])
        angle = mp.asin(rarest * mp.sin(mp.radians(mpf(grazing))) / window.index[0])
    for _ in range(40):
        w = direction_at(rng, window, angle)
        traced = window.trace_out(w) if in_field(w, half_field) else None
        if traced is None:
            continue
        s = mpf(10)**rng.uniform(-1, 5) / dot(window.normal, traced[1])
        x = exact(along(traced[0], s, traced[1]))
        inner = window.solve_in(x)
        if inner is None or not in_field(inner, half_field):
            continue
        pixel = project_lens(lens, parameters, inner)
        seen = unproject_lens(lens, parameters, exact(pixel), inner)
        tau, direction = window.tau_direction(seen)
        return {"X": rounded(x), "pixel": rounded(pixel), "tau": float(tau), "direction": rounded(direction)}
    return None


def make_unseen(rng, window, half_field):
    """Points in the shadow of total reflection: just beyond and far beyond the last ray."""
    media = window.index + [window.outer]
    reached = [n for h, n in zip(window.height, window.index) if h > 0] + [window.outer]
    limit = min(media)
    if limit == min(reached):
        return []
    points = []
    for factor in (1.0001, 3):
        w = direction_at(rng, window, mpf(1))
        across = unit(window.split(w)[1])
        out = mpf(rng.uniform(10, 1000))
        v = sum(h * limit / mp.sqrt(n * n - limit**2)
                for h, n in zip(window.height + [out], media) if h > 0) * factor
        x = tuple((sum(window.height) + out) * n + v * a for n, a in zip(window.normal, across))
        points.append(rounded(x))
        assert window.solve_in(exact(x)) is None
    return points


def make_unseeing(rng, window, lens, parameters, half_field):
    pixels = []
    for _ in range(200):
        w = direction_at(rng, window, mpf(rng.uniform(0, 1.5)))
        if len(pixels) < 2 and in_field(w, half_field) and window.trace_out(w) is None:
            pixel = project_lens(lens, parameters, w)
            if window.trace_out(unproject_lens(lens, parameters, exact(pixel), w)) is None:
                pixels.append(rounded(pixel))
    return pixels


def project_posed(lens, lens_count, window_parameters_start, values, object_point):
    rvec, tvec = values[:3], values[3:6]
    window = Window(values[window_parameters_start:])
    x = tuple(a + b for a, b in zip(rotate(rvec, object_point), tvec))
    return project_lens(lens, values[6:6 + lens_count], window.solve_in(x))


def make_posed(rng, lens, parameters, window_parameters, x):
    """The camera-frame point x as object point under a random pose, with all derivatives."""
    rvec = exact(rng.uniform(-0.6, 0.6) for _ in range(3))
    tvec = exact(rng.uniform(-50, 50) for _ in range(3))
    back = tuple(-r for r in rvec)
    object_point = exact(rotate(back, tuple(a - t for a, t in zip(x, tvec))))
    start = 6 + len(parameters)
    values = list(rvec + tvec) + list(parameters) + list(window_parameters)

    def project(changed):
        return project_posed(lens, len(parameters), start, changed, object_point)
    columns = []
    step = mpf(10)**-22
    for i in range(len(values)):
        ends = [project(values[:i] + [values[i] + sign * step] + values[i + 1:]) for sign in (1, -1)]
        columns.append([(a - b) / (2 * step) for a, b in zip(*ends)])
    jacobian = [rounded(c[row] for c in columns) for row in range(2)]
    return {"object": rounded(object_point), "rvec": rounded(rvec), "tvec": rounded(tvec),
            "pixel": rounded(project(values)), "jacobian": jacobian}


def make_case(rng, lens, window):
    model, core, coefficients, half_field = lens
    parameters = exact(list(core) + coefficients)
    window_parameters = exact(make_window(*window[1:]))
    w = Window(window_parameters)
    layers = len(window[3])
    points = [p for p in (make_point(rng, w, model, parameters, half_field, g) for g in GRAZING) if p]
    case = {
        "lens": model, "core": list(core), "coefficients": coefficients,
        "window": {"name": window[0], "normal": rounded(window_parameters[:3]), "distance": window[2],
                   "thickness": window[3], "index": window[4], "inner_index": window[5], "outer_index": window[6]},
        "points": points, "unseen": make_unseen(rng, w, half_field),
        "unseeing": make_unseeing(rng, w, model, parameters, half_field)}
    assert len(window_parameters) == 6 + 2 * layers
    moderate = [p["X"] for p in points if p["X"][2] < 5000][-1:] or [points[0]["X"]]
    # With exactly equal media and no layer there is no window to differentiate by, but its parameters exist.
    case["posed"] = make_posed(rng, model, parameters, window_parameters, exact(moderate[0]))
    return case


def main():
    rng = random.Random(SEED)
    cases = [make_case(rng, lens, window) for window in WINDOWS for lens in LENSES]
    path = os.path.join(os.path.dirname(os.path.abspath(__file__)), "projection.json")
    with open(path + ".tmp", "w") as out:
        out.write("[\n" + ",\n".join(json.dumps(c) for c in cases) + "\n]\n")
    os.replace(path + ".tmp", path)
    print(len(cases), "cases,", sum(len(c["points"]) for c in cases), "points,",
          sum(len(c["unseen"]) for c in cases), "unseen,", sum(len(c["unseeing"]) for c in cases), "unseeing ->", path)


if __name__ == "__main__":
    main()
