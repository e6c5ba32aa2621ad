// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_GIVEN_NORMALS_HPP
#define REFRACT_TOOLS_GIVEN_NORMALS_HPP

#include <opencv2/core.hpp>
#include <string>
#include <vector>

namespace tools {

class OptionParser;

//! --normal and --normal-std: what is known of the normals of flat windows.
class GivenNormals
{
public:
    void addTo(OptionParser& parser);
    bool isSaid() const { return !texts_.empty(); }
    double std() const { return stdDeg_*CV_PI/180.; }       //!< radians, about each of two axes
    //! Of length 1, in each camera's frame: one for all or one for each; empty: not said. Throws Failure. @param isShared one window
    std::vector<cv::Vec3d> of(int cameras, bool isShared) const;

private:
    std::vector<std::string> texts_;
    double stdDeg_ = 0.;
};

} // namespace tools

#endif // REFRACT_TOOLS_GIVEN_NORMALS_HPP
