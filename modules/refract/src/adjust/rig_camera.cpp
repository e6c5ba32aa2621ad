// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#include "adjust/rig_camera.hpp"
#include "window/place.hpp"

namespace cv { namespace refract {

Camera withWindow(const Camera& camera, const GlassWindow& window)
{
    Camera other(camera);
    other.setWindow(window);
    return other;
}

RigCamera::RigCamera(const Camera& camera)
    : behindWindow_(camera), bare_(withWindow(camera)), isLensPossible_(true), isWindowPossible_(true) {}

void RigCamera::set(const Parameters& parameters)
{
    extrinsics = TransformWithDerivatives(parameters.extrinsics);
    window.reset();
    if (!parameters.ownsWindow)
        window.reset(new TransferredWindow(at(), ofOwner(parameters).data(),
                                           TransformWithDerivatives(parameters.ownerExtrinsics), extrinsics));
    // A trial step may leave the domain of the focal lengths, or of the window.
    isLensPossible_ = parameters.lens[0] > 0 && parameters.lens[1] > 0;
    isWindowPossible_ = isLensPossible_ && setWindow(parameters);
    if (isLensPossible_)
        bare_.setLensParameters(Mat(1, lensCount(), CV_64F, const_cast<double*>(parameters.lens)));
}

//! The window's parameters in the frame of its owner.
std::vector<double> RigCamera::ofOwner(const Parameters& parameters) const
{
    std::vector<double> all(at().count);
    std::copy(parameters.place, parameters.place + placeCount(), all.begin() + at().normal);
    std::copy(parameters.media, parameters.media + mediaCount(), all.begin() + at().media);
    return all;
}

bool RigCamera::setWindow(const Parameters& parameters)
{
    // With equal media the distance has no effect, or with a wedge hardly any: another camera's need not be known well enough to be
    // positive here.
    if (window && !hasCenter(at().shape) && window->parameters[at().innerIndex] == window->parameters[at().outerIndex] &&
        window->parameters[at().distance] < 0)
        window->hold(at().distance, 0);
    const std::vector<double> p = window ? window->parameters : ofOwner(parameters);
    if (!isPossible(at(), p.data()))
        return false;
    std::vector<double> all(parameters.lens, parameters.lens + lensCount());
    all.insert(all.end(), p.begin(), p.end());
    behindWindow_.setParameters(all);
    return true;
}

const Camera* RigCamera::camera(bool refracted) const
{
    return refracted ? (isWindowPossible_ ? &behindWindow_ : nullptr) : (isLensPossible_ ? &bare_ : nullptr);
}

}} // namespace
