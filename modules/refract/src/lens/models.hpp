// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#ifndef OPENCV_REFRACT_MODELS_HPP
#define OPENCV_REFRACT_MODELS_HPP

#include "lens/lens.hpp"

/* All lens models, by name. Calls, files, the tests and the fuzzers make their lenses from this table.

How to add one: in a lens_NAME.cpp of its own derive from PlaneLens (or from KernelLens, if it has a vector form), state the
formula and its domain at the top, and define its maker; give it a row here; and add it to allLenses() of test/scenes.hpp,
whose lenses all tests of cameras and of lenses go through. */

namespace cv { namespace refract {

//! What a lens is made of. Its maker finds finite numbers, focal lengths above 0, and as many coefficients as its row allows.
struct LensSpec
{
    String model;                           //!< the whole name
    Matx33d cameraMatrix;
    std::vector<double> distCoeffs;
    String argument = "distCoeffs";         //!< what the caller calls the array of the coefficients,
    size_t before = 0;                      //!< and how many numbers precede them in it
    std::vector<double> inName = {};        //!< the values in the name, in the order of the row's keys

    //! fx, fy, cx, cy and the coefficients.
    std::vector<double> parameters() const;
    // Each throws with the argument's name and value.
    void requireCount(const std::vector<size_t>& allowed) const;
    void requireNoSkew() const;
};

typedef Ptr<Lens> LensMaker(const LensSpec& spec);

/* A row: name, keys of the values that it goes on with (_key=value each), maker, allowed numbers of coefficients; none: the
maker checks their number, which depends on the values. LENSMODEL_ are mrcal's names; one maker under two names is one model. */
#define REFRACT_LENS_MODELS(EACH) \
    EACH("opencv", "", makeOpenCVLens, 0, 4, 5, 8, 12, 14) \
    EACH("fisheye", "", makeFisheyeLens, 0, 4) \
    EACH("LENSMODEL_PINHOLE", "", makeOpenCVLens, 0) \
    EACH("LENSMODEL_OPENCV4", "", makeOpenCVLens, 4) \
    EACH("LENSMODEL_OPENCV5", "", makeOpenCVLens, 5) \
    EACH("LENSMODEL_OPENCV8", "", makeOpenCVLens, 8) \
    EACH("LENSMODEL_OPENCV12", "", makeOpenCVLens, 12) \
    EACH("LENSMODEL_STEREOGRAPHIC", "", makeStereographicLens, 0) \
    EACH("LENSMODEL_LONLAT", "", makeLonLatLens, 0) \
    EACH("LENSMODEL_LATLON", "", makeLatLonLens, 0) \
    EACH("LENSMODEL_CAHVOR", "", makeCahvorLens, 5) \
    EACH("LENSMODEL_CAHVORE", "linearity", makeCahvorLens, 8) \
    EACH("LENSMODEL_SPLINED_STEREOGRAPHIC", "order Nx Ny fov_x_deg", makeSplinedLens, )

#define REFRACT_DECLARE_MAKER(name, keys, maker, ...) LensMaker maker;
REFRACT_LENS_MODELS(REFRACT_DECLARE_MAKER)
#undef REFRACT_DECLARE_MAKER

//! A row of the table.
struct LensModel
{
    String name;
    std::vector<String> keys;
    LensMaker* make;
    std::vector<size_t> coefficients;

    bool isMrcal() const { return name.compare(0, 10, "LENSMODEL_") == 0; }
    String pattern() const;                         //!< the name with _key=... for each key
    bool isNameOf(const String& lensModel) const;   //!< as far as its first key
};

const std::vector<LensModel>& lensModels();

//! The lens that a caller or a file names. Throws with the argument's name and value.
Ptr<Lens> makeLens(const LensSpec& spec);
//! The same from fx, fy, cx, cy and the coefficients in one array, as mrcal has them.
Ptr<Lens> makeLens(const String& model, const std::vector<double>& intrinsics);
//! One of mrcal's, by its name there.
Ptr<Lens> makeMrcalLens(const String& model, const std::vector<double>& intrinsics);
//! What mrcal calls a lens of that many coefficients; empty if it has none like it.
String mrcalNameOf(const String& lensModel, size_t coefficients);

}} // namespace

#endif // OPENCV_REFRACT_MODELS_HPP
