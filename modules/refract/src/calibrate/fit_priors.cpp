// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#include "calibrate/fit_priors.hpp"
#include "arrays/arrays.hpp"
#include "calibrate/fit_arguments.hpp"
#include "math/covariance_matrix.hpp"

namespace cv { namespace refract {

int countVectors(InputArrayOfArrays a, const char* name)
{
    if (a.empty())
        return 0;
    return a.isMatVector() || a.kind() == _InputArray::STD_VECTOR_VECTOR ? (int)a.total() : (int)readPoints3(a, name).size();
}

//! They may be NaN.
static std::vector<Vec3d> readVectors(InputArrayOfArrays a, int count, const char* name)
{
    std::vector<Vec3d> vectors;
    if (a.isMatVector() || a.kind() == _InputArray::STD_VECTOR_VECTOR)
        for (int i = 0; i < (int)a.total(); i++)
        {
            Mat numbers;
            a.getMat(i).convertTo(numbers, CV_64F);
            if (numbers.total()*numbers.channels() != 3)
                CV_Error_(Error::StsBadSize, ("%s has %d values; it must be a vector of 3", numbered(name, i).c_str(),
                                              (int)numbers.total()*numbers.channels()));
            vectors.push_back(Vec3d(numbers.ptr<double>()));
        }
    else
        for (const Point3d& p : readPoints3(a, name))
            vectors.push_back(Vec3d(p));
    if ((int)vectors.size() != count)
        CV_Error_(Error::StsUnmatchedSizes, ("%s has %d vectors, but there are %d views, whose poses must be given", name,
                                             (int)vectors.size(), count));
    return vectors;
}

//! What is exact beside what is not: far below what images tell, so that it is a prior as the rest.
static double exactly(int coordinate, double distance)
{
    const double EXACTLY = 1e-8;        // radians, and of the distance
    return coordinate < 3 || !(distance > 0) ? EXACTLY : EXACTLY*distance;
}

void holdExactly(int first, double distance, PosePrior& prior)
{
    const int rows = (int)prior.sqrtInformation.rows();
    prior.kind = PosePrior::UNCERTAIN;
    prior.sqrtInformation.conservativeResize(rows + 3, 6);
    prior.sqrtInformation.bottomRows(3).setZero();
    for (int i = 0; i < 3; i++)
        prior.sqrtInformation(rows + i, first + i) = 1/exactly(first + i, distance);
}

static PosePrior readPosePrior(InputArray covariance, const Pose& pose, const String& name)
{
    PosePrior prior;
    prior.kind = PosePrior::EXACT;
    Mat numbers;
    covariance.getMat().convertTo(numbers, CV_64F);
    const int values = (int)numbers.total()*numbers.channels();
    if (values == 0)
        return prior;
    if (values != 36)
        CV_Error_(Error::StsBadSize, ("%s has %d values; it must be 6x6, or empty", name.c_str(), values));
    const Mat_<double> all = knownCovariance(numbers.reshape(1, 6), name);
    if (countNonZero(all) == 0)
        return prior;
    std::vector<int> known;
    for (int i = 0; i < 6; i++)
        if (!std::isnan(all(i, i)))
            known.push_back(i);
    prior.kind = known.empty() ? PosePrior::NONE : PosePrior::UNCERTAIN;
    if (known.empty())
        return prior;
    const double distance = norm(pose.tvec);
    const int count = (int)known.size();
    Eigen::MatrixXd C(count, count), rows = Eigen::MatrixXd::Zero(count, 6);
    for (int i = 0; i < count; i++)
    {
        for (int j = 0; j < count; j++)
            C(i, j) = all(known[i], known[j]);
        if (C(i, i) == 0)
            C(i, i) = std::pow(exactly(known[i], distance), 2);
        rows(i, known[i]) = 1;
    }
    prior.sqrtInformation = whiten(C, rows);
    return prior;
}

std::vector<Pose> readPoses(InputArrayOfArrays rvecs, InputArrayOfArrays tvecs, int count)
{
    const std::vector<Vec3d> r = readVectors(rvecs, count, "rvecs"), t = readVectors(tvecs, count, "tvecs");
    std::vector<Pose> poses(count);
    for (int view = 0; view < count; view++)
    {
        poses[view].rvec = r[view];
        poses[view].tvec = t[view];
        poses[view].found = std::isfinite(norm(r[view])) && std::isfinite(norm(t[view]));
    }
    return poses;
}

void checkKnown(const Pose& pose, int view, const PosePrior& prior)
{
    for (int i = 0; i < 6; i++)
    {
        const double value = i < 3 ? pose.rvec[i] : pose.tvec[i - 3];
        if (prior.tells(i) && !std::isfinite(value))
            CV_Error_(Error::StsBadArg, ("%s[%d] is %g; it must be finite", numbered(i < 3 ? "rvecs" : "tvecs", view).c_str(), i % 3,
                                         value));
    }
}

void checkPoseCovariances(const std::vector<Mat>& covariances, int flags)
{
    if (!covariances.empty() && !(flags & GLASS_USE_POSES))
        CV_Error(Error::StsBadArg, "poseCovariances is given, but flags has no GLASS_USE_POSES");
}

std::vector<PosePrior> readPosePriors(const std::vector<Mat>& covariances, const std::vector<Pose>& poses)
{
    const int count = (int)poses.size();
    std::vector<Mat> all = covariances;
    if (!all.empty() && (int)all.size() != count)
        CV_Error_(Error::StsUnmatchedSizes, ("poseCovariances has %d elements, but there are %d views", (int)all.size(), count));
    all.resize(count);
    std::vector<PosePrior> priors;
    for (int view = 0; view < count; view++)
        priors.push_back(readPosePrior(all[view], poses[view], numbered("poseCovariances", view)));
    return priors;
}

std::vector<CameraPrior> readCameraPriors(const std::vector<Mat>& all, const std::vector<Camera>& cameras)
{
    std::vector<CameraPrior> priors;
    if (all.empty())
        return priors;
    checkCount(all.size(), (int)cameras.size(), "cameraCovariances", false);
    for (int c = 0; c < (int)all.size(); c++)
    {
        const String name = numbered("cameraCovariances", c);
        const int lens = cameras[c].lensCount(), both = cameras[c].parameterCount(), side = all[c].rows;
        if (!all[c].empty() && (all[c].channels() != 1 || all[c].cols != side ||
                                (side != lens && side != both && side != both + 6)))
            CV_Error_(Error::StsBadSize, ("%s is %dx%d with %d channels; it must be %dx%d (lens), %dx%d (lens and window), %dx%d "
                                          "(these, rvec and T) or empty", name.c_str(), side, all[c].cols, all[c].channels(), lens, lens,
                                          both, both, both + 6, both + 6));
        CameraPrior prior;
        Mat_<double> numbers;
        all[c].convertTo(numbers, CV_64F);
        const Mat_<double> known = knownCovariance(numbers, name);
        if (!known.empty())
            prior.covariance = Eigen::Map<const RowMajorMatrix>(known.ptr<double>(), side, side);
        if (prior.covariance.diagonal().array().isNaN().all())      // nothing is known
            prior.covariance.resize(0, 0);
        priors.push_back(prior);
    }
    return priors;
}

Eigen::MatrixXd readTargetCovariance(const Mat& given)
{
    const int count = SharedTargetErrors::COUNT;
    if (given.empty())
        return Eigen::MatrixXd();
    if (given.channels() != 1 || given.rows != count || given.cols != count)
        CV_Error_(Error::StsBadSize, ("targetCovariance is %dx%d with %d channels; it must be 7x7 (relative error of the scale, "
                                      "rotation vector, translation), or empty", given.rows, given.cols, given.channels()));
    Mat_<double> numbers;
    given.convertTo(numbers, CV_64F);
    const Mat_<double> known = knownCovariance(numbers, "targetCovariance");
    return Eigen::Map<const RowMajorMatrix>(known.ptr<double>(), count, count);
}

}} // namespace
