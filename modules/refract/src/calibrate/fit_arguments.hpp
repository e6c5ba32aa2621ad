// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#ifndef OPENCV_REFRACT_FIT_ARGUMENTS_HPP
#define OPENCV_REFRACT_FIT_ARGUMENTS_HPP

#include "arrays/extrinsics.hpp"
#include "calibrate/pair_check.hpp"

namespace cv { namespace refract {

// Arguments that several public calibrators have: checks, and what is read of them.

const int FIX_FLAGS = GLASS_FIX_FOCAL_LENGTH | GLASS_FIX_PRINCIPAL_POINT | GLASS_FIX_K1 | GLASS_FIX_K2 | GLASS_FIX_K3 |
                      GLASS_FIX_K4 | GLASS_FIX_K5 | GLASS_FIX_K6 | GLASS_FIX_TANGENT_DIST | GLASS_FIX_S1_S2_S3_S4 |
                      GLASS_FIX_TAUX_TAUY;
const int MONO_FLAGS = GLASS_FREE_THICKNESS | GLASS_FREE_INDEX | GLASS_FREE_DISTANCE | GLASS_FREE_OUTER_INDEX | GLASS_FREE_WEDGE |
                       GLASS_FREE_RADIUS | GLASS_FREE_CURVATURE |
                       GLASS_FREE_INTRINSICS | FIX_FLAGS | GLASS_ROBUST | GLASS_REQUIRE_WINDOW | GLASS_REQUIRE_INTRINSICS |
                       GLASS_REQUIRE_EXTRINSICS;

void checkFlags(int flags, int allowed);

//! What flags free and a pane has not gets the value 0, so that it is among its parameters: a wedge, a curvature.
void addParameters(std::vector<Camera>& cameras, int flags);

/** Refuses windows and flags of which no data can tell, and windows that nobody looked through.
@param isSeen of each camera: it sees a point
@param names of each camera's refracted views */
void checkWindows(const Rig& rig, const RigViews& views, int flags, const std::vector<String>& names);
void checkWindows(const Rig& rig, const std::vector<bool>& isSeen, int flags, const std::vector<String>& names);

//! One entry per camera; fewer only if it may be left out altogether.
void checkCount(size_t count, int expected, const char* name, bool mayBeEmpty);

//! What all cameras saw; either list may be empty as a whole, but not both.
RigViews readRigViews(InputArrayOfArrays objectPoints, const std::vector<std::vector<Mat> >& imagePointsDirect,
                      const std::vector<std::vector<Mat> >& imagePointsRefracted, int cameras,
                      HalfPixels halves = HalfPixels::NOT_SEEN);

//! Covariances of what was read, as imagePointsDirect and imagePointsRefracted have it; nothing if there are none.
void addPixelCovariances(const std::vector<std::vector<Mat> >& direct, const std::vector<std::vector<Mat> >& refracted,
                         RigViews& views);

//! Whether R and T of some camera are estimated.
bool areExtrinsicsFree(int flags, const Rig& rig, const std::vector<CameraPrior>& priors);

//! The cameras behind the handles, each of which must be an object of its own; names in messages.
std::vector<Camera> camerasOf(const std::vector<Ptr<RefractiveCamera> >& handles, const std::vector<String>& names);
void setCameras(const Rig& rig, const std::vector<Ptr<RefractiveCamera> >& handles);
//! The first camera that looks through the same window; as many layers as it are given to the others. Empty: each its own.
void setOwners(Rig& rig, const std::vector<int>& windowOfCamera);

std::vector<Pose> readExtrinsicPoses(InputArrayOfArrays Rs, InputArrayOfArrays Ts, int cameras);
void writeExtrinsicPoses(const Rig& rig, InputOutputArrayOfArrays Rs, InputOutputArrayOfArrays Ts);

}} // namespace

#endif // OPENCV_REFRACT_FIT_ARGUMENTS_HPP
