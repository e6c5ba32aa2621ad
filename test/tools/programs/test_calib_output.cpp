// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

// What refract_calib prints: ten lines with what matters, and a PASS that hides nothing.
#include "calib_scene.hpp"
#include <nlohmann/json.hpp>

using namespace cv;
using namespace cv::refract;
using namespace calib_scene;

namespace {

const size_t LINES = 10, COLUMNS = 80;
const int ENOUGH_PAIRS = 4;         // what README.md and the guide ask for

//! What a terminal shows: stdout and stderr in one place.
struct Screen
{
    int code;
    std::vector<std::string> lines;
    std::string text;
};

Screen screenOf(const TemporaryFolder& f, const std::string& command)
{
    const std::string file = f / "screen.txt";
    const int status = std::system((paths::programs() + '/' + command + " >" + file + " 2>&1").c_str());
    std::string text = readFile(file);
    takeProgress(text);
    Screen screen{WEXITSTATUS(status), {}, text};
    std::istringstream in(text);
    for (std::string line; std::getline(in, line); )
        screen.lines.push_back(line);
    return screen;
}

size_t columnsOf(const std::string& line)
{
    return std::count_if(line.begin(), line.end(), [](char c) { return (c & 0xC0) != 0x80; });
}

void checkTenLines(const Screen& screen)
{
    INFO(screen.text);
    CHECK(screen.lines.size() <= LINES);
    for (const std::string& line : screen.lines)
        CHECK(columnsOf(line) <= COLUMNS);
}

//! Leaves so many of the images through the window, every step-th; all direct ones stay.
void keepPairs(const TemporaryFolder& f, int pairs, int step)
{
    std::istringstream in(readFile(f / "glass1.vnl"));
    std::ostringstream kept;
    for (std::string line; std::getline(in, line); )
    {
        const int view = line[0] == '#' ? 0 : std::stoi(line.substr(line.find("view") + 4, 2));
        if (view % step == 0 && view < step*pairs)
            kept << line << '\n';
    }
    writeFile(f / "glass1.vnl", kept.str());
}

nlohmann::json summaryOf(const TemporaryFolder& f) { return nlohmann::json::parse(readFile(f / "s.json")); }

} // namespace

TEST_CASE("A housing that cannot be opened is not asked for pairs", "[calib_tool][ten_lines]")
{
    const TemporaryFolder f;
    const std::string stereo = paths::bundled() + "/stereo";
    const ToolResult r = runTool("refract_calib --size=6x5 --square=39 --thickness=20 --index=1.5437 --camera=" + stereo
                                 + "/truth.yml --glass='" + stereo + "/glass1/*' --no-cross-validation --out=" + (f / "c.yml"));
    CAPTURE(r.out, r.err);
    CHECK(r.code == 0);
    CHECK(mentions(r.out, "take another image: "));
    CHECK(!mentions(r.out, "pair"));
}

TEST_CASE("A report that cannot be written leaves the calibration", "[calib_tool]")
{
    const TemporaryFolder f;
    const std::string stereo = paths::bundled() + "/stereo";
    const ToolResult r = runTool("refract_calib --size=6x5 --square=39 --thickness=20 --index=1.5437 --camera=" + stereo
                                 + "/truth.yml --glass='" + stereo + "/glass1/*' --no-cross-validation --quiet"
                                 + " --out=" + (f / "c.yml") + " --summary=/dev/full");
    CAPTURE(r.err);
    CHECK(r.code == 1);
    CHECK(mentions(r.err, "/dev/full"));
    CHECK(std::filesystem::exists(f / "c.yml"));
}

