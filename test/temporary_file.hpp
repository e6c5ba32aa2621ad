// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TEST_TEMPORARY_FILE_HPP
#define REFRACT_TEST_TEMPORARY_FILE_HPP

#include <opencv2/core/utility.hpp>
#include <cstdio>
#include <fstream>
#include <string>

//! A file that is gone when the test is over.
struct TemporaryFile
{
    explicit TemporaryFile(const std::string& suffix, const std::string& text = "") : path(cv::tempfile(suffix.c_str()))
    {
        std::ofstream(path, std::ios::binary) << text;
    }
    ~TemporaryFile() { std::remove(path.c_str()); }
    const std::string path;
};

#endif // REFRACT_TEST_TEMPORARY_FILE_HPP
