// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "console/cli.hpp"
#include "console/images.hpp"

#include <opencv2/core/utils/logger.hpp>
#include <algorithm>
#include <charconv>
#include <iostream>
#include <sstream>

namespace tools {

namespace {

std::string quoted(const std::string& argument)
{
    const char* plain = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789-_=./,:+%@";
    if (!argument.empty() && argument.find_first_not_of(plain) == std::string::npos)
        return argument;
    std::string result = "'";
    for (char c : argument)
        result += c == '\'' ? std::string("'\\''") : std::string(1, c);
    return result + "'";
}

//! OpenCV's checks speak in several lines that begin with '>'.
std::string oneLine(const std::string& text)
{
    std::istringstream words(text);
    std::string result, word;
    while (words >> word)
        if (word != ">")
            result += (result.empty() ? "" : " ") + word;
    return result;
}

} // namespace

Command::Command(int argc, char** argv, const std::string& manual)
    : parser(manual, argc > 0 ? stripFolder(argv[0]) : ""), arguments_(argv + std::min(argc, 1), argv + argc), line_(quoted(parser.name()))
{
    for (const std::string& argument : arguments_)
        line_ += " " + quoted(argument);
    parser.addVersion(parser.name() + " " REFRACT_VERSION " (OpenCV " CV_VERSION ")");
    parser.addFlag("--quiet", quiet_, "no progress, no table: errors and warnings only");
    parser.addSettingsFile("settings file (TOML): options without dashes, as size = \"6x5\", one a line; the command line goes first");
}

std::string Command::stripFolder(const std::string& path)
{
    return path.substr(path.find_last_of('/') + 1);
}

void Command::parse()
{
    parser.parse(arguments_);
    settings_ = parser.settings();
    for (const std::string& argument : parser.settingsArguments())
        line_ += " " + quoted(argument);
}

void Command::warn(const std::string& text) const
{
    std::cerr << parser.name() << ": warning: " << text << std::endl;
}

int runTool(int argc, char** argv, const std::string& manual, const std::function<int(Command&)>& body)
{
    // What goes wrong is said once, in the exception; OpenCV's log would repeat it in its own words, and does to those who ask it to.
    if (!std::getenv("OPENCV_LOG_LEVEL"))
        cv::utils::logging::setLogLevel(cv::utils::logging::LOG_LEVEL_SILENT);
    Command command(argc, argv, manual);
    const auto sayRotated = [&command] {
        const std::string turned = takeRotationNotice();
        if (!turned.empty())
            command.warn(turned);
    };
    std::string error;
    try
    {
        const int code = body(command);
        if (!std::cout.flush())
            throw Failure("the output could not be written: is the disk full?");
        sayRotated();
        return code;
    }
    catch (const OptionParser::Answer& answer)
    {
        std::cout << answer.text << std::flush;
        return DONE;
    }
    catch (const cv::Exception& e)
    {
        error = oneLine(e.err);
    }
    catch (const std::bad_alloc&)
    {
        error = "not enough memory: use fewer or smaller images";
    }
    catch (const std::exception& e)
    {
        error = oneLine(e.what());
    }
    std::cerr << command.parser.name() << ": " << error << std::endl;
    sayRotated();           // it may be why
    return CANNOT;
}

} // namespace tools