TEST_CASE("refract_calib prints ten lines of 80 columns", "[calib_tool][ten_lines]")
{
    const struct { const char* name; int views; bool stereo; std::string more, says, next; int code; } cases[] = {
        {"one camera", 10, false, PANE + std::string(" --lens=opencv4"), "Good\n",
            "measure (refract_measure); to do so better, take another pair", 0},
        {"stereo", 10, true, PANE, "lengths right within", "measure", 0},
        {"limits met", 10, false, PANE + std::string(" --max-rms=0.2 --max-error-at=600:5"), "Met: --max-rms=0.2 (0.1", "measure", 0},
        {"limits not met", 10, false, PANE + std::string(" --max-rms=0.01 --max-normal-std=1e-5 --max-error-at=600:1e-4 "
            "--max-error-at=700:1e-4 --max-error-at=800:1e-4 --max-error-at=900:1e-4"), "FAIL\n",
            "look at the images that fit worst, first 'view", 2},
        {"limit of the error not met", 10, false, PANE + std::string(" --max-error-at=600:1e-4"), "FAIL\n", "take sharper images: 99 %", 2},
        {"contradicted", 10, false, " --thickness=26 --index=1.5437 --no-robust", "Not usable: the images contradict",
            "put right what the images contradict", 2},
        // In air a rig that is 1.3 times as large, with its board, sees the same: a square of 50.7 is as good, and may come first.
        {"contradicted, stereo", 10, true, " --thickness=26 --index=1.5437 --no-robust", "the images contradict --thickness=26",
            "put right what the images contradict", 2},
        {"weak", 1, false, PANE + std::string(" --free=thickness,index"), "- and ", "take 3 more pairs, first: ", 0},
        {"weak, stereo, limits", 2, true, PANE + std::string(" --max-rms=1 --max-normal-std=3"), "PASS; look at the weak points; "
            "not checked:", "take 2 more pairs, first: ", 0}};
    for (const auto& c : cases)
    {
        const TemporaryFolder f;
        SceneOptions options;
        options.views = c.views;
        options.stereo = c.stereo;
        writeScene(f, options, 131);
        const bool lensFromImages = mentions(c.more, "--lens");
        const std::string more = c.more + (lensFromImages ? "" : lens(f))
            + (c.stereo ? images2(f) + " --camera2=" + f / "camera2.yml" : "") + " --summary=" + f / "s.json";
        const Screen screen = screenOf(f, brief(f, more));
        CAPTURE(c.name, screen.text);
        checkTenLines(screen);
        CHECK(screen.code == c.code);
        CHECK(mentions(screen.text, c.says));
        CHECK(mentions(screen.text, "\nNext: " + c.next));
        CHECK(mentions(screen.text, "--verbose"));
        CHECK_FALSE(mentions(screen.text, "nan"));
        const bool contradicted = !summaryOf(f)["findings"]["contradictions"].empty();
        CHECK(mentions(screen.text, "A measured point: +- ") == !contradicted);

        // Where stderr is another file, it has the reasons of an exit code 2, and --quiet leaves only these.
        const ToolResult quiet = runTool(brief(f, more + " --quiet"));
        CHECK(quiet.out.empty());
        CHECK(quiet.err.empty() == (c.code == 0));
        CHECK(runTool(brief(f, more)).err == quiet.err);
    }
}

TEST_CASE("Where not all fits into ten lines, what a tape measure can check does", "[calib_tool][ten_lines]")
{
    const TemporaryFolder f;
    SceneOptions options;
    options.stereo = true;
    options.wrong = 0.02;       // some are left out, which is said, too
    writeScene(f, options, 133);
    const Screen screen = screenOf(f, brief(f, images2(f) + PANE + " --max-rms=0.2 --max-error-at=600:5"));
    checkTenLines(screen);
    INFO(screen.text);
    CHECK(mentions(screen.text, "Met: --max-rms=0.2"));
    CHECK(mentions(screen.text, "Check by tape measure: camera 2 is 22"));
    CHECK_FALSE(mentions(screen.text, "Left out:"));
}

TEST_CASE("That much does not fit and was left out is a weak point, and says of which images", "[calib_tool][verdict]")
{
    for (int wrongViews : {1, 4})
    {
        const TemporaryFolder f;
        writeScene(f, SceneOptions(), 134);
        // As of another camera or window: of the first images three corners in five are elsewhere.
        std::istringstream in(readFile(f / "glass1.vnl"));
        std::ostringstream changed;
        int row = 0;
        for (std::string line; std::getline(in, line); row++)
        {
            std::istringstream words(line);
            std::string name;
            double x, y;
            if (line[0] != '#' && words >> name >> x >> y && std::stoi(name.substr(name.find("view") + 4, 2)) < wrongViews && row % 5 < 3)
                line = name + format(" %g %g 0", x + 5 + row*7 % 11, y - 5 - row*5 % 13);
            changed << line << '\n';
        }
        writeFile(f / "glass1.vnl", changed.str());
        const ToolResult r = runTool(brief(f, PANE + lens(f) + " --unpaired --summary=" + f / "s.json", false));
        CAPTURE(wrongViews, r.out, r.err);
        REQUIRE(r.code == 0);
        const std::string weak = summaryOf(f)["findings"]["weak"].dump();
        CHECK(mentions(weak, "points through the window do not fit the others and were left out") == (wrongViews > 1));
        for (int view = 0; view < wrongViews; view++)
            CHECK(mentions(weak, format("'view%02d'", view)) == (wrongViews > 1));
    }
}

