#ifndef REFRACT_TOOLS_DETECTED_VIEWS_HPP
#define REFRACT_TOOLS_DETECTED_VIEWS_HPP

#include "console/images.hpp"
#include "target/target.hpp"

namespace tools {

//! One image in which the target was found.
struct DetectedView
{
    std::string stem;                   //!< file name without folder and extension: pairs views of one moment
    std::string path;
    std::vector<cv::Point2d> points;    //!< Target::count() pixels, NaN where a point was not seen
    int seenCount() const;
};

//! The views of one camera in one state (direct or through the window), in the order of their names.
struct ViewSet
{
    std::vector<DetectedView> views;
    std::vector<std::string> withoutTarget;     //!< paths of images in which the target was not found
    std::vector<std::string> files;             //!< that were read
    cv::Size imageSize;

    const DetectedView* find(const std::string& stem) const;    //!< null if there is none
};

/** Finds the target in all images of a glob, or reads an mrcal corners.vnl (recognised by its extension .vnl).
@param source glob ('data/direct-*.png') or file name.
@param imageSize needed for a .vnl, which does not say it; otherwise checked if not empty.
@param quiet no progress.
Throws Failure if there is no image, an image cannot be read, images differ in size, or no image shows the target. */
ViewSet readViews(const std::string& source, const Target& target, cv::Size imageSize, bool quiet);

//! "the chessboard in WHERE looks like one of 9x6 inner corners, not --size=10x7: ..."
std::string otherTargetText(const std::string& where, const Target& target, cv::Size other);

} // namespace tools

#endif // REFRACT_TOOLS_DETECTED_VIEWS_HPP
