// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_LENGTHS_HPP
#define REFRACT_TOOLS_LENGTHS_HPP

#include "accept/gum_table.hpp"

/* Calibrated lengths, as their certificate says, and the points between which they are. */
namespace tools {

struct CalibratedLength
{
    std::string name;
    size_t ends[2];                 //!< indices into the points
    double length, U;               //!< as certified, at the temperature of the test; U expanded, k = 2
    std::vector<CertifiedSource> ofTemperature = {};
};

//! What the length is uncertain by: its certificate, then its temperature.
std::vector<CertifiedSource> sourcesOf(const CalibratedLength& length);

/** The standard at the test: it has grown since its certificate by length*expansion*(temperature - reference). NaN: not stated. Its
certificate is then taken to be valid at the temperature of the test. */
struct StandardTemperature
{
    double temperature, std;            //!< degrees Celsius, K
    double expansion, expansionStd;     //!< 1/K
    double reference;                   //!< of the certificate, degrees Celsius

    bool isStated() const { return temperature == temperature; }
    CalibratedLength applied(const CalibratedLength& length) const;
};

/** lengths.csv: name,image1,id1,image2,id2,length,U. Where both images are empty and the points have some, the length is one of each
image that shows both of its points (a board); its name then goes on with the image. Refuses with a Failure that names file and
line: a length without an uncertainty, a name or a pair that stands twice, points that are not there or have no answer. */
std::vector<CalibratedLength> readLengths(const std::string& path, const TestPoints& points);

//! The largest error that is allowed to a length: a number, or "A+L/K" as makers of measuring machines state it.
class PermissibleError
{
public:
    explicit PermissibleError(const std::string& text);     //!< throws Failure
    double of(double length) const { return constant_ + (perLength_ > 0 ? length/perLength_ : 0.); }
    const std::string& text() const { return text_; }

private:
    std::string text_;
    double constant_ = 0., perLength_ = 0.;
};

} // namespace tools

#endif // REFRACT_TOOLS_LENGTHS_HPP
