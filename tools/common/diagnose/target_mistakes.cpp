// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "diagnose/target_mistakes.hpp"
#include "console/median.hpp"
#include "diagnose/fit_quality.hpp"
#include "console/table.hpp"
#include <opencv2/calib3d.hpp>
#include <set>

using namespace cv;
using namespace cv::refract;

namespace tools {

namespace {

const double MOST = 0.8;                // of the pairs that are apart
const double WHOLE_SQUARES = 0.25;      // of a shift remains if it is one by whole squares

struct PairShift
{
    Point shift;                //!< by how many rows and columns the glass image shows another part of the board than the direct one
    bool isApart;               //!< by more than half a square, however that comes
};

PairShift shiftOfPair(const CalibrationInput& input, const View& view, int camera)
{
    std::vector<Point2d> board, direct, glass;
    if (view.neighbours.empty())        // no board
        return {};
    for (size_t i = 0; i < view.objectPoints.size(); i++)
        if (seen(view.direct[camera][i]) && seen(view.glass[camera][i]))
        {
            board.emplace_back(view.objectPoints[i].x, view.objectPoints[i].y);
            direct.push_back(view.direct[camera][i]);
            glass.push_back(view.glass[camera][i]);
        }
    const Mat H = board.size() < 4 ? Mat() : findHomography(board, direct);
    if (H.empty())
        return {};
    const auto offBy = [&](Point shift) {
        std::vector<Point2d> moved, there;
        for (const Point2d& p : board)
            moved.push_back(p + input.square*Point2d(shift));
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
    std::vector<Point2d> ends, there;
    for (const Point2d& p : board)
        ends.push_back(p + 0.5*input.square*Point2d(1, 0));
    perspectiveTransform(ends, there, H);
    std::vector<double> halves;
    for (size_t i = 0; i < there.size(); i++)
        halves.push_back(norm(there[i] - direct[i]));
    return {best, best != Point() || offBy(Point()) > median(halves)};
}

} // namespace

std::string partOfBoard(const CalibrationInput& input, size_t fewest)
{
    int pairs = 0, apart = 0, shifted = 0;
    std::set<const View*> views;
    for (const View& view : input.data.views)
        for (int c = 0; c < input.data.cameraCount; c++)
            if (view.isPair(c))
            {
                pairs++;
                const PairShift pair = shiftOfPair(input, view, c);
                apart += pair.isApart;
                shifted += pair.shift != Point();
                if (pair.shift != Point())
                    views.insert(&view);
            }
    // Pairs of different moments are apart by anything, now and then by whole squares.
    if (views.size() < fewest || shifted < MOST*apart)
        return "";
    return format("in %d of %d pairs the two images show the board a whole row or column apart, so --size is smaller than the board: "
                  "count the inner corners (dots)", shifted, pairs);
}

double errorOfDirect(const CalibrationInput& input, int camera)
{
    const std::vector<View>& views = input.data.views;
    if (input.options.known[camera] || std::none_of(views.begin(), views.end(), [&](const View& v) { return !v.direct[camera].empty(); }))
        return 0.;
    try
    {
        std::vector<LensSource> sources;
        const CalibrationInput one = oneCamera(input, camera);
        startModel(one.data, one.options, sources);
        return sources[0].rms;
    }
    catch (const std::exception&)       // told elsewhere
    {
        return 0.;
    }
}

std::string badCorners(const CalibrationInput& input)
{
    for (int c = 0; c < input.data.cameraCount; c++)
    {
        const double px = errorOfDirect(input, c);
        if (px > largestSoundError(oneCamera(input, c).data))
            return format("already the direct images of camera %d, without any window, do not fit a lens (%.1f px): the "
                          "target is not as --pattern and --size say, or its points were found wrongly", c + 1, px);
    }
    return "";
}

} // namespace tools
