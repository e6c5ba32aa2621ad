// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

// What a user of refract_calib does wrong with images and options: each mistake is told by its name, and soon.
#include "run_tool.hpp"
#include "paths.hpp"
#include <catch2/catch.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <chrono>
#include <functional>
#include <iostream>
#include <sys/resource.h>

namespace {

const std::string STEREO = paths::bundled() + "/stereo";
const double MOST_PROCESSOR_SECONDS = 20;       // ten seconds on two cores; a busy machine takes longer, not more

//! Of ended children, and of theirs.
double processorSeconds()
{
    rusage usage;
    getrusage(RUSAGE_CHILDREN, &usage);
    return (double)(usage.ru_utime.tv_sec + usage.ru_stime.tv_sec) + 1e-6*(double)(usage.ru_utime.tv_usec + usage.ru_stime.tv_usec);
}

//! The bundled direct images, each changed.
std::string changed(const TemporaryFolder& folder, const std::string& name, const std::function<cv::Mat(const cv::Mat&)>& change)
{
    std::filesystem::create_directory(folder/name);
    for (const auto& entry : std::filesystem::directory_iterator(STEREO + "/direct1"))
        cv::imwrite(folder/(name + "/" + entry.path().filename().string()),
                    change(cv::imread(entry.path().string(), cv::IMREAD_GRAYSCALE)));
    return folder/(name + "/*");
}

cv::Mat leftHidden(const cv::Mat& image)
{
    cv::Mat half = image.clone();
    half.colRange(0, image.cols/2 - 20).setTo(128);
    return half;
}

//! A large board of 12x9, its right part out of the picture.
cv::Mat largeBoard(const cv::Mat& image)
{
    cv::Mat board(image.size(), CV_8U);
    for (int y = 0; y < board.rows; y++)
        for (int x = 0; x < board.cols; x++)
        {
            const int column = (x - 400 + y/20)/110, row = (y - 20 + x/30)/95;
            const bool inside = x - 400 + y/20 >= 0 && y - 20 + x/30 >= 0 && column < 13 && row < 10;
            board.at<uchar>(y, x) = inside && (row + column) % 2 == 0 ? 40 : 200;
        }
    cv::GaussianBlur(board, board, cv::Size(), 0.8);
    return board;
}

cv::Mat noise(const cv::Mat& image)
{
    cv::Mat result(image.size(), CV_8U);
    cv::randu(result, 0, 255);
    cv::GaussianBlur(result, result, cv::Size(), 8);
    cv::normalize(result, result, 0, 255, cv::NORM_MINMAX);
    return result;
}

struct Mistake
{
    std::string name, arguments;
    std::vector<std::string> expected;          //!< all are said
    std::vector<std::string> not_said = {};
};

std::string direct(const std::string& glob) { return " --direct='" + glob + "'"; }

} // namespace

