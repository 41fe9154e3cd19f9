// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <span>

#include "palpate/geometry/eigen_alignment.h"
#include "palpate/probing/contact_stiffness.h"

namespace palpate::probing {

/// The stiffness of an object between its contacts: ordinary kriging (Cressie 1993, sec. 3.2) of
/// its logarithm, which keeps it above zero. The covariance is Matern of order 5/2 over straight
/// distances, so that the two sides of a thin object are not told apart. Its length and amplitude
/// are the most likely ones of a grid; the noise is that of the contacts.
class StiffnessProcess {
 public:
  /// \throws InvalidInput if there are fewer than three contacts, two are at one place, a number is
  /// not finite, or a stiffness or a deviation is not > 0.
  explicit StiffnessProcess(std::span<const ContactStiffness> contacts);

  /// The stiffness at a place [mm]: its median, and its standard deviation without noise.
  [[nodiscard]] ContactStiffness predict(const Eigen::Vector3d& place) const;
  /// [mm] over which the stiffness changes
  [[nodiscard]] double length() const { return length_; }
  /// Standard deviation of the logarithm along the surface; 0.1 is 10 %.
  [[nodiscard]] double amplitude() const { return amplitude_; }

 private:
  double fit(double length, double amplitude);

  Eigen::Matrix3Xd places_;
  Eigen::VectorXd logarithms_, noise_;
  double length_ = 0, amplitude_ = 0, mean_ = 0, sum_ = 0;
  Eigen::LLT<Eigen::MatrixXd> factor_;
  Eigen::VectorXd ones_, weights_;  // K^-1 1 and K^-1 (y - mean)
};

}  // namespace palpate::probing
