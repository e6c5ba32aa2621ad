// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

// refract_bench: ours and its peers run alternately in one process, on one pinned thread; one table of ns per point, ratio
// to the named call, error against the long double reference, number of answers. doc/performance.md explains the result.
#include "bundles.hpp"
#include "growth.hpp"
#include "rows.hpp"

#include <CLI/CLI.hpp>
#include <cstdio>
#include <unistd.h>

using namespace bench;

namespace {

//! OpenCV and the module ask for the processor's features once, when they are loaded: begin again without some of them.
void restartFor(const std::string& isa, char** argv)
{
    const char* disabled = isa == "baseline" ? "AVX512-SKX,AVX2" : isa == "avx2" ? "AVX512-SKX" : "";
    if (*disabled && !getenv("OPENCV_CPU_DISABLE"))
    {
        setenv("OPENCV_CPU_DISABLE", disabled, 1);
        execv("/proc/self/exe", argv);
        throw std::runtime_error("cannot start again with OPENCV_CPU_DISABLE");
    }
}

std::string instructions()
{
    return cv::checkHardwareSupport(CV_CPU_AVX512_SKX) ? "AVX-512" : cv::checkHardwareSupport(CV_CPU_AVX2) ? "AVX2" : "baseline";
}

void print(double v, const char* format) { std::isnan(v) ? std::printf("%10s", "-") : std::printf(format, v); }

//! True if every answer is there and right.
bool printRow(const Row& row, const Times& t, bool avx512)
{
    std::printf("%-39s %-30s", row.work.c_str(), row.peerName.c_str());
    for (double ns : { t.ours, t.peer, t.scalar, t.mrcal, t.memory })
        print(ns, "%10.2f");
    print(t.ratio, "%10.3f");
    const double target = row.target[avx512 ? 0 : 1];
    print(target > 0 ? target : NAN, "%10.3f");
    row.ours();     // what the peers left behind must not be taken for it
    const int answers = row.successes ? row.successes() : row.count;
    const double error = row.error ? row.error() : NAN, peerError = row.peerError ? row.peerError() : NAN;
    print(error, "%10.1e");
    print(peerError, "%10.1e");
    std::printf(" %-12s %d/%d\n", row.unit.c_str(), answers, row.count);
    std::fflush(stdout);
    return answers == row.count && !(error > row.tolerance);
}

} // namespace

int main(int argc, char** argv)
{
    CLI::App app("Speed and accuracy of refract beside OpenCV, mrcal and the straightforward scalar program.\n"
                 "Exit code 2: an answer was missing or wrong. Times never change the exit code.");
    bool quick = false, growth = false, bundles = false;
    std::string only, isa = "avx512";
    int count = 100000, rounds = 15;
    app.add_flag("--quick", quick, "few points, one round: a check of the answers only");
    app.add_flag("--growth", growth, "time against points, layers, incidence and views instead of the table");
    app.add_flag("--bundles", bundles, "large bundle adjustments, processor time, instead of the table");
    app.add_option("--only", only, "rows whose key begins with this");
    app.add_option("--isa", isa, "the highest instruction set to use")->check(CLI::IsMember({ "baseline", "avx2", "avx512" }));
    app.add_option("--points", count, "points in an array")->check(CLI::PositiveNumber);
    app.add_option("--rounds", rounds, "rounds of which the median is taken")->check(CLI::PositiveNumber);
    CLI11_PARSE(app, argc, argv);
    restartFor(isa, argv);
    if (quick)
        count = 2000, rounds = 1;
    if (bundles)
    {
        printBundles();
        return 0;
    }
    cv::setNumThreads(2);       // its workers start here, where they may run anywhere
    cv::parallel_for_(cv::Range(0, 2), [](const cv::Range&) {});
    pin(1);
    cv::setNumThreads(1);

    if (growth)
    {
        std::printf("instructions: %s, processor time of one thread\n", instructions().c_str());
        printGrowth();
        return 0;
    }
    std::vector<Row> rows;
    addPointRows(rows, count);
    addWedgeRows(rows, count);
    addCurvedRows(rows, count);
    addSplinedRows(rows, count);
    addPairRows(rows, count);
    addRobustRows(rows);
    addCallRows(rows, count);
    addStereoRows(rows);
    addCalibrationRows(rows);
    std::printf("instructions: %s, points: %d, rounds: %d, ns per point\n", instructions().c_str(), count, rounds);
    std::printf("%-39s %-30s%10s%10s%10s%10s%10s%10s%10s%10s%10s %-12s answers\n", "work", "peer (without window)", "ours", "peer",
                "scalar", "mrcal", "memory", "ratio", "target", "error", "peer's", "unit");
    bool right = true;
    for (const Row& row : rows)
        if (row.key.compare(0, only.size(), only) == 0)
            right = printRow(row, measure(row, rounds), instructions() == "AVX-512") && right;
    return right ? 0 : 2;
}
