// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_WRONG_POINTS_HPP
#define REFRACT_TOOLS_WRONG_POINTS_HPP

#include "calibrate/starting_model.hpp"

/* Dirty glass: hidden, smeared or wrongly detected points, and images whose target was moved. They are found by a robust fit
of everything (GLASS_ROBUST) and taken out of the data before the calibration itself, which then knows nothing of them. */
namespace tools {

//! What was left out of one image.
struct Dropped
{
    std::string view;
    int camera;
    bool glass;
    int points;                 //!< of those seen
    bool image;                 //!< the whole image
    std::string why;

    std::string sentence() const;
};

struct WrongPoints
{
    std::vector<Dropped> dropped;
    std::string fault;          //!< why wrong points could not be looked for; empty if they were
};

//! Takes wrong points and images out of the data. Leaves all of them where the robust fit is not possible.
WrongPoints dropWrongPoints(RigData& data, const RigModel& start, int flags);

/** A lens from a few images of its own is not as sharp as corners are, and good images may contradict it: where it costs whole
images, or fits nothing at all, the fit with a free lens, which is what the calibration itself is, says what is wrong. */
WrongPoints dropWrongPoints(RigData& data, const RigModel& start, int flags, const std::vector<LensSource>& lensSources);

/** The same where the start comes from the data too: wrong points are in its lens, and so in what seems wrong. They are looked
for again in all the data, from the start that the others give, until the same ones are wrong.
@param start, lensSources result: as of startModel from what is left */
WrongPoints startWithoutWrongPoints(RigData& data, const RigOptions& options, RigModel& start,
                                    std::vector<LensSource>& lensSources);

} // namespace tools

#endif // REFRACT_TOOLS_WRONG_POINTS_HPP
