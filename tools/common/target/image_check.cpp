// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "target/image_check.hpp"
#include "console/failure.hpp"
#include "console/numbers.hpp"
#include "console/progress.hpp"

#include <algorithm>
#include <exception>
#include <map>

namespace tools {

namespace {

//! One file, and what came of reading it.
struct Checked
{
    std::string path;
    size_t source;
    ImageFacts facts;
    std::exception_ptr error;
};

std::vector<Checked> readAll(const std::vector<std::vector<std::string>>& files, bool quiet)
{
    std::vector<Checked> all;
    for (size_t s = 0; s < files.size(); s++)
        for (const std::string& path : files[s])
            all.push_back({path, s, {}, nullptr});
    Progress progress("reading images", (int)all.size(), quiet);
    cv::parallel_for_(cv::Range(0, (int)all.size()), [&](const cv::Range& range) {
        for (int i = range.start; i < range.end; i++)
        {
            progress.at(all[i].path);
            try
            {
                all[i].facts = factsOf(all[i].path);
            }
            catch (...)
            {
                all[i].error = std::current_exception();
            }
            progress.step();
        }
    }, (double)all.size());
    return all;
}

[[noreturn]] void refuseGrey(const std::string& path, Channel channel)
{
    throw Failure("--channel=" + nameOf(channel) + ": '" + path + "' is a grey image, which has no channels: leave --channel out, and say "
                  "the light of the camera by --wavelength where an index is a material's name");
}

void requireKnownSize(const std::vector<Checked>& images, const std::vector<ImageSource>& sources)
{
    for (const Checked& image : images)
    {
        const cv::Size known = sources[image.source].imageSize;
        if (!known.empty() && image.facts.size != known)
            throw Failure("'" + image.path + "' is " + sizeText(image.facts.size) + " pixels, not " + sizeText(known)
                          + " as the calibration, --camera or --image-size says: " + sizeAdvice(image.facts.size, known));
    }
}

//! Of one camera in one state; those that differ from the most are to blame.
void requireOneSize(const std::vector<Checked>& images, size_t source)
{
    std::map<std::pair<int, int>, std::vector<const Checked*>> bySize;
    for (const Checked& image : images)
        if (image.source == source)
            bySize[{image.facts.size.width, image.facts.size.height}].push_back(&image);
    if (bySize.size() < 2)
        return;
    const auto most = std::max_element(bySize.begin(), bySize.end(), [](const auto& a, const auto& b) {
        return a.second.size() < b.second.size(); });
    for (const auto& entry : bySize)
        if (entry.first != most->first)
        {
            const cv::Size size = entry.second[0]->facts.size, usual = most->second[0]->facts.size;
            const size_t count = most->second.size();
            throw Failure("'" + entry.second[0]->path + "' is " + sizeText(size) + " pixels, "
                          + (count > 1 ? std::to_string(count) + " other images are " : "'" + most->second[0]->path + "' is ")
                          + sizeText(usual) + ": all images of a camera must have one size; " + sizeAdvice(size, usual));
        }
}

//! The same, of both states.
void requireOneSizeOfCamera(const std::vector<Checked>& images, const std::vector<ImageSource>& sources)
{
    std::map<int, const Checked*> first;
    for (const Checked& image : images)
    {
        const ImageSource& source = sources[image.source];
        const Checked* const other = first.emplace(source.camera, &image).first->second;
        if (other->facts.size != image.facts.size)
            throw Failure(cv::format("camera %d: %s ('%s') are %s, %s ('%s') %s: they must come from the same camera at the same "
                                     "resolution; ", source.camera + 1, sources[other->source].name.c_str(), other->path.c_str(),
                                     sizeText(other->facts.size).c_str(), source.name.c_str(), image.path.c_str(),
                                     sizeText(image.facts.size).c_str()) + sizeAdvice(image.facts.size, other->facts.size));
    }
}

} // namespace

void requireColour(const std::string& path, Channel channel)
{
    if (channel != BRIGHTNESS && !factsOf(path).coloured)
        refuseGrey(path, channel);
}

std::string sizeAdvice(cv::Size image, cv::Size expected)
{
    if (image == cv::Size(expected.height, expected.width))
        return "width and height are exchanged: use images as the camera stored them, not turned; a size is WIDTHxHEIGHT";
    return "use the images of this camera, not resized";
}

std::vector<cv::Size> checkImages(const std::vector<ImageSource>& sources, const std::vector<std::vector<std::string>>& files,
                                  Channel channel, bool quiet)
{
    const std::vector<Checked> images = readAll(files, quiet);
    for (const Checked& image : images)
        if (image.error)
            std::rethrow_exception(image.error);
    requireKnownSize(images, sources);
    for (size_t s = 0; s < sources.size(); s++)
        requireOneSize(images, s);
    requireOneSizeOfCamera(images, sources);
    for (const Checked& image : images)
        if (channel != BRIGHTNESS && !image.facts.coloured)
            refuseGrey(image.path, channel);
    std::vector<cv::Size> sizes(sources.size());
    for (const Checked& image : images)
        sizes[image.source] = image.facts.size;
    return sizes;
}

} // namespace tools
