// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "console/options.hpp"
#include "console/byte_order_mark.hpp"
#include "console/failure.hpp"
#include "console/numbers.hpp"
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cctype>
#include <cmath>
#include <iterator>
#include <set>
#include <sstream>

namespace tools {

namespace {

//! CLI11's own names the largest double in its error, and lets nan through.
Check numberThat(const std::function<bool(double)>& isGood, const std::string& words, const std::string& range)
{
    return Check(CLI::Validator([=](std::string& text) {
        double number;
        return parseNumber(text, number) && isGood(number) ? std::string() : "give a number " + words + ", not " + text;
    }, range));
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

const char FIRST_GROUP[] = "Most used", LAST_GROUP[] = "Options";       // the latter by CLI11

//! Groups in the order in which they began, but for what most commands need, and what all tools have.
class Help : public CLI::Formatter
{
public:
    std::string make_help(const CLI::App* app, std::string name, CLI::AppFormatMode) const override
    {
        std::vector<std::string> groups = app->get_groups();
        const auto rest = std::stable_partition(groups.begin(), groups.end(), [](const auto& group) { return group == FIRST_GROUP; });
        std::stable_partition(rest, groups.end(), [](const auto& group) { return group != LAST_GROUP; });
        std::string text = make_description(app) + make_usage(app, name) + make_positionals(app);
        for (const std::string& group : groups)
        {
            const std::vector<const CLI::Option*> options = app->get_options([&](const CLI::Option* option) {
                return option->nonpositional() && option->get_group() == group; });
            if (!options.empty())
                text += make_group(group, false, options);
        }
        return text + "\n";
    }
};

//! What stands before the first '=' of a line, without blanks and quotes; empty if that is no name.
static std::string nameOf(const std::string& line)
{
    const std::string AROUND = " \t\"'";
    const size_t equals = line.find('='), begin = line.find_first_not_of(AROUND);
    if (equals == std::string::npos || begin >= equals)
        return "";
    const std::string name = line.substr(begin, line.find_last_not_of(AROUND, equals - 1) + 1 - begin);
    const auto isOfName = [](char c) { return std::isalnum((unsigned char)c) || c == '.' || c == '_' || c == '-'; };
    return std::all_of(name.begin(), name.end(), isOfName) ? name : "";
}

//! The text of a file of settings, without a byte order mark. Throws Failure for a setting that comes twice.
static std::string readSettings(std::istream& in)
{
    std::istringstream lines(withoutByteOrderMark({std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()}));
    std::set<std::string> names;
    for (std::string line; std::getline(lines, line); )
    {
        const std::string name = nameOf(line);
        if (!name.empty() && !names.insert(name).second)
            throw Failure("--config: '" + name + "' is set twice; several values are a list: name = [one, two]");
    }
    return lines.str();
}

Check::Check(const CLI::Validator& validator) : validator_(std::make_shared<CLI::Validator>(validator)) {}

Check isMember(const std::vector<std::string>& words) { return Check(CLI::IsMember(words)); }

Check moreThanZero()
{
    return numberThat([](double number) { return number > 0 && std::isfinite(number); }, "more than 0", "> 0");
}

Check notNegative()
{
    return numberThat([](double number) { return number >= 0 && std::isfinite(number); }, "from 0 on", ">= 0");
}

Check between(double least, double most)
{
    const std::string range = cv::format("%g to %g", least, most);
    return numberThat([=](double number) { return number >= least && number <= most; }, "from " + range, range);
}

Check isCount() { return Check(CLI::PositiveNumber); }

Check isCountUpTo(int most) { return Check(CLI::Range(1, most)); }

Option& Option::required(bool isRequired)
{
    option_->required(isRequired);
    return *this;
}

Option& Option::check(const Check& check)
{
    option_->check(check.validator());
    return *this;
}

Option& Option::captureDefault()
{
    option_->capture_default_str();
    return *this;
}

Option& Option::needs(const Option& other)
{
    option_->needs(other.option_);
    return *this;
}

Option& Option::excludes(const Option& other)
{
    option_->excludes(other.option_);
    return *this;
}

Option& Option::delimiter(char between)
{
    option_->delimiter(between);
    return *this;
}

Option& Option::oneAtATime()
{
    option_->allow_extra_args(false);
    return *this;
}

Option& Option::mayBeAlone()
{
    option_->expected(0, 1)->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
    return *this;
}

Option& Option::typeName(const std::string& name)
{
    option_->type_name(name);
    return *this;
}

size_t Option::count() const { return option_->count(); }

//! Names that are no options, and sections, are refused.
class OptionParser::SettingsFile : public CLI::ConfigTOML
{
public:
    SettingsFile(CLI::App& app, const OptionNames& names) : app_(app), names_(names) {}

    std::vector<CLI::ConfigItem> from_config(std::istream& in) const override
    {
        std::istringstream text(readSettings(in));      // CLI11 joins a setting that comes twice, as if it were a list
        std::vector<CLI::ConfigItem> items;
        std::map<std::string, OptionNames::Said> saidOfEach;
        for (CLI::ConfigItem& item : CLI::ConfigTOML::from_config(text))
        {
            if (item.parents.empty())
                item.name = names_.presentName("--" + item.name).substr(2);
            const std::string ofEach = names_.nameOfEach("--" + item.fullname());
            for (const std::string& value : ofEach.empty() ? std::vector<std::string>() : item.inputs)
                saidOfEach[ofEach].push_back({"--" + item.fullname(), value});
            if (!ofEach.empty())
                continue;
            const CLI::Option& option = optionOf(item);
            item.name = item.fullname();        // that of calib.yml has a dot, which divides sections
            item.parents.clear();
            if (option.get_items_expected_max() == 1 && item.inputs.size() > 1)
                item.inputs = {CLI::detail::join(item.inputs, ",")};     // thickness = [20, 5] is --thickness=20,5
            if (option.empty())
                noteArguments(option, item);
            items.push_back(item);
        }
        for (const auto& said : saidOfEach)
            complete(said.first, names_.valuesOfEach(said.first, said.second));
        return items;
    }

    const std::vector<std::string>& arguments() const { return arguments_; }

private:
    const CLI::Option& optionOf(const CLI::ConfigItem& item) const
    {
        const std::string name = item.fullname(), where = "--config: ";
        if (item.name == "++" || item.name == "--")
            throw Failure(where + "'[...]' begins a section; give all settings without sections, one a line: name = value");
        const CLI::Option* option = app_.get_option_no_throw("--" + name);
        if (!option)
            option = app_.get_option_no_throw(name);
        if (!option)
            throw Failure(where + "there is no setting '" + name + "'; settings are the options that --help lists, without dashes, "
                          "one a line: name = value");
        if (!option->get_configurable())
            throw Failure(where + "'" + name + "' belongs on the command line: take it out of the file");
        return *option;
    }

    //! Of the cameras of which the command line says nothing.
    void complete(const std::string& name, const std::vector<std::string>& values) const
    {
        CLI::Option& option = *app_.get_option(name);
        std::vector<std::string> all = option.results();
        all.resize(std::max(all.size(), values.size()));
        for (size_t at = 0; at < values.size(); at++)
            if (all[at].empty() && !values[at].empty())
            {
                all[at] = values[at];
                arguments_.push_back(numberedName(name, at) + "=" + values[at]);
            }
        option.clear();
        option.add_result(all);
    }

    //! So that the command line that goes into outputs says all.
    void noteArguments(const CLI::Option& option, const CLI::ConfigItem& item) const
    {
        const bool isFlag = option.get_expected_max() == 0;
        for (const std::string& value : item.inputs)
            if (option.get_positional())
                arguments_.push_back(value);
            else if (!isFlag || value == "true")
                arguments_.push_back("--" + item.name + (isFlag ? "" : "=" + value));
    }

    CLI::App& app_;
    const OptionNames& names_;
    mutable std::vector<std::string> arguments_;        // CLI11 reads through a const interface
};

OptionParser::OptionParser(const std::string& about, const std::string& name)
    : name_(name), app_(std::make_unique<CLI::App>(about, name))
{
    app_->formatter(std::make_shared<Help>());
    app_->get_formatter()->column_width(34);
}

OptionParser::~OptionParser() = default;

Option OptionParser::add(const std::string& name, std::string& value, const std::string& about)
{
    return Option(app_->add_option(name, value, about));
}

Option OptionParser::add(const std::string& name, double& value, const std::string& about)
{
    return Option(app_->add_option(name, value, about));
}

Option OptionParser::add(const std::string& name, int& value, const std::string& about)
{
    return Option(app_->add_option(name, value, about));
}

Option OptionParser::add(const std::string& name, std::vector<std::string>& values, const std::string& about)
{
    return Option(app_->add_option(name, values, about));
}

Option OptionParser::addCallback(const std::string& name, const std::function<void(const std::vector<std::string>&)>& take,
                                 const std::string& about)
{
    return Option(app_->add_option_function<std::vector<std::string>>(name, take, about));
}

Option OptionParser::addForEach(const std::string& name, std::string* values, size_t count, const std::string& about,
                                const std::string& needed)
{
    names_.addForEach(name, values, count, needed);
    return addCallback(name, [=](const std::vector<std::string>& said) { std::copy(said.begin(), said.end(), values); }, about)
        .oneAtATime();
}

Option OptionParser::addFlag(const std::string& name, bool& flag, const std::string& about)
{
    return Option(app_->add_flag(name, flag, about));
}

Option OptionParser::addNegation(const std::string& name, bool& flag, const std::string& about)
{
    return Option(app_->add_flag_callback(name, [&flag] { flag = false; }, about));
}

void OptionParser::addVersion(const std::string& text) { app_->set_version_flag("--version", text); }

void OptionParser::addSettingsFile(const std::string& about)
{
    settingsFile_ = std::make_shared<SettingsFile>(*app_, names_);
    app_->config_formatter(settingsFile_);
    app_->set_config("--config", "", about)->type_name("FILE");
}

void OptionParser::addFormerName(const std::string& former, const std::string& name) { names_.addFormer(former, name); }

Option OptionParser::get(const std::string& name) const { return Option(app_->get_option(name)); }

void OptionParser::beginGroup(const std::string& heading) { app_->option_defaults()->group(heading); }

void OptionParser::listFirst(const std::vector<std::string>& names)
{
    for (const std::string& name : names)
        app_->get_option(name)->group(FIRST_GROUP);
}

void OptionParser::parse(const std::vector<std::string>& arguments)
{
    const std::string seeHelp = " (see " + name_ + " --help)";
    const auto check = [&](const auto& names) {
        try
        {
            return names();
        }
        catch (const Failure& e)
        {
            throw Failure(e.what() + seeHelp);
        } };
    std::vector<std::string> reversed = check([&] { return names_.inOrder(arguments); });       // as CLI11 takes them
    std::reverse(reversed.begin(), reversed.end());
    try
    {
        app_->parse(reversed);
    }
    catch (const CLI::FileError&)
    {
        throw Failure("--config=" + app_->get_config_ptr()->as<std::string>() + ": there is no such file, or it cannot be read: check "
                      "folder and name");
    }
    catch (const CLI::Success& asked)
    {
        std::ostringstream out;
        app_->exit(asked, out, out);
        throw Answer{out.str()};
    }
    catch (const CLI::ParseError& e)
    {
        const std::string unknown = unknownOption(*app_);       // which may be why something else is missing
        throw Failure((unknown.empty() ? e.what() : unknown) + seeHelp);
    }
    check([&] { names_.requireNeeded(); });
}

std::string OptionParser::settings() const
{
    const CLI::Option* const file = app_->get_config_ptr();
    return file && file->count() ? file->as<std::string>() : "";
}

std::vector<std::string> OptionParser::settingsArguments() const
{
    return settingsFile_ ? settingsFile_->arguments() : std::vector<std::string>();
}

} // namespace tools
