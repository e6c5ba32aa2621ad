// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

// refract_bundle --colmap where lengths or positions are wrong: it names them, and no right ones.
#include "survey_scene.hpp"

using namespace survey_scene;

namespace {

using Table = std::vector<std::vector<std::string>>;        // the first line: heading

Table readTable(const std::string& path)
{
    Table table;
    std::istringstream in(readFile(path));
    std::string line, cell;
    while (std::getline(in, line))
    {
        std::istringstream cells(line);
        table.push_back({});
        while (std::getline(cells, cell, ','))
            table.back().push_back(cell);
    }
    return table;
}

void writeTable(const std::string& path, const Table& table)
{
    std::string text;
    for (const std::vector<std::string>& row : table)
        for (size_t i = 0; i < row.size(); i++)
            text += row[i] + (i + 1 < row.size() ? "," : "\n");
    writeFile(path, text);
}

void scale(std::string& cell, double factor) { cell = format("%.6f", std::atof(cell.c_str())*factor); }

//! What is wrong with the tables, and what is to be said of it.
struct Mistake
{
    const char* name;
    bool needsPositions;
    bool isSlow;                    //!< far from where a fit comes to an end soon
    std::function<void(Table& lengths, Table& positions)> make;
    const char* said;
};

void scaleAll(Table& lengths, double factor)
{
    for (size_t i = 1; i < lengths.size(); i++)
        scale(lengths[i][2], factor);
}

const Mistake MISTAKES[] = {
    {"all lengths 10 % too long", true, false, [](Table& l, Table&) { scaleAll(l, 1.1); }, "the lengths of '"},
    {"all lengths twice as long", true, true, [](Table& l, Table&) { scaleAll(l, 2); }, "the lengths of '"},
    {"all lengths ten times as long", true, true, [](Table& l, Table&) { scaleAll(l, 10); }, "the lengths of '"},
    {"two lengths exchanged", false, false, [](Table& l, Table&) { std::swap(l[2][2], l[4][2]); }, "line 3 of '"},
    {"a length 4 % too long", false, false, [](Table& l, Table&) { scale(l[3][2], 1.04); }, "line 4 of '"},
    {"a position 60 off", true, false, [](Table&, Table& p) { p[5][2] = format("%.6f", std::atof(p[5][2].c_str()) + 60); }, "line 6 of '"},
    {"two positions exchanged", true, false, [](Table&, Table& p) { std::swap(p[3][0], p[9][0]); }, "positions.csv'"},
    {"positions in reverse order", true, false, [](Table&, Table& p) {
        for (size_t i = 1, k = p.size() - 1; i < k; i++, k--)
            std::swap(p[i][0], p[k][0]); }, "the positions of '"},
};

std::string optionsFor(const TemporaryFolder& f, int cameras, bool lengths, bool positions)
{
    static const char* const IMAGES[] = {"", " --images='left/*' --images='right/*' --free=normal",
                                         " --images='left/*' --images='right/*' --images='third/*' --free=normal"};
    return std::string(lengths ? " --lengths=" + f / "lengths.csv" : "") + (positions ? " --positions=" + f / "positions.csv" : "")
        + IMAGES[cameras - 1];
}

//! Of many rigs: one to three cameras, windows thin and thick, some with wrong observations.
template<class Run> void overRigs(unsigned salt, int trials, const Run& run)
{
    const double SIZES[] = {0.3, 1, 2};
    for (int trial = 0; trial < trials; trial++)
        for (int cameras = 1; cameras <= 3; cameras++)
        {
            Network network(salt + 10*trial + cameras, cameras, trial % 4 == 3 ? 0.05 : 0, -1, SIZES[trial % 3]);
            const TemporaryFolder f;
            network.write(f);
            run(f, cameras);
        }
}

struct Count
{
    int runs = 0, refused = 0, named = 0, failed = 0;
    void add(const ToolResult& result, const std::string& said)
    {
        runs++;
        failed += result.code != 0 && result.code != 2;
        refused += result.code == 2;
        named += result.code == 2 && mentions(result.err, said);
    }
};

} // namespace

