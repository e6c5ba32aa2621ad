// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#include "pose/central_pose.hpp"
#include "arrays/views.hpp"
#include "math/rotation.hpp"

namespace cv { namespace refract {

Bearings bearingsOf(const Camera& camera, const std::vector<Point2d>& pixels)
{
    const double NaN = std::numeric_limits<double>::quiet_NaN();
    Bearings b;
    b.normalized.assign(pixels.size(), Point2d(NaN, NaN));
    std::vector<Vec3d> directions(pixels.size(), Vec3d::all(NaN));
    Vec3d look;
    Rays rays;
    double sumTau = 0;
    Vec3d sumOffset;
    int found = 0;
    for (size_t i = 0; i < pixels.size(); i++)
    {
        uchar status = REFRACT_OK;
        if (!isWhole(pixels[i]))
            continue;
        camera.unproject(1, &pixels[i].x, &pixels[i].y, rays, &status);
        if (status != REFRACT_OK)
            continue;
        directions[i] = rays.direction(0);
        look += directions[i];
        sumTau += rays.tau[0];
        sumOffset += rays.offsetOf(0);
        found++;
    }
    if (!(norm(look) > 0))
        return b;
    b.turn = turnToZ(look/norm(look));
    b.centre = camera.layers().normal()*(sumTau/found) + sumOffset*(1./found);
    for (size_t i = 0; i < pixels.size(); i++)
    {
        const Vec3d d = b.turn*directions[i];
        if (d[2] > 0.05)                    // normalised coordinates end before 90 degrees
            b.normalized[i] = Point2d(d[0]/d[2], d[1]/d[2]);
    }
    return b;
}

namespace {

typedef std::vector<Point2d> Points;

//! R and baseline of pinholes.
struct PinholePose { Mat R, t; };

//! By the essential matrix; the number of inliers.
int posesOfScene(const Points& n1, const Points& n2, double limit, double prob, std::vector<PinholePose>& poses)
{
    const Mat K = Mat::eye(3, 3, CV_64F);
    Mat mask, R, t;
    const Mat E = findEssentialMat(n1, n2, K, RANSAC, prob, limit, 1000, mask);
    const int inliers = E.rows == 3 ? recoverPose(E, n1, n2, K, R, t, 1e9, mask) : 0;
    if (inliers >= 6)
        poses.push_back({ R, t });
    return inliers;
}

/** By the homography, of a plane that is in front of all inliers. One essential matrix of a plane's matches is as good as
the other, and findEssentialMat has one of them only.
@param least inliers that a scene taken for a plane must have */
void posesOfPlane(const Points& n1, const Points& n2, double limit, double prob, int least, std::vector<PinholePose>& poses)
{
    Mat mask;
    const Mat H = findHomography(n1, n2, RANSAC, limit, mask, 1000, prob);
    if (H.empty() || countNonZero(mask) < least)
        return;
    std::vector<Mat> R, t, normals;
    const int count = decomposeHomographyMat(H, Mat::eye(3, 3, CV_64F), R, t, normals);
    for (int k = 0; k < count; k++)
    {
        const Vec3d normal(normals[k].ptr<double>());
        int inFront = 0;
        for (size_t i = 0; i < n1.size(); i++)
            inFront += mask.at<uchar>((int)i) && normal.dot(Vec3d(n1[i].x, n1[i].y, 1)) > 0;
        if (inFront >= least && norm(t[k]) > 0)
            poses.push_back({ R[k], t[k]/norm(t[k]) });
    }
}

} // namespace

std::vector<RigidTransform> centralPoses(const Bearings& b1, const Bearings& b2, double threshold, double prob)
{
    Points n1, n2;
    for (size_t i = 0; i < b1.normalized.size(); i++)
        if (isWhole(b1.normalized[i]) && isWhole(b2.normalized[i]))
        {
            n1.push_back(b1.normalized[i]);
            n2.push_back(b2.normalized[i]);
        }
    std::vector<PinholePose> found;
    for (double limit = threshold; limit <= 32*threshold && n1.size() >= 6; limit *= 2)
    {
        const int inliers = posesOfScene(n1, n2, limit, prob, found);
        posesOfPlane(n1, n2, limit, prob, std::max(6, inliers/2), found);
    }
    std::vector<RigidTransform> poses;
    for (const PinholePose& p : found)
        poses.push_back({ b2.turn.t()*Matx33d(p.R)*b1.turn, b2.turn.t()*Vec3d(p.t.ptr<double>()) });
    return poses;
}

}} // namespace
