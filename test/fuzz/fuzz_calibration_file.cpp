#include "calibrate/calib_file.hpp"
#include "file_harness.hpp"

// calib.yml as the tools read it; what was read is written and read again.

const char fuzz::EXTENSION[] = ".yml";

void fuzz::tryFile(const std::string& path)
{
    const tools::Calibration calibration = tools::readCalibration(path);
    promise(calibration.cameras.size() == 1 || calibration.cameras.size() == 2, "one camera or two");
    promise(cv::checkRange(calibration.R) && cv::checkRange(calibration.T), "R and T are finite");
    const std::string copy = (scratch().path() / "copy.yml").string();
    tools::writeCalibration(copy, calibration);
    const tools::Calibration again = tools::readCalibration(copy);
    promise(again.cameras.size() == calibration.cameras.size(), "a calibration that is read again has the same cameras");
}
