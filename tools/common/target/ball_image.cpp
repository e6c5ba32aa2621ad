// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "target/ball_image.hpp"
#include "math/quantile.hpp"

#include <opencv2/imgproc.hpp>
#include <algorithm>
#include <cmath>

using namespace cv;

namespace tools {

namespace {

//! An ellipse by the moments of its pixels; false: they are of another shape.
bool isEllipse(const Mat& mask, const Point& corner, DotImage& dot)
{
    const double ROUND = 0.55, FULL = 0.12;         // least ratio of the axes; how much of the area may be amiss
    const Moments m = moments(mask, true);
    const Matx22d spread(m.mu20/m.m00 + 1./12, m.mu11/m.m00, m.mu11/m.m00, m.mu02/m.m00 + 1./12);
    Vec2d values;
    Matx22d vectors;
    eigen(spread, values, vectors);
    const Vec2d half(2*std::sqrt(values[0]), 2*std::sqrt(values[1]));
    dot = {Point2d(corner) + Point2d(m.m10/m.m00, m.m01/m.m00), vectors.t()*Matx22d(1/half[0], 0, 0, 1/half[1])*vectors};
    const double area = CV_PI*half[0]*half[1];
    return half[1] > ROUND*half[0] && std::abs(m.m00/area - 1) < FULL + 2/std::sqrt(area);
}

struct Candidate
{
    DotImage dot;
    double contrast, level;
    //! How far the level is from where an outline is seen best: well below the brightest part, of a ball that is lit from one side.
    double misplaced() const
    {
        const double BEST = 0.35;
        return std::abs(std::log(level/(BEST*contrast)));
    }
};

//! Round parts of an image that are above a level.
void addRound(const Mat& over, double level, std::vector<Candidate>& candidates)
{
    const int SMALLEST = 9, OF_IMAGE = 16;           // pixels; a larger part of the image is no ball
    Mat labels, stats, centroids;
    const int count = connectedComponentsWithStats(over > level, labels, stats, centroids, 8, CV_32S);
    const Rect inner(1, 1, over.cols - 2, over.rows - 2);
    for (int i = 1; i < count; i++)
    {
        const int area = stats.at<int>(i, CC_STAT_AREA);
        const Rect box(stats.at<int>(i, CC_STAT_LEFT), stats.at<int>(i, CC_STAT_TOP), stats.at<int>(i, CC_STAT_WIDTH),
                       stats.at<int>(i, CC_STAT_HEIGHT));
        if (area < SMALLEST || area > (int)over.total()/OF_IMAGE || (box & inner) != box)
            continue;
        const Mat mask = labels(box) == i;
        Candidate candidate = {{}, 0., level};
        if (!isEllipse(mask, box.tl(), candidate.dot))
            continue;
        minMaxLoc(over(box), nullptr, &candidate.contrast, nullptr, nullptr, mask);
        candidates.push_back(candidate);
    }
}

//! Of each ball once, at its best level.
std::vector<Candidate> candidatesIn(const Mat& over)
{
    const double LOWEST = 12., STEP = 1.6;
    Mat smooth;
    GaussianBlur(over, smooth, Size(), 0.7);
    std::vector<Candidate> all, best;
    double highest;
    minMaxLoc(smooth, nullptr, &highest);
    for (double level = LOWEST; level < highest; level *= STEP)
        addRound(smooth, level, all);
    std::sort(all.begin(), all.end(), [](const Candidate& a, const Candidate& b) { return a.misplaced() < b.misplaced(); });
    for (const Candidate& c : all)
        if (std::none_of(best.begin(), best.end(), [&](const Candidate& b) { return std::min(b.dot.out(c.dot.centre),
                                                                                             c.dot.out(b.dot.centre)) < 1; }))
            best.push_back(c);
    std::sort(best.begin(), best.end(), [](const Candidate& a, const Candidate& b) { return a.contrast > b.contrast; });
    return best;
}

//! How near a point of a ball is to who looks at it, in radii; 0 beside it. @param out from the middle of its image
double heightOf(double out) { return std::sqrt(std::max(0., 1 - out*out)); }

//! The same where it is blurred. @param blur in units of out
double blurredHeight(double out, double blur)
{
    const double STEP = 0.5, END = 3.;
    double sum = 0., weights = 0.;
    for (double t = -END; t <= END; t += STEP)
    {
        const double weight = std::exp(-0.5*t*t);
        sum += weight*heightOf(out + t*blur);
        weights += weight;
    }
    return sum/weights;
}

/* What the pixels round a ball are: background, and the ball where its edge, an ellipse that is blurred, has it. A matt ball's brightness
is linear in the direction of its surface, thus in the place in its image and in the height above it. */
class BallModel
{
public:
    static const int COUNT = 11;        // centre, three of the ellipse, blur, light beside the background's, four of the ball's
    using Parameters = Vec<double, COUNT>;

