// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "measure/measured_doubts.hpp"
#include "calibrate/given_std.hpp"
#include "calibrate/units.hpp"
#include "console/table.hpp"
#include "math/dense.hpp"
#include "measure/joint_error.hpp"
#include <algorithm>
#include <cmath>
#include <limits>

using namespace cv;

namespace tools {

namespace {

const double NOT_KNOWN = std::numeric_limits<double>::quiet_NaN();

bool isOutside(const Calibration& calibration, size_t camera, const Point2d& pixel)
{
    return isFarOutside(pixel, calibration.cameras[camera].camera->imageSize());
}

//! The sum of the ratios, and how it changes with each point of a view.
struct RatiosOfView
{
    double sum = 0.;
    int count = 0;
    std::vector<Vec3d> byPoint;
};

RatiosOfView ratiosOf(const View& view, const Measurement& measured)
{
    RatiosOfView ratios;
    ratios.byPoint.resize(measured.points.size());
    for (const auto& pair : view.neighbours)
    {
        if (measured.status[pair.first] != refract::REFRACT_OK || measured.status[pair.second] != refract::REFRACT_OK)
            continue;
        const Vec3d along = measured.points[pair.second] - measured.points[pair.first];
        const double length = norm(view.objectPoints[pair.second] - view.objectPoints[pair.first]);
        const Vec3d by = along*(1./(norm(along)*length));
        ratios.sum += norm(along)/length;
        ratios.count++;
        ratios.byPoint[pair.second] += by;
        ratios.byPoint[pair.first] -= by;
    }
    return ratios;
}

} // namespace

void forgetOutside(const Calibration& calibration, Measurement& m)
{
    for (size_t i = 0; i < m.points.size(); i++)
        for (size_t c = 0; c < m.pixels.size(); c++)
            if (isOutside(calibration, c, m.pixels[c][i]))
            {
                m.points[i] = Point3d(NOT_KNOWN, NOT_KNOWN, NOT_KNOWN);
                m.sigma[i] = Vec3d::all(NOT_KNOWN);
                m.status[i] = OUTSIDE_IMAGE;
            }
}

//! What to say of points outside, with the first one by its name; empty: there are none.
static std::string outsideIn(const Calibration& calibration, const Measurement& m, const std::vector<std::string>& ids)
{
    std::string first;
    int count = 0;
    for (size_t i = 0; i < m.points.size(); i++)
    {
        count += m.status[i] == OUTSIDE_IMAGE;
        for (size_t c = 0; c < m.pixels.size() && first.empty(); c++)
            if (isOutside(calibration, c, m.pixels[c][i]))
            {
                const Size size = calibration.cameras[c].camera->imageSize();
                first = format("'%s' at (%g, %g) in camera %zu (%dx%d)", ids[i].c_str(), m.pixels[c][i].x, m.pixels[c][i].y, c + 1,
                               size.width, size.height);
            }
    }
    if (!count)
        return "";
    return format("%d of %zu points lie outside of an image, first ", count, m.points.size()) + first
        + format("; status %d, no answer. Are these the pixels of images of another size, cropped, or with the cameras exchanged?",
                 OUTSIDE_IMAGE);
}

std::vector<double> lengthErrors(const View& view, const std::vector<Point3d>& points)
{
    std::vector<double> errors;
    for (const auto& pair : view.neighbours)
    {
        const double measured = cv::norm(points[pair.second] - points[pair.first]);
        if (measured == measured)
            errors.push_back(measured - cv::norm(view.objectPoints[pair.second] - view.objectPoints[pair.first]));
    }
    return errors;
}

double LengthScale::deviations() const
{
    return sigma > 0. ? std::abs(ratio - 1.)/sigma : 0.;
}

LengthScale lengthScaleOf(const Calibration& calibration, const std::vector<View>& views, const std::vector<Measurement>& results,
                          double pixelSigma, double targetSigma, const std::optional<Vec4d>& plane)
{
    double sum = 0., ofNoise = 0.;
    int count = 0;
    Eigen::RowVectorXd byCalibration;
    for (size_t k = 0; k < results.size(); k++)
    {
        const RatiosOfView ratios = ratiosOf(views[k], results[k]);
        if (ratios.count == 0)
            continue;
        sum += ratios.sum;
        count += ratios.count;
        const JointError joint = jointErrorOf(calibration, results[k].points, results[k].pixels, plane);
        for (size_t i = 0; i < ratios.byPoint.size(); i++)
        {
            if (results[k].status[i] != refract::REFRACT_OK)
                continue;
            const Eigen::RowVector3d by(ratios.byPoint[i][0], ratios.byPoint[i][1], ratios.byPoint[i][2]);
            ofNoise += by*joint.noise[i]*by.transpose();
            if (byCalibration.size() == 0)
                byCalibration = Eigen::RowVectorXd::Zero(joint.byCalibration[i].cols());
            byCalibration += refract::product(by, joint.byCalibration[i]);
        }
    }
    if (count == 0)
        return {1., std::numeric_limits<double>::quiet_NaN()};
    double variance = pixelSigma*pixelSigma*ofNoise/((double)count*count) + targetSigma*targetSigma;
    if (calibration.covariance.empty())
        variance = std::numeric_limits<double>::quiet_NaN();
    else
        variance += refract::propagated(toEigen(calibration.covariance), byCalibration)(0, 0)/((double)count*count);
    return {sum/count, std::sqrt(variance)};
}

std::string contradictionIn(const std::vector<MeasuredView>& measured, const std::vector<Measurement>& results)
{
    std::vector<std::string> names;
    int points = 0, all = 0, nowhere = 0;
    double worst = 0;
    for (size_t i = 0; i < results.size(); i++)
    {
        const Measurement& m = results[i];
        all += (int)m.points.size();
        if (!m.inconsistent())
            continue;
        names.push_back(measured[i].stem);
        points += m.inconsistent();
        for (size_t k = 0; k < m.points.size(); k++)
            nowhere += m.status[k] == INCONSISTENT && m.points[k].x != m.points[k].x;
        worst = std::max(worst, m.worstResidual);
    }
    if (names.empty())
        return "";
    const bool pairs = results[0].pixels.size() == 2, rig = results[0].pixels.size() > 1;
    const std::string left = pairs ? "the two pixels of a point miss each other by up to %.3g px"
                             : rig ? "the pixels of a point miss each other by up to %.3g px RMS per coordinate"
                                   : "the pose leaves residuals of up to %.3g px per coordinate";
    return format("%d of %d points contradict themselves by far more than the noise: ", points, all)
        + format(left.c_str(), pairs ? std::sqrt(2.)*worst : worst) + " (" + listed(names) + "; status 9"
        + (nowhere == points ? ", no answer" : nowhere ? format(", %d of them without answer", nowhere)
           : rig ? ", large sx, sy, sz" : ", no sx, sy, sz")
        + "). "
        + (rig ? std::string("Check that ") + (pairs ? "left and right are not swapped, that the images of a pair"
                                                     : "the cameras are in the calibration's order, that images of one name")
                 + " are of one moment, and that no camera and no window has moved since the calibration"
                 : "Check --size, --square, that the target is flat, and that camera and window are those of the calibration");
}

std::string outsideImages(const Calibration& calibration, const std::vector<MeasuredView>& measured,
                          const std::vector<Measurement>& results)
{
    for (size_t i = 0; i < results.size(); i++)
    {
        const std::string text = outsideIn(calibration, results[i], measured[i].ids);
        if (!text.empty())
            return (results.size() > 1 ? "'" + measured[i].stem + "': " : "") + text;
    }
    return "";
}

bool mostContradict(const std::vector<Measurement>& results)
{
    int all = 0, wrong = 0;
    for (const Measurement& m : results)
    {
        all += m.seenPoints();
        wrong += m.contradicting() + (int)std::count(m.status.begin(), m.status.end(), OUTSIDE_IMAGE);
    }
    return 2*wrong > all;
}

std::string wrongLengths(double square, const Calibration& calibration, const std::vector<MeasuredView>& measured,
                         const std::vector<Measurement>& results, double pixelSigma, const std::optional<cv::Vec4d>& plane)
{
    const double FAR_OFF = 0.2, CONTRADICTING = 5.;     // of a plane, whose error is not said; standard deviations, as those of a point
    const LengthScale scale = lengthScaleOf(calibration, {measured.begin(), measured.end()}, results, pixelSigma,
                                            USUAL_SQUARE_STD, plane);
    const bool isFar = std::abs(scale.ratio - 1.) > FAR_OFF, contradicts = !plane && scale.deviations() > CONTRADICTING;
    if (!isFar && !contradicts)
        return "";
    const std::string unit = unitSeen(scale.ratio, calibration.unit);
    const std::string times = format("the distances between neighbouring points are on average %.*g times those of the target",
                                     isFar ? 3 : 6, scale.ratio);
    if (!unit.empty())
        return times + format(": is --square=%g in ", square) + unit
            + "? It must be in the unit of the calibration" + (calibration.unit.empty() ? "" : ", " + calibration.unit);
    return times
        + (contradicts ? format(", %.3g standard deviations of noise, calibration and a printed board from 1", scale.deviations())
                       : std::string())
        + format(": is --square=%g right, in the unit of the calibration, and are ", square)
        + (isFar ? "images and calibration of the same cameras?" : "cameras and windows where they were when they were calibrated?");
}

std::string noisierImages(const std::vector<MeasuredView>& measured, const std::vector<Measurement>& results, double pixelSigma)
{
    const double FEW = 3.;
    std::vector<std::string> names;
    double worst = 0;
    for (size_t i = 0; i < results.size(); i++)
        if (!results[i].inconsistent() && results[i].noise > FEW*pixelSigma)
        {
            names.push_back(measured[i].stem);
            worst = std::max(worst, results[i].noise);
        }
    if (names.empty())
        return "";
    return format("the pixels are noisier than in the calibration: up to %.3g px per coordinate instead of %.3g px, in ", worst, pixelSigma)
        + listed(names) + "; sx, sy, sz include this. Check focus, light, motion, and the target";
}

} // namespace tools
