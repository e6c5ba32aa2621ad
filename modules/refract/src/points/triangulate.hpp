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
@param off pixels by which the images of each point are off, at most, if vectors shall do it; 0: it is there
@param enough a step that moves the images by less, in pixels, is the last; 0: to the accuracy of double */
void refineBlock(const PlacedCameras& cameras, PixelBlock& block, int n, const double* off, double enough);

//! Covariances of maximum-likelihood points, a block at a time.
class PointCovariance
{
public:
    //! calibration: empty, or as calibrateGlassRig returns it.
    PointCovariance(const PlacedCameras& cameras, InputArray calibration);
    /** @param block points, and which cameras see them
    @param variance of each pixel coordinate
    @param pixels what it is more: 2x2 covariances of the last camera's pixels; may be null
    @param covariance 3x3 by rows of each point; NaN where it has no answer, or where a camera that sees the point should not */
    void evaluate(const PixelBlock& block, int n, double variance, const Columns& pixels, Matx33d* covariance) const;

private:
    struct Block;
    void differentiate(const PixelBlock& block, int n, Block& work) const;
    void carry(int n, Block& work) const;

    //! The uncertain parameters of one camera: its own, then its rotation vector and translation.
    struct Parameters
    {
        int count;                      //!< all of them
        int lensAndWindow;              //!< of these, the camera's own
        std::vector<int> uncertain;     //!< columns with a variance
        std::vector<int> index;         //!< of the uncertain ones in the calibration's covariance
        Matx33d dR[3];                  //!< by the rotation vector
    };
    const PlacedCameras& cameras_;
    std::vector<Parameters> parameters_;
    std::vector<std::vector<double> > covariance_;      //!< of each pair of cameras (a, b <= a), see carryCovariance; empty: exact
};

/** How far the images of the points are from the pixels that were given, row by row of each point, a column a camera; NaN where
there is no point, or the camera does not see it. */
void reprojectionErrors(const PlacedCameras& cameras, const PixelBlock& block, int n, double* errors);

//! Throws unless it is finite and not negative.
void checkSigma(double sigma, const char* name);

}} // namespace

#endif // OPENCV_REFRACT_TRIANGULATE_HPP