TEST_CASE("refract_calib tells the most important weak points first, and how many it leaves out", "[calib_tool][ten_lines]")
{
    const TemporaryFolder f;
    SceneOptions options;
    options.views = 1;
    writeScene(f, options, 132);
    const Screen screen = screenOf(f, brief(f, PANE + lens(f) + " --free=thickness,index --summary=" + f / "s.json"));
    INFO(screen.text);
    const std::vector<std::string> weak = summaryOf(f)["findings"]["weak"];
    const size_t shown = std::count_if(screen.lines.begin(), screen.lines.end(),
                                       [](const std::string& line) { return line.compare(0, 2, "- ") == 0; }) - 1;
    REQUIRE(weak.size() > shown);
    CHECK(mentions(screen.text, format("- and %zu more: --verbose\n", weak.size() - shown)));
    for (size_t i = 0; i < shown; i++)
        CHECK(mentions(screen.text, "- " + weak[i].substr(0, 40)));
    // That there is one image comes before what that one does not determine.
    const auto at = [&](const char* part) {
        return std::find_if(weak.begin(), weak.end(), [part](const std::string& s) { return mentions(s, part); }) - weak.begin();
    };
    CHECK(at("only 1 pair") < at("weakly determined"));
    CHECK(at("weakly determined") < (long)weak.size());
}

TEST_CASE("A limit is not met by one image, and PASS says what it does not know", "[calib_tool][verdict]")
{
    const TemporaryFolder f;
    const struct { int pairs; std::string options, verdict; int code; } cases[] = {
        {1, " --max-rms=0.3", "FAIL", 2},
        {1, " --max-normal-std=90", "FAIL", 2},
        {1, " --max-error-at=600:500", "FAIL", 2},
        {2, " --max-rms=0.3", "PASS; look at the weak points; not checked: there are too few images", 0},
        {10, " --max-rms=0.3 --no-cross-validation", "PASS, but not checked: with --no-cross-validation all boards took part", 0},
        {10, " --max-rms=0.3 --lens=opencv4", "PASS", 0},
        {10, " --no-cross-validation", "Good, but not checked: with --no-cross-validation", 0},
        {2, "", "Look at the weak points; not checked: there are too few images", 0}};
    for (const auto& c : cases)
    {
        SceneOptions options;
        options.views = 10;
        writeScene(f, options, 133);
        keepPairs(f, c.pairs, 1);
        const ToolResult r = runTool(brief(f, PANE + c.options + (mentions(c.options, "--lens") ? "" : lens(f)) + " --summary="
                                              + f / "s.json"));
        CAPTURE(c.pairs, c.options, r.out, r.err);
        CHECK(r.code == c.code);
        const std::string verdict = summaryOf(f)["verdict"];
        CHECK(verdict.substr(0, c.verdict.size()) == c.verdict);
        CHECK(r.out.substr(0, 4) == verdict.substr(0, 4));
        const FileStorage file(f / "calib.yml", FileStorage::READ);
        CHECK((std::string)file["verdict"] == verdict);
        CHECK(file["weak_points"].size() == summaryOf(f)["findings"]["weak"].size());
        if (c.code == 2)
        {
            CHECK(mentions(r.err, "cannot be judged on one image through the window"));
            CHECK(mentions(r.out, "cannot be judged on one image"));
            CHECK(mentions(r.out, format("Next: take %d more pairs", ENOUGH_PAIRS - 1)));
        }
    }
}

TEST_CASE("As many pairs as README, guide and --help ask for are enough for the verdict", "[calib_tool][verdict]")
{
    const TemporaryFolder f;
    for (int pairs : {ENOUGH_PAIRS - 1, ENOUGH_PAIRS})
    {
        SceneOptions options;
        options.views = 12;
        writeScene(f, options, 134);
        keepPairs(f, pairs, 3);
        const ToolResult r = runTool(brief(f, PANE + std::string(" --lens=opencv4 --summary=") + f / "s.json"));
        INFO(r.out << r.err);
        REQUIRE(r.code == 0);
        const std::string only = format("only %d pairs: take at least %d", ENOUGH_PAIRS - 1, ENOUGH_PAIRS);
        CHECK(mentions(summaryOf(f)["findings"]["weak"].dump(), only) == (pairs < ENOUGH_PAIRS));
        CHECK(summaryOf(f)["findings"]["weak"].empty() == (pairs == ENOUGH_PAIRS));
    }
    const auto page = [](const char* name) {
        std::string text = readFile(paths::bundled() + "/../../" + name);
        std::replace(text.begin(), text.end(), '\n', ' ');
        return text;
    };
    CHECK(mentions(runTool("refract_calib --help").out, "Take four of them"));
    CHECK(mentions(page("doc/howto_calibrate.md"), "For four of them"));
    CHECK(mentions(page("README.md"), "**Four pairs**"));
    CHECK(mentions(page("README.md"), "through the window, four of them"));
}

