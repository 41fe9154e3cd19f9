// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <span>
#include <vector>

#include "palpate/geometry/eigen_alignment.h"

namespace palpate::probing {

/// A force at a contact and the displacement to which it led, in any common frame.
struct ForcePair {
  Eigen::Vector3d force = Eigen::Vector3d::Zero();         ///< [N]
  Eigen::Vector3d displacement = Eigen::Vector3d::Zero();  ///< [mm]
};

struct SurrogateOptions {
  double position_noise = 0.022;  ///< [mm] of a component of a displacement; > 0
  double force_noise = 0.01;      ///< [N] of a component of a force; >= 0
};

/// A displacement as the surrogate expects it.
struct PredictedDisplacement {
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();        ///< [mm]
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();  ///< [mm^2] without noise
};

/// [N^2] Mean squared error of the force if each pair is predicted from the others, as found and as
/// expected, noise included.
struct LeftOutPairs {
  double found = 0, expected = 0;
  /// As found if displacements need not be the gradient of an energy, but only be as smooth. It is
  /// smaller than `found` where they depend on the path of the tool.
  double found_without_energy = 0;
};

/// Predicts a contact's displacements from a few measurements: a Gaussian process on the
/// complementary energy W(f), whose gradient is the displacement. Its covariance is that of a
/// random symmetric compliance plus smooth parts that vary over fractions of the root of a force,
/// since objects stiffen. It is the same in all frames. Amplitudes are relative to the mean
/// compliance of the pairs, which also turns noise of forces into isotropic noise of displacements.
class ForceSurrogate {
 public:
  /// \throws InvalidInput if there is no pair, a number is not measurable (`is_measurable`), all
  /// forces are zero, or an option is outside its range.
  explicit ForceSurrogate(std::span<const ForcePair> pairs, const SurrogateOptions& options = {});

  [[nodiscard]] PredictedDisplacement predict(const Eigen::Vector3d& force) const;
  /// [mm/N] dd/df, symmetric, with eigenvalues that are at least a small part of the mean
  /// compliance
  [[nodiscard]] Eigen::Matrix3d compliance(const Eigen::Vector3d& force) const;
  /// [mm/N] root mean square of |displacement| / |force| of the pairs
  [[nodiscard]] double mean_compliance() const { return scale_; }
  /// [mm] standard deviation of a measured component
  [[nodiscard]] double noise() const;

  /// [N^2] Mean over queries of the expected squared error of the force there, |K(f) e|^2 with the
  /// stiffness K and the error e of the displacement.
  [[nodiscard]] double error_variance(std::span<const Eigen::Vector3d> queries) const;
  /// An error counts with at most 25 times its expected square.
  [[nodiscard]] LeftOutPairs left_out() const;
  /// [N^2] Reduction of `error_variance` by one more measurement of each candidate.
  [[nodiscard]] std::vector<double> reductions(std::span<const Eigen::Vector3d> queries,
                                               std::span<const Eigen::Vector3d> candidates) const;

 private:
  [[nodiscard]] Eigen::MatrixXd whitened(std::span<const Eigen::Vector3d> forces) const;

  std::vector<Eigen::Vector3d> forces_;
  SurrogateOptions options_;
  double scale_ = 0;
  Eigen::LLT<Eigen::MatrixXd> factor_;
  Eigen::VectorXd measured_, weights_;
};

}  // namespace palpate::probing
