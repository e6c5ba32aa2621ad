// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#ifndef OPENCV_REFRACT_AIR_HPP
#define OPENCV_REFRACT_AIR_HPP

namespace cv { namespace refract {

/** Index of air relative to vacuum, with 450 ppm of CO2: @cite Ciddor1996, whose stated
accuracy is 2 to 5e-8.
@param um wavelength in vacuum, micrometres
@param celsius temperature
@param pascal pressure
@param humidity relative, 0 to 100 % */
double indexOfAir(double um, double celsius, double pascal, double humidity);

}} // namespace

#endif // OPENCV_REFRACT_AIR_HPP