TEST_CASE("The first page of the report prints on one sheet of A4", "[calib_tool][report]")
{
    for (const char* program : {"gnuplot", "chromium", "pdftotext"})
        if (std::system((std::string("command -v ") + program + " >/dev/null 2>&1").c_str()) != 0)
        {
            WARN("SKIPPED: " << program << " is not installed");
            return;
        }
    const struct { int views; bool stereo; std::string more; } cases[] = {
        {5, false, ""},
        {2, true, " --free=thickness,index --max-rms=1e-4 --max-normal-std=1e-4 --max-error-at=500:1e-4 --max-error-at=600:1e-4 "
                  "--max-error-at=700:1e-4 --serial=W-0042 --note=customer='Tunnel and Sons' --note=shift=2"}};
    for (const auto& c : cases)
    {
        const TemporaryFolder f;
        SceneOptions options;
        options.views = c.views;
        options.stereo = c.stereo;
        writeScene(f, options, 135);
        const ToolResult r = runTool(brief(f, PANE + lens(f) + (c.stereo ? images2(f) + " --camera2=" + f / "camera2.yml" : "") + c.more
                                              + " --no-cross-validation --report=" + f / "report.html"));
        INFO(r.out << r.err);
        REQUIRE(r.code != 1);
        const std::string pdf = f / "report.pdf";
        REQUIRE(std::system(("chromium --headless --no-sandbox --disable-gpu --no-pdf-header-footer --user-data-dir=" + f / "browser"
                             + " --print-to-pdf=" + pdf + " file://" + f / "report.html >/dev/null 2>&1").c_str()) == 0);
        const auto textOfPage = [&](int page) {
            const std::string text = f / "page.txt";
            REQUIRE(std::system(format("pdftotext -layout -f %d -l %d %s %s", page, page, pdf.c_str(), text.c_str()).c_str()) == 0);
            return readFile(text);
        };
        const std::string first = textOfPage(1), second = textOfPage(2);
        INFO(first << "-----\n" << second);
        const char* const heading = c.stereo ? "CALIBRATION OF 2 CAMERAS" : "CALIBRATION OF A CAMERA";
        for (const char* part : {heading, "Expected error of a measured point", "What to do next"})
        {
            CHECK(mentions(first, part));
            CHECK_FALSE(mentions(second, part));
        }
        CHECK(mentions(second, "How well it measures"));
    }
}

TEST_CASE("Given values stand with their deviations, and who said them", "[calib_tool][given]")
{
    const TemporaryFolder f;
    writeScene(f, {}, 136);
    std::string command = brief(f, lens(f) + " --thickness=20 --thickness-std=0.05 --index=N-BK7 --wedge-std=0 --no-cross-validation "
                                   "--verbose --summary=" + f / "s.json");
    const std::string exact = " --exact";
    command.erase(command.find(exact), exact.size());
    const ToolResult r = runTool(command);
    INFO(r.out << r.err);
    REQUIRE(r.code != 1);
    const nlohmann::json given = summaryOf(f)["given"];
    const auto of = [&](const std::string& what) {
        for (const auto& row : given)
            if (row["what"] == what)
                return std::vector<std::string>{row["value"], row["known_to"], row["source"]};
        return std::vector<std::string>();
    };
    using Row = std::vector<std::string>;
    CHECK(of("square of the board") == Row{"39 mm", "0.019 mm", "default"});
    CHECK(of("thickness") == Row{"20 mm", "0.05 mm", "given"});
    CHECK(of("index") == Row{"1.51852", "0.0031", "N-BK7, light of 450 to 650 nm"});
    CHECK(of("wedge of each layer") == Row{"0'", "exact", ""});
    CHECK(of("index of the scene's medium") == Row{"1", "exact", ""});
    CHECK(of("motion of all boards, direct to glass") == Row{"0 mm", "0.02 mm", "default"});
    CHECK(of("lens") == Row{"its file's", "exact", "--camera"});
    CHECK(given.size() == 7);
    CHECK(mentions(r.out, "Given values, and how well they are known:"));
}
