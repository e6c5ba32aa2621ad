// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TEST_DRAWN_MATCHES_HPP
#define REFRACT_TEST_DRAWN_MATCHES_HPP

#include "match_scene.hpp"

/* Matches without images, for statistics that rendering would make too slow: points of a scene's surfaces that both cameras see, with
errors as large as those that matches of rendered images have. */
namespace match_scene {

//! What matches of rendered images show.
struct FeatureNoise
{
    MatchNoise noise;                                   //!< across the curves
    double alongMore = 0;                               //!< along them: a standard deviation beside it, px
    double wrongShare = 0;                              //!< of all that are found
    std::vector<std::pair<double, double>> scales;      //!< of the features of matches
    std::vector<double> unlike = {};                    //!< of the same; empty: 1
};

//! Of matches of a rig whose rendered images they come from.
inline void addNoise(const TexturedScene& scene, const RigModel& rig, const ScaledMatches& all, const SceneMatches& good,
                     FeatureNoise& noise)
{
    const double SAME = 3;              // px
    const std::vector<Point2d> partners = truePartners(scene, rig, all.matches.pixels[0]);
    int wrong = 0;
    for (int i = 0; i < all.size(); i++)
        wrong += !(cv::norm(all.matches.pixels[1][i] - partners[i]) < SAME);
    noise.wrongShare = wrong/(double)all.size();
    const Matches& m = good.good.matches;
    const std::vector<Point2d> places = truePartners(scene, rig, m.pixels[0]);
    const std::vector<MatchResidual> residuals = residualsOf(good.good, rig);
    double along = 0;
    int right = 0;
    for (int i = 0; i < good.good.size(); i++)
    {
        const Point2d off = m.pixels[1][i] - places[i];
        if (!(cv::norm(off) < SAME))
            continue;
        noise.scales.push_back({ good.good.scales[0][i], good.good.scales[1][i] });
        noise.unlike.push_back(good.good.unlike[i]);
        along += off.dot(off) - 2*residuals[i].squares - m.stds[0][i]*m.stds[0][i] - m.stds[1][i]*m.stds[1][i];
        right++;
    }
    noise.noise = good.noise;
    noise.alongMore = std::sqrt(std::max(0., along/right));
}

//! So many matches of one moment.
inline ScaledMatches drawMatches(const std::string& moment, const TexturedScene& scene, const RigModel& rig, const FeatureNoise& noise,
                                 int count, scenes::Random& random)
{
    const double SAME_PLACE = 1, WRONG = 8;             // mm; px
    const int DRAWS = 4*count;
    std::vector<Point2d> first;
    const cv::Size size = rig.cameras[0]->imageSize(), size2 = rig.cameras[1]->imageSize();
    for (int i = 0; i < DRAWS; i++)
        first.push_back(Point2d(random.uniform(0, size.width - 1), random.uniform(0, size.height - 1)));
    std::vector<Point3d> seen1(DRAWS, Point3d(NAN, NAN, NAN)), nearer = seen1;
    const std::vector<SceneRay> rays1 = raysOf(first, viewpointOf(rig, 0));
    for (int i = 0; i < DRAWS; i++)
    {
        const SurfaceHit hit = firstSurface(scene, rays1[i]);
        if (!hit.surface)
            continue;
        seen1[i] = Point3d(rays1[i].at(hit.intersection.s));
        nearer[i] = Point3d(rays1[i].at(hit.intersection.s - SAME_PLACE));
    }
    std::vector<Point2d> second, along;
    const Vec3d rvec = rotationVector(rig.extrinsics[1].R);
    refractiveProjectPoints(seen1, rvec, rig.extrinsics[1].t, rig.cameras[1], second);
    refractiveProjectPoints(nearer, rvec, rig.extrinsics[1].t, rig.cameras[1], along);
    const std::vector<SceneRay> rays2 = raysOf(second, viewpointOf(rig, 1));
    ScaledMatches result;
    result.matches.pixels.resize(2);
    result.scales.resize(2);
    for (int i = 0; i < DRAWS && result.size() < count; i++)
    {
        if (!(second[i].x > 0 && second[i].y > 0 && second[i].x < size2.width - 1 && second[i].y < size2.height - 1))
            continue;
        const SurfaceHit hit = firstSurface(scene, rays2[i]);
        if (!hit.surface || cv::norm(rays2[i].at(hit.intersection.s) - Vec3d(seen1[i])) > SAME_PLACE)
            continue;
        const int kind = (int)random.uniform(0, noise.scales.size() - 1e-9);
        const auto scales = noise.scales[kind];
        const double unlike = noise.unlike.empty() ? 1 : noise.unlike[kind];
        const double std1 = noise.noise.stdOf(scales.first, unlike), std2 = noise.noise.stdOf(scales.second, unlike);
        Point2d curve = along[i] - second[i];
        curve *= 1/cv::norm(curve);
        Point2d p2 = second[i] + Point2d(random.normal(std2), random.normal(std2)) + random.normal(noise.alongMore)*curve;
        if (random.uniform(0, 1) < noise.wrongShare)
            p2 += Point2d(random.uniform(-WRONG, WRONG), random.uniform(-WRONG, WRONG));
        result.matches.names.push_back({ moment, std::to_string(result.size() + 1) });
        result.matches.pixels[0].push_back(first[i] + Point2d(random.normal(std1), random.normal(std1)));
        result.matches.pixels[1].push_back(p2);
        result.unlike.push_back(unlike);
        result.scales[0].push_back(scales.first);
        result.scales[1].push_back(scales.second);
    }
    return result;
}

//! What is seen.
struct Seen
{
    int moments = 20, count = 3000;
    bool isWall = false;                        //!< and nothing before it
    double moving = 0;                          //!< share of the image's width: things that moved between the images of a pair, px below
    int reflected = 0;                          //!< features of a reflection on the pane, at the same place in all images
};

inline TexturedScene wallOf(scenes::Random& random)
{
    TexturedScene wall;
    const Vec3d normal(random.uniform(-0.2, 0.2), random.uniform(-0.2, 0.2), -1);
    wall.surfaces.push_back(std::make_shared<Plane>(Vec3d(0, 0, 900), cv::normalize(normal), Vec3d(1, 1, 1)));
    return wall;
}

inline ScaledMatches drawSeen(Rig& rig, const Seen& seen, const FeatureNoise& noise)
{
    const double MOVED = 5, BESIDE = 4;         // px
    ScaledMatches all, reflection;
    if (seen.reflected > 0)
        reflection = drawMatches("", roomOf(rig.random), rig.truth, noise, seen.reflected, rig.random);
    const double beside = rig.random.uniform(-BESIDE, BESIDE);
    for (int m = 0; m < seen.moments; m++)
    {
        ScaledMatches ofMoment = drawMatches(std::to_string(m), seen.isWall ? wallOf(rig.random) : roomOf(rig.random), rig.truth, noise,
                                             seen.count/seen.moments, rig.random);
        const Point2d moved(rig.random.uniform(-MOVED, MOVED), rig.random.uniform(-MOVED, MOVED));
        for (int i = 0; i < ofMoment.size(); i++)
            if (ofMoment.matches.pixels[0][i].x < seen.moving*rig.truth.cameras[0]->imageSize().width)
                ofMoment.matches.pixels[1][i] += moved;
        all.add(ofMoment);
        for (int i = 0; i < reflection.size(); i++)
            reflection.matches.names[i].image = std::to_string(m);
        ScaledMatches here = reflection;
        for (int i = 0; i < here.size(); i++)
            here.matches.pixels[1][i] += Point2d(rig.random.normal(0.1), beside + rig.random.normal(0.1));
        if (here.size() > 0)
            all.add(here);
    }
    return all;
}

} // namespace match_scene

#endif // REFRACT_TEST_DRAWN_MATCHES_HPP
