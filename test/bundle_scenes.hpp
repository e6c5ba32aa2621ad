// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

// Seeded scenes without a target: a rig that stands still and sees a wand, or a rig that moves through points.
#ifndef REFRACT_TEST_BUNDLE_SCENES_HPP
#define REFRACT_TEST_BUNDLE_SCENES_HPP

#include "cramer_rao.hpp"
#include "rig_scenes.hpp"

namespace scenes {

//! What a rig sees of points that nobody knows: [camera][view][point].
struct BundleScene
{
    std::vector<cv::Point3d> points;        //!< frame of the scene
    std::vector<cv::Vec3d> rvecs, tvecs;    //!< scene -> camera 1
    std::vector<PixelViews> pixels;
    std::vector<cv::Vec4d> lengths;
};

//! Pixels of the scene's points in all images; one in so many is not seen, outside the image none.
inline void look(const RigTruth& rig, Random& random, double sigma, double missing, BundleScene& scene,
                 cv::Size image = cv::Size(1280, 1024))
{
    scene.pixels.assign(rig.cameras.size(), PixelViews());
    for (size_t c = 0; c < rig.cameras.size(); c++)
        for (size_t view = 0; view < scene.rvecs.size(); view++)
        {
            cv::Matx33d R;
            cv::Vec3d rvec;
            cv::Rodrigues(scene.rvecs[view], R);
            cv::Rodrigues(rig.Rs[c]*R, rvec);
            std::vector<cv::Point2d> pixels;
            cv::Mat status;
            cv::refract::refractiveProjectPoints(scene.points, rvec, rig.Rs[c]*scene.tvecs[view] + rig.Ts[c], rig.cameras[c],
                                                 pixels, status);
            for (cv::Point2d& p : pixels)
            {
                const bool isInside = p.x > 0 && p.y > 0 && p.x < image.width && p.y < image.height;
                const cv::Point2d noise(random.normal(sigma), random.normal(sigma));
                p = isInside && random.uniform(0, 1) >= missing ? p + noise : cv::Point2d(NaN, NaN);
            }
            scene.pixels[c].push_back(pixels);
        }
}

const double WAND = 120, WAND_SIGMA = 0.02;

//! A wand waved through the volume that the rig looks at, its length measured to WAND_SIGMA.
inline BundleScene makeWandScene(const RigTruth& rig, int moments, Random& random, double sigma, double missing = 0)
{
    BundleScene scene;
    for (int moment = 0; moment < moments; moment++)
    {
        const cv::Vec3d middle(random.uniform(-60, 60), random.uniform(-50, 50), random.uniform(560, 680));
        const cv::Vec3d along = WAND/2*randomNormal(random, 180);
        scene.points.push_back(cv::Point3d(middle + along));
        scene.points.push_back(cv::Point3d(middle - along));
        scene.lengths.push_back({ 2.*moment, 2.*moment + 1, WAND + random.normal(sigma > 0 ? WAND_SIGMA : 0), WAND_SIGMA });
    }
    scene.rvecs = scene.tvecs = { cv::Vec3d() };
    look(rig, random, sigma, missing, scene);
    return scene;
}

//! A rig that moves through a static scene, one distance in which is known.
inline BundleScene makeMovingScene(const RigTruth& rig, int views, int points, Random& random, double sigma, double missing = 0)
{
    BundleScene scene;
    for (int i = 0; i < points; i++)
        scene.points.push_back({ random.uniform(-90, 90), random.uniform(-75, 75), random.uniform(-60, 60) });
    scene.points[0] = cv::Point3d(-70, -20, 10);
    scene.points[1] = cv::Point3d(60, 30, -20);
    for (int view = 0; view < views; view++)
    {
        const cv::Vec3d axis = cv::normalize(cv::Vec3d(random.normal(1), random.normal(1), 0.5*random.normal(1)));
        scene.rvecs.push_back(view == 0 ? cv::Vec3d() : axis*random.uniform(0.1, 0.5));
        scene.tvecs.push_back({ random.uniform(-20, 20), random.uniform(-20, 20), random.uniform(580, 660) });
    }
    const double length = cv::norm(scene.points[0] - scene.points[1]);
    scene.lengths.push_back({ 0, 1, length + random.normal(sigma > 0 ? WAND_SIGMA : 0), WAND_SIGMA });
    look(rig, random, sigma, missing, scene);
    return scene;
}

//! Points that any image misses are left out altogether: the dense bound has no place for them.
inline void keepWhatAllSee(BundleScene& scene)
{
    std::vector<int> place(scene.points.size(), -1);
    BundleScene kept = scene;
    kept.points.clear();
    kept.lengths.clear();
    for (PixelViews& views : kept.pixels)
        for (std::vector<cv::Point2d>& pixels : views)
            pixels.clear();
    for (size_t i = 0; i < scene.points.size(); i++)
    {
        bool isSeen = true;
        for (const PixelViews& views : scene.pixels)
            for (const std::vector<cv::Point2d>& pixels : views)
                isSeen = isSeen && !std::isnan(pixels[i].x);
        if (!isSeen)
            continue;
        place[i] = (int)kept.points.size();
        kept.points.push_back(scene.points[i]);
        for (size_t c = 0; c < scene.pixels.size(); c++)
            for (size_t view = 0; view < scene.pixels[c].size(); view++)
                kept.pixels[c][view].push_back(scene.pixels[c][view][i]);
    }
    for (const cv::Vec4d& l : scene.lengths)
        if (place[(int)l[0]] >= 0 && place[(int)l[1]] >= 0)
            kept.lengths.push_back({ (double)place[(int)l[0]], (double)place[(int)l[1]], l[2], l[3] });
    scene = kept;
}

/** Arguments and results of one call. The start: the true lens; windows that look straight ahead, at so much of their distance;
R, T and the poses off by so many degrees and hundredths of the range, but for the first pose, which stays. off 0: the truth. */
struct BundleCall : cv::refract::BundleAdjustResult
{
    BundleCall(const RigTruth& rig, const BundleScene& scene, Random& random, double off = 1, double distance = 1)
        : lengths(scene.lengths), windows(rig.windows)
    {
        const auto turned = [&](const cv::Vec3d& rvec) { return rvec + random.vector(off*CV_PI/180); };
        for (size_t c = 0; c < rig.cameras.size(); c++)
        {
            GlassWindow window = rig.cameras[c]->window();
            if (off > 0)
                window.normal = cv::Vec3d(0, 0, 1);
            window.distance *= distance;
            cameras.push_back(RefractiveCamera::create(rig.cameras[c]->cameraMatrix(), rig.cameras[c]->distCoeffs(), window));
            cv::Vec3d rvec;
            cv::Rodrigues(rig.Rs[c], rvec);
            cv::Mat R;
            cv::Rodrigues(c == 0 ? rvec : turned(rvec), R);
            Rs.push_back(R);
            Ts.push_back(cv::Mat(c == 0 ? rig.Ts[c] : rig.Ts[c] + random.vector(6*off), true));
            images.push_back(RigCall::mats(scene.pixels[c]));
        }
        for (size_t view = 0; view < scene.rvecs.size(); view++)
        {
            rvecs.push_back(cv::Mat(view == 0 ? scene.rvecs[view] : turned(scene.rvecs[view]), true));
            tvecs.push_back(cv::Mat(view == 0 ? scene.tvecs[view] : scene.tvecs[view] + random.vector(6*off), true));
        }
    }

