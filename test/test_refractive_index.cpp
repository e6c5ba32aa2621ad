// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

// Indices by name, against published values that are not those the formulas were fitted to (or that are the maker's promise).
#include "scenes.hpp"

using namespace cv;
using namespace cv::refract;
using Catch::Matchers::Contains;

namespace {

// Spectral lines, nm.
const double G = 435.8343, F_BLUE = 479.9914, F = 486.1327, E = 546.0740, D = 587.5618, SODIUM = 589.2938, C_RED = 643.8469,
    C = 656.2725;

const char* const NAMES[] = {"N-BK7", "K9", "B270", "soda-lime", "borosilicate", "fused-silica", "sapphire", "PMMA",
                             "polycarbonate", "water", "seawater", "air"};

struct Published
{
    const char* material;
    double nm, index, accuracy;
};

double abbe(const char* material)
{
    return (refractiveIndex(material, D) - 1.)/(refractiveIndex(material, F) - refractiveIndex(material, C));
}

// Ciddor's index of the air that all others are relative to, at 633 nm: NIST, Engineering Metrology Toolbox.
const double AIR_633 = 1.000271800;

// Index of water at 20 C relative to vacuum: M. Daimon, A. Masumura, Applied Optics 46, 3811 (2007), stated accuracy 1e-5.
double daimonMasumura(double um)
{
    const double terms[][2] = {{5.684027565e-1, 5.101829712e-3}, {1.726177391e-1, 1.821153936e-2},
                               {2.086189578e-2, 2.620722293e-2}, {1.130748688e-1, 1.069792721e1}};
    double sum = 1.;
    for (const auto& term : terms)
        sum += term[0]*um*um/(um*um - term[1]);
    return std::sqrt(sum);
}

} // namespace

TEST_CASE("Indices of glasses and plastics are those of data sheets and handbooks", "[refractive_index]")
{
    const Published values[] = {
        // Schott, data sheet N-BK7: five digits
        {"N-BK7", G, 1.52668, 1e-5}, {"N-BK7", F, 1.52238, 1e-5}, {"N-BK7", E, 1.51872, 1e-5}, {"N-BK7", D, 1.51680, 1e-5},
        {"N-BK7", C, 1.51432, 1e-5},
        // CDGM, catalogue H-K9L
        {"K9", D, 1.516797, 1e-5},
        // Corning, data sheet HPFS 7980: another maker's than those of Malitson's specimens, which differed by 3e-5
        {"fused-silica", F, 1.46313, 3e-5}, {"fused-silica", D, 1.45846, 3e-5}, {"fused-silica", C, 1.45637, 3e-5},
        // I. H. Malitson, J. Opt. Soc. Am. 52, 1377 (1962): other specimens, 24 C
        {"sapphire", G, 1.78120, 2e-4}, {"sapphire", E, 1.77078, 2e-4}, {"sapphire", C_RED, 1.76547, 2e-4},
        {"sapphire", SODIUM, 1.7682, 2e-4},
        // Schott, BOROFLOAT 33, the data sheet before that which the formula is fitted to
        {"borosilicate", G, 1.48015, 2e-4}, {"borosilicate", F_BLUE, 1.47676, 2e-4}, {"borosilicate", E, 1.47311, 2e-4},
        {"borosilicate", SODIUM, 1.47133, 2e-4}, {"borosilicate", C_RED, 1.46953, 2e-4}, {"borosilicate", C, 1.46916, 2e-4},
        // Schott, data sheet B 270 i
        {"B270", D, 1.5229, 1e-3}, {"B270", E, 1.5251, 1e-3},
        // Float glass; B 270, another soda-lime glass
        {"soda-lime", SODIUM, 1.520, 0.005}, {"soda-lime", D, 1.5229, 0.005},
        // Handbook of Plastic Optics (U. S. Precision Lens, 1983): other kinds than those of the formulas
        {"PMMA", F, 1.497760, 0.002}, {"PMMA", D, 1.491756, 0.002}, {"PMMA", C, 1.489201, 0.002},
        {"polycarbonate", F, 1.599439, 0.003}, {"polycarbonate", D, 1.585470, 0.003}, {"polycarbonate", C, 1.579864, 0.003}};
    for (const Published& value : values)
    {
        INFO(value.material << " at " << value.nm << " nm");
        CHECK(std::abs(refractiveIndex(value.material, value.nm) - value.index) <= value.accuracy);
        CHECK(value.accuracy <= std::max(2e-4, refractiveIndexTolerance(value.material)));
    }
}

