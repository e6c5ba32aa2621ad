// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "boards.hpp"
#include "rows.hpp"

using namespace cv::refract;

namespace bench {

void addCalibrationRows(std::vector<Row>& rows)
{
    const int VIEWS = 50;
    const auto boards = std::make_shared<Boards>(VIEWS);
    const auto add = [&](const std::string& key, const std::string& work, int flags)
    {
        // Time is per pair of corners.
        Row r = { key, work, "cv::calibrateCamera, direct", { 0.5, 0.5 }, VIEWS*Boards::CORNERS, {}, {}, {}, {}, 0, "deviations",
                  5, {}, {}, {} };
        r.ours = [=] { boards->calibrateGlass(flags); };
        r.peer = [=] { boards->calibrateCamera(); };
        r.error = [=] { return boards->normalError(flags); };
        rows.push_back(r);
    };
    add("calibrate", "calibrateGlass, 50 pairs of 54 corners", 0);
    add("calibrate_lens", "the same, lens and thickness free", GLASS_FREE_INTRINSICS | GLASS_FREE_THICKNESS);
}

} // namespace bench
