// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_MEASURES_HPP
#define REFRACT_TOOLS_MEASURES_HPP

#include "bundle/bundle_adjustment.hpp"

/* What is measured beside the images and tells the scale: lengths, and where views were. Each may be wrong. */
namespace tools {

//! Where a camera was, from outside.
struct KnownPosition
{
    cv::Vec3d center;
    double std;                 //!< of each coordinate
    int line = 0;               //!< of its table
};

struct Measures
{
    GivenLengths lengths;
    std::map<int, KnownPosition> positions;     //!< by view
};

//! Observations that can be adjusted again with other measures.
struct MeasuredBundle
{
    Measures measures;
    std::string lengthsPath, positionsPath;     //!< of their tables, for a sentence
    std::vector<std::vector<int>> points;       //!< of which point each pixel is, as BundleAdjustment::used has them
    //! May throw Failure. @param only these pixels, as BundleAdjustment::used, all of which are right; nullptr: as the user has it
    std::function<BundleAdjustment(const Measures& measures, const std::vector<std::vector<uchar>>* only)> adjust;
};

struct ContradictedMeasures
{
    std::string sentence;       //!< which contradict the rest; empty: none does
    bool isFactor = false;      //!< all lengths do, by one factor
    BundleAdjustment rest;      //!< to which measures say next to nothing
};

//! @param adjustment with the measures as they are given
ContradictedMeasures contradictedMeasures(const MeasuredBundle& bundle, const BundleAdjustment& adjustment);

} // namespace tools

#endif // REFRACT_TOOLS_MEASURES_HPP
