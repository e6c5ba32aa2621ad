// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "console/cli.hpp"
#include "console/exif.hpp"
#include "console/leftovers.hpp"
#include "console/settings_file.hpp"

#include <opencv2/core/utils/logger.hpp>
#include <algorithm>
#include <charconv>
#include <cmath>
#include <iostream>
#include <limits>
#include <locale>
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

//! Of what is left over after parsing; empty if there is none.
std::string unknownOption(const CLI::App& app)
{
    for (const std::string& left : app.remaining())
        if (left.size() > 1 && left[0] == '-')
            return "there is no option " + left;
    return "";
}

} // namespace

Command::Command(int argc, char** argv, const std::string& manual)
    : app(manual, argc > 0 ? stripFolder(argv[0]) : "")
{
    for (int i = 0; i < argc; i++)
        line_ += (i ? " " : "") + quoted(i ? argv[i] : app.get_name());
    for (int i = argc - 1; i > 0; i--)      // CLI11 takes them in reverse
        arguments_.push_back(argv[i]);
    app.set_version_flag("--version", app.get_name() + " " REFRACT_VERSION " (OpenCV " CV_VERSION ")");
    app.add_flag("--quiet", quiet_, "no progress, no table: errors and warnings only");
    settingsFile_ = std::make_shared<SettingsFile>(app);
    app.config_formatter(settingsFile_);
    app.set_config("--config", "", "settings file (TOML): options without dashes, as size = \"6x5\", one a line; the command line goes "
                   "first")->type_name("FILE");
    app.get_formatter()->column_width(34);
}

std::string Command::stripFolder(const std::string& path)
{
    return path.substr(path.find_last_of('/') + 1);
}

void Command::parse()
{
    try
    {
        app.parse(arguments_);
    }
    catch (const CLI::FileError&)
    {
        throw Failure("--config: there is no such file, or it cannot be read: check folder and name");
    }
    settings_ = app.get_config_ptr()->count() ? app.get_config_ptr()->as<std::string>() : "";
    for (const std::string& argument : settingsFile_->arguments())
        line_ += " " + quoted(argument);
}

void Command::warn(const std::string& text) const
{
    std::cerr << app.get_name() << ": warning: " << text << std::endl;
}

int runTool(int argc, char** argv, const std::string& manual, const std::function<int(Command&)>& body)
{
    // What goes wrong is said once, in the exception; OpenCV's log would repeat it in its own words.
    cv::utils::logging::setLogLevel(cv::utils::logging::LOG_LEVEL_SILENT);
    removeLeftoversOnSignals();
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
    catch (const CLI::Success& e)       // --help, --version
    {
        return command.app.exit(e);
    }
    catch (const CLI::ParseError& e)
    {
        error = unknownOption(command.app);     // which may be why something else is missing
        if (error.empty())
            error = oneLine(e.what());
        error += " (see " + command.app.get_name() + " --help)";
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
    std::cerr << command.app.get_name() << ": " << error << std::endl;
    sayRotated();           // it may be why
    return CANNOT;
}

} // namespace tools
