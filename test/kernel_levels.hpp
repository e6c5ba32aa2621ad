// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

// The kernels of every instruction set that this machine has.
#ifndef REFRACT_TEST_KERNEL_LEVELS_HPP
#define REFRACT_TEST_KERNEL_LEVELS_HPP

#include "dispatch/kernels.hpp"
#include <opencv2/core.hpp>
#include <vector>

inline std::vector<const cv::refract::Kernels*> kernelLevels()
{
    using namespace cv::refract;
    std::vector<const Kernels*> levels(1, kernelsBaseline());
    if (cv::checkHardwareSupport(CV_CPU_AVX2) && cv::checkHardwareSupport(CV_CPU_FMA3) && kernelsAvx2())
        levels.push_back(kernelsAvx2());
    if (cv::checkHardwareSupport(CV_CPU_AVX512_SKX) && kernelsAvx512())
        levels.push_back(kernelsAvx512());
    return levels;
}

#endif // REFRACT_TEST_KERNEL_LEVELS_HPP
