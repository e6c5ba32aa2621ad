// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_CHECK_IMAGES_HPP
#define REFRACT_TOOLS_CHECK_IMAGES_HPP

#include "assess/check_problem.hpp"
#include "assess/rig_check.hpp"
#include "calibrate/conditions.hpp"
#include "calibrate/provenance.hpp"
#include "calibrate/rig_data.hpp"
#include "match/scene_matches.hpp"

/* The new images of a check. */
namespace tools {

/** Of the false alarms of a history: the check by itself, which knows more causes than the charts. */
const double SHARE_OF_CHECK = 0.05;

struct CheckOptions
{
    std::string calibration, imageSize, summary, unit;
    RigSources images;
    TargetOptions target;
    PerCamera<std::string> scene;
    std::string depth;
    double falseAlarm = 0., detect = 0.1, sigma = 0.;
    bool newPane = false, fixedTarget = false;
    PaneStd pane = {0., 0.001, 0.};
    double wedgeMinutes = 1.;
    double placement = -1.;         //!< negative: that of the calibration
    ConditionsOptions conditions;
    std::string history, page, date, serial;

    bool hasHistory() const { return !history.empty(); }
    bool isOfScene() const { return !scene[0].empty(); }
    //! Of the check by itself.
    double falseAlarmOfCheck() const { return hasHistory() ? SHARE_OF_CHECK*falseAlarm : falseAlarm; }
    std::string pageFile() const;
    //! All files that it reads.
    std::vector<std::string> inputs() const;
    void addTo(OptionParser& parser);
    //! Refuses what is not said together: a target and a scene.
    void complete();
    /** What was left out, as the calibration has it. Refuses another unit or serial number.
    @param calibration as it was read */
    void completeFrom(const Calibration& calibration);
};

//! What the images are of, a target or a scene, and their files.
struct CheckImages
{
    std::vector<View> views;                    //!< of a target
    SceneMatches scene;
    std::vector<std::string> files;
    std::vector<CalibrationImage> shown;        //!< of a target: what is known of each
};

CheckImages readCheckImages(const CheckOptions& options, const Calibration& calibration, const Command& command);

/** The images against the calibration.
@param input becomes what was tested: with the target's motions between pairs, or the noise of a scene's points */
CheckResult checkImages(const CheckOptions& options, const CheckImages& images, const Calibration& calibration, CheckInput& input);

} // namespace tools

#endif // REFRACT_TOOLS_CHECK_IMAGES_HPP
