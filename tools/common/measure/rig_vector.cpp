// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "measure/rig_vector.hpp"
#include "calibrate/parameter_columns.hpp"
#include "calibrate/window_face.hpp"
#include <algorithm>

using namespace cv;
using namespace cv::refract;

namespace tools {

namespace {

void put(const Vec3d& values, int first, VectorXd& numbers)
{
    for (int i = 0; i < 3; i++)
        numbers[first + i] = values[i];
}

Vec3d get(const VectorXd& numbers, int first) { return Vec3d(numbers[first], numbers[first + 1], numbers[first + 2]); }

//! The first camera that looks through a camera's window.
int ownerOf(const RigModel& rig, int camera)
{
    int owner = 0;
    while (!rig.sharesWindow(owner, camera))
        owner++;
    return owner;
}

RigidTransform placeOfCamera(const RigModel& rig, int camera, const VectorXd& numbers)
{
    const int at = extrinsicsColumn(rig, camera);
    return camera == 0 ? RigidTransform() : transformOf(get(numbers, at), get(numbers, at + 3));
}

void setLens(RigModel& rig, int camera, const VectorXd& numbers)
{
    const ParameterColumns at = columnsOf(rig, camera);
    rig.cameras[camera]->setLensParameters(toMat(numbers.segment(at.lens, at.lensCount)));
}

void setTargets(RigModel& rig, const VectorXd& numbers)
{
    const int at = columnCount(rig);
    rig.targetScale = numbers[at];
    rig.targetMotion = transformOf(get(numbers, at + 1), get(numbers, at + 4));
}

//! Numbers of a shared window for a camera that does not own it.
VectorXd windowNumbersOf(const RigModel& rig, int owner, int camera, const VectorXd& numbers)
{
    const RigidTransform there = fromTo(placeOfCamera(rig, owner, numbers), placeOfCamera(rig, camera, numbers));
    const GlassWindow shared = windowOf(rig.cameras[owner]->window(), columnsOf(rig, owner), numbers.data());
    const ParameterColumns at = columnsOf(*rig.cameras[camera]);
    VectorXd window = VectorXd::Zero(at.end);
    putWindow(seenFrom(shared, there), at, window.data());
    return window.tail(at.end - at.window);
}

} // namespace

int rigVectorSize(const RigModel& rig) { return columnCount(rig) + TARGET_ERRORS; }

VectorXd toVector(const RigModel& rig)
{
    VectorXd numbers(rigVectorSize(rig));
    for (int c = 0; c < (int)rig.cameras.size(); c++)
    {
        const ParameterColumns at = columnsOf(rig, c);
        numbers.segment(at.lens, at.lensCount) = toEigen(rig.cameras[c]->lensParameters());
        putWindow(rig.cameras[c]->window(), at, numbers.data());
        if (c == 0)
            continue;
        put(rotationVector(rig.extrinsics[c].R), extrinsicsColumn(rig, c), numbers);
        put(rig.extrinsics[c].T, extrinsicsColumn(rig, c) + 3, numbers);
    }
    const int targets = columnCount(rig);
    numbers[targets] = rig.targetScale;
    put(rotationVector(rig.targetMotion.R), targets + 1, numbers);
    put(rig.targetMotion.T, targets + 4, numbers);
    return numbers;
}

VectorXd parametersOf(const RigModel& rig)
{
    const VectorXd numbers = toVector(rig);
    return rig.targetCovariance.empty() ? VectorXd(numbers.head(columnCount(rig))) : numbers;
}

void setParameters(RigModel& rig, const VectorXd& p)
{
    for (int c = 0; c < (int)rig.cameras.size(); c++)
    {
        setLens(rig, c, p);
        rig.cameras[c]->setWindow(windowOf(rig.cameras[c]->window(), columnsOf(rig, c), p.data()));
        if (c > 0)
            rig.extrinsics[c] = placeOfCamera(rig, c, p);
    }
    if (!rig.targetCovariance.empty())
        setTargets(rig, p);
}

RigModel withVector(const RigModel& rig, const VectorXd& numbers)
{
    RigModel result = rig.clone();
    for (int c = 1; c < (int)rig.cameras.size(); c++)
        result.extrinsics[c] = placeOfCamera(rig, c, numbers);
    for (int c = 0; c < (int)rig.cameras.size(); c++)
    {
        const ParameterColumns at = columnsOf(rig, c);
        setLens(result, c, numbers);
        const int owner = ownerOf(rig, c);
        GlassWindow window = windowOf(rig.cameras[c]->window(), at, numbers.data());
        if (owner < c)
            window = seenFrom(result.cameras[owner]->window(), fromTo(result.extrinsics[owner], result.extrinsics[c]));
        window.distance = std::max(0., window.distance);        // between equal media any will do, and 0 is given
        result.cameras[c]->setWindow(window);
    }
    setTargets(result, numbers);
    return result;
}

MatrixXd consistentChanges(const RigModel& rig)
{
    const VectorXd numbers = toVector(rig);
    MatrixXd changes = MatrixXd::Identity(numbers.size(), numbers.size());
    for (int c = 0; c < (int)rig.cameras.size(); c++)
    {
        const ParameterColumns at = columnsOf(rig, c);
        if (rig.ownsWindow(c))
        {
            for (int column : {at.normal, at.axis})         // unit vectors
                if (at.has(column))
                {
                    const Eigen::Vector3d unit = numbers.segment<3>(column);
                    changes.block<3, 3>(column, column) -= unit*unit.transpose();
                }
            continue;
        }
        // Only the rows of this camera's window, which is a few products of the rest: by differences.
        const double STEP = 1e-6;
        const int owner = ownerOf(rig, c);
        changes.middleRows(at.window, at.end - at.window).setZero();
        std::vector<int> columns;
        for (int i = columnsOf(rig, owner).window; i < columnsOf(rig, owner).end; i++)
            columns.push_back(i);
        for (int camera : {owner, c})
            for (int i = 0; i < 6 && camera > 0; i++)
                columns.push_back(extrinsicsColumn(rig, camera) + i);
        for (int column : columns)
        {
            VectorXd more = numbers, less = numbers;
            more[column] += STEP;
            less[column] -= STEP;
            changes.block(at.window, column, at.end - at.window, 1) =
                (windowNumbersOf(rig, owner, c, more) - windowNumbersOf(rig, owner, c, less))/(2.*STEP);
        }
    }
    return changes;
}

} // namespace tools
