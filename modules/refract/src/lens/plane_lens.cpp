// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#include "lens/plane_lens.hpp"

namespace cv { namespace refract {

PlaneLens::PlaneLens(const LensSpec& spec) : PlaneLens(spec.model, spec.parameters()) { spec.requireNoSkew(); }

PlaneLens::PlaneLens(const String& model, const std::vector<double>& p)
    : model_(model), fx_(p[0]), fy_(p[1]), cx_(p[2]), cy_(p[3]), coefficients_(p.begin() + 4, p.end()) {}

void PlaneLens::project(int n, const double* x, const double* y, const double* z, double* u, double* v, uchar* status) const
{
    for (int i = 0; i < n; i++)
        if (status[i] == REFRACT_OK)
            status[i] = projectOne(Vec3d(x[i], y[i], z[i]), u[i], v[i]);
}

uchar PlaneLens::projectOne(const Vec3d& direction, double& u, double& v) const
{
    Vec2d plane;
    const uchar status = bend(direction, plane, NULL, NULL);
    u = fx_*plane[0] + cx_;
    v = fy_*plane[1] + cy_;
    return status;
}

void PlaneLens::unproject(int n, const double* u, const double* v, double* x, double* y, double* z, uchar* status) const
{
    for (int i = 0; i < n; i++)
    {
        Vec3d direction;
        if (status[i] != REFRACT_OK)
            continue;
        status[i] = unbend(Vec2d((u[i] - cx_)/fx_, (v[i] - cy_)/fy_), direction);
        x[i] = direction[0];
        y[i] = direction[1];
        z[i] = direction[2];
    }
}

void PlaneLens::projectJacobian(int n, const double* x, const double* y, const double* z, double* u, double* v,
                                const Columns& byDirection, const Columns& byParameters, uchar* status) const
{
    const int count = (int)coefficients_.size();
    AutoBuffer<Vec2d> byCoefficients(count + 1);
    for (int i = 0; i < n; i++)
    {
        Vec2d plane;
        Matx23d J;
        if (status[i] != REFRACT_OK)
            continue;
        status[i] = bend(Vec3d(x[i], y[i], z[i]), plane, &J, byCoefficients.data());
        u[i] = fx_*plane[0] + cx_;
        v[i] = fy_*plane[1] + cy_;
        for (int row = 0; row < 2; row++)
        {
            const double f = row == 0 ? fx_ : fy_;
            for (int c = 0; c < 3; c++)
                byDirection.at(row, c)[i] = f*J(row, c);
            for (int c = 0; c < 4 && byParameters.data; c++)
                byParameters.at(row, c)[i] = c%2 != row ? 0 : c < 2 ? plane[row] : 1;
            for (int c = 0; c < count && byParameters.data; c++)
                byParameters.at(row, 4 + c)[i] = f*byCoefficients[c][row];
        }
    }
}

Mat PlaneLens::columnOf(const std::vector<double>& values)
{
    return values.empty() ? Mat() : Mat((int)values.size(), 1, CV_64F, (void*)values.data()).clone();
}

std::vector<double> PlaneLens::parameters() const
{
    std::vector<double> p = { fx_, fy_, cx_, cy_ };
    p.insert(p.end(), coefficients_.begin(), coefficients_.end());
    return p;
}

std::vector<String> PlaneLens::parameterNames() const
{
    std::vector<String> names = { "fx", "fy", "cx", "cy" };
    const std::vector<String> ofModel = coefficientNames();
    names.insert(names.end(), ofModel.begin(), ofModel.end());
    return names;
}

}} // namespace
