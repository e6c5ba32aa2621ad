// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "match/wand_matches.hpp"
#include "bundle/bundle_adjustment.hpp"
#include "console/failure.hpp"
#include "console/numbers.hpp"
#include "console/progress.hpp"
#include "match/scene_matches.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

using namespace cv;

namespace tools {

namespace {

const double NaN = std::numeric_limits<double>::quiet_NaN();
const int FEWEST = 8;               // moments, of which a fit can be made
const int LATE = 3, FAR_LATE = 100;             // images, by which cameras may be out of step: often, and where nothing fits

/* What a camera shows that does not move, and what its images have in common. */
struct StillCamera
{
    Mat background;
    double white;               //!< of more bits, one for all images: a flash must not make the rest darker
};

//! By images spread over all, as many as tell what stands still.
StillCamera stillCameraOf(Frames& frames, const Calibration& calibration, int camera)
{
    const int ENOUGH = 15, FEWEST_STILL = 5;
    if (frames.size() < FEWEST_STILL)
        throw Failure(format("camera %d has images of %d moment%s; what stands still, which is no wand, is told from %d or more",
                             camera + 1, frames.size(), frames.size() == 1 ? "" : "s", FEWEST_STILL));
    const int count = std::min(frames.size(), ENOUGH);
    const auto frameOf = [&](int i) { return (int)((int64)i*frames.size()/count); };
    double white = 0.;
    for (int i = 0; i < count; i++)
    {
        const Mat image = frames.read(frameOf(i));
        if (image.depth() == CV_8U)
            break;
        white = std::max(white, whiteOf(image));
    }
    std::vector<Mat> images;
    for (int i = 0; i < count; i++)
        images.push_back(greyFrame(frames, frameOf(i), calibration, camera, white));
    return {stillBackground(images), white};
}

//! Whether two cameras see two balls or more.
bool mayHaveWand(const std::vector<Balls>& balls)
{
    return std::count_if(balls.begin(), balls.end(), [](const Balls& ofCamera) { return ofCamera.size() > 1; }) > 1;
}

//! Whether a camera is one of these.
bool mayShowWand(const std::vector<Balls>& balls, int camera) { return balls[camera].size() > 1 && mayHaveWand(balls); }

int withWand(const BallSightings& seen) { return (int)std::count_if(seen.balls.begin(), seen.balls.end(), mayHaveWand); }

/* All moments against a rig. */
class WandSearch
{
public:
    WandSearch(const BallSightings& seen, const Wand& wand) : seen_(seen), wand_(wand), clear_(seen.balls)
    {
        for (std::vector<Balls>& balls : clear_)
            for (Balls& ofCamera : balls)
                if (ofCamera.size() != 2)
                    ofCamera.clear();
        const std::vector<std::vector<Balls>> clear = clear_;
        for (int c = 0; !clear.empty() && c < (int)clear[0].size(); c++)
            if (std::count_if(clear.begin(), clear.end(), [c](const std::vector<Balls>& b) { return mayShowWand(b, c); }) < FEWEST)
                for (size_t m = 0; m < clear.size(); m++)
                    clear_[m][c] = seen.balls[m][c];
    }

    const Wand& wand() const { return wand_; }

    //! What a rig makes of the wand where one camera sees it, medians; NaN: nothing of most moments.
    struct Usual
    {
        double miss;            //!< px, RMS of a wand
        double length;          //!< over the wand's
    };

    //! @param camera which sees both balls, at so many moments later than the others
    Usual usual(const RigModel& rig, const WandLimits& limits, int camera, int later = 0) const
    {
        const int ENOUGH = 60;          // moments, that tell by how much it is late
        const int moments = (int)seen_.moments.size(), step = later ? (moments + ENOUGH - 1)/ENOUGH : 1;
        std::vector<double> misses, lengths;
        int looked = 0;
        for (int m = 0; m < moments; m += step)
        {
            const std::vector<Balls> balls = inStep(m, camera, later);
            if (!mayShowWand(balls, camera))
                continue;
            const std::vector<WandPlace> places = WandFinder(rig, balls).places(wand_, limits);
            const auto best = std::min_element(places.begin(), places.end(), [camera](const WandPlace& p, const WandPlace& q) {
                return p.seenBy(camera) != q.seenBy(camera) ? p.seenBy(camera) : p.rms() < q.rms(); });
            looked++;
            if (best == places.end() || !best->seenBy(camera))
                continue;
            misses.push_back(best->rms());
            lengths.push_back(best->length()/wand_.length);
        }
        return (int)misses.size() < std::max(FEWEST, looked/2) ? Usual{NaN, NaN} : Usual{median(misses), median(lengths)};
    }

