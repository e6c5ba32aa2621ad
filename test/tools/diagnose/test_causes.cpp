// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "diagnose/causes.hpp"
#include "diagnose/mistake_scenes.hpp"

using namespace mistakes;

TEST_CASE("Where camera 1 moves, the others move the other way, in parallel rigs, too", "[diagnose]")
{
    Scene scene = mistaken(NONE_AT_ALL, STEREO_IN_AIR, 51);
    Fit fit;
    fit.rig = scene.truth.clone();
    for (size_t i = 0; i < scene.calibration.data.views.size(); i++)
        fit.views.push_back((int)i);
    for (const Vec3d& turn : {Vec3d(), Vec3d(1e-7, -1e-7, 0), Vec3d(0.02, -0.4, 0.01)})
    {
        RigidTransform& cam2_from_cam1 = fit.rig.extrinsics[1];
        cam2_from_cam1.R = rotationMatrix(turn);
        const std::vector<Cause> causes = causesOf(scene.calibration.data, scene.calibration.options, fit);
        const auto place = std::find_if(causes.begin(), causes.end(), [](const Cause& cause) { return cause.kind == "place 0"; });
        REQUIRE(place != causes.end());
        REQUIRE(place->freed.size() == 6);
        for (int k = 0; k < 6; k++)
        {
            VectorXd shift = VectorXd::Zero(6);
            for (const std::pair<int, double>& number : place->freed[k].numbers)
                if (number.first >= extrinsicsColumn(fit.rig, 1) && number.first < extrinsicsColumn(fit.rig, 1) + 6)
                    shift[number.first - extrinsicsColumn(fit.rig, 1)] += number.second;
            const double FAR = 1e-4;
            const Vec3d there = rotationVector(cam2_from_cam1.R) + FAR*Vec3d(shift.data());
            Vec3d axis;
            axis[k % 3] = FAR;
            CAPTURE(turn, k);
            if (k < 3)
                CHECK(norm(rotationMatrix(there) - cam2_from_cam1.R*rotationMatrix(-axis)) < 1e-7);
            else
                CHECK(norm(Vec3d(shift.data() + 3) + cam2_from_cam1.R*axis/FAR) < 1e-6);
        }
    }
}
