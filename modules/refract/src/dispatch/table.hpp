// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#ifndef OPENCV_REFRACT_KERNELS_TABLE_HPP
#define OPENCV_REFRACT_KERNELS_TABLE_HPP

#include "arrays/array_kernels.hpp"
#include "points/derivative_kernels.hpp"
#include "window/layer_kernels.hpp"
#include "lens/opencv_kernels.hpp"
#include "lens/fisheye_kernels.hpp"

namespace cv { namespace refract { namespace {

//! All kernels as compiled here. A constant: looking at it takes no instruction that a machine may not have.
const Kernels table = {
#if defined(__GNUC__) && defined(__AVX512DQ__)
    "AVX-512",
#elif defined(__GNUC__) && defined(__AVX2__)
    "AVX2",
#else
    "baseline",
#endif
    loadPoints, storePoints, transform, multiples, pinhole, meetPlane, chordRoots, areClose,
    traceOut, solveIn, chainWindow, chainLinear, interpolate, gaussNewton,
    projectOpenCV, unprojectOpenCV, projectJacobianOpenCV, projectFisheye, unprojectFisheye, projectJacobianFisheye
};

}}} // namespace

#endif // OPENCV_REFRACT_KERNELS_TABLE_HPP
