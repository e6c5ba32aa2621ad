// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "bundle/bundle_adjustment.hpp"
#include "calibrate/parameter_columns.hpp"
#include "console/failure.hpp"
#include "measure/rig_vector.hpp"

#include <algorithm>
#include <cmath>

using namespace cv;
using namespace cv::refract;

namespace tools {

namespace {

const char LEAVE_OUT[] = "start nearer to the truth, or leave out of --free what the points hardly tell";

//! The library's error in the tool's words: what was found, then what to do here.
std::string explained(const CalibrationError& e)
{
    const std::string reason = e.reason.empty() ? e.err : e.reason;
    switch (e.cause)
    {
    case CalibrationError::UNDETERMINED:
        return reason + ". Leave what is known out of --free, or see more: points nearer and farther, in the corners of the images, "
            "and lengths in all directions";
    case CalibrationError::NOT_CONVERGED:
        return std::string("the adjustment came to no end: ") + LEAVE_OUT;
    case CalibrationError::NO_SCALE:
        return "nothing tells the scale: no length of --lengths is between two points that two cameras see, by rays that meet beyond the "
            "windows; are the start, its unit of length and the order of the cameras right?";
    case CalibrationError::TOO_FEW_INLIERS:
        return reason + ": are the points matched, are the cameras in the order of the start, and is the start near enough (a few degrees "
            "and per cent)?";
    case CalibrationError::TOO_FEW_POINTS:
        return reason + "; give more points, or more lengths, or free less";
    case CalibrationError::WINDOW_NOT_SEEN:
        return format("no point was seen through the window of camera %d", e.camera + 1);
    case CalibrationError::NO_IMAGE:
        return reason + "; check what is given of the windows, the lens, and the units of the start, or " + LEAVE_OUT;
    default:
        return e.err;
    }
}

//! Squared deviations from what is known, in their standard deviations: (x - x0)^T C^+ (x - x0).
double squaredPrior(const BundleStart& start, const RigModel& rig)
{
    if (start.covariance.empty())
        return 0.;
    const VectorXd change = parametersOf(rig) - parametersOf(start.rig);
    std::vector<int> known;
    for (int i = 0; i < (int)change.size(); i++)
        if (start.covariance.at<double>(i, i) > 0)
            known.push_back(i);
    if (known.empty())
        return 0.;
    Mat correlation = partOf(start.covariance, known, known), inverse, scaled((int)known.size(), 1, CV_64F);
    const Mat variances = correlation.diag().clone();
    for (int i = 0; i < scaled.rows; i++)
    {
        scaled.at<double>(i) = change[known[i]]/std::sqrt(variances.at<double>(i));
        for (int j = 0; j < scaled.rows; j++)
            correlation.at<double>(i, j) /= std::sqrt(variances.at<double>(i)*variances.at<double>(j));
    }
    invert(correlation, inverse, DECOMP_SVD);
    return std::max(0., scaled.dot(inverse*scaled));
}

//! The same of the lengths, with the best of the error that all share.
double squaredLengths(const GivenLengths& lengths, const std::vector<Point3d>& points)
{
    const std::vector<Vec4d> rows = lengths.rows();
    const double common = lengths.commonStd();
    double squares = 0., cross = 0., weight = 1./(common*common);
    for (const Vec4d& row : rows)
    {
        const double found = norm(points[(int)row[0]] - points[(int)row[1]]);
        if (!std::isfinite(found))
            continue;
        const double residual = (found - row[2])/row[3], byScale = row[2]/row[3];
        squares += residual*residual;
        cross += residual*byScale;
        weight += byScale*byScale;
    }
    return squares - cross*cross/weight;
}

void setPoints(const Matches& matches, const Mat& points3D, const Mat& deviations, const std::vector<Mat>& inliers,
               BundleAdjustment& result)
{
    const double NaN = std::numeric_limits<double>::quiet_NaN();
    const int count = (int)matches.names.size();
    result.used.assign(matches.cameraCount(), std::vector<uchar>(count, 0));
    for (int c = 0; c < matches.cameraCount(); c++)
        for (int i = 0; i < count; i++)
        {
            result.used[c][i] = inliers[c].at<uchar>(i);
            result.usedPixels += result.used[c][i];
            result.seenPixels += matches.seenBy(i) > 1 && matches.pixels[c][i].x == matches.pixels[c][i].x;
        }
    for (int i = 0; i < count; i++)
    {
        const Vec3d X = points3D.at<Vec3d>(i);
        const Vec3d s(deviations.ptr<double>(i));
        const bool found = std::isfinite(X[0]) && std::isfinite(s[0] + s[1] + s[2]);
        result.points.push_back(found ? Point3d(X) : Point3d(NaN, NaN, NaN));
        result.sigma.push_back(found ? s : Vec3d::all(NaN));
        result.status.push_back(found ? (uchar)REFRACT_OK : matches.seenBy(i) < 2 ? (uchar)REFRACT_NOT_FINITE : INCONSISTENT);
    }
}

//! RMS of each camera. @param weighted squares of all, of each over its relative variance
std::vector<double> rmsOfCameras(const Matches& matches, const BundleAdjustment& result, double& weighted)
{
    std::vector<double> all;
    const double usual = matches.usualStd();
    weighted = 0.;
    for (int c = 0; c < matches.cameraCount(); c++)
    {
        std::vector<Point2d> modelled;
        const RigidTransform& place = result.fit.rig.extrinsics[c];
        refractiveProjectPoints(result.points, rotationVector(place.R), place.t, result.fit.rig.cameras[c], modelled);
        double squares = 0.;
        int count = 0;
        for (size_t i = 0; i < modelled.size(); i++)
            if (result.used[c][i] && seen(modelled[i]))
            {
                const double square = std::pow(norm(modelled[i] - matches.pixels[c][i]), 2);
                squares += square;
                weighted += matches.stds.empty() ? square : square*std::pow(usual/matches.stds[c][i], 2);
                count++;
            }
        all.push_back(count ? std::sqrt(squares/count) : -1.);
    }
    return all;
}

//! As refractiveBundleAdjust takes them; empty: all pixels are alike.
std::vector<std::vector<Mat>> covariancesOf(const Matches& matches)
{
    std::vector<std::vector<Mat>> all;
    const double usual = matches.usualStd();
    for (int c = 0; c < (int)matches.stds.size(); c++)
    {
        Mat_<Vec3d> covariances((int)matches.names.size(), 1);
        for (int i = 0; i < covariances.rows; i++)
        {
            const double variance = std::pow(matches.stds[c][i]/usual, 2);
            covariances(i) = Vec3d(variance, 0., variance);
        }
        all.push_back({covariances});
    }
    return all;
}

} // namespace

void adjustOrExplain(const std::function<void()>& adjust)
{
    try
    {
        adjust();
    }
    catch (const CalibrationError& e)
    {
        throw Failure(explained(e));
    }
    catch (const cv::Exception& e)
    {
        throw Failure(e.err + ": an adjustment must not come to that; " + LEAVE_OUT);
    }
}

double squaredKnown(const BundleStart& start, const GivenLengths& lengths, const BundleAdjustment& result)
{
    return squaredPrior(start, result.fit.rig) + (lengths.list.empty() ? 0. : squaredLengths(lengths, result.points));
}

int BundleAdjustment::answers() const
{
    return (int)std::count_if(points.begin(), points.end(), [](const Point3d& X) { return X.x == X.x; });
}

std::vector<int> BundleAdjustment::outliers() const
{
    std::vector<int> list;
    for (int i = 0; i < (int)points.size(); i++)
        if (status[i] == INCONSISTENT)
            list.push_back(i);
    return list;
}

BundleAdjustment adjustBundle(const BundleStart& start, const Matches& matches, const GivenLengths& lengths, bool robust, int iterations)
{
    BundleAdjustment result;
    Fit& fit = result.fit;
    fit.rig = start.rig.clone();
    std::vector<std::vector<Mat>> pixels;
    std::vector<Mat> Rs, Ts;
    for (int c = 0; c < matches.cameraCount(); c++)
    {
        pixels.push_back({Mat(matches.pixels[c], true)});
        Rs.push_back(Mat(fit.rig.extrinsics[c].R, true));
        Ts.push_back(Mat(fit.rig.extrinsics[c].t, true));
    }
    BundleAdjustOptions options(start.flags | (robust ? GLASS_ROBUST : 0));
    options.criteria.maxCount = iterations;
    options.pixelCovariances = covariancesOf(matches);
    options.rigCovariance = start.covariance;
    options.lengthScaleStd = lengths.commonStd();
    Mat points3D;
    BundleAdjustResult found;
    adjustOrExplain([&] {
        found = refractiveBundleAdjust(pixels, fit.rig.cameras, fit.rig.windows, Rs, Ts, noArray(), noArray(), points3D, lengths.rows(),
                                       options);
    });
    setEstimate(found, fit);
    for (int c = 1; c < matches.cameraCount(); c++)
        fit.rig.extrinsics[c] = {Rs[c], Ts[c]};
    setPoints(matches, points3D, found.pointDeviations, found.inliers, result);
    result.rmsOfCamera = rmsOfCameras(matches, result, result.squaredPixels);
    result.squaredKnown = squaredKnown(start, lengths, result);
    return result;
}

Calibration toFile(const BundleAdjustment& adjustment, const Calibration& start)
{
    Calibration file = calibrationOf(adjustment.fit.rig);
    for (int c = 0; c < (int)file.cameras.size(); c++)
    {
        file.cameras[c].windowStd = windowStd(adjustment.fit, c);
        file.cameras[c].rms = adjustment.rmsOfCamera[c];
    }
    file.rms = adjustment.fit.rms;
    file.sigma = adjustment.fit.sigma;
    file.dof = adjustment.fit.dof;
    file.covariance = adjustment.fit.covariance;
    file.square = start.square;
    file.channel = start.channel;
    file.label = start.label;
    file.provenance.images = start.provenance.images;       // these had their say
    return file;
}

} // namespace tools
