// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "calibrate/conditions.hpp"
#include "calibrate/parameter_columns.hpp"
#include "calibrate/window_face.hpp"
#include "console/failure.hpp"
#include "console/options.hpp"

using namespace cv;
using namespace cv::refract;

namespace tools {

namespace {

void requireDistance(const GlassWindow& window, const Medium& medium, size_t camera, const std::string& filename)
{
    if (!isRound(window) && !hasDifferentMedia(window) && medium.index.value != window.outerIndex)
        throw Failure(format("--outer-index: '%s' was calibrated with an index of %g on both sides of the window of camera %zu, where the "
                             "window's distance has no effect and is not known: calibrate with images that were taken in the other medium",
                             filename.c_str(), window.outerIndex, camera + 1));
}

GlassWindow inMedium(GlassWindow window, const Medium& medium)
{
    window.outerIndex = medium.index.value;
    if (!window.materials.empty())
        window.materials.back() = medium.index.material;
    return window;
}

std::vector<int> columnsOfMedium(const RigModel& rig)
{
    std::vector<int> columns;
    for (int c = 0; c < (int)rig.cameras.size(); c++)
        columns.push_back(columnsOf(rig, c).outerIndex);
    return columns;
}

//! One error for all windows, independent of all else.
void setVariance(Mat& covariance, const std::vector<int>& columns, double std)
{
    for (int column : columns)
    {
        covariance.row(column).setTo(0.);
        covariance.col(column).setTo(0.);
    }
    for (int a : columns)
        for (int b : columns)
            covariance.at<double>(a, b) = std*std;
}

//! The same of what the covariance is made of: the index of that time stays as far as it moved other parameters.
void setSource(std::vector<UncertaintySource>& sources, const std::vector<int>& columns, int rows, const Medium& medium)
{
    for (UncertaintySource& source : sources)
    {
        source.factor = source.factor.clone();
        for (int column : columns)
            source.factor.row(column).setTo(0.);
        if (source.name.find(INDEX_OF_MEDIUM) == 0)
            source.name += ", when calibrated";
    }
    UncertaintySource now = {INDEX_OF_MEDIUM, medium.std.text(""), medium.std, Mat(rows, 1, CV_64F, Scalar(0))};
    for (int column : columns)
        now.factor.at<double>(column) = medium.std;
    sources.push_back(now);
}

} // namespace

Calibration inMedium(const Calibration& calibration, const Medium& medium, const std::string& filename)
{
    Calibration result = calibration;
    for (size_t c = 0; c < result.cameras.size(); c++)
    {
        CameraCalibration& camera = result.cameras[c];
        requireDistance(camera.camera->window(), medium, c, filename);
        camera.camera = copyWithWindow(camera.camera, inMedium(camera.camera->window(), medium));
        camera.windowStd.outerIndex = medium.std;
    }
    const RigModel rig = modelOf(result);
    if (calibration.covariance.empty() && !(medium.std > 0.))
        return result;
    const int count = columnCount(rig);
    result.covariance = Mat(count, count, CV_64F, Scalar(0));
    if (!calibration.covariance.empty())
        calibration.covariance.copyTo(result.covariance);
    const std::vector<int> columns = columnsOfMedium(rig);
    setVariance(result.covariance, columns, medium.std);
    if (!result.provenance.sources.empty())
        setSource(result.provenance.sources, columns, count, medium);
    return result;
}

void ConditionsOptions::addTo(OptionParser& parser)
{
    Option index = parser.add("--outer-index", index_, "index of the scene's medium now, or its name, as seawater:T=8,S=35 "
                              "(default: that of the calibration)");
    parser.add("--outer-index-std", std_, "how well it is known, one standard deviation (default: 0.001; of a name, its tolerance and "
               "the light's band)").check(notNegative()).needs(index);
}

Medium ConditionsOptions::of(const Calibration& calibration) const
{
    const double wavelength = calibration.cameras[0].camera->window().wavelength;
    Medium medium;
    medium.index = readIndex(index_, lightOf(calibration.channel, wavelength), "--outer-index");
    const double LARGEST = 4.;
    if (!(medium.index.value >= 1. && medium.index.value <= LARGEST))
        throw Failure("--outer-index=" + index_ + format(": give an index from 1 to %g, or the name of a medium", LARGEST));
    medium.std = std_ < 0. ? usualStdOf(medium.index) : Std(std_);
    return medium;
}

Calibration ConditionsOptions::appliedTo(const Calibration& calibration, const std::string& filename) const
{
    return isSaid() ? inMedium(calibration, of(calibration), filename) : calibration;
}

std::string ConditionsOptions::notice(const Calibration& calibration) const
{
    if (!isSaid())
        return "";
    const Medium medium = of(calibration);
    return "scene's medium: " + (medium.index.isNamed() ? medium.index.name + ", " : std::string())
        + format("index %.5f +- %.2g; calibrated in %.5f", medium.index.value, medium.std.value,
                 calibration.cameras[0].camera->window().outerIndex);
}

} // namespace tools
