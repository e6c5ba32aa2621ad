// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_TARGET_SEARCH_HPP
#define REFRACT_TOOLS_TARGET_SEARCH_HPP

#include "console/images.hpp"
#include "console/progress.hpp"
#include "target/target.hpp"

namespace tools {

/* What images show in place of the target that was asked for. */

struct ImageWithoutTarget
{
    std::string path;
    cv::Size chessboard;        //!< the largest that is seen in it, the longer side first; empty: none
};

//! As Target::detect(); a Failure names the image.
std::vector<cv::Point2d> detectIn(const cv::Mat& grey, const std::string& path, const Target& target, cv::Size* other = nullptr);

/** One sentence that says why the target is not found and what to do: a chessboard of another size, a part of the board in view, a target
of another kind, or nothing at all.
@param where the glob, in quotes
@param images that were looked at; all: how many there are */
std::string explainMissing(const std::vector<ImageWithoutTarget>& images, const std::string& where, size_t all, const Target& target,
                           Channel channel);

//! "the chessboard in WHERE looks like one of 9x6 inner corners, not --size=10x7: ..."
std::string otherTargetText(const std::string& where, const Target& target, cv::Size other);

/* The search for a target in the images of one camera. Where it fails it fails slowly, as every detector tries all that it can; so a few
images come first, and if none of them shows the target, it is refused with what they show instead. Images are searched in parallel; what
is found, and what is said, does not depend on the order. */
class TargetSearch
{
public:
    //! @param source as the user gave it, for texts
    TargetSearch(const std::string& source, const std::vector<std::string>& paths, const Target& target, Channel channel);

    //! A few images: throws Failure if they tell that there is no target in any.
    void begin(Progress& progress);

    //! All others. Returns the pixels of each image, see Target::detect; throws Failure if all are empty.
    std::vector<std::vector<cv::Point2d>> finish(Progress& progress);

private:
    struct Result
    {
        std::vector<cv::Point2d> points;
        cv::Size other;             //!< see Target::detect
        bool done = false;
    };

    void search(const std::vector<int>& which, Progress& progress);
    //! Whether one of these is worth while to be searched.
    bool isLikelyInAny(const std::vector<int>& which, Progress& progress);
    void lookForOthers(const std::vector<int>& which);
    [[noreturn]] void refuse(const std::vector<int>& which) const;

    std::string source_;
    const std::vector<std::string>& paths_;
    const Target& target_;
    Channel channel_;
    std::vector<Result> results_;
};

} // namespace tools

#endif // REFRACT_TOOLS_TARGET_SEARCH_HPP
