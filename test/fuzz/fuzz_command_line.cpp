// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "harness.hpp"
#include "one_program.hpp"
#include "scratch.hpp"
#include <opencv2/imgcodecs.hpp>
#include <iostream>
#include <map>
#include <unistd.h>

/* The tools as they are started: the input is a command line, one argument a line, the tool's name first. They run in a folder
of their own, with a small file of each kind; arguments that could lead out of it are not tried. */

using namespace fuzz;
namespace fs = std::filesystem;

namespace {

const char CAMERA[] = R"(
  image_width: 32
  image_height: 24
  camera_matrix: !!opencv-matrix { rows: 3, cols: 3, dt: d, data: [ 30., 0., 16., 0., 30., 12., 0., 0., 1. ] }
  distortion_coefficients: !!opencv-matrix { rows: 4, cols: 1, dt: d, data: [ -0.1, 0.01, 0., 0. ] }
  glass_window: { normal: [ 0.1, 0., 0.995 ], distance: 5., thickness: [ 10. ], index: [ 1.5 ] }
)";
const char POSE[] = R"(
R: !!opencv-matrix { rows: 3, cols: 3, dt: d, data: [ 1., 0., 0., 0., 1., 0., 0., 0., 1. ] }
T: [ -50., 0., 0. ]
)";
const char RENDERING[] = R"(
target: { pattern: chessboard, size: "3x3", square: 20. }
poses: { board: [ { rvec: [ 0., 0., 0. ], tvec: [ -20., -20., 300. ] } ] }
sets: { glass: { window: 1, poses: [ board ] } }
)";

//! The working folder, as it was at the start, before each command.
class Folder
{
public:
    Folder()
    {
        fs::current_path(scratch_.path());
        fs::create_directory("work");       // one deeper than what is removed at the end
        fs::current_path("work");
        const std::string head = "%YAML:1.0\n---\n", pair = head + "camera1:" + CAMERA + "camera2:" + CAMERA + POSE;
        std::string one = CAMERA, vnl = "# filename x y\n", points = "u,v\n", matches = "id,u1,v1,u2,v2\n";
        for (size_t at = one.find("\n  "); at != std::string::npos; at = one.find("\n  ", at))
            one.erase(at + 1, 2);
        for (const char* image : {"a", "b"})
            for (int i = 0; i < 9; i++)
                vnl += cv::format("%s.png %d %d\n", image, 8 + 5*(i % 3), 6 + 4*(i/3));
        for (int i = 0; i < 3; i++)
            points += cv::format("%d,%d\n", 8 + i, 9);
        for (int i = 0; i < 12; i++)
            matches += cv::format("%d,%d,%d,%d,%d\n", i, 8 + 5*(i % 4), 6 + 4*(i/4), 3 + 5*(i % 4), 6 + 4*(i/4));
        files_ = {{"pair.yml", pair}, {"one.yml", head + one}, {"rig.yml", pair + RENDERING}, {"corners.vnl", vnl},
                  {"points.txt", points}, {"matches.csv", matches}, {"lengths.csv", "id1,id2,length,std\n0,3,40,0.1\n4,9,30,0.1\n"},
                  {"measured.csv", "id,x,y,z,sx,sy,sz,status\n0,-5,0,200,0.1,0.1,1,0\n1,5,0,210,0.1,0.1,1,0\n2,0,5,220,0.1,0.1,1,0\n"},
                  {"certified.csv", "name,image1,id1,image2,id2,length,U\na,,0,,1,14,0.1\nb,,1,,2,12,0.1\n"},
                  {"run.toml", "size = \"3x3\"\nsquare = [20]\n"}};
        std::vector<uchar> image;
        cv::imencode(".png", cv::Mat(24, 32, CV_8U, cv::Scalar(90)), image);
        files_["a.png"] = files_["b.png"] = std::string(image.begin(), image.end());
        files_["empty.png"] = "";
        restore();
    }

    void restore()
    {
        if (isAsItWas())
            return;
        for (const auto& entry : fs::directory_iterator("."))
            fs::remove_all(entry.path());
        times_.clear();
        for (const auto& file : files_)
        {
            std::ofstream(file.first, std::ios::binary) << file.second;
            times_[file.first] = fs::last_write_time(file.first);
        }
    }

private:
    bool isAsItWas() const
    {
        size_t count = 0;
        for (const auto& entry : fs::directory_iterator("."))
        {
            const auto found = times_.find(entry.path().filename().string());
            if (found == times_.end() || !entry.is_regular_file() || entry.last_write_time() != found->second)
                return false;
            count++;
        }
        return count == files_.size();
    }

    Scratch scratch_;
    std::map<std::string, std::string> files_;
    std::map<std::string, fs::file_time_type> times_;
};

//! Not to be tried: what names other folders, what starts gnuplot, and what waits.
bool leadsOut(const std::string& argument)
{
    return argument.find('/') != std::string::npos || argument.find("..") != std::string::npos
           || argument.find('~') != std::string::npos || argument.find("--rep") != std::string::npos
           || argument.find("--watch") != std::string::npos;
}

} // namespace

void fuzz::tryInput(Bytes& bytes)
{
    static Folder folder;
    static std::ofstream nowhere;
    std::cout.rdbuf(nowhere.rdbuf());
    std::cerr.rdbuf(nowhere.rdbuf());

    std::vector<std::string> words(1);
    for (const char c : bytes.rest())
        if (c == '\n')
            words.emplace_back();
        else if (c != 0)            // ends an argument in C
            words.back() += c;
    if (!words.back().empty() || words.size() == 1)
        words.emplace_back();
    words.pop_back();
    const tools::NamedTool* tool = tools::ALL_TOOLS;
    while (tool->name && tool->name != words[0])
        tool++;
    if (!tool->name)
        return;
    std::vector<char*> arguments;
    for (std::string& word : words)
    {
        if (leadsOut(word))
            return;
        arguments.push_back(&word[0]);
    }
    arguments.push_back(nullptr);
    folder.restore();
    const int code = tool->main((int)words.size(), arguments.data());
    promise(code >= 0 && code <= 2, "the exit code is 0, 1 or 2");
}
