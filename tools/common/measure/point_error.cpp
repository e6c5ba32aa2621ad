// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "measure/point_error.hpp"
#include "math/quantile.hpp"
#include <algorithm>
#include <limits>

using namespace cv;
using namespace cv::refract;

namespace tools {

namespace {

const double NOT_SEEN = std::numeric_limits<double>::quiet_NaN();

//! What the cameras see of the points where camera 1's rays through some pixels meet the plane z = range.
struct PointsAtRange
{
    std::vector<cv::Point3d> points;            //!< NaN: not seen by camera 1 and another one, if there is one
    RigPixels pixels;                           //!< exact; NaN where a camera does not see the point
};

std::vector<double> errorsOf(const Calibration& calibration, const PointsAtRange& seen, double range, double pixelSigma)
{
    const Measurement m = calibration.single() ? measureOnPlane(calibration, seen.pixels[0], Vec4d(0, 0, 1, range), pixelSigma)
                                               : measureRig(calibration, seen.pixels, pixelSigma);
    std::vector<double> errors;
    for (size_t i = 0; i < m.points.size(); i++)
        errors.push_back(m.status[i] == REFRACT_OK ? norm(m.sigma[i]) : NOT_SEEN);
    return errors;
}

} // namespace

bool ErrorMap::seen() const { return worst() == worst(); }

double ErrorMap::best() const { return quantile(total, 0.); }

double ErrorMap::worst() const { return quantile(total, 1.); }

double ErrorMap::worstPixelNoise() const { return quantile(pixelNoise, 1.); }

double ErrorMap::percentile95() const { return quantile(total, 0.95); }

double ErrorMap::median() const { return quantile(total, 0.5); }

double ErrorMap::seenShare() const
{
    const auto seen = std::count_if(total.begin(), total.end(), [](double error) { return error == error; });
    return total.empty() ? 0. : (double)seen/(double)total.size();
}

void ErrorSquares::add(const ErrorMap& map)
{
    for (size_t i = 0; i < map.total.size(); i++)
    {
        if (!(map.total[i] == map.total[i]))
            continue;
        const double noise = map.pixelNoise[i]*map.pixelNoise[i];
        calibration += map.total[i]*map.total[i] - noise;
        pixelNoise += noise;
        count++;
    }
}

std::vector<Point2d> gridOver(Size image, int columns, Size& grid)
{
    grid = Size(columns, std::max(2, cvRound((double)columns*image.height/image.width)));
    std::vector<Point2d> pixels;
    for (int row = 0; row < grid.height; row++)
        for (int column = 0; column < grid.width; column++)
            pixels.emplace_back((image.width - 1.)*column/(grid.width - 1), (image.height - 1.)*row/(grid.height - 1));
    return pixels;
}

static PointsAtRange pointsAtRange(const Calibration& calibration, const std::vector<Point2d>& pixels1, double range)
{
    PointsAtRange result;
    result.pixels = {pixels1};
    refractivePointsOnPlane(pixels1, result.points, calibration.cameras[0].camera, Vec4d(0, 0, 1, range));
    const Point2d none(NOT_SEEN, NOT_SEEN);
    for (size_t c = 1; c < calibration.cameras.size(); c++)
    {
        const Ptr<RefractiveCamera>& camera = calibration.cameras[c].camera;
        std::vector<Point2d> pixels;
        refractiveProjectPoints(result.points, Mat(calibration.extrinsics[c].R), calibration.extrinsics[c].t, camera, pixels);
        const Rect2d image(Point2d(-0.5, -0.5), Size2d(camera->imageSize()));
        for (Point2d& pixel : pixels)
            if (!image.contains(pixel))         // false for NaN
                pixel = none;
        result.pixels.push_back(pixels);
    }
    for (size_t i = 0; i < pixels1.size() && !calibration.single(); i++)
        if (std::none_of(result.pixels.begin() + 1, result.pixels.end(), [i](const auto& pixels) { return tools::seen(pixels[i]); }))
        {
            result.points[i] = Point3d(NOT_SEEN, NOT_SEEN, NOT_SEEN);
            result.pixels[0][i] = none;
        }
    return result;
}

ErrorMap mapErrors(const Calibration& calibration, double range, double pixelSigma, int columns)
{
    ErrorMap map;
    map.range = range;
    map.pixels = gridOver(calibration.cameras[0].camera->imageSize(), columns, map.grid);
    const PointsAtRange seen = pointsAtRange(calibration, map.pixels, range);
    Calibration certain = calibration;
    certain.covariance.release();
    map.total = errorsOf(calibration, seen, range, pixelSigma);
    map.pixelNoise = errorsOf(certain, seen, range, pixelSigma);
    return map;
}

} // namespace tools
