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

double stereoCalibrateGlass(InputArrayOfArrays, InputArrayOfArrays, InputArrayOfArrays, InputArrayOfArrays,
                            InputArrayOfArrays, const Ptr<RefractiveCamera>&, const Ptr<RefractiveCamera>&, InputOutputArray,
                            InputOutputArray, OutputArrayOfArrays, OutputArrayOfArrays, OutputArray, OutputArray, OutputArray,
                            int, TermCriteria)
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

double calibrateGlassRig(InputArrayOfArrays, const std::vector<std::vector<Mat> >&, const std::vector<std::vector<Mat> >&,
                         const std::vector<Ptr<RefractiveCamera> >&, const std::vector<int>&, InputOutputArrayOfArrays,
                         InputOutputArrayOfArrays, InputOutputArrayOfArrays, InputOutputArrayOfArrays, OutputArray, OutputArray,
                         OutputArray, OutputArray, OutputArrayOfArrays, OutputArray, int, InputArrayOfArrays, TermCriteria,
                         InputArrayOfArrays, const std::vector<std::vector<Mat> >&, const std::vector<std::vector<Mat> >&)
{
    throwWithoutCeres("calibrateGlassRig");
}

double calibrateGlassRig(InputArrayOfArrays, const std::vector<std::vector<Mat> >&, const std::vector<std::vector<Mat> >&,
                         const std::vector<Ptr<RefractiveCamera> >&, const std::vector<int>&, InputOutputArrayOfArrays,
                         InputOutputArrayOfArrays, InputOutputArrayOfArrays, InputOutputArrayOfArrays, OutputArray, OutputArray,
                         OutputArray, OutputArray, OutputArrayOfArrays, OutputArray, InputArray, OutputArray, int, InputArrayOfArrays,
                         TermCriteria, InputArrayOfArrays, const std::vector<std::vector<Mat> >&,
                         const std::vector<std::vector<Mat> >&)
{
    throwWithoutCeres("calibrateGlassRig");
}

double calibrateGlassRig(InputArrayOfArrays, const std::vector<std::vector<Mat> >&, const std::vector<std::vector<Mat> >&,
                         const std::vector<Ptr<RefractiveCamera> >&, const std::vector<int>&, InputOutputArrayOfArrays,
                         InputOutputArrayOfArrays, OutputArrayOfArrays, OutputArrayOfArrays, int, TermCriteria)
{
    throwWithoutCeres("calibrateGlassRig");
}

FitStatistics fitGlassRig(InputArrayOfArrays, const std::vector<std::vector<Mat> >&, const std::vector<std::vector<Mat> >&,
                          const std::vector<Ptr<RefractiveCamera> >&, const std::vector<int>&, InputOutputArrayOfArrays,
                          InputOutputArrayOfArrays, InputOutputArrayOfArrays, InputOutputArrayOfArrays, OutputArray, OutputArray,
                          OutputArray, OutputArray, OutputArrayOfArrays, OutputArray, InputArray, OutputArray, int, InputArrayOfArrays,
                          TermCriteria, InputArrayOfArrays, const std::vector<std::vector<Mat> >&, const std::vector<std::vector<Mat> >&)
{
    throwWithoutCeres("calibrateGlassRig");
}

double refractiveBundleAdjust(const std::vector<std::vector<Mat> >&, const std::vector<Ptr<RefractiveCamera> >&,
                              const std::vector<int>&, InputOutputArrayOfArrays, InputOutputArrayOfArrays,
                              InputOutputArrayOfArrays, InputOutputArrayOfArrays, InputOutputArray, InputArray, OutputArray,
                              OutputArray, OutputArray, OutputArray, OutputArrayOfArrays, int, InputArrayOfArrays, TermCriteria,
                              InputArrayOfArrays, const std::vector<std::vector<Mat> >&, InputArray, double)
{
    throwWithoutCeres("refractiveBundleAdjust");
}

double refractiveBundleAdjust(InputArray, InputArray, const std::vector<Ptr<RefractiveCamera> >&, const std::vector<int>&,
                              InputOutputArrayOfArrays, InputOutputArrayOfArrays, InputOutputArrayOfArrays,
                              InputOutputArrayOfArrays, InputOutputArray, InputArray, OutputArray, OutputArray,
                              OutputArrayOfArrays, OutputArray, OutputArray, OutputArray, int, InputArrayOfArrays, TermCriteria,
                              InputArrayOfArrays, InputArray, InputArray, double, double)
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
