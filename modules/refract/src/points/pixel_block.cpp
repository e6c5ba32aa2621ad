// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#include "points/pixel_block.hpp"

namespace cv { namespace refract {

uchar projectIntoAll(const PlacedCameras& cameras, const PixelBlock& block, int i, const Vec3d& X, PointImages& images)
{
    std::fill(images.errors.begin(), images.errors.end(), 0);
    std::fill(images.byPoint.begin(), images.byPoint.end(), Vec3d());
    for (int c = 0; c < (int)cameras.size(); c++)
    {
        if (!block.isSeen(c, i))
            continue;
        Vec2d pixel;
        Matx23d J;
        const uchar status = cameras[c].camera->projectJacobian(cameras[c].place.apply(X), pixel, J.val, NULL);
        if (status != REFRACT_OK)
            return status;
        J = J*cameras[c].place.R;
        for (int k = 0; k < 2; k++)
        {
            const bool isKnown = !std::isnan(block.pixel(2*c + k)[i]);
            images.errors[2*c + k] = isKnown ? pixel[k] - block.pixel(2*c + k)[i] : 0;
            images.byPoint[2*c + k] = isKnown ? Vec3d(J.val + 3*k) : Vec3d();
        }
        if (block.whitening.empty())
            continue;
        const Whitening& W = block.whiteningOf(c, i);
        W.apply(images.errors[2*c], images.errors[2*c + 1]);
        for (int k = 0; k < 3; k++)
            W.apply(images.byPoint[2*c][k], images.byPoint[2*c + 1][k]);
    }
    return REFRACT_OK;
}

void checkBeyond(const PlacedCameras& cameras, PixelBlock& block, int n)
{
    for (int c = 0; c < (int)cameras.size(); c++)
    {
        const Layers& layers = cameras[c].camera->layers();
        const RigidTransform& place = cameras[c].place;
        const Surface last = inFrame(layers.lastSurface(), place.R.val, place.t.val);       // the frame of camera 1
        for (int i = 0; i < n && layers.refracts(); i++)
        {
            if (isBeyond(last, block.x[i], block.y[i], block.z[i], 1.) || block.status[i] != REFRACT_OK || !block.isSeen(c, i))
                continue;
            const Vec3d X = place.R*Vec3d(block.x[i], block.y[i], block.z[i]) + place.t;
            if (!(last.curvature < 0) || !layers.isBeyond(X[0], X[1], X[2]))
                block.status[i] = REFRACT_BEHIND_WINDOW;
        }
    }
}

}} // namespace
