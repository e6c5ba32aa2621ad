// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_WAND_MATCHES_HPP
#define REFRACT_TOOLS_WAND_MATCHES_HPP

#include "bundle/bundle_start.hpp"
#include "calibrate/rig_model.hpp"
#include "console/frames.hpp"
#include "console/json.hpp"
#include "match/partner_search.hpp"
#include "target/ball_image.hpp"
#include "target/refine_points.hpp"
#include <opencv2/refract.hpp>
#include <cmath>

/* A wand with a ball at each end that is waved before cameras which do not move: from images to what a bundle adjustment takes. */
namespace tools {

/* Which of the balls that cameras see at one moment are the two of a wand. */

struct BallCenter
{
    cv::Point2d pixel;          //!< where the ball's centre is seen
    double radius;              //!< of the ball, as its image has it at that distance; NaN: nothing can be seen there
};

/** The middle of a ball's image is not where its centre is seen: off the axis the far side of the image is stretched, and a window adds
to that. The rays of the outline touch the ball, which says where its centre is.
@param near about where the centre is, in the frame of the camera: its distance is taken */
BallCenter centerOfBall(const cv::Ptr<cv::refract::RefractiveCamera>& camera, const DotImage& outline, const cv::Point3d& near);

struct Wand
{
    double length, std;                 //!< between the centres of its balls
};

using Balls = std::vector<BallImage>;

//! A ball as some cameras see it.
struct BallPoint
{
    Chain balls;
    cv::Point3d X;                          //!< in camera 1
    double squares = 0.;                //!< px^2, of the distances of its projections
    int count = 0;                      //!< cameras
    std::vector<cv::Point2d> centers = {};  //!< per camera
    double radius = 0.;

    double rms() const { return std::sqrt(squares/count); }
    bool sharesBallWith(const BallPoint& other) const
    {
        for (size_t c = 0; c < balls.size(); c++)
            if (balls[c] >= 0 && balls[c] == other.balls[c])
                return true;
        return false;
    }
    bool isPartOf(const BallPoint& other) const
    {
        for (size_t c = 0; c < balls.size(); c++)
            if (balls[c] >= 0 && balls[c] != other.balls[c])
                return false;
        return count < other.count;
    }
};

//! Two balls that may be the wand's.
struct WandPlace
{
    BallPoint a, b;

    int count() const { return a.count + b.count; }
    double rms() const { return std::sqrt((a.squares + b.squares)/count()); }
    double length() const { return cv::norm(a.X - b.X); }
    bool seenBy(int camera) const { return a.balls[camera] >= 0 && b.balls[camera] >= 0; }
};

struct WandLimits
{
    double rms;                     //!< px
    double length;                  //!< by which it may be longer or shorter, of its length
};

class WandFinder
{
public:
    //! @param balls per camera
    WandFinder(const RigModel& rig, const std::vector<Balls>& balls) : rig_(rig), balls_(balls) {}

    //! Those that most cameras see first, of these the one whose rays meet best.
    std::vector<WandPlace> places(const Wand& wand, const WandLimits& limits) const;

private:
    int cameras() const { return (int)balls_.size(); }
    std::vector<Chain> pairs() const;
    std::vector<BallPoint> triangulated(const std::vector<Chain>& chains) const;
    Chain extended(const BallPoint& point, double reach) const;
    bool measure(BallPoint& point) const;
    std::vector<BallPoint> pointsWithin(double tolerance) const;

    const RigModel& rig_;
    const std::vector<Balls>& balls_;
};

//! --wand=LENGTH[,STD]; without STD a thousandth of the length.
Wand parseWand(const std::string& text);

//! The balls that cameras see; all are brighter than their background, or all darker, as more moments show two.
struct BallSightings
{
    std::vector<std::string> moments;
    std::vector<std::vector<Balls>> balls;      //!< of each moment, per camera
    int crowded = 0;                            //!< images with more round things than are looked at
};

//! Of all moments that two cameras have images of. Throws Failure where there are few, or few show two balls.
BallSightings findBalls(const Calibration& calibration, std::vector<Frames>& cameras, bool quiet);

struct WandMatches
{
    Matches matches;                //!< a and b, of which a is the larger ball, or either
    GivenLengths lengths;
    int moments = 0, unseen = 0;    //!< all; where no two cameras see two balls
    int unfit = 0, unclear = 0;     //!< where no two balls are a wand, as far as rays and length tell; where several are
    int crowded = 0;                //!< images, of any moment, with more round things than are looked at
};

/** Which of the balls are the ends of the wand: those whose rays meet, and that are as far from each other as it is long. A start of
nominal values lets rays miss each other by many pixels; so what is clear tells the rig first, and this what the others are. Throws
Failure where hardly any moment shows a wand, with what is known of why, or where those that do let nothing be fitted, with their line.
@param path of the start, for the text */
WandMatches matchWand(const BundleStart& start, const std::string& path, const BallSightings& seen, const Wand& wand);

//! "wand: 78 of 80 moments; left out: 1 where no two fit, 1 where several do".
std::string textOf(const WandMatches& found);

//! Its numbers.
Json jsonOf(const WandMatches& found);

} // namespace tools

#endif // REFRACT_TOOLS_WAND_MATCHES_HPP
