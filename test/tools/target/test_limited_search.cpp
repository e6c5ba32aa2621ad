// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

// A search that would never end, and the progress that is told meanwhile.
#include "console/progress.hpp"
#include "target/limited_search.hpp"
#include "target/chessboard.hpp"
#include <catch2/catch.hpp>
#include <opencv2/imgproc.hpp>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <thread>
#include <unistd.h>

using namespace tools;

namespace {

double secondsOf(const std::function<void()>& work)
{
    const auto start = std::chrono::steady_clock::now();
    work();
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

} // namespace

TEST_CASE("A board that is partly out of the picture, or ends there, is told by what is seen of it", "[limited_search]")
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

TEST_CASE("What is seen of a board is looked for until it is enough", "[limited_search]")
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

TEST_CASE("A search ends in its time, whatever it does", "[limited_search]")
{
    const std::vector<cv::Point2f> points = {{1, 2}, {3, 4}};
    CHECK(searchLimited(5, 10, [&] { return points; }) == points);
    CHECK(searchLimited(5, 1, [&] { return points; }).size() == 1);
    CHECK(searchLimited(5, 10, [] { return std::vector<cv::Point2f>(); }).empty());
    CHECK(searchLimited(5, 10, []() -> std::vector<cv::Point2f> { throw std::runtime_error("no"); }).empty());
    CHECK(searchLimited(5, 10, []() -> std::vector<cv::Point2f> { raise(SIGKILL); return {}; }).empty());
    CHECK(secondsOf([] {
        CHECK(searchLimited(1, 10, []() -> std::vector<cv::Point2f> { for (volatile int i = 0;; i = i + 1) {} }).empty());
    }) < 10);
    CHECK(secondsOf([] {
        CHECK(searchLimited(1, 10, []() -> std::vector<cv::Point2f> { sleep(60); return {}; }).empty());
    }) < 10);
}

// Not under the address sanitizer, whose allocator a fork beside other threads may leave locked for ever.
TEST_CASE("Searches of many threads at once all end with their result", "[limited_search][slow]")
{
    std::vector<std::thread> threads;
    std::vector<size_t> counts(8);
    for (size_t i = 0; i < counts.size(); i++)
        threads.emplace_back([&counts, i] {
            counts[i] = searchLimited(5, 10, [i] { return std::vector<cv::Point2f>(i); }).size();
        });
    for (std::thread& thread : threads)
        thread.join();
    for (size_t i = 0; i < counts.size(); i++)
        CHECK(counts[i] == i);
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
