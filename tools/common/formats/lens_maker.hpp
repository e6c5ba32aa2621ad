// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_LENS_MAKER_HPP
#define REFRACT_TOOLS_LENS_MAKER_HPP

#include "console/failure.hpp"
#include <opencv2/refract.hpp>
#include <string>
#include <vector>

namespace tools {

//! What `make` makes of a file's numbers; Failure "its WHAT cannot be one" where the module refuses them.
template<typename Make> auto possible(const std::string& what, const Make& make) -> decltype(make())
{
    try
    {
        return make();
    }
    catch (const cv::Exception& e)
    {
        throw Failure("its " + what + " cannot be one: " + e.err);
    }
}

/** A camera without a window. @param model "opencv" or "fisheye"
@param coefficients zeros may follow, where the model has fewer places
@param size 0x0 where the file does not say. Throws Failure. */
cv::Ptr<cv::refract::RefractiveCamera> makeCamera(const std::string& model, const cv::Matx33d& cameraMatrix,
                                                  std::vector<double> coefficients, const cv::Size& size);

//! Of an image. Throws Failure for one that cannot be.
cv::Size imageSizeOf(double width, double height);

//! fx, fy, cx, cy as a matrix.
inline cv::Matx33d cameraMatrixOf(double fx, double fy, double cx, double cy) { return {fx, 0, cx, 0, fy, cy, 0, 0, 1}; }

/** By COLMAP's name of a lens model, whose pixel (0, 0) is a corner. Throws Failure for a model that is not known here, and for one that
has no equal in OpenCV. @param name empty: by id */
cv::Ptr<cv::refract::RefractiveCamera> makeColmapCamera(const std::string& name, const std::vector<double>& parameters,
                                                        const cv::Size& size);

//! What COLMAP's binary files call a model by; empty: none. @param count of its parameters
std::string colmapModelName(int id, size_t& count);
bool isColmapModel(const std::string& name);

/** COLMAP's FLATPORT (normal, distance, thickness, indices of air, port and water) and DOMEPORT (centre, radius, the same), as its fork
for cameras under water and Calibmar have them. Throws Failure. */
cv::refract::GlassWindow makePort(const std::string& type, const std::vector<double>& parameters);

} // namespace tools

#endif // REFRACT_TOOLS_LENS_MAKER_HPP
