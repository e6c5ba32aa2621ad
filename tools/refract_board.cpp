// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "calibrate/units.hpp"
#include "console/cli.hpp"
#include "console/file_output.hpp"
#include "target/board_page.hpp"

#include <filesystem>
#include <iostream>

static const char MANUAL[] = R"(Writes a calibration board to print: PDF or SVG, in true size.

  refract_board --pattern=chessboard --size=9x6 --square=25 --out=board.pdf
  refract_board --pattern=charuco --size=11x7 --square=22 --dictionary=DICT_5X5_100 --paper=A3 --out=board.svg
  refract_board --pattern=aprilgrid --size=6x6 --square=24 --tag-spacing=0.3 --out=tags.pdf

Below the board stand its size, as the other tools want it, and a ruler of 100 mm. Print at 100 % ("actual size", not "fit to page")
and measure the ruler: if it is not 100 mm long, neither is a square what --square says; print again, or measure the whole board and
give the square that follows. Paper bends: glue it on something flat.

A chessboard with one even and one odd number of inner corners, ChArUco or AprilGrid cannot be taken for one turned by half.)";

namespace {

using namespace tools;

struct Options
{
    TargetOptions target;
    std::string paper, unit = "mm", out;
};

void addOptions(OptionParser& parser, Options& options)
{
    options.target.addTo(parser, true);
    parser.add("--unit", options.unit, "unit of --square and --marker").check(isMember(unitNames()))
        .captureDefault();
    parser.add("--paper", options.paper, "A0 ... A5 (either way round) or WxH in mm; default: the smallest from A4 that fits");
    parser.add("--out", options.out, "file to write (.pdf, .svg)").required();
}

void requireExtension(const std::string& path)
{
    const std::string extension = std::filesystem::path(path).extension().string();
    for (const char* known : {".pdf", ".svg", ".PDF", ".SVG"})
        if (extension == known)
            return;
    throw Failure("--out=" + path + ": a board is written as .pdf or .svg");
}

//! As the other tools are told of it.
std::string asOptions(const Options& o, double tagSpacing)
{
    std::string text = "--pattern=" + o.target.pattern + " --size=" + o.target.size + cv::format(" --square=%g", o.target.square);
    if (o.target.pattern == "charuco")
        text += (o.target.marker > 0 ? cv::format(" --marker=%g", o.target.marker) : "") + " --dictionary=" + o.target.dictionary;
    if (o.target.pattern == "aprilgrid")
        text += cv::format(" --tag-spacing=%g", tagSpacing);
    return text + (o.unit == "mm" ? "" : " --unit=" + o.unit);
}

} // namespace

int refract_board_main(int argc, char** argv)
{
    return runTool(argc, argv, MANUAL, [](Command& command) {
        const Options options = parsed(command, addOptions);
        const Target target(options.target);
        const double millimetres = millimetresIn(options.unit), square = options.target.square*millimetres, LEAST = 0.5;
        if (square < LEAST || square*std::max(target.size().width, target.size().height) > 10000)
            throw Failure(cv::format("--square=%g %s: a board to print has squares of %g mm or more, and is not longer than 10 m",
                                     options.target.square, options.unit.c_str(), LEAST));
        requireExtension(options.out);
        checkOutputs({{"--out", options.out, OUTPUT_TEXT}}, {command.settings()});
        const BoardPage page(target, millimetres, options.paper);
        page.write(options.out, {asOptions(options, target.tagSpacing()),
                                 cv::format("Square: %g mm. The ruler is 100 mm long: print at 100 %%, not fitted to the page, and measure "
                                            "it.", square)});
        if (!command.quiet())
            std::cout << options.out << ": " << page.paperName()
                      << cv::format(", board %g x %g mm; print at 100 %% and measure the ruler", page.board().width, page.board().height)
                      << std::endl;
        return DONE;
    });
}
