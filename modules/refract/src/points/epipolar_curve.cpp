// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#include "points/epipolar_curve.hpp"

namespace cv { namespace refract {

int addSamples(const EpipolarCurve& curve, double tNear, double tFar, int samples, Projection& p)
{
    double t[Projection::CAPACITY];
    for (int i = 0; i < samples; i++)
        t[i] = tNear + (tFar - tNear)*i/(samples - 1);
    return p.add(curve, samples, t);
}

//! The end of visibility between a visible and an invisible t, from the visible side.
static double edgeOfVisibility(const EpipolarCurve& curve, const Camera& other, double visible, double invisible)
{
    const double enough = 1e-9*std::abs(visible - invisible);
    Projection p(other);
    while (std::abs(visible - invisible) > enough)
    {
        const double middle = 0.5*(visible + invisible);
        if (middle == visible || middle == invisible)       // no number lies between
            break;
        p.clear();
        p.add(curve, 1, &middle);
        p.run();
        (p.status(0) == REFRACT_OK ? visible : invisible) = middle;
    }
    return visible;
}

bool visiblePart(const EpipolarCurve& curve, const Projection& p, int begin, int samples, double& tNear, double& tFar)
{
    int first = begin, last = begin + samples - 1;
    while (first <= last && p.status(first) != REFRACT_OK)
        first++;
    if (first > last)
        return false;
    while (p.status(last) != REFRACT_OK)
        last--;
    tNear = first == begin ? p.t()[first] : edgeOfVisibility(curve, p.camera(), p.t()[first], p.t()[first - 1]);
    tFar = last == begin + samples - 1 ? p.t()[last] : edgeOfVisibility(curve, p.camera(), p.t()[last], p.t()[last + 1]);
    return true;
}

}} // namespace
