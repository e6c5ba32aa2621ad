// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_GIVEN_WINDOW_HPP
#define REFRACT_TOOLS_GIVEN_WINDOW_HPP

#include "calibrate/given_places.hpp"
#include "calibrate/given_std.hpp"
#include "calibrate/parameter_columns.hpp"
#include "calibrate/starting_model.hpp"
#include <map>

/* What a command line says of windows: their shape, their values, and what of them is free. */
namespace tools {

class OptionParser;

//! A window, and where its indices come from.
struct GivenWindow
{
    cv::refract::GlassWindow window;
    std::vector<GivenIndex> layers = {};
    GivenIndex inner = {}, outer = {};

    bool hasMaterials() const;          //!< that are named
};

//! --window, --radius, --thickness and their kin.
class GivenWindowOptions
{
public:
    //! @param distance what is said of --distance where it is needed and not given
    void addTo(OptionParser& parser, const std::string& distance);
    bool isSaid() const;                //!< any of them
    bool isDistanceSaid() const;
    const std::string& shape() const { return shape_; }     //!< as --window says it
    const std::string& index() const { return index_; }     //!< the same of --index

    /** The window as far as it is known; a bent one is still flat here. Throws Failure where options do not go together, and where
    there is no such material.
    @param flags GLASS_FREE_...
    @param channel of colour images, in whose light the named materials are seen */
    GivenWindow of(int flags, Channel channel) const;
    //! Throws Failure where --window=bent, and nothing bends the window.
    void requireBow(const GivenStd& std, int flags) const;

private:
    void requireOptionsOfShape() const;
    void takeIndices(Channel channel, GivenWindow& given) const;
    void requireMaterials(const cv::refract::GlassWindow& window) const;
    void takePlace(cv::refract::GlassWindow& window) const;

    const OptionParser* parser_ = nullptr;
    std::string shape_ = "flat", center_, axis_, thickness_, index_, innerIndex_ = "1", outerIndex_ = "1";
    double radius_ = 0., wavelength_ = 0., distance_ = 0.;
};

//! X,Y,Z in a camera's frame.
cv::Vec3d parseVector(const std::string& text, const char* option);

//! What --free may name of lenses and windows, wherever windows are, and its flags.
const std::map<std::string, int>& freeFlags();

//! Throws Failure where flags free what a window of this shape has not.
void requireFreeOfShape(const cv::refract::GlassWindow& window, int flags);

//! With the wedges and the bow that are to be estimated, which start at 0.
cv::refract::GlassWindow withEstimated(cv::refract::GlassWindow window, const GivenStd& std, int flags);

//! How well a window's values are given, into the covariance of a camera's or a rig's parameters; what is not known of its place stays 0.
void putVariances(const GivenStd& std, const ParameterColumns& at, cv::Mat& covariance);

//! What the options of refract_calib say of the windows of all cameras: what is known, how well, and what is to be found.
struct GivenRigOptions
{
    GivenWindowOptions window;
    GivenStdOptions std;
    GivenPlaces places;
    std::vector<std::string> free;          //!< names of freeFlags()
    std::string windowOfCamera;             //!< "1,1,2,2"; empty: each has its own
    bool sharedWindow = false;
    std::string unit = "mm";

    /** Throws Failure where options do not go together, or ask for what no image can tell.
    @param knowsPoses of the target. @param square of a board; 0: there is none */
    RigOptions of(int cameras, Channel channel, bool knowsPoses, double square) const;
    //! Of a liquid that was given as a layer, which stays where it is only between two others; empty: there is none.
    std::string noticeOfLiquid(const cv::refract::GlassWindow& given) const;

private:
    bool isDistanceKnown() const;
    std::vector<int> windowsOf(int cameras) const;
    void takePlaces(int cameras, RigOptions& rig) const;
    void takeStd(double square, RigOptions& rig) const;
};

} // namespace tools

#endif // REFRACT_TOOLS_GIVEN_WINDOW_HPP
