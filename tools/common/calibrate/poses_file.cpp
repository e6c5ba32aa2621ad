// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "calibrate/poses_file.hpp"
#include "calibrate/units.hpp"
#include "calibrate/rigid_transform.hpp"
#include "console/failure.hpp"
#include "console/numbers.hpp"
#include "console/csv.hpp"
#include "math/rotation.hpp"
#include "pose/poses.hpp"
#include <cmath>
#include <map>

using namespace cv;

namespace tools {

namespace {

const char* const HEADING = "view,rx_deg,ry_deg,rz_deg,tx,ty,tz,sigma_deg,sigma";
const double ORTHONORMAL = 1e-4;        // more than rounding leaves

//! The name of a column of lengths as the file has it, and what its numbers are to be multiplied by; empty: there is none.
struct LengthColumn
{
    LengthColumn(const CsvTable& table, const std::string& name, const std::string& unit)
    {
        if (table.find(name) >= 0)
            column = name;
        for (const std::string& other : unitNames())
            if (table.find(name + "_" + other) >= 0)
            {
                column = name + "_" + other;
                factor = millimetresIn(other)/millimetresIn(unit);
            }
    }
    std::string column;
    double factor = 1.;
};

class PosesFile
{
public:
    PosesFile(const std::string& path, const std::string& unit)
        : table_(path, {"view"}, "a file of known poses"), sigma_(table_, "sigma", unit)
    {
        for (const std::string axis : {"x", "y", "z"})
        {
            lengths_.emplace_back(table_, "t" + axis, unit);
            if (lengths_.back().column.empty())
                throw Failure("'" + path + "': there is no column t" + axis + " (or t" + axis + "_mm, ...): a file of known poses "
                              "begins with the line " + HEADING);
        }
        if (!has("r", "_deg") && !has("r", "_rad") && table_.find("r33") < 0)
            throw Failure("'" + path + "' says no rotations: give the columns rx_deg,ry_deg,rz_deg (a rotation vector in degrees), "
                          "rx_rad,... or a matrix r11,r12,...,r33");
        if (sigma_.column.empty() != (table_.find("sigma_deg") < 0))
            throw Failure("'" + path + "': sigma_deg and sigma must be there both, or none of them");
    }

    std::map<std::string, KnownPose> poses() const
    {
        std::map<std::string, KnownPose> poses;
        for (const CsvTable::Row& row : table_.rows())
            if (!poses.emplace(table_.text(row, "view"), poseOf(row)).second)
                throw Failure(table_.where(row) + ": the view '" + table_.text(row, "view") + "' has a pose already");
        return poses;
    }

private:
    bool has(const std::string& name, const std::string& unit) const { return table_.find(name + "x" + unit) >= 0; }

    Vec3d rotationOf(const CsvTable::Row& row) const
    {
        Vec3d rvec;
        if (table_.find("r33") < 0)
        {
            const bool degrees = has("r", "_deg");
            for (int i = 0; i < 3; i++)
                rvec[i] = table_.number(row, std::string("r") + "xyz"[i] + (degrees ? "_deg" : "_rad"));
            return degrees ? rvec*(CV_PI/180.) : rvec;
        }
        Matx33d R;
        for (int i = 0; i < 9; i++)
            R.val[i] = table_.number(row, format("r%d%d", i/3 + 1, i % 3 + 1));
        if (!(norm(R*R.t() - Matx33d::eye()) <= ORTHONORMAL && determinant(R) > 0))     // also where that is NaN
            throw Failure(table_.where(row) + ": r11 to r33 are no rotation");
        return rotationVector(R);
    }

    KnownPose poseOf(const CsvTable::Row& row) const
    {
        KnownPose pose;
        pose.rvec = rotationOf(row);
        for (int i = 0; i < 3; i++)
            pose.tvec[i] = table_.number(row, lengths_[i].column)*lengths_[i].factor;
        if (!sigma_.column.empty())
            pose.covariance = covarianceOf(row, pose.rvec);
        return pose;
    }

    //! Turned by a small rotation with equal deviations about all axes, and shifted.
    Mat covarianceOf(const CsvTable::Row& row, const Vec3d& rvec) const
    {
        const auto deviation = [&](const std::string& column) {
            const double value = table_.numberOrNone(row, column);
            if (value < 0)
                throw Failure(table_.where(row) + ": " + column + " is a standard deviation, and not below 0");
            return std::isnan(value) ? 0. : value;
        };
        const double turn = deviation("sigma_deg")*CV_PI/180., shift = deviation(sigma_.column)*sigma_.factor;
        if (turn == 0 && shift == 0)
            return Mat();
        if (turn == 0 || shift == 0)
            throw Failure(table_.where(row) + ": sigma_deg and " + sigma_.column + " must both be more than 0, or both 0 (exact)");
        const Matx33d J = refract::Rotation(rvec.val).rightJacobian();
        Mat covariance = Mat::eye(6, 6, CV_64F)*(shift*shift);
        Mat(turn*turn*(J.t()*J).inv()).copyTo(covariance(Rect(0, 0, 3, 3)));
        return covariance;
    }

    CsvTable table_;
    LengthColumn sigma_;
    std::vector<LengthColumn> lengths_;
};

//! Of the points of the views.
KnownPose moved(const KnownPose& given, const refract::NearOrigin& origin)
{
    refract::Pose pose;
    pose.rvec = given.rvec;
    pose.tvec = given.tvec;
    pose = origin.toNear(pose);
    if (!origin.isMoved() || given.covariance.empty())
        return {pose.rvec, pose.tvec, given.covariance};
    const Mat derivatives(origin.nearByFar(pose));
    return {pose.rvec, pose.tvec, Mat(derivatives*given.covariance*derivatives.t())};
}

} // namespace

void readPoses(const std::string& path, const std::string& unit, RigData& data)
{
    const std::map<std::string, KnownPose> poses = PosesFile(path, unit).poses();
    std::vector<std::string> missing;
    for (View& view : data.views)
    {
        const auto found = poses.find(view.stem);
        if (found == poses.end())
            missing.push_back(view.stem);
        else
            view.pose = moved(found->second, data.origin);
    }
    if (!missing.empty())
        throw Failure("'" + path + "' has no pose of view " + listed(missing) + ": with --poses every view needs one; leave the "
                      "others out of the images");
}

} // namespace tools
