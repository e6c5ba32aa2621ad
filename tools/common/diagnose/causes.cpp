// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "diagnose/causes.hpp"
#include "measure/rig_vector.hpp"
#include "calibrate/parameter_columns.hpp"
#include "console/table.hpp"
#include <algorithm>
#include <cmath>

using namespace cv;
using namespace cv::refract;

namespace tools {

namespace {

const double DEGREES = 180./CV_PI;

//! About the middle of what the cameras saw, so that a turn moves the boards little.
Vec3d middleOf(const Fit& fit)
{
    Vec3d sum;
    for (const Vec3d& tvec : fit.tvecs)
        sum += tvec;
    return sum*(1./std::max<size_t>(1, fit.tvecs.size()));
}

std::vector<Shift> motionAbout(const Vec3d& middle, int first, bool turns)
{
    std::vector<Shift> shifts;
    for (int k = 0; k < 3; k++)
        shifts.push_back({{{first + 3 + k, 1.}}});
    for (int k = 0; k < 3 && turns; k++)
    {
        Vec3d axis;
        axis[k] = 1.;
        const Vec3d along = -axis.cross(middle);
        shifts.push_back({{{first + k, 1.}, {first + 3, along[0]}, {first + 4, along[1]}, {first + 5, along[2]}}});
    }
    return shifts;
}

//! All boards, or the mount of the cameras, between direct images and those through the windows.
void addMotion(const FittedRig& rig, std::vector<Cause>& causes)
{
    if (rig.data.countPairs() == 0)
        return;
    const Vec3d middle = middleOf(rig.fit);
    const int first = columnCount(rig.fit.rig) + 1;
    const double known = rig.options.std.placement;
    for (bool turns : {false, true})
        causes.push_back({"motion", motionAbout(middle, first, turns), [=](const Relaxed& found, double deviations) {
            const RigidTransform& motion = found.glass.targetMotion;
            const Vec3d moved = motion.apply(middle) - middle, turned = DEGREES*rotationVector(motion.R);
            // Where it turns, its columns are those of the camera's centre: the +- about the middle is that of the shifts.
            const int of = turns ? (int)found.covariance.rows() - 6 : first + 3;
            std::string text;
            for (int k = 0; k < 3; k++)
                text += (k ? ", " : "") + plusMinus(moved[k], stdOfSum(found, {of + k}));
            return format("the images contradict --placement-std=%.2g: between direct and glass images all boards (or the cameras' mount) "
                          "moved by (", known) + text + ")" + (turns ? format(", turned by %.3f degrees", norm(turned)) : std::string())
                + howSure(deviations); }});
}

//! fx and fy together.
Shift focusOf(const FittedRig& rig, int camera, bool glassOnly)
{
    const int lens = columnsOf(rig.fit.rig, camera).lens;
    const VectorXd values = toVector(rig.fit.rig);
    return {{{lens, values[lens]}, {lens + 1, values[lens + 1]}}, glassOnly};
}

void addLenses(const FittedRig& rig, std::vector<Cause>& causes)
{
    const double TELLING = 3.;          // standard deviations of a parameter alone
    for (int c = 0; c < rig.data.cameraCount; c++)
    {
        const std::string where = ofCamera(c, rig.data.cameraCount), suffix = cameraSuffix(c);
        const ParameterColumns at = columnsOf(rig.fit.rig, c);
        if (at.lensCount < 4)
            continue;
        const auto factor = [](const Relaxed& found) {
            return plusMinus(1. + found.shifts[0], stdOfSum(found, {(int)found.covariance.rows() - 1})); };
        if (rig.hasBothStates(c))
            causes.push_back({format("focus %d", c), {focusOf(rig, c, true)}, [=](const Relaxed& found, double deviations) {
                return "the focus or zoom" + where + " changed: through the window the focal length is " + factor(found)
                    + " times that of the direct images" + howSure(deviations); }});
        if (!rig.options.known[c] || rig.options.knownCovariance[c].empty() == ((rig.options.flags & GLASS_FREE_INTRINSICS) != 0))
            continue;           // it is free
        causes.push_back({format("lens focus %d", c), {focusOf(rig, c, false)}, [=](const Relaxed& found, double deviations) {
            return "the images contradict --camera" + suffix + ": set free, the focal length would be " + factor(found) + " times that of "
                "the file" + howSure(deviations); }});
        std::vector<Shift> lens;
        for (int i = 0; i < at.lensCount; i++)
            lens.push_back({{{at.lens + i, 1.}}});
        const VectorXd given = toVector(rig.fit.rig);
        const bool isExact = rig.options.knownCovariance[c].empty();
        const std::vector<String> names = rig.fit.rig.cameras[c]->parameterNames();
        causes.push_back({format("lens focus %d", c), lens, [=](const Relaxed& found, double deviations) {
            const VectorXd values = toVector(found.glass);
            const auto moved = [&](int i) {
                return std::abs(values[at.lens + i] - given[at.lens + i])/stdOfSum(found, {at.lens + i}); };
            int most = 0;               // what the file errs in: the others change as they are tied to it
            for (int i = 1; i < at.lensCount; i++)
                most = moved(i) > moved(most) ? i : most;
            const std::string contradicted = "the images contradict --camera" + suffix + ": set free, the lens would ";
            if (!(moved(most) > TELLING))
                return contradicted + "differ as a whole, though in no parameter alone" + howSure(deviations);
            return contradicted + "have " + names[most] + " = "
                + plusMinus(values[at.lens + most], stdOfSum(found, {at.lens + most}))
                + (isExact ? format(" in place of %.5g", given[at.lens + most]) : std::string()) + howSure(deviations); }});
    }
}

//! A camera in its place of the rig, in the images through the windows.
std::vector<Shift> placeOfCamera(const RigModel& rig, int camera)
{
    std::vector<Shift> shifts;
    if (camera > 0)
    {
        for (int k = 0; k < 6; k++)
            shifts.push_back({{{extrinsicsColumn(rig, camera) + k, 1.}}, true});
        return shifts;
    }
    // Camera 1 is the frame: the boards move, and the other cameras with them.
    const double STEP = 1e-6;
    const int motion = columnCount(rig) + 1;
    for (int k = 0; k < 6; k++)
    {
        Vec6d back;
        back[k] = -STEP;
        const RigidTransform inverse = transformOf(Vec3d(back[0], back[1], back[2]), Vec3d(back[3], back[4], back[5]));
        Shift shift{{{motion + k, 1.}}, true};
        for (int c = 1; c < (int)rig.cameras.size(); c++)
        {
            const RigidTransform moved = rig.extrinsics[c]*inverse;
            const Vec3d turned = (rotationVector(moved.R) - rotationVector(rig.extrinsics[c].R))*(1./STEP);
            const Vec3d shifted = (moved.t - rig.extrinsics[c].t)*(1./STEP);
            for (int i = 0; i < 3; i++)
            {
                shift.numbers.push_back({extrinsicsColumn(rig, c) + i, turned[i]});
                shift.numbers.push_back({extrinsicsColumn(rig, c) + 3 + i, shifted[i]});
            }
        }
        shifts.push_back(shift);
    }
    return shifts;
}

void addPlaces(const FittedRig& rig, std::vector<Cause>& causes)
{
    for (int c = 0; c < rig.data.cameraCount && rig.data.cameraCount > 1; c++)
        if (rig.hasBothStates(c))
            causes.push_back({format("place %d", c), placeOfCamera(rig.fit.rig, c), [=](const Relaxed& found, double deviations) {
                const int other = c > 0 ? c : 1;
                const RigidTransform &before = found.direct.extrinsics[other], &after = found.glass.extrinsics[other];
                const double turned = DEGREES*norm(rotationVector(after.R*before.R.t()));
                const double moved = norm(after.R.t()*after.t - before.R.t()*before.t);
                return format("camera %d moved in the rig between direct and glass images: it turned by %.3g degrees and moved by %.2g",
                              c + 1, turned, moved) + howSure(deviations); }});
}

void addTarget(const FittedRig& rig, std::vector<Cause>& causes)
{
    const int scale = columnCount(rig.fit.rig);
    const double square = squareOf(rig.data);
    causes.push_back({"square", {{{{scale, 1.}}}}, [=](const Relaxed& found, double deviations) {
        const double factor = found.glass.targetScale, std = stdOfSum(found, {scale});
        return (square > 0. ? format("the images contradict --square=%.5g: set free, it would be ", square)
                + plusMinus(square*factor, square*std) : "the images contradict the size of the target: set free, it would be "
                + plusMinus(factor, std) + " times as large") + unitHint(factor) + howSure(deviations); }});
}

void addPoses(const FittedRig& rig, std::vector<Cause>& causes)
{
    if (!(rig.options.flags & GLASS_USE_POSES))
        return;
    const bool exact = std::all_of(rig.fit.views.begin(), rig.fit.views.end(), [&](int m) {
        return rig.data.views[m].pose && rig.data.views[m].pose->covariance.empty(); });
    causes.push_back({"poses", {}, [=](const Relaxed&, double) {
        return std::string("the images contradict --poses, which are taken as ")
            + (exact ? "exact: give their uncertainty in the columns sigma_deg and sigma, or measure them again"
               : "exact as sigma_deg and sigma say: measure them again, or say more"); }, true});
}

} // namespace

std::vector<Cause> causesOf(const RigData& data, const RigOptions& options, const Fit& fit)
{
    const FittedRig rig{data, options, fit};
    std::vector<Cause> causes;
    addValues(rig, causes);
    addKnownPlaces(rig, causes);
    addWedges(rig, causes);
    addBows(rig, causes);
    addMotion(rig, causes);
    addLenses(rig, causes);
    addPlaces(rig, causes);
    addTarget(rig, causes);
    addPoses(rig, causes);
    return causes;
}

} // namespace tools
