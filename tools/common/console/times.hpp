// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_TIMES_HPP
#define REFRACT_TOOLS_TIMES_HPP

#include <string>
#include <vector>

/* Times in files and on command lines, as ISO 8601 writes them in UTC: 2026-11-26T08:30:00Z. */
namespace tools {

//! 2026-11-26, 2026-11-26T08:30, 2026-11-26T08:30:00Z or ...+01:00 -> UTC. Throws Failure for anything else.
std::string parseTime(const std::string& text, const std::string& option);
//! Throws Failure unless it is YYYY-MM-DD, a day that there is.
void requireDate(const std::string& date, const std::string& option);
//! Throws Failure for a time that is still to come; a day alone may be that of any place on earth. @param text as it was given
void requirePast(const std::string& text, const std::string& option);

//! That of now, or of SOURCE_DATE_EPOCH if it is set.
std::string timeOfNow();
/** The time that outputs carry, ISO 8601 UTC: that of SOURCE_DATE_EPOCH, if set, else of the newest input, so that the same
input gives the same bytes. */
std::string timeOfFiles(const std::vector<std::string>& inputs);
//! Seconds since 1970. @param time in UTC
double secondsOf(const std::string& time);
std::string timeAt(double seconds);

} // namespace tools

#endif // REFRACT_TOOLS_TIMES_HPP
