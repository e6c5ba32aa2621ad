// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

// The manual: what --help prints first.
static const char MANUAL[] = R"(Checks whether anything has changed since the calibration, and what, from one new pair or a few images of
a board, or of any scene.

  refract_check calib.yml --size=6x5 --square=39 --direct=new/direct.png --glass=new/glass.png
  refract_check calib.yml --size=6x5 --square=39 --glass='new/*.png'                          no image without the window
  refract_check calib.yml ... --direct='d1/*' --glass='g1/*' --direct='d2/*' --glass='g2/*'      a stereo rig
  refract_check calib.yml --scene='left/*.png' --scene='right/*.png' --depth=450,1150                   the same without a board

One image each of --direct and --glass are a pair; among several, those with the same name. The target must not have moved
between them, not even by a tenth of a pixel: in air, such a shift looks like a tilt of the window (--placement-std).
Tried, each alone: a window tilted, its distance, thickness, index, wedge; the medium before it; the focus of one camera or of
all, a camera's principal point, R and T; the square of the board; a motion of all boards between direct and glass; images turned,
mirrored, exchanged, or of different moments. What explains the images best is named with its value and +-; what does so about as
well follows after "or".
The noise comes from the calibration's residuals, the calibration's own error from the covariance in calib.yml.
A new pane is wedge-shaped in another way than the old one, which looks like a tilt: with --new-pane, that is part of the +-.
If nothing changed, it says that something did with the probability --false-alarm. What was wrong in the calibration and still is,
as the square of the same board, hardly shows, as the calibrated values have absorbed it: the last lines say up to which size.

--scene, once for each camera, are images, quoted globs or videos, in which refract_match finds points; --depth is z of the scene in the
frame of camera 1. No scene shows a turn of the whole rig, or another scale; in air it hardly shows a window's tilt.

  refract_check calib.yml ... --history=rig7.json              every month: keeps this check, and draws the control charts of all

The charts (rig7.html, or --report) show drifts that no single check does: an EWMA of each parameter and T^2 of all, whose limits
take into account that the calibration's own error is the same in all checks. --false-alarm (then 1/370) is for all charts and the
check together. The images of each check must be new ones (one that was stored anew is known by where it shows the target), and the
calibration the same. An edited or deleted record is told. Two checks at once wait for each other.

--outer-index=seawater:T=8,S=35 says the scene's medium now, where it is not that of the calibration.

Exit code: 0 unchanged, 2 something changed (with --history, or a chart is beyond its limit), 1 could not tell: bad images, or images
that would not show a tilt of --detect degrees, or in a scene a turn of a camera, with a probability of 95 % (not with --history, whose
estimates have their +-).)";

#include "calibrate/units.hpp"
#include "check/check_output.hpp"
#include "console/cli.hpp"
#include "console/file_output.hpp"
#include "console/table.hpp"
#include <iostream>

using namespace tools;

namespace {

CheckInput inputOf(const CheckOptions& o, const Calibration& calibration)
{
    const CheckInput input = checkInputOf(calibration, o.calibration, o.sigma);
    if (!o.newPane)
        return input;
    PaneStd pane = o.pane;
    pane.wedge = o.wedgeMinutes*ARC_MINUTE;
    return withNewPanes(input, pane);
}

std::unique_ptr<KeptCheck> keptCheck(const CheckOptions& options, const Calibration& asCalibrated, const Command& command)
{
    if (!options.hasHistory())
        return {};
    auto kept = std::make_unique<KeptCheck>(options, asCalibrated);
    for (const std::string& sentence : kept->broken())
        command.warn("'" + options.history + "' is not as it was written: " + sentence);
    return kept;
}

//! Of a scene in which hardly anything is found, this says so as of one that tells too little.
CheckImages newImages(const CheckOptions& o, const Calibration& calibration, const Command& command)
{
    try
    {
        return readCheckImages(o, calibration, command);
    }
    catch (const TooFewMatches& few)
    {
        const std::string why = format("these images would hardly show a turn by %g deg, so 'unchanged' cannot be said: ", o.detect)
                                + few.what();
        if (!o.summary.empty())
            writeText(o.summary, Json({{"verdict", CANNOT_TELL}, {"why", why}}).text(1) + '\n');
        if (!command.quiet())
            std::cout << toned(std::cout, CANNOT_TELL, Tone::DOUBTFUL) << "\n\n";
        throw Failure(why);
    }
}

//! What is to be said of a check, and of all of its history.
struct Conclusion
{
    std::string why;            //!< the images do not tell; else empty
    std::string verdict;
    bool isAlarm;

