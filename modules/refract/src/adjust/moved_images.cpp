// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

/* A target that was moved between the images of a view.

The view's one pose against a pose of its own for each image: the gain in squared errors is chi^2 with 6 degrees of freedom
per further image where nothing moved. Views are judged against the median view as well, as a wrong constant (thickness,
index) moves all of them. */

#include "adjust/moved_images.hpp"
#include "math/robust_scale.hpp"

namespace cv { namespace refract {

namespace {

//! Quantile of chi^2 (@cite WilsonHilferty1931).
double chiSquareQuantile(double normalQuantile, int freedom)
{
    const double a = 2./(9*freedom);
    return freedom*std::pow(1 - a + normalQuantile*std::sqrt(a), 3);
}

//! The pose, object -> camera 1, that one image alone tells.
Pose ownPose(const Rig& rig, const Image& image)
{
    const Camera& behindWindow = rig.cameras[image.camera];
    const Camera camera = image.refracted ? behindWindow : withWindow(behindWindow);
    double rms;
    const std::vector<Point2d> inliers = pointsOfOnePose(camera, image.points.object, image.points.pixel);
    const Pose pose = solvePose(camera, image.points.object, inliers, Pose(), rms);
    return pose.found ? inCamera1(pose, rig.extrinsics[image.camera]) : pose;
}

class MovedImages
{
public:
    MovedImages(Problem& rig, double scale) : problem_(rig), rig_(rig.rig()), scale_(scale) {}

    std::vector<int> find();

private:
    //! Images of one view.
    struct View
    {
        std::vector<int> images;
        std::vector<Pose> own;          //!< of each
        double gain;                    //!< see gainOfOwnPoses
        int freedom() const { return 6*((int)images.size() - 1); }
    };

    const Image& image(int i) const { return problem_.images()[i]; }
    std::vector<View> viewsOfSeveral() const;
    double gainOfOwnPoses(const View& view) const;
    double cutSum(const Image& image, const Pose& pose) const;
    std::vector<int> minorityOf(const View& view);
    std::vector<bool> agreement(const View& view, const Pose& pose) const;

    Problem& problem_;
    const Rig rig_;
    const double scale_;
};

//! Sum of squares, each cut off.
double MovedImages::cutSum(const Image& image, const Pose& pose) const
{
    double sum = 0;
    for (double r : problem_.pixelErrors(image, pose))
        sum += std::pow(std::min(r, CUT*scale_), 2);
    return sum;
}

//! How much smaller the sum of squares of a view is, in variances, if every image has its own pose.
double MovedImages::gainOfOwnPoses(const View& view) const
{
    double gain = 0;
    for (size_t k = 0; k < view.images.size(); k++)
    {
        const Image& seen = image(view.images[k]);
        if (view.own[k].found)
            gain += cutSum(seen, problem_.pose(seen.view)) - cutSum(seen, view.own[k]);
    }
    return gain/(scale_*scale_);
}

std::vector<MovedImages::View> MovedImages::viewsOfSeveral() const
{
    std::vector<View> views;
    for (int v = 0; v < problem_.viewCount(); v++)
    {
        View view = { problem_.imagesOf(v), std::vector<Pose>(), 0 };
        if (view.images.size() < 2)
            continue;
        for (int i : view.images)
            view.own.push_back(problem_.inDirectImages(image(i), ownPose(rig_, image(i))));
        view.gain = gainOfOwnPoses(view);
        views.push_back(view);
    }
    return views;
}

//! Which images of the view the pose of one of them fits, but for what its own uncertainty does.
std::vector<bool> MovedImages::agreement(const View& view, const Pose& pose) const
{
    const double LENIENT = 8;
    std::vector<bool> agrees;
    for (int i : view.images)
        agrees.push_back(pose.found && median(problem_.pixelErrors(image(i), pose)) < LENIENT*scale_);
    return agrees;
}

/** All but the largest group of images that agree; of two equal ones that with more images through the window stays, as
only these tell of it. If no group stands out, the direct images. */
std::vector<int> MovedImages::minorityOf(const View& view)
{
    std::vector<bool> kept(view.images.size(), true);
    double best = 0;
    for (const Pose& pose : view.own)
    {
        const std::vector<bool> agrees = agreement(view, pose);
        double support = (double)std::count(agrees.begin(), agrees.end(), true);
        for (size_t k = 0; k < view.images.size(); k++)
            support += agrees[k] && image(view.images[k]).refracted ? 0.01 : 0;
        if (support <= best)
            continue;
        best = support;
        kept = agrees;
        problem_.setPose(image(view.images[0]).view, pose);
    }
    const bool tellsApart = std::count(kept.begin(), kept.end(), false) > 0;
    std::vector<int> moved;
    for (size_t k = 0; k < view.images.size(); k++)
        if (tellsApart ? !kept[k] : !image(view.images[k]).refracted)
            moved.push_back(view.images[k]);
    return moved;
}

std::vector<int> MovedImages::find()
{
    std::vector<int> moved;
    const std::vector<View> views = viewsOfSeveral();
    const size_t FEWEST = 3;        // views, to tell what is usual
    if (views.size() < FEWEST)
        return moved;
    std::vector<double> perFreedom;
    for (const View& view : views)
        perFreedom.push_back(view.gain/view.freedom());
    const double usual = std::max(1., median(perFreedom)), quantile = 4.5;      // of the normal: 3e-6
    for (const View& view : views)
        if (view.gain > usual*chiSquareQuantile(quantile, view.freedom()))
        {
            const std::vector<int> minority = minorityOf(view);
            moved.insert(moved.end(), minority.begin(), minority.end());
        }
    return moved;
}

} // namespace

std::vector<int> findMovedImages(Problem& rig, double scale)
{
    return MovedImages(rig, scale).find();
}

}} // namespace
