// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/probing/force_surrogate.h"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>

#include "palpate/core/error.h"
#include "palpate/core/require.h"
#include "palpate/probing/measurable.h"

namespace palpate::probing {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

/// Standard deviation of a component of the random compliance, relative to the mean compliance.
constexpr double kLinearDeviation = 1;
/// A smooth part: its length scale, and the standard deviation of the displacement that it
/// contributes, relative to the mean compliance times 1 N.
struct SmoothPart {
  double length;  // [N^1/2]
  double deviation;
};
constexpr std::array<SmoothPart, 2> kSmoothParts{{{1, 0.1}, {3, 3}}};
constexpr double kBentForce = 0.6;  // [N] beyond which lengths grow with the root of the force
/// Least eigenvalue of a compliance, relative to the mean compliance; smaller ones are implausible.
constexpr double kLeastCompliance = 0.03;
constexpr double kDifference = 1e-3;    // [N] step of the derivatives of the mean
constexpr double kLargestLeftOut = 25;  // of squared errors; limits the effect of outliers
/// Variance that keeps the factor positive definite, relative to that of a displacement at 1 N.
constexpr double kJitter = 1e-10;

// The map f -> g = f / sqrt(|f| + kBentForce), and its symmetric Jacobian.
struct Bent {
  Vector3d at;
  Matrix3d jacobian;
};
Bent bend(const Vector3d& force) {
  const double size = force.norm();
  const double rho = 1 / std::sqrt(size + kBentForce);
  Matrix3d jacobian = rho * Matrix3d::Identity();
  if (size > 0) jacobian -= rho * rho * rho / (2 * size) * force * force.transpose();
  return {rho * force, jacobian};
}

// The assumption about the displacements: that they are the gradient of an energy, or only that
// each component is as smooth.
enum class Law { energy, any };

// Covariance of the displacements under two forces, relative to the squared mean compliance; with
// an energy, d/df d/df'^T of the covariance of W.
Matrix3d covariance(const Vector3d& f, const Bent& bent_f, const Vector3d& g, const Bent& bent_g,
                    Law law = Law::energy) {
  const Vector3d off = bent_f.at - bent_g.at;
  Matrix3d linear = f.dot(g) * Matrix3d::Identity(), turns = off * off.transpose();
  if (law == Law::energy)
    linear = (linear + g * f.transpose()) / 2;
  else
    turns.setZero();
  Matrix3d smooth = Matrix3d::Zero();
  for (const SmoothPart& part : kSmoothParts) {
    const double l2 = part.length * part.length;
    smooth += part.deviation * part.deviation * std::exp(-off.squaredNorm() / (2 * l2)) *
              (Matrix3d::Identity() - turns / l2);
  }
  return kLinearDeviation * kLinearDeviation * linear + bent_f.jacobian * smooth * bent_g.jacobian;
}

Eigen::MatrixXd covariances(std::span<const Vector3d> rows, std::span<const Vector3d> columns,
                            Law law = Law::energy) {
  std::vector<Bent> bent_rows, bent_columns;
  for (const Vector3d& f : rows) bent_rows.push_back(bend(f));
  for (const Vector3d& f : columns) bent_columns.push_back(bend(f));
  Eigen::MatrixXd result(3 * static_cast<Eigen::Index>(rows.size()),
                         3 * static_cast<Eigen::Index>(columns.size()));
  for (std::size_t i = 0; i < rows.size(); ++i) {
    for (std::size_t j = 0; j < columns.size(); ++j) {
      result.block<3, 3>(3 * static_cast<Eigen::Index>(i), 3 * static_cast<Eigen::Index>(j)) =
          covariance(rows[i], bent_rows[i], columns[j], bent_columns[j], law);
    }
  }
  return result;
}

}  // namespace

ForceSurrogate::ForceSurrogate(std::span<const ForcePair> pairs, const SurrogateOptions& options)
    : options_(options) {
  require("SurrogateOptions::position_noise", options.position_noise, above(0).finite(), "mm");
  require("SurrogateOptions::force_noise", options.force_noise, at_least(0).finite(), "N");
  double forces = 0, displacements = 0;
  for (const ForcePair& pair : pairs) {
    if (!is_measurable(pair.force) || !is_measurable(pair.displacement))
      throw InvalidInput("ForceSurrogate: a pair is not finite, or beyond 1e12 mm or N");
    forces_.push_back(pair.force);
    forces += pair.force.squaredNorm();
    displacements += pair.displacement.squaredNorm();
  }
  if (!(forces > 0)) throw InvalidInput("ForceSurrogate: needs a pair whose force is not zero");
  // Add the compliance that noise could hide, so that the scale of a rigid contact is not zero.
  const double hidden =
      options.position_noise * options.position_noise * static_cast<double>(pairs.size()) / forces;
  scale_ = std::sqrt(displacements / forces + hidden);
  Eigen::MatrixXd gram = covariances(forces_, forces_);
  gram.diagonal().array() += noise() * noise() / (scale_ * scale_) + kJitter;
  factor_.compute(gram);
  measured_.resize(gram.rows());
  for (std::size_t i = 0; i < pairs.size(); ++i)
    measured_.segment<3>(3 * static_cast<Eigen::Index>(i)) = pairs[i].displacement / scale_;
  weights_ = factor_.solve(measured_);
}

