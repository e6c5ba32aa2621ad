// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "calibrate/given_places.hpp"
#include "file_harness.hpp"

// Markers on a window, and the plane through them: it may be refused, but what is taken is a window before the camera, and how well it is
// known is a covariance.

const char fuzz::EXTENSION[] = ".csv";

void fuzz::tryFile(const std::string& path)
{
    for (const double std : {0., 0.5})
        try
        {
            const tools::GivenPlace place = tools::placeOfMarkers(tools::readPaneMarkers(path, std), path);
            promise(std::abs(cv::norm(place.normal) - 1) < 1e-9 && place.normal[2] > 0, "the normal is a unit vector, from the camera");
            promise(place.distance > 0 && std::isfinite(place.distance), "the window is before the camera");
            promise(cv::checkRange(cv::Mat(place.covariance)), "the covariance is finite");
            promise(place.normalStd() > 0 && place.distanceStd() > 0, "what is measured has an error");
        }
        catch (const tools::Failure&)       // or with the other standard deviation
        {
        }
}
