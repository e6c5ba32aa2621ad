// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_RIG_DATA_HPP
#define REFRACT_TOOLS_RIG_DATA_HPP

#include "pose/near_origin.hpp"
#include "target/detected_images.hpp"
#include <array>
#include <optional>

/* Which images belong together: the observations of a target at each of its poses by all cameras. */
namespace tools {

class OptionParser;

/** Pairs that a calibration needs: of the bundled rig, four state the normal within 13 % and the worst point within 5 % of what five do,
and leave two for each half of the range, which tests the other. README.md, --help and doc/ ask for as many (a test reads them). */
const int ENOUGH_PAIRS = 4;

const int MAX_CAMERAS = 16;
const int MIN_POSE_POINTS = 4;          // an image with fewer has no pose

//! One value for each camera; empty for cameras that the rig does not have.
template <typename T> using PerCamera = std::array<T, MAX_CAMERAS>;

//! "" for the first camera, then "2", "3", ...: what follows the names of options and keys.
inline std::string cameraSuffix(int camera) { return camera ? std::to_string(camera + 1) : ""; }

//! " of camera 2"; nothing where there is one, or where no camera is meant (negative).
inline std::string ofCamera(int camera, int cameras)
{
    return cameras > 1 && camera >= 0 ? " of camera " + std::to_string(camera + 1) : "";
}

//! The image files of each camera, direct and through the window; empty: none.
struct RigSources
{
    PerCamera<std::string> direct, glass;
    Channel channel = BRIGHTNESS;               //!< of colour images, in which the target is looked for
    std::string viewPattern;                    //!< what names say of the moment, see momentOf(); empty: what takeOffCameras() finds
    std::string yFrom;                          //!< of tables of points that leave it open, see PixelOrigin

    //! --direct and --glass, which is required, for each camera; --view-pattern.
    void addTo(OptionParser& parser, const std::string& aboutGlass, const std::string& aboutDirect);
    std::vector<std::string> all() const;       //!< that are given
    int cameraCount() const;                    //!< the last that has any
    bool anyDirect() const;
};

//! What was found in them; no images: there are none.
struct RigImages
{
    PerCamera<DetectedImages> direct, glass;

    std::vector<const DetectedImages*> all() const; //!< direct and glass of camera 1, of camera 2, ...
    void nameSingles();                             //!< one image for each camera: they are one view, whatever their names
};

//! readDetectedImages of each source; imageSize[c]: of each camera.
RigImages readRigImages(const RigSources& sources, const Target* target, const PerCamera<cv::Size>& imageSize, bool quiet);

//! A pose that is known from outside: object -> camera 1.
struct KnownPose
{
    cv::Vec3d rvec, tvec;
    cv::Mat covariance;         //!< 6x6 of (rvec, tvec); empty: exact
};

//! One pose of the target, and its images in all cameras. An empty array: no image, or the target was not found.
struct View
{
    std::string stem;
    std::vector<cv::Point3d> objectPoints;              //!< of the target
    std::vector<std::pair<int, int>> neighbours;        //!< points next to each other, as Target::neighbours()
    PerCamera<std::vector<cv::Point2d>> direct, glass;  //!< where it was seen, NaN where a point was not
    std::optional<KnownPose> pose;

    bool hasDirect(int camera) const { return !direct[camera].empty(); }
    bool hasGlass(int camera) const { return !glass[camera].empty(); }
    int countDirect() const;                            //!< cameras
    int countGlass() const;
    bool hasGlass() const { return countGlass() > 0; }
    bool isPair(int camera) const { return hasDirect(camera) && hasGlass(camera); }
};

struct RigData
{
    int cameraCount = 1;
    std::vector<View> views;
    cv::refract::NearOrigin origin;             //!< of points.csv, if that is far from its points: those of the views are moved
    PerCamera<cv::Size> imageSize;

    int countPairs(int camera) const;
    int countPairs() const;                     //!< of all cameras
    bool hasDirect() const;                     //!< any camera; a sealed housing has none
};

/** The order in which the extrinsics of the cameras can be found, from camera 1 on: (known, new), the pair with most views in common
first.
@param throughOnly only images through the window count
Throws Failure if a camera has no view in common with the others. */
std::vector<std::pair<int, int>> cameraLinks(const RigData& data, bool throughOnly);

//! 0, 1, 2, ...
std::vector<int> allViews(const RigData& data);

/** Groups images into views. Images with the same stem are one view. With `unpaired` a direct and a glass image never are one
view, but the images of several cameras still are. Points are renumbered if the target's symmetry makes two images of a view
disagree. Points with coordinates of their own (points.csv) are the same point if these are equal. The last camera with images
through the window gives the number of cameras.
@param target null: all points have coordinates of their own
@param fewest points that an image must show */
RigData groupIntoViews(const Target* target, const RigImages& sets, bool unpaired, int fewest = MIN_POSE_POINTS);

/* Whether the images are what they are meant to be, before anything is fitted to them. */

/** Direct and glass images belong together by their names. Throws Failure if both are there and no name is common, or if the
target was found in both images of no pair: the user meant pairs, and a calibration without them is far worse. */
void requirePairs(const RigImages& sets);

//! The same as far as the names of images tell, before any is searched for the target.
void requirePairNames(const RigSources& sources);

//! What spoils a calibration without showing in its residuals: one image under two names, boards that are all parallel.
std::vector<std::string> noticesOf(const RigImages& sets, const RigData& data);

} // namespace tools

#endif // REFRACT_TOOLS_RIG_DATA_HPP
