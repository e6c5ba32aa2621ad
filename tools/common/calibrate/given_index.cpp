#include "calibrate/given_index.hpp"
#include "console/cli.hpp"
#include <opencv2/refract.hpp>
#include <cctype>
#include <cmath>

using namespace cv;
using namespace cv::refract;

namespace tools {

namespace {

const double BLUE = 450., RED = 650.;       // nm, between which most of what a sensor sees of white light is

bool isName(const std::string& text)
{
    double number;
    return !text.empty() && std::isalpha((unsigned char)text[0]) && !parseNumber(text, number);
}

bool isWhite(double wavelength)
{
    return wavelength >= BLUE && wavelength <= RED;
}

//! What is known is a name: the light may be of any colour, the piece of any batch.
double deviationOf(const std::string& name, double wavelength)
{
    const double kind = refractiveIndexTolerance(name);
    return isWhite(wavelength) ? std::hypot(kind, 0.5*(refractiveIndex(name, BLUE) - refractiveIndex(name, RED))) : kind;
}

GivenIndex named(const std::string& name, double wavelength, const std::string& option)
{
    try
    {
        return {refractiveIndex(name, wavelength), name, wavelength, deviationOf(name, wavelength)};
    }
    catch (const cv::Exception& e)
    {
        throw Failure(option + "=" + name + ": " + e.err);
    }
}

} // namespace

std::string GivenIndex::sentence() const
{
    return format("the index of %s at %g nm: %.5f", name.c_str(), wavelength, value);
}

std::string GivenIndex::light() const
{
    return name + (isWhite(wavelength) ? format(", light of %g to %g nm", BLUE, RED) : std::string());
}

GivenIndex readIndex(const std::string& text, double wavelength, const std::string& option)
{
    if (isName(text))
        return named(text, wavelength, option);
    const std::vector<double> numbers = parseNumbers(text, option);
    if (numbers.size() != 1)
        throw Failure(option + "=" + text + ": give one number, or the name of a material");
    return {numbers[0]};
}

std::vector<GivenIndex> readIndices(const std::string& text, double wavelength, const std::string& option)
{
    std::vector<GivenIndex> indices;
    for (const std::string& item : CLI::detail::split(text, ','))
    {
        if (item.find('=') != std::string::npos)
            throw Failure(option + "=" + text + ": '" + item + "': a layer's material stands without parameters");
        indices.push_back(readIndex(CLI::detail::trim_copy(item), wavelength, option));
    }
    return indices;
}

} // namespace tools
