#include "assess/misfit.hpp"
#include "calibrate/image_fit.hpp"
#include "calibrate/units.hpp"
#include "console/table.hpp"
#include <opencv2/calib3d.hpp>
#include <algorithm>
#include <cmath>
#include <limits>

using namespace cv;
using namespace cv::refract;

namespace tools {

namespace {

const double CORNERS_PX = 2.;           // half of the corners are never farther off, in an image of usual size;
const double CORNERS_SHARE = 1. / 640.; // in a larger one, of its longer side
const double ALONE = 10.;               // times what the same corners leave if each image may be fitted alone:
const double ALONE_PX = 1.;             // the given values do not belong to them
const double EXPLAINS = 0.3;            // a mistake undone leaves less than this share
const double AS_GOOD = 3.;              // as the best of them
const double WHOLE_SQUARES = 0.25;      // of a shift remains if it is one by whole squares
const double USUAL_INDEX = 1.5;
const int ITERATIONS = 100;             // what explains the images fits them soon; a wrong guess may creep for a thousand
const double NO_FIT = std::numeric_limits<double>::infinity();

double median(std::vector<double> values)
{
    if (values.empty())
        return 0.;
    std::nth_element(values.begin(), values.begin() + values.size() / 2, values.end());
    return values[values.size() / 2];
}

/** How far half of the corners lie from where the fit puts them, px: wrong corners among them do not matter. Of the worse
camera, and of the moments with a glass image: direct images alone always fit. */
double medianOf(const RigData& data, const std::vector<Residual>& residuals)
{
    double worst = 0.;
    for (int c = 0; c < data.cameraCount; c++)
    {
        std::vector<double> lengths;
        for (const Residual& r : residuals)
            if (r.camera == c && data.moments[r.moment].hasGlass())
                lengths.push_back(std::isnan(r.error.x) ? NO_FIT : norm(r.error));
        worst = std::max(worst, median(lengths));
    }
    return worst;
}

double cornersLimit(const RigData& data)
{
    double limit = CORNERS_PX;
    for (int c = 0; c < data.cameraCount; c++)
        limit = std::max(limit, CORNERS_SHARE * std::max(data.imageSize[c].width, data.imageSize[c].height));
    return limit;
}

double misfitOf(const RigData& data, const RigOptions& options, RigModel* result = nullptr)
{
    try
    {
        std::vector<LensSource> sources;
        const Fit fit = fitImages(data, startModel(data, options, sources), allMoments(data), options.flags, ITERATIONS);
        if (result)
            *result = fit.rig;
        return medianOf(data, residualsOf(data, fit));
    }
    catch (const std::exception&)
    {
        return NO_FIT;
    }
}

struct Explanation
{
    std::string sentence;
    double px;                  //!< what it leaves
};

bool hasPairs(const RigData& data)
{
    return data.countPairs(0) + (data.cameraCount == 2 ? data.countPairs(1) : 0) > 0;
}

//! One pane that shifts rays as the layers together do, at small angles.
GlassWindow onePane(const GlassWindow& window)
{
    GlassWindow pane = window;
    double thickness = 0., shift = 0.;
    for (size_t i = 0; i < window.thickness.size(); i++)
    {
        thickness += window.thickness[i];
        shift += window.thickness[i] * (1. - window.outerIndex / window.index[i]);
    }
    pane.thickness = {thickness};
    pane.index = {window.outerIndex / (1. - shift / thickness)};
    return pane;
}

//! Pairs show the thickness in squares: only the ratio of the two.
Explanation wrongScale(const Given& given)
{
    if (!hasPairs(given.data) || given.options.window.thickness.empty())
        return {"", NO_FIT};
    RigOptions options = given.options;
    options.flags = (options.flags | GLASS_FREE_THICKNESS) & ~GLASS_FREE_INDEX;
    const GlassWindow pane = onePane(given.options.window);
    if (!(pane.index[0] > 1.))
        return {"", NO_FIT};
    double best = NO_FIT, ratio = 1.;
    for (double start : {1., 0.1, 10., 0.01, 100., 1000.})
    {
        options.window = pane;
        options.window.thickness[0] *= start;
        RigModel rig;
        const double px = misfitOf(given.data, options, &rig);
        if (px >= 0.5 * best)
            continue;
        best = px;
        ratio = rig.cameras[0]->window().thickness[0] / pane.thickness[0];
    }
    std::string sentence = format("--square=%.3g in place of %.4g%s", given.square / ratio, given.square,
                                  isRatioOfUnits(ratio) ? " (a wrong unit?)" : "");
    if (given.options.window.thickness.size() == 1)
    {
        sentence += format(", or --thickness=%.3g in place of %.4g", pane.thickness[0] * ratio, pane.thickness[0]);
    }
    else
        sentence += format(", or each --thickness times %.3g", ratio);
    return {sentence + ", as only their ratio shows", best};
}

Explanation wrongIndex(const Given& given)
{
    if (!hasPairs(given.data) || given.options.window.index.size() != 1)
        return {"", NO_FIT};
    RigOptions options = given.options;
    options.flags = (options.flags | GLASS_FREE_INDEX) & ~GLASS_FREE_THICKNESS;
    options.window.index[0] = USUAL_INDEX;
    RigModel rig;
    const double px = misfitOf(given.data, options, &rig);
    const double index = px < NO_FIT ? rig.cameras[0]->window().index[0] : 1.;
    return {format("--index=%.3g in place of %.4g", index, given.options.window.index[0]),
            index > 1.2 && index < 2.5 ? px : NO_FIT};
}

//! @param only one camera's; -1: all
Explanation swapped(const Given& given, int only)
{
    if (!hasPairs(given.data) || only >= given.data.cameraCount || (only >= 0 && given.data.cameraCount == 1))
        return {"", NO_FIT};
    RigData data = given.data;
    for (Moment& m : data.moments)
        for (int c = 0; c < data.cameraCount; c++)
            if (only < 0 || only == c)
                std::swap(m.direct[c], m.glass[c]);
    const char* suffix = only == 1 ? "2" : "";
    return {format("--direct%s and --glass%s exchanged", suffix, suffix), misfitOf(data, given.options)};
}

/** The folders of the two cameras exchanged, in one state only. Without a known lens the cameras have no names of their own:
the glass images exchanged back explain exchanged direct images as well. */
Explanation camerasExchanged(const Given& given, bool glass)
{
    const bool lensKnown = given.options.known[0] || given.options.known[1];
    if (!hasPairs(given.data) || given.data.cameraCount < 2 || (!glass && !lensKnown))
        return {"", NO_FIT};
    RigData data = given.data;
    for (Moment& m : data.moments)
        glass ? std::swap(m.glass[0], m.glass[1]) : std::swap(m.direct[0], m.direct[1]);
    const std::string sentence = glass ? "--glass and --glass2 exchanged" : "--direct and --direct2 exchanged";
    return {sentence + (lensKnown ? "" : " (or --direct and --direct2)"), misfitOf(data, given.options)};
}

Explanation otherMedium(const Given& given)
{
    RigOptions options = given.options;
    GlassWindow& window = options.window;
    const bool air = window.outerIndex == 1.;
    window.outerIndex = air ? 1.333 : 1.;
    if (window.outerIndex == window.innerIndex)
        options.flags &= ~GLASS_FREE_DISTANCE;
    else
    {
        options.flags |= GLASS_FREE_DISTANCE;
        if (window.distance == 0.)
            window.distance = given.square;
    }
    if (window.thickness.empty() && window.outerIndex == window.innerIndex)
        return {"", NO_FIT};
    return {format("--outer-index=%g in place of %g (the medium in which the board was)", window.outerIndex,
                   given.options.window.outerIndex), misfitOf(given.data, options)};
}

//! What one camera saw, as a rig of its own.
Given oneCamera(const Given& given, int camera)
{
    Given one = given;
    one.data.cameraCount = 1;
    one.data.imageSize[0] = given.data.imageSize[camera];
    one.options.known[0] = given.options.known[camera];
    one.options.flags &= ~GLASS_SHARED_WINDOW;
    one.data.moments.clear();
    for (const Moment& m : given.data.moments)
        if (m.hasDirect(camera) || m.hasGlass(camera))
        {
            one.data.moments.push_back({});
            one.data.moments.back().stem = m.stem;
            one.data.moments.back().direct[0] = m.direct[camera];
            one.data.moments.back().glass[0] = m.glass[camera];
        }
    return one;
}

Explanation otherMoments(const Given& given)
{
    if (given.data.cameraCount < 2)
        return {"", NO_FIT};
    double worst = 0.;
    for (int c = 0; c < 2; c++)
    {
        const Given one = oneCamera(given, c);
        worst = std::max(worst, misfitOf(one.data, one.options));
    }
    return {"each camera calibrated alone, so equal names of camera 1 and camera 2 are not the same moment (or the cameras "
            "moved to each other)", worst};
}

Explanation unpaired(const Given& given)
{
    if (!hasPairs(given.data))
        return {"", NO_FIT};
    RigData data = given.data;
    data.moments.clear();
    for (const Moment& m : given.data.moments)
    {
        Moment direct = m, glass = m;
        for (int c = 0; c < 2; c++)
        {
            direct.glass[c].clear();
            glass.direct[c].clear();
        }
        if (m.hasGlass())
            data.moments.push_back(glass);
        if (m.hasDirect(0) || m.hasDirect(1))
            data.moments.push_back(direct);
    }
    return {"each image fitted alone, so equal names of --direct and --glass are not one place of the board (it moved, or it "
            "was hand-held: --unpaired)", misfitOf(data, given.options)};
}

//! By how many rows and columns the glass image of a pair shows another part of the board than the direct one.
Point shiftOfPair(const Given& given, const Moment& m, int camera)
{
    std::vector<Point2d> board, direct, glass;
    for (size_t i = 0; i < given.data.objectPoints.size(); i++)
        if (seen(m.direct[camera][i]) && seen(m.glass[camera][i]))
        {
            board.emplace_back(given.data.objectPoints[i].x, given.data.objectPoints[i].y);
            direct.push_back(m.direct[camera][i]);
            glass.push_back(m.glass[camera][i]);
        }
    const Mat H = board.size() < 4 ? Mat() : findHomography(board, direct);
    if (H.empty())
        return Point();
    const auto offBy = [&](Point shift) {
        std::vector<Point2d> moved, there;
        for (const Point2d& p : board)
            moved.push_back(p + given.square * Point2d(shift));
        perspectiveTransform(moved, there, H);
        std::vector<double> lengths;
        for (size_t i = 0; i < there.size(); i++)
            lengths.push_back(norm(there[i] - glass[i]));
        return median(lengths);
    };
    Point best;
    for (int x = -2; x <= 2; x++)
        for (int y = -2; y <= 2; y++)
            if (offBy(Point(x, y)) < WHOLE_SQUARES * offBy(best))
                best = Point(x, y);
    return best;
}

//! A part of the board is found in place of all of it, and not the same part each time.
std::string partOfBoard(const Given& given)
{
    int pairs = 0, shifted = 0;
    for (const Moment& m : given.data.moments)
        for (int c = 0; c < given.data.cameraCount; c++)
            if (m.isPair(c))
            {
                pairs++;
                shifted += shiftOfPair(given, m, c) != Point();
            }
    return shifted == 0 ? "" : format("in %d of %d pairs the two images show the board a whole row or column apart, so --size is "
                                      "smaller than the board: count the inner corners (dots)", shifted, pairs);
}

//! Corners that no lens explains, each board where it fits best.
std::string badCorners(const Given& given)
{
    for (int c = 0; c < given.data.cameraCount; c++)
        try
        {
            std::vector<LensSource> sources;
            const Given one = oneCamera(given, c);
            startModel(one.data, one.options, sources);
            if (sources[0].kind == LensSource::FROM_DIRECT && sources[0].rms > cornersLimit(one.data))
                return format("already the direct images of camera %d, without any window, do not fit a lens (%.1f px): the "
                              "target is not as --pattern and --size say, or its points were found wrongly", c + 1,
                              sources[0].rms);
        }
        catch (const std::exception&) {}        // told elsewhere
    return "";
}

const char* const NOTHING_TRIED = "neither another square, thickness, index or medium, nor images exchanged or wrongly paired "
    "explain it. Check --pattern and --size, that the images are from this camera with the same zoom and focus, that the target "
    "is flat, and the images themselves";

std::string joined(const std::vector<std::string>& reasons)
{
    if (reasons.empty())
        return NOTHING_TRIED;
    std::string text;
    for (size_t i = 0; i < reasons.size(); i++)
        text += (i ? "; or " : "") + reasons[i];
    return text;
}

} // namespace

std::vector<std::string> explainMisfit(const Given& given)
{
    const double now = misfitOf(given.data, given.options);
    std::vector<std::string> sentences;
    for (const std::string& sentence : {badCorners(given), partOfBoard(given)})
        if (!sentence.empty())
            sentences.push_back(sentence);
    const std::vector<Explanation> tried = {wrongScale(given), wrongIndex(given), swapped(given, -1), swapped(given, 0),
                                            swapped(given, 1), camerasExchanged(given, true), camerasExchanged(given, false),
                                            otherMedium(given), otherMoments(given), unpaired(given)};
    double best = NO_FIT;
    for (const Explanation& e : tried)
        best = std::min(best, e.px);
    for (const Explanation& e : tried)
        if (e.px < EXPLAINS * now && e.px < cornersLimit(given.data) && e.px <= AS_GOOD * best)
            sentences.push_back(format("the same images fit within %.2g px with ", e.px) + e.sentence);
    return sentences;
}

void requireSensible(const RigCalibration& c, const Given& given)
{
    const double now = medianOf(c.data, c.residuals);
    double alone = 0.;
    for (int k = 0; k < c.data.cameraCount; k++)
        alone = std::max({alone, c.baselines.throughGlass[k], c.lensSources[k].rms});
    std::string fault;
    if (now > cornersLimit(c.data) || (now > ALONE_PX && now > ALONE * alone))
        fault = format("the calibration does not fit its images: half of the corners lie more than %.2g px from where it puts "
                       "them", now);
    else if (hasPairs(given.data) && !hasPairs(c.data))
        fault = format("all %d pair(s) contradict the calibration", given.data.countPairs(0)
                       + (given.data.cameraCount == 2 ? given.data.countPairs(1) : 0));
    if (!fault.empty())
    {
        std::vector<std::string> reasons = explainMisfit(given);
        reasons.insert(reasons.begin(), given.notices.begin(), given.notices.end());
        throw Failure(fault + ": " + joined(reasons));
    }
}

std::string explainError(const std::string& error, const Given& given)
{
    // The library speaks of its own arguments.
    const std::string theirs = "; raise criteria.maxCount, or fix what the views hardly determine";
    std::string text = error;
    const size_t at = text.find(theirs);
    // The distance is set free without being asked for where it is needed.
    const bool asked = given.options.flags & (GLASS_FREE_THICKNESS | GLASS_FREE_INDEX | GLASS_FREE_OUTER_INDEX
                                              | GLASS_FREE_INTRINSICS);
    if (at != std::string::npos)
        text.replace(at, theirs.size(), std::string(": the images hardly determine what is free. ") + (asked ? "Leave out "
                     "--free=..., g" : "G") + "ive what you know (--thickness, --index, --distance, --camera), or add "
                     "images: pairs, more tilt, more depth");
    std::vector<std::string> reasons = explainMisfit(given);
    reasons.insert(reasons.begin(), given.notices.begin(), given.notices.end());
    return reasons.empty() ? text : text + ". However, " + joined(reasons);
}

} // namespace tools
