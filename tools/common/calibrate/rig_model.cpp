#include "calibrate/rig_model.hpp"
#include <opencv2/calib3d.hpp>

using namespace cv;
using namespace cv::refract;

namespace tools {

RigModel RigModel::clone() const
{
    RigModel copy = *this;
    for (Ptr<RefractiveCamera>& camera : copy.cameras)
        camera = camera->clone();
    return copy;
}

Ptr<RefractiveCamera> copyWithWindow(const Ptr<RefractiveCamera>& camera, const GlassWindow& window)
{
    const Ptr<RefractiveCamera> copy = camera->clone();
    copy->setWindow(window);
    return copy;
}

void poseInCamera(const RigModel& rig, int camera, Vec3d& rvec, Vec3d& tvec)
{
    if (camera == 0)
        return;
    Matx33d R;
    Rodrigues(rvec, R);
    Rodrigues(rig.R*R, rvec);
    tvec = rig.R*tvec + rig.T;
}

Calibration calibrationOf(const RigModel& rig)
{
    Calibration calibration;
    for (const Ptr<RefractiveCamera>& camera : rig.cameras)
        calibration.cameras.push_back({camera, WindowStd(), -1.});
    calibration.R = rig.R;
    calibration.T = rig.T;
    return calibration;
}

} // namespace tools
