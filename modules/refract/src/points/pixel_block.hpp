// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#ifndef OPENCV_REFRACT_PIXEL_BLOCK_HPP
#define OPENCV_REFRACT_PIXEL_BLOCK_HPP

#include "arrays/extrinsics.hpp"
#include "arrays/whitening.hpp"
#include "camera/camera.hpp"

/* What cameras of a rig see of points: a block of them on its way from pixels to points, and one of them in all images. */

namespace cv { namespace refract {

//! A camera of a rig and where it is.
struct PlacedCamera
{
    PlacedCamera(const Camera& c, const RigidTransform& p) : camera(&c), place(p) {}
    const Camera* camera;
    RigidTransform place;
};
typedef std::vector<PlacedCamera> PlacedCameras;    //!< the first is in its own frame

//! A block of points on their way from their pixels in all images to the frame of camera 1.
struct PixelBlock
{
    explicit PixelBlock(int cameras) : sees((size_t)cameras), hasHalves((size_t)cameras), pixels_((size_t)2*cameras*BLOCK)
    {
        std::fill(sees.data(), sees.data() + cameras, (uchar)ALL);
        std::fill(hasHalves.data(), hasHalves.data() + cameras, (uchar)false);
    }
    //! u1, v1, u2, v2, ...
    double* pixel(int k) { return pixels_.data() + k*BLOCK; }
    const double* pixel(int k) const { return pixels_.data() + k*BLOCK; }
    bool isSeen(int camera, int i) const { return !std::isnan(pixel(2*camera)[i]) || !std::isnan(pixel(2*camera + 1)[i]); }
    bool isHalf(int camera, int i) const { return std::isnan(pixel(2*camera)[i]) != std::isnan(pixel(2*camera + 1)[i]); }
    //! Whether some camera sees half of the point.
    bool hasHalf(int i) const
    {
        for (size_t c = 0; c < hasHalves.size(); c++)
            if (hasHalves[c] && isHalf((int)c, i))
                return true;
        return false;
    }
    Point2d pixelOf(int camera, int i) const { return Point2d(pixel(2*camera)[i], pixel(2*camera + 1)[i]); }

    enum Sees { NONE, SOME, ALL };
    AutoBuffer<uchar, 16> sees;         //!< of each camera: which of the points; SOME: pixels of the others are NaN
    AutoBuffer<uchar, 16> hasHalves;    //!< of each camera: one coordinate of some pixels is NaN
    //! Of each camera and point, if covariances were given; halves have rows of 0. W of each point has a scale of its own, so that
    //! its largest row is about 1.
    std::vector<Whitening> whitening;
    std::vector<double> scale;          //!< of each point: this times the pixels' standard deviation has been divided out
    const Whitening& whiteningOf(int camera, int i) const { return whitening[(size_t)camera*BLOCK + i]; }
    double x[BLOCK], y[BLOCK], z[BLOCK];
    uchar status[BLOCK];
private:
    AutoBuffer<double, 4*BLOCK> pixels_;
};

//! One point's pixels in all images: two rows a camera, 0 where the camera does not see it; whitened.
struct PointImages
{
    explicit PointImages(int cameras) : errors(2*cameras), byPoint(2*cameras) {}
    std::vector<double> errors;         //!< predicted - observed
    std::vector<Vec3d> byPoint;         //!< of the predicted pixels, in the frame of camera 1
};

//! Where X would be seen by the cameras that see point i; the first reason why one cannot.
uchar projectIntoAll(const PlacedCameras& cameras, const PixelBlock& block, int i, const Vec3d& X, PointImages& images);

//! A point that is not beyond the windows of all cameras that see it gets a status that says so.
void checkBeyond(const PlacedCameras& cameras, PixelBlock& block, int n);

/** Lets a camera compute a block, but for the points that it does not see: they count as failed already, so that nobody looks
for the reason, and keep their status. */
template<typename Compute>
void forSeen(const PixelBlock& block, int camera, int n, uchar* status, const Compute& compute)
{
    if (block.sees[camera] == PixelBlock::ALL)
        return compute(status);
    uchar own[BLOCK];
    for (int i = 0; i < n; i++)
        own[i] = block.isSeen(camera, i) ? status[i] : (uchar)REFRACT_TOO_FEW_VIEWS;
    compute(own);
    for (int i = 0; i < n; i++)
        if (block.isSeen(camera, i))
            status[i] = own[i];
}

}} // namespace

#endif // OPENCV_REFRACT_PIXEL_BLOCK_HPP
