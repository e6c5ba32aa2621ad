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
    inParallel((int)all.size(), [&](int i) {
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
    });
    return all;
}

[[noreturn]] void refuseGrey(const std::string& path, Channel channel)
{
    throw Failure("--channel=" + nameOf(channel) + ": '" + path + "' is a grey image, which has no channels: leave --channel out, and say "
                  "the light of the camera by --wavelength where an index is a material's name");
}

//! All that cannot be read are named, as each may have to be copied again.
void requireReadable(const std::vector<Checked>& images)
{
    const size_t MOST = 8;
    std::vector<const Checked*> bad;
    for (const Checked& image : images)
        if (image.error)
            bad.push_back(&image);
    if (bad.size() == 1)
        std::rethrow_exception(bad[0]->error);
    std::string text;
    for (size_t i = 0; i < std::min(MOST, bad.size()); i++)
        try
        {
            std::rethrow_exception(bad[i]->error);
        }
        catch (const Failure& error)
        {
            text += std::string(i ? "; " : ": ") + error.what();
        }
    if (!bad.empty())
        throw Failure(cv::format("%zu of %zu images cannot be used", bad.size(), images.size()) + text
                      + (bad.size() > MOST ? cv::format("; and %zu more", bad.size() - MOST) : ""));
}

std::vector<std::string> pathsOf(const std::vector<const Checked*>& images)
{
    std::vector<std::string> paths;
    for (const Checked* image : images)
        paths.push_back(image->path);
    return paths;
}

//! "'a' is", "'a', 'b' are"
std::string areThey(const std::vector<const Checked*>& images)
{
    return listed(pathsOf(images)) + (images.size() > 1 ? " are " : " is ");
}

//! What to do about an image of another size than was expected.
std::string sizeAdvice(cv::Size image, cv::Size expected)
{
    if (image == cv::Size(expected.height, expected.width))
        return "width and height are exchanged: use images as the camera stored them, not turned; a size is WIDTHxHEIGHT";
    return "use the images of this camera, not resized";
}

void requireKnownSize(const std::vector<Checked>& images, const std::vector<ImageSource>& sources)
{
    for (const Checked& first : images)
    {
        const cv::Size known = sources[first.source].imageSize, size = first.facts.size;
        if (known.empty() || size == known)
            continue;
        std::vector<const Checked*> others, all;
        for (const Checked& image : images)
            if (image.source == first.source)
            {
                all.push_back(&image);
                if (image.facts.size == size)
                    others.push_back(&image);
            }
        if (others.size() == all.size())            // not the images, but what they are held against: one is enough
            others.resize(1);
        throw Failure(areThey(others) + sizeText(size) + " pixels, not " + sizeText(known)
                      + " as the calibration, --camera or --image-size says: " + sizeAdvice(size, known));
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
    const cv::Size usual = most->second[0]->facts.size;
    const std::string those = most->second.size() > 1 ? std::to_string(most->second.size()) + " other images are "
                                                      : "'" + most->second[0]->path + "' is ";
    std::string odd;
    for (const auto& entry : bySize)
        if (entry.first != most->first)
            odd += areThey(entry.second) + sizeText(entry.second[0]->facts.size) + " pixels, ";
    const cv::Size first = (bySize.begin() == most ? std::next(bySize.begin()) : bySize.begin())->second[0]->facts.size;
    throw Failure(odd + those + sizeText(usual) + ": all images of a camera must have one size; " + sizeAdvice(first, usual));
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

std::vector<cv::Size> checkImages(const std::vector<ImageSource>& sources, const std::vector<std::vector<std::string>>& files,
                                  Channel channel, bool quiet)
{
    const std::vector<Checked> images = readAll(files, quiet);
    requireReadable(images);
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
