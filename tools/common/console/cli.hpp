// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_CLI_HPP
#define REFRACT_TOOLS_CLI_HPP

#include "console/failure.hpp"
#include "console/numbers.hpp"
#include "console/options.hpp"
#include <functional>
#include <string>
#include <vector>

/* What every tool shares: exit codes, errors as one plain sentence, --help, --version, --quiet, --config.

    static const char MANUAL[] = R"(What the tool does. ...)";

    int refract_NAME_main(int argc, char** argv)         // in refract_NAME.cpp
    {
        return tools::runTool(argc, argv, MANUAL, [](tools::Command& command) {
            std::string out;
            command.parser.add("--out", out, "the file to write").required();
            command.parse();
            ...
            return tools::DONE;
        });
    } */
namespace tools {

class Command
{
public:
    Command(int argc, char** argv, const std::string& manual);

    OptionParser parser;    //!< add options here, before parse()
    void parse();       //!< to be called by the body once, after the options are added

    bool quiet() const { return quiet_; }                   //!< after parse()
    const std::string& line() const { return line_; }       //!< the command line, quoted for a shell, with what --config says
    const std::string& settings() const { return settings_; }   //!< the file that --config names, which is an input; or empty

    //! One line on stderr, with --quiet too: what was done is not quite what was asked.
    void warn(const std::string& text) const;

private:
    static std::string stripFolder(const std::string& path);

    std::vector<std::string> arguments_;
    std::string line_, settings_;
    bool quiet_ = false;
};

//! The options of a command line; add() declares them.
template<typename Options>
Options parsed(Command& command, void (*add)(OptionParser& parser, Options& options))
{
    Options options;
    add(command.parser, options);
    command.parse();
    return options;
}

//! Runs the body; turns every exception into exit code 1 and one sentence on stderr.
int runTool(int argc, char** argv, const std::string& manual, const std::function<int(Command&)>& body);

} // namespace tools

#endif // REFRACT_TOOLS_CLI_HPP
