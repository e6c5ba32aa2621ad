// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_MISSING_TARGET_HPP
#define REFRACT_TOOLS_MISSING_TARGET_HPP

#include "console/images.hpp"
#include "target/target.hpp"

/* What images show in place of the target that was asked for. */
namespace tools {

//! An image in which the target was not found.
struct Without
{
    std::string path;
    cv::Size chessboard;        //!< the largest that is seen in it, the longer side first; empty: none
};

//! As Target::detect(); a Failure names the image.
std::vector<cv::Point2d> detectIn(const cv::Mat& grey, const std::string& path, const Target& target, cv::Size* other = nullptr,
                                  Target::Effort effort = Target::THOROUGH);

//! The size of the chessboard that all these images show in place of the one that was asked for; empty if they do not agree.
cv::Size otherChessboard(const std::vector<Without>& images);

/** One sentence that says why the target is not found and what to do: a chessboard of another size, a part of the board in view, a target
of another kind, or nothing at all.
@param where the glob, in quotes
@param images that were looked at; all: how many there are */
std::string explainMissing(const std::vector<Without>& images, const std::string& where, size_t all, const Target& target, Channel channel);

//! "the chessboard in WHERE looks like one of 9x6 inner corners, not --size=10x7: ..."
std::string otherTargetText(const std::string& where, const Target& target, cv::Size other);

} // namespace tools

#endif // REFRACT_TOOLS_MISSING_TARGET_HPP
