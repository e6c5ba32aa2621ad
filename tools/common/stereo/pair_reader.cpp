// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "stereo/pair_reader.hpp"
#include "console/failure.hpp"
#include "console/images.hpp"
#include "console/table.hpp"
#include <algorithm>
#include <cmath>
#include <iostream>

using cv::format;
using cv::format;

namespace tools {

std::pair<cv::Mat, cv::Mat> PairReader::read(const FramePair& pair)
{
    cv::Mat image1 = first_.read(pair.first), image2 = second_.read(pair.second);
    requireSize(image1, first_.name(pair.first), rig_.cameras[0].camera->imageSize());
    requireSize(image2, second_.name(pair.second), rig_.cameras[1].camera->imageSize());
    if (image1.size() != image2.size())
        throw Failure(format("the images of the cameras are %dx%d and %dx%d pixels: refract_stereo is for two of one size",
                             image1.cols, image1.rows, image2.cols, image2.rows));
    if (needsColour_ && (image1.channels() != 3 || image2.channels() != 3))
        throw Failure("'" + (image1.channels() != 3 ? first_.name(pair.first) : second_.name(pair.second))
                      + "' is a grey image: --channels is for colours, leave it out");
    makeEightBit(image1, image2);
    return {image1, image2};
}

namespace {

//! NaN: nothing tells.
std::string orUnknown(double value, const char* how)
{
    return std::isnan(value) ? "unknown" : format(how, value);
}

std::string rowsFound(const PairResult& r)
{
    return std::isnan(r.rowsFound) ? "unknown" : format("%.2f of %.2f", r.rowsFound, r.rowsExpected);
}

std::vector<std::string> rowOf(const PairResult& r, const RectifiedRig& rig)
{
    return {r.stem, format("%.1f %%", 100*r.matched), format("%.5g ... %.5g", r.near, r.far), orUnknown(r.typicalSigma, "%.3g"),
            format("%.2f, %.2f", rig.rowError[0], rig.rowError[1]), rowsFound(r), format("%.1f", r.seconds)};
}

//! All pairs in one row: means, the whole range, the worst rows.
PairResult summaryOf(const std::vector<PairResult>& results)
{
    PairResult all = results[0];
    all.stem = format("all %d pairs", (int)results.size());
    all.matched = all.typicalSigma = all.seconds = 0;
    const auto isKnown = [](const PairResult& r) { return !std::isnan(r.typicalSigma); };
    const auto known = (double)std::count_if(results.begin(), results.end(), isKnown);
    for (const PairResult& r : results)
    {
        all.matched += r.matched/(double)results.size();
        all.typicalSigma += isKnown(r) ? r.typicalSigma : 0;
        all.near = std::min(all.near, r.near);
        all.far = std::max(all.far, r.far);
        all.rowsFound = std::fmax(all.rowsFound, r.rowsFound);
        all.rowsExpected = std::fmax(all.rowsExpected, r.rowsExpected);
        all.seconds += r.seconds;
    }
    all.typicalSigma /= known;
    return all;
}

} // namespace

void printTable(const std::vector<PairResult>& results, const RectifiedRig& rig)
{
    const size_t most = 30;     // rows that one reads
    const std::string unit = rig.calibration().unit, in = unit.empty() ? "" : ", " + unit;
    Table table({"", "pixels matched", "depth z" + in, "median sz" + in, "rows stated, px", "rows found, px", "seconds"});
    if (results.size() <= most)
        for (const PairResult& r : results)
            table.add(rowOf(r, rig));
    if (results.size() > 1)
        table.add(rowOf(summaryOf(results), rig));
    table.print(std::cout);
}

} // namespace tools
