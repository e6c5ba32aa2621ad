// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#define CATCH_CONFIG_RUNNER
#define CATCH_CONFIG_CONSOLE_WIDTH 300      // --list-tests must not break names: discover_tests.cmake reads them
#include <catch2/catch.hpp>

namespace {

//! Counts the cases that said WARN("SKIPPED: why").
struct SkippedCases : Catch::TestEventListenerBase
{
    using TestEventListenerBase::TestEventListenerBase;

    void testCaseStarting(const Catch::TestCaseInfo&) override { isSkipped = false; }
    bool assertionEnded(const Catch::AssertionStats& stats) override
    {
        const Catch::AssertionResult& result = stats.assertionResult;
        if (result.getResultType() == Catch::ResultWas::Warning && result.getMessage().find("SKIPPED: ") == 0)
            isSkipped = true;
        return true;
    }
    void testCaseEnded(const Catch::TestCaseStats&) override { (isSkipped ? skipped : run)++; }

    bool isSkipped = false;
    static int skipped, run;
};

int SkippedCases::skipped = 0, SkippedCases::run = 0;

} // namespace

CATCH_REGISTER_LISTENER(SkippedCases)

int main(int argc, char** argv)
{
    const int failed = Catch::Session().run(argc, argv);
    const int SKIPPED = 77;     // as ctest is told
    return failed == 0 && SkippedCases::skipped > 0 && SkippedCases::run == 0 ? SKIPPED : failed;
}
