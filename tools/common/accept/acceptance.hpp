// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_ACCEPTANCE_HPP
#define REFRACT_TOOLS_ACCEPTANCE_HPP

#include "accept/gum_table.hpp"

/* An acceptance test: errors of indication of calibrated lengths against what is permitted, decided with guard bands (ISO 14253-1):

    conforms:   |error| + U <= limit,       does not:   |error| - U_test > limit,       else undecided.

U_test is of the test alone: the certified length, its temperature, the noise of the points' pixels. U has what the rig's own calibration
may err by, too. What a rig errs by is what is tested: it may not excuse a failure by how badly it is known, but a pass must hold wherever
in its volume it measures. */
namespace tools {

/* Calibrated lengths, as their certificate says, and the points between which they are. */

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
line: a length without an uncertainty, a name or a pair that stands twice, points that are not there or have no answer.
@param untested gets the names of lengths of an image of which an end was not measured there */
std::vector<CalibratedLength> readLengths(const std::string& path, const TestPoints& points, std::vector<std::string>& untested);
//! Empty: all were tested.
std::string remarkOfUntested(const std::vector<std::string>& untested);

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

enum class Decision { PASS, FAIL, UNDECIDED };

Decision decide(double error, double U, double testU, double limit);
std::string textOf(Decision decision);
//! The rule with its edition and guard bands, for whoever signs.
extern const char* const DECISION_RULE;

//! In which lengths are tested.
struct TestVolume
{
    std::optional<CalibratedVolume> box;    //!< none: not known
    bool isStated = false;                  //!< by --volume; else it is where the rig was calibrated

    TestVolume(const std::optional<CalibratedVolume>& ofCalibration = std::nullopt) : box(ofCalibration) {}
    std::string name() const { return isStated ? "the stated volume" : "the calibrated volume"; }
    //! "x -100 ... 100, y -80 ... 80, z 500 ... 700"
    std::string numbers() const;
};

struct LengthResult
{
    CalibratedLength length;
    double measured, error, limit;
    GumTable budget;                    //!< of the error
    Decision decision;
    bool outside = false;               //!< an end is not in the volume

    double U() const { return budget.U; }
    double testU() const { return budget.testU; }
    //! What of the limit is used up, U included: above 1 it does not pass.
    double used() const { return (std::abs(error) + U())/limit; }
};

struct Acceptance
{
    TestPoints points;
    PermissibleError limit;
    std::vector<LengthResult> lengths;
    TestVolume volume;
    std::vector<std::string> missing;   //!< against VDI/VDE 2634 part 1, half a sentence each
    std::vector<std::string> notices;   //!< what the reader should know, a sentence each
    std::string unit;
    bool imagesChecked = false;         //!< that none of them calibrated

    void add(const std::vector<std::string>& more) { notices.insert(notices.end(), more.begin(), more.end()); }
    Decision decision() const;          //!< of all lengths: one that fails is enough, one that is undecided too
    int count(Decision decision) const;
    int outside() const;
    std::vector<std::string> remarks() const;   //!< all that a reader should know, a sentence each: screen and paper have the same
    const LengthResult& decisive() const;       //!< that uses most of its limit
    const LengthResult& largest() const;        //!< error
    double rms() const;
};

//! Errors and decisions.
Acceptance testLengths(const TestPoints& points, const PointErrors& errors, const std::vector<CalibratedLength>& lengths,
                       const PermissibleError& limit, const TestVolume& volume);

//! A factor that all errors share, error = scale*length: a wrong square of the board that calibrated makes one.
struct CommonScale
{
    double value, std;                  //!< std: by the test's own errors
    int ofOneSign, count;

    //! "All errors share one scale, +0.100 +- 0.003 % (24 of 24 have its sign): ..."
    //! @param unit of the calibration; empty: unknown
    std::string sentence(const std::string& unit) const;
};
//! None: fewer than three lengths, or the errors do not show it.
std::optional<CommonScale> commonScale(const std::vector<LengthResult>& lengths);

/** Whether the lengths are those of a board with the square that calibrated, as far as their certificates tell: between its points there
is nothing but sqrt(a^2 + b^2) squares. If it is that board, a wrong square makes both sides wrong alike, and the test does not see it.
@param lengths as certified @param square of the calibration; 0: not known */
bool areOfBoard(const std::vector<CalibratedLength>& lengths, double square);

/* What VDI/VDE 2634 part 1 asks of the lengths that test an optical system: seven measuring lines anywhere in the volume, five
lengths on each, the longest at least two thirds of the volume's longest diagonal. */

//! Lengths on one straight line, as indices.
using MeasuringLine = std::vector<size_t>;

/** Lines are inferred from where lengths were measured: from the longest on, a length is on a line if it is along it, within a tenth
of its own length, and both of its ends are within a twentieth of the line's longest length from it. */
std::vector<MeasuringLine> measuringLines(const Acceptance& acceptance);

//! What the test lacks, half a sentence each; empty: nothing.
std::vector<std::string> missingOf(const Acceptance& acceptance);

} // namespace tools

#endif // REFRACT_TOOLS_ACCEPTANCE_HPP
