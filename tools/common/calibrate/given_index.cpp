// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "calibrate/given_index.hpp"
#include "console/failure.hpp"
#include "console/numbers.hpp"
#include <opencv2/refract.hpp>
#include <cctype>
#include <cmath>

using namespace cv;
using namespace cv::refract;

namespace tools {

namespace {

bool isName(const std::string& text)
{
    double number;
    return !text.empty() && std::isalpha((unsigned char)text[0]) && !parseNumber(text, number);
}

//! What is known is a name: the light may be of any colour of the band, the piece of any batch.
double deviationOf(const std::string& name, const Light& light)
{
    return std::hypot(refractiveIndexTolerance(name), 0.5*(refractiveIndex(name, light.shortest) - refractiveIndex(name, light.longest)));
}

GivenIndex named(const std::string& name, const Light& light, const std::string& option)
{
    bool isKnown = false;
    try
    {
        refractiveIndexTolerance(name);
        isKnown = true;
        return {refractiveIndex(name, light.wavelength), name, name, light, deviationOf(name, light)};
    }
    catch (const cv::Exception& e)
    {
        if (isKnown)    // then it is the wavelength that is out of range
            throw Failure(format("--wavelength=%g: ", light.wavelength) + e.err + "; give nm, as 550");
        throw Failure(option + "=" + name + ": " + e.err);
    }
}

} // namespace

std::string GivenIndex::sentence() const
{
    return format("the index of %s at %g nm: %.5f", name.c_str(), of.wavelength, value);
}

std::string GivenIndex::light() const
{
    return name + (of.shortest < of.longest ? format(", light of %g to %g nm", of.shortest, of.longest) : std::string());
}

GivenIndex readIndex(const std::string& text, const Light& light, const std::string& option)
{
    if (isName(text))
        return named(text, light, option);
    const std::vector<double> numbers = parseNumbers(text, option);
    if (numbers.size() != 1)
        throw Failure(option + "=" + text + ": give one number, or the name of a material");
    return {numbers[0]};
}

std::vector<GivenIndex> readIndices(const std::string& text, const Light& light, const std::string& option)
{
    std::vector<GivenIndex> indices;
    for (const std::string& item : splitAtCommas(text))
    {
        if (item.find('=') != std::string::npos)
            throw Failure(option + "=" + text + ": '" + item + "': a layer's material stands without parameters");
        indices.push_back(readIndex(item, light, option));
    }
    return indices;
}

} // namespace tools
