# This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
# SPDX-License-Identifier: Apache-2.0

"""Which printed numbers follow from the paper's other numbers, and which do not. No simulation, only arithmetic."""
import numpy as np
import normals
import paper_method
import published
import simulation as sim
from tables import show


def check_tables():
    """RMSE from the rows' errors and values, mean of the errors; errors that are no differences of their values."""
    for number, table, stated in ((1, published.TABLE_1, published.TABLE_1_RMSE),
                                  (2, published.TABLE_2, published.TABLE_2_RMSE)):
        for i, (rows, text) in enumerate(zip(table, stated)):
            rows = np.array(rows)
            printed = rows[:, 3:]                                   # before, after
            differences = np.abs(rows[:, 1:3] - rows[:, :1])
            for column, name in enumerate(("before", "after")):
                found = "{:.4f} from the errors, {:.4f} from the values; mean {:.4f}".format(
                    sim.rms(printed[:, column]), sim.rms(differences[:, column]), printed[:, column].mean())
                yield f"Table {number}, experiment {i + 1}: RMSE {name}, mm", f"{text[column]:.4f}", found
            for row in np.flatnonzero(np.abs(differences - printed).max(axis=1) > 2e-4):    # rounding of two values
                yield (f"Table {number}, experiment {i + 1}, {published.SEGMENTS[row]}: errors before, after, mm",
                       *("{:.4f}, {:.4f}".format(*errors[row]) for errors in (printed, differences)))


def check_real_values():
    """Table 1 takes as real what was measured without glass: how far is that from the board as made (Table 2)?"""
    for i, (measured, made) in enumerate(zip(published.TABLE_1, published.TABLE_2)):
        difference = sim.rms(np.array(measured)[:, 0] - np.array(made)[:, 0])
        yield f"Table 1, experiment {i + 1}: \"real values\" off the board as made, RMS, mm", "0", f"{difference:.4f}"


def check_rig():
    board = sim.BOARD + (0, 0, published.BOARD_DISTANCE)
    for name, rotation in (("M_R", published.M_R), ("the transpose of M_R", published.M_R.T)):
        x, y, z = (board @ rotation.T + published.M_T).T
        u = published.K2[0, 0]*x/z + published.K2[0, 2]
        yield (f"Table 3: columns of the board at 610 mm in the right image, with {name}", "0 to 1280",
               f"{u.min():.0f} to {u.max():.0f}")
    yield "Baseline, mm", f"{published.BASELINE_STATED:.0f}", f"{np.linalg.norm(published.M_T):.1f}"
    fields = (np.degrees(2*np.arctan(size/2/published.K1[0, 0])) for size in published.IMAGE_SIZE)
    yield "Field of view, degrees", "25", "{:.1f} x {:.1f}".format(*fields)
    for name, camera, normal, center in normals.PRINTED:
        by_normal = normals.center_of_normal(normal, sim.LENSES[camera][0])
        yield (f"Distortion centre, {name}, px", "({:.1f}, {:.1f})".format(*center),
               "({:.1f}, {:.1f}) from the normal".format(*by_normal))


def check_pollution():
    for side, (vectors, similarities) in published.TABLE_4.items():
        for name, vector, similarity in zip("AB", vectors[1:], similarities):
            cosine = np.dot(vectors[0], vector)/np.linalg.norm(vectors[0])/np.linalg.norm(vector)
            yield f"Table 4, {side}, Pollution {name}: cosine similarity", f"{similarity:.7f}", f"{cosine:.7f}"
        lengths = np.linalg.norm(vectors, axis=1)
        yield f"Table 4, {side}: length of the unit normals", "1", ", ".join(f"{length:.4f}" for length in lengths)


def check_equations():
    """(6) and (17) taken literally."""
    n = np.array(published.TABLE_3_LEFT[2])
    n = n/np.linalg.norm(n)
    printed = paper_method.rotation_to_virtual_camera(n).T @ (0, 0, 1)      # (6) turns the other way
    three = "({:.3f}, {:.3f}, {:.3f})".format
    yield "Text below (8): w1 = w turned by (6), Table 3, left", three(-n[0], -n[1], n[2]), three(*printed)
    K, f = published.K1, 12.5
    q3, q2 = paper_method.virtual_rays(K[:2, 2][None], K, n, published.THICKNESS, published.INDEX)
    # (17) has F_h in the direction of F4 as seen from the centre, instead of on the ray through F4
    shift = np.linalg.norm(q3 - q2)
    yield ("(17): point at 610 mm on the left axis, off the ray of (14), mm", "0",
           f"{shift*(published.BOARD_DISTANCE/f - 1):.0f}")


def run():
    checks = check_tables, check_real_values, check_rig, check_pollution, check_equations
    show("What follows from the paper's own numbers", ["", "printed", "from its own numbers"],
         [row for check in checks for row in check()])


if __name__ == "__main__":
    run()
