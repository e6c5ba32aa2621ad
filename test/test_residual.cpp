// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "calibration_scenes.hpp"
#include "adjust/residual.hpp"

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

//! Where a camera's window comes from.
enum WindowOwner { ITSELF, CAMERA_1, CAMERA_3 };

//! One image's residuals with all its parameter blocks.
struct Image
{
    Image(const Camera& prototype, const ImagePoints& points, const std::vector<double>& rootWeights, bool isCamera1,
          bool refracted, WindowOwner owner) : camera(prototype), isCamera1_(isCamera1), refracted_(refracted), owner_(owner)
    {
        const std::vector<double> all = prototype.parameters();
        const int lens = prototype.lensCount();
        blocks.push_back({ 0.1, -0.2, 0.3, 5, 6, 600 });
        if (!isCamera1)
            blocks.push_back({ 0.05, 0.1, -0.07, 20, -10, 30 });
        blocks.push_back({ all.begin(), all.begin() + lens });
        const int media = lens + camera.at().media;
        window_ = { std::vector<double>(all.begin() + lens, all.begin() + media), std::vector<double>(all.begin() + media, all.end()),
                    { -0.1, 0.06, 0.03, -15, 8, 20 } };
        if (refracted)
            for (int i = 0; i < (owner == CAMERA_3 ? 3 : 2); i++)
                blocks.push_back(window_[i]);
        setCamera();
        residual.reset(new ImageResidual(camera, points, rootWeights, { refracted, isCamera1, owner == CAMERA_1, false },
                                         noTargetErrors));
    }

    //! The camera holds what the blocks say.
    void setCamera()
    {
        const int lens = isCamera1_ ? 1 : 2;
        Blocks& window = refracted_ ? blocks : window_;
        const int normal = refracted_ ? lens + 1 : 0;
        camera.set({ isCamera1_ ? nullptr : blocks[1].data(), blocks[lens].data(), window[normal].data(),
                     window[normal + 1].data(), owner_ == CAMERA_3 ? window[normal + 2].data() : nullptr,
                     owner_ == ITSELF });
    }

    bool evaluate(std::vector<double>& residuals, double** jacobians)
    {
        setCamera();
        residuals.resize(residual->count());
        return residual->evaluate(blocks[0].data(), residuals.data(), jacobians);
    }

    RigCamera camera;
    Blocks blocks;
    const SharedTargetErrors noTargetErrors;
    std::unique_ptr<ImageResidual> residual;

private:
    bool isCamera1_, refracted_;
    WindowOwner owner_;
    Blocks window_;
};

//! Largest difference between the jacobian of one coordinate and central differences, relative to its size.
double jacobianError(Image& image, int block, int coordinate, double step)
{
    const int rows = image.residual->count();
    Blocks jacobians;
    for (const std::vector<double>& b : image.blocks)
        jacobians.push_back(std::vector<double>(rows*b.size()));
    std::vector<double> residuals, above, below;
    REQUIRE(image.evaluate(residuals, pointers(jacobians).data()));
    double& value = image.blocks[block][coordinate];
    const double kept = value;
    value = kept + step;
    REQUIRE(image.evaluate(above, nullptr));
    value = kept - step;
    REQUIRE(image.evaluate(below, nullptr));
    value = kept;
    double error = 0, size = 1e-3;
    for (int r = 0; r < rows; r++)
    {
        const double exact = jacobians[block][r*image.blocks[block].size() + coordinate];
        error = std::max(error, std::abs((above[r] - below[r])/(2*step) - exact));
        size = std::max(size, std::abs(exact));
    }
    return error/size;
}

} // namespace

TEST_CASE("Every jacobian of the residual equals central differences", "[residual]")
{
    GlassWindow pane({ -0.24, 0.1, 1 }, 20, 1.5437, 50, 1.2), dome = GlassWindow::dome({ 15, -10, 20 }, 90, 12, 1.5, 1.2);
    pane.innerIndex = dome.innerIndex = 1.1;
    GlassWindow tube = GlassWindow::tube({ 15, -10, 20 }, { 0.3, 1, 0.2 }, 90, 12, 1.5, 1.2), bent = pane;
    bent.shape = WINDOW_BENT;
    bent.curvature = 1e-3;
    const GlassWindow window = GENERATE_COPY(pane, dome, tube, bent);
    CAPTURE(window.shape);
    const Ptr<RefractiveCamera> handle = makeCamera(lensNamed("4 coefficients"), window);
    ImagePoints points;
    Random random(500);
    points.object = cloud(random, 5);
    points.pixel.assign(5, Point2d(600, 500));
    const std::vector<double> rootWeights = { 1, 0.5, 0, 0.1, 1 };

    for (bool isCamera1 : { true, false })
        for (bool refracted : { false, true })
            for (WindowOwner owner : { ITSELF, CAMERA_1, CAMERA_3 })
            {
                if (isCamera1 && owner != ITSELF)
                    continue;
                Image image(cameraOf(handle), points, rootWeights, isCamera1, refracted, owner);
                for (int b = 0; b < (int)image.blocks.size(); b++)
                    for (int i = 0; i < (int)image.blocks[b].size(); i++)
                    {
                        const double scale = std::max(0.1, std::abs(image.blocks[b][i]));
                        double least = 1;
                        for (double step : { 1e-2, 1e-3, 1e-4, 1e-5, 1e-6 })
                            least = std::min(least, jacobianError(image, b, i, step*scale));
                        CAPTURE(isCamera1, refracted, (int)owner, b, i, seed());
                        CHECK(least < 1e-7);
                    }
            }
}

