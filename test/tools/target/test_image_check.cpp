// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

// Files that are no images of one camera are refused before anything is searched, and the sentence names the file.
#include "target/image_check.hpp"
#include "console/images.hpp"
#include "console/failure.hpp"
#include "temporary_folder.hpp"
#include <catch2/catch.hpp>
#include <opencv2/imgcodecs.hpp>
#include <fstream>

using namespace tools;

namespace {

const cv::Size WIDE(64, 48), TALL(48, 64), SMALL(32, 24);

struct Files
{
    TemporaryFolder folder;

    std::string image(const std::string& name, cv::Size size, int type = CV_8U) const
    {
        cv::Mat pixels(size, type);
        cv::randu(pixels, 0, 255);
        cv::imwrite(folder/name, pixels);
        return folder/name;
    }
};

//! What is said; empty: nothing.
std::string said(const std::vector<ImageSource>& sources, const std::vector<std::vector<std::string>>& files, Channel channel = BRIGHTNESS)
{
    try
    {
        checkImages(sources, files, channel, true);
    }
    catch (const Failure& e)
    {
        return e.what();
    }
    return "";
}

void expect(const std::string& text, const std::vector<std::string>& parts)
{
    for (const std::string& part : parts)
    {
        CAPTURE(text, part);
        CHECK(text.find(part) != std::string::npos);
    }
}

const ImageSource DIRECT = {"direct/*", {}, 0, "direct images"}, GLASS = {"glass/*", {}, 0, "glass images"};

} // namespace

TEST_CASE("Sizes of images are checked, and the one that differs is named", "[image check]")
{
    const Files f;
    const std::string a = f.image("a.png", WIDE), b = f.image("b.png", WIDE), small = f.image("c.png", SMALL);
    const std::string tall = f.image("d.png", TALL);
    CHECK(said({DIRECT, GLASS}, {{a}, {b}}).empty());
    CHECK(checkImages({DIRECT, GLASS}, {{a}, {}}, BRIGHTNESS, true) == std::vector<cv::Size>{WIDE, cv::Size()});
    expect(said({DIRECT}, {{a, b, small}}), {"'" + small + "' is 32x24", "2 other images are 64x48", "not resized"});
    expect(said({DIRECT}, {{a, tall, b}}), {"'" + tall + "' is 48x64", "exchanged"});
    expect(said({DIRECT, GLASS}, {{a}, {small}}),
           {"camera 1: direct images ('" + a + "') are 64x48, glass images ('" + small + "') 32x24"});
    ImageSource known = DIRECT;
    known.imageSize = TALL;
    expect(said({known}, {{a, b}}), {"'" + a + "' is 64x48 pixels, not 48x64", "WIDTHxHEIGHT"});
    expect(said({known}, {{a, tall, b}}), {"'" + a + "', '" + b + "' are 64x48 pixels, not 48x64"});
    const std::string another = f.image("e.png", SMALL);
    expect(said({DIRECT}, {{a, small, b, tall, another, a}}), {"'" + small + "', '" + another + "' are 32x24 pixels, '" + tall
                                                               + "' is 48x64 pixels, 3 other images are 64x48"});
    ImageSource second = GLASS;         // another camera may have another size
    second.camera = 1;
    CHECK(said({DIRECT, second}, {{a}, {small}}).empty());
}

TEST_CASE("A file that is no image, or cut, is named before sizes", "[image check]")
{
    const Files f;
    const std::string a = f.image("a.png", WIDE), small = f.image("b.png", SMALL), text = f.folder / "c.png", cut = f.folder / "d.png";
    std::ofstream(text) << "no image";
    std::ifstream in(a, std::ios::binary);
    std::string bytes{std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
    std::ofstream(cut, std::ios::binary) << bytes.substr(0, bytes.size()/2);
    expect(said({DIRECT}, {{a, small, text}}), {"'" + text + "' is not an image"});
    expect(said({DIRECT}, {{a, cut}}), {"'" + cut + "' is cut short"});
    expect(said({DIRECT, GLASS}, {{a, cut}, {text, small}}), {"2 of 4 images cannot be used: '" + cut + "' is cut short", "; '" + text
                                                              + "' is not an image"});
}

TEST_CASE("A grey image has no channels", "[image check]")
{
    const Files f;
    const std::string grey = f.image("grey.png", WIDE), colour = f.image("colour.png", WIDE, CV_8UC3);
    CHECK(said({DIRECT}, {{colour}}, GREEN).empty());
    CHECK(said({DIRECT}, {{colour, grey}}).empty());
    expect(said({DIRECT}, {{colour, grey}}, GREEN), {"--channel=green: '" + grey + "' is a grey image", "leave --channel out"});
    const cv::Mat pixels = cv::imread(grey, cv::IMREAD_COLOR);          // the one grey three times
    cv::imwrite(f.folder / "repeated.png", pixels);
    expect(said({DIRECT}, {{f.folder / "repeated.png"}}, RED), {"is a grey image"});
}

TEST_CASE("EXIF data that ask for a turned picture change no size", "[image check]")
{
    using namespace std::string_literals;
    const Files f;
    const std::string plain = f.image("plain.jpg", WIDE), turned = f.folder / "turned.jpg";
    std::ifstream in(plain, std::ios::binary);
    std::string bytes{std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
    const std::string exif = "Exif\0\0II*\0\x08\0\0\0\x01\0\x12\x01\x03\0\x01\0\0\0\x06\0\0\0\0\0\0\0"s;     // orientation 6
    bytes.insert(2, "\xff\xe1\0"s + (char)(exif.size() + 2) + exif);
    std::ofstream(turned, std::ios::binary) << bytes;
    REQUIRE(cv::imread(turned).size() == TALL);                 // so do others
    CHECK(checkImages({DIRECT}, {{plain, turned}}, BRIGHTNESS, true) == std::vector<cv::Size>{WIDE});
    expect(takeRotationNotice(), {"'" + turned + "' asks for a turned picture", "as they are stored"});
}
