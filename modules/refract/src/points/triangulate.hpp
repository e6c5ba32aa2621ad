// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#ifndef OPENCV_REFRACT_TRIANGULATE_HPP
#define OPENCV_REFRACT_TRIANGULATE_HPP

#include "points/pixel_block.hpp"

namespace cv { namespace refract {

//! Two cameras, X2 = R X1 + T.
struct StereoPair
{
    StereoPair(const Camera& c1, const Camera& c2, InputArray R_, InputArray T_)
        : camera1(c1), camera2(c2), R(readRotation(R_, "R")), T(readVec3(T_, "T")) {}
    PlacedCameras cameras() const { return { PlacedCamera(camera1, RigidTransform()), PlacedCamera(camera2, { R, T }) }; }
    const Camera& camera1;
    const Camera& camera2;
    const Matx33d R;
    const Vec3d T;
};

//! pixels -> x, y, z, where status is REFRACT_OK; flags: TriangulateFlags.
void triangulateBlock(const PlacedCameras& cameras, PixelBlock& block, int n, int flags);

/** The most likely points, from near ones in x, y, z.
@param off pixels by which the images of these points are off, at most, if vectors shall do it
@param enough a step that moves the images by less, in pixels, is the last; 0: to the accuracy of double */
void refineBlock(const PlacedCameras& cameras, PixelBlock& block, int n, double off, double enough);

//! Covariance of a maximum-likelihood point.
class PointCovariance
{
public:
    //! calibration: empty, or as calibrateGlassRig returns it.
    PointCovariance(const PlacedCameras& cameras, InputArray calibration);
    /** @param block which cameras see point i
    @param pixels covariance of u1, v1, u2, v2, ..., by rows
    @param covariance 3x3 by rows; NaN where a camera that sees the point should not */
    void evaluate(const PixelBlock& block, int i, const double* pixels, double* covariance) const;

private:
    struct Calibration;
    const PlacedCameras& cameras_;
    Ptr<Calibration> calibration_;
};

//! Throws unless it is finite and not negative.
void checkSigma(double sigma, const char* name);

}} // namespace

#endif // OPENCV_REFRACT_TRIANGULATE_HPP
