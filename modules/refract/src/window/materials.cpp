// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#include "precomp.hpp"
#include "window/materials.hpp"
#include "window/air.hpp"

namespace cv { namespace refract {

namespace {

using Values = std::vector<double>;

struct Resonance
{
    double strength, um2;               // square of its wavelength
};

//! Sellmeier's equation.
double sellmeier(double um, std::initializer_list<Resonance> resonances)
{
    const double l2 = um*um;
    double sum = 1.;
    for (const Resonance& r : resonances)
        sum += r.strength*l2/(l2 - r.um2);
    return std::sqrt(sum);
}

// @cite Schott_NBK7: nd 1.51680 +- 0.0005 as delivered (step 3), the formula within 5e-6 of the melt's.
double nBk7(double um, const Values&)
{
    return sellmeier(um, {{1.03961212, 0.00600069867}, {0.231792344, 0.0200179144}, {1.01046945, 103.560653}});
}

// @cite CDGM_HK9L, tolerance as above.
double hK9l(double um, const Values&)
{
    return sellmeier(um, {{0.614555251, 0.0145987884}, {0.656775017, 0.00287769588}, {1.02699346, 107.653051}});
}

// Least squares to the eight lines, 435.8 to 656.3 nm, of @cite Schott_B270, which has four digits: within 4e-5.
double b270(double um, const Values&)
{
    return sellmeier(um, {{1.27995, 0.010325}});
}

// @cite Rubin1985: clear window glass.
double sodaLime(double um, const Values&)
{
    return 1.5130 - 0.003169*um*um + 0.003962/(um*um);
}

// @cite Schott_BOROFLOAT33, as fitted in @cite Polyanskiy2024.
double borosilicate(double um, const Values&)
{
    return std::sqrt(0.3542 + std::pow(sellmeier(um, {{0.78657, 0.10856*0.10856}, {0.18285, 4.427*4.427}}), 2));
}

// @cite Malitson1965, 20 C.
double fusedSilica(double um, const Values&)
{
    return sellmeier(um, {{0.6961663, 0.0684043*0.0684043}, {0.4079426, 0.1162414*0.1162414},
                          {0.8974794, 9.896161*9.896161}});
}

// @cite MalitsonDodge1972, 20 C; the ordinary ray, which all light is in a window cut square to the crystal's axis, seen
// straight through.
double sapphire(double um, const Values&)
{
    return sellmeier(um, {{1.4313493, 0.0726631*0.0726631}, {0.65054713, 0.1193242*0.1193242},
                          {5.3414021, 18.028251*18.028251}});
}

// @cite Beadie2015.
double pmma(double um, const Values&)
{
    const double l2 = um*um, s2 = 1./l2;
    return std::sqrt(2.1778 + l2*(6.1209e-3 - l2*1.5004e-3)
                     + s2*(2.3678e-2 + s2*(-4.2137e-3 + s2*(7.3417e-4 - s2*4.5042e-5))));
}

// @cite Sultanova2009, 20 C,
// as fitted in @cite Polyanskiy2024.
double polycarbonate(double um, const Values&)
{
    return sellmeier(um, {{1.4182, 0.021304}});
}

// @cite QuanFry1995: relative to air,
// as the measurements selected by @cite AustinHalikas1976, which it reproduces within 1.5e-5 on average.
double quanFry(double um, double T, double S)
{
    const double nm = 1000.*um;
    return 1.31405 + (1.779e-4 + T*(-1.05e-6 + T*1.6e-8))*S - 2.02e-6*T*T
        + (15.868 + 0.01155*S - 0.00423*T)/nm - 4382./(nm*nm) + 1.1455e6/(nm*nm*nm);
}

double water(double um, const Values& v) { return quanFry(um, v[0], 0.); }

double seawater(double um, const Values& v) { return quanFry(um, v[0], v[1]); }

double air(double um, const Values& v)
{
    return indexOfAir(um, v[0], v[1], v[2])/indexOfAir(um, 20., 101325., 0.);
}

} // namespace

const std::vector<Material>& materials()
{
    static const MaterialParameter T = {"T", 20., 0., 30.}, S = {"S", 35., 0., 35.};
    static const std::vector<Material> all = {
        {"N-BK7", "BK7", 300, 2500, 0.0005, {}, nBk7},
        {"K9", "H-K9L", 365, 1711, 0.0005, {}, hK9l},
        {"B270", nullptr, 435, 657, 0.001, {}, b270},
        {"soda-lime", nullptr, 310, 4600, 0.005, {}, sodaLime},
        {"borosilicate", "Borofloat", 240, 1550, 0.003, {}, borosilicate},
        {"fused-silica", nullptr, 210, 3710, 0.00003, {}, fusedSilica},
        {"sapphire", nullptr, 200, 5000, 0.0002, {}, sapphire},
        {"PMMA", nullptr, 420, 1620, 0.002, {}, pmma},
        {"polycarbonate", nullptr, 437, 1052, 0.003, {}, polycarbonate},
        {"water", nullptr, 400, 700, 0.0005, {T}, water},
        {"seawater", nullptr, 400, 700, 0.0009, {T, S}, seawater},
        {"air", nullptr, 300, 1690, 0.00002,
         {{"T", 20., -40., 100.}, {"P", 101325., 10000., 140000.}, {"RH", 0., 0., 100.}}, air}};
    return all;
}

}} // namespace