    Tone tone() const { return !why.empty() ? Tone::DOUBTFUL : isAlarm ? Tone::BAD : Tone::GOOD; }
};

//! Adds the check to its history, if there is one; gives that up where the images do not tell.
Conclusion concluded(const CheckResult& result, const CheckOptions& options, const CheckInput& input, const CheckImages& images,
                     const Command& command, std::unique_ptr<KeptCheck>& kept)
{
    Conclusion conclusion;
    conclusion.why = whyNot(result, options, input);
    conclusion.verdict = verdictOf(result, conclusion.why);
    conclusion.isAlarm = result.changed;
    if (!kept)
        return conclusion;
    if (result.isMixup || result.charted.changes.empty() || !conclusion.why.empty())
    {
        command.warn("this check is not kept in '" + options.history + "': its images "
                     + (result.isMixup ? "are not what they are given for" : "do not tell where the rig is"));
        kept.reset();
        return conclusion;
    }
    kept->add(result, input, images, conclusion.verdict);
    conclusion.isAlarm |= kept->isAlarm();
    if (conclusion.isAlarm && !result.changed)
        conclusion.verdict = "drifted";
    kept->write(conclusion.verdict, !conclusion.isAlarm, unseenBy(result));
    return conclusion;
}

} // namespace

int refract_check_main(int argc, char** argv)
{
    return runTool(argc, argv, MANUAL, [](Command& command) {
        CheckOptions options = parsed<CheckOptions>(command, [](OptionParser& parser, CheckOptions& o) { o.addTo(parser); });
        options.complete();
        const Calibration asCalibrated = readCalibration(options.calibration, false, command, "");
        options.completeFrom(asCalibrated);
        const Calibration calibration = options.conditions.appliedTo(asCalibrated, options.calibration);
        std::vector<std::string> inputs = options.inputs();
        inputs.push_back(command.settings());
        checkOutputs({{"--summary", options.summary, options.hasHistory() ? OUTPUT_SHARED : OUTPUT_TEXT},
                      {"--history", options.history, OUTPUT_SHARED}, {"--report", options.pageFile(), OUTPUT_SHARED}}, inputs);
        std::unique_ptr<KeptCheck> kept = keptCheck(options, asCalibrated, command);
        CheckInput input = inputOf(options, calibration);
        const CheckImages images = newImages(options, calibration, command);
        if (kept)
            kept->requireNewImages(images);
        const CheckResult result = checkImages(options, images, calibration, input);
        const Conclusion conclusion = concluded(result, options, input, images, command, kept);
        if (!options.summary.empty())
        {
            Json json = checkJson(result, options, input, conclusion.verdict, conclusion.why);
            if (kept)
                json.set("history", kept->json());
            writeText(options.summary, json.text(1) + '\n');
        }
        if (!command.quiet())
        {
            std::cout << toned(std::cout, conclusion.verdict, conclusion.tone()) << "\n\n";
            if (options.conditions.isSaid())
                std::cout << options.conditions.notice(asCalibrated) << "\n\n";
            printCheck(result, options, input, images);
            if (kept)
                kept->print();
        }
        if (!conclusion.why.empty())
            throw Failure(conclusion.why);
        return conclusion.isAlarm ? LIMIT_NOT_MET : DONE;
    });
}
