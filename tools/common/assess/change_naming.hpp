// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_CHANGE_NAMING_HPP
#define REFRACT_TOOLS_CHANGE_NAMING_HPP

#include "assess/rig_check.hpp"
#include "calibrate/rig_data.hpp"
#include "calibrate/rig_model.hpp"
#include <optional>

/* Which of the changes that were tested explains new images. */
namespace tools {

/* Images that are not what they are given for: turned, mirrored, exchanged, of other moments, of a board of another size, without
windows. */

//! The views with one such mistake undone.
struct Undone
{
    std::string name;           //!< "images of camera 2 mirrored"
    int camera;                 //!< from 0; negative: of the rig as a whole
    std::vector<View> views;    //!< of boards; or else
    int poses = 0;              //!< more than before
    std::vector<ViewObservations> observed = {};
    std::optional<Change> freed = {};       //!< beside it
};

//! Mistakes that leave residuals of many pixels.
std::vector<Undone> swappedImages(const RigModel& rig, const std::vector<View>& views);

//! Images given as of one place of the board, or of one moment, that are not: any of them may fit better so.
std::vector<Undone> unrelatedImages(const RigModel& rig, const std::vector<View>& views);

//! Images given as through a window that were taken without it. @param views of boards or of a scene, with what is unknown of them
std::vector<Undone> imagesWithoutWindows(const RigModel& rig, const std::vector<ViewObservations>& views);

/** A board so much larger or smaller than it is given for that no fit gets there: as large as several cameras measure it.
@param unit of lengths; empty: unknown */
std::vector<Undone> boardOfOtherSize(const RigModel& rig, const std::vector<View>& views, const std::string& unit);

//! Of so large residuals or larger ones from noise alone. @param parameters that were estimated; dof of the noise
double probabilityOfResiduals(const CheckProblem& problem, double chiSquare, int parameters, double dof);

class ChangeNaming
{
public:
    //! All outlive it. @param result its sigma and dof; name() tells it what explains the images
    ChangeNaming(const CheckProblem& problem, const CheckFit& unchanged, bool isScene, CheckResult& result)
        : problem_(problem), unchanged_(unchanged), isScene_(isScene), result_(result) {}
    void add(const TestedChange& tested);       //!< if it was fitted
    void addUndone(const CheckInput& input, const std::vector<Undone>& all);
    //! @return the changes that were named
    std::vector<const TestedChange*> name();

private:
    //! One that competes for the name.
    struct Candidate
    {
        NamedChange named;
        double chiSquare;
        int parameters;
        const TestedChange* tested;     //!< null: images that are not what they are given for
    };

    double noiseOf(const Candidate& c) const { return c.chiSquare/std::max(1, problem_.observations() - c.parameters); }
    bool isExplained(const Candidate& c) const;
    bool contains(const TestedChange& large, const TestedChange& small) const;
    void dropNested();
    std::vector<Candidate> ranked() const;
    void tellWhatCanHappenFirst(std::vector<Candidate>& named) const;

    const CheckProblem& problem_;
    const CheckFit& unchanged_;
    const bool isScene_;
    CheckResult& result_;
    std::vector<Candidate> candidates_;
};

} // namespace tools

#endif // REFRACT_TOOLS_CHANGE_NAMING_HPP
