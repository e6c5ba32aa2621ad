// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_SCENE_MATCHES_HPP
#define REFRACT_TOOLS_SCENE_MATCHES_HPP

#include "assess/check_input.hpp"
#include "bundle/matches.hpp"
#include "calibrate/rig_model.hpp"
#include "console/failure.hpp"
#include "console/frames.hpp"
#include "match/match_noise.hpp"
#include "match/partner_search.hpp"

/* From images of a scene to matches for refract_bundle and refract_check. */
namespace tools {

struct ViewObservations;

/** What each camera of a calibration took. Throws Failure if there are not as many as cameras, or one alone. @param filename of the
calibration, for the text */
std::vector<Frames> framesOf(const std::vector<std::string>& sources, const Calibration& calibration, const std::string& filename,
                             const std::string& viewPattern = "");

//! That two cameras have images of. Throws Failure if there are none.
std::vector<Moment> sharedMoments(const std::vector<Frames>& cameras);

//! What a camera saw, 8-bit grey. @param white value that becomes 255, of images with more bits; 0: their largest, of each its own
cv::Mat greyFrame(Frames& frames, int i, const Calibration& calibration, int camera, double white = 0.);

//! What all cameras saw at a moment, 8-bit grey; empty: nothing.
std::vector<cv::Mat> imagesOf(const Moment& moment, const Calibration& calibration, std::vector<Frames>& cameras);

struct SceneOptions
{
    cv::Vec2d depth;                //!< z of the scene in the frame of camera 1
    double search = 0.;             //!< px from the epipolar curves; 0: what the calibration does not know, and what may have moved
    int count = 3000, mostFeatures = 4000;      //!< matches at most; features of an image at most
    std::string features = "SIFT";              //!< of featureNames()
};

//! By how much cameras and windows may have turned since the calibration, degrees.
const double MAY_HAVE_TURNED = 0.3;

struct SceneMatches
{
    ScaledMatches good;             //!< with stds
    double residual = 0.;           //!< px, RMS of the good ones: what no point and no motion of the rig explains
    MatchNoise noise;
    double search = 0.;             //!< px, the largest of all pairs
    int moments = 0;                //!< of which two cameras have images
    int found = 0;                  //!< matches in all images
    int chosen = 0;                 //!< of these, spread over image and depth
    int leftOut = 0;                //!< of the chosen: no point explains them
    double wrongLeft = 0.;          //!< expected among the good: as many are near a curve by chance
};

//! A plain wall, night: so few matches tell nothing, not even which of them are right.
class TooFewMatches : public Failure
{
public:
    using Failure::Failure;
};

/** The cameras of a calibration, and what is known of them. */
class SceneMatcher
{
public:
    SceneMatcher(const Calibration& calibration, const SceneOptions& options);

    //! All matches of one moment. @param images per camera, 8-bit grey; empty: none
    ScaledMatches matchesOf(const std::string& moment, const std::vector<cv::Mat>& images) const;

    /** The good ones of all moments. The rig may have moved: it is estimated within what is known of it and what may have turned. Throws
    TooFewMatches where there are too few to tell the good ones. */
    SceneMatches goodOf(const ScaledMatches& all) const;

private:
    //! @param groups of which some may err together
    std::vector<int> leaveOutWrong(ScaledMatches& scaled, const std::vector<int>& groups, SceneMatches& result) const;

    CheckInput input_;
    SceneOptions options_;
    std::vector<CameraPair> pairs_;
};

//! Of all moments that two cameras have images of.
SceneMatches matchScene(const Calibration& calibration, std::vector<Frames>& cameras, const SceneOptions& options, bool quiet);

//! The same by the moment's stem.
std::vector<cv::Mat> imagesOfMoment(const Calibration& calibration, std::vector<Frames>& cameras, const std::string& stem);

/** The baseline: RMS of the residuals of the same matches, px, where windows are ignored and the cameras' places fitted to the matches.
NaN: there is no such fit. */
double residualWithoutWindows(const Calibration& calibration, const ScaledMatches& good);

//! Matches as a check of a rig takes them, with points where the rig as calibrated sees them; without matches of which it sees none.
ViewObservations observationsOf(const RigModel& rig, const Matches& matches);

} // namespace tools

#endif // REFRACT_TOOLS_SCENE_MATCHES_HPP
