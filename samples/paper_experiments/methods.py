# This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
# SPDX-License-Identifier: Apache-2.0

"""The methods that are compared, by the names and colours that tables and figures give them."""
IGNORED = "glass ignored"
PAPER = "the paper's method, 1 pair"
PINHOLE = "pinhole calibrated through the glass"
OURS_1 = "ours, 1 pair"
OURS_10 = "ours, 10 pairs"
WITHOUT = "no glass at all"
METHODS = IGNORED, PAPER, PINHOLE, OURS_1, OURS_10, WITHOUT
COLORS = {IGNORED: "tab:orange", PAPER: "tab:purple", PINHOLE: "tab:red", OURS_1: "tab:cyan", WITHOUT: "tab:gray"}
