#include "calibration_scenes.hpp"
#include "residual.hpp"

using namespace cv;
using namespace cv::refract;
using namespace scenes;

namespace {

typedef std::vector<std::vector<double> > Blocks;

std::vector<double*> pointers(Blocks& blocks)
{
    std::vector<double*> p;
    for (std::vector<double>& block : blocks)
        p.push_back(block.data());
    return p;
}

//! Largest difference between the jacobian of one coordinate and central differences, relative to its size.
double jacobianError(const ceres::CostFunction& cost, Blocks& blocks, int block, int coordinate, double step)
{
    const int rows = cost.num_residuals();
    Blocks jacobians;
    for (const std::vector<double>& b : blocks)
        jacobians.push_back(std::vector<double>(rows*b.size()));
    std::vector<double> residuals(rows), above(rows), below(rows);
    REQUIRE(cost.Evaluate(pointers(blocks).data(), residuals.data(), pointers(jacobians).data()));
    double& value = blocks[block][coordinate];
    const double kept = value;
    value = kept + step;
    REQUIRE(cost.Evaluate(pointers(blocks).data(), above.data(), nullptr));
    value = kept - step;
    REQUIRE(cost.Evaluate(pointers(blocks).data(), below.data(), nullptr));
    value = kept;
    double error = 0, size = 1e-3;
    for (int r = 0; r < rows; r++)
    {
        const double exact = jacobians[block][r*blocks[block].size() + coordinate];
        error = std::max(error, std::abs((above[r] - below[r])/(2*step) - exact));
        size = std::max(size, std::abs(exact));
    }
    return error/size;
}

} // namespace

TEST_CASE("Every jacobian of the residual equals central differences", "[residual]")
{
    GlassWindow window({ -0.24, 0.1, 1 }, 20, 1.5437, 50, 1.2);
    window.innerIndex = 1.1;
    const Ptr<RefractiveCamera> handle = makeCamera(allLenses()[2], window);
    const Camera& camera = cameraOf(handle);
    const std::vector<double> all = camera.parameters();
    const int lens = camera.lensCount();
    ImagePoints points;
    Random random(500);
    points.object = cloud(random, 5);
    points.pixel.assign(5, Point2d(600, 500));

    for (bool isCamera2 : { false, true })
        for (ImageResidual::Window kind : { ImageResidual::WITHOUT, ImageResidual::OWN, ImageResidual::OF_CAMERA_1 })
        {
            if (!isCamera2 && kind == ImageResidual::OF_CAMERA_1)
                continue;
            const std::unique_ptr<ceres::CostFunction> cost(ImageResidual::Create(camera, points, isCamera2, kind));
            Blocks blocks(1, std::vector<double>{ 0.1, -0.2, 0.3, 5, 6, 600 });
            if (isCamera2)
                blocks.push_back({ 0.05, 0.1, -0.07, 20, -10, 30 });
            blocks.push_back({ all.begin(), all.begin() + lens });
            if (kind != ImageResidual::WITHOUT)
            {
                blocks.push_back({ all.begin() + lens, all.begin() + lens + 3 });
                blocks.push_back({ all.begin() + lens + 3, all.end() });
            }
            for (int b = 0; b < (int)blocks.size(); b++)
                for (int i = 0; i < (int)blocks[b].size(); i++)
                {
                    const double scale = std::max(0.1, std::abs(blocks[b][i]));
                    double least = 1;
                    for (double step : { 1e-2, 1e-3, 1e-4, 1e-5, 1e-6 })
                        least = std::min(least, jacobianError(*cost, blocks, b, i, step*scale));
                    CAPTURE(isCamera2, (int)kind, b, i, seed());
                    CHECK(least < 1e-7);
                }
        }
}

TEST_CASE("The residual fails where a point has no image, and at impossible parameters", "[residual]")
{
    const Ptr<RefractiveCamera> handle = paperCamera(paperWindow());
    const Camera& camera = cameraOf(handle);
    const std::vector<double> all = camera.parameters();
    const int lens = camera.lensCount();
    ImagePoints points;
    points.object = board();
    points.pixel.assign(30, Point2d(600, 500));
    const std::unique_ptr<ceres::CostFunction> cost(ImageResidual::Create(camera, points, false, ImageResidual::OWN));
    std::vector<double> residuals(60);
    Blocks blocks = { { 0, 0, 0, 0, 0, 600 }, { all.begin(), all.begin() + lens },
                      { all.begin() + lens, all.begin() + lens + 3 }, { all.begin() + lens + 3, all.end() } };
    const auto evaluates = [&](int block, int coordinate, double value)
    {
        Blocks changed = blocks;
        changed[block][coordinate] = value;
        return cost->Evaluate(pointers(changed).data(), residuals.data(), nullptr);
    };
    CHECK(evaluates(0, 5, 600));
    CHECK(!evaluates(0, 5, 60));        // inside the window
    CHECK(!evaluates(0, 5, -600));
    CHECK(!evaluates(1, 0, -1));        // focal length
    CHECK(!evaluates(2, 2, -1));        // normal towards the camera
    CHECK(!evaluates(3, 0, -1));        // distance
    CHECK(!evaluates(3, 0, NaN));
}
