// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#ifndef OPENCV_REFRACT_RIG_CAMERA_HPP
#define OPENCV_REFRACT_RIG_CAMERA_HPP

#include "adjust/transferred_window.hpp"
#include "camera/camera.hpp"

namespace cv { namespace refract {

//! The same lens behind another window, or none.
Camera withWindow(const Camera& camera, const GlassWindow& window = GlassWindow());

/** One camera of the rig at one set of parameter values: what all its images share. */
class RigCamera
{
public:
    //! Lens model and number of layers.
    explicit RigCamera(const Camera& camera);

    //! What describes the camera. Extrinsics are null for camera 1.
    struct Parameters
    {
        const double* extrinsics;
        const double* lens;
        const double* place;                //!< in the owner's frame
        const double* media;                //!< the window's other parameters; the distance is the owner's
        const double* ownerExtrinsics;
        bool ownsWindow;
    };
    void set(const Parameters& parameters);

    int lensCount() const { return behindWindow_.lensCount(); }
    //! Of the window's parameters.
    const WindowLayout& at() const { return behindWindow_.layers().at(); }
    int placeCount() const { return at().media - at().normal; }
    int mediaCount() const { return at().count - at().media; }

    //! With its window, or the lens alone; null where the parameters are impossible.
    const Camera* camera(bool refracted) const;

    TransformWithDerivatives extrinsics;
    std::unique_ptr<TransferredWindow> window;       //!< null if it is the camera's own

private:
    std::vector<double> ofOwner(const Parameters& parameters) const;
    bool setWindow(const Parameters& parameters);
    Camera behindWindow_, bare_;
    bool isLensPossible_, isWindowPossible_;
};

}} // namespace

#endif // OPENCV_REFRACT_RIG_CAMERA_HPP
