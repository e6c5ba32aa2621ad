// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "console/failure.hpp"
#include "colmap/colmap_model.hpp"
#include "harness.hpp"
#include "scratch.hpp"

// COLMAP's models: a first letter, b of bytes or t of text, then the files, in order, each before the line ====.

void fuzz::tryInput(Bytes& bytes)
{
    static const Scratch folder;
    const char SEPARATOR[] = "====\n";
    const std::string input = bytes.rest();
    const std::string extension = !input.empty() && input[0] == 'b' ? ".bin" : ".txt";
    size_t at = std::min<size_t>(1, input.size());
    for (const char* stem : {"cameras", "images", "points3D", "rigs", "frames"})
    {
        const size_t end = std::min(input.find(SEPARATOR, at), input.size());
        folder.write(stem + extension, input.substr(at, end - at));
        std::filesystem::remove(folder/(stem + std::string(extension == ".bin" ? ".txt" : ".bin")));
        at = std::min(end + sizeof SEPARATOR - 1, input.size());
    }
    try
    {
        const tools::ColmapModel model = tools::readColmapModel(folder.path().string());
        promise(!model.images.empty() && !model.points.empty(), "a model has images and points");
        for (const tools::ColmapPoint& point : model.points)
            promise(std::isfinite(cv::norm(point.X)) || cv::norm(point.X) > 1e150, "points are finite");
        tools::writeColmapModel(model, folder/"again");
        const tools::ColmapModel again = tools::readColmapModel(folder/"again");
        promise(again.images.size() == model.images.size() && again.points.size() == model.points.size(), "it is read as it was written");
    }
    catch (const tools::Failure&)       // refused, in a sentence
    {
    }
    std::filesystem::remove_all(folder/"again");
}
