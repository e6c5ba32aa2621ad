// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

// Ceres writes nothing while the library solves.
#include "adjust/ceres_silence.hpp"
#include <catch2/catch.hpp>
#include <opencv2/core/utility.hpp>

#if __has_include(<glog/logging.h>)
#pragma push_macro("CHECK")         // both have one
#undef CHECK
#define GLOG_NO_ABBREVIATED_SEVERITIES
#include <glog/logging.h>
#undef CHECK
#pragma pop_macro("CHECK")
#endif

#ifdef COMPACT_GOOGLE_LOG_INFO      // glog itself
TEST_CASE("Ceres is silent while it solves, in all threads, and as loud as before afterwards", "[calibrate_arguments][silence]")
{
    const int before = FLAGS_minloglevel;
    {
        const cv::refract::Silence outer;
        CHECK(FLAGS_minloglevel == google::GLOG_FATAL);
        {
            const cv::refract::Silence inner;
        }
        CHECK(FLAGS_minloglevel == google::GLOG_FATAL);
    }
    CHECK(FLAGS_minloglevel == before);
    cv::parallel_for_(cv::Range(0, 64), [](const cv::Range& range)
    {
        for (int i = range.start; i < range.end; i++)
            const cv::refract::Silence one;
    });
    CHECK(FLAGS_minloglevel == before);
}
#endif
