// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

// Options of a command line, each kind of value and each kind of check.
#include "console/options.hpp"
#include "console/failure.hpp"
#include "temporary_folder.hpp"
#include <catch2/catch.hpp>
#include <fstream>

using namespace tools;

namespace {

struct Values
{
    std::string file, pattern = "dots", alone, two, left[3], right[3];
    double length = 2.5, share = 0.;
    int count = 1;
    std::vector<std::string> images, notes, free, folders;
    bool quick = false, robust = true, isWatching = false;
};

Values parse(const std::vector<std::string>& arguments)
{
    OptionParser parser("What it does.", "tool");
    Values v;
    parser.add("FILE", v.file, "a position").required();
    parser.add("IMAGES", v.images, "more positions");
    parser.add("--pattern", v.pattern, "a word").check(isMember({"dots", "squares"})).captureDefault();
    parser.add("--length", v.length, "a number").check(moreThanZero());
    parser.add("--share", v.share, "another").check(between(0., 1.));
    parser.add("--count", v.count, "a whole number").check(isCountUpTo(3));
    parser.add("--note", v.notes, "one at a time").oneAtATime();
    parser.add("--free", v.free, "commas between").delimiter(',');
    const Option quick = parser.addFlag("--quick", v.quick, "a flag");
    parser.addNegation("--no-robust", v.robust, "the opposite");
    parser.add("--alone", v.alone, "not with --quick").excludes(quick);
    parser.add("--two", v.two, "only with --quick").needs(quick);
    parser.beginGroup("Images");
    parser.addForEach("--left", v.left, 3, "once for each camera", "--right");
    parser.addForEach("--right", v.right, 3, "the same");
    parser.beginGroup("Watch");
    parser.addCallback("--watch", [&v](const std::vector<std::string>& values) {
        v.isWatching = true;
        v.folders = values;
    }, "with a value or without").mayBeAlone().typeName("[FOLDER]");
    parser.addFormerName("--range", "--length");
    parser.listFirst({"--length", "--left"});
    parser.addVersion("tool 1");
    parser.addSettingsFile("settings");
    parser.parse(arguments);
    return v;
}

std::string answerTo(const std::string& argument)
{
    try
    {
        parse({argument});
    }
    catch (const OptionParser::Answer& answer)
    {
        return answer.text;
    }
    return "";
}

} // namespace

TEST_CASE("Options take what the command line says, and keep what they had", "[options]")
{
    const Values none = parse({"a.yml"});
    CHECK(none.file == "a.yml");
    CHECK(none.pattern == "dots");
    CHECK(none.length == 2.5);
    CHECK((!none.quick && none.robust && !none.isWatching && none.images.empty()));
    const Values all = parse({"a.yml", "b", "c", "--pattern=squares", "--length", "1e2", "--share=1", "--count=3", "--note=x=y", "--note",
                              "z", "--free=p,q", "--quick", "--no-robust", "--two=2", "--watch=d", "--watch=e"});
    CHECK(all.images == std::vector<std::string>{"b", "c"});
    CHECK(all.pattern == "squares");
    CHECK((all.length == 100. && all.share == 1. && all.count == 3));
    CHECK(all.notes == std::vector<std::string>{"x=y", "z"});
    CHECK(all.free == std::vector<std::string>{"p", "q"});
    CHECK((all.quick && !all.robust && all.two == "2"));
    CHECK((all.isWatching && all.folders == std::vector<std::string>{"d", "e"}));
    CHECK(parse({"a.yml", "--watch"}).isWatching);
}

