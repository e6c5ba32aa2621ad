// Real data that the project does not own: see REFRACT_DATA_DIR. Skipped where the folder is absent.
#include "calibration_scenes.hpp"
#include <nlohmann/json.hpp>
#include <fstream>

using namespace cv;
using namespace cv::refract;
using namespace scenes;
using nlohmann::json;

//! False, with a warning, if the file is not there.
static bool readJson(const std::string& name, json& content)
{
    const std::string path = std::string(REFRACT_DATA_DIR) + "/" + name;
    std::ifstream file(path);
    if (!file)
    {
        WARN("SKIPPED: " << path << " is absent");
        return false;
    }
    content = json::parse(file);
    return true;
}

TEST_CASE("ouc_laser3d: lens from air, one water surface fitted to the water images", "[real_data]")
{
    json data;
    if (!readJson("ouc_laser3d/corners.json", data))
        return;
    const double square = data["square_mm"];
    std::vector<std::vector<Point3f> > object[2];
    std::vector<std::vector<Point2f> > pixels[2];
    for (const auto& image : data["corners"].items())
    {
        const int inWater = image.key().compare(0, 5, "water") == 0;
        std::vector<Point3f> targets;
        std::vector<Point2f> corners;
        for (const json& corner : image.value())
        {
            targets.push_back(Point3f((float)(square*corner[0].get<double>()), (float)(square*corner[1].get<double>()), 0));
            corners.push_back(Point2f(corner[2], corner[3]));
        }
        object[inWater].push_back(targets);
        pixels[inWater].push_back(corners);
    }
    Mat K, D;
    std::vector<Mat> rvecs, tvecs;
    calibrateCamera(object[0], pixels[0], Size(648, 486), K, D, rvecs, tvecs, CALIB_FIX_K3,
                    TermCriteria(TermCriteria::COUNT + TermCriteria::EPS, 200, 1e-14));

    GlassWindow water;
    water.outerIndex = 1.333;
    for (double start : { 0., 100. })
    {
        water.distance = start;
        GlassWindow found = water;
        const double rms = calibrateGlass(object[1], pixels[1], noArray(), K, D, found, rvecs, tvecs, GLASS_FREE_DISTANCE);
        CAPTURE(start, found.normal, found.distance);
        CHECK(rms <= 0.30);
        CHECK(found.distance == Approx(16.6).epsilon(0.02));
        printNumber("ouc_laser3d, 14 water images, distance started at " + std::to_string((int)start) + ", RMS", rms, "px");
    }
}

TEST_CASE("openptv_cavity: cameras 3 and 4 through glass into water", "[real_data]")
{
    json data;
    if (!readJson("openptv_cavity/points.json", data))
        return;
    ObjectViews object(1);
    for (const json& p : data["object_points_mm"])
        object[0].push_back(Point3d(p[0], p[1], p[2]));

    Ptr<RefractiveCamera> cameras[2];
    Matx33d R[2];
    Vec3d t[2];
    PixelViews pixels[2];
    for (int i = 0; i < 2; i++)
    {
        const json& camera = data["cams"][i == 0 ? "3" : "4"];
        Matx33d K;
        for (int k = 0; k < 9; k++)
            K.val[k] = camera["K_nominal"][k/3][k%3];
        GlassWindow window({ 0, 0, 1 }, 6, 1.46, camera["d0_mm"], 1.33);
        cameras[i] = RefractiveCamera::create(K, noArray(), window);
        pixels[i].assign(1, std::vector<Point2d>(object[0].size(), Point2d(NaN, NaN)));
        for (size_t k = 0; k < camera["point_index"].size(); k++)
            pixels[i][0][camera["point_index"][k]] = Point2d(camera["image_points"][k][0], camera["image_points"][k][1]);
        std::vector<Vec3d> rvecs, tvecs;
        CHECK(calibrateGlass(object, pixels[i], noArray(), cameras[i], rvecs, tvecs) < 0.7);
        Rodrigues(rvecs[0], R[i]);
        t[i] = tvecs[0];
    }
    std::vector<Point3d> found;
    const Matx33d R21 = R[1]*R[0].t();
    triangulateRefractive(cameras[0], cameras[1], R21, t[1] - R21*t[0], pixels[0][0], pixels[1][0], found);
    double sum = 0;
    int count = 0;
    for (size_t i = 0; i < found.size(); i++)
        if (!std::isnan(found[i].x))
        {
            const Vec3d error = Vec3d(found[i]) - (R[0]*Vec3d(object[0][i]) + t[0]);
            sum += error.dot(error);
            count++;
        }
    CHECK(count == 70);
    CHECK(std::sqrt(sum/count) < 0.13);
    printNumber("openptv_cavity, cameras 3+4, 70 dots, 3-D RMS", std::sqrt(sum/count), "mm");
}
