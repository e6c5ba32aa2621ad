// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#ifndef OPENCV_REFRACT_OUTLIERS_HPP
#define OPENCV_REFRACT_OUTLIERS_HPP

#include "adjust/problem.hpp"

namespace cv { namespace refract {

//! What leaving out observations means to a problem.
class Outliers
{
public:
    virtual ~Outliers() = default;
    //! Root of an observation's weight while outliers are not yet known, by its error over the scale of its image.
    virtual double rootWeight(double ratio) const = 0;
    //! Takes out images that are wrong as a whole. @param scale of a pixel coordinate
    virtual void leaveOutImages(double scale) { (void)scale; }
    /** Uses these observations, and none that the others leave without meaning, which it takes out of inliers.
    @return whether what is left determines what is free */
    virtual FitOutcome setInliers(Masks& inliers) = 0;
    /** Tries to bring back what setInliers took out; false if there is nothing.
    @param scale of a pixel coordinate
    @param returned per scene point: it came back before, and does not again; in and out, empty at first */
    virtual bool bringBack(Masks& inliers, double scale, std::vector<uchar>& returned)
    {
        (void)inliers; (void)scale; (void)returned;
        return false;
    }
    //! Which observations may have a say.
    virtual Masks candidates() const = 0;
};

//! Of known targets. Images whose target was not where the view's other images have it are wrong.
class TargetOutliers : public Outliers
{
public:
    explicit TargetOutliers(Problem& problem) : problem_(problem), status_(problem.images().size(), (uchar)GLASS_IMAGE_USED) {}
    double rootWeight(double ratio) const override;
    void leaveOutImages(double scale) override;
    FitOutcome setInliers(Masks& inliers) override;
    Masks candidates() const override;

    //! GlassImageStatus, in the order of Problem::images().
    const std::vector<uchar>& imageStatus() const { return status_; }

private:
    Problem& problem_;
    std::vector<uchar> status_;
};

//! What tells the scale of a scene: lengths, R and T of several cameras, poses of several views.
struct ScaleSources
{
    bool areLengthsKnown = false, isRigKnown = false, arePosesKnown = false;
    bool any() const { return areLengthsKnown || isRigKnown || arePosesKnown; }
};

//! Of a scene: points without enough inliers are not in use.
class SceneOutliers : public Outliers
{
public:
    SceneOutliers(Problem& problem, const ScaleSources& scale) : problem_(problem), scale_(scale) {}
    double rootWeight(double ratio) const override;
    FitOutcome setInliers(Masks& inliers) override;
    bool bringBack(Masks& inliers, double scale, std::vector<uchar>& returned) override;
    Masks candidates() const override;

    //! NO_SCALE or TOO_FEW_EQUATIONS where the observations in use do not determine what is free.
    FitOutcome checkWhatIsLeft() const;

private:
    bool tellsScale() const;
    bool bringBackWhatLengthsAllow(const std::vector<Point3d>& points, const Masks& before, double scale, Masks& inliers);
    Problem& problem_;
    const ScaleSources scale_;
};

}} // namespace

#endif // OPENCV_REFRACT_OUTLIERS_HPP
