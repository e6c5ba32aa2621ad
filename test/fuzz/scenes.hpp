// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_FUZZ_SCENES_HPP
#define REFRACT_FUZZ_SCENES_HPP

#include "arguments.hpp"

/* Observations of a small target, for the calls that look for poses, windows and lenses: of a scene that there could be, now and
then with a number, an image or an array that there could not. */
namespace fuzz {

typedef std::vector<std::vector<cv::Point2d>> Views;        //!< the points that one camera saw, view by view

struct Scene
{
    explicit Scene(Bytes& bytes, int cameraCount = 1);

    std::vector<std::vector<cv::Point3d>> objectPoints;
    std::vector<cv::Ptr<cv::refract::RefractiveCamera>> cameras;
    std::vector<cv::Mat> Rs, Ts;                            //!< camera 1 -> camera
    std::vector<cv::Mat> rvecs, tvecs;
    std::vector<Views> direct, refracted;                   //!< of each camera
};

//! A change of the arrays that a caller may make by mistake: a view too many or too few, a point missing, NaN, another type.
std::vector<cv::Mat> arraysOf(Bytes& bytes, const Views& views);
std::vector<cv::Mat> arraysOf(Bytes& bytes, const std::vector<std::vector<cv::Point3d>>& views);
int flagsOf(Bytes& bytes);
cv::TermCriteria criteriaOf(Bytes& bytes);

} // namespace fuzz

#endif // REFRACT_FUZZ_SCENES_HPP
