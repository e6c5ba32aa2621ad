// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

/* Relative pose from matches of which some are wrong. The search, on a part of the matches where there are many, begins with
pinholes' poses (central_pose.hpp), and is followed by a fit of all inliers. The scale shows only in how the rays miss the pinholes;
what is known of it is the likelihood's profile (length_profile.hpp).

Of a flat scene the likelihood has two minima far apart, equal without windows. So it is followed from each start that leads
elsewhere, and where two ends are as likely there is no answer. */

#include "pose/central_pose.hpp"
#include "pose/a_contrario.hpp"
#include "pose/pose_covariance.hpp"
#include "pose/relative_estimate.hpp"
#include "pose/relative_search.hpp"
#include "arrays/arrays.hpp"
#include "arrays/views.hpp"
#include <array>
#include <map>

namespace cv { namespace refract {

namespace {

const double NaN = std::numeric_limits<double>::quiet_NaN();

//! How likely uniformly random matches agree with a pose of five of them: the other pixel lies in a strip along the curve.
Sampling samplingOf(const std::vector<Point2d>& pixels2, double limit)
{
    const double POSES = 4;                 // of a sample, on average
    const Size2d extent = extentOf(pixels2);
    const double strip = 2*std::sqrt(2.)*limit*std::hypot(extent.width, extent.height);
    return { 5, POSES, strip/std::max(extent.area(), DBL_MIN) };
}

bool recover(const Camera& camera1, const Camera& camera2, const MatchedPixels& pixels, double prob, double threshold, RelativeEstimate& e)
{
    const PixelMatches matches = matchesOf(camera1, camera2, pixels), sample = sampleOf(matches);
    std::vector<Point2d> sample1, sample2;
    for (const Match& m : sample)
    {
        sample1.push_back(m.pixel1);
        sample2.push_back(m.pixel2);
    }
    const Bearings b1 = bearingsOf(camera1, sample1), b2 = bearingsOf(camera2, sample2);
    const MatchedCameras pair = { camera1, camera2, b1.centre, b2.centre };
    const std::vector<Consensus> places = placesOf(pair, sample, threshold,
                                                   centralPoses(b1, b2, threshold/camera1.lens().parameters()[0], prob));
    size_t most = 0;
    for (const Consensus& place : places)
        most = std::max(most, place.inliers.size());
    std::vector<RelativeEstimate> estimates;
    for (const Consensus& place : places)
    {
        RelativeEstimate here;
        if (2*place.inliers.size() >= most && estimateRelativePose(pair, matches, threshold, place.motion, here))
            estimates.push_back(here);
    }
    if (estimates.empty())
        return false;
    const auto best = std::min_element(estimates.begin(), estimates.end(),
                                       [](const RelativeEstimate& a, const RelativeEstimate& b) { return a.cost() < b.cost(); });
    e = *best;
    return !isExplainedByChance((int)matches.size(), (int)e.inliers.size(), samplingOf(pixels.second, threshold))
           && std::none_of(estimates.begin(), estimates.end(), [&](const RelativeEstimate& other)
                           { return &other != &*best && isAmbiguous(pair, matches, e, other); });
}

} // namespace

/** Those that both cameras saw, each once: a copy tells nothing.
@param index of each, in the result; of one that was not seen: the result's size */
static MatchedPixels differentMatches(const std::vector<Point2d>& all1, const std::vector<Point2d>& all2, std::vector<int>& index)
{
    MatchedPixels matches;
    std::map<std::array<double, 4>, int> known;
    for (size_t i = 0; i < all1.size(); i++)
    {
        index.push_back(-1);
        if (!isWhole(all1[i]) || !isWhole(all2[i]))
            continue;
        const auto entry = known.insert({ { { all1[i].x, all1[i].y, all2[i].x, all2[i].y } }, (int)matches.first.size() });
        index.back() = entry.first->second;
        if (!entry.second)
            continue;
        matches.first.push_back(all1[i]);
        matches.second.push_back(all2[i]);
    }
    std::replace(index.begin(), index.end(), -1, (int)matches.first.size());
    return matches;
}

static void readCameraCovariances(InputArrayOfArrays given, const Camera& camera1, const Camera& camera2, Mat (&covariances)[2])
{
    if (given.empty())
        return;
    std::vector<Mat> all;
    given.getMatVector(all);
    if (all.size() != 2)
        CV_Error_(Error::StsUnmatchedSizes, ("cameraCovariances has %d matrices; it must be one for each of the 2 cameras",
                                             (int)all.size()));
    covariances[0] = readCameraCovariance(all[0], camera1, "cameraCovariances[0]");
    covariances[1] = readCameraCovariance(all[1], camera2, "cameraCovariances[1]");
}

static int recoverPose(InputArray points1, InputArray points2, const Ptr<RefractiveCamera>& camera1,
                       const Ptr<RefractiveCamera>& camera2, OutputArray R, OutputArray T, double prob, double threshold,
                       OutputArray mask, InputArrayOfArrays cameraCovariances, RelativeEstimate& e)
{
    const Camera &c1 = cameraOf(camera1, "camera1"), &c2 = cameraOf(camera2, "camera2");
    const std::vector<Point2d> all1 = readPoints2(points1, "points1"), all2 = readPoints2(points2, "points2");
    const int count = (int)all1.size();
    if (all1.size() != all2.size())
        CV_Error_(Error::StsUnmatchedSizes, ("points1 has %d points, points2 %d; they must agree", count, (int)all2.size()));
    if (count == 0)
    {
        mask.release();
        return 0;
    }
    if (count < 6)
        CV_Error_(Error::StsBadArg, ("points1 has %d points; a relative pose needs at least 6", count));
    if (!(prob > 0 && prob < 1))
        CV_Error_(Error::StsOutOfRange, ("prob is %g; it must lie between 0 and 1", prob));
    if (!(threshold > 0) || !std::isfinite(threshold))
        CV_Error_(Error::StsOutOfRange, ("threshold is %g; it must be positive", threshold));
    Mat covariances[2];
    readCameraCovariances(cameraCovariances, c1, c2, covariances);
    std::vector<int> index;
    const MatchedPixels matches = differentMatches(all1, all2, index);
    const bool found = recover(c1, c2, matches, prob, threshold, e);
    if (found && !cameraCovariances.empty())
        addCameras(c1, c2, matches, covariances, e);
    std::vector<uchar> chosen(matches.first.size() + 1, 0);           // the last: what was not seen
    for (size_t i = 0; found && i < e.inliers.size(); i++)
        chosen[e.inliers[i]] = 1;
    Mat isInlier(count, 1, CV_8U);
    for (int i = 0; i < count; i++)
        isInlier.at<uchar>(i) = chosen[index[i]];
    if (mask.needed())
        isInlier.copyTo(mask);
    if (!found)
        return 0;
    Mat(e.motion.R).copyTo(R);
    Mat(e.motion.t).copyTo(T);
    return countNonZero(isInlier);
}

int refractiveRecoverPose(InputArray points1, InputArray points2, const Ptr<RefractiveCamera>& camera1,
                          const Ptr<RefractiveCamera>& camera2, OutputArray R, OutputArray T, double prob, double threshold,
                          OutputArray mask)
{
    CV_INSTRUMENT_REGION();

    RelativeEstimate e;
    return recoverPose(points1, points2, camera1, camera2, R, T, prob, threshold, mask, noArray(), e);
}

int refractiveRecoverPose(InputArray points1, InputArray points2, InputArray cameraMatrix1, InputArray distCoeffs1,
                          const GlassWindow& window1, InputArray cameraMatrix2, InputArray distCoeffs2,
                          const GlassWindow& window2, OutputArray R, OutputArray T, double prob, double threshold,
                          OutputArray mask)
{
    CV_INSTRUMENT_REGION();

    return refractiveRecoverPose(points1, points2, RefractiveCamera::create(cameraMatrix1, distCoeffs1, window1),
                                 RefractiveCamera::create(cameraMatrix2, distCoeffs2, window2), R, T, prob, threshold, mask);
}

int refractiveRecoverPose(InputArray points1, InputArray points2, const Ptr<RefractiveCamera>& camera1,
                          const Ptr<RefractiveCamera>& camera2, OutputArray R, OutputArray T, double prob, double threshold,
                          OutputArray mask, OutputArray covariance, Vec2d& scaleInterval, InputArrayOfArrays cameraCovariances)
{
    CV_INSTRUMENT_REGION();

    RelativeEstimate e;
    const int count = recoverPose(points1, points2, camera1, camera2, R, T, prob, threshold, mask, cameraCovariances, e);
    scaleInterval = count > 0 ? e.interval : Vec2d(NaN, NaN);
    if (covariance.needed())
        Mat(count > 0 ? e.covariance : Matx66d::all(NaN)).copyTo(covariance);
    return count;
}

}} // namespace