TEST_CASE("What is wrong with a command line is one sentence", "[options]")
{
    struct
    {
        std::vector<std::string> arguments;
        std::string mentions;
    } const wrong[] = {{{}, "FILE is required"}, {{"a", "--pattern=stars"}, "--pattern: stars not in {dots,squares}"},
        {{"a", "--length=0"}, "--length: give a number more than 0, not 0"}, {{"a", "--length=nan"}, "more than 0, not nan"},
        {{"a", "--share=1.1"}, "from 0 to 1"}, {{"a", "--count=4"}, "--count"}, {{"a", "--count=1.5"}, "--count"},
        {{"a", "--quick", "--alone=1"}, "excludes"}, {{"a", "--two=2"}, "requires --quick"}, {{"a", "--length"}, "--length"},
        {{"--lenght=1"}, "there is no option --lenght=1"}, {{"a", "--left4=b"}, "there is no option --left4"},
        {{"a", "--left0=b"}, "there is no option --left0"}, {{"a", "--left2"}, "--left2: 1 required TEXT missing"},
        {{"a", "--left", "--quick"}, "--left: 1 required TEXT missing"}, {{"a", "--left2=b"}, "--left2 requires --right2"},
        {{"a", "--left=b", "--left=c", "--left2=d"}, "--left2 is given twice"},
        {{"a", "--left=b", "--left=c", "--left=d", "--left=e"}, "--left is given more than 3 times"}};
    for (const auto& c : wrong)
    {
        CAPTURE(c.mentions);
        CHECK_THROWS_WITH(parse(c.arguments), Catch::Contains(c.mentions) && Catch::EndsWith("(see tool --help)"));
    }
}

TEST_CASE("An option for each camera is said once for each, or with a camera's number", "[options]")
{
    using Said = std::vector<std::string>;
    const auto left = [](const Said& arguments) {
        const Values v = parse(arguments);
        return Said(v.left, v.left + 3);
    };
    const Said right = {"a", "--right=x", "--right2=y", "--right3=z"};
    const auto with = [&](Said more) {
        more.insert(more.begin(), right.begin(), right.end());
        return more;
    };
    CHECK(left({"a"}) == Said{"", "", ""});
    CHECK(left(with({"--left=b", "--left", "c", "--left=d=e"})) == Said{"b", "c", "d=e"});
    CHECK(left(with({"--left2", "c", "--left=b"})) == Said{"b", "c", ""});
    CHECK(left(with({"--left3=d"})) == Said{"", "", "d"});
    CHECK(left(with({"--left2=c", "--left1=b"})) == Said{"b", "c", ""});
    CHECK_THROWS_WITH(left(with({"--left1=b", "--left=c"})), Catch::Contains("--left is given twice"));
    CHECK(left(with({"--left3=-d", "--left=[b]", "--", "--left=e"})) == Said{"[b]", "", "-d"});     // behind -- are no options
    // Of a file of settings what the command line does not say.
    const TemporaryFolder folder;
    std::ofstream(folder / "run.toml") << "left = [\"p\", \"q\"]\nleft3 = \"r\"\nright = [\"x\", \"y\", \"z\"]\n";
    const std::string settings = "--config=" + (folder / "run.toml");
    CHECK(left({"a", settings}) == Said{"p", "q", "r"});
    CHECK(left({"a", settings, "--left2=c"}) == Said{"p", "c", "r"});
    CHECK(left({"a", settings, "--left=b", "--left=c"}) == Said{"b", "c", "r"});
    std::ofstream(folder / "run.toml") << "left = [\"p\", \"q\"]\nleft2 = \"r\"\n";
    CHECK_THROWS_WITH(left({"a", settings}), Catch::Contains("--left2 is given twice"));
}

TEST_CASE("An option is known by its former name, too", "[options]")
{
    CHECK(parse({"a", "--range=3"}).length == 3.);
    CHECK(parse({"a", "--range", "4"}).length == 4.);
    const TemporaryFolder folder;
    std::ofstream(folder / "run.toml") << "range = 5\n";
    CHECK(parse({"a", "--config=" + (folder / "run.toml")}).length == 5.);
    CHECK(answerTo("--help").find("--range") == std::string::npos);
}

TEST_CASE("Help lists the options by groups: first what most need, last what all tools have", "[options]")
{
    CHECK(answerTo("--version") == "tool 1\n");
    const std::string help = answerTo("--help");
    for (const char* part : {"What it does.", "Usage: tool [OPTIONS] FILE [IMAGES...]", "--pattern TEXT:{dots,squares}=dots",
                             "--length FLOAT:> 0", "--watch [FOLDER]"})
    {
        CAPTURE(help, part);
        CHECK(help.find(part) != std::string::npos);
    }
    size_t at = 0;
    for (const char* part : {"\nMost used:\n  --length", "\n  --left TEXT ...", "\nImages:\n  --right", "\nWatch:\n  --watch",
                             "\nOptions:\n"})
    {
        CAPTURE(help, part, at);
        at = help.find(part, at);
        REQUIRE(at != std::string::npos);
    }
}
