// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

// Four real cameras behind one wall of a tank (proPTV's comparison): a lens with more coefficients than one view determines. For
// two of them the least error lies where the wall would pass through the nearest markers: that is refused.
#include "real_data.hpp"

using namespace cv;
using namespace cv::refract;
using namespace real_data;

TEST_CASE("A lens that one view hardly determines is answered within 100 iterations, or refused", "[real]")
{
    int answers = 0;
    for (int c = 0; c < 4; c++)
    {
        const Dots all = readDots(format("proptv/markers_c%d.txt", c));
        if (all.object.empty())
            return;
        for (int half = 0; half < 2; half++)
        {
            Dots some;
            for (size_t i = half; i < all.object.size(); i += 2)
            {
                some.object.push_back(all.object[i]);
                some.pixels.push_back(all.pixels[i]);
            }
            GlassWindow window;
            window.distance = 300;
            window.outerIndex = 1.333;
            const Ptr<RefractiveCamera> camera = RefractiveCamera::create(Matx33d(2000, 0, 1024, 0, 2000, 1024, 0, 0, 1),
                                                                          std::vector<double>(5, 0.), window);
            Mat rvecs, tvecs, deviations;
            double rms = 0;
            const std::string refusal = scenes::thrown([&]
            {
                rms = calibrateGlass(std::vector<std::vector<Point3d> >{ some.object }, noArray(),
                                     std::vector<std::vector<Point2d> >{ some.pixels }, camera, rvecs, tvecs, deviations, noArray(),
                                     noArray(), noArray(), GLASS_FREE_DISTANCE | GLASS_FREE_INTRINSICS,
                                     TermCriteria(TermCriteria::COUNT | TermCriteria::EPS, 100, 1e-9));
            });
            CAPTURE(c, half, refusal);
            if (!refusal.empty())
            {
                std::cout << "[numbers] proptv, camera " << c << ", half " << half << ", five coefficients: refused\n";
                CHECK(refusal.find("did not converge in 100 iterations") != std::string::npos);
                continue;
            }
            answers++;
            std::cout << "[numbers] proptv, camera " << c << ", half " << half << ", five coefficients: " << rms << " px, distance "
                      << camera->window().distance << " +- " << deviations.at<double>(12) << " mm, focal length "
                      << camera->cameraMatrix().at<double>(0, 0) << " +- " << deviations.at<double>(0) << " px\n";
            CHECK(rms < 1);
        }
    }
    CHECK(answers >= 4);
}
