// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#ifndef OPENCV_REFRACT_SCENE_HPP
#define OPENCV_REFRACT_SCENE_HPP

#include "arrays/views.hpp"
#include <Eigen/Core>

namespace cv { namespace refract {

//! A distance of two scene points that is known with a standard deviation.
struct KnownLength
{
    int a, b;
    double length, sigma;
};

/** Points that known lengths tie together, the two ends of a wand for example, or one point alone. They are eliminated
together. */
struct Cluster
{
    std::vector<int> points;            //!< indices into the scene
    std::vector<KnownLength> lengths;   //!< a and b count within the cluster
    Eigen::Map<Eigen::VectorXd> values; //!< x, y, z of each point, kept by the scene

    int size() const { return (int)values.size(); }
    /** Adds what its lengths give to normal equations by values; returns their squared residuals.
    @param pixelSigma to which a length's standard deviation is scaled */
    double addLengths(double pixelSigma, Eigen::MatrixXd& matrix, Eigen::VectorXd& gradient) const;
    double squaredLengthError(double pixelSigma) const;

private:
    double residual(const KnownLength& length, Eigen::RowVectorXd& byValues) const;
};

//! Points that are not known, and lengths between them. A point is in use or not.
class Scene
{
public:
    explicit Scene(int pointCount = 0, const std::vector<KnownLength>& lengths = std::vector<KnownLength>());
    Scene(const Scene&) = delete;
    Scene& operator=(const Scene&) = delete;

    int pointCount() const { return pointCount_; }
    //! @param points NaN: not in use
    void setPoints(const std::vector<Point3d>& points);
    std::vector<Point3d> points() const;    //!< NaN: not in use
    bool isUsed(int point) const { return clusterOf_[point] >= 0; }

    std::vector<Cluster>& clusters() { return clusters_; }
    const std::vector<Cluster>& clusters() const { return clusters_; }
    //! Of a point in use: its cluster, and where it stands there; -1: not in use.
    int clusterOf(int point) const { return clusterOf_[point]; }
    int placeInCluster(int point) const { return at_[point]; }
    int lengthCount() const;                //!< between points in use
    int coordinateCount() const;            //!< of points in use

private:
    const int pointCount_;
    const std::vector<KnownLength> lengths_;
    std::vector<double> values_;            //!< of all clusters, one after the other
    std::vector<Cluster> clusters_;
    std::vector<int> clusterOf_, at_;       //!< per point
};

}} // namespace

#endif // OPENCV_REFRACT_SCENE_HPP