TEST_CASE("Wrong lengths and positions of a survey are named, right ones are believed", "[tools][bundle][colmap][slow]")
{
    const int cameras = GENERATE(1, 2);
    Network network(780 + cameras, cameras);
    const TemporaryFolder f;
    network.write(f);
    const Table lengths = readTable(f / "lengths.csv"), positions = readTable(f / "positions.csv");
    const ToolResult right = survey(f, optionsFor(f, cameras, true, true));
    CAPTURE(scenes::seed(), cameras, right.out, right.err);
    CHECK(right.code == 0);
    for (const Mistake& mistake : MISTAKES)
    {
        if (mistake.isSlow)
            continue;
        Table wrongLengths = lengths, wrongPositions = positions;
        mistake.make(wrongLengths, wrongPositions);
        writeTable(f / "lengths.csv", wrongLengths);
        writeTable(f / "positions.csv", wrongPositions);
        const ToolResult result = survey(f, optionsFor(f, cameras, true, true));
        CAPTURE(mistake.name, result.out, result.err);
        CHECK(result.code == 2);
        CHECK(mentions(result.out, "NOT USABLE"));
        CHECK(mentions(result.err, mistake.said));
    }
}

TEST_CASE("A length with a large std is not blamed", "[tools][bundle][colmap]")
{
    Network network(784, 2);
    const TemporaryFolder f;
    network.write(f);
    Table lengths = readTable(f / "lengths.csv");
    scale(lengths[3][2], 1.04);
    for (const double share : {0.001, 0.04})
    {
        lengths[3][3] = format("%.6f", share*std::atof(lengths[3][2].c_str()));
        writeTable(f / "lengths.csv", lengths);
        const ToolResult result = survey(f, optionsFor(f, 2, true, false));
        CAPTURE(scenes::seed(), share, result.out, result.err);
        CHECK(result.code == (share < 0.01 ? 2 : 0));
        CHECK(mentions(result.err, "line 4 of '") == (share < 0.01));
    }
}

TEST_CASE("Right lengths and positions of many rigs are believed", "[.monte-carlo][measures]")
{
    const char* const WHICH[] = {"", "lengths", "positions", "lengths and positions"};
    std::map<std::string, Count> counts;
    overRigs(5000, scenes::trials(5), [&](const TemporaryFolder& f, int cameras) {
        for (const int which : {1, 2, 3})
        {
            const ToolResult result = survey(f, optionsFor(f, cameras, which & 1, which & 2));
            counts[format("%d cameras, %s", cameras, WHICH[which])].add(result, "standard deviations");
        }
    });
    for (const auto& count : counts)
    {
        std::printf("[numbers] right, %s: %d runs, %d refused, %d named, %d failed\n", count.first.c_str(), count.second.runs,
                    count.second.refused, count.second.named, count.second.failed);
        CAPTURE(scenes::seed(), count.first);
        CHECK(count.second.refused == 0);
    }
}

TEST_CASE("Wrong lengths and positions of many rigs are named", "[.monte-carlo][measures]")
{
    std::map<std::string, Count> counts;
    overRigs(6000, scenes::trials(1), [&](const TemporaryFolder& f, int cameras) {
        const Table lengths = readTable(f / "lengths.csv"), positions = readTable(f / "positions.csv");
        for (const Mistake& mistake : MISTAKES)
        {
            Table wrongLengths = lengths, wrongPositions = positions;
            mistake.make(wrongLengths, wrongPositions);
            writeTable(f / "lengths.csv", wrongLengths);
            writeTable(f / "positions.csv", wrongPositions);
            for (const bool both : {true, false})
            {
                if (!both && mistake.needsPositions && cameras == 1)
                    continue;           // nothing else tells
                const std::string options = optionsFor(f, cameras, both || wrongLengths != lengths, both || wrongLengths == lengths);
                const ToolResult result = survey(f, options);
                counts[std::string(mistake.name) + (both ? ", lengths and positions" : ", alone")].add(result, mistake.said);
            }
        }
    });
    int runs = 0, named = 0;
    for (const auto& count : counts)
    {
        std::printf("[numbers] %s: %d runs, %d refused, %d named, %d failed\n", count.first.c_str(), count.second.runs,
                    count.second.refused, count.second.named, count.second.failed);
        CAPTURE(scenes::seed(), count.first);
        CHECK(count.second.refused + count.second.failed == count.second.runs);
        runs += count.second.runs - count.second.failed;
        named += count.second.named;
    }
    CHECK(3*named > 2*runs);
}
