// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#ifndef OPENCV_REFRACT_BUNDLE_IMAGES_HPP
#define OPENCV_REFRACT_BUNDLE_IMAGES_HPP

#include "adjust/problem.hpp"

namespace cv { namespace refract {

//! What a bundle adjustment is given of pixels, in either form.
struct BundleImages
{
    std::vector<SceneImage> images;     //!< view by view, in each by camera; none is empty
    int cameras = 0, views = 0, points = 0;
    //! Of each image, of each of its points: its index in the list; in the dense form none.
    std::vector<std::vector<int> > places;
    int listed = 0;                     //!< length of the list
    double variance = 1;                //!< the median of all pixels' coordinates, as RigViews has it

    //! Which views show something, and which cameras.
    std::vector<bool> seenViews() const;
    std::vector<bool> seeingCameras() const;
};

/** The dense form: per camera, per view.
@param points of the scene; 0: as many as the images say
@param covariances of the pixels, or nothing */
BundleImages denseImages(const std::vector<PixelViews>& pixels, int cameras, int points,
                         const std::vector<std::vector<Mat> >& covariances);

/** The list: rows of view, camera, point, with a pixel each.
@param views that there are; 0: as many as the list says. @param points likewise */
BundleImages listedImages(InputArray observations, InputArray imagePoints, int cameras, int views, int points, InputArray covariances);

//! Per view, per camera, or one mask for the list, as the images were given. @param isUsed per image, per point of it
std::vector<Mat> denseMasks(const BundleImages& images, const Masks& isUsed);
Mat listedMask(const BundleImages& images, const Masks& isUsed);

}} // namespace

#endif // OPENCV_REFRACT_BUNDLE_IMAGES_HPP
