// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#ifndef OPENCV_REFRACT_EPIPOLAR_DISTANCE_HPP
#define OPENCV_REFRACT_EPIPOLAR_DISTANCE_HPP

#include "arrays/arrays.hpp"
#include "camera/camera.hpp"
#include "points/point_kernels.hpp"

namespace cv { namespace refract {

//! z of the scene, in the frame of the camera whose pixels have curves.
struct DepthRange
{
    double near, far;           //!< far may be infinity
    bool isLimited() const { return near > 0 || far < DBL_MAX; }
};

//! A block of matches on its way to distances. Pixels of one are u, then v, of BLOCK each.
struct Matches
{
    double ofCurve[2*BLOCK], other[2*BLOCK];
    uchar status[BLOCK];
    double distance[BLOCK];     //!< of the other's pixel from the curve
    double depth[BLOCK];        //!< z of the nearest point, in the frame of the curves' camera
    double jacobian[10*BLOCK];  //!< by the curve's pixel (2), the other (2), the rotation vector (3), the translation (3)
    //! The nearest point is where visibility ends. How that moves is not known: the derivatives are those of a constant depth.
    uchar isCut[BLOCK];
};

//! Distances of pixels of one camera from the curves of pixels of another.
class EpipolarDistance
{
public:
    /** R, T map camera 1 -> camera 2.
    @param whichImage has the curves' pixels, 1 or 2 */
    EpipolarDistance(const Camera& camera1, const Camera& camera2, const Matx33d& R, const Vec3d& T, int whichImage,
                     const DepthRange& range);

    //! The pixels' distances, depths and, if they are wanted, derivatives, where status is REFRACT_OK.
    void evaluate(Matches& block, int n, bool derivatives) const;

private:
    struct Search;
    void start(const Matches& block, Search& search, int n, uchar* status) const;
    void run(Search& search, int n, int rounds, double enough, uchar* arrived) const;
    uchar refineFromSamples(Search& search, int lane) const;
    void differentiate(Matches& block, const Search& search, int n) const;

    const Camera& curves_;      //!< the camera whose pixels have curves
    const Camera& other_;
    CurveFrame frame_;
    CurveMotion motion_;
};

}} // namespace

#endif // OPENCV_REFRACT_EPIPOLAR_DISTANCE_HPP
