// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "calibrate/light.hpp"
#include "calibrate/window_face.hpp"
#include "console/failure.hpp"
#include "console/numbers.hpp"

using namespace cv;
using namespace cv::refract;

namespace tools {

// Where the filters of usual colour sensors let most light through, and half the width of what they let through.
static const double USUAL[] = {465., 540., 610.}, HALF_BAND = 35.;

Light lightOf(Channel channel, double wavelength)
{
    if (channel != BRIGHTNESS)
    {
        const double middle = wavelength > 0 ? wavelength : USUAL[channel];
        return {middle, middle - HALF_BAND, middle + HALF_BAND};
    }
    Light light;
    if (wavelength > 0 && (wavelength < light.shortest || wavelength > light.longest))
        return {wavelength, wavelength, wavelength};
    light.wavelength = wavelength > 0 ? wavelength : light.wavelength;
    return light;
}

ChannelWavelengths parseChannels(const std::string& text)
{
    return channelsOf(parseNumbers(text, "--channels"), "--channels=" + text);
}

ChannelWavelengths channelsOf(const std::vector<double>& numbers, const std::string& name)
{
    if (numbers.size() != 3 || !(numbers[0] > numbers[1] && numbers[1] > numbers[2] && numbers[2] > 0))
        throw Failure(name + ": give the wavelengths of red, green and blue, nm, as 610,540,465");
    return {numbers[2], numbers[1], numbers[0]};
}

std::vector<Ptr<RefractiveCamera>> camerasInColours(const Ptr<RefractiveCamera>& camera, const ChannelWavelengths& wavelengths,
                                                    const std::string& of)
{
    const GlassWindow window = camera->window();
    if (refracts(window) && window.materials.empty())
        throw Failure("'" + of + "' does not name the window's materials, so its indices for other colours are not known: calibrate "
                      "with the names of the materials (refract_calib --index=N-BK7 --outer-index=water), or add them to "
                      "glass_window, from the camera outwards, as in materials: [ air, N-BK7, water ]");
    std::vector<Ptr<RefractiveCamera>> cameras;
    for (double wavelength : wavelengths)
    {
        cameras.push_back(camera->clone());
        try
        {
            cameras.back()->setWindow(window.atWavelength(wavelength));
        }
        catch (const cv::Exception& e)
        {
            throw Failure(format("%g nm, of the channels: ", wavelength) + e.err);
        }
    }
    return cameras;
}

std::string oneColourNotice(const RefractiveCamera& camera)
{
    const GlassWindow window = camera.window();
    if (!refracts(window) || window.materials.empty())
        return "";
    return format("in the light of the calibration, %g nm; --channels=610,540,465 corrects each colour by itself",
                  window.wavelength > 0 ? window.wavelength : Light().wavelength);
}

} // namespace tools
