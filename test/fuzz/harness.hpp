// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_FUZZ_HARNESS_HPP
#define REFRACT_FUZZ_HARNESS_HPP

#include "arguments.hpp"
#include <opencv2/core/utils/logger.hpp>
#include <algorithm>
#include <cstdio>
#include <cstdlib>

/* A harness is one file fuzz_NAME.cpp with a function tryInput(): it ends with an answer that holds what refract.hpp promises, or
with cv::Exception. Whatever else happens is a finding; broken() says which promise was broken. */
namespace fuzz {

void tryInput(Bytes& bytes);

//! The input's first byte says which.
inline void tryOneOf(Bytes& bytes, std::initializer_list<void (*)(Bytes&)> calls)
{
    calls.begin()[bytes.below((int)calls.size())](bytes);
}

[[noreturn]] inline void broken(const char* promise)
{
    std::fprintf(stderr, "FINDING: %s\n", promise);
    std::abort();
}

inline void promise(bool kept, const char* what)
{
    if (!kept)
        broken(what);
}

//! How many of the numbers of rows begin ... end - 1 are NaN; OpenCV's != takes NaN for equal to itself where AVX2 compares.
inline int countNaN(const cv::Mat& answer, int begin, int end)
{
    cv::Mat numbers;
    answer.rowRange(begin, end).reshape(1).convertTo(numbers, CV_64F);
    return (int)std::count_if(numbers.begin<double>(), numbers.end<double>(), [](double a) { return std::isnan(a); });
}

inline bool allNaN(const cv::Mat& answer, int i)
{
    return countNaN(answer, i, i + 1) == answer.cols*answer.channels();
}

/* An answer holds no NaN where its status is 0, else it is NaN in every coordinate. What is beyond the range of its type is
infinite, as in any arithmetic: a pixel behind a focal length of 1e300, say. */
inline void checkAnswer(const cv::Mat& answer, const cv::Mat& status)
{
    if (answer.empty() || status.empty())
        return;
    promise(answer.rows == (int)status.total(), "one status for each item of the answer");
    for (int i = 0; i < answer.rows; i++)
        if (status.at<uchar>(i) == cv::refract::REFRACT_OK)
            promise(countNaN(answer, i, i + 1) == 0, "status 0: no NaN");
        else
            promise(allNaN(answer, i), "status not 0: NaN in every coordinate");
}

} // namespace fuzz

extern "C" int LLVMFuzzerInitialize(int*, char***)
{
    cv::setNumThreads(1);       // the same input, the same path
    cv::utils::logging::setLogLevel(cv::utils::logging::LOG_LEVEL_SILENT);
    return 0;
}

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size)
{
    fuzz::Bytes bytes(data, size);
    try
    {
        fuzz::tryInput(bytes);
    }
    catch (const cv::Exception&)        // the arguments were refused
    {
    }
    return 0;
}

#endif // REFRACT_FUZZ_HARNESS_HPP
