// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "console/file_lock.hpp"
#include "console/failure.hpp"
#include <cerrno>
#include <cstring>
#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

namespace tools {

FileLock::FileLock(const std::string& file, int descriptor) : file_(file), descriptor_(descriptor) {}

//! The file that was opened must still be the one of that name: the other takes it away with itself.
static bool isStillNamed(int descriptor, const std::string& file)
{
    struct stat opened = {}, named = {};
    return fstat(descriptor, &opened) == 0 && stat(file.c_str(), &named) == 0 && opened.st_ino == named.st_ino;
}

std::unique_ptr<FileLock> FileLock::tryOnce(const std::string& file)
{
    const int TRIES = 10;
    for (int i = 0; i < TRIES; i++)
    {
        int descriptor = open(file.c_str(), O_CREAT | O_RDWR | O_CLOEXEC, 0666);
        if (descriptor < 0 && errno == EACCES)      // another user left it
            descriptor = open(file.c_str(), O_RDONLY | O_CLOEXEC);
        if (descriptor < 0)
            throw Failure("cannot write '" + file + "', which keeps two runs at once apart: " + std::strerror(errno));
        const bool isTaken = flock(descriptor, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK;      // else: locked, or no locks here
        if (!isTaken && isStillNamed(descriptor, file))
            return std::unique_ptr<FileLock>(new FileLock(file, descriptor));
        close(descriptor);
        if (isTaken)
            return nullptr;
    }
    return nullptr;
}

FileLock::~FileLock()
{
    unlink(file_.c_str());
    close(descriptor_);
}

} // namespace tools
