// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_GIVEN_INDEX_HPP
#define REFRACT_TOOLS_GIVEN_INDEX_HPP

#include "calibrate/light.hpp"

/* Indices of refraction as users give them: a number, or the name of a material. */
namespace tools {

struct GivenIndex
{
    double value = 1.;
    std::string name = "";          //!< empty: it was given as a number
    std::string material = "";      //!< as refractiveIndex takes it; name may say more
    Light of = {};                  //!< that of the value, if it has a name
    double deviation = 0.;          //!< how far it may be off, if it has a name

    bool isNamed() const { return !name.empty(); }
    std::string sentence() const;   //!< "the index of N-BK7 at 550 nm: 1.51852"
    std::string light() const;      //!< what deviation is of: "N-BK7, light of 450 to 650 nm"
};

//! "1.333" or "seawater:T=12,S=35". @param option names the option in the error text
GivenIndex readIndex(const std::string& text, const Light& light, const std::string& option);

//! "1.52,1.48" or "N-BK7,PMMA,1.5": of each layer; names without parameters.
std::vector<GivenIndex> readIndices(const std::string& text, const Light& light, const std::string& option);

} // namespace tools

#endif // REFRACT_TOOLS_GIVEN_INDEX_HPP
