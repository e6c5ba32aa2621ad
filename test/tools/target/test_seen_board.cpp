// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

// What is seen of a board, and the progress that is told while it is searched.
#include "console/progress.hpp"
#include "target/chessboard.hpp"
#include <catch2/catch.hpp>
#include <opencv2/imgproc.hpp>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <thread>
#include <unistd.h>

using namespace tools;

TEST_CASE("A board that is partly out of the picture, or ends there, is told by what is seen of it", "[seen_board]")
{
    const cv::Size board(9, 6);
    const auto pieceAt = [](cv::Point2f first, float step, cv::Size size) {
        SeenChessboard piece{size, {}};
        for (int row = 0; row < size.height; row++)
            for (int column = 0; column < size.width; column++)
                piece.corners.push_back(first + step*cv::Point2f((float)column, (float)row));
        return piece;
    };
    const auto picture = [](cv::Point first, int step, cv::Size corners) {      // of a board with so many corners, of which this is one
        cv::Mat image(480, 640, CV_8U, cv::Scalar(230));
        for (int row = 0; row <= corners.height; row++)
            for (int column = 0; column <= corners.width; column++)
                if ((row + column) % 2 == 0)
                    cv::rectangle(image, cv::Rect(first.x + (column - 1)*step, first.y + (row - 1)*step, step, step), cv::Scalar(30),
                                  cv::FILLED);
        return image;
    };
    const cv::Mat near = picture({20, 60}, 90, {9, 6}), turned = picture({60, 20}, 90, {6, 9}), whole = picture({60, 60}, 40, board);
    CHECK_FALSE(mayBeInView(pieceAt({20, 60}, 90, {6, 5}), board, near));           // three more columns to the right
    CHECK_FALSE(mayBeInView(pieceAt({60, 20}, 90, {5, 6}), board, turned));         // however it was counted
    CHECK(mayBeInView(pieceAt({100, 100}, 40, {6, 5}), board, whole));              // they are in view
    CHECK(mayBeInView(pieceAt({60, 60}, 40, board), board, whole));
    CHECK_FALSE(mayBeInView(pieceAt({60, 60}, 40, {6, 5}), board, picture({60, 60}, 40, {6, 5})));      // the board ends there
    CHECK(mayBeInView(pieceAt({20, 60}, 90, {4, 3}), board, near));                 // as much may be anything
    CHECK(mayBeInView(SeenChessboard(), board, near));
}

TEST_CASE("What is seen of a board is looked for until it is enough", "[seen_board]")
{
    const int SIDE = 90;
    cv::Mat image(480, 640, CV_8U, cv::Scalar(230));        // a board that goes on beyond the left and the lower border
    for (int row = 0; row < 6; row++)
        for (int column = 0; column < 7; column++)
            if ((row + column) % 2 == 0)
                cv::rectangle(image, cv::Rect(column*SIDE - 20, 90 + row*SIDE, SIDE, SIDE), cv::Scalar(30), cv::FILLED);
    cv::GaussianBlur(image, image, cv::Size(), 1.);
    int calls = 0;
    const auto look = [&](bool isEnough) {
        calls = 0;
        return lookForChessboard(image, [&](const SeenChessboard& seen) {
            calls++;
            CHECK((int)seen.corners.size() == seen.size.area());
            return isEnough; }); };
    const SeenChessboard first = look(true);
    CHECK(calls == 1);
    CHECK_FALSE(mayBeInView(first, cv::Size(9, 6), image));
    CHECK(look(false).size.area() == lookForChessboard(image).size.area());
}

TEST_CASE("Noise beside a board that a wide-angle lens bends does not hold up the search for it", "[seen_board]")
{
    cv::Mat image(375, 500, CV_8U);
    for (int v = 0; v < image.rows; v++)
        for (int u = 0; u < image.cols; u++)
        {
            const double x = (u - 250)/250., y = (v - 187)/250., bent = 1 + 0.8*(x*x + y*y);
            const bool isDark = ((int)std::floor(4*(x*bent + 3)) + (int)std::floor(4*(y*bent + 3))) % 2 != 0;
            image.at<uchar>(v, u) = std::abs(x*bent) < 0.9 && std::abs(y*bent) < 0.68 && isDark ? 40 : 210;
        }
    cv::Mat noise(image.size(), CV_16S), sum;
    cv::RNG(1).fill(noise, cv::RNG::NORMAL, 0, 8);
    cv::add(image, noise, image, cv::noArray(), CV_8U);
    CHECK(detectChessboard(image, cv::Size(9, 6), nullptr).empty());        // it has 7 x 5 corners, in minutes if OpenCV looks at each speck
}

TEST_CASE("Progress without a terminal names what is worked on, every few seconds", "[progress]")
{
    for (const bool quiet : {false, true})
    {
        std::FILE* file = std::tmpfile();
        const int terminal = dup(STDERR_FILENO);
        dup2(fileno(file), STDERR_FILENO);
        {
            Progress progress("searching", 3, quiet);
            progress.at("a.png");
            progress.step();
            progress.at("b.png");
            std::this_thread::sleep_for(std::chrono::milliseconds(5400));
        }
        dup2(terminal, STDERR_FILENO);
        close(terminal);
        std::rewind(file);
        char text[100] = "";
        const size_t length = std::fread(text, 1, sizeof(text), file);
        std::fclose(file);
        CHECK(std::string(text, length) == (quiet ? "" : "... searching 1/3: b.png\n"));
    }
}
