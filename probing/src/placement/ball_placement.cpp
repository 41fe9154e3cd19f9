// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/probing/ball_placement.h"

#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "palpate/core/error.h"
#include "palpate/core/quantile.h"
#include "palpate/core/require.h"
#include "palpate/geometry/robust_weights.h"
#include "placement/ball_doubts.h"
#include "placement/ball_points.h"
#include "placement/pose_equations.h"

namespace palpate::probing {
namespace {

using Eigen::Matrix3d;
using Eigen::Matrix3Xd;
using Eigen::Vector3d;

/// Balls that are needed to judge a pose, and with an offset: as many numbers again as unknowns.
constexpr std::size_t kFewestBalls = 4, kFewestBallsWithOffset = 6;

/// A position contradicts the others if its distance is more than this many standard deviations of
/// a coordinate. One in 6000 good ones is beyond 4.5, but few positions give the deviation within a
/// quarter only.
constexpr double kBallOutlier = 6;

/// The offset is estimated if moving it by 1 mm in the weakest direction changes the positions, and
/// no pose compensates it, by at least this much (root mean square): orientations differ by about 6
/// degrees about two axes.
constexpr double kOffsetShown = 0.1;

constexpr int kMostBallSteps = 100;
constexpr double kSmallBallStep = 1e-10;  // of the radius of the positions

/// The pose and the offset at one step.
struct BallState {
  Eigen::Isometry3d T_camera_base = Eigen::Isometry3d::Identity();
  Vector3d offset = Vector3d::Zero();
};

/// Normal equations of pose and offset.
struct BallEquations {
  explicit BallEquations(const Matrix3Xd& places) : pose(places) {}
  PoseEquations pose;
  Matrix3d offset = Matrix3d::Zero();
  Eigen::Matrix<double, 6, 3> both = Eigen::Matrix<double, 6, 3>::Zero();
  Vector3d offset_slope = Vector3d::Zero();
};

/// Positions as the camera would see them.
Matrix3Xd places_of(const BallPoints& balls, const BallState& state) {
  Matrix3Xd places(3, balls.size());
  for (Eigen::Index i = 0; i < balls.size(); ++i) {
    places.col(i) = state.T_camera_base *
                    (balls.tips.col(i) + balls.turns[static_cast<std::size_t>(i)] * state.offset);
  }
  return places;
}

/// [mm] distances, weighted with what is known of each coordinate.
Eigen::VectorXd distances_of(const BallPoints& balls, const Matrix3Xd& places) {
  Eigen::VectorXd distances(balls.size());
  for (Eigen::Index i = 0; i < balls.size(); ++i) {
    const Vector3d error = places.col(i) - balls.seen.col(i);
    distances[i] = std::sqrt(error.dot(balls.information[static_cast<std::size_t>(i)] * error));
  }
  return distances;
}

BallEquations equations_of(const BallPoints& balls, const BallState& state, const Matrix3Xd& places,
                           const Eigen::VectorXd& weights) {
  std::vector<Eigen::Index> used;
  for (Eigen::Index i = 0; i < balls.size(); ++i)
    if (weights[i] > 0) used.push_back(i);
  BallEquations sums(places(Eigen::all, used));
  for (const Eigen::Index i : used) {
    const Matrix3d information = weights[i] * balls.information[static_cast<std::size_t>(i)];
    const Vector3d error = places.col(i) - balls.seen.col(i);
    sums.pose.add(places.col(i), information, error);
    const Matrix3d turn = state.T_camera_base.linear() * balls.turns[static_cast<std::size_t>(i)];
    sums.offset += turn.transpose() * information * turn;
    sums.both += sums.pose.motion_at(places.col(i)).transpose() * information * turn;
    sums.offset_slope += turn.transpose() * information * error;
  }
  return sums;
}

/// Returns the equations of the offset after the pose has compensated as much as possible.
Matrix3d offset_alone(const BallEquations& sums) {
  const Eigen::CompleteOrthogonalDecomposition<Matrix6d> pose(sums.pose.normal);
  return sums.offset - sums.both.transpose() * pose.solve(sums.both);
}

/// The same for the pose.
PoseEquations pose_alone(const BallEquations& sums, bool with_offset) {
  PoseEquations pose = sums.pose;
  if (!with_offset) return pose;
  const Eigen::LDLT<Matrix3d> offset(sums.offset);
  pose.normal -= sums.both * offset.solve(sums.both.transpose());
  pose.slope -= sums.both * offset.solve(sums.offset_slope);
  return pose;
}

/// One step of Gauss and Newton; its length [mm].
double step_balls(const BallPoints& balls, const Eigen::VectorXd& weights, bool with_offset,
                  BallState& state) {
  const BallEquations sums = equations_of(balls, state, places_of(balls, state), weights);
  const Vector6d x = pose_alone(sums, with_offset).solution();
  double moved = x.norm();
  if (with_offset) {
    const Vector3d change =
        sums.offset.ldlt().solve(-(sums.offset_slope + sums.both.transpose() * x));
    state.offset += change;
    moved += change.norm();
  }
  state.T_camera_base = sums.pose.to_motion(x) * state.T_camera_base;
  return moved;
}

double spare_numbers(Eigen::Index balls, bool with_offset) {
  return std::max(1.0, 3.0 * static_cast<double>(balls) - (with_offset ? 9 : 6));
}

/// Standard deviation of a coordinate if half of the positions agree.
double deviation_of(const Eigen::VectorXd& distances, bool with_offset) {
  constexpr double kMedian = 1.538;  // of the length of a vector of three normal coordinates
  const double median = palpate::median(distances) / kMedian;
  const auto numbers = 3.0 * static_cast<double>(distances.size());
  return median * std::sqrt(numbers / spare_numbers(distances.size(), with_offset));
}

/// Iterates with the weights of a function of the distances until the steps are small.
template <typename Weights>
void settle_balls(const BallPoints& balls, bool with_offset, const Weights& weights,
                  BallState& state) {
  const double radius = PoseEquations(balls.tips).radius;
  for (int k = 0; k < kMostBallSteps; ++k) {
    if (step_balls(balls, weights(distances_of(balls, places_of(balls, state))), with_offset,
                   state) < kSmallBallStep * radius)
      return;
  }
}

struct FittedBalls {
  BallState state;
  Eigen::VectorXd distances;
  std::vector<Eigen::Index> used;
  double variance = 0;  ///< [mm^2] of a coordinate
};

FittedBalls fit_balls(const BallPoints& balls, const Eigen::Isometry3d& start, bool with_offset) {
  FittedBalls fitted;
  fitted.state.T_camera_base = start;
  const double rounding = std::numeric_limits<double>::epsilon() * balls.seen.cwiseAbs().maxCoeff();
  settle_balls(
      balls, with_offset,
      [&](const Eigen::VectorXd& distances) -> Eigen::VectorXd {
        const double deviation = std::max(deviation_of(distances, with_offset), rounding);
        return distances.unaryExpr(
            [&](double distance) { return geometry::tukey_weight(distance, deviation); });
      },
      fitted.state);
  // Least squares of those that agree; their number settles after a few rounds.
  constexpr int kRounds = 5;
  fitted.distances = distances_of(balls, places_of(balls, fitted.state));
  double deviation = deviation_of(fitted.distances, with_offset);
  for (int round = 0; round < kRounds; ++round) {
    std::vector<Eigen::Index> used;
    Eigen::VectorXd weights = Eigen::VectorXd::Zero(balls.size());
    for (Eigen::Index i = 0; i < balls.size(); ++i) {
      if (!(fitted.distances[i] <= kBallOutlier * deviation + rounding)) continue;
      used.push_back(i);
      weights[i] = 1;
    }
    if (used == fitted.used) break;
    fitted.used = std::move(used);
    settle_balls(
        balls, with_offset, [&](const Eigen::VectorXd&) { return weights; }, fitted.state);
    fitted.distances = distances_of(balls, places_of(balls, fitted.state));
    const double squares = fitted.distances(fitted.used).squaredNorm();
    fitted.variance =
        squares / spare_numbers(static_cast<Eigen::Index>(fitted.used.size()), with_offset);
    deviation = std::max(deviation, std::sqrt(fitted.variance));
  }
  return fitted;
}

/// Returns true if the orientations determine the offset of the ball.
bool determine_offset(const BallPoints& balls, const Eigen::Isometry3d& pose) {
  if (!balls.oriented || balls.size() < static_cast<Eigen::Index>(kFewestBallsWithOffset))
    return false;
  const BallState state{.T_camera_base = pose};
  const BallEquations sums =
      equations_of(balls, state, places_of(balls, state), Eigen::VectorXd::Ones(balls.size()));
  const Eigen::SelfAdjointEigenSolver<Matrix3d> axes(offset_alone(sums), Eigen::EigenvaluesOnly);
  return axes.eigenvalues()[0] > kOffsetShown * kOffsetShown * static_cast<double>(balls.size());
}

/// Explains why orientations cannot be those of the tip, if positions agree better with others.
std::optional<std::string> wrong_orientations(const BallPoints& balls,
                                              const Eigen::Isometry3d& start, double variance) {
  constexpr double kAgree = 0.5 * 0.5;                 // [mm^2] needs no explanation
  constexpr double kExplains = (1.0 / 3) * (1.0 / 3);  // of the variance
  if (variance < kAgree) return std::nullopt;
  struct Other {
    const char* words;
    Matrix3d (*of)(const Matrix3d& turn);
  };
  constexpr std::array<Other, 2> kOthers{
      {{"the inverse: give those that turn directions of the tip into those of the base",
        [](const Matrix3d& turn) -> Matrix3d { return turn.transpose(); }},
       {"quaternions with qw first: check the order of the columns",
        [](const Matrix3d& turn) -> Matrix3d {
          const Eigen::Quaterniond q(turn);
          return Eigen::Quaterniond(q.x(), q.y(), q.z(), q.w()).toRotationMatrix();
        }}}};
  for (const Other& other : kOthers) {
    BallPoints turned = balls;
    for (Matrix3d& turn : turned.turns) turn = other.of(turn);
    if (fit_balls(turned, start, true).variance < kExplains * variance)
      return fmt::format("the orientations fit the positions only as {}", other.words);
  }
  return std::nullopt;
}

/// Places around those that were measured, as far from their middle as these.
std::vector<Candidate> further_places(const Matrix3Xd& places, const Vector3d& centre) {
  const double reach = (places.colwise() - centre).colwise().norm().maxCoeff();
  std::vector<Candidate> candidates;
  for (int x = -1; x <= 1; ++x)
    for (int y = -1; y <= 1; ++y)
      for (int z = -1; z <= 1; ++z)
        if (x != 0 || y != 0 || z != 0)
          candidates.push_back(
              {centre + reach * Vector3d(x, y, z).normalized(), Matrix3d::Identity()});
  return candidates;
}

void check_balls(const std::vector<HeldBall>& balls) {
  for (std::size_t i = 0; i < balls.size(); ++i) {
    const HeldBall& ball = balls[i];
    const auto refuse = [&](const char* what) {
      throw InvalidInput(fmt::format("place_by_ball: pose {}: {}", i + 1, what));
    };
    if (!ball.tip.allFinite()) refuse("the position has a coordinate that is not finite");
    if (ball.R_base_tip.has_value() != balls.front().R_base_tip.has_value())
      refuse("only some poses have an orientation; give it for all or for none");
    constexpr double kUnit = 1e-3;  // accepts quaternions rounded to four decimals
    if (ball.R_base_tip && !(std::abs(ball.R_base_tip->norm() - 1) <= kUnit))
      refuse("the quaternion of the orientation does not have the length 1");
    if (ball.seen && !(ball.seen->centre.allFinite() && ball.seen->information.allFinite()))
      refuse("the ball has a coordinate that is not finite");
  }
}

}  // namespace

BallPlacement place_by_ball(const std::vector<HeldBall>& held, double ball_radius) {
  require("place_by_ball: ball_radius", ball_radius, above(0).finite(), "mm");
  check_balls(held);
  BallPlacement placement;
  placement.residuals.assign(held.size(), {.distance = std::numeric_limits<double>::quiet_NaN()});
  const BallPoints balls = ball_points(held);
  if (balls.size() < static_cast<Eigen::Index>(kFewestBalls)) {
    placement.reason = fmt::format("the ball was found at {} poses; at least {} are needed",
                                   balls.size(), kFewestBalls);
    return placement;
  }
  if (const auto impossible = impossible_balls(balls, ball_radius)) {
    placement.reason = *impossible;
    return placement;
  }
  const Eigen::Isometry3d start = agreed_pose(balls.tips, balls.seen).motion;
  const bool with_offset = determine_offset(balls, start);
  const FittedBalls fitted = fit_balls(balls, start, with_offset);
  if (with_offset) {
    if (const auto wrong = wrong_orientations(balls, start, fitted.variance)) {
      placement.reason = *wrong;
      return placement;
    }
  }
  placement.T_camera_base = fitted.state.T_camera_base;
  placement.offset = fitted.state.offset;
  placement.used = static_cast<int>(fitted.used.size());
  const Matrix3Xd places = places_of(balls, fitted.state);
  double squares = 0;
  for (Eigen::Index i = 0; i < balls.size(); ++i) {
    placement.residuals[balls.rows[static_cast<std::size_t>(i)]].distance =
        (places.col(i) - balls.seen.col(i)).norm();
  }
  Eigen::VectorXd weights = Eigen::VectorXd::Zero(balls.size());
  for (const Eigen::Index i : fitted.used) {
    PlacementResidual& residual = placement.residuals[balls.rows[static_cast<std::size_t>(i)]];
    residual.used = true;
    squares += residual.distance * residual.distance;
    weights[i] = 1;
  }
  placement.rms = std::sqrt(squares / std::max(1, placement.used));
  const BallEquations sums = equations_of(balls, fitted.state, places, weights);
  const std::optional<std::string> free =
      state_errors(pose_alone(sums, with_offset), fitted.variance,
                   further_places(places(Eigen::all, fitted.used), sums.pose.centre), 0, placement);
  if (with_offset) {
    const Matrix3d covariance = fitted.variance * offset_alone(sums).inverse();
    placement.offset_deviation = covariance.diagonal().cwiseSqrt();
  }
  const std::size_t fewest = with_offset ? kFewestBallsWithOffset : kFewestBalls;
  if (free) {
    placement.reason = fmt::format("the positions do not determine {}", *free);
  } else if (fitted.used.size() < fewest || 2 * fitted.used.size() <= held.size()) {
    placement.reason = fmt::format(
        "the positions of only {} of {} poses agree; at least {}, and more than half, must",
        fitted.used.size(), held.size(), fewest);
  } else {
    placement.determined = true;
    placement.reason = fmt::format("{} of {} positions agree within {:.3g} mm (RMS)",
                                   fitted.used.size(), held.size(), placement.rms);
  }
  doubt_balls(balls, fitted.used, std::sqrt(fitted.variance), placement);
  if (placement.determined) doubt_frame(placement);
  return placement;
}

}  // namespace palpate::probing
