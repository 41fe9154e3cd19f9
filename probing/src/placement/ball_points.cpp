// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "placement/ball_points.h"

#include <algorithm>
#include <array>
#include <limits>

#include "palpate/core/quantile.h"

namespace palpate::probing {

BallPoints ball_points(const std::vector<HeldBall>& balls) {
  BallPoints points;
  for (std::size_t i = 0; i < balls.size(); ++i)
    if (balls[i].seen) points.rows.push_back(i);
  const auto count = static_cast<Eigen::Index>(points.rows.size());
  points.tips.resize(3, count);
  points.seen.resize(3, count);
  points.oriented = !balls.empty() && balls.front().R_base_tip.has_value();
  for (Eigen::Index k = 0; k < count; ++k) {
    const HeldBall& ball = balls[points.rows[static_cast<std::size_t>(k)]];
    points.tips.col(k) = ball.tip;
    points.seen.col(k) = ball.seen->centre;
    points.turns.emplace_back(points.oriented ? ball.R_base_tip->normalized().toRotationMatrix()
                                              : Eigen::Matrix3d::Identity());
    points.information.emplace_back(3 * ball.seen->information);
    points.radii.push_back(ball.seen->radius);
  }
  return points;
}

AgreedPose agreed_pose(const Eigen::Matrix3Xd& from, const Eigen::Matrix3Xd& to) {
  constexpr Eigen::Index kMostTriples = 5000;
  const Eigen::Index count = from.cols();
  const Eigen::Index triples = count * (count - 1) * (count - 2) / 6;
  const Eigen::Index stride = std::max<Eigen::Index>(1, triples / kMostTriples);
  AgreedPose best{.median = std::numeric_limits<double>::infinity()};
  Eigen::Index number = 0;
  for (Eigen::Index i = 0; i < count; ++i) {
    for (Eigen::Index j = i + 1; j < count; ++j) {
      for (Eigen::Index k = j + 1; k < count; ++k) {
        if (number++ % stride != 0) continue;
        const std::array<Eigen::Index, 3> some{i, j, k};
        const Eigen::Matrix3d a = from(Eigen::all, some), b = to(Eigen::all, some);
        const Eigen::Isometry3d motion(Eigen::umeyama(a, b, false));
        const Eigen::VectorXd distances = (motion * from - to).colwise().norm().transpose();
        const double median = palpate::median(distances);
        if (median < best.median) best = {motion, median};
      }
    }
  }
  return best;
}

}  // namespace palpate::probing
