# This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
# SPDX-License-Identifier: Apache-2.0

"""Table 4: the normal from one pair of images when the glass is polluted.

The paper shows its stains and gives no numbers for them. Here: A (sewage) hides each point with a chance of 20 % and
smears each other one with a chance of one half; B (sludge) hides the 40 % of the points on one side of a line across
the board, and smears the others likewise. A smeared point has three times the noise. The true normals are those of
"Non-pollution".
"""
import numpy as np
import normals
import published
import simulation as sim
from tables import show

HIDDEN_A, HIDDEN_B, SMEARED, SMEAR = 0.2, 0.4, 0.5, 3.
KINDS = "Non-pollution", "Pollution A", "Pollution B"
FITS = normals.fit_paper, normals.fit_joint


def hidden_points(rng, kind):
    if kind == "Pollution A":
        return rng.uniform(size=len(sim.BOARD)) < HIDDEN_A
    across = sim.BOARD[:, :2] @ rng.normal(size=2)
    return across > np.quantile(across, 1 - HIDDEN_B)


def polluted(rng, pixels, kind):
    """Pixels as detected through the stains: NaN where hidden."""
    if kind == "Non-pollution":
        return pixels
    smeared = rng.uniform(size=len(pixels)) < SMEARED
    # together with the noise that is there already: SMEAR times as much
    pixels = pixels + smeared[:, None]*rng.normal(0, np.sqrt(SMEAR**2 - 1)*sim.SIGMA, pixels.shape)
    pixels[hidden_points(rng, kind)] = np.nan
    return pixels


def fit_seen(fit, direct, glass, lens):
    """fit_paper knows no missing points: they are left out for both."""
    seen = np.isfinite(glass).all(axis=1)
    if fit is normals.fit_joint:
        return fit([direct], [glass], lens)
    return fit([direct[seen]], [glass[seen]], lens)


def angles(rng, camera, normal, trials):
    """Degrees (trials, 3 kinds, 2 fits, 2): from the fit's result without pollution, and from the truth."""
    window, lens = sim.make_window(normal), sim.LENSES[camera]
    found = []
    for _ in range(trials):
        board = sim.board_points(rng, (0, 0, published.BOARD_DISTANCE), (30, 30, 50), 30, (0, 1))
        (direct,), _ = normals.pairs(rng, [board], camera, window)
        # every kind has an image of its own, as in the paper
        views = [polluted(rng, sim.look(board, camera, window, rng), kind) for kind in KINDS]
        fitted = [[fit_seen(fit, direct, view, lens) for fit in FITS] for view in views]
        found.append([[(sim.angle(n, clean), sim.angle(n, window.normal)) for n, clean in zip(ns, fitted[0])]
                      for ns in fitted])
    return np.array(found)


def run(trials):
    rng = np.random.default_rng(sim.SEED)
    rows = []
    for camera, (side, (vectors, similarities)) in enumerate(published.TABLE_4.items()):
        found = angles(rng, camera, vectors[0], trials)
        for i, kind in enumerate(KINDS):
            result = np.sqrt(np.mean(found[:, i]**2, axis=0))
            cells = ["", ""] if i == 0 else [f"{similarities[i - 1]:.7f}", f"{sim.angle(vectors[i], vectors[0]):.3f}"]
            rows.append([f"{side}, {kind}", *cells, *(f"{value:.3f}" if i or j else "" for value, j in
                                                      zip(result.ravel(), (0, 1, 0, 1)))])
    show(f"Table 4: normals through polluted glass, degrees (RMS of {trials} trials, 1 pair)",
         ["", "cosine similarity, published", "its angle", "the paper's method, from itself without pollution",
          "from the truth", "ours, from itself without pollution", "from the truth"], rows)


if __name__ == "__main__":
    run(200)
