// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

// Where to look for the partner of a point in the other image: a curve, not a line.
//
//   compute_refractive_epilines [--calib=calib.yml --near=400 --far=1500]

#include <opencv2/calib3d.hpp>
#include <opencv2/refract.hpp>
#include <iostream>

using namespace cv;

static double distanceToLine(const std::vector<Point2f>& line, Point2d p)
{
    double nearest = std::numeric_limits<double>::infinity();
    for (size_t i = 1; i < line.size(); i++)
    {
        const Point2d a = line[i - 1], ab = Point2d(line[i]) - a;
        const double t = std::min(1., std::max(0., (p - a).dot(ab)/ab.dot(ab)));
        nearest = std::min(nearest, norm(p - a - t*ab));
    }
    return nearest;
}

int main(int argc, char** argv)
{
    const CommandLineParser args(argc, argv,
        "{calib | samples/data/stereo/truth.yml | calibrated stereo rig}"
        "{near | 400 | smallest z} {far | 1500 | largest z, may be inf}");
    const String filename = args.get<String>("calib");
    const Ptr<refract::RefractiveCamera> camera1 = refract::RefractiveCamera::read(filename, "camera1");
    const Ptr<refract::RefractiveCamera> camera2 = refract::RefractiveCamera::read(filename, "camera2");
    const FileStorage file(filename, FileStorage::READ);
    const Mat R = file["R"].mat(), T = file["T"].mat();

    // A point at z = 600 and its true image in both cameras.
    const std::vector<Point3d> point(1, Point3d(30, -40, 600));
    std::vector<Point2d> pixel1, pixel2;
    refract::refractiveProjectPoints(point, Vec3d(), Vec3d(), camera1, pixel1);
    refract::refractiveProjectPoints(point, R, T, camera2, pixel2);

    std::vector<std::vector<Point2f>> lines;
    refract::computeRefractiveEpilines(pixel1, 1, camera1, camera2, R, T,
                                       Vec2d(args.get<double>("near"), args.get<double>("far")), lines);

    const double distance = distanceToLine(lines[0], pixel2[0]);
    std::cout << "curve of " << lines[0].size() << " points from " << lines[0].front() << " to " << lines[0].back()
              << "\nthe true partner " << pixel2[0] << " lies " << distance << " px beside it" << std::endl;
    return distance < 0.02 ? 0 : 1;
}
