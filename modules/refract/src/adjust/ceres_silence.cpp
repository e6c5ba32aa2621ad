// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#include "adjust/ceres_silence.hpp"
#include <ceres/version.h>
#include <mutex>

// From 2.3 on Ceres has other logs than glog.
#if CERES_VERSION_MAJOR == 2 && CERES_VERSION_MINOR < 3 && defined(__has_include)
#if __has_include(<glog/logging.h>)
#define GLOG_NO_ABBREVIATED_SEVERITIES
#include <glog/logging.h>
#endif
#endif

namespace cv { namespace refract {

// A macro that Ceres' small replacement of glog does not have: what is as loud as that is chosen when Ceres is compiled.
#ifdef COMPACT_GOOGLE_LOG_INFO

static std::mutex mutex;
static int count = 0, before = 0;       // of all threads

Silence::Silence()
{
    const std::lock_guard<std::mutex> lock(mutex);
    if (count++ == 0)
    {
        before = FLAGS_minloglevel;
        FLAGS_minloglevel = google::GLOG_FATAL;
    }
}

Silence::~Silence()
{
    const std::lock_guard<std::mutex> lock(mutex);
    if (--count == 0)
        FLAGS_minloglevel = before;
}

#else

Silence::Silence() {}
Silence::~Silence() {}

#endif

}} // namespace