    BallModel(const Mat& grey, const Mat& background, const DotImage& start) : grey_(grey), background_(background), origin_(start.centre)
    {
        const double WIDE = 1.5, RIM = 4.;
        const double reach = WIDE*start.radius() + RIM;
        part_ = Rect(Point(cvFloor(origin_.x - reach), cvFloor(origin_.y - reach)),
                     Point(cvCeil(origin_.x + reach) + 1, cvCeil(origin_.y + reach) + 1)) & Rect(Point(), grey.size());
    }

    int pixels() const { return part_.area(); }
    int rows() const { return part_.height; }
    DotImage outline(const Parameters& p) const
    {
        return {origin_ + Point2d(p[0], p[1]), Matx22d(p[2], p[3], p[3], p[4])};
    }
    //! Image minus model, row by row.
    void residuals(const Parameters& p, Mat_<double>& values) const
    {
        const double FAR = 4.;
        const DotImage edge = outline(p);
        const Matx22d square = edge.toCircle*edge.toCircle;
        values.create(pixels(), 1);
        for (int y = 0, i = 0; y < part_.height; y++)
            for (int x = 0; x < part_.width; x++, i++)
            {
                const Point at = part_.tl() + Point(x, y);
                const Vec2d d(at.x - edge.centre.x, at.y - edge.centre.y);
                const Vec2d outwards = square*d;
                const double out = edge.out(at), slope = norm(outwards);
                const double beyond = slope > 0 ? (out - 1)*out/slope/p[5] : -2*FAR;    // of the edge, in units of the blur
                const double around = background_.at<uchar>(at) + p[6], ball = p[7] + p[8]*d[0] + p[9]*d[1];
                values(i) = grey_.at<uchar>(at) - around;
                if (std::abs(beyond) > FAR)
                    values(i) -= beyond < 0 ? ball - around + p[10]*heightOf(out) : 0;
                else        // a step is blurred to an error function, and a slope that ends there to that and its derivative
                    values(i) -= (ball - around)*0.5*std::erfc(beyond*M_SQRT1_2)
                        - (p[8]*outwards[0] + p[9]*outwards[1])/slope*p[5]*std::exp(-0.5*beyond*beyond)/std::sqrt(2*CV_PI)
                        + p[10]*blurredHeight(out, p[5]*slope/out);
            }
    }
    Parameters startOf(const DotImage& start, double ball) const
    {
        return {0, 0, start.toCircle(0, 0), start.toCircle(0, 1), start.toCircle(1, 1), 1., 0, ball, 0, 0, 0};
    }

private:
    const Mat &grey_, &background_;
    Point2d origin_;
    Rect part_;
};

//! The normal equations about some values, by differences.
struct Normal
{
    Mat_<double> at, J;             //!< residuals and their derivatives, a row for each pixel
    Matx<double, BallModel::COUNT, BallModel::COUNT> H;
    BallModel::Parameters g;
    double squares;

