// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

// Seeded scenes of several cameras, and calibrateGlassRig's many arguments in one place.
#ifndef REFRACT_TEST_RIG_SCENES_HPP
#define REFRACT_TEST_RIG_SCENES_HPP

#include "calibration_scenes.hpp"

namespace scenes {

struct RigTruth
{
    std::vector<cv::Ptr<RefractiveCamera> > cameras;
    std::vector<int> windows;
    std::vector<cv::Matx33d> Rs;
    std::vector<cv::Vec3d> Ts;
};

/** Cameras on an arc about the target, so many radians apart, each behind a window of its own tilt; equal numbers in windows
share that of their first camera. */
inline RigTruth makeRig(int count, const std::vector<int>& windows, double outerIndex, double apart = 0.2)
{
    RigTruth rig;
    rig.windows = windows;
    for (int c = 0; c < count; c++)
    {
        const double turn = apart*c, part = apart*c/0.2;
        cv::Matx33d R;
        cv::Rodrigues(cv::Vec3d(0.02*part, turn, 0.01*part), R);
        rig.Rs.push_back(R);
        rig.Ts.push_back(cv::Vec3d(0, 0, 610) - R*cv::Vec3d(0, 0, 610) + cv::Vec3d(3, -2, 5)*part);
        GlassWindow window = paper::pane(80 + 10*part, { -0.2 + 0.08*part, 0.1 - 0.05*part, 1 }, outerIndex);
        const int owner = (int)(std::find(windows.begin(), windows.end(), windows[c]) - windows.begin());
        if (owner < c)
        {
            window = rig.cameras[owner]->window();
            const cv::Vec3d normal1 = rig.Rs[owner].t()*window.normal;
            window.distance -= window.normal.dot(rig.Ts[owner]);
            window.normal = R*normal1;
            window.distance += window.normal.dot(rig.Ts[c]);
        }
        rig.cameras.push_back(paperCamera(window));
    }
    return rig;
}

//! The paper's: two cameras behind differently tilted windows.
inline RigTruth paperStereo()
{
    RigTruth rig;
    rig.windows = { 0, 1 };
    rig.Rs = { cv::Matx33d::eye(), paper::rotation() };
    rig.Ts = { cv::Vec3d(), paper::T };
    rig.cameras = { paperCamera(paper::pane()),
                    RefractiveCamera::create(paper::K2, paper::D2, paper::pane(40, paper::NORMAL2)) };
    return rig;
}

//! How images are taken, and what of it is estimated.
struct Flow
{
    const char* name;
    int cameras;
    bool shared, paired;        //!< one window for all cameras; pairs or hand-held
    double outerIndex;
    int views, flags;
};

//! What all cameras see: [camera][view].
struct RigScene
{
    ObjectViews object;
    std::vector<PixelViews> refracted, direct;
    std::vector<cv::Vec3d> rvecs, tvecs;
};

inline RigScene makeRigScene(const RigTruth& rig, const ObjectViews& targets, Random& random, double sigma,
                             double near = 560, double far = 660)
{
    const CalibrationScene first = makeScene(rig.cameras[0], targets, random, sigma, near, far);
    RigScene scene;
    scene.object = first.object;
    scene.rvecs = first.rvecs;
    scene.tvecs = first.tvecs;
    scene.refracted.push_back(first.refracted);
    scene.direct.push_back(first.direct);
    for (size_t c = 1; c < rig.cameras.size(); c++)
    {
        const cv::Ptr<RefractiveCamera> bare = RefractiveCamera::create(rig.cameras[c]->cameraMatrix(),
                                                                        rig.cameras[c]->distCoeffs());
        scene.refracted.push_back(PixelViews());
        scene.direct.push_back(PixelViews());
        for (size_t view = 0; view < targets.size(); view++)
        {
            cv::Matx33d R;
            cv::Vec3d rvec;
            cv::Rodrigues(first.rvecs[view], R);
            cv::Rodrigues(rig.Rs[c]*R, rvec);
            const cv::Vec3d tvec = rig.Rs[c]*first.tvecs[view] + rig.Ts[c];
            scene.refracted[c].push_back(seen(targets[view], rvec, tvec, rig.cameras[c], random, sigma));
            scene.direct[c].push_back(seen(targets[view], rvec, tvec, bare, random, sigma));
        }
    }
    return scene;
}

inline RigScene makeRigScene(const RigTruth& rig, int views, Random& random, double sigma)
{
    return makeRigScene(rig, ObjectViews(views, board()), random, sigma);
}

//! The rig and what it sees, of the first camera only.
inline void keepFirst(RigTruth& rig, RigScene& scene)
{
    rig.cameras.resize(1);
    rig.windows.resize(1);
    rig.Rs.resize(1);
    rig.Ts.resize(1);
    scene.refracted.resize(1);
    scene.direct.resize(1);
}

inline std::vector<cv::Mat> vectorsOf(const std::vector<cv::Vec3d>& vectors)
{
    std::vector<cv::Mat> mats;
    for (const cv::Vec3d& v : vectors)
        mats.push_back(cv::Mat(v, true));
    return mats;
}

/** Arguments and results of one call. The start: the true lens, R and T; windows that look straight ahead, at nine tenths of
their distance. */
struct RigCall : cv::refract::GlassRigResult
{
    RigCall(const RigTruth& rig, const RigScene& scene, bool paired) : object(scene.object), windows(rig.windows)
    {
        for (size_t c = 0; c < rig.cameras.size(); c++)
        {
            GlassWindow window = rig.cameras[c]->window();
            window.normal = cv::Vec3d(0, 0, 1);
            if (window.innerIndex != window.outerIndex)
                window.distance *= 0.9;
            cameras.push_back(RefractiveCamera::create(rig.cameras[c]->cameraMatrix(), rig.cameras[c]->distCoeffs(), window));
            Rs.push_back(cv::Mat(rig.Rs[c], true));
            Ts.push_back(cv::Mat(rig.Ts[c], true));
            refracted.push_back(mats(scene.refracted[c]));
            if (paired)
                direct.push_back(mats(scene.direct[c]));
        }
    }

