// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_GIVEN_STD_HPP
#define REFRACT_TOOLS_GIVEN_STD_HPP

#include "calibrate/light.hpp"
#include <string>
#include <vector>

/* How well given values are known: as the user says, or as is usual for values of their kind. */
namespace tools {

/* Indices of refraction as users give them: a number, or the name of a material. */

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

class OptionParser;

//! A standard deviation; 0: exact.
struct Std
{
    double value = 0.;
    std::string source;             //!< "default", or the material that says it; empty: the user

    Std(double std = 0., const std::string& from = "") : value(std), source(from) {}
    operator double() const { return value; }
    //! "0.1 mm", "0.1 mm (default)"; with the factor to the unit's value.
    std::string text(const std::string& unit, double factor = 1.) const;
};

const double USUAL_SQUARE_STD = 5e-4;        //!< relative, of a printed board
const double USUAL_PLACEMENT_MM = 0.02;      //!< of a board on a stand, or a camera on its mount, while the window goes in

//! Of an index where nothing is said: of a material's name its tolerance and the light's band, 0.001 of a number; air as a number is exact.
Std usualStdOf(const GivenIndex& index);

struct GivenStd
{
    Std thickness, outerIndex, distance;
    std::vector<Std> index = {};        //!< of each layer; empty: exact
    Std wedge;                          //!< of each of its two angles, radians
    Std radius;                         //!< of a dome's or tube's inner face
    Std center;                         //!< of a dome's centre, per axis; 0: nothing is known of it
    Std normal;                         //!< of a flat window's, radians, about each of two axes; 0: nothing is known of it
    Std bow;                            //!< of a pane, mm of sag per metre
    double curvature = 0.;              //!< the same, over the unit of lengths
    Std scale;                          //!< of the targets (a board's square), relative
    bool isDistanceOpen = false;        //!< nobody gave it, and faces that are not parallel show it a little, between equal media, too
    Std placement;                      //!< by how much all boards moved between direct and glass, per axis

    Std indexOf(size_t layer) const { return layer < index.size() ? index[layer] : Std(); }
    bool ofIndices() const;
    bool ofWindow() const;
};

//! What the defaults depend on.
struct GivenValues
{
    std::vector<GivenIndex> layers;
    GivenIndex outer;
    bool equalMedia = true;             //!< on both sides of the window
    bool distance = false;              //!< was given
    int shape = cv::refract::WINDOW_FLAT;
    std::vector<int> others = {};       //!< shapes of the rig's other windows, of which deviations may be said, too
    double square = 0.;                 //!< of a board; 0: there is none
    double millimetre = 1.;             //!< in the unit of lengths
    int flags = 0;                      //!< GLASS_FREE_...: what is estimated from the images alone has no default
};

//! --thickness-std and its kin.
class GivenStdOptions
{
public:
    //! @param target also what is known of a board and its placement
    void addTo(OptionParser& parser, bool target = true);
    bool isSaid() const;                //!< any of them
    //! What was said; of all else what is usual. Throws Failure where a deviation is said of what there is not.
    GivenStd of(const GivenValues& values) const;

private:
    enum { THICKNESS, INDEX, OUTER_INDEX, DISTANCE, WEDGE, RADIUS, CENTER, BOW, SQUARE, SCALE, PLACEMENT, COUNT };
    void requireShape(const GivenValues& values) const;
    bool isMoreThanZero(int which) const { return said_[which] > 0.; }
    double said_[COUNT];                //!< NaN: not
    bool exact_ = false;
};

} // namespace tools

#endif // REFRACT_TOOLS_GIVEN_STD_HPP
