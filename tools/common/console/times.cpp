// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "console/times.hpp"
#include "console/failure.hpp"
#include <opencv2/core.hpp>
#include <sys/stat.h>
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <iomanip>
#include <sstream>

using cv::format;

namespace tools {

double secondsOf(const std::string& time)
{
    std::tm parts = {};
    std::istringstream in(time);
    in.imbue(std::locale::classic());
    in >> std::get_time(&parts, "%Y-%m-%dT%H:%M:%SZ");
    return (double)timegm(&parts);
}

std::string timeAt(double seconds)
{
    const std::time_t time = (std::time_t)seconds;
    std::tm parts = {};
    gmtime_r(&time, &parts);
    std::ostringstream out;
    out.imbue(std::locale::classic());
    out << std::put_time(&parts, "%Y-%m-%dT%H:%M:%SZ");
    return out.str();
}

//! That of SOURCE_DATE_EPOCH, if it is set.
static std::string timeOr(std::time_t otherwise)
{
    const char* epoch = std::getenv("SOURCE_DATE_EPOCH");
    return timeAt(epoch && *epoch ? (double)std::strtoll(epoch, nullptr, 10) : (double)otherwise);
}

std::string timeOfNow() { return timeOr(std::time(nullptr)); }

std::string timeOfFiles(const std::vector<std::string>& inputs)
{
    std::time_t newest = 0;
    struct stat status;
    for (const std::string& file : inputs)
        if (stat(file.c_str(), &status) == 0)
            newest = std::max(newest, status.st_mtime);
    return timeOr(newest);
}

std::string parseTime(const std::string& text, const std::string& option)
{
    int year = 0, month = 0, day = 0, hour = 0, minute = 0, second = 0, zoneHour = 0, zoneMinute = 0, end = 0, at = 0;
    char sign[2] = "+";
    bool isGood = std::sscanf(text.c_str(), "%4d-%2d-%2d%n", &year, &month, &day, &end) == 3;
    if (isGood && text[end] == 'T')
    {
        isGood = std::sscanf(text.c_str() + end, "T%2d:%2d%n", &hour, &minute, &at) == 2;
        end += at;
        if (isGood && std::sscanf(text.c_str() + end, ":%2d%n", &second, &at) == 1)
            end += at;
        if (isGood && text[end] == 'Z')
            end++;
        else if (isGood && std::sscanf(text.c_str() + end, "%1[+-]%2d:%2d%n", sign, &zoneHour, &zoneMinute, &at) == 3)
            end += at;
    }
    if (!isGood || (size_t)end != text.size())
        throw Failure(option + "=" + text + ": give a time as 2026-11-26, 2026-11-26T08:30:00Z or 2026-11-26T09:30+01:00");
    const std::string written = format("%04d-%02d-%02dT%02d:%02d:%02dZ", year, month, day, hour, minute, second);
    // A day that there is comes back as it was.
    if (timeAt(secondsOf(written)) != written || zoneHour > 14 || zoneMinute > 59)
        throw Failure(option + "=" + text + ": there is no such time");
    const double east = 60.*(60.*zoneHour + zoneMinute);
    return timeAt(secondsOf(written) - (sign[0] == '-' ? -east : east));
}

void requireDate(const std::string& date, const std::string& option)
{
    const size_t DAY = 10;                  // YYYY-MM-DD
    if (date.size() != DAY)
        throw Failure(option + "=" + date + ": give a day as year-month-day, as in " + option + "=2026-11-26");
    parseTime(date, option);
}

void requirePast(const std::string& text, const std::string& option)
{
    const size_t DAY = 10;
    const double AHEAD = 14.*3600., CLOCKS = 300.;      // of the earliest day on earth; by which clocks differ
    const double now = std::max((double)std::time(nullptr), secondsOf(timeOfNow()));         // SOURCE_DATE_EPOCH may be long ago
    const double later = secondsOf(parseTime(text, option)) - now;
    if (later > (text.size() == DAY ? AHEAD : CLOCKS))
        throw Failure(option + "=" + text + ": that is in the future, now is " + timeOfNow() + "; is the clock right?");
}

} // namespace tools
