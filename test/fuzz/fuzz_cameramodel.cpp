#include "file_harness.hpp"

// mrcal's .cameramodel.

using namespace cv::refract;

const char fuzz::EXTENSION[] = ".cameramodel";

void fuzz::tryFile(const std::string& path)
{
    const cv::Ptr<RefractiveCamera> camera = RefractiveCamera::read(path);
    promise(cv::checkRange(camera->lensParameters()), "what was read is finite");
}
