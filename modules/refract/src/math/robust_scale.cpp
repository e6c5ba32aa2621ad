// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#include "math/robust_scale.hpp"
#include "math/quantile.hpp"

namespace cv { namespace refract {

double median(std::vector<double> values)
{
    return values.empty() ? 0 : quantile(std::move(values), 0.5);
}

double scaleOf(const std::vector<double>& errors)
{
    const double MEDIAN_OF_RAYLEIGH = 1.17741;
    return std::max(median(errors)/MEDIAN_OF_RAYLEIGH, LEAST_SCALE);
}

double truncationFactor(double cut)
{
    const double x = cut*cut/2;
    return 1 - x/(std::exp(x) - 1);
}

double truncatedScale(const std::vector<double>& errors, double scale, double cut)
{
    for (int i = 0; i < 50; i++)
    {
        double sum = 0;
        int count = 0;
        for (double r : errors)
            if (r < cut*scale)
            {
                sum += r*r;
                count++;
            }
        if (count == 0)
            return scale;
        const double next = std::max(std::sqrt(sum/(2*count*truncationFactor(cut))), LEAST_SCALE);
        if (std::abs(next - scale) < 1e-6*scale)
            return next;
        scale = next;
    }
    return scale;
}

}} // namespace
