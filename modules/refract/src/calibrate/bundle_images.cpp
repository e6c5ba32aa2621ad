// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

/* Which pixels a bundle adjustment is given, as images with the points that each of them shows. */

#include "calibrate/bundle_images.hpp"
#include "arrays/arrays.hpp"
#include "arrays/extrinsics.hpp"
#include "calibrate/fit_arguments.hpp"
#include <climits>
#include <numeric>
#include <tuple>

namespace cv { namespace refract {

std::vector<bool> BundleImages::seenViews() const
{
    std::vector<bool> all(views, false);
    for (const SceneImage& image : images)
        all[image.view] = true;
    return all;
}

std::vector<bool> BundleImages::seeingCameras() const
{
    std::vector<bool> all(cameras, false);
    for (const SceneImage& image : images)
        all[image.camera] = true;
    return all;
}

namespace {

void checkCameras(int cameras)
{
    if (cameras == 0)
        CV_Error(Error::StsBadArg, "cameras is empty; at least one is needed");
}

//! All images must have as many points, those of the scene.
int checkedPointCount(const std::vector<PixelViews>& pixels, int count)
{
    for (size_t c = 0; c < pixels.size(); c++)
    {
        if (pixels[c].size() != pixels[0].size() || pixels[c].empty())
            CV_Error_(Error::StsUnmatchedSizes, ("imagePoints[%d] has %d views, imagePoints[0] has %d; they must agree, with "
                                                 "at least one", (int)c, (int)pixels[c].size(), (int)pixels[0].size()));
        for (size_t view = 0; view < pixels[c].size(); view++)
        {
            const int own = (int)pixels[c][view].size();
            if (count == 0)
                count = own;
            if (own != 0 && own != count)
                CV_Error_(Error::StsUnmatchedSizes, ("imagePoints[%d][%d] has %d points, but the scene has %d; NaN stands for "
                                                     "those that are not seen", (int)c, (int)view, own, count));
        }
    }
    if (count == 0)
        CV_Error(Error::StsBadArg, "imagePoints has no point");
    return count;
}

//! One row of the list.
struct Listed
{
    int view, camera, point;
    bool operator<(const Listed& o) const
    { return std::tie(view, camera, point) < std::tie(o.view, o.camera, o.point); }
};

//! A whole number from 0 on, below a limit if there is one.
/** @param limit that the source says; 0: it says nothing
@param observations that there are: so many points, or views, may have one each */
int checkedIndex(double value, int i, const char* what, int limit, const char* source, int observations)
{
    const bool isIndex = value >= 0 && value == std::floor(value);
    if (isIndex && value < (limit > 0 ? limit : observations))
        return (int)value;
    if (isIndex && limit == 0)
        CV_Error_(Error::StsOutOfRange, ("observations[%d] is of %s %.0f, but %d observations are of %d at most; count from 0 without "
                                         "gaps, or give %s of as many as there are", i, what, value, observations, observations, source));
    if (limit > 0)
        CV_Error_(Error::StsOutOfRange, ("observations[%d] is of %s %g, but %s has %d, counted from 0", i, what, value, source, limit));
    CV_Error_(Error::StsOutOfRange, ("observations[%d] is of %s %g; it must be a whole number, counted from 0", i, what, value));
}

std::vector<Listed> readList(InputArray observations, int cameras, int views, int points)
{
    const Mat given = observations.getMat();
    if (given.empty())
        CV_Error(Error::StsBadArg, "observations is empty; at least one is needed");
    const bool isVector = given.channels() == 3 && (given.rows == 1 || given.cols == 1);
    if (given.dims > 2 || !(isVector || (given.channels() == 1 && given.cols == 3)))
        CV_Error_(Error::StsBadSize, ("observations is %dx%d with %d channels; it must be Nx3: view, camera, point", given.rows, given.cols,
                                      given.channels()));
    Mat_<double> rows;
    given.clone().reshape(1, isVector ? (int)given.total() : given.rows).convertTo(rows, CV_64F);
    std::vector<Listed> all;
    for (int i = 0; i < rows.rows; i++)
        all.push_back({ checkedIndex(rows(i, 0), i, "view", views, "rvecs", rows.rows),
                        checkedIndex(rows(i, 1), i, "camera", cameras, "cameras", rows.rows),
                        checkedIndex(rows(i, 2), i, "point", points, "points3D", rows.rows) });
    return all;
}

} // namespace

BundleImages denseImages(const std::vector<PixelViews>& pixels, int cameras, int points,
                         const std::vector<std::vector<Mat> >& covariances)
{
    checkCameras(cameras);
    checkCount(pixels.size(), cameras, "imagePoints", false);
    BundleImages all;
    all.cameras = cameras;
    all.views = (int)pixels[0].size();
    all.points = checkedPointCount(pixels, points);
    checkCount(covariances.size(), cameras, "pixelCovariances", true);
    std::vector<CovarianceViews> known;
    MedianVariance median;
    for (size_t c = 0; c < covariances.size(); c++)
    {
        known.push_back(readCovarianceViews(covariances[c], pixels[c], numbered("pixelCovariances", (int)c)));
        for (int view = 0; view < all.views; view++)
            median.add(pixels[c][view], known[c].empty() ? PixelCovariances() : known[c][view]);
    }
    all.variance = median();
    all.images = sceneImages(pixels, known, all.variance);
    return all;
}

BundleImages listedImages(InputArray observations, InputArray imagePoints, int cameras, int views, int points, InputArray covariances)
{
    checkCameras(cameras);
    const std::vector<Listed> list = readList(observations, cameras, views, points);
    const std::vector<Point2d> pixels = readPoints2(imagePoints, "imagePoints");
    const int count = (int)list.size();
    if ((int)pixels.size() != count)
        CV_Error_(Error::StsUnmatchedSizes, ("imagePoints has %d pixels, but observations has %d rows", (int)pixels.size(), count));
    const PixelCovariances known = readPixelCovariances(covariances, pixels, "pixelCovariances");
    MedianVariance median;
    if (!known.empty())
        median.add(pixels, known);
    BundleImages all;
    all.cameras = cameras;
    all.views = views;
    all.points = points;
    all.listed = count;
    all.variance = median();
    for (const Listed& o : list)
    {
        all.views = std::max(all.views, o.view + 1);
        all.points = std::max(all.points, o.point + 1);
    }
    std::vector<int> order(count);
    std::iota(order.begin(), order.end(), 0);
    std::stable_sort(order.begin(), order.end(), [&](int a, int b) { return list[a] < list[b]; });
    for (int begin = 0, end = 0; begin < count; begin = end)
    {
        const Listed& first = list[order[begin]];
        std::vector<Point2d> own;
        PixelCovariances ofOwn;
        for (; end < count && list[order[end]].view == first.view && list[order[end]].camera == first.camera; end++)
        {
            own.push_back(pixels[order[end]]);
            if (!known.empty())
                ofOwn.push_back(known[order[end]]);
        }
        SceneImage image = { first.view, first.camera, observed(std::vector<Point3d>(own.size()), own, ofOwn, all.variance) };
        if (image.points.pixel.empty())
            continue;
        std::vector<int> places;
        for (int& index : image.points.index)
        {
            places.push_back(order[begin + index]);
            index = list[places.back()].point;
        }
        all.places.push_back(places);
        all.images.push_back(image);
    }
    return all;
}

std::vector<Mat> denseMasks(const BundleImages& images, const Masks& isUsed)
{
    std::vector<Mat> masks(images.views*images.cameras);
    for (size_t i = 0; i < images.images.size(); i++)
    {
        const SceneImage& image = images.images[i];
        Mat mask(images.points, 1, CV_8U, Scalar(0));
        for (size_t k = 0; k < isUsed[i].size(); k++)
            mask.at<uchar>(image.points.index[k]) = isUsed[i][k];
        masks[image.view*images.cameras + image.camera] = mask;
    }
    return masks;
}

Mat listedMask(const BundleImages& images, const Masks& isUsed)
{
    Mat mask(images.listed, 1, CV_8U, Scalar(0));
    for (size_t i = 0; i < isUsed.size(); i++)
        for (size_t k = 0; k < isUsed[i].size(); k++)
            mask.at<uchar>(images.places[i][k]) = isUsed[i][k];
    return mask;
}

}} // namespace