TEST_CASE("Mistakes with images and options are told by their names within seconds", "[tools][calib][mistakes][slow]")
{
    cv::setRNGSeed(27);
    const TemporaryFolder f;
    const std::string good = direct(STEREO + "/direct1/*"), size = " --size=6x5", glass = " --glass='" + STEREO + "/glass1/*'";
    const std::string half = changed(f, "half", leftHidden), large = changed(f, "large", largeBoard);
    const std::string nothing = changed(f, "nothing", noise);
    const std::string small = changed(f, "small", [](const cv::Mat& image) {
        cv::Mat result;
        cv::resize(image, result, cv::Size(), 0.5, 0.5, cv::INTER_AREA);
        return result;
    });
    const std::string turned = changed(f, "turned", [](const cv::Mat& image) { return cv::Mat(image.t()); });
    const std::string mixed = changed(f, "mixed", [](const cv::Mat& image) { return image; });
    std::filesystem::copy_file(f / "small/air05.jpg", f / "mixed/air05.jpg", std::filesystem::copy_options::overwrite_existing);
    const std::string texts = changed(f, "texts", [](const cv::Mat& image) { return image; });
    writeFile(f / "texts/air03.jpg", "no image");
    writeFile(f / "film.mp4", "no film");
    const Mistake mistakes[] = {
        {"board of another size, larger", good + glass + " --size=7x6", {"looks like one of 6x5", "--size=7x6"}},
        {"board of another size, smaller", good + glass + " --size=5x4", {"looks like one of 6x5", "give --size=6x5"}},
        {"squares counted", good + glass + " --size=7x5", {"looks like one of 6x5", "not squares"}},
        {"half the board hidden", direct(half) + glass + size, {"only a part of the chessboard", "--partial"}, {"light and focus"}},
        {"half the board hidden, through the glass", good + size + " --glass='" + half + "'", {"only a part of the chessboard"}},
        {"half a large board", direct(large) + glass + " --size=12x9", {"add --unpaired --partial"}, {"too little"}},
        {"another pattern, dots", good + glass + size + " --pattern=circles", {"--pattern=chessboard --size=6x5"}},
        {"another pattern, ChArUco", good + glass + size + " --pattern=charuco", {"--pattern=chessboard --size=6x5"}},
        {"no board", direct(nothing) + glass + size, {"not found in any image of '" + nothing}},
        {"one image of another size", direct(mixed) + glass + size, {"mixed/air05.jpg' is 640x512", "17 other images are 1280x1024"}},
        {"images resized", direct(small) + glass + size, {"640x512", "1280x1024", "not resized"}},
        {"images turned", direct(turned) + glass + size, {"1024x1280", "exchanged"}},
        {"--image-size exchanged", good + glass + size + " --image-size=1024x1280", {"1280x1024 pixels, not 1024x1280", "exchanged"}},
        {"a text as image", direct(texts) + glass + size, {"texts/air03.jpg' is not an image"}},
        {"a grey image by its channel", good + glass + size + " --channel=green", {"is a grey image", "leave --channel out"}},
        {"no file", direct(f / "absent/*") + glass + size, {"no file matches"}},
        {"a folder", direct(f / "half") + glass + size, {"is a folder"}},
        {"a video", direct(f / "film.mp4") + glass + size, {"is a video"}},
        {"one file for two cameras", good + glass + size + " --direct2='" + STEREO + "/direct1/*' --glass2='" + STEREO + "/glass2/*'",
         {"direct1/air01.jpg' is one of the direct images of camera 1 and one of the direct images of camera 2"}},
        {"no lens", glass + size + " --glass2='" + STEREO + "/glass2/*'", {"there are no images for the lens"}},
        {"names that do not pair", direct(STEREO + "/direct1/air*") + size + " --glass='" + STEREO + "/measure1/*'", {"there is no pair"}},
    };
    double most = 0.;
    for (const Mistake& mistake : mistakes)
    {
        const double before = processorSeconds();
        const auto start = std::chrono::steady_clock::now();
        const ToolResult result = runTool("refract_calib --square=39 --thickness=20 --index=1.5437 --out=" + (f / "calib.yml")
                                          + mistake.arguments);
        const double clock = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
        const double processor = processorSeconds() - before;
        most = std::max(most, processor);
        CAPTURE(mistake.name, result.err, processor);
        std::cout << cv::format("[numbers] mistake: %s: %.1f s of processor time, %.1f s\n", mistake.name.c_str(), processor, clock);
        CHECK(result.code == 1);
        CHECK(std::count(result.err.begin(), result.err.end(), '\n') == 1);
        for (const std::string& part : mistake.expected)
        {
            CAPTURE(part);
            CHECK(mentions(result.err, part));
        }
        for (const std::string& part : mistake.not_said)
        {
            CAPTURE(part);
            CHECK(!mentions(result.err, part));
        }
        CHECK(processor < MOST_PROCESSOR_SECONDS);
        CHECK(!std::filesystem::exists(f / "calib.yml"));
    }
    std::cout << cv::format("[numbers] longest answer to a mistake: %.1f s of processor time\n", most);
}

TEST_CASE("A square that is no other unit, and cameras exchanged, are named, and nothing beside", "[tools][calib][mistakes][slow]")
{
    const TemporaryFolder f;
    const auto calibrate = [&](const std::string& square, const std::string& glass1, const std::string& glass2) {
        return runTool("refract_calib --size=6x5 --thickness=20 --index=1.5437 --out=" + (f / "calib.yml") + " --square=" + square
                       + direct(STEREO + "/direct1/*") + " --direct2='" + STEREO + "/direct2/*' --glass='" + STEREO + "/" + glass1
                       + "/*' --glass2='" + STEREO + "/" + glass2 + "/*'").err; };
    CHECK_THAT(calibrate("25", "glass1", "glass2"), Catch::Contains("--square would be 38.9 in place of 25")
                                                    || Catch::Contains("--square would be 39 in place of 25"));
    // What is left is what the boards moved, within --placement-std.
    CHECK_THAT(calibrate("39", "glass2", "glass1"), Catch::Contains("--glass and --glass2 exchanged")
                                                    && !Catch::Contains("something else"));
}
