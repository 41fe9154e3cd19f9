// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <vector>

#include "palpate/haptics/force_field.h"

namespace palpate::haptics {

/// Least standard deviation of an error relative to the extent of its quantity: a few rounding
/// errors.
inline constexpr double kExact = 1e-9;

/// Median of chi^2 with three degrees of freedom.
inline constexpr double kMedianChi2 = 2.366;

/// Standard deviations of each component of a displacement and of a force.
struct SampleNoise {
  double displacement = 0;  ///< >= 0
  double force = 0;         ///< > 0
};

/// Measures how well a field with weights >= 0 fits samples, with each error in units of its noise.
/// Dimensionless: the caller scales.
///
/// An error of a displacement acts as an error of the force through the local stiffness K, so the
/// error of a sample has the covariance S = force^2 I + displacement^2 K K^T. It is whitened by the
/// inverse of the Cholesky factor of S. The loss of a whitened error of length r is c^2 log(1 + r^2
/// / c^2) (Cauchy), c^2 = kCauchy * spread, which grows only slowly for outliers.
class WhitenedProblem {
 public:
  WhitenedProblem(Eigen::Matrix3Xd displacements, Eigen::Matrix3Xd forces, SampleNoise noise);

  /// Takes the local stiffness from a field; from the samples themselves if it has no bases.
  void whiten(const ForceField& field);
  /// Sets `spread` to the ratio of the median error to that caused by noise; at least 1.
  void adapt_spread(const ForceField& field);

  /// 3 N, sample by sample.
  [[nodiscard]] Eigen::VectorXd residuals(const ForceField& field) const;
  /// Derivatives of the residuals, five columns per base: by weight, by log epsilon, and by the
  /// centre; for a ridge, instead of the centre, by the centre along it and by two rotations about
  /// the perpendicular axes of `tangents`.
  [[nodiscard]] Eigen::MatrixXd jacobian(const ForceField& field) const;
  [[nodiscard]] double loss(const Eigen::VectorXd& residuals) const;
  /// N: weight, in [0, 1], of the squared error of each sample at these residuals.
  [[nodiscard]] Eigen::VectorXd robust_weights(const Eigen::VectorXd& residuals) const;

  [[nodiscard]] Eigen::Index size() const { return forces_.cols(); }
  [[nodiscard]] const Eigen::Matrix3Xd& displacements() const { return displacements_; }
  [[nodiscard]] const Eigen::Matrix3Xd& forces() const { return forces_; }
  /// W of sample i: W S W^T = I.
  [[nodiscard]] const Eigen::Matrix3d& whitening(Eigen::Index i) const {
    return whitening_[static_cast<std::size_t>(i)];
  }
  /// Mean over the samples of the trace of S: the squared error that noise alone makes.
  [[nodiscard]] double mean_noise() const { return mean_noise_; }

 private:
  Eigen::Matrix3Xd displacements_, forces_;
  SampleNoise noise_;
  std::vector<Eigen::Matrix3d> whitening_;
  double spread_ = 1;
  double mean_noise_ = 0;
};

/// Squared length of a whitened error above which a sample is an outlier; noise exceeds it once in
/// 10^10 samples.
inline constexpr double kOutlier = 50;

struct ReducedChi2 {
  double value = 0;  ///< chi^2 per degree of freedom, about 1 where noise makes the errors
  int outliers = 0;
};

/// Chi^2 of the squared lengths of whitened errors, three numbers each, after `parameters` numbers
/// were fitted. Outliers are left out unless there are too many for the fit to follow them.
[[nodiscard]] ReducedChi2 reduced_chi2(const Eigen::VectorXd& squares, double parameters);

/// Two unit vectors perpendicular to a ridge and to each other, as columns.
[[nodiscard]] Eigen::Matrix<double, 3, 2> tangents(const Eigen::Vector3d& ridge);

}  // namespace palpate::haptics
