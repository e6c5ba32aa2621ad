// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "calibrate/rig_model.hpp"
#include "calibrate/parameter_columns.hpp"
#include "paths.hpp"
#include <catch2/catch.hpp>

using namespace tools;
using cv::Mat;

TEST_CASE("The first pair of a rig keeps what the covariance says of it", "[tools][calibrate]")
{
    Calibration rig = readCalibration(paths::bundled() + "/scene/truth.yml");
    for (const int cameras : {2, 3})
    {
        if (cameras == 3)
            rig.add(rig.cameras[1], rig.extrinsics[1]);
        const int count = columnCount(modelOf(rig)), ofPair = extrinsicsColumn(modelOf(rig), 1);
        const int place = columnsOf(modelOf(rig), 1).end;
        rig.covariance = Mat(count, count, CV_64F);
        cv::randu(rig.covariance, 1, 2);
        const Mat before = rig.covariance.clone();
        const Calibration pair = firstTwoCameras(rig);
        CHECK(cv::norm(rig.covariance, before, cv::NORM_INF) == 0);
        REQUIRE(pair.covariance.rows == place + 6);
        CHECK(pair.covariance.at<double>(3, 5) == before.at<double>(3, 5));
        CHECK(pair.covariance.at<double>(place + 5, place) == before.at<double>(ofPair + 5, ofPair));
        CHECK(pair.covariance.at<double>(3, place + 1) == before.at<double>(3, ofPair + 1));
    }
}
