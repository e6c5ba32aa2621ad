// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#include "arrays/extrinsics.hpp"
#include "math/rotation.hpp"

/* Where the cameras of a rig are: lists of R and T, one per camera, the first that of camera 1 itself. */

namespace cv { namespace refract {

String numbered(const char* name, int i) { return format("%s[%d]", name, i); }

static std::vector<Mat> readList(InputArrayOfArrays list, int cameras, const char* name)
{
    std::vector<Mat> items;
    if (!list.empty())
        list.getMatVector(items);
    if ((int)items.size() != cameras)
        CV_Error_(Error::StsUnmatchedSizes, ("%s has %d elements; cameras has %d", name, (int)items.size(), cameras));
    return items;
}

std::vector<RigidTransform> readExtrinsics(InputArrayOfArrays Rs, InputArrayOfArrays Ts, int cameras)
{
    const double ROUNDING = 1e-6;       // of single precision
    std::vector<RigidTransform> extrinsics(cameras);
    if (cameras == 1 && Rs.empty() && Ts.empty())
        return extrinsics;
    const std::vector<Mat> R = readList(Rs, cameras, "Rs"), T = readList(Ts, cameras, "Ts");
    double size = 1;
    for (const Mat& t : T)
        size = std::max(size, norm(t, NORM_INF));
    for (int c = 0; c < cameras; c++)
    {
        RigidTransform& camera = extrinsics[c];
        camera.R = readRotation(R[c], numbered("Rs", c).c_str());
        camera.t = readVec3(T[c], numbered("Ts", c).c_str());
        const double turned = norm(rotationVector(camera.R)), moved = norm(camera.t);
        if (c == 0 && turned + moved/size > ROUNDING)
            CV_Error_(Error::StsBadArg, ("Rs[0] and Ts[0] rotate by %g and translate by %g; those of camera 1 must be the identity "
                                         "and 0", turned, moved));
    }
    extrinsics[0] = RigidTransform();
    return extrinsics;
}

void writeRotation(const Matx33d& R, OutputArray out)
{
    if (out.fixedSize() && out.total()*out.channels() == 3)     // as it was given
        Mat(rotationVector(R)).convertTo(out, out.depth());
    else
        Mat(R).convertTo(out, out.fixedType() ? out.depth() : CV_64F);
}

void writeExtrinsics(const std::vector<RigidTransform>& extrinsics, OutputArrayOfArrays Rs, OutputArrayOfArrays Ts)
{
    const int count = (int)extrinsics.size();
    const bool isArray = Rs.needed() && !Rs.isMatVector(), areVectors = isArray && Rs.type() == CV_64FC3;
    // OutputArray cannot resize a std::vector<Matx33d>.
    if (isArray && !areVectors && (Rs.type() != CV_64FC(9) || (int)Rs.total() != count))
        CV_Error_(Error::StsBadArg, ("Rs must be a std::vector<Mat>, a std::vector<Vec3d>, or a std::vector<Matx33d> of %d", count));
    std::vector<Vec3d> rotations, T;
    std::vector<Mat> R;
    for (const RigidTransform& camera : extrinsics)
    {
        rotations.push_back(rotationVector(camera.R));
        R.push_back(Mat(camera.R, true));
        T.push_back(camera.t);
    }
    writeVectors(T, Ts);
    if (areVectors)
        return writeVectors(rotations, Rs);
    if (!isArray)
        return writeMatrices(R, Rs);
    Mat fixed = Rs.getMat();
    for (int c = 0; c < count; c++)
        fixed.ptr<Matx33d>()[c] = extrinsics[c].R;
}

}} // namespace
