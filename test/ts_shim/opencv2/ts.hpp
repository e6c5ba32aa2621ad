// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

// What modules/refract/test needs of OpenCV's test module, over googletest: distributions do not ship opencv_ts. With it
// the module's own tests run standalone too.
#ifndef REFRACT_TS_SHIM_HPP
#define REFRACT_TS_SHIM_HPP

#include <gtest/gtest.h>
#include <opencv2/core.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

namespace cvtest {

using cv::norm;

//! As OpenCV's tests: the same random numbers in every test.
class Seed : public testing::EmptyTestEventListener
{
    void OnTestStart(const testing::TestInfo&) override { cv::theRNG() = cv::RNG(0x12345678); }
};

inline int run(int argc, char** argv)
{
    testing::InitGoogleTest(&argc, argv);
    testing::UnitTest::GetInstance()->listeners().Append(new Seed);
    return RUN_ALL_TESTS();
}

} // namespace cvtest

namespace opencv_test {
using namespace cv;
}

#define CV_TEST_MAIN(resources) int main(int argc, char** argv) { return cvtest::run(argc, argv); }

#endif // REFRACT_TS_SHIM_HPP
