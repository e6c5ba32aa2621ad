// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_IMAGE_DISAGREEMENT_HPP
#define REFRACT_TOOLS_IMAGE_DISAGREEMENT_HPP

#include "calibrate/rig_data.hpp"
#include "calibrate/rigid_transform.hpp"
#include "diagnose/calibration_input.hpp"
#include <string>
#include <unordered_map>

/* How far images contradict each other, px, whatever the window is: told without it, by pinholes, in milliseconds. */
namespace tools {

const double WINDOWS_PX = 20.;          //!< less is a window's doing
const double MOMENTS_PX = 4.*WINDOWS_PX;    //!< more is of boards that are not the same, if two cameras are pinholes without windows

//! Pinholes that are good enough to tell boards that are turned or elsewhere; zeros: there is none.
struct RoughLenses
{
    PerCamera<cv::Matx33d> direct, glass;
};

RoughLenses roughLensesOf(const RigData& data);

/** Of each camera, or of each but the first to the first; 0 where there is nothing to compare. What is compared is a kind: images that are
given to another camera take what they have along. */
struct Disagreements
{
    std::vector<double> pairs;              //!< how far the two images of a pair are apart
    std::vector<double> magnifications;     //!< how much images through the window are magnified otherwise than by it
    //! How far boards are from where one of them has this camera to the first: of images of one state, and of glass by direct ones.
    std::vector<double> direct, glass, states;

    std::vector<std::vector<double>> kinds() const { return {pairs, magnifications, direct, glass, states}; }
    double largest() const;
    //! The largest of two cameras in images of one state.
    double camerasApart() const;
};

//! Poses of boards before pinholes, found once: of hundreds of exchanges each leaves nearly all images as they were.
class BoardPoses
{
public:
    //! The best first; empty: there is none.
    const std::vector<RigidTransform>& of(const View& view, const std::vector<cv::Point2d>& pixels, const cv::Matx33d& K);

private:
    std::unordered_map<std::string, std::vector<RigidTransform>> known_;    // by the bytes of pinhole, pixels and board
};

Disagreements disagreementsOf(const RigData& data, const RigOptions& options, const RoughLenses& lenses, BoardPoses& poses);

//! The same where images or lenses of some cameras have changed. @param all of what was before
void update(const RigData& data, const RigOptions& options, const RoughLenses& lenses, const std::vector<int>& cameras, BoardPoses& poses,
            Disagreements& all);

/** Views in which the board is clearly elsewhere in a camera than where most images through the windows have this camera to the first,
whichever of the two poses of a flat board each image shows; empty where most do not agree. */
std::vector<int> viewsElsewhere(const RigData& data, const RigOptions& options, int camera);

std::vector<int> allCameras(const RigData& data);

//! Disagreements::camerasApart of these images.
double camerasApart(const RigData& data, const RigOptions& options);

/* Pairs of images against the map of the direct image on that through the window, which a window nearly is: a homography. */

//! How far pairs are from one map of the direct image on that through the window, of the worst camera. A window is such a map, nearly.
double pairsFromOneMap(const RigData& data);

//! Views of which the pair of a camera is off the map that most of its pairs are on; empty: none, or no map is that of most.
std::vector<int> pairsOffMap(const RigData& data, int camera);

/** Views whose pairs of a camera are on two maps, as of two cameras, whatever their names are: those of either; empty: one map is as
good, or two are not enough. */
std::vector<std::vector<int>> pairsOfTwoMaps(const RigData& data, int camera);

} // namespace tools

#endif // REFRACT_TOOLS_IMAGE_DISAGREEMENT_HPP
