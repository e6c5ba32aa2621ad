// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#ifndef OPENCV_REFRACT_MATERIALS_HPP
#define OPENCV_REFRACT_MATERIALS_HPP

#include "opencv2/core.hpp"
#include <vector>

namespace cv { namespace refract {

//! A number that may stand after a material's name, as T=12.
struct MaterialParameter
{
    const char* key;
    double usual, least, most;
};

//! Refractive index by wavelength, relative to air as refractiveIndex states.
struct Material
{
    const char* name;
    const char* otherName;              //!< null: none
    double shortest, longest;           //!< nm, where the formula holds
    double tolerance;                   //!< as refractiveIndexTolerance states
    std::vector<MaterialParameter> parameters;
    double (*index)(double um, const std::vector<double>& values);      //!< values of the parameters, in their order
};

const std::vector<Material>& materials();

}} // namespace

#endif // OPENCV_REFRACT_MATERIALS_HPP
