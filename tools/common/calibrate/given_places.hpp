// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_GIVEN_PLACES_HPP
#define REFRACT_TOOLS_GIVEN_PLACES_HPP

#include "calibrate/given_std.hpp"
#include "calibrate/parameter_columns.hpp"

/* What is known from outside of where flat windows are: a normal, or markers on the window, which tell its distance, too. */
namespace tools {

class OptionParser;

//! A marker on a window's face towards the camera, in the camera's frame.
struct PaneMarker
{
    std::string id;
    cv::Vec3d at, std;                  //!< its own error along each axis, independent of the others'
};

struct GivenPlace
{
    cv::Vec3d normal;                   //!< of length 1
    double distance = -1.;              //!< below 0: nothing is known of it
    cv::Matx44d covariance = cv::Matx44d::zeros();      //!< of both together, by the markers; beside what GivenStd says

    bool tellsDistance() const { return distance >= 0.; }
    double normalStd() const;           //!< by the markers, of the worst turn, radians
    double distanceStd() const;         //!< the same
    //! The normal and the distance into a window.
    void putInto(cv::refract::GlassWindow& window) const;
    //! Beside what is in the covariance of a camera's or a rig's parameters. Where images do not show a distance it is left out.
    void addTo(const cv::refract::GlassWindow& window, const ParameterColumns& at, cv::Mat& covariance) const;
};

/** How many standard deviations a window is from where it was given, of the turns about two axes and the distance together.
@param known, ofFound covariances of normal and distance, of errors that have nothing in common */
double deviationsBetween(const cv::refract::GlassWindow& given, const cv::Matx44d& known, const cv::refract::GlassWindow& found,
                         const cv::Matx44d& ofFound);

/** The plane that fits markers best, and its covariance. Throws Failure where they are on no plane within five of their standard
deviations, nearly on one line, or not before the camera. @param path in its text */
GivenPlace placeOfMarkers(const std::vector<PaneMarker>& markers, const std::string& path);

/** id,x,y,z[,sx,sy,sz], as refract_measure writes them; those without coordinates are left out. Throws Failure.
@param std of each coordinate, where the table does not say it; 0: not given */
std::vector<PaneMarker> readPaneMarkers(const std::string& path, double std);

//! --normal, --pane-points, and how well they are known.
class GivenPlaces
{
public:
    void addTo(OptionParser& parser);
    bool isSaid() const { return !normals_.empty() || !points_.empty(); }
    bool areOfMarkers() const { return !points_.empty(); }
    const char* option() const { return areOfMarkers() ? "--pane-points" : "--normal"; }
    const std::vector<std::string>& files() const { return points_; }

    double normalStd() const { return normalStdDeg_*CV_PI/180.; }       //!< radians, about each of two axes
    /** Of each camera, in its frame; empty: not said. Of a window that cameras share the first of them counts. Throws Failure.
    @param windows which one each camera looks through; empty: each has its own */
    std::vector<GivenPlace> of(int cameras, const std::vector<int>& windows) const;

private:
    std::vector<GivenPlace> ofNormals(int cameras, const std::vector<int>& windows) const;
    std::vector<GivenPlace> ofMarkers(int cameras, const std::vector<int>& windows) const;

    std::vector<std::string> normals_, points_;
    double normalStdDeg_ = 0., pointStd_ = 0.;
};

} // namespace tools

#endif // REFRACT_TOOLS_GIVEN_PLACES_HPP
