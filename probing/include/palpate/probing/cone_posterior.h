// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "palpate/geometry/eigen_alignment.h"

namespace palpate::probing {

/// A force that was applied at a contact, and whether the tip slipped.
struct ConeTrial {
  Eigen::Vector3d force = Eigen::Vector3d::Zero();  ///< [N] of the tool on the object
  bool slipped = false;
};

/// Prior of a friction cone before the first trial: independent normal distributions of the angle
/// between axis and surface and of the axis's two tilts against the pressing direction.
struct ConePrior {
  double angle = 0.7;            ///< [rad] mean of the angle; 0.7: a coefficient of 0.84
  double angle_deviation = 0.4;  ///< [rad] > 0
  double tilt_deviation = 0.12;  ///< [rad] of each tilt, 7 degrees; > 0
  double force_noise = 0.01;     ///< [N] of each component of an applied force; > 0
};

struct ConeEstimate {
  double angle = 0;            ///< [rad] between axis and surface: the coefficient is its tangent
  double angle_deviation = 0;  ///< [rad]
  double least_angle = 0;      ///< [rad] 95 % lower bound
  double coefficient = 0;
  double coefficient_error = 0;                    ///< standard deviation
  double low = 0, high = 0;                        ///< 95 % interval of the coefficient
  Eigen::Vector3d axis = Eigen::Vector3d::Zero();  ///< unit length
  double axis_error = 0;  ///< [rad] root mean square of its angle to the true axis
  double tilt = 0;        ///< [rad] angle between axis and pressing direction
};

/// Returns the prior of a contact from the cones of other contacts of an object. The spreads of
/// their angles and of their tilts are combined with the usual ones, which count as two further
/// contacts. Cones not known to 0.1 rad do not count; without any it is the usual prior.
[[nodiscard]] ConePrior pooled_prior(std::span<const ConeEstimate> cones, double force_noise);

/// The distribution of the friction cone of one contact after trials, by Bayes' rule, on a grid
/// that follows it. A trial with the signed distance d = cos(angle) |f_T| - sin(angle) f.axis from
/// the cone slips with the probability e + (1 - 2 e) Phi(d / noise); e = 2 % stands for slips that
/// are judged wrongly. Unlike the most likely cone, the mean over all cones stays right even if no
/// direction has both a force that held and one that slipped.
class ConePosterior {
 public:
  /// \param pressing into the object, of any length but zero.
  /// \throws InvalidInput if a number of the prior is outside its range.
  explicit ConePosterior(const Eigen::Vector3d& pressing, const ConePrior& prior = {});

  void add(std::span<const ConeTrial> trials);

  /// Probability that the tip slips under a force, over all cones.
  [[nodiscard]] double slip_probability(const Eigen::Vector3d& force) const;
  [[nodiscard]] ConeEstimate estimate() const;

 private:
  struct Axis {
    double low, step;
    [[nodiscard]] double at(int i) const { return low + step * i; }
  };
  void fill(const Eigen::Vector3d& low, const Eigen::Vector3d& high);
  void follow();

  Eigen::Matrix3d frame_;  // third column: the pressing direction
  ConePrior prior_;
  std::vector<ConeTrial> trials_;  // forces in the frame
  Eigen::Matrix4Xd cells_;         // sine and cosine of the angle, tilts of the axis
  Eigen::VectorXd angles_;
  Eigen::VectorXd weights_;  // sum 1
  Eigen::Vector3d mean_, deviation_;
};

}  // namespace palpate::probing