TEST_CASE("Residuals with and without jacobians are the same; weights scale them, 0 leaves a point out", "[residual]")
{
    const Ptr<RefractiveCamera> handle = paperCamera(paper::pane());
    ImagePoints points;
    points.object = board();
    points.pixel.assign(30, Point2d(600, 500));
    std::vector<double> rootWeights(30, 1.);
    std::vector<double> residuals, weighted, withJacobian;
    Image image(cameraOf(handle), points, rootWeights, false, true, CAMERA_1);
    REQUIRE(image.evaluate(residuals, nullptr));
    rootWeights[3] = 0.5;
    rootWeights[7] = 0;
    points.object[7] = Point3d(0, 0, -1e4);     // no image, and none is needed
    REQUIRE(image.evaluate(weighted, nullptr));
    std::vector<double> byPose(60*6, NaN);
    std::vector<double*> jacobians(image.blocks.size(), nullptr);
    jacobians[0] = byPose.data();
    REQUIRE(image.evaluate(withJacobian, jacobians.data()));
    CHECK(largestDifference(weighted, withJacobian) < 1e-9);
    CHECK(std::abs(weighted[6] - 0.5*residuals[6]) < 1e-12);     // in another lane it may be rounded otherwise
    CHECK(std::abs(weighted[8] - residuals[8]) < 1e-12);
    CHECK(weighted[14] == 0);
    CHECK(byPose[14*6] == 0);
}

TEST_CASE("The residual fails where a point has no image, and at impossible parameters", "[residual]")
{
    const Ptr<RefractiveCamera> handle = paperCamera(paper::pane());
    ImagePoints points;
    points.object = board();
    points.pixel.assign(30, Point2d(600, 500));
    const std::vector<double> rootWeights(30, 1.);
    Image image(cameraOf(handle), points, rootWeights, true, true, ITSELF);
    image.blocks[0] = { 0, 0, 0, 0, 0, 600 };
    std::vector<double> residuals;
    const auto evaluates = [&](int block, int coordinate, double value)
    {
        const double kept = image.blocks[block][coordinate];
        image.blocks[block][coordinate] = value;
        const bool possible = image.evaluate(residuals, nullptr);
        image.blocks[block][coordinate] = kept;
        return possible;
    };
    CHECK(evaluates(0, 5, 600));
    CHECK(!evaluates(0, 5, 60));        // inside the window
    CHECK(!evaluates(0, 5, -600));
    CHECK(!evaluates(1, 0, -1));        // focal length
    CHECK(!evaluates(2, 2, -1));        // normal towards the camera
    CHECK(!evaluates(3, 0, -1));        // distance
    CHECK(!evaluates(3, 0, NaN));
}

TEST_CASE("A window seen from another camera: the same points lie on it", "[residual]")
{
    Random random(510);
    CAPTURE(seed());
    for (int run = 0; run < 20; run++)
    {
        std::vector<double> a, b;
        for (int i = 0; i < 6; i++)
        {
            a.push_back(random.uniform(-0.3, 0.3)*(i < 3 ? 1 : 300));
            b.push_back(random.uniform(-0.3, 0.3)*(i < 3 ? 1 : 300));
        }
        const TransformWithDerivatives owner(a.data()), camera(b.data());
        const Vec3d normal = randomNormal(random, 30);
        const double distance = random.uniform(10, 500);
        const WindowTransfer window(normal, distance, owner, camera);
        const Vec3d across = normal.cross(random.vector(100)), onWindow = distance*normal + across;
        const Vec3d inCamera1 = owner.rotation.R.t()*(onWindow - owner.T);
        const Vec3d there = camera.rotation.R*inCamera1 + camera.T;
        CHECK(window.normal.dot(there) == Approx(window.distance).margin(1e-9));
        CHECK(norm(window.normal) == Approx(1));
    }
}