    double run(const cv::refract::BundleAdjustOptions& options)
    {
        static_cast<cv::refract::BundleAdjustResult&>(*this) =
            cv::refract::refractiveBundleAdjust(images, cameras, windows, Rs, Ts, rvecs, tvecs, points, lengths, options);
        return rms;
    }

    //! With what is known of the rig, and of an error that all lengths share.
    double run(const cv::Mat& rigCovariance, double lengthScaleStd, int flags)
    {
        cv::refract::BundleAdjustOptions options(flags);
        options.poseCovariances = poseCovariances;
        options.rigCovariance = rigCovariance;
        options.lengthScaleStd = lengthScaleStd;
        return run(options);
    }

    double run(int flags) { return run(cv::Mat(), 0, flags); }

    std::vector<std::vector<cv::Mat> > images;
    std::vector<cv::Vec4d> lengths;
    std::vector<cv::Ptr<RefractiveCamera> > cameras;
    std::vector<int> windows;
    std::vector<cv::Mat> Rs, Ts, rvecs, tvecs, poseCovariances;
    std::vector<cv::Point3d> points;
};

/** The Cramer-Rao bound from refractiveProjectPoints' derivatives alone: covariance of all cameras' windows (in the order of
parameterNames, lens left out) and of Rs, Ts, for pixels with a standard deviation sigma, poses and points unknown. Dense: for
small scenes without noise. Each camera has its own window. */
class BundleBound
{
public:
    enum What { NORMAL = 1, DISTANCE = 2, THICKNESS = 4, EXTRINSICS = 8 };

