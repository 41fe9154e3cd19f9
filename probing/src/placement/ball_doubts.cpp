// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "placement/ball_doubts.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "palpate/core/quantile.h"
#include "placement/length_units.h"

namespace palpate::probing {
namespace {

using Eigen::Matrix3Xd;
using Eigen::Vector3d;

/// The radius of the ball is wrong if that of the range maps differs by more than this share; a
/// sphere of which a third is seen has a radius that is wrong by a few thousandths.
constexpr double kOtherRadius = 0.03;

/// If the positions of the arm extend this many times farther than those of the ball, or less far,
/// they are in another unit: an offset of the ball changes the extent by less.
constexpr double kOtherUnit = 5;

/// [mm] Poses that agree better than this need no explanation.
constexpr double kBallsAgree = 1;
/// An explanation counts if it leaves at most this share of the distances.
constexpr double kExplainsBalls = 1.0 / 3;

/// Median distance from the middle, which a few wrong positions do not change much.
double median_extent(const Matrix3Xd& points) {
  Vector3d middle;
  for (int axis = 0; axis < 3; ++axis) {
    const auto row = points.row(axis);
    middle[axis] = median(std::vector<double>(row.begin(), row.end()));
  }
  const Eigen::VectorXd distances = (points.colwise() - middle).colwise().norm().transpose();
  return median(distances);
}

std::optional<std::string> wrong_radius(const BallPoints& balls, double given) {
  const double radius = median(balls.radii);
  if (std::abs(radius - given) <= kOtherRadius * given) return std::nullopt;
  constexpr double kAboutTwice = 0.1;
  const bool diameter = std::abs(given / radius - 2) < kAboutTwice;
  return fmt::format(
      "the ball that is seen has a radius of {:.2f} mm (median of {} poses), not {:.2f} mm{}",
      radius, balls.size(), given, diameter ? "; give the radius, not the diameter" : "");
}

std::optional<std::string> wrong_unit(const BallPoints& balls) {
  const double arm = median_extent(balls.tips), camera = median_extent(balls.seen);
  if (!(arm > 0)) return std::nullopt;
  const double ratio = camera / arm;
  if (ratio < kOtherUnit && ratio > 1 / kOtherUnit) return std::nullopt;
  std::string text = fmt::format(
      "the positions of the arm spread over {:.3g} mm, and those of the ball over {:.3g} mm "
      "(median distance from the middle)",
      arm, camera);
  constexpr double kAbout = 1.5;
  for (const LengthUnit& unit : kOtherUnits)
    if (ratio < kAbout * unit.mm && ratio > unit.mm / kAbout)
      return text + fmt::format(": the positions seem to be in {}; give millimetres", unit.name);
  return text + ": the two sets do not match";
}

std::optional<std::string> wrong_hand(const BallPoints& balls) {
  const AgreedPose plain = agreed_pose(balls.tips, balls.seen);
  if (plain.median < kBallsAgree) return std::nullopt;
  Matrix3Xd mirrored = balls.tips;
  mirrored.row(0) *= -1;
  if (!(agreed_pose(mirrored, balls.seen).median < kExplainsBalls * plain.median))
    return std::nullopt;
  return "the positions fit those of the ball only if they are mirrored: the axes of the base are "
         "left-handed. One axis has the wrong sign, or two columns are exchanged";
}

}  // namespace

std::optional<std::string> impossible_balls(const BallPoints& balls, double ball_radius) {
  if (auto radius = wrong_radius(balls, ball_radius)) return radius;
  if (auto unit = wrong_unit(balls)) return unit;
  return wrong_hand(balls);
}

void doubt_balls(const BallPoints& balls, const std::vector<Eigen::Index>& used, double deviation,
                 BallPlacement& placement) {
  if (balls.oriented && !placement.offset_deviation) {
    placement.doubts.emplace_back(
        "the orientations of the tip differ too little to determine where the ball is on it; it is "
        "assumed to be at the tip");
  }
  Matrix3Xd held(3, static_cast<Eigen::Index>(used.size()));
  for (std::size_t k = 0; k < used.size(); ++k) {
    held.col(static_cast<Eigen::Index>(k)) =
        balls.tips.col(used[k]) + balls.turns[static_cast<std::size_t>(used[k])] * placement.offset;
  }
  held = placement.T_camera_base.linear() * held;
  const Matrix3Xd arm = held.colwise() - held.rowwise().mean();
  const Matrix3Xd seen = balls.seen(Eigen::all, used);
  const double squares = arm.squaredNorm();
  if (!(squares > 0)) return;
  const double scale = arm.cwiseProduct(seen.colwise() - seen.rowwise().mean()).sum() / squares;
  constexpr double kDeviations = 4, kMuch = 0.003;
  if (std::abs(scale - 1) < std::max(kMuch, kDeviations * deviation / std::sqrt(squares))) return;
  placement.doubts.push_back(
      fmt::format("distances between the balls are {:.2f} % {} for the camera than for the arm: "
                  "check the lengths of the arm's links and the squares of the board that the rig "
                  "was calibrated with",
                  100 * std::abs(scale - 1), scale > 1 ? "larger" : "smaller"));
}

}  // namespace palpate::probing
