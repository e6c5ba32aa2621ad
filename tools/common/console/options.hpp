// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_OPTIONS_HPP
#define REFRACT_TOOLS_OPTIONS_HPP

#include "console/option_names.hpp"
#include <cstddef>
#include <functional>
#include <memory>
#include <string>
#include <vector>

namespace CLI {
class App;
class Option;
class Validator;
}

/* The options of a command line: their names, where their values go, what these must be, and --help, which lists them. Over CLI11,
whose templates take seconds to compile: they are in options.cpp alone. */
namespace tools {

//! What the value of an option must be.
class Check
{
public:
    explicit Check(const CLI::Validator& validator);
    const CLI::Validator& validator() const { return *validator_; }

private:
    std::shared_ptr<const CLI::Validator> validator_;
};

Check isMember(const std::vector<std::string>& words);
Check moreThanZero();                           //!< a finite number
Check notNegative();
Check between(double least, double most);
Check isCount();                                //!< a whole number from 1 on
Check isCountUpTo(int most);

//! An option that was added; valid as long as its parser.
class Option
{
public:
    explicit Option(CLI::Option* option) : option_(option) {}

    Option& required(bool isRequired = true);
    Option& check(const Check& check);
    Option& captureDefault();                   //!< --help says the value that it has now
    Option& needs(const Option& other);
    Option& excludes(const Option& other);
    Option& delimiter(char between);            //!< of values in one argument
    Option& oneAtATime();                       //!< of several values, each has the option's name before it
    Option& mayBeAlone();                       //!< no value, or one; may be said more than once
    Option& typeName(const std::string& name);  //!< what --help calls its value
    size_t count() const;                       //!< how often it was said

private:
    CLI::Option* option_;
};

class OptionParser
{
public:
    //! @param about what --help says first @param name of the program
    explicit OptionParser(const std::string& about = "", const std::string& name = "");
    ~OptionParser();

    // The value goes into the variable, which keeps what it has where the option is not given. A name without dashes is a position.
    Option add(const std::string& name, std::string& value, const std::string& about);
    Option add(const std::string& name, double& value, const std::string& about);
    Option add(const std::string& name, int& value, const std::string& about);
    Option add(const std::string& name, std::vector<std::string>& values, const std::string& about);
    /** Once for each camera, in their order; with a camera's number behind its name, as --glass3, also where others are left out.
    @param values of `count` cameras
    @param needed of its kind: a camera after the first that has a value needs one of it, too; empty: none */
    Option addForEach(const std::string& name, std::string* values, size_t count, const std::string& about,
                      const std::string& needed = "");
    Option addCallback(const std::string& name, const std::function<void(const std::vector<std::string>&)>& take,
                       const std::string& about);
    Option addFlag(const std::string& name, bool& flag, const std::string& about);
    Option addNegation(const std::string& name, bool& flag, const std::string& about);     //!< "--no-...": the flag becomes false
    //! @param text what --version says
    void addVersion(const std::string& text);
    //! --config: a file with options by their names without dashes, one a line, as TOML (or INI) writes them. The command line goes first.
    void addSettingsFile(const std::string& about);

    void addFormerName(const std::string& former, const std::string& name);     //!< is taken for it, and in no --help

    Option get(const std::string& name) const;
    //! Options that are added from now on stand together in --help, under this heading.
    void beginGroup(const std::string& heading);
    void listFirst(const std::vector<std::string>& names);      //!< in --help, under a heading of their own
    const std::string& name() const { return name_; }

    //! Thrown where the command line asks for no more than a text, as --help does.
    struct Answer
    {
        std::string text;
    };

    //! Throws Failure where the arguments are wrong, and Answer. @param arguments without the name of the program
    void parse(const std::vector<std::string>& arguments);

    // After parse().
    std::string settings() const;                       //!< the file that --config names; or empty
    std::vector<std::string> settingsArguments() const; //!< what was taken from it, as arguments

private:
    class SettingsFile;
    std::string name_;
    std::unique_ptr<CLI::App> app_;
    OptionNames names_;
    std::shared_ptr<SettingsFile> settingsFile_;
};

} // namespace tools

#endif // REFRACT_TOOLS_OPTIONS_HPP