    BundleBound(const RigTruth& rig, const BundleScene& scene, int free, double sigma);

    //! Of the normal's angle (mean of its two directions, radians), the distance, the first layer's thickness of camera c.
    double normal(int c) const { return std::sqrt((at(firstOfCamera(c)) + at(firstOfCamera(c) + 1))/2); }
    double distance(int c) const { return std::sqrt(at(firstOfCamera(c) + 2)); }
    double thickness(int c) const { return std::sqrt(at(firstOfCamera(c) + 2 + ((free_ & DISTANCE) ? 1 : 0))); }
    //! Covariance of camera c's normal in its tangents and, if free, its distance and thickness.
    cv::Mat ofCamera(int c) const
    { return covariance_(cv::Rect(firstOfCamera(c), firstOfCamera(c), perCamera_, perCamera_)).clone(); }
    //! Standard deviation of a coordinate of a point; of a coordinate of T of camera c > 0.
    double point(int i, int coordinate) const { return std::sqrt(at(firstPoint_ + 3*i + coordinate)); }
    double translation(int c, int coordinate) const { return std::sqrt(at(firstExtrinsics_ + 6*(c - 1) + 3 + coordinate)); }

private:
    double at(int i) const { return covariance_.at<double>(i, i); }
    int firstOfCamera(int c) const { return c*perCamera_; }
    const int free_;
    int perCamera_, firstExtrinsics_, firstPoint_;
    cv::Mat covariance_;
};

inline BundleBound::BundleBound(const RigTruth& rig, const BundleScene& scene, int free, double sigma) : free_(free)
{
    const int cameras = (int)rig.cameras.size(), views = (int)scene.rvecs.size(), points = (int)scene.points.size();
    perCamera_ = ((free & NORMAL) ? 2 : 0) + ((free & DISTANCE) ? 1 : 0) + ((free & THICKNESS) ? 1 : 0);
    const int extrinsics = cameras*perCamera_, poses = extrinsics + ((free & EXTRINSICS) ? 6*(cameras - 1) : 0);
    const int scenePoints = poses + 6*(views - 1), count = scenePoints + 3*points;
    firstExtrinsics_ = extrinsics;
    firstPoint_ = scenePoints;
    cv::Mat information = cv::Mat::zeros(count, count, CV_64F);
    for (int c = 0; c < cameras; c++)
        for (int view = 0; view < views; view++)
        {
            // Derivatives by the camera's own frame, then by what moves it.
            cv::Matx33d Rv;
            cv::Rodrigues(scene.rvecs[view], Rv);
            cv::Mat dRc, dRv;
            cv::Vec3d rc;
            cv::Rodrigues(rig.Rs[c], rc);
            cv::Matx33d unused;
            cv::Rodrigues(rc, unused, dRc);             // 3x9, a row for each component of the vector
            cv::Rodrigues(scene.rvecs[view], unused, dRv);
            std::vector<cv::Point3d> inCamera, inCamera1;
            for (const cv::Point3d& X : scene.points)
            {
                inCamera1.push_back(cv::Point3d(Rv*cv::Vec3d(X) + scene.tvecs[view]));
                inCamera.push_back(cv::Point3d(rig.Rs[c]*cv::Vec3d(inCamera1.back()) + rig.Ts[c]));
            }
            cv::Mat pixels, status, J;
            cv::refract::refractiveProjectPoints(inCamera, cv::Vec3d(), cv::Vec3d(), rig.cameras[c], pixels, status, J);
            const int lens = rig.cameras[c]->lensParameters().rows, layers = (int)rig.cameras[c]->window().thickness.size();
            CV_Assert(J.cols == 6 + lens + 4 + 2*layers + 2);
            const cv::Mat tangents(tangentsOf(rig.cameras[c]->window().normal));
            for (int i = 0; i < points; i++)
            {
                if (std::isnan(scene.pixels[c][view][i].x))
                    continue;
                const cv::Mat rows = J.rowRange(2*i, 2*i + 2), byPoint = rows.colRange(3, 6);
                cv::Mat row = cv::Mat::zeros(2, count, CV_64F);
                const auto put = [&](int column, const cv::Mat& values)
                { values.copyTo(row(cv::Rect(column, 0, values.cols, 2))); };
                int column = firstOfCamera(c);
                if (free & NORMAL)
                {
                    put(column, rows.colRange(6 + lens, 6 + lens + 3)*tangents);
                    column += 2;
                }
                if (free & DISTANCE)
                    put(column++, rows.col(6 + lens + 3));
                if (free & THICKNESS)
                    put(column++, rows.col(6 + lens + 4));
                const auto byRotation = [&](const cv::Mat& dR, const cv::Vec3d& X, int first, const cv::Mat& by)
                {
                    for (int k = 0; k < 3; k++)
                        put(first + k, by*(dR.row(k).clone().reshape(1, 3)*cv::Mat(X)));
                };
                if ((free & EXTRINSICS) && c > 0)
                {
                    byRotation(dRc, inCamera1[i], extrinsics + 6*(c - 1), byPoint);
                    put(extrinsics + 6*(c - 1) + 3, byPoint);
                }
                const cv::Mat by1 = byPoint*cv::Mat(rig.Rs[c]);
                if (view > 0)
                {
                    byRotation(dRv, scene.points[i], poses + 6*(view - 1), by1);
                    put(poses + 6*(view - 1) + 3, by1);
                }
                put(scenePoints + 3*i, by1*cv::Mat(Rv));
                information += row.t()*row/(sigma*sigma);
            }
        }
    for (const cv::Vec4d& length : scene.lengths)
    {
        const int a = (int)length[0], b = (int)length[1];
        const cv::Vec3d along = cv::normalize(cv::Vec3d(scene.points[a] - scene.points[b]))/length[3];
        cv::Mat row = cv::Mat::zeros(1, count, CV_64F);
        cv::Mat(along.t()).copyTo(row(cv::Rect(scenePoints + 3*a, 0, 3, 1)));
        cv::Mat(-along.t()).copyTo(row(cv::Rect(scenePoints + 3*b, 0, 3, 1)));
        information += row.t()*row;
    }
    cv::Mat scale;
    cv::sqrt(information.diag(), scale);
    const cv::Mat both = scale*scale.t();
    covariance_ = cv::Mat(cv::Mat(information/both).inv(cv::DECOMP_CHOLESKY))/both;
}

} // namespace scenes

#endif // REFRACT_TEST_BUNDLE_SCENES_HPP