    double run(const cv::refract::GlassRigOptions& options)
    {
        return keep(cv::refract::calibrateGlassRig(object, direct, refracted, cameras, windows, Rs, Ts, rvecs, tvecs, options));
    }

    double keep(const cv::refract::GlassRigResult& result)
    {
        static_cast<cv::refract::GlassRigResult&>(*this) = result;
        return rms;
    }

    double run(int flags)
    {
        cv::refract::GlassRigOptions options(flags);
        options.poseCovariances = poseCovariances;
        return run(options);
    }

    //! @param priors of each camera; of the targets, see targetCovariance(): empty, they are exact
    double run(int flags, const std::vector<cv::Mat>& priors, const cv::Mat& ofTargets = cv::Mat())
    {
        cv::refract::GlassRigOptions options(flags);
        options.criteria.maxCount = 300;
        options.cameraCovariances = priors;
        options.targetCovariance = ofTargets;
        return run(options);
    }

    static std::vector<cv::Mat> mats(const PixelViews& views)
    {
        std::vector<cv::Mat> all;
        for (const std::vector<cv::Point2d>& view : views)
            all.push_back(cv::Mat(view, true));
        return all;
    }

    ObjectViews object;
    std::vector<std::vector<cv::Mat> > refracted, direct;
    std::vector<cv::Ptr<RefractiveCamera> > cameras;
    std::vector<int> windows;
    std::vector<cv::Mat> Rs, Ts, rvecs, tvecs, poseCovariances;
};

//! e^T C^+ e for the rows of the errors e in a covariance.
inline double squaredMahalanobis(const std::vector<double>& errors, const cv::Mat& covariance, const std::vector<int>& rows)
{
    const int count = (int)rows.size();
    cv::Mat part(count, count, CV_64F), inverse, e(count, 1, CV_64F);
    for (int i = 0; i < count; i++)
    {
        e.at<double>(i) = errors[i];
        for (int j = 0; j < count; j++)
            part.at<double>(i, j) = covariance.at<double>(rows[i], rows[j]);
    }
    // Scaled, as lengths and angles differ in size and a normal has a direction without variance.
    cv::Mat scale;
    cv::sqrt(part.diag(), scale);
    part = part/(scale*scale.t());
    e = e/scale;
    cv::Mat w, u, vt;
    cv::SVD::compute(part, w, u, vt);
    double sum = 0;
    for (int i = 0; i < count; i++)
        if (w.at<double>(i) > 1e-9*w.at<double>(0))
            sum += std::pow(cv::Mat(u.col(i).t()*e).at<double>(0), 2)/w.at<double>(i);
    return sum;
}

} // namespace scenes

#endif // REFRACT_TEST_RIG_SCENES_HPP
