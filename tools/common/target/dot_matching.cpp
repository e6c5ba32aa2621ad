// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "target/dot_target.hpp"
#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>
#include <algorithm>
#include <cmath>
#include <numeric>
#include <set>

using cv::Point2d;
using cv::Matx22d;
using cv::Matx33d;
using cv::Matx34d;
using cv::Point2d;
using cv::Point3d;
using cv::Vec2d;
using cv::Vec3d;

namespace tools {

static cv::Point pixelOf(const Point2d& p, cv::Size image)
{
    return {std::clamp(cvRound(p.x), 0, image.width - 1), std::clamp(cvRound(p.y), 0, image.height - 1)};
}

DotMap::DotMap(const std::vector<Point2d>& dots, cv::Size image) : dots_(dots)
{
    cv::Mat empty(image, CV_8U, cv::Scalar(255)), distance;
    for (const Point2d& dot : dots)
        empty.at<uchar>(pixelOf(dot, image)) = 0;
    cv::distanceTransform(empty, distance, nearest_, cv::DIST_L2, cv::DIST_MASK_5, cv::DIST_LABEL_PIXEL);
    ofLabel_.resize(dots.size() + 1, -1);
    for (int i = 0; i < (int)dots.size(); i++)
        ofLabel_[nearest_.at<int>(pixelOf(dots[i], image))] = i;
}

bool DotMap::isInside(const Point2d& p) const
{
    return p.x > -0.5 && p.y > -0.5 && p.x < nearest_.cols - 0.5 && p.y < nearest_.rows - 0.5;
}

int DotMap::at(const Point2d& p, double reach) const
{
    if (!isInside(p))
        return -1;
    const int dot = ofLabel_[nearest_.at<int>(pixelOf(p, nearest_.size()))];
    return dot >= 0 && cv::norm(dots_[dot] - p) < reach ? dot : -1;
}

namespace {

const size_t FEWEST = 8;            // dots of a target
const size_t MOST = 6000;           // dots of an image
const int AROUND = 24;              // neighbours that a guess is tried on
const double SEEN = 0.4;            // of a target's dots, at the least

//! The nearest of all to one of them, without itself, the nearest first.
template <typename Point>
std::vector<int> nearestTo(const std::vector<Point>& all, int one, size_t count)
{
    std::vector<std::pair<double, int>> others;
    for (int i = 0; i < (int)all.size(); i++)
        if (i != one)
            others.emplace_back(cv::norm(all[i] - all[one]), i);
    count = std::min(count, others.size());
    std::partial_sort(others.begin(), others.begin() + (long)count, others.end());
    std::vector<int> nearest;
    for (size_t k = 0; k < count; k++)
        nearest.push_back(others[k].second);
    return nearest;
}

Point2d through(const Matx34d& P, const Point3d& X)
{
    const Vec3d p = P*cv::Vec4d(X.x, X.y, X.z, 1.);
    return p[2] > 0. ? Point2d(p[0]/p[2], p[1]/p[2]) : Point2d(NAN, NAN);
}

struct Triple
{
    int dots[3];
};

/** How a target is seen whose triple is seen there, one answer for each sign of depth: rows of the camera are at right angles and alike
long. False: the three are nearly on a line, or seen nearly from the side. */
bool camerasOf(const std::vector<Point3d>& target, const Triple& t, const std::vector<Point2d>& dots, const Triple& seen,
               Matx34d cameras[2])
{
    const double LINE = 0.3, STEEPEST = 0.35;       // sine between the sides; cosine of the tilt
    const Vec3d q(target[t.dots[0]]), v1 = Vec3d(target[t.dots[1]]) - q, v2 = Vec3d(target[t.dots[2]]) - q;
    const Point2d u = dots[seen.dots[0]], w1 = dots[seen.dots[1]] - u, w2 = dots[seen.dots[2]] - u;
    const Vec3d across = v1.cross(v2);
    if (cv::norm(across) < LINE*cv::norm(v1)*cv::norm(v2) || std::abs(w1.cross(w2)) < 0.3*LINE*cv::norm(w1)*cv::norm(w2))
        return false;
    const Vec3d e1 = cv::normalize(v1), e3 = cv::normalize(across), e2 = e3.cross(e1);
    const Matx22d A = Matx22d(w1.x, w2.x, w1.y, w2.y)*Matx22d(v1.dot(e1), v2.dot(e1), 0, v2.dot(e2)).inv(), G = A*A.t();
    const double mean = 0.5*(G(0, 0) + G(1, 1)), spread = std::hypot(0.5*(G(0, 0) - G(1, 1)), G(0, 1));
    if (mean - spread < STEEPEST*STEEPEST*(mean + spread))
        return false;
    // h h^T = (mean + spread) I - G
    const double xx = mean + spread - G(0, 0), yy = mean + spread - G(1, 1), hx = std::sqrt(std::max(xx, 0.));
    const Vec2d h(hx, G(0, 1) > 0. ? -std::sqrt(std::max(yy, 0.)) : std::sqrt(std::max(yy, 0.)));
    for (int sign : {0, 1})
    {
        Matx34d& P = cameras[sign];
        P = Matx34d::zeros();
        for (int row = 0; row < 2; row++)
        {
            const Vec3d r = A(row, 0)*e1 + A(row, 1)*e2 + (sign ? -h[row] : h[row])*e3;
            for (int i = 0; i < 3; i++)
                P(row, i) = r[i];
            P(row, 3) = (row ? u.y : u.x) - r.dot(q);
        }
        P(2, 3) = 1.;
    }
    return true;
}

//! The target's dots and what is beside each.
struct Neighbourhoods
{
    explicit Neighbourhoods(const std::vector<Point3d>& all) : target(all)
    {
        for (int i = 0; i < (int)all.size(); i++)
            nearest.push_back(nearestTo(all, i, AROUND));
        size = 0.;
        for (const Point3d& p : all)
            size = std::max(size, cv::norm(p - all[0]));
    }
    const std::vector<Point3d>& target;
    std::vector<std::vector<int>> nearest;
    double size;                    //!< about, of the target
};

//! How many of the dots around the first are in their places; those far away are where perspective has moved them.
int countAround(const Neighbourhoods& n, int first, const Matx34d& P, double step, const DotMap& map)
{
    const double NEAR = 0.3;
    const int EARLY = 8;
    int found = 0, tried = 0;
    for (int k : n.nearest[first])
    {
        found += map.at(through(P, n.target[k]), NEAR*step) >= 0;
        if (++tried == EARLY && 2*found < EARLY)
            return 0;
    }
    return found;
}

struct Guess
{
    Matx34d P;
    int first, around;              //!< dot of the target that it begins at; neighbours that agree
};

//! All guesses at what a triple of the image is. @param best what is known so far; more than a little less is of no use
std::vector<Guess> guessesOf(const Neighbourhoods& n, const DotMap& map, const Triple& seen, int best)
{
    const size_t FIRST = 4, SECOND = 8;
    const double NEARLY = 0.8;
    const double step = cv::norm(map.dots()[seen.dots[1]] - map.dots()[seen.dots[0]]), least = 0.5*(double)std::min(AROUND,
        (int)n.target.size() - 1);
    std::vector<Guess> guesses;
    for (int i = 0; i < (int)n.target.size(); i++)
        for (size_t j = 0; j < std::min(FIRST, n.nearest[i].size()); j++)
            for (size_t k = 0; k < std::min(SECOND, n.nearest[i].size()); k++)
            {
                Matx34d cameras[2];
                const Triple t = {{i, n.nearest[i][j], n.nearest[i][k]}};
                if (j == k || !camerasOf(n.target, t, map.dots(), seen, cameras))
                    continue;
                for (const Matx34d& P : cameras)
                {
                    const int around = countAround(n, i, P, step, map);
                    if (around >= std::max(least, NEARLY*best))
                        guesses.push_back({P, i, around});
                    best = std::max(best, around);
                }
            }
    return guesses;
}

//! Neighbours of each of some dots of the image.
std::vector<Triple> triplesOf(const std::vector<Point2d>& dots)
{
    const size_t SEEDS = 60, FIRST = 2, SECOND = 6;
    std::vector<int> seeds(dots.size());
    std::iota(seeds.begin(), seeds.end(), 0);
    cv::RNG rng(1);
    for (size_t i = seeds.size(); i > 1; i--)
        std::swap(seeds[i - 1], seeds[(size_t)rng.uniform(0, (int)i)]);
    seeds.resize(std::min(seeds.size(), SEEDS));
    std::vector<Triple> triples;
    for (int seed : seeds)
    {
        const std::vector<int> nearest = nearestTo(dots, seed, SECOND);
        for (size_t j = 0; j < std::min(FIRST, nearest.size()); j++)
            for (size_t k = j + 1; k < nearest.size(); k++)
                triples.push_back({{seed, nearest[j], nearest[k]}});
    }
    return triples;
}

//! Who is who, and how well a projective camera explains it.
struct Assignment
{
    std::vector<int> dots;          //!< -1: not seen
    Matx34d P;
    int count = 0;
    double rms = 0.;
};

//! Least squares of P(2, 3) = 1, in units of the target and of its image, held where it was as far as the dots do not tell.
Matx34d fitted(const Matx34d& before, const std::vector<Point3d>& target, const std::vector<Point2d>& dots, const Assignment& a,
               const Point3d& origin, double size)
{
    const double HELD = 1e-2;
    const Point2d middle = through(before, origin);
    const double scale = size*cv::norm(cv::Vec3d(before(0, 0), before(0, 1), before(0, 2))/before(2, 3));
    const Matx34d toUnits = Matx33d(1/scale, 0, -middle.x/scale, 0, 1/scale, -middle.y/scale, 0, 0, 1)*before
        *cv::Matx44d(size, 0, 0, origin.x, 0, size, 0, origin.y, 0, 0, size, origin.z, 0, 0, 0, 1);
    cv::Matx<double, 11, 1> prior, right;
    cv::Matx<double, 11, 11> sum;
    for (int i = 0; i < 11; i++)
    {
        prior(i) = toUnits.val[i]/toUnits(2, 3);
        sum(i, i) = HELD*HELD;
        right(i) = HELD*HELD*prior(i);
    }
    for (size_t i = 0; i < a.dots.size(); i++)
        if (a.dots[i] >= 0)
        {
            const Point3d X = (target[i] - origin)*(1/size);
            const Point2d u = (dots[a.dots[i]] - middle)*(1/scale);
            const double rows[2][11] = {{X.x, X.y, X.z, 1, 0, 0, 0, 0, -u.x*X.x, -u.x*X.y, -u.x*X.z},
                                        {0, 0, 0, 0, X.x, X.y, X.z, 1, -u.y*X.x, -u.y*X.y, -u.y*X.z}};
            for (int k = 0; k < 2; k++)
                for (int r = 0; r < 11; r++)
                {
                    right(r) += rows[k][r]*(k ? u.y : u.x);
                    for (int c = 0; c < 11; c++)
                        sum(r, c) += rows[k][r]*rows[k][c];
                }
        }
    cv::Matx<double, 11, 1> solution;
    if (!cv::solve(sum, right, solution, cv::DECOMP_CHOLESKY))
        return before;
    Matx34d P;
    std::copy_n(solution.val, 11, P.val);
    P(2, 3) = 1.;
    return Matx33d(scale, 0, middle.x, 0, scale, middle.y, 0, 0, 1)*P
        *cv::Matx44d(1/size, 0, 0, -origin.x/size, 0, 1/size, 0, -origin.y/size, 0, 0, 1/size, -origin.z/size, 0, 0, 0, 1);
}

//! The first of the order that are in their places. @param reach as a part of the distance to the next dot
Assignment assigned(const Neighbourhoods& n, const std::vector<int>& order, size_t first, const Matx34d& P, double reach, const DotMap& map)
{
    Assignment a;
    a.P = P;
    a.dots.assign(n.target.size(), -1);
    std::set<int> taken;
    double sum = 0.;
    for (size_t k = 0; k < first; k++)
    {
        const int i = order[k];
        const Point2d at = through(P, n.target[i]);
        const int dot = map.at(at, reach*cv::norm(through(P, n.target[n.nearest[i][0]]) - at));
        if (dot < 0 || !taken.insert(dot).second)
            continue;
        a.dots[i] = dot;
        a.count++;
        sum += cv::norm(map.dots()[dot] - at)*cv::norm(map.dots()[dot] - at);
    }
    a.rms = std::sqrt(sum/std::max(a.count, 1));
    return a;
}

//! From a guess outwards; count 0: it leads nowhere.
Assignment grown(const Neighbourhoods& n, const Guess& guess, const DotMap& map)
{
    const double REACH = 0.3, LAST = 0.2;
    std::vector<int> order = nearestTo(n.target, guess.first, n.target.size());
    order.insert(order.begin(), guess.first);
    Matx34d P = guess.P;
    for (size_t first = 9; first < order.size(); first += std::max<size_t>(1, first/3))
    {
        const Assignment a = assigned(n, order, first, P, REACH, map);
        if (a.count < SEEN*(double)first)
            return {};
        P = fitted(P, n.target, map.dots(), a, n.target[guess.first], n.size);
    }
    for (int round = 0; round < 4; round++)
        P = fitted(P, n.target, map.dots(), assigned(n, order, order.size(), P, round < 2 ? REACH : LAST, map), n.target[guess.first],
                   n.size);
    const Assignment a = assigned(n, order, order.size(), P, LAST, map);
    return a.count < std::max(SEEN*(double)order.size(), (double)FEWEST - 2) ? Assignment() : a;
}

//! With the best of some focal lengths to start from; it need not be the true one, as of a flat target nothing tells it.
double rmsOfPinhole(const std::vector<Point3d>& target, const std::vector<Point2d>& dots, const Assignment& a, cv::Size image)
{
    std::vector<std::vector<cv::Point3f>> object(1);
    std::vector<std::vector<cv::Point2f>> pixels(1);
    for (size_t i = 0; i < a.dots.size(); i++)
        if (a.dots[i] >= 0)
        {
            object[0].emplace_back(target[i] - target[0]);
            pixels[0].emplace_back(dots[a.dots[i]]);
        }
    double best = INFINITY;
    for (double focal : {0.7, 1.5, 3., 6.})
    {
        const double f = focal*image.width;
        cv::Mat K(Matx33d(f, 0, 0.5*image.width, 0, f, 0.5*image.height, 0, 0, 1)), distortion = cv::Mat::zeros(1, 5, CV_64F);
        std::vector<cv::Mat> rvecs, tvecs;
        try
        {
            const double rms = cv::calibrateCamera(object, pixels, image, K, distortion, rvecs, tvecs, cv::CALIB_USE_INTRINSIC_GUESS
                | cv::CALIB_FIX_PRINCIPAL_POINT | cv::CALIB_FIX_ASPECT_RATIO | cv::CALIB_ZERO_TANGENT_DIST | cv::CALIB_FIX_K2
                | cv::CALIB_FIX_K3);
            if (tvecs[0].at<double>(2) > 0.)        // the mirror image is as good behind the camera
                best = std::min(best, rms);
        }
        catch (const cv::Exception&)        // no pose from there
        {
        }
    }
    return best;
}

//! Those that explain about as many dots as the best, each once: the mirror image of one may have a speck more.
std::vector<Assignment> contenders(const std::vector<Assignment>& all)
{
    int most = 0;
    for (const Assignment& a : all)
        most = std::max(most, a.count);
    std::vector<Assignment> result;
    std::set<std::vector<int>> known;
    for (const Assignment& a : all)
        if (a.count > 0 && a.count >= most - 1 - most/50 && known.insert(a.dots).second)
            result.push_back(a);
    return result;
}

std::vector<int> bestOf(const std::vector<Assignment>& all, const Neighbourhoods& n, const DotMap& map, cv::Size image)
{
    const double ALIKE = 1.25, PIXEL = 0.05;        // of residuals, which tell nothing below
    const std::vector<Assignment> left = contenders(all);
    std::vector<double> rms;
    for (const Assignment& a : left)
        rms.push_back(rmsOfPinhole(n.target, map.dots(), a, image));
    const double least = rms.empty() ? 0. : *std::min_element(rms.begin(), rms.end());
    int best = -1;
    double nearest = INFINITY;
    for (size_t i = 0; std::isfinite(least) && i < left.size(); i++)
    {
        const Point2d first = through(left[i].P, n.target[0]);
        const int more = best < 0 ? 1 : left[i].count - left[best].count;       // a row that is a dot shorter tells what is left
        if (rms[i] > ALIKE*least + PIXEL || more < 0 || (more == 0 && first.x + first.y >= nearest))
            continue;
        nearest = first.x + first.y;
        best = (int)i;
    }
    return best < 0 ? std::vector<int>() : left[best].dots;
}

} // namespace

std::vector<int> matchDots(const std::vector<Point3d>& target, const std::vector<Point2d>& dots, cv::Size image)
{
    const size_t TRIPLES = 10;          // of the image, that all guesses are made of: one would do if its dots were surely right
    if (target.size() < FEWEST || dots.size() < FEWEST - 2 || dots.size() > MOST)
        return {};
    const Neighbourhoods n(target);
    const DotMap map(dots, image);
    std::vector<std::pair<int, std::vector<Guess>>> ofTriples;
    int best = 0;
    for (const Triple& triple : triplesOf(dots))
    {
        std::vector<Guess> guesses = guessesOf(n, map, triple, best);
        int around = 0;
        for (const Guess& guess : guesses)
            around = std::max(around, guess.around);
        best = std::max(best, around);
        if (!guesses.empty())
            ofTriples.emplace_back(around, std::move(guesses));
    }
    std::stable_sort(ofTriples.begin(), ofTriples.end(), [](const auto& a, const auto& b) { return a.first > b.first; });
    std::vector<Assignment> all;
    for (size_t t = 0; t < std::min(ofTriples.size(), TRIPLES); t++)
        for (const Guess& guess : ofTriples[t].second)
            all.push_back(grown(n, guess, map));
    return bestOf(all, n, map, image);
}

} // namespace tools
