// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_FUZZ_FILE_HARNESS_HPP
#define REFRACT_FUZZ_FILE_HARNESS_HPP

#include "console/failure.hpp"
#include "harness.hpp"
#include "scratch.hpp"

/* The harness of a parser: the input is the whole file. It defines EXTENSION and tryFile(). */
namespace fuzz {

extern const char EXTENSION[];
void tryFile(const std::string& path);

inline const Scratch& scratch()
{
    static const Scratch folder;
    return folder;
}

inline void tryInput(Bytes& bytes)
{
    const std::string path = scratch().write(std::string("input") + EXTENSION, bytes.rest());
    try
    {
        tryFile(path);
    }
    catch (const tools::Failure&)       // refused, in a sentence
    {
    }
}

} // namespace fuzz

#endif // REFRACT_FUZZ_FILE_HARNESS_HPP