TEST_CASE("Abbe numbers are those of data sheets", "[refractive_index]")
{
    CHECK(abbe("N-BK7") == Approx(64.17).margin(0.005));
    CHECK(abbe("K9") == Approx(64.21).margin(0.02));
    CHECK(abbe("fused-silica") == Approx(67.8).margin(0.1));
    CHECK(abbe("sapphire") == Approx(72.2).margin(0.2));
    CHECK(abbe("borosilicate") == Approx(65.4).margin(0.7));
    CHECK(abbe("B270") == Approx(58.6).margin(0.6));
    CHECK(abbe("PMMA") == Approx(57.8).margin(2.));
    CHECK(abbe("polycarbonate") == Approx(29.9).margin(2.5));
    CHECK(abbe("water") == Approx(55.7).margin(0.3));
}

TEST_CASE("Water's index is relative to air", "[refractive_index]")
{
    // Measured relative to vacuum by others: divided by the air's index it must be Quan and Fry's, itself it is 3.6e-4 off.
    for (double nm : {404.7, 435.8, 486.1, 546.1, 589.3, 633., 656.3})
    {
        INFO(nm << " nm");
        CHECK(refractiveIndex("water", nm)*AIR_633 == Approx(daimonMasumura(nm/1000.)).margin(3e-5));
        CHECK(std::abs(refractiveIndex("water", nm) - daimonMasumura(nm/1000.)) > 3e-4);
    }
    // CRC Handbook of Chemistry and Physics: water relative to air at 589.3 nm, 0 to 30 C.
    const double handbook[] = {1.33395, 1.33369, 1.33299, 1.33192};
    for (int i = 0; i < 4; i++)
        CHECK(refractiveIndex(format("water:T=%d", 10*i), SODIUM) == Approx(handbook[i]).margin(3e-5));
}

TEST_CASE("Seawater has the index of the tables", "[refractive_index]")
{
    // The ends of Austin and Halikas' tables, as in C. D. Mobley, The optical properties of water (1995).
    struct Row { double T, S, nm, index; };
    const Row rows[] = {{0, 0, 400, 1.344186}, {0, 0, 700, 1.331084}, {30, 0, 400, 1.342081}, {30, 0, 700, 1.329128},
                        {0, 35, 400, 1.351415}, {0, 35, 700, 1.337906}, {30, 35, 400, 1.348752}, {30, 35, 700, 1.335316},
                        {20, 35, 589.3, 1.33940}};
    for (const Row& row : rows)
    {
        const std::string name = format("seawater:T=%g,S=%g", row.T, row.S);
        INFO(name << " at " << row.nm << " nm");
        CHECK(refractiveIndex(name, row.nm) == Approx(row.index).margin(6e-5));
    }
    CHECK(refractiveIndex("seawater") == refractiveIndex("seawater:S=35,T=20", 550.));
    CHECK(refractiveIndex("seawater:S=0") == refractiveIndex("water"));
}

