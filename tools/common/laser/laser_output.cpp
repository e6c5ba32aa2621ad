// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "laser/laser_output.hpp"
#include "console/csv.hpp"
#include "console/numbers.hpp"
#include <opencv2/core.hpp>
#include <algorithm>
#include <cmath>
#include <iostream>
#include <sstream>

using namespace cv::refract;
using cv::format;

namespace tools {

std::string csvOf(const std::vector<Scan>& scans)
{
    PointsCsv csv(1);
    for (const Scan& scan : scans)
        for (size_t i = 0; i < scan.line.points.size(); i++)
        {
            const Measurement& m = scan.measured;
            csv.add(scan.name, std::to_string(i), {m.pixels[0][i].x, m.pixels[0][i].y}, m.points[i], m.sigma[i], m.status[i]);
        }
    return csv.text();
}

std::string unitAfter(const std::string& unit) { return unit.empty() ? "" : " " + unit; }

void ElsewhereLine::add(const Measurement& measured)
{
    for (size_t i = 0; i < measured.points.size(); i++)
        if (measured.status[i] == REFRACT_OK)
        {
            points++;
            near = std::min(near, measured.points[i].z);
            far = std::max(far, measured.points[i].z);
        }
}

std::string ElsewhereLine::text(const std::string& depth) const
{
    return format("%d points of a line are at z %.4g to %.4g, outside --depth=%s", points, near, far, depth.c_str());
}

std::string bendNotice(const SheetFit& fit, const std::string& unit)
{
    const double SURE = 4.;
    double sum = 0., weight = 0., largest = 0.;
    for (const LineOnBoard& line : fit.lines)
    {
        sum += line.bend/(line.bendSigma*line.bendSigma);
        weight += 1./(line.bendSigma*line.bendSigma);
        largest = std::max(largest, std::abs(line.bend));
    }
    if (!(std::abs(sum) > SURE*std::sqrt(weight)))
        return "";
    const char* const why = isPlane(fit.sheet)
        ? "the sheet is not quite a plane (refracted at a window that it does not cross straight: describe that by --emitter), or the "
          "boards are not flat"
        : "it is not the sheet of the emitter that --emitter describes, or the boards are not flat";
    return format("the lines on the boards are bent off the sheet, by %.2g%s on average and at most %.2g: %s", std::abs(sum/weight),
                  unitAfter(unit).c_str(), largest, why);
}

void printSheet(const SheetFit& fit, const std::vector<BoardImage>& boards, const Sheet& sheet)
{
    const std::string unit = unitAfter(sheet.unit);
    const cv::Mat& C = sheet.covariance;
    const double tilt = std::sqrt(C.at<double>(0, 0) + C.at<double>(1, 1) + C.at<double>(2, 2))*180/CV_PI;
    double rms = 0.;
    for (const LineOnBoard& line : fit.lines)
        rms += line.rmsPx*line.rmsPx/fit.lines.size();
    std::cout << format("Sheet of light: %.6f x %+.6f y %+.6f z = %s%s (camera 1)\n", sheet.plane[0], sheet.plane[1], sheet.plane[2],
                        rounded(sheet.plane[3], decimalsOf(fit.sheetStd)).c_str(), unit.c_str());
    if (isPlane(sheet))
        std::cout << format("  +- %.3f deg, ", tilt);
    else
        std::cout << "  is the nearest plane to the emitter's, which is refracted at its window;\n"
                  << format("  for a plane, chi-square is larger by %.1f\n", fit.planeExcess)
                  << format("  +- %.3g%s (RMS where the lines are), ", fit.sheetStd, unit.c_str());
    std::cout << format("at z %.4g to %.4g%s; %zu of %zu boards\n", sheet.depth[0], sheet.depth[1], unit.c_str(), fit.lines.size(),
                        boards.size())
              << format("  lines: %.3f px off straight (RMS), profile %.1f px wide (standard deviation)\n", std::sqrt(rms), sheet.scale)
              << format("  boards' poses: errors %.1f times those of the corners' noise\n", fit.poseNoise)
              << format("Each board held out: %s%s from the sheet of the others (RMS),\n  %.2f times what the +- says\n",
                        rounded(fit.heldOutRms(), decimalsOf(fit.heldOutRms())).c_str(), unit.c_str(), fit.heldOutRatio());
}

} // namespace tools
