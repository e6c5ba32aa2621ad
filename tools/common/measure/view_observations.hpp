// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_VIEW_OBSERVATIONS_HPP
#define REFRACT_TOOLS_VIEW_OBSERVATIONS_HPP

#include "calibrate/rig_data.hpp"
#include "calibrate/rig_model.hpp"
#include "measure/rig_vector.hpp"

namespace tools {

/** The observations of one new view, and the current estimate of what is unknown of it: the pose of a board, or all points of a
scene. */
struct ViewObservations
{
    std::vector<cv::Point3d> objectPoints;
    std::vector<ImageOfView> images;
    Eigen::VectorXd pixels;             //!< in the order of differentiateView
    cv::Vec3d rvec, tvec;               //!< board -> camera 1; of a scene 0
    bool isScene = false;               //!< the points are unknown, and the pose is none
    Eigen::VectorXd noise = {};         //!< of each coordinate over the usual one; empty: all are alike

    int unknowns() const { return isScene ? 3*(int)objectPoints.size() : 6; }
    //! Rows of coordinates over their noise.
    Eigen::MatrixXd weighed(const Eigen::MatrixXd& rows) const;
    //! Moves what is unknown.
    void move(const Eigen::VectorXd& step);
};

/** What no change of the unknowns of a view can produce, and which change comes nearest to a residual. Rows and residuals are
weighed. */
class UnknownsOfView
{
public:
    //! @param byPose of its derivatives, weighed
    UnknownsOfView(const ViewObservations& observed, const Eigen::MatrixXd& byPose);
    //! As many rows as there are coordinates more than unknowns.
    Eigen::MatrixXd projectedOut(const Eigen::MatrixXd& rows) const;
    Eigen::VectorXd solve(const Eigen::VectorXd& residual) const;

private:
    /** Coordinates that share unknowns: all of a board, those of one point of a scene. Q R = derivatives by these, by Householder. A scene
    has thousands of groups of four rows, so that all are in one place. */
    struct Group
    {
        size_t rows, normals, R;            //!< where its own begin
        int count;                          //!< of rows
    };
    void add(const std::vector<int>& rows, const Eigen::Ref<const Eigen::MatrixXd>& byUnknowns);
    //! x = Q^T of its rows of a column of all.
    void reflect(const Group& group, const double* column, Eigen::VectorXd& x) const;
    Eigen::VectorXd solveR(const Group& group, const Eigen::VectorXd& x) const;

    int unknowns_;                          //!< of a group
    std::vector<Group> groups_;
    std::vector<int> rows_;
    std::vector<double> normals_, R_;       //!< of the mirrors, of length 1 or 0; rows of R
    Eigen::Index left_ = 0;                 //!< rows, of all
};

//! The seen points of one image, after those that are there; an image without any is none.
void addImage(const View& view, int camera, bool glass, ViewObservations& observed);

/** Points of a scene that miss their pixels by more than that count no more in `observed`. @param at the same view where it was fitted
@param far px of a usual coordinate @return how many */
size_t giveUpFarOff(const RigModel& rig, const ViewObservations& at, double far, ViewObservations& observed);

//! The pose is that of one of the images. Throws Failure if none has one.
ViewObservations observationsOf(const RigModel& rig, const View& view);

//! Gauss-Newton on the pose. @return the derivatives there
ViewDerivatives refinePose(const RigModel& rig, ViewObservations& observed);

//! The noise of a pixel coordinate.
struct ImageNoise
{
    double sigma, dof;          //!< dof 0: nothing tells
};

/** What the images themselves tell of their noise, whatever the calibration is worth: each image has a pose of its own, and a
wrong lens, window or target leaves residuals that are smooth over the image, so that a cubic polynomial takes them away. */
ImageNoise imageNoise(const RigModel& rig, const std::vector<View>& views);

} // namespace tools

#endif // REFRACT_TOOLS_VIEW_OBSERVATIONS_HPP
