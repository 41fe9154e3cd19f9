// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "fit/whitened_problem.h"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <utility>

#include "field/field_forces.h"
#include "palpate/core/quantile.h"

namespace palpate::haptics {
namespace {

// Squared length of a whitened error at which its weight has fallen to a half. Noise alone exceeds
// it once in 10^10 samples (chi^2 with three degrees of freedom), so the robust loss costs no
// accuracy. An outlier of 30 standard deviations keeps a twentieth of its weight.
constexpr double kCauchy = 50;
// Least length, in units of the data's extent, by which a force is divided for a secant stiffness.
constexpr double kShortestSecant = 1e-3;
// If more than this fraction are outliers, the fit cannot follow the samples, so none are left out.
constexpr double kMaxOutliers = 0.1;

}  // namespace

Eigen::Matrix<double, 3, 2> tangents(const Eigen::Vector3d& ridge) {
  Eigen::Matrix<double, 3, 2> result;
  result.col(0) = ridge.unitOrthogonal();
  result.col(1) = ridge.cross(result.col(0));
  return result;
}

WhitenedProblem::WhitenedProblem(Eigen::Matrix3Xd displacements, Eigen::Matrix3Xd forces,
                                 SampleNoise noise)
    : displacements_(std::move(displacements)),
      forces_(std::move(forces)),
      noise_(noise),
      whitening_(static_cast<std::size_t>(forces_.cols())) {
  whiten({});
}

void WhitenedProblem::whiten(const ForceField& field) {
  mean_noise_ = 0;
  for (Eigen::Index i = 0; i < size(); ++i) {
    Eigen::Matrix3d local;
    if (field.bases.empty()) {
      const double length = std::max(displacements_.col(i).norm(), kShortestSecant);
      local = forces_.col(i).norm() / length * Eigen::Matrix3d::Identity();
    } else {
      local = stiffness(field, displacements_.col(i));
    }
    const Eigen::Matrix3d covariance =
        noise_.force * noise_.force * Eigen::Matrix3d::Identity() +
        noise_.displacement * noise_.displacement * local * local.transpose();
    const Eigen::LLT<Eigen::Matrix3d> factor(covariance);
    whitening_[static_cast<std::size_t>(i)] = factor.matrixL().solve(Eigen::Matrix3d::Identity());
    mean_noise_ += covariance.trace() / static_cast<double>(size());
  }
}

void WhitenedProblem::adapt_spread(const ForceField& field) {
  const Eigen::VectorXd errors = residuals(field);
  std::vector<double> squares;
  for (Eigen::Index i = 0; i < size(); ++i) {
    squares.push_back(errors.segment<3>(3 * i).squaredNorm());
  }
  spread_ = std::max(1.0, median(squares) / kMedianChi2);
}

Eigen::VectorXd WhitenedProblem::residuals(const ForceField& field) const {
  const Eigen::Matrix3Xd forces = field_forces(field, displacements_);
  Eigen::VectorXd result(3 * size());
  for (Eigen::Index i = 0; i < size(); ++i)
    result.segment<3>(3 * i) = whitening(i) * (forces.col(i) - forces_.col(i));
  return result;
}

namespace {

// With t = u.x, d = t - o, s^2 = d^2 + e^2 and s0^2 = o^2 + e^2 the force is w u h, where
// h = d / s + o / s0.
void ridge_columns(const Multiquadric& base, const WhitenedProblem& problem,
                   Eigen::Ref<Eigen::MatrixXd> columns) {
  const Eigen::Matrix<double, 3, 2> turns = tangents(base.ridge);
  const double w = base.weight, e = base.epsilon, o = base.ridge.dot(base.center);
  const double s0 = std::sqrt(o * o + e * e), cube0 = 1 / (s0 * s0 * s0);
  for (Eigen::Index i = 0; i < problem.size(); ++i) {
    const Eigen::Vector3d x = problem.displacements().col(i);
    const double d = base.ridge.dot(x) - o, s = std::sqrt(d * d + e * e), cube = 1 / (s * s * s);
    const double h = d / s + o / s0, slope = e * e * cube;
    const Eigen::Vector3d ridge = problem.whitening(i) * base.ridge;
    const Eigen::Matrix<double, 3, 2> turned = problem.whitening(i) * turns;
    columns.block<3, 1>(3 * i, 0) = h * ridge;
    columns.block<3, 1>(3 * i, 1) = -w * e * e * (d * cube + o * cube0) * ridge;
    columns.block<3, 1>(3 * i, 2) = w * (e * e * cube0 - slope) * ridge;
    for (int turn = 0; turn < 2; ++turn) {
      columns.block<3, 1>(3 * i, 3 + turn) =
          w * (h * turned.col(turn) + slope * turns.col(turn).dot(x) * ridge);
    }
  }
}

// With q = (x - c) / s, s^2 = |x - c|^2 + e^2 and q0 the same at x = 0 the force is w (q - q0).
void isotropic_columns(const Multiquadric& base, const WhitenedProblem& problem,
                       Eigen::Ref<Eigen::MatrixXd> columns) {
  const double w = base.weight, e = base.epsilon;
  const double s0 = std::sqrt(base.center.squaredNorm() + e * e);
  const Eigen::Vector3d q0 = -base.center / s0;
  const Eigen::Matrix3d slope0 = (Eigen::Matrix3d::Identity() - q0 * q0.transpose()) / s0;
  for (Eigen::Index i = 0; i < problem.size(); ++i) {
    const Eigen::Vector3d d = problem.displacements().col(i) - base.center;
    const double s = std::sqrt(d.squaredNorm() + e * e);
    const Eigen::Vector3d q = d / s;
    const Eigen::Matrix3d slope = (Eigen::Matrix3d::Identity() - q * q.transpose()) / s;
    const Eigen::Matrix3d& whitening = problem.whitening(i);
    columns.block<3, 1>(3 * i, 0) = whitening * (q - q0);
    columns.block<3, 1>(3 * i, 1) = w * e * e * (whitening * (q0 / (s0 * s0) - q / (s * s)));
    columns.block<3, 3>(3 * i, 2) = w * (whitening * (slope0 - slope));
  }
}

}  // namespace

Eigen::MatrixXd WhitenedProblem::jacobian(const ForceField& field) const {
  Eigen::MatrixXd result(3 * size(), 5 * static_cast<Eigen::Index>(field.bases.size()));
  for (std::size_t k = 0; k < field.bases.size(); ++k) {
    const auto columns = result.middleCols(5 * static_cast<Eigen::Index>(k), 5);
    if (is_ridge(field.bases[k])) {
      ridge_columns(field.bases[k], *this, columns);
    } else {
      isotropic_columns(field.bases[k], *this, columns);
    }
  }
  return result;
}

double WhitenedProblem::loss(const Eigen::VectorXd& residuals) const {
  const double scale = kCauchy * spread_;
  double sum = 0;
  for (Eigen::Index i = 0; i < size(); ++i) {
    sum += scale * std::log1p(residuals.segment<3>(3 * i).squaredNorm() / scale);
  }
  return sum;
}

Eigen::VectorXd WhitenedProblem::robust_weights(const Eigen::VectorXd& residuals) const {
  const double scale = kCauchy * spread_;
  Eigen::VectorXd result(size());
  for (Eigen::Index i = 0; i < size(); ++i) {
    result[i] = 1 / (1 + residuals.segment<3>(3 * i).squaredNorm() / scale);
  }
  return result;
}

ReducedChi2 reduced_chi2(const Eigen::VectorXd& squares, double parameters) {
  ReducedChi2 result;
  double all = 0, inside = 0;
  for (const double square : squares) {
    all += square;
    if (square > kOutlier) {
      ++result.outliers;
    } else {
      inside += square;
    }
  }
  const auto count = static_cast<double>(squares.size());
  const double degrees = 3 * count - parameters;
  result.value = result.outliers <= kMaxOutliers * count
                     ? inside / std::max(1.0, degrees - 3 * result.outliers)
                     : all / std::max(1.0, degrees);
  return result;
}

}  // namespace palpate::haptics
