// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

// refract_bench: ours and its peers run alternately in one process, on one pinned thread; one table of ns per point, ratio
// to the named call, error against the long double reference, number of answers. doc/performance.md explains the result.
#include "arrays.hpp"
#include "bundles.hpp"
#include "growth.hpp"
#include "rows.hpp"
#include "surveys.hpp"

#include <opencv2/core/utility.hpp>
#include <cstdio>
#include <iostream>
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

struct Options
{
    bool quick, growth, bundles, lines;
    std::string only, isa;
    int points, rounds, surveys, surveysFrom, strips, views, arrays;
};

const char KEYS[] =
    "{ help h  |        | }"
    "{ quick   |        | few points, one round: a check of the answers only }"
    "{ growth  |        | time against points, layers, incidence and views instead of the table }"
    "{ bundles |        | large bundle adjustments, processor time, instead of the table }"
    "{ surveys | 0      | strips of 20, 100, 300, 1000, ... views, up to so many, instead of the table }"
    "{ surveys-from | 0 | views of the shortest of these }"
    "{ lines   |        | of lines side by side, an area, in place of strips }"
    "{ strips | 0       | errors over stated of so many strips, instead of the table }"
    "{ views   | 20     | of each of these strips }"
    "{ arrays  | 0      | rings of 3, 6, 12, ... cameras above water, up to so many, instead of the table }"
    "{ only    |        | rows whose key begins with this }"
    "{ isa     | avx512 | the highest instruction set to use: baseline, avx2, avx512 }"
    "{ points  | 100000 | points in an array }"
    "{ rounds  | 15     | rounds of which the median is taken }";

//! Throws for a name that there is not: OpenCV's parser passes over it.
Options optionsOf(int argc, char** argv)
{
    cv::CommandLineParser parser(argc, argv, KEYS);
    parser.about("Speed and accuracy of refract beside OpenCV, mrcal and the straightforward scalar program.\n"
                 "Exit code 2: an answer was missing or wrong. Times never change the exit code.");
    if (parser.has("help"))
    {
        parser.printMessage();
        std::exit(0);
    }
    for (int i = 1; i < argc; i++)
    {
        const std::string argument = argv[i], name = argument.substr(0, argument.find('='));
        if (name.compare(0, 2, "--") != 0 || std::string(KEYS).find("{ " + name.substr(2) + ' ') == std::string::npos)
            throw std::runtime_error("there is no option " + argument + ", see --help");
    }
    const Options o = { parser.has("quick"), parser.has("growth"), parser.has("bundles"), parser.has("lines"),
                        parser.get<std::string>("only"), parser.get<std::string>("isa"), parser.get<int>("points"),
                        parser.get<int>("rounds"), parser.get<int>("surveys"), parser.get<int>("surveys-from"), parser.get<int>("strips"),
                        parser.get<int>("views"), parser.get<int>("arrays") };
    if (!parser.check() || o.points < 1 || o.rounds < 1 || o.views < 7 || (o.isa != "baseline" && o.isa != "avx2" && o.isa != "avx512"))
        throw std::runtime_error("--points and --rounds are numbers from 1 on, --views from 7, --isa is baseline, avx2 or avx512");
    return o;
}

} // namespace

int main(int argc, char** argv)
try
{
    Options o = optionsOf(argc, argv);
    restartFor(o.isa, argv);
    if (o.quick)
        o.points = 2000, o.rounds = 1;
    if (o.bundles || o.surveys > 0 || o.strips > 0 || o.arrays > 0)
    {
        o.bundles ? printBundles() : o.arrays > 0 ? printArrays(o.arrays)
        : o.strips > 0 ? printManySurveys(o.views, o.strips) : printSurveys(o.surveysFrom, o.surveys, o.lines);
        return 0;
    }
    cv::setNumThreads(2);       // its workers start here, where they may run anywhere
    cv::parallel_for_(cv::Range(0, 2), [](const cv::Range&) {});
    pin(1);
    cv::setNumThreads(1);

    if (o.growth)
    {
        std::printf("instructions: %s, processor time of one thread\n", instructions().c_str());
        printGrowth();
        return 0;
    }
    std::vector<Row> rows;
    addPointRows(rows, o.points);
    addWedgeRows(rows, o.points);
    addCurvedRows(rows, o.points);
    addSplinedRows(rows, o.points);
    addPairRows(rows, o.points);
    addRobustRows(rows);
    addCallRows(rows, o.points);
    addStereoRows(rows);
    addCalibrationRows(rows);
    std::printf("instructions: %s, points: %d, rounds: %d, ns per point\n", instructions().c_str(), o.points, o.rounds);
    std::printf("%-39s %-30s%10s%10s%10s%10s%10s%10s%10s%10s%10s %-12s answers\n", "work", "peer (without window)", "ours", "peer",
                "scalar", "mrcal", "memory", "ratio", "target", "error", "peer's", "unit");
    bool right = true;
    for (const Row& row : rows)
        if (row.key.compare(0, o.only.size(), o.only) == 0)
            right = printRow(row, measure(row, o.rounds), instructions() == "AVX-512") && right;
    return right ? 0 : 2;
}
catch (const std::exception& e)
{
    std::cerr << "refract_bench: " << e.what() << std::endl;
    return 1;
}
