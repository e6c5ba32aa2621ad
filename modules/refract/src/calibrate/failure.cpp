// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#include "calibrate/failure.hpp"

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

String describeUndetermined(const FitOutcome& outcome)
{
    const std::vector<String> words = wordsOf(outcome.parameters);
    String text;
    for (size_t i = 0; i < words.size(); i++)
        text += (i == 0 ? "" : i + 1 < words.size() ? ", " : " and ") + words[i];
    if ((int)words.size() > outcome.dimension)
        text += outcome.opticalThickness == 0 ? String("; only combinations of them show") :
            format("; at small angles only thickness (1 - outerIndex/index) = %.4g shows", outcome.opticalThickness);
    return "the views do not determine " + text + ". Fix what is known otherwise, or add views: pairs without and with the window, "
           "more tilt, more depth";
}

String describe(const FitOutcome& o, bool isBundle)
{
    switch (o.status)
    {
    case FitOutcome::CONVERGED:
        break;
    case FitOutcome::MAX_ITERATIONS:
        return isBundle ? format("the bundle adjustment did not converge in %d iterations; raise criteria.maxCount, give a better "
                                 "start, or fix what the images hardly determine", o.count)
                        : format("the calibration did not converge in %d iterations; raise criteria.maxCount, or fix what the "
                                 "views hardly determine", o.count);
    case FitOutcome::NO_IMAGE:
        return format("view %d of camera %d, point (%g, %g, %g): no image %s at the start (RefractiveStatus %d); check the "
                      "window's distance and thickness, the lens, the units, and given poses", o.view, o.camera + 1, o.point.x,
                      o.point.y, o.point.z, o.refracted ? "through the window" : "without window", o.imageStatus);
    case FitOutcome::LOOKS_AWAY:
        return format("shared window: camera %d looks away from it, as its normal is (%g, %g, %g) in the camera's frame, with R and "
                      "T and the start of the window; do all cameras look through one wall?", o.camera + 1, o.point.x, o.point.y,
                      o.point.z);
    case FitOutcome::BEYOND_WINDOW:
        return format("shared window: camera %d lies beyond the window, at distance %g", o.camera + 1, o.distance);
    case FitOutcome::NO_POSE:
        return format("view %d: no pose of the target was found; %s", o.view, o.count < 4 ?
                      "fewer than 4 of its points were seen in one image" :
                      "its points lie on a line, do not fit the target, or lie behind the window");
    case FitOutcome::TOO_FEW_EQUATIONS:
        return isBundle ? format("points that are seen in two images or more give %d equations, with lengths and poses; %d fewer "
                                 "than are needed; take more points, or points that more images see", o.count, o.expected - o.count)
                        : format("the observed points give %d equations for %d unknowns; take more views", o.count,
                                 o.expected - 1);
    case FitOutcome::NO_SCALE:
        return "lengths has none between two points that are seen in two images or more, by rays that meet beyond the windows; "
               "nothing else tells the scale";
    case FitOutcome::TOO_FEW_INLIERS:
        return isBundle ? format("only %d of %d observations fit; are the points matched, and is the start near enough?", o.count,
                                 o.expected)
                        : format("only %d of %d points fit; are the target's size, its square and the order of its points right, "
                                 "and the poses, if they were given (target to camera 1)?", o.count, o.expected);
    case FitOutcome::UNDETERMINED:
        return describeUndetermined(o);
    case FitOutcome::POSE_UNDETERMINED:
        return format("the points do not determine the poses, that of view %d least; leave it out, or add points that it shares "
                      "with others", o.view);
    }
    return String();
}

//! Whether the arguments are wrong, rather than what the data tell.
bool isArgument(FitOutcome::Status status)
{
    return status == FitOutcome::NO_IMAGE || status == FitOutcome::LOOKS_AWAY || status == FitOutcome::BEYOND_WINDOW ||
           status == FitOutcome::NO_POSE || status == FitOutcome::TOO_FEW_EQUATIONS || status == FitOutcome::NO_SCALE;
}

} // namespace

void throwUnlessConverged(const FitOutcome& outcome, FitKind kind)
{
    if (!outcome.converged())
        CV_Error(isArgument(outcome.status) ? Error::StsBadArg : Error::StsNoConv, describe(outcome, kind == FitKind::BUNDLE));
}

}} // namespace