TEST_CASE("Air is that of Ciddor's tables, and 1 where indices are relative to it", "[refractive_index]")
{
    for (double nm : {300., 450., 550., 1690.})
        CHECK(refractiveIndex("air", nm) == 1.);
    // P. E. Ciddor, Applied Optics 35, 1566 (1996), tables 1 and 3; NIST, Engineering Metrology Toolbox. 633 nm, 450 ppm of CO2.
    struct Row { double T, P, RH, index, accuracy; };
    const Row rows[] = {{20, 80000, 0, 1.000214580, 3e-8}, {20, 100000, 0, 1.000268244, 3e-8}, {20, 120000, 0, 1.000321916, 3e-8},
                        {10, 100000, 0, 1.000277747, 3e-8}, {30, 100000, 0, 1.000259372, 3e-8},
                        {20, 80000, 75, 1.000213940, 5e-8}, {40, 120000, 75, 1.000299418, 5e-8}, {50, 80000, 100, 1.000190584, 5e-8},
                        {20, 60000, 0, 1.000160924, 3e-8}, {50, 100000, 0, 1.000243285, 3e-8}, {-40, 100000, 0, 1.000337580, 3e-8},
                        {20, 100000, 100, 1.000267394, 5e-8}};
    for (const Row& row : rows)
    {
        const std::string name = format("air:T=%g,P=%g,RH=%g", row.T, row.P, row.RH);
        INFO(name);
        CHECK(std::abs(refractiveIndex(name, 633.)*AIR_633 - row.index) < row.accuracy);
    }
    // The same at the ends of the spectrum: at 20 C and 101325 Pa 1.000286581 (300 nm) and 1.000268479 (1700 nm).
    CHECK(refractiveIndex("air:T=-40,P=120000", 300.)*1.000286581 == Approx(1.000427233).margin(3e-8));
}

TEST_CASE("Indices fall from blue to red, all over the visible", "[refractive_index]")
{
    for (const char* name : NAMES)
    {
        if (std::string(name) == "air")         // 1, by definition
            continue;
        INFO(name);
        double last = scenes::INF;
        for (double nm = 440.; nm <= 655.; nm += 5.)
        {
            const double n = refractiveIndex(name, nm);
            CHECK(n < last);
            CHECK((n > 1.3 && n < 1.8));
            last = n;
        }
        CHECK(refractiveIndex(name) == refractiveIndex(name, 550.));
        CHECK((refractiveIndexTolerance(name) > 0. && refractiveIndexTolerance(name) < 0.01));
    }
}

TEST_CASE("Names are taken in any case, and other names", "[refractive_index]")
{
    CHECK(refractiveIndex("n-bk7") == refractiveIndex("N-BK7"));
    CHECK(refractiveIndex("BK7") == refractiveIndex("N-BK7"));
    CHECK(refractiveIndex("h-k9l") == refractiveIndex("K9"));
    CHECK(refractiveIndex("BOROFLOAT") == refractiveIndex("borosilicate"));
    CHECK(refractiveIndex("SeaWater:t=12,s=30") == refractiveIndex("seawater:T=12,S=30"));
}

TEST_CASE("What is unknown or out of range is refused with name, value and range", "[refractive_index]")
{
    struct Wrong { const char* material; double nm; const char* says; };
    const Wrong wrongs[] = {
        {"N-BK8", 550, "nearest is 'N-BK7'"}, {"polycarbonat", 550, "nearest is 'polycarbonate'"},
        {"poly", 550, "nearest is 'polycarbonate'"},
        {"diamond", 550, "those that are: N-BK7, K9, B270"}, {"plexi", 550, "PMMA, polycarbonate"}, {"", 550, "''"},
        {"glass", 550, "fused-silica, sapphire, PMMA"}, {"N-BK7:T=20", 550, "it has none"}, {"water:S=35", 550, "it has none but T"},
        {"seawater:T=31", 550, "T of seawater must be from 0 to 30"}, {"seawater:S=nan", 550, "'nan'"},
        {"seawater:T=12;S=35", 550, "'12;S=35' is not a number"}, {"seawater:", 550, "''"}, {"seawater:T=12,", 550, "''"},
        {"seawater:T", 550, "'T' is no KEY=VALUE"}, {"seawater:T=", 550, "'' is not a number"}, {"air:P=0", 550, "from 10000 to 140000"},
        {"N-BK7", 299, "the index of N-BK7 is known from 300 to 2500 nm; wavelengthNm is 299"}, {"water", 701, "from 400 to 700"},
        {"PMMA", 0.55, "wavelengthNm is 0.55"}, {"sapphire", scenes::NaN, "wavelengthNm is nan"}, {"sapphire", -550, "-550"},
        {"sapphire", scenes::INF, "inf"}};
    for (const Wrong& wrong : wrongs)
    {
        INFO(wrong.material);
        CHECK_THROWS_WITH(refractiveIndex(wrong.material, wrong.nm), Contains(wrong.says));
    }
    CHECK_THROWS_WITH(refractiveIndexTolerance("glas"), Contains("which is not known"));
}