    WandMatches matches(const RigModel& rig, const WandLimits& limits) const
    {
        WandMatches found;
        found.moments = (int)seen_.moments.size();
        found.crowded = seen_.crowded;
        found.matches.pixels.resize(rig.cameras.size());
        found.matches.stds.resize(rig.cameras.size());
        for (int m = 0; m < found.moments; m++)
        {
            const std::vector<WandPlace> places = WandFinder(rig, seen_.balls[m]).places(wand_, limits);
            if (places.empty())
                (mayHaveWand(seen_.balls[m]) ? found.unfit : found.unseen)++;
            else if (places.size() > 1 && places[0].count() == places[1].count())
                found.unclear++;
            else
                add(m, places[0], found);
        }
        found.lengths.objects = 1;
        return found;
    }

private:
    std::vector<Balls> inStep(int moment, int camera, int later) const
    {
        std::vector<Balls> balls = clear_[moment];
        const int other = moment + later;
        balls[camera] = other < 0 || other >= (int)clear_.size() ? Balls() : clear_[other][camera];
        return balls;
    }

    void add(int moment, const WandPlace& place, WandMatches& found) const
    {
        const int first = (int)found.matches.names.size();
        for (const BallPoint* point : {&place.a, &place.b})
        {
            found.matches.names.push_back({seen_.moments[moment], point == &place.a ? "a" : "b"});
            for (size_t c = 0; c < point->balls.size(); c++)
            {
                const int ball = point->balls[c];
                found.matches.pixels[c].push_back(point->centers[c]);
                found.matches.stds[c].push_back(ball >= 0 ? seen_.balls[moment][c][ball].std : NaN);
            }
        }
        found.lengths.list.push_back({first, first + 1, wand_.length, wand_.std, 0});
    }

