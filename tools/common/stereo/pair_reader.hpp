// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_PAIR_READER_HPP
#define REFRACT_TOOLS_PAIR_READER_HPP

#include "calibrate/calib_file.hpp"
#include "console/frames.hpp"
#include "stereo/rectified_rig.hpp"
#include <string>
#include <vector>

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

//! What the table says of a pair.
struct PairResult
{
    std::string stem;
    double matched = 0, near = 0, far = 0, typicalSigma = NAN, rowsFound = NAN, rowsExpected = NAN, seconds = 0;
    std::vector<std::string> warnings;
    std::string refusal;                //!< empty: it is written
};

//! A row for each pair, or one for all where these are too many to read.
void printTable(const std::vector<PairResult>& results, const RectifiedRig& rig);

} // namespace tools

#endif // REFRACT_TOOLS_PAIR_READER_HPP
