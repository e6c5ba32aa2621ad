// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_FUZZ_SCRATCH_HPP
#define REFRACT_FUZZ_SCRATCH_HPP

#include "../temporary_folder.hpp"
#include <fstream>

namespace fuzz {

//! A folder of this process's own, removed at the end.
class Scratch : public TemporaryFolder
{
public:
    std::string write(const std::string& name, const std::string& content) const
    {
        const std::string path = *this/name;
        std::ofstream(path, std::ios::binary) << content;
        return path;
    }
};

} // namespace fuzz

#endif // REFRACT_FUZZ_SCRATCH_HPP
