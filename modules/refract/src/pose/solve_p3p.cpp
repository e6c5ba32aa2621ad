// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

/* The public call for three points, or four of which the last tells which pose is right. */

#include "pose/near_origin.hpp"
#include "pose/poses.hpp"
#include "pose/generalized_p3p.hpp"
#include "arrays/arrays.hpp"

namespace cv { namespace refract {

//! Those of the poses that give all points an image.
static std::vector<PoseMinimum> visiblePoses(const Camera& camera, const ImagePoints& points,
                                             const std::vector<RigidTransform>& motions)
{
    std::vector<PoseMinimum> poses;
    for (const RigidTransform& motion : motions)
    {
        PoseMinimum p = { poseOf(motion), 0 };
        p.rms = refinePose(camera, points, p.pose, 1);          // no step: the error alone
        if (!std::isnan(p.rms))
            poses.push_back(p);
    }
    return poses;
}

int refractiveSolveP3P(InputArray objectPoints, InputArray imagePoints, const Ptr<RefractiveCamera>& camera,
                       OutputArrayOfArrays rvecs, OutputArrayOfArrays tvecs)
{
    CV_INSTRUMENT_REGION();

    const Camera& seenBy = cameraOf(camera);
    ImagePoints points = readPosePoints(objectPoints, imagePoints, 3, 4);
    const NearOrigin origin = moveNear(points);
    const PointRays rays(seenBy, points);
    std::vector<PoseMinimum> poses;
    if (rays.point.size() >= 3 && rays.point[2] == 2 && points.index[2] == 2)
    {
        const SceneRay three[3] = { rays.ray[0], rays.ray[1], rays.ray[2] };
        const Vec3d object[3] = { points.object[0], points.object[1], points.object[2] };
        poses = visiblePoses(seenBy, points, allPosesOfThreeRays(three, object));
    }
    if (points.pixel.size() > 3)
        sortByError(poses);
    writePoses(poses, origin, rvecs, tvecs);
    return (int)poses.size();
}

int refractiveSolveP3P(InputArray objectPoints, InputArray imagePoints, InputArray cameraMatrix, InputArray distCoeffs,
                       const GlassWindow& window, OutputArrayOfArrays rvecs, OutputArrayOfArrays tvecs)
{
    CV_INSTRUMENT_REGION();

    return refractiveSolveP3P(objectPoints, imagePoints, RefractiveCamera::create(cameraMatrix, distCoeffs, window), rvecs, tvecs);
}

}} // namespace
