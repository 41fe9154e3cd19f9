// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/probing/ball_placement.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <random>
#include <string>

#include "placement_testing.h"
#include "refusal.h"

namespace palpate::probing {
namespace {

using Eigen::Quaterniond;
using Eigen::Vector3d;
using test::error_of;
using test::kTurnDegree;
using test::PoseError;
using test::stand;
using ::testing::HasSubstr;

constexpr double kBallRadius = 15;  // [mm]
constexpr double kBallNoise =
    0.03;  // [mm] of a coordinate of a centre; three times as much in depth

/// Information of the camera about a ball of which it sees a cap: the depth is less certain here,
/// so that weights matter.
Eigen::Matrix3d cap() { return Vector3d(9, 9, 1).asDiagonal().toDenseMatrix() / 19; }

/// A ball that an arm moves through a room of 150 x 100 x 120 mm before a camera.
std::vector<HeldBall> held_balls(int count, unsigned seed, double noise,
                                 const Vector3d& offset = {0, 0, 0}, double turning = 0) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> uniform(-1, 1);
  std::normal_distribution<double> normal(0, 1);
  std::vector<HeldBall> balls;
  for (int i = 0; i < count; ++i) {
    HeldBall& ball = balls.emplace_back();
    const Vector3d place{75 * uniform(random), 50 * uniform(random), 700 + 60 * uniform(random)};
    ball.tip = stand().inverse() * place;
    Vector3d centre = ball.tip;
    if (turning > 0) {
      const Vector3d axis{normal(random), normal(random), normal(random)};
      ball.R_base_tip =
          Quaterniond(Eigen::AngleAxisd(turning * uniform(random), axis.normalized()));
      centre += *ball.R_base_tip * offset;
    }
    const Vector3d error{normal(random), normal(random), 3 * normal(random)};
    ball.seen = geometry::SeenBall{.centre = stand() * centre + noise * kBallNoise * error,
                                   .information = cap(),
                                   .points = 500,
                                   .rms = 0.05,
                                   .radius = kBallRadius + 0.02 * normal(random)};
  }
  return balls;
}

TEST(PlaceByBall, IsExactForExactPositions) {
  const BallPlacement found = place_by_ball(held_balls(8, 1, 0), kBallRadius);
  ASSERT_TRUE(found.determined) << found.reason;
  EXPECT_LT(error_of(found).shift.norm(), 1e-9);
  EXPECT_LT(error_of(found).turn.norm(), 1e-10);
  EXPECT_FALSE(found.offset_deviation);
  EXPECT_THAT(found.doubts, ::testing::IsEmpty());
}

TEST(PlaceByBall, FindsWhereTheBallIsOnATipThatTurns) {
  for (const Vector3d& offset : {Vector3d(0, 0, 0), Vector3d(4, -3, 60), Vector3d(-150, 40, 90)}) {
    const BallPlacement found =
        place_by_ball(held_balls(14, 2, 0, offset, 50 * kTurnDegree), kBallRadius);
    ASSERT_TRUE(found.determined) << found.reason;
    EXPECT_LT((found.offset - offset).norm(), 1e-6);
    EXPECT_LT(error_of(found).turn.norm(), 1e-8);
    EXPECT_TRUE(found.offset_deviation);
  }
}

/// RMS over seeds of errors over stated deviations.
double error_over_stated(double turning) {
  constexpr int kSeeds = 100;
  double squares = 0;
  for (unsigned seed = 1; seed <= kSeeds; ++seed) {
    const BallPlacement found =
        place_by_ball(held_balls(12, seed, 1, {4, -3, 60}, turning), kBallRadius);
    EXPECT_TRUE(found.determined) << seed << found.reason;
    const PoseError error = error_of(found);
    squares += test::squared_ratio(found);
    EXPECT_LT(error.shift.norm(), 0.2) << seed;
    EXPECT_LT(error.turn.norm(), 0.1 * kTurnDegree) << seed;
    if (!found.offset_deviation) continue;
    EXPECT_LT((found.offset - Vector3d(4, -3, 60)).norm(), 0.4);
  }
  return std::sqrt(squares / kSeeds);
}

TEST(PlaceByBall, ErrsByWhatItStates) {
  for (const double turning : {0.0, 50 * kTurnDegree}) {
    const double ratio = error_over_stated(turning);
    EXPECT_GT(ratio, 0.7) << turning;
    EXPECT_LT(ratio, 1.5) << turning;
    RecordProperty(turning > 0 ? "with_offset" : "without", std::to_string(ratio));
  }
}

TEST(PlaceByBall, NamesPosesThatContradictTheOthers) {
  std::vector<HeldBall> balls = held_balls(12, 3, 1);
  balls[2].tip += Vector3d(0, 2, 0);
  balls[9].seen->centre += Vector3d(-5, 0, 30);
  balls[5].seen.reset();
  const BallPlacement found = place_by_ball(balls, kBallRadius);
  ASSERT_TRUE(found.determined) << found.reason;
  for (std::size_t i = 0; i < balls.size(); ++i)
    EXPECT_EQ(found.residuals[i].used, i != 2 && i != 9 && i != 5) << i;
  EXPECT_TRUE(std::isnan(found.residuals[5].distance));
  EXPECT_NEAR(found.residuals[2].distance, 2, 0.3);
  EXPECT_LT(error_of(found).shift.norm(), 0.1);
}

TEST(PlaceByBall, SaysWhichTurnPositionsOnALineLeaveFreeAndWhatWouldFixIt) {
  std::vector<HeldBall> balls = held_balls(8, 4, 1);
  const Vector3d along(0.6, 0, 0.8);
  for (std::size_t i = 0; i < balls.size(); ++i) {
    const Vector3d error = balls[i].seen->centre - stand() * balls[i].tip;
    const Vector3d place = Vector3d(0, 0, 700) + (20 * static_cast<double>(i) - 70) * along;
    balls[i].tip = stand().inverse() * place;
    balls[i].seen->centre = place + error;
  }
  const BallPlacement found = place_by_ball(balls, kBallRadius);
  EXPECT_FALSE(found.determined);
  EXPECT_THAT(found.reason, ::testing::AnyOf(HasSubstr("a turn about (0.60, 0.00, 0.80)"),
                                             HasSubstr("a turn about (-0.60, 0.00, -0.80)"),
                                             HasSubstr("a turn about (0.60, -0.00, 0.80)"),
                                             HasSubstr("a turn about (-0.60, -0.00, -0.80)")));
  ASSERT_TRUE(found.advice);
  const Vector3d way = found.advice->tip_camera - Vector3d(0, 0, 700);
  EXPECT_GT((way - way.dot(along) * along).norm(), 40);
  EXPECT_LT(found.advice->after, 0.1 * found.advice->before);
  // In one place nothing is fixed.
  for (HeldBall& ball : balls) {
    ball.seen->centre += stand() * balls[0].tip - stand() * ball.tip;
    ball.tip = balls[0].tip;
  }
  EXPECT_FALSE(place_by_ball(balls, kBallRadius).determined);
}

TEST(PlaceByBall, TakesTheBallToBeAtATipThatDoesNotTurn) {
  const BallPlacement found = place_by_ball(held_balls(10, 5, 1, {0, 0, 0}, 0.01), kBallRadius);
  EXPECT_TRUE(found.determined) << found.reason;
  EXPECT_FALSE(found.offset_deviation);
  EXPECT_EQ(found.offset, Vector3d::Zero());
  ASSERT_FALSE(found.doubts.empty());
  EXPECT_THAT(found.doubts.front(), HasSubstr("assumed to be at the tip"));
}

TEST(PlaceByBall, SaysWhatIsWrongWithPositionsThatCannotFit) {
  const auto reason = [](const std::function<void(HeldBall&)>& spoil, double radius,
                         double turning) {
    std::vector<HeldBall> balls = held_balls(14, 6, 1, {0, 0, turning > 0 ? 60.0 : 0.0}, turning);
    for (HeldBall& ball : balls) spoil(ball);
    const BallPlacement found = place_by_ball(balls, radius);
    EXPECT_FALSE(found.determined);
    return found.reason;
  };
  const auto right = [](HeldBall&) {};
  EXPECT_THAT(reason(right, 2 * kBallRadius, 0), HasSubstr("give the radius, not the diameter"));
  EXPECT_THAT(reason(right, 14, 0), HasSubstr("has a radius of 15.0"));
  EXPECT_THAT(reason([](HeldBall& ball) { ball.tip /= 1000; }, kBallRadius, 0),
              HasSubstr("in metres"));
  EXPECT_THAT(reason([](HeldBall& ball) { ball.tip /= 25.4; }, kBallRadius, 0),
              HasSubstr("in inches"));
  EXPECT_THAT(reason([](HeldBall& ball) { ball.tip.z() *= -1; }, kBallRadius, 0),
              HasSubstr("left-handed"));
  EXPECT_THAT(reason([](HeldBall& ball) { std::swap(ball.tip.x(), ball.tip.y()); }, kBallRadius, 0),
              HasSubstr("two columns are exchanged"));
  constexpr double kMuch = 60 * kTurnDegree;
  EXPECT_THAT(reason([](HeldBall& ball) { ball.R_base_tip = ball.R_base_tip->conjugate(); },
                     kBallRadius, kMuch),
              HasSubstr("the inverse"));
  EXPECT_THAT(reason(
                  [](HeldBall& ball) {
                    const Quaterniond q = *ball.R_base_tip;
                    // Read as x, y, z, w from a file in the order w, x, y, z.
                    ball.R_base_tip = Quaterniond(q.z(), q.w(), q.x(), q.y());
                  },
                  kBallRadius, kMuch),
              HasSubstr("qw first"));
}

TEST(PlaceByBall, DoubtsLengthsThatDifferAndAFrameThatIsTheCameras) {
  std::vector<HeldBall> longer = held_balls(12, 7, 1);
  for (HeldBall& ball : longer) ball.tip *= 0.99;
  const BallPlacement scaled = place_by_ball(longer, kBallRadius);
  ASSERT_TRUE(scaled.determined) << scaled.reason;
  ASSERT_EQ(scaled.doubts.size(), 1U);
  const std::size_t figure = scaled.doubts.front().find_first_of("0123456789");
  ASSERT_NE(figure, std::string::npos) << scaled.doubts.front();
  EXPECT_NEAR(std::stod(scaled.doubts.front().substr(figure)), 100 / 0.99 - 100, 0.05);  // per cent
  EXPECT_THAT(scaled.doubts.front(), HasSubstr("larger for the camera"));
  std::vector<HeldBall> same = held_balls(12, 7, 1);
  for (HeldBall& ball : same) ball.tip = stand() * ball.tip;
  const BallPlacement still = place_by_ball(same, kBallRadius);
  ASSERT_EQ(still.doubts.size(), 1U);
  EXPECT_THAT(still.doubts.front(), HasSubstr("already in the frame of the camera"));
}

TEST(PlaceByBall, RefusesFewPosesAndNumbersThatAreNone) {
  EXPECT_THAT(place_by_ball(held_balls(3, 1, 0), kBallRadius).reason, HasSubstr("at 3 poses"));
  EXPECT_THAT(place_by_ball({}, kBallRadius).reason, HasSubstr("at 0 poses"));
  std::vector<HeldBall> balls = held_balls(6, 1, 0);
  balls[3].tip.x() = std::nan("");
  EXPECT_THAT(refusal([&] { (void)place_by_ball(balls, kBallRadius); }), HasSubstr("pose 4"));
  balls[3].tip.x() = 0;
  balls[2].R_base_tip = Quaterniond::Identity();
  EXPECT_THAT(refusal([&] { (void)place_by_ball(balls, kBallRadius); }),
              HasSubstr("only some poses"));
  EXPECT_EQ(refusal([&] { (void)place_by_ball({}, 0); }),
            "place_by_ball: ball_radius is 0 mm; it must be > 0 and finite");
}

}  // namespace
}  // namespace palpate::probing
