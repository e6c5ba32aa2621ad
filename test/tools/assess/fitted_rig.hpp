// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

// A rig fitted to what it sees, as refract_calib hands it to what judges it.
#ifndef REFRACT_TEST_TOOLS_FITTED_RIG_HPP
#define REFRACT_TEST_TOOLS_FITTED_RIG_HPP

#include "assess/rig_calibration.hpp"
#include "calibrate/fit.hpp"
#include "calibrate/priors.hpp"
#include "paper_rig.hpp"

//! Fitted from the rig itself, which knows all that is given; lengths in mm.
inline tools::RigCalibration fittedRig(const tools::RigModel& rig, const tools::RigData& data, double square = 39., int flags = 0)
{
    tools::RigCalibration c;
    c.square = square;
    c.unit = "mm";
    c.data = data;
    c.start = rig;
    c.lensSources.resize(data.cameraCount);
    c.fit = tools::fitImages(c.data, rig, tools::allViews(c.data), flags);
    c.residuals = tools::residualsOf(c.data, c.fit);
    return c;
}

//! Without images yet.
inline tools::RigData dataOf(const tools::RigModel& rig)
{
    tools::RigData data;
    data.cameraCount = (int)rig.cameras.size();
    for (int k = 0; k < data.cameraCount; k++)
        data.imageSize[k] = rig.cameras[k]->imageSize();
    return data;
}

//! Two cameras with known lenses, eight pairs; what is known of the given values.
inline tools::RigCalibration calibratedPairs(const tools::GivenStd& std, unsigned seed, double sigma, double square, int flags = 0)
{
    scenes::Random random(seed);
    tools::RigModel rig = paperRig(2);
    for (const cv::Ptr<cv::refract::RefractiveCamera>& camera : rig.cameras)
    {
        cv::refract::GlassWindow window = camera->window();
        if (std.wedge > 0.)
            window.wedge = {cv::Vec2d()};
        camera->setWindow(window);
    }
    tools::RigData data = dataOf(rig);
    for (int i = 0; i < 8; i++)
    {
        const cv::Vec3d tvec(random.uniform(-30, 30), random.uniform(-20, 20), random.uniform(560, 660)), rvec = random.vector(0.4);
        data.views.push_back(observe(rig, board(6, 5, square), rvec, tvec, true, sigma, random));
    }
    tools::RigOptions options;
    options.window = rig.cameras[0]->window();
    options.std = std;
    for (int k = 0; k < 2; k++)
    {
        options.known[k] = rig.cameras[k];
        rig.known.push_back(tools::knownOf(*rig.cameras[k], options, k));
        rig.known[k].window = rig.cameras[k]->window();
    }
    rig.targetCovariance = tools::targetCovarianceOf(data, rig, std);
    tools::RigCalibration c = fittedRig(rig, data, square, flags);
    c.options = options;
    return c;
}

#endif // REFRACT_TEST_TOOLS_FITTED_RIG_HPP
