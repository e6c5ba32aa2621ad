// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_FILE_LOCK_HPP
#define REFRACT_TOOLS_FILE_LOCK_HPP

#include <memory>
#include <string>

namespace tools {

/** What one process of several may have at a time: a file of this name, which goes with the lock. Where a signal ends the process the file
stays, and the lock goes. */
class FileLock
{
public:
    //! Null: another process has it. A file system without locks keeps nobody apart. Throws Failure if there can be no such file.
    static std::unique_ptr<FileLock> tryOnce(const std::string& file);
    ~FileLock();
    FileLock(const FileLock&) = delete;
    FileLock& operator=(const FileLock&) = delete;

private:
    FileLock(const std::string& file, int descriptor);

    std::string file_;
    int descriptor_;
};

} // namespace tools

#endif // REFRACT_TOOLS_FILE_LOCK_HPP
