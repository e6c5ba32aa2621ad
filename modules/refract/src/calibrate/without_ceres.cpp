// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

/* What is compiled in place of the calibrators where there is no Ceres (cmake/ceres.cmake). */

#include "calibrate/refit.hpp"

#ifdef REFRACT_WITHOUT_CERES

namespace cv { namespace refract {

[[noreturn]] static void throwWithoutCeres(const char* call)
{
    CV_Error_(Error::StsNotImplemented, ("%s needs the library Ceres, which this build of the module is without: install Ceres "
                                         "2.1 or newer and Eigen, and build it again with -DREFRACT_WITH_CERES=ON", call));
}

double calibrateGlass(InputArrayOfArrays, InputArrayOfArrays, InputArrayOfArrays, InputArray, InputArray, GlassWindow&,
                      OutputArrayOfArrays, OutputArrayOfArrays, int, TermCriteria)
{
    throwWithoutCeres("calibrateGlass");
}

double calibrateGlass(InputArrayOfArrays, InputArrayOfArrays, InputArrayOfArrays, const Ptr<RefractiveCamera>&,
                      OutputArrayOfArrays, OutputArrayOfArrays, int, TermCriteria)
{
    throwWithoutCeres("calibrateGlass");
}

double calibrateGlass(InputArrayOfArrays, InputArrayOfArrays, InputArrayOfArrays, const Ptr<RefractiveCamera>&,
                      OutputArrayOfArrays, OutputArrayOfArrays, OutputArray, OutputArray, OutputArray, OutputArray, int,
                      TermCriteria)
{
    throwWithoutCeres("calibrateGlass");
}

double calibrateGlass(InputArrayOfArrays, InputArrayOfArrays, InputArrayOfArrays, InputArray, InputArray, GlassWindow&,
                      OutputArrayOfArrays, OutputArrayOfArrays, OutputArray, OutputArray, OutputArray, OutputArray, int,
                      TermCriteria)
{
    throwWithoutCeres("calibrateGlass");
}

GlassRigResult stereoCalibrateGlass(InputArrayOfArrays, InputArrayOfArrays, InputArrayOfArrays, InputArrayOfArrays,
                                    InputArrayOfArrays, const Ptr<RefractiveCamera>&, const Ptr<RefractiveCamera>&,
                                    InputOutputArray, InputOutputArray, OutputArrayOfArrays, OutputArrayOfArrays,
                                    const GlassRigOptions&)
{
    throwWithoutCeres("stereoCalibrateGlass");
}

int selectLensCoefficients(InputArrayOfArrays, const std::vector<std::vector<Mat> >&, const std::vector<std::vector<Mat> >&,
                           const std::vector<Ptr<RefractiveCamera> >&, const std::vector<int>&, InputArrayOfArrays,
                           InputArrayOfArrays, int, OutputArray)
{
    throwWithoutCeres("selectLensCoefficients");
}

int selectLensCoefficients(InputArrayOfArrays, const std::vector<std::vector<Mat> >&, const std::vector<std::vector<Mat> >&,
                           const std::vector<Ptr<RefractiveCamera> >&, const std::vector<int>&, InputArrayOfArrays,
                           InputArrayOfArrays, int, OutputArray, OutputArrayOfArrays)
{
    throwWithoutCeres("selectLensCoefficients");
}

GlassRigResult calibrateGlassRig(InputArrayOfArrays, const std::vector<std::vector<Mat> >&, const std::vector<std::vector<Mat> >&,
                                 const std::vector<Ptr<RefractiveCamera> >&, const std::vector<int>&, InputOutputArrayOfArrays,
                                 InputOutputArrayOfArrays, InputOutputArrayOfArrays, InputOutputArrayOfArrays, const GlassRigOptions&)
{
    throwWithoutCeres("calibrateGlassRig");
}

double calibrateGlassRig(InputArrayOfArrays, const std::vector<std::vector<Mat> >&, const std::vector<std::vector<Mat> >&,
                         const std::vector<Ptr<RefractiveCamera> >&, const std::vector<int>&, InputOutputArrayOfArrays,
                         InputOutputArrayOfArrays, OutputArrayOfArrays, OutputArrayOfArrays, int, TermCriteria)
{
    throwWithoutCeres("calibrateGlassRig");
}

GlassRigResult fitGlassRig(InputArrayOfArrays, const std::vector<std::vector<Mat> >&, const std::vector<std::vector<Mat> >&,
                           const std::vector<Ptr<RefractiveCamera> >&, const std::vector<int>&, InputOutputArrayOfArrays,
                           InputOutputArrayOfArrays, InputOutputArrayOfArrays, InputOutputArrayOfArrays, const GlassRigOptions&)
{
    throwWithoutCeres("calibrateGlassRig");
}

BundleAdjustResult refractiveBundleAdjust(const std::vector<std::vector<Mat> >&, const std::vector<Ptr<RefractiveCamera> >&,
                                          const std::vector<int>&, InputOutputArrayOfArrays, InputOutputArrayOfArrays,
                                          InputOutputArrayOfArrays, InputOutputArrayOfArrays, InputOutputArray, InputArray,
                                          const BundleAdjustOptions&)
{
    throwWithoutCeres("refractiveBundleAdjust");
}

BundleAdjustResult refractiveBundleAdjust(InputArray, InputArray, const std::vector<Ptr<RefractiveCamera> >&,
                                          const std::vector<int>&, InputOutputArrayOfArrays, InputOutputArrayOfArrays,
                                          InputOutputArrayOfArrays, InputOutputArrayOfArrays, InputOutputArray, InputArray,
                                          const BundleAdjustOptions&)
{
    throwWithoutCeres("refractiveBundleAdjust");
}

double refractiveBundleAdjust(InputArrayOfArrays, const std::vector<Ptr<RefractiveCamera> >&, const std::vector<int>&,
                              InputOutputArrayOfArrays, InputOutputArrayOfArrays, InputOutputArray, InputArray, int,
                              TermCriteria)
{
    throwWithoutCeres("refractiveBundleAdjust");
}

}} // namespace

#endif // REFRACT_WITHOUT_CERES
