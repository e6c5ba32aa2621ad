// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_STARTING_MODEL_HPP
#define REFRACT_TOOLS_STARTING_MODEL_HPP

#include "calibrate/given_places.hpp"
#include "calibrate/rig_data.hpp"
#include "calibrate/rig_model.hpp"
#include <algorithm>

/* Initial values of a fit: the lens from a file or from the direct images, the windows as given, R and T from single views. */
namespace tools {

struct RigOptions
{
    cv::refract::GlassWindow window;                        //!< the known values, and the start of the others
    int flags = 0;                                          //!< GlassCalibrationFlags
    int lensCoefficients = 5;                               //!< of the lens that the images determine
    std::vector<cv::Mat> leftOut = {};                      //!< what they leave open of more, of each camera (LensChoice); may be empty
    std::vector<cv::Ptr<cv::refract::RefractiveCamera>> lensThroughWindow = {}; //!< of each camera, where it was chosen with its window
    std::vector<int> windows = {};                          //!< which window each camera looks through; empty: each has its own
    PerCamera<cv::Ptr<cv::refract::RefractiveCamera>> known;    //!< lens from a file; null: from the images
    PerCamera<cv::Mat> knownCovariance;                     //!< of its lens parameters; empty where the file has none
    GivenStd std;
    std::vector<GivenIndex> layers = {};                    //!< where the window's indices come from; empty: numbers
    GivenIndex inner = {}, outer = {};                      //!< the same of the media
    Channel channel = BRIGHTNESS;                           //!< of colour images, in which the points were found

    std::vector<GivenPlace> places = {};                    //!< that are known: of all cameras, or of each; empty: none
    std::string placeOption = {};                           //!< which said them

    //! Of a camera's lens, with those that are left open.
    int carriedCoefficients(int camera) const;
    //! The window of a camera, as far as it is known.
    cv::refract::GlassWindow windowOf(int camera) const;
    const GivenPlace& placeOf(int camera) const { return places[std::min((size_t)camera, places.size() - 1)]; }
    bool areMarkersGiven() const { return !places.empty() && places[0].tellsDistance(); }
    bool hasMaterials() const;                              //!< that are named
};

//! Where the lens of a camera came from.
struct LensSource
{
    enum Kind { FROM_FILE, FROM_DIRECT, FROM_GLASS } kind = FROM_FILE;
    int views = 0;
    double rms = 0.;            //!< cv::calibrateCamera's
};

//! A window's distance to start from, where nothing is known of it; away from its bound, 0. @param square of a board; 0: there is none
double startDistance(const RigData& data, double square);

//! Object -> camera of one image of a view; false if there is none.
bool solveView(const View& view, const cv::Ptr<cv::refract::RefractiveCamera>& camera, const std::vector<cv::Point2d>& pixels,
               RigidTransform& pose);

/** Initial values: lenses, the windows as given, and R, T from the view that fits the others best; with the priors.
@param found a fit: cameras and windows are at its places; null: there was none */
RigModel startModel(const RigData& data, const RigOptions& options, std::vector<LensSource>& lensSources, const RigModel* found = nullptr);

} // namespace tools

#endif // REFRACT_TOOLS_STARTING_MODEL_HPP
