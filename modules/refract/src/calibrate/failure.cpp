// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#include "calibrate/failure.hpp"
#include "calibrate/calibration_error.hpp"

namespace cv { namespace refract {

namespace {

//! Two angles of one normal are one word.
std::vector<String> wordsOf(const std::vector<FitOutcome::Parameter>& parameters)
{
    std::vector<String> words;
    for (const FitOutcome::Parameter& p : parameters)
    {
        String word = p.name;
        if (!std::isnan(p.value))
            word += format(" = %.4g", p.value);
        if (!std::isnan(p.sigma))
            word += format(" +- %.2g", p.sigma);
        if (std::find(words.begin(), words.end(), word) == words.end())
            words.push_back(word);
    }
    return words;
}

//! A failure in words: whom it is about, what was found, what to do. The first and the last may be empty.
struct Failure
{
    CalibrationError::Cause cause;
    String subject, reason, advice;
};

Failure describeUndetermined(const FitOutcome& outcome)
{
    const std::vector<String> words = wordsOf(outcome.parameters);
    String text;
    for (size_t i = 0; i < words.size(); i++)
        text += (i == 0 ? "" : i + 1 < words.size() ? ", " : " and ") + words[i];
    if ((int)words.size() > outcome.dimension)
        text += outcome.opticalThickness == 0 ? String("; only combinations of them show") :
            format("; at small angles only thickness (1 - outerIndex/index) = %.4g shows", outcome.opticalThickness);
    return { CalibrationError::UNDETERMINED, "", "the views do not determine " + text,
             ". Fix what is known otherwise, or add views: pairs without and with the window, more tilt, more depth" };
}

//! Iterations help where there were too few of them.
Failure describeUnconverged(const FitOutcome& o, const char* fit, const char* otherwise)
{
    const int PLENTY = 1000;        // criteria.maxCount of those who do not name it
    if (o.pointIndex >= 0)
        return { CalibrationError::NOT_CONVERGED, format("view %d: ", o.view),
                 format("%s did not converge; where it errs least, point %d touches the window of camera %d", fit, o.pointIndex,
                        o.camera + 1),
                 String("; check the window's distance and thickness, the size of the target, and the units") +
                     (o.isStuck || o.count >= PLENTY ? "" : "; or raise criteria.maxCount") };
    if (o.isStuck)
        return { CalibrationError::NOT_CONVERGED, "",
                 format("%s did not converge: after %d iterations no step makes it better", fit, o.count),
                 "; fix what is hardly determined, or give a better start" };
    return { CalibrationError::NOT_CONVERGED, "", format("%s did not converge in %d iterations", fit, o.count),
             String("; raise criteria.maxCount, ") + otherwise };
}

//! What any fit may come to.
Failure describe(const FitOutcome& o)
{
    switch (o.status)
    {
    case FitOutcome::NO_IMAGE:
        return { CalibrationError::NO_IMAGE,
                 format("view %d of camera %d, point (%g, %g, %g): ", o.view, o.camera + 1, o.point.x, o.point.y, o.point.z),
                 format("no image %s at the start (RefractiveStatus %d)", o.refracted ? "through the window" : "without window",
                        o.imageStatus),
                 "; check the window's distance and thickness, the lens, the units, and given poses" };
    case FitOutcome::LOOKS_AWAY:
        return { CalibrationError::LOOKS_AWAY, "",
                 format("shared window: camera %d looks away from it, as its normal is (%g, %g, %g) in the camera's frame, with R and "
                        "T and the start of the window", o.camera + 1, o.point.x, o.point.y, o.point.z),
                 "; do all cameras look through one wall?" };
    case FitOutcome::BEYOND_WINDOW:
        return { CalibrationError::BEYOND_WINDOW, "",
                 format("shared window: camera %d lies beyond the window, at distance %g", o.camera + 1, o.distance), "" };
    case FitOutcome::NO_POSE:
        return { CalibrationError::NO_POSE, format("view %d: ", o.view),
                 format("no pose of the target was found; %s", o.count < 4 ? "fewer than 4 of its points were seen in one image" :
                        "its points lie on a line, do not fit the target, or lie behind the window"), "" };
    case FitOutcome::NO_SCALE:
        return { CalibrationError::NO_SCALE, "", "lengths has none between two points that are seen in two images or more, by rays "
                 "that meet beyond the windows; nothing else tells the scale", "" };
    case FitOutcome::UNDETERMINED:
        return describeUndetermined(o);
    case FitOutcome::POSE_UNDETERMINED:
        return { CalibrationError::POSE_UNDETERMINED, "",
                 format("the points do not determine the poses, that of view %d least", o.view),
                 "; leave it out, or add points that it shares with others" };
    case FitOutcome::MAX_ITERATIONS:
        return describeUnconverged(o, "the calibration", "or fix what the views hardly determine");
    case FitOutcome::TOO_FEW_EQUATIONS:
        return { CalibrationError::TOO_FEW_POINTS, "",
                 format("the observed points give %d equations for %d unknowns", o.count, o.expected - 1), "; take more views" };
    case FitOutcome::TOO_FEW_INLIERS:
        return { CalibrationError::TOO_FEW_INLIERS, "", format("only %d of %d points fit", o.count, o.expected),
                 "; are the target's size, its square and the order of its points right, and the poses, if they were given (target to "
                 "camera 1)?" };
    default:
        CV_Error(Error::StsInternal, "a fit that converged is no failure");
    }
}

//! Of a bundle adjustment, which has no target.
Failure describeBundle(const FitOutcome& o)
{
    switch (o.status)
    {
    case FitOutcome::MAX_ITERATIONS:
        return describeUnconverged(o, "the bundle adjustment", "give a better start, or fix what the images hardly determine");
    case FitOutcome::TOO_FEW_EQUATIONS:
        return { CalibrationError::TOO_FEW_POINTS, "",
                 format("points that are seen in two images or more give %d equations, with lengths and poses; %d fewer than are "
                        "needed", o.count, o.expected - o.count), "; take more points, or points that more images see" };
    case FitOutcome::TOO_FEW_INLIERS:
        return { CalibrationError::TOO_FEW_INLIERS, "", format("only %d of %d observations fit", o.count, o.expected),
                 "; are the points matched, and is the start near enough?" };
    default:
        return describe(o);
    }
}

} // namespace

void throwUnlessConverged(const FitOutcome& outcome, FitKind kind)
{
    if (outcome.converged())
        return;
    const Failure failure = kind == FitKind::BUNDLE ? describeBundle(outcome) : describe(outcome);
    CalibrationError error(failure.cause, failure.subject + failure.reason + failure.advice, failure.reason);
    error.view = outcome.view;
    error.camera = outcome.camera;
    error.point = outcome.pointIndex;
    raise(error);
}

}} // namespace
