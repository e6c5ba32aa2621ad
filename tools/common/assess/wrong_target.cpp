// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "assess/wrong_target.hpp"
#include "assess/fit_quality.hpp"
#include "console/table.hpp"
#include <opencv2/calib3d.hpp>

using namespace cv;
using namespace cv::refract;

namespace tools {

namespace {

const double WHOLE_SQUARES = 0.25;      // of a shift remains if it is one by whole squares

//! By how many rows and columns the glass image of a pair shows another part of the board than the direct one.
Point shiftOfPair(const Given& given, const Moment& m, int camera)
{
    std::vector<Point2d> board, direct, glass;
    if (m.neighbours.empty())           // no board
        return Point();
    for (size_t i = 0; i < m.objectPoints.size(); i++)
        if (seen(m.direct[camera][i]) && seen(m.glass[camera][i]))
        {
            board.emplace_back(m.objectPoints[i].x, m.objectPoints[i].y);
            direct.push_back(m.direct[camera][i]);
            glass.push_back(m.glass[camera][i]);
        }
    const Mat H = board.size() < 4 ? Mat() : findHomography(board, direct);
    if (H.empty())
        return Point();
    const auto offBy = [&](Point shift) {
        std::vector<Point2d> moved, there;
        for (const Point2d& p : board)
            moved.push_back(p + given.square*Point2d(shift));
        perspectiveTransform(moved, there, H);
        std::vector<double> lengths;
        for (size_t i = 0; i < there.size(); i++)
            lengths.push_back(norm(there[i] - glass[i]));
        return median(lengths);
    };
    Point best;
    for (int x = -2; x <= 2; x++)
        for (int y = -2; y <= 2; y++)
            if (offBy(Point(x, y)) < WHOLE_SQUARES*offBy(best))
                best = Point(x, y);
    return best;
}

} // namespace

std::string partOfBoard(const Given& given)
{
    int pairs = 0, shifted = 0;
    for (const Moment& m : given.data.moments)
        for (int c = 0; c < given.data.cameraCount; c++)
            if (m.isPair(c))
            {
                pairs++;
                shifted += shiftOfPair(given, m, c) != Point();
            }
    return shifted == 0 ? "" : format("in %d of %d pairs the two images show the board a whole row or column apart, so --size is "
                                      "smaller than the board: count the inner corners (dots)", shifted, pairs);
}

std::string badCorners(const Given& given)
{
    for (int c = 0; c < given.data.cameraCount; c++)
        try
        {
            std::vector<LensSource> sources;
            const Given one = oneCamera(given, c);
            startModel(one.data, one.options, sources);
            if (sources[0].kind == LensSource::FROM_DIRECT && sources[0].rms > largestSoundError(one.data))
                return format("already the direct images of camera %d, without any window, do not fit a lens (%.1f px): the "
                              "target is not as --pattern and --size say, or its points were found wrongly", c + 1,
                              sources[0].rms);
        }
        catch (const std::exception&) {}        // told elsewhere
    return "";
}

} // namespace tools
