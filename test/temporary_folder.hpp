// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TEST_TEMPORARY_FOLDER_HPP
#define REFRACT_TEST_TEMPORARY_FOLDER_HPP

#include <cstdlib>
#include <filesystem>
#include <stdexcept>
#include <string>

//! An empty folder of its own, removed at the end.
class TemporaryFolder
{
public:
    TemporaryFolder()
    {
        std::string name = (std::filesystem::temp_directory_path() / "refract-test-XXXXXX").string();
        if (!mkdtemp(&name[0]))
            throw std::runtime_error("cannot make a temporary folder");
        path_ = name;
    }
    ~TemporaryFolder()
    {
        std::error_code ignored;
        std::filesystem::remove_all(path_, ignored);
    }
    const std::filesystem::path& path() const { return path_; }
    std::string operator/(const std::string& file) const { return (path_/file).string(); }
    //! Names of all files in it, to find half-written ones.
    size_t count() const
    {
        return std::distance(std::filesystem::directory_iterator(path_), std::filesystem::directory_iterator());
    }
private:
    std::filesystem::path path_;
};

#endif // REFRACT_TEST_TEMPORARY_FOLDER_HPP
