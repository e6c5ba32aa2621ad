// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

// Random rigs around a tank, of which a calibration knows hardly anything: seeded, with one view of a target in depth.
#ifndef REFRACT_TEST_CRUDE_SCENES_HPP
#define REFRACT_TEST_CRUDE_SCENES_HPP

#include "rig_scenes.hpp"

namespace scenes {

const cv::Size TANK_IMAGE(1280, 1024);

//! Five planes of ten by ten dots: 500 points.
inline std::vector<cv::Point3d> fivePlanes(double pitch = 12, double apart = 20)
{
    std::vector<cv::Point3d> points;
    for (int plane = -2; plane <= 2; plane++)
        for (const cv::Point3d& p : board(10, 10, pitch))
            points.push_back(cv::Point3d(p.x, p.y, apart*plane));
    return points;
}

//! A rotation that takes one unit vector to another, and turns about it.
inline cv::Matx33d rotationTo(const cv::Vec3d& from, const cv::Vec3d& to, double spin)
{
    cv::Matx33d turn, about;
    const cv::Vec3d axis = from.cross(to);
    const double sine = cv::norm(axis);
    cv::Rodrigues(sine > 0 ? axis*(std::atan2(sine, from.dot(to))/sine) : cv::Vec3d(), turn);
    cv::Rodrigues(to*spin, about);
    return about*turn;
}

inline cv::Vec3d tilted(double tilt, double azimuth)
{
    return { std::sin(tilt)*std::cos(azimuth), std::sin(tilt)*std::sin(azimuth), std::cos(tilt) };
}

/** Cameras that look through walls into water at one target, which fills much of each image. windows as calibrateGlassRig's
windowOfCamera: cameras with equal numbers stand around the normal of one wall, walls about 0.6 rad apart. */
struct TankRig
{
    RigTruth rig;
    std::vector<cv::Matx33d> targetRs;      //!< target -> camera
    std::vector<cv::Vec3d> targetTs;
    std::vector<cv::Point3d> target = fivePlanes();
    PixelViews pixels;                      //!< of each camera

    TankRig(const std::vector<int>& windows, Random& random, double sigma)
    {
        rig.windows = windows;
        const int walls = 1 + *std::max_element(windows.begin(), windows.end());
        std::vector<GlassWindow> wall;
        std::vector<double> depth;          // of the target's centre behind the wall
        for (int w = 0; w < walls; w++)
        {
            wall.push_back(GlassWindow(tilted(walls > 1 ? random.uniform(0.2, 0.6) : random.uniform(0, 0.2),
                                              2*CV_PI*w/walls + random.uniform(-0.3, 0.3)),
                                       random.uniform(4, 20), random.uniform(1.46, 1.52), 0, 1.333));
            depth.push_back(random.logUniform(150, 600));
        }
        for (size_t c = 0; c < windows.size(); c++)
            place(wall[windows[c]], depth[windows[c]], 2*CV_PI*c/windows.size(), random);
        for (size_t c = 0; c < windows.size(); c++)
        {
            rig.Rs.push_back(targetRs[c]*targetRs[0].t());
            rig.Ts.push_back(targetTs[c] - rig.Rs[c]*targetTs[0]);
            look((int)c, random, sigma);
        }
    }

    //! A random camera outside the wall; in its own frame it sees the wall tilted by up to 0.5.
    void place(GlassWindow window, double depth, double azimuth, Random& random)
    {
        const cv::Vec3d normalInTarget = window.normal;
        window.distance = random.logUniform(50, 600);
        window.normal = tilted(random.uniform(0.05, 0.5), random.uniform(0, 2*CV_PI));
        const double range = window.distance + depth/window.outerIndex;
        const double f = random.uniform(0.7, 1)*0.4*TANK_IMAGE.height*range/60;
        const cv::Matx33d K(f*random.uniform(0.998, 1.002), 0, 639.5 + random.uniform(-20, 20), 0, f,
                            511.5 + random.uniform(-20, 20), 0, 0, 1);
        const std::vector<double> D = { random.uniform(-0.3, 0.2), random.uniform(-0.1, 0.1), 0, 0 };
        const cv::Ptr<RefractiveCamera> camera = RefractiveCamera::create(K, D, window);
        std::vector<cv::Point3d> origin, direction;
        cv::refract::refractiveUnprojectPoints(std::vector<cv::Point2d>{ { 640 + random.uniform(-60, 60),
                                                                          512 + random.uniform(-60, 60) } },
                                               origin, direction, camera);
        const cv::Vec3d o = origin[0], d = direction[0];
        rig.cameras.push_back(camera);
        targetTs.push_back(o + d*((window.distance + window.thickness[0] + depth - window.normal.dot(o))/window.normal.dot(d)));
        targetRs.push_back(rotationTo(normalInTarget, window.normal, azimuth + random.uniform(-0.3, 0.3)));
    }

