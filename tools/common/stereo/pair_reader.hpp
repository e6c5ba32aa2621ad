// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_PAIR_READER_HPP
#define REFRACT_TOOLS_PAIR_READER_HPP

#include "calibrate/calib_file.hpp"
#include "console/frames.hpp"

namespace tools {

//! Images of both cameras, 8-bit, of the size that was calibrated.
class PairReader
{
public:
    PairReader(Frames& first, Frames& second, const Calibration& rig, bool needsColour)
        : first_(first), second_(second), rig_(rig), needsColour_(needsColour) {}

    std::pair<cv::Mat, cv::Mat> read(const FramePair& pair);

private:
    Frames &first_, &second_;
    const Calibration& rig_;
    bool needsColour_;
};

} // namespace tools

#endif // REFRACT_TOOLS_PAIR_READER_HPP