double ForceSurrogate::noise() const {
  return std::hypot(options_.position_noise, options_.force_noise * scale_);
}

Eigen::MatrixXd ForceSurrogate::whitened(std::span<const Vector3d> forces) const {
  return factor_.matrixL().solve(covariances(forces_, forces));
}

PredictedDisplacement ForceSurrogate::predict(const Vector3d& force) const {
  const Eigen::MatrixXd cross = covariances(forces_, {&force, 1});
  const Eigen::MatrixXd known = factor_.matrixL().solve(cross);
  const Bent bent = bend(force);
  const Matrix3d left = covariance(force, bent, force, bent) - known.transpose() * known;
  return {scale_ * (cross.transpose() * weights_), scale_ * scale_ * (left + left.transpose()) / 2};
}

Matrix3d ForceSurrogate::compliance(const Vector3d& force) const {
  Matrix3d slope;
  for (int k = 0; k < 3; ++k) {
    const Vector3d step = kDifference * Vector3d::Unit(k), up = force + step, down = force - step;
    const Vector3d change =
        (covariances(forces_, {&up, 1}) - covariances(forces_, {&down, 1})).transpose() * weights_;
    slope.col(k) = scale_ * change / (2 * kDifference);
  }
  const Eigen::SelfAdjointEigenSolver<Matrix3d> eigen((slope + slope.transpose()) / 2);
  return eigen.eigenvectors() *
         eigen.eigenvalues().cwiseMax(kLeastCompliance * scale_).asDiagonal() *
         eigen.eigenvectors().transpose();
}

double ForceSurrogate::error_variance(std::span<const Vector3d> queries) const {
  double sum = 0;
  for (const Vector3d& query : queries) {
    const Matrix3d stiffness = compliance(query).inverse();
    sum += (stiffness * predict(query).covariance * stiffness).trace();
  }
  return queries.empty() ? 0 : sum / static_cast<double>(queries.size());
}

LeftOutPairs ForceSurrogate::left_out() const {
  Eigen::MatrixXd free = covariances(forces_, forces_, Law::any);
  free.diagonal().array() += noise() * noise() / (scale_ * scale_) + kJitter;
  const Eigen::MatrixXd identity = Eigen::MatrixXd::Identity(free.rows(), free.cols());
  const Eigen::MatrixXd inverse = factor_.solve(identity);
  const Eigen::MatrixXd free_inverse = free.llt().solve(identity);
  const Eigen::VectorXd free_weights = free_inverse * measured_;
  LeftOutPairs result;
  for (std::size_t i = 0; i < forces_.size(); ++i) {
    const auto row = 3 * static_cast<Eigen::Index>(i);
    const Matrix3d stiffness = scale_ * compliance(forces_[i]).inverse();
    // Without pair i, its covariance is the inverse of its block of the inverse, and its error that
    // times its weight.
    const auto force_error = [&](const Matrix3d& left, const Eigen::VectorXd& weights) {
      return (stiffness * (left * weights.segment<3>(row))).squaredNorm();
    };
    const Matrix3d left = inverse.block<3, 3>(row, row).inverse();
    const double expected = (stiffness * left * stiffness).trace();
    const double most = kLargestLeftOut * expected;
    result.expected += expected;
    result.found += std::min(force_error(left, weights_), most);
    result.found_without_energy +=
        std::min(force_error(free_inverse.block<3, 3>(row, row).inverse(), free_weights), most);
  }
  for (double* sum : {&result.found, &result.expected, &result.found_without_energy})
    *sum /= static_cast<double>(forces_.size());
  return result;
}

std::vector<double> ForceSurrogate::reductions(std::span<const Vector3d> queries,
                                               std::span<const Vector3d> candidates) const {
  const Eigen::MatrixXd at_queries = whitened(queries), at_candidates = whitened(candidates);
  // Covariance of queries and candidates, given the measurements. The stiffnesses convert it to one
  // of forces.
  Eigen::MatrixXd between =
      covariances(queries, candidates) - at_queries.transpose() * at_candidates;
  for (std::size_t q = 0; q < queries.size(); ++q) {
    const auto row = 3 * static_cast<Eigen::Index>(q);
    between.middleRows<3>(row) =
        (scale_ * compliance(queries[q]).inverse() * between.middleRows<3>(row)).eval();
  }
  std::vector<double> result;
  const double variance = noise() * noise() / (scale_ * scale_);
  for (std::size_t c = 0; c < candidates.size(); ++c) {
    const auto column = 3 * static_cast<Eigen::Index>(c);
    const Bent bent = bend(candidates[c]);
    const auto known = at_candidates.middleCols<3>(column);
    const Matrix3d measured = covariance(candidates[c], bent, candidates[c], bent) -
                              known.transpose() * known + variance * Matrix3d::Identity();
    const Matrix3d gain = between.middleCols<3>(column).transpose() * between.middleCols<3>(column);
    result.push_back(measured.ldlt().solve(gain).trace() /
                     static_cast<double>(std::max<std::size_t>(queries.size(), 1)));
  }
  return result;
}

}  // namespace palpate::probing