    void look(int c, Random& random, double sigma)
    {
        cv::Vec3d rvec;
        cv::Rodrigues(targetRs[c], rvec);
        std::vector<cv::Point2d> all;
        cv::refract::refractiveProjectPoints(target, rvec, targetTs[c], rig.cameras[c], all, cv::noArray());
        for (cv::Point2d& p : all)
        {
            p += cv::Point2d(random.normal(sigma), random.normal(sigma));
            if (!(p.x >= 0 && p.y >= 0 && p.x < TANK_IMAGE.width && p.y < TANK_IMAGE.height))
                p = cv::Point2d(NaN, NaN);
        }
        pixels.push_back(all);
    }
};

/** calibrateGlassRig of a TankRig that is sealed: all that is known of a lens is its focal length to 10 %, of a window what it
is made of and its distance to a factor of 3; nothing is known of where the cameras are. */
struct CrudeCall : cv::refract::GlassRigResult
{
    //! @param random chooses the start; null: the truth, from where it goes downhill only, as its lenses count as known.
    CrudeCall(const TankRig& tank, Random* random) : object(1, tank.target), windows(tank.rig.windows)
    {
        for (size_t c = 0; c < windows.size(); c++)
        {
            refracted.push_back({ cv::Mat(tank.pixels[c], true) });
            const cv::Ptr<RefractiveCamera> truth = tank.rig.cameras[c];
            if (random)
            {
                cameras.push_back(crude(truth, *random));
                continue;
            }
            cameras.push_back(truth->clone());
            const int lens = (int)truth->lensParameters().total();
            nothingKnown.push_back(cv::Mat(lens, lens, CV_64F, cv::Scalar(NaN)));
            Rs.push_back(cv::Mat(tank.rig.Rs[c], true));
            Ts.push_back(cv::Mat(tank.rig.Ts[c], true));
        }
    }

    static cv::Ptr<RefractiveCamera> crude(const cv::Ptr<RefractiveCamera>& truth, Random& random)
    {
        const double f = cv::Matx33d(truth->cameraMatrix())(0, 0)*random.uniform(0.9, 1.1);
        GlassWindow window = truth->window();
        window.normal = cv::Vec3d(0, 0, 1);
        window.distance *= random.logUniform(1/3., 3);
        return RefractiveCamera::create(cv::Matx33d(f, 0, (TANK_IMAGE.width - 1)/2., 0, f, (TANK_IMAGE.height - 1)/2., 0, 0, 1),
                                        std::vector<double>(4, 0.), window);
    }

    double run(int flags = 0)
    {
        using namespace cv::refract;
        GlassRigOptions options(flags | GLASS_FREE_INTRINSICS | GLASS_FREE_DISTANCE | GLASS_FREE_EXTRINSICS | GLASS_FIX_TANGENT_DIST);
        options.cameraCovariances = nothingKnown;
        static_cast<GlassRigResult&>(*this) = calibrateGlassRig(object, std::vector<std::vector<cv::Mat> >(), refracted, cameras, windows,
                                                                Rs, Ts, rvecs, tvecs, options);
        return rms;
    }

    //! How little worse the second best minimum is; infinite if there is none.
    double nearestRival() const
    {
        double least = INF;
        for (int c = 0; c < otherMinima.rows; c++)
            if (!std::isnan(otherMinima.at<double>(c, 3)))
                least = std::min(least, otherMinima.at<double>(c, 3));
        return least;
    }

    ObjectViews object;
    std::vector<std::vector<cv::Mat> > refracted;
    std::vector<cv::Ptr<RefractiveCamera> > cameras;
    std::vector<int> windows;
    std::vector<cv::Mat> Rs, Ts, rvecs, tvecs, nothingKnown;
};

} // namespace scenes

#endif // REFRACT_TEST_CRUDE_SCENES_HPP
