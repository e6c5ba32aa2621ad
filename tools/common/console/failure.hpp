// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_FAILURE_HPP
#define REFRACT_TOOLS_FAILURE_HPP

#include <stdexcept>

namespace tools {

enum ExitCode {
    DONE = 0,           //!< done and within limits
    CANNOT = 1,         //!< could not do it; one sentence on stderr says why and what to do
    LIMIT_NOT_MET = 2   //!< done, but a limit that the caller set was not met, or the result is not to be trusted
};

//! Could not do it. what() is one sentence that says what is wrong and what to do.
class Failure : public std::runtime_error
{
public:
    using std::runtime_error::runtime_error;
};

} // namespace tools

#endif // REFRACT_TOOLS_FAILURE_HPP