    const BallSightings& seen_;
    const Wand& wand_;
    std::vector<std::vector<Balls>> clear_;     //!< of a camera: where it sees two balls and no more, if these are enough
};

/** Throws Failure if the images of a camera fit far better so many moments later; the one that fits worst is looked at first, as it makes
others fit badly.
@param usual of each camera
@param mostLate images, that are tried both ways */
void requireInStep(const WandSearch& search, const RigModel& rig, const WandLimits& limits, const std::vector<WandSearch::Usual>& usual,
                   int mostLate)
{
    const double APART = 3., FAR_BETTER = 0.2;      // px; of the usual miss
    const auto missOf = [&](int camera) { return std::isnan(usual[camera].miss) ? INFINITY : usual[camera].miss; };
    std::vector<int> cameras(usual.size());
    std::iota(cameras.rbegin(), cameras.rend(), 0);
    std::stable_sort(cameras.begin(), cameras.end(), [&](int c, int k) { return missOf(c) > missOf(k); });
    for (const int c : cameras)
    {
        double least = FAR_BETTER*missOf(c);
        int best = 0;
        for (int later = -mostLate; later <= mostLate && missOf(c) >= APART; later++)
        {
            const double miss = later ? search.usual(rig, limits, c, later).miss : NaN;
            if (miss < least)
                least = miss, best = later;
        }
        if (best)
            throw Failure(format("the images of camera %d are of other moments than those of %s, which fit %d image%s %s: rays "
                                 "miss each other by %.2g px then, and by %s%.2g px as they are given", c + 1,
                                 usual.size() > 2 ? "the others" : "camera 1", std::abs(best), std::abs(best) == 1 ? "" : "s",
                                 best > 0 ? "later" : "earlier", least, std::isinf(missOf(c)) ? "more than " : "",
                                 std::min(missOf(c), limits.rms)));
    }
}

//! Px, by which rays may miss each other at a start of nominal values.
double widestMiss(const RigModel& rig)
{
    const double WIDE = 0.05;           // of an image
    int largest = 0;
    for (const Ptr<refract::RefractiveCamera>& camera : rig.cameras)
        largest = std::max({largest, camera->imageSize().width, camera->imageSize().height});
    return WIDE*largest;
}

void requireUnit(const std::vector<WandSearch::Usual>& usual, double tolerance, const std::string& path, const Wand& wand)
{
    for (const WandSearch::Usual& ofCamera : usual)
        if (std::abs(ofCamera.length - 1) > tolerance)
            throw Failure(format("with '%s' the balls are %.3g apart (median), and --wand says %g: is that in the unit of T, thickness and "
                                 "distance there?", path.c_str(), ofCamera.length*wand.length, wand.length));
}

//! Nothing where none is.
std::string crowdedText(int images)
{
    return images == 0 ? "" : format("; %d image%s more than %zu round things that move, of which those with the most contrast are looked "
                                     "at", images, images == 1 ? " has" : "s have", MOST_BALLS);
}

//! Of those that show a wand: in which a camera sees an end of it.
int momentsOf(const WandMatches& found, int camera)
{
    const std::vector<Point2d>& pixels = found.matches.pixels[camera];
    int count = 0;
    for (size_t i = 0; i + 1 < pixels.size(); i += 2)
        count += !std::isnan(pixels[i].x) || !std::isnan(pixels[i + 1].x);
    return count;
}

void requireEnough(const WandMatches& found, const std::string& path)
{
    const int fit = (int)found.matches.names.size()/2;
    if (fit < FEWEST || fit < found.unfit)
        throw Failure(format("only %d of %d moments show a wand, and %d and most are needed: in %d no two cameras see two balls, in %d no "
                             "two fit, in %d several do%s. Are the images of the cameras of '%s', in their order, and of one moment each?",
                             fit, found.moments, FEWEST, found.unseen, found.unfit, found.unclear, crowdedText(found.crowded).c_str(),
                             path.c_str()));
    for (size_t c = 0; c < found.matches.pixels.size(); c++)
    {
        const int sees = momentsOf(found, (int)c);
        if (sees < FEWEST)
            throw Failure(format("camera %zu sees the wand in %d of %d moments, and %d are needed: does it look where the others do, are "
                                 "its images of the same moments, and are its values in '%s' about right?", c + 1, sees, fit, FEWEST,
                                 path.c_str()));
    }
}

RigModel fittedTo(const BundleStart& start, const WandMatches& found)
{
    try
    {
        return adjustBundle(start, found.matches, found.lengths, true).fit.rig;
    }
    catch (const Failure& failure)
    {
        throw Failure(failure.what() + ("; " + textOf(found)));
    }
}

std::vector<WandSearch::Usual> usualOfAll(const WandSearch& search, const RigModel& rig, const WandLimits& limits)
{
    std::vector<WandSearch::Usual> usual;
    for (int c = 0; c < (int)rig.cameras.size(); c++)
        usual.push_back(search.usual(rig, limits, c));
    return usual;
}

//! @param usual of the start
WandMatches matchedFrom(const BundleStart& start, const std::string& path, const WandSearch& search, WandLimits limits,
                        std::vector<WandSearch::Usual> usual)
{
    const double LEAST[] = {1., 0.3}, TIMES[] = {3., 5.}, LENGTHS[] = {0.3, 0.1};
    RigModel rig = start.rig;
    WandMatches found;
    requireUnit(usual, LENGTHS[0], path, search.wand());
    for (int round : {0, 1})
    {
        double worst = 0.;
        for (const WandSearch::Usual& ofCamera : usual)
            worst = std::max(worst, std::isnan(ofCamera.miss) ? limits.rms : ofCamera.miss);
        limits = {std::min(std::max(LEAST[round], TIMES[round]*worst), limits.rms), LENGTHS[round]};
        found = search.matches(rig, limits);
        requireEnough(found, path);
        if (round == 0)
        {
            rig = fittedTo(start, found);
            usual = usualOfAll(search, rig, limits);
        }
    }
    return found;
}

} // namespace

Wand parseWand(const std::string& text)
{
    const double USUAL = 1e-3;
    const std::vector<double> numbers = parseNumbers(text, "--wand");
    if (numbers.empty() || numbers.size() > 2 || !(numbers[0] > 0) || !(numbers.back() > 0))
        throw Failure("--wand=" + text + ": LENGTH or LENGTH,STD is wanted, both more than 0: the distance between the centres of the "
                      "balls, and how well it is known");
    const Wand wand = {numbers[0], numbers.size() > 1 ? numbers[1] : USUAL*numbers[0]};
    if (wand.std >= wand.length/3)
        throw Failure("--wand=" + text + ": a length of that standard deviation is not known; are the two exchanged?");
    return wand;
}

BallSightings findBalls(const Calibration& calibration, std::vector<Frames>& cameras, bool quiet)
{
    const std::vector<Moment> moments = sharedMoments(cameras);
    if ((int)moments.size() < FEWEST)
        throw Failure(format("--wand: two cameras have images of %zu moments, and %d are needed, some dozens better", moments.size(),
                             FEWEST));
    std::vector<StillCamera> still;
    for (int c = 0; c < (int)cameras.size(); c++)
        still.push_back(stillCameraOf(cameras[c], calibration, c));
    BallSightings seen[2];              // bright, dark
    Progress progress("looking for balls", (int)moments.size(), quiet);
    for (const Moment& moment : moments)
    {
        progress.at(moment.stem);
        for (BallSightings& ofKind : seen)
        {
            ofKind.moments.push_back(moment.stem);
            ofKind.balls.emplace_back(cameras.size());
        }
        for (int c = 0; c < (int)cameras.size(); c++)
        {
            if (moment.frames[c] < 0)
                continue;
            const Mat image = greyFrame(cameras[c], moment.frames[c], calibration, c, still[c].white);
            for (int dark : {0, 1})
            {
                bool crowded;
                seen[dark].balls.back()[c] = ballsIn(image, still[c].background, !dark, &crowded);
                seen[dark].crowded += crowded;
            }
        }
        progress.step();
    }
    const BallSightings& result = seen[withWand(seen[1]) > withWand(seen[0])];
    if (withWand(result) < FEWEST)
        throw Failure(format("--wand: two cameras see two balls in %d of %zu moments, and %d are needed. What is looked for is round, 4 "
                             "pixels wide or more, brighter or darker than what is behind it, and moves from image to image%s",
                             withWand(result), moments.size(), FEWEST, crowdedText(result.crowded).c_str()));
    return result;
}

WandMatches matchWand(const BundleStart& start, const std::string& path, const BallSightings& seen, const Wand& wand)
{
    const WandSearch search(seen, wand);
    const WandLimits widest = {widestMiss(start.rig), INFINITY};
    const std::vector<WandSearch::Usual> usual = usualOfAll(search, start.rig, widest);
    requireInStep(search, start.rig, widest, usual, LATE);
    try
    {
        return matchedFrom(start, path, search, widest, usual);
    }
    catch (const Failure&)
    {
        requireInStep(search, start.rig, widest, usual, std::min(FAR_LATE, (int)seen.moments.size() - FEWEST));
        throw;
    }
}

std::string textOf(const WandMatches& found)
{
    std::string text = format("wand: %zu of %d moments", found.matches.names.size()/2, found.moments), out;
    const auto add = [&](int count, const char* why) { out += count ? format("%s%d %s", out.empty() ? "" : ", ", count, why) : ""; };
    add(found.unseen, "where two cameras do not see two balls");
    add(found.unfit, "where no two fit");
    add(found.unclear, "where several do");
    return text + (out.empty() ? "" : "; left out: " + out) + crowdedText(found.crowded);
}

Json jsonOf(const WandMatches& found)
{
    return {{"moments", found.moments}, {"moments_used", found.matches.names.size()/2}, {"moments_unseen", found.unseen},
            {"moments_unfit", found.unfit}, {"moments_unclear", found.unclear}, {"images_crowded", found.crowded}};
}

} // namespace tools
