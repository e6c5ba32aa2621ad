// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_RIG_DATA_HPP
#define REFRACT_TOOLS_RIG_DATA_HPP

#include "target/detected_views.hpp"
#include <array>
#include <optional>

namespace CLI { class App; }

/* Which images belong together: what the cameras saw of a target at each of its poses. */
namespace tools {

const int MAX_CAMERAS = 16;
const int POINTS_OF_POSE = 4;           // a view of fewer has none

//! Something of each camera; empty for one that is not there.
template <typename T> using PerCamera = std::array<T, MAX_CAMERAS>;

//! "" for the first camera, then "2", "3", ...: what follows the names of options and keys.
inline std::string cameraSuffix(int camera) { return camera ? std::to_string(camera + 1) : ""; }

//! Where the images of the cameras are, without and through the window; empty: there are none.
struct RigSources
{
    PerCamera<std::string> direct, glass;
    Channel channel = BRIGHTNESS;               //!< of colour images, in which the target is looked for

    //! --direct, --glass, --direct2, --glass2, ... --glass16; the first is required.
    void addTo(CLI::App& app, const std::string& aboutGlass, const std::string& aboutDirect);
    std::vector<std::string> all() const;       //!< that are given
    int cameraCount() const;                    //!< the last that has any
    bool anyDirect() const;
};

//! What was found in them; no views: there are none.
struct RigViewSets
{
    PerCamera<ViewSet> direct, glass;

    std::vector<const ViewSet*> all() const;        //!< direct and glass of camera 1, of camera 2, ...
};

//! readViews of each source; imageSize[c]: of each camera.
RigViewSets readViewSets(const RigSources& sources, const Target* target, const PerCamera<cv::Size>& imageSize, bool quiet);

//! A pose that is known from outside: object -> camera 1.
struct KnownPose
{
    cv::Vec3d rvec, tvec;
    cv::Mat covariance;         //!< 6x6 of (rvec, tvec); empty: exact
};

//! One pose of the target, and what each camera saw of it. An empty array: no image, or the target was not found.
struct Moment
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
    std::vector<Moment> moments;
    PerCamera<cv::Size> imageSize;

    int countPairs(int camera) const;
    int countPairs() const;                     //!< of all cameras
};

/** The order in which cameras can be placed, each beside one that is placed already, from camera 1: (from, to), the most moments in
common first.
@param throughOnly only images through the window count
Throws Failure if some cannot be. */
std::vector<std::pair<int, int>> cameraLinks(const RigData& data, bool throughOnly);

//! 0, 1, 2, ...
std::vector<int> allMoments(const RigData& data);

/** Sorts views into moments. Equal stems are one moment; with `unpaired` a direct and a glass image never are, while
the two cameras of a rig still are. Points are renumbered where the target's symmetry makes two images of a moment
disagree; points with coordinates of their own (points.csv) are one if these are equal. There are as many cameras as the last
with views through the window says.
@param target null: all points have coordinates of their own
@param fewest points of a view that counts */
RigData pairViews(const Target* target, const RigViewSets& sets, bool unpaired, int fewest = POINTS_OF_POSE);

} // namespace tools

#endif // REFRACT_TOOLS_RIG_DATA_HPP
