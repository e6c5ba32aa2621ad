// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_LIGHT_SOURCE_HPP
#define REFRACT_TOOLS_LIGHT_SOURCE_HPP

#include "laser/emitter.hpp"
#include "simulate/surface.hpp"
#include <opencv2/core.hpp>

/* Lines and fringes on what cameras see. A point of the scene is projected into the emitter, through its window, and lit by what the
emitter sends at its u. What RIG.yml says of emitters, by name:

    emitters:
      laser: { ... as emitter.hpp ..., line: 320., width: 4., brightness: 90., color: [0., 1., 0.], speckle: 0.1, speckle_size: 0.8 }
      projector: { ..., brightness: 120., fringes: { periods: [640., 32.], steps: 4, phase: 0. } } */
namespace tools {

struct LightSource
{
    std::string name;
    Emitter emitter;
    cv::Vec3d color = cv::Vec3d(1, 1, 1);   //!< red, green, blue, 0 ... 1
    double brightness = 0.;         //!< levels that it adds to a white surface
    double width = 0.;              //!< of a line, pixels of the emitter, at half its height
    std::vector<double> periods;    //!< of fringes, pixels of the emitter; empty: a line
    int steps = 1;                  //!< images for each period
    double phase = 0.;
    double speckle = 0.;            //!< its contrast: standard deviation over mean
    double speckleSize = 0.8;       //!< pixels of the camera, standard deviation of a grain

    bool isLine() const { return periods.empty(); }
    //! How many images it takes.
    int pictures() const { return isLine() ? 1 : (int)periods.size()*steps; }
    /** 0 ... 1 at a u. Of fringes in picture k of N for a period p: (1 + cos(2 pi u/p + phase - 2 pi k/N))/2 */
    double at(double u, int picture) const;
    Viewpoint view(bool window) const;
};

//! Throws Failure that names the file and the key.
std::vector<LightSource> readLightSources(const cv::FileNode& emitters, const std::string& filename);

//! What lights an image.
struct Illumination
{
    std::vector<LightSource> sources;
    int picture = 0;            //!< of fringes
    bool window = true;         //!< the emitters look through theirs
    uint64_t seed = 1;          //!< of the speckle
};

/** Adds the light to levels, blue, green, red.
@param points camera 1's frame, CV_64FC3, of each level; NaN where nothing is
@param reflectance CV_32FC3, of blue, green, red
@param scene what throws shadows, or none */
void addLight(const Illumination& light, const cv::Mat& points, const cv::Mat& reflectance, const TexturedScene* scene, cv::Mat& levels);

//! Blur, noise and vignetting of a camera. Grey levels 0 ... 255.
struct Exposure
{
    double dark = 35., light = 205., background = 110.;
    double blur = 0.7;          //!< standard deviation of the lens's point spread, pixels, 0 ... 2
    double noise = 2.;          //!< standard deviation, grey levels
    double vignetting = 0.;     //!< loss of light in the image's corners, 0 ... 1
};

const int FINE = 2;         // samples per pixel, each way
const int PAD = 8;          // pixels rendered around the image, so that the blur has no border

//! Size of the image with its padding, in pixels.
inline cv::Size paddedSize(cv::Size image) { return image + cv::Size(2*PAD, 2*PAD); }

//! Pixel of the image in which a fine sample of the padded image lies.
inline cv::Point2d pixelOfSample(int x, int y)
{
    return cv::Point2d((x + 0.5)/FINE - 0.5 - PAD, (y + 0.5)/FINE - 0.5 - PAD);
}

/** The light that falls on the fine grid of the padded image -> the image: blur at the finer resolution, the mean over each
pixel, vignetting, noise, 8 bits.
@param levels grey levels or colours, float32; used up */
cv::Mat expose(cv::Mat& levels, const Exposure& exposure, uint64_t seed);

} // namespace tools

#endif // REFRACT_TOOLS_LIGHT_SOURCE_HPP
