// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_SETTINGS_FILE_HPP
#define REFRACT_TOOLS_SETTINGS_FILE_HPP

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

namespace tools {

/** --config=run.toml: options by their names without dashes, one a line, as TOML (or INI) writes them. The command line goes first.
Throws Failure for a name that is no option, and for sections. */
class SettingsFile : public CLI::ConfigTOML
{
public:
    //! @param app whose options there are, when the file is read
    explicit SettingsFile(const CLI::App& app) : app_(app) {}

    std::vector<CLI::ConfigItem> from_config(std::istream& in) const override;

    //! What was taken from the file, as arguments.
    const std::vector<std::string>& arguments() const { return arguments_; }

private:
    const CLI::Option& optionOf(const CLI::ConfigItem& item) const;
    void noteArguments(const CLI::Option& option, const CLI::ConfigItem& item) const;

    const CLI::App& app_;
    mutable std::vector<std::string> arguments_;        // CLI11 reads through a const interface
};

} // namespace tools

#endif // REFRACT_TOOLS_SETTINGS_FILE_HPP
