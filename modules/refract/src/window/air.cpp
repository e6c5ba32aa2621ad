// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#include "precomp.hpp"
#include "window/air.hpp"

namespace cv { namespace refract {

// The letters and the numbers of equations are those of Ciddor's paper.

static const double CO2 = 450.;                                             // ppm, in which the paper's dry air is given
static const double MOLAR_AIR = 1e-3*(28.9635 + 12.011e-6*(CO2 - 400.));    // kg/mol
static const double MOLAR_WATER = 0.018015, GAS_CONSTANT = 8.314510;
static const double KELVIN = 273.15;

//! (1): refractivity of dry air at 15 C and 101325 Pa.
static double refractivityOfDryAir(double um)
{
    const double s2 = 1./(um*um);
    return 1e-8*(5792105./(238.0185 - s2) + 167917./(57.362 - s2));
}

//! (3): refractivity of water vapour at 20 C and 1333 Pa.
static double refractivityOfVapour(double um)
{
    const double s2 = 1./(um*um);
    return 1.022e-8*(295.235 + s2*(2.6422 + s2*(-0.032380 + s2*0.004028)));
}

//! Appendix A: molar fraction of water vapour.
static double molarFraction(double celsius, double pascal, double humidity)
{
    const double T = celsius + KELVIN;
    const double saturated = std::exp(T*(1.2378847e-5*T - 1.9121316e-2) + 33.93711047 - 6.3431645e3/T);
    const double enhancement = 1.00062 + 3.14e-8*pascal + 5.6e-7*celsius*celsius;
    return enhancement*humidity/100.*saturated/pascal;
}

//! (12): compressibility.
static double compressibility(double celsius, double pascal, double x)
{
    const double t = celsius, r = pascal/(t + KELVIN);
    return 1. - r*(1.58123e-6 + t*(-2.9331e-8 + t*1.1043e-10) + (5.707e-6 - 2.051e-8*t)*x + (1.9898e-4 - 2.376e-6*t)*x*x)
        + r*r*(1.83e-11 - 0.765e-8*x*x);
}

//! (4): density of the dry part, or of the vapour, kg/m^3; `x` is the whole's molar fraction of vapour.
static double density(double celsius, double pascal, double x, bool vapour)
{
    const double part = vapour ? MOLAR_WATER*x : MOLAR_AIR*(1. - x);
    return pascal*part/(compressibility(celsius, pascal, x)*GAS_CONSTANT*(celsius + KELVIN));
}

double indexOfAir(double um, double celsius, double pascal, double humidity)
{
    const double x = molarFraction(celsius, pascal, humidity);
    return 1. + density(celsius, pascal, x, false)/density(15., 101325., 0., false)*refractivityOfDryAir(um)
        + density(celsius, pascal, x, true)/density(20., 1333., 1., true)*refractivityOfVapour(um);
}

}} // namespace