    //! @param steps of the differences; a parameter without one stays as it is
    Normal(const BallModel& model, const BallModel::Parameters& p, const BallModel::Parameters& steps)
    {
        Mat_<double> there;
        J = Mat_<double>(model.pixels(), BallModel::COUNT, 0.);
        model.residuals(p, at);
        for (int k = 0; k < BallModel::COUNT; k++)
        {
            if (!(steps[k] > 0))
                continue;
            BallModel::Parameters q = p;
            q[k] += steps[k];
            model.residuals(q, there);
            J.col(k) = (there - at)/steps[k];
        }
        H = Mat(J.t()*J);
        for (int k = 0; k < BallModel::COUNT; k++)
            H(k, k) += steps[k] > 0 ? 0 : 1;
        g = Mat(J.t()*at);
        squares = at.dot(at);
    }
};

//! Levenberg-Marquardt; false: there is no answer.
bool fitted(const BallModel& model, BallModel::Parameters& p, Normal& normal, const BallModel::Parameters& steps)
{
    const int ITERATIONS = 30;
    const double CONVERGED = 1e-6, WORST = 1e6;
    Mat_<double> trial;
    for (double damping = 1e-3, iteration = 0; iteration < ITERATIONS && damping < WORST; iteration++)
    {
        auto damped = normal.H;
        for (int k = 0; k < BallModel::COUNT; k++)
            damped(k, k) *= 1 + damping;
        BallModel::Parameters step;
        if (!solve(damped, normal.g, step, DECOMP_CHOLESKY))
            return false;
        const BallModel::Parameters next = p - step;
        model.residuals(next, trial);
        const double squares = trial.dot(trial);
        if (!(squares < normal.squares) || !(next[5] > 0))
        {
            damping *= 10;
            continue;
        }
        const bool converged = normal.squares - squares < CONVERGED*squares;
        p = next;
        normal = Normal(model, p, steps);
        damping *= 0.1;
        if (converged)
            return true;
    }
    return true;
}

/** Std of a coordinate of the centre, of noise that near pixels may have in common: what compresses or sharpens an image ties them. It
is taken to be the same all over the part. Residuals have less of it than pixels, by what the fit took. */
double centreStd(const BallModel& model, const Normal& normal)
{
    const int FAR = 3;                  // pixels, over which noise is tied
    const double white = normal.squares/(model.pixels() - BallModel::COUNT);
    const Mat_<double> residuals = normal.at.reshape(1, model.rows());
    const Mat inverse(normal.H.inv(DECOMP_SVD));
    std::vector<Mat_<double>> slopes, moves;        // of each parameter: of pixels by it, of it by pixels
    for (int k = 0; k < BallModel::COUNT; k++)
    {
        slopes.push_back(Mat(normal.J.col(k).clone()).reshape(1, model.rows()));
        moves.push_back(Mat(normal.J*inverse.col(k)).reshape(1, model.rows()));
    }
    double variance = 0.;
    for (int y = -FAR; y <= FAR; y++)
        for (int x = -FAR; x <= FAR; x++)
        {
            const Rect all(Point(), residuals.size()), from = all & (all - Point(x, y)), to = from + Point(x, y);
            const auto pairs = [&](const Mat_<double>& a, const Mat_<double>& b) { return a(from).dot(b(to)); };
            double common = pairs(residuals, residuals);
            for (int k = 0; k < BallModel::COUNT; k++)
                common += white*pairs(moves[k], slopes[k]);
            variance += common/from.area()*0.5*(pairs(moves[0], moves[0]) + pairs(moves[1], moves[1]));
        }
    return std::sqrt(variance);
}

//! The outline that explains the pixels; false: none does.
bool refine(const Mat& grey, const Mat& background, const Candidate& candidate, bool bright, BallImage& ball)
{
    const double MOVED = 0.7, RESIZED = 1.8, BLURRED = 0.6;     // of a radius, at most; more blurred a shaded ball is one that moved
    const double AMISS = 0.1;                                   // of the contrast, RMS
    const double SHARP = 4.;                                    // blurs in a radius, where the height can be told from them
    const DotImage& start = candidate.dot;
    const BallModel model(grey, background, start);
    const double radius = start.radius(), level = grey.at<uchar>(Point(cvRound(start.centre.x), cvRound(start.centre.y)));
    BallModel::Parameters p = model.startOf(start, level), steps;
    for (int k = 0; k < BallModel::COUNT; k++)
        steps[k] = k < 2 || k == 5 ? 1e-3 : k < 5 ? 1e-4/radius : k == 8 || k == 9 ? 1e-2/radius : 1e-2;
    const double height = steps[10];
    steps[10] = 0;
    Normal normal(model, p, steps);
    if (model.pixels() <= 2*BallModel::COUNT || !fitted(model, p, normal, steps))
        return false;
    if (SHARP*p[5] < model.outline(p).radius())
    {
        steps[10] = height;
        normal = Normal(model, p, steps);
        if (!fitted(model, p, normal, steps))
            return false;
    }
    ball.outline = model.outline(p);
    ball.contrast = (bright ? 1 : -1)*(p[7] - p[6] - background.at<uchar>(Point(cvRound(start.centre.x), cvRound(start.centre.y))));
    const double variance = normal.squares/(model.pixels() - BallModel::COUNT);
    ball.std = centreStd(model, normal);
    const double growth = ball.outline.radius()/radius;
    return start.out(ball.outline.centre) < MOVED && growth < RESIZED && growth > 1/RESIZED && p[5] < BLURRED*radius*growth
        && ball.contrast > 0 && std::sqrt(variance) < AMISS*ball.contrast && ball.std > 0 && std::isfinite(ball.std);
}

//! The same of a ball of any size: a large one has far more pixels than are needed, so some are taken together.
bool refineAny(const Mat& grey, const Mat& background, const Candidate& candidate, bool bright, BallImage& ball)
{
    const double LARGE = 25., WIDE = 1.6, RIM = 6., SMOOTH = 0.6;       // px; of a radius; px that were taken together, these two
    const double radius = candidate.dot.radius(), times = std::ceil(radius/LARGE), reach = WIDE*radius + RIM*times;
    if (times <= 1)
        return refine(grey, background, candidate, bright, ball);
    const Point2d corner = candidate.dot.centre - Point2d(reach, reach), middle(0.5, 0.5);
    Rect part = Rect(corner, Size2d(2*reach, 2*reach)) & Rect(Point(), grey.size());
    part.width -= part.width % (int)times;
    part.height -= part.height % (int)times;
    const auto shrunk = [&](const Mat& image) {
        Mat smooth, small;
        GaussianBlur(image(part), smooth, Size(), SMOOTH*times);
        resize(smooth, small, part.size()/(int)times, 0, 0, INTER_AREA);
        return small;
    };
    const Mat coarseGrey = shrunk(grey), coarseBackground = shrunk(background);
    Candidate coarse = candidate;
    coarse.dot = {(candidate.dot.centre - Point2d(part.tl()) + middle)/times - middle, candidate.dot.toCircle*times};
    if (!refine(coarseGrey, coarseBackground, coarse, bright, ball))
        return false;
    ball.outline = {(ball.outline.centre + middle)*times - middle + Point2d(part.tl()), ball.outline.toCircle*(1/times)};
    ball.std *= times;
    return true;
}

} // namespace

Mat stillBackground(const std::vector<Mat>& images)
{
    CV_Assert(!images.empty());
    Mat background(images[0].size(), CV_8U);
    std::vector<uchar> values(images.size());
    for (int y = 0; y < background.rows; y++)
        for (int x = 0; x < background.cols; x++)
        {
            for (size_t i = 0; i < images.size(); i++)
                values[i] = images[i].at<uchar>(y, x);
            background.at<uchar>(y, x) = (uchar)cv::refract::quantile(values, 0.5);
        }
    return background;
}

std::vector<BallImage> ballsIn(const Mat& grey, const Mat& background, bool bright, bool* crowded)
{
    CV_Assert(grey.type() == CV_8U && background.type() == CV_8U && grey.size() == background.size());
    Mat over;
    subtract(grey, background, over, noArray(), CV_32F);
    if (!bright)
        over = -over;
    std::vector<Candidate> candidates = candidatesIn(over);
    if (crowded)
        *crowded = candidates.size() > MOST_BALLS;
    candidates.resize(std::min(candidates.size(), MOST_BALLS));
    std::vector<BallImage> balls;
    for (const Candidate& candidate : candidates)
    {
        BallImage ball = {};
        if (refineAny(grey, background, candidate, bright, ball))
            balls.push_back(ball);
    }
    return balls;
}

} // namespace tools
