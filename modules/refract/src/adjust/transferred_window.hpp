// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#ifndef OPENCV_REFRACT_TRANSFERRED_WINDOW_HPP
#define OPENCV_REFRACT_TRANSFERRED_WINDOW_HPP

#include "adjust/window_transfer.hpp"
#include "window/layout.hpp"

namespace cv { namespace refract {

/** A window that is described in the frame of its owner, as another camera sees it, with derivatives. Between parallel faces only
the normal and the distance depend on the frame; with a wedge the thickness (along the normal through the centre of projection) and
the wedge's axes do, too; where faces are bent the normal leads to the spheres' centre. Of a dome it is the center, of a tube the
center and the axis. */
struct TransferredWindow
{
    //! @param ofOwner the window's parameters in the order of the layout
    TransferredWindow(const WindowLayout& at, const double* ofOwner, const TransformWithDerivatives& owner,
                 const TransformWithDerivatives& camera);

    std::vector<double> parameters;         //!< in the frame of the camera; what is impossible is not refused here
    Eigen::MatrixXd byWindow;               //!< by the owner's parameters
    Eigen::Matrix<double, Eigen::Dynamic, 6> byOwner, byCamera;     //!< by rvec and T of the two

    //! Gives a parameter a value on which nothing depends.
    void hold(int parameter, double value);

private:
    void transferFaces(const WindowLayout& at, const double* ofOwner, const TransformWithDerivatives& owner,
                       const TransformWithDerivatives& camera);
    void transferCenter(const WindowLayout& at, const double* ofOwner, const TransformWithDerivatives& owner,
                        const TransformWithDerivatives& camera);
    //! These parameters, and their derivatives by all.
    void differentiate(const WindowLayout& at, const double* ofOwner, const TransformWithDerivatives& owner,
                       const TransformWithDerivatives& camera, const std::vector<int>& rows);
};

}} // namespace

#endif // OPENCV_REFRACT_TRANSFERRED_WINDOW_HPP
