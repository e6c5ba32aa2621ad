// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_DOT_LATTICE_HPP
#define REFRACT_TOOLS_DOT_LATTICE_HPP

#include <opencv2/core.hpp>
#include <opencv2/features2d.hpp>
#include <vector>

/* Grids of dots of which some are covered, worn or larger than others: neighbours are joined one by one, and what is missing is missing. */
namespace tools {

//! Places of dots among each other, from (0, 0); x to the right and y down, seen from the board's front.
struct DotLattice
{
    std::vector<cv::Point> places;
    std::vector<int> dots;          //!< of each place: which of the dots it is
    cv::Size size;                  //!< that the places take

    //! How many of the places within its size have a dot.
    double filled() const { return (double)places.size()/std::max(size.area(), 1); }
};

//! The lattice that most of the dots are on; a step is that between nearest neighbours, which is oblique on an asymmetric grid.
DotLattice findLattice(const std::vector<cv::KeyPoint>& dots);

//! The places on a grid whose rows are shifted by half a step against each other, as gridOf() has it.
DotLattice asAsymmetric(const DotLattice& lattice);

/** For each point of a grid the dot that is on it, -1 where none is. Empty: the lattice is not of this size, or less than three quarters of
the dots are there, or less than half of those of an outer row or column, so that it might be a part of a larger one. */
std::vector<int> dotsOfGrid(const DotLattice& lattice, const std::vector<cv::Vec2d>& grid);

//! The grid of dots that an image shows, however many are missing; empty: none. @param asymmetric receives its kind
cv::Size dotGridIn(const cv::Mat& grey, bool& asymmetric);

} // namespace tools

#endif // REFRACT_TOOLS_DOT_LATTICE_HPP
