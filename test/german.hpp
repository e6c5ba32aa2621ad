// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

// German habits of writing numbers, for tests.
#ifndef REFRACT_TEST_GERMAN_HPP
#define REFRACT_TEST_GERMAN_HPP

#include "temporary_folder.hpp"
#include <catch2/catch.hpp>
#include <clocale>
#include <cstdlib>
#include <locale>

struct CommaPoint : std::numpunct<char>
{
    char do_decimal_point() const override { return ','; }
    char do_thousands_sep() const override { return '.'; }
    std::string do_grouping() const override { return "\3"; }
};

//! German habits for C and C++ while it lives. The locale is made for it: few systems have it ready.
class German
{
public:
    German()
        : before_(std::locale::global(std::locale(std::locale::classic(), new CommaPoint)))
    {
        REQUIRE(std::system(("localedef -i de_DE -f UTF-8 " + folder_ / "de_DE.UTF-8").c_str()) == 0);   // package locales
        setenv("LOCPATH", (folder_ / "").c_str(), 1);
        REQUIRE(std::setlocale(LC_ALL, "de_DE.UTF-8") != nullptr);
    }
    ~German()
    {
        std::setlocale(LC_ALL, "C");
        unsetenv("LOCPATH");
        std::locale::global(before_);
    }
private:
    TemporaryFolder folder_;
    std::locale before_;
};

#endif // REFRACT_TEST_GERMAN_HPP
