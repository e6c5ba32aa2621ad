// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#ifndef OPENCV_REFRACT_VIRTUAL_CENTRES_HPP
#define OPENCV_REFRACT_VIRTUAL_CENTRES_HPP

#include "points/triangulate.hpp"

namespace cv { namespace refract {

/* All rays of a camera meet the axis of its window, C + tau n, each at a tau of its own (behind faces that are not parallel, nearly
so). A pinhole at one well chosen tau, its virtual centre, that shows one plane exactly, shows what lies before and behind it nearly
so: a pair of such pinholes is rectified to first order in all that varies with depth. */

//! A pair of pinholes at virtual centres, turned so that one's rows (or columns) are the other's.
struct VirtualPair
{
    VirtualPair(const StereoPair& pair, const Vec2d& tau);
    Matx33d R1, R2;         //!< camera -> rectified
    int axis;               //!< along which disparity is: 0 x, 1 y
    Vec3d centre1, centre2; //!< rectified frame, whose origin is the centre of projection of camera 1
};

//! What the two cameras see of points all over their common view, from near to far.
class RowSamples
{
public:
    //! depthRange: z in the frame of camera 1; throws if no point of it is seen by both.
    RowSamples(const StereoPair& pair, Size imageSize, const Vec2d& depthRange);

    /** Differences of the points' rows (columns) in the images of the pinholes that show the plane z = depth of the rectified
    frame, at focal length 1; NaN where a pinhole does not see one. */
    std::vector<double> differences(const VirtualPair& virtualPair, double depth) const;

private:
    const StereoPair& pair_;
    struct Ray { Vec3d origin, direction; };
    std::vector<Ray> rays1_, rays2_;    //!< each in the frame of its camera
};

//! Tau of a ray along the window's normal.
double paraxialTau(const Camera& camera);

//! By which the image grows, straight through the window: a flat one in water, by the index.
double paraxialMagnification(const Camera& camera);

/** Least and largest tau of a virtual centre: where four in five rays of the image meet the axis of the window, and as far again.
The image is taken to be twice as large as the principal point is far from the first pixel. */
Vec2d virtualCentreRange(const Camera& camera);

/** Taus in these ranges of the centres by which the rows differ least. Where several do alike, as behind a shared window, the ones
nearest to those of rays along the normals. */
Vec2d bestVirtualCentres(const StereoPair& pair, const RowSamples& samples, double depth);

}} // namespace

#endif // OPENCV_REFRACT_VIRTUAL_CENTRES_HPP
