// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "accept/scale_test.hpp"
#include <algorithm>
#include <cmath>

namespace tools {

namespace {

const double ROUNDING = 1e-4;           // of a certificate, and of a square as it was given
const double TELLING = 0.2;             // chance that any length would agree

//! Whether a whole number within the tolerance is a sum of two squares.
bool isSumOfSquares(double number, double tolerance)
{
    for (int n = std::max(1, (int)std::ceil(number - tolerance)); n <= number + tolerance; n++)
        for (int a = 0; 2*a*a <= n; a++)
        {
            const int b = (int)std::lround(std::sqrt((double)(n - a*a)));
            if (a*a + b*b == n)
                return true;
        }
    return false;
}

} // namespace

bool areOfBoard(const std::vector<CalibratedLength>& lengths, double square)
{
    int telling = 0;
    for (const CalibratedLength& length : lengths)
    {
        const double squares = length.length/square, tolerance = 2.*squares*(length.U/square + ROUNDING*squares);
        if (!(square > 0) || !(tolerance < TELLING))
            continue;
        telling++;
        if (!isSumOfSquares(squares*squares, tolerance))
            return false;
    }
    return telling > 0;
}

} // namespace tools
