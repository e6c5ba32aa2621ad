// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "calibrate/fit_error.hpp"

using namespace cv;
using namespace cv::refract;

namespace tools {

namespace {

std::string textOf(const CalibrationError& e, const RigData& data, const std::vector<int>& views)
{
    const View* const view = e.view < 0 ? nullptr : &data.views[views.at(e.view)];
    switch (e.cause)
    {
    case CalibrationError::NOT_CONVERGED:
        return (view ? "view '" + view->stem + "': " : std::string()) + e.reason;
    case CalibrationError::NO_POSE:
        return "view '" + view->stem + "': " + e.reason;
    case CalibrationError::NO_IMAGE:
    {
        const Point3d X = view->objectPoints.at(e.point) + Point3d(data.origin.origin());
        return cv::format("view '%s' of camera %d, point (%g, %g, %g): ", view->stem.c_str(), e.camera + 1, X.x, X.y, X.z) + e.reason +
            "; check --distance, --thickness, the lens, the units, and --poses if given";
    }
    case CalibrationError::WINDOW_NOT_SEEN:
        return "the --glass" + cameraSuffix(e.camera) + " images have no point that was seen";
    case CalibrationError::PAIRS_SWAPPED:
        return "the --direct images and the --glass images are swapped: " + e.reason + "; direct is what was seen without the window";
    case CalibrationError::PAIRS_CONTRADICT:
        return e.reason + ". The --direct image and the --glass image of a pair must show the same target that was not moved in "
            "between, its points in the same order; of a hand-held board say --unpaired";
    default:
        return e.err;
    }
}

} // namespace

CalibrationError inToolsWords(const CalibrationError& error, const RigData& data, const std::vector<int>& views)
{
    CalibrationError said = error;
    said.err = textOf(error, data, views);
    said.formatMessage();
    return said;
}

} // namespace tools
