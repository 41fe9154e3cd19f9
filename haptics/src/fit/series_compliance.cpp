// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "fit/series_compliance.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "fit/whitened_problem.h"
#include "palpate/core/quantile.h"

namespace palpate::haptics {
namespace {

// The weights converge in three or four iterations.
constexpr int kReweightings = 8;
// Least compliance that counts as positive, relative to the prior's deviation.
constexpr double kLeastCompliance = 1e-9;

using Vector6d = Eigen::Vector<double, 6>;

const double kRoot2 = std::sqrt(2.0);

// Coordinates of a symmetric matrix in an orthonormal basis of the Frobenius product, so that the
// result does not depend on the frame.
Vector6d to_vector(const Eigen::Matrix3d& m) {
  Vector6d v;
  v << m(0, 0), m(1, 1), m(2, 2), kRoot2 * m(0, 1), kRoot2 * m(0, 2), kRoot2 * m(1, 2);
  return v;
}

Eigen::Matrix3d to_matrix(const Vector6d& v) {
  Eigen::Matrix3d m;
  m << v[0], v[3] / kRoot2, v[4] / kRoot2,  //
      v[3] / kRoot2, v[1], v[5] / kRoot2,   //
      v[4] / kRoot2, v[5] / kRoot2, v[2];
  return m;
}

// E with G f = E to_vector(G).
Eigen::Matrix<double, 3, 6> equations(const Eigen::Vector3d& f) {
  Eigen::Matrix<double, 3, 6> e;
  e << f.x(), 0, 0, f.y() / kRoot2, f.z() / kRoot2, 0,  //
      0, f.y(), 0, f.x() / kRoot2, 0, f.z() / kRoot2,   //
      0, 0, f.z(), 0, f.x() / kRoot2, f.y() / kRoot2;
  return e;
}

// W with W S W^T = I, where S is the covariance of the error of a displacement.
Eigen::Matrix3d whitening(const Eigen::Matrix3d& compliance, const PairNoise& noise) {
  const Eigen::Matrix3d covariance =
      noise.displacement * noise.displacement * Eigen::Matrix3d::Identity() +
      noise.force * noise.force * compliance * compliance.transpose();
  return covariance.llt().matrixL().solve(Eigen::Matrix3d::Identity());
}

// Moves from the prior's mean towards G as long as the compliance stays positive semi-definite.
Eigen::Matrix3d monotone(const Eigen::Matrix3d& global, const CompliancePrior& prior,
                         const ForceField& local, const Eigen::Matrix3Xd& forces) {
  const Eigen::Matrix3d way = global - prior.mean;
  const double least = kLeastCompliance * prior.deviation;
  double part = 1;
  for (const auto& f : forces.colwise()) {
    const Eigen::Matrix3d at_mean = stiffness(local, f) + prior.mean;
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> start(at_mean);
    const Eigen::Vector3d values = start.eigenvalues().cwiseMax(least);
    const Eigen::Matrix3d root = start.eigenvectors() *
                                 values.cwiseSqrt().cwiseInverse().asDiagonal() *
                                 start.eigenvectors().transpose();
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> relative(root * way * root,
                                                                  Eigen::EigenvaluesOnly);
    const double slope = relative.eigenvalues()[0];
    if (slope < -1) part = std::min(part, -1 / slope);
  }
  return prior.mean + part * way;
}

}  // namespace

PairNoise pair_noise(const ForceSamples& samples, const FitNoise& noise) {
  constexpr double kLeast = std::numeric_limits<double>::min();
  const double length = samples.displacements.cwiseAbs().maxCoeff();
  const double size = samples.forces.cwiseAbs().maxCoeff();
  return {std::max({noise.displacement.value_or(kDisplacementNoise), kExact * length, kLeast}),
          std::max({noise.force, kExact * size, kLeast})};
}

Eigen::Matrix3d fit_global_compliance(const ForceSamples& samples, const ForceField& local,
                                      const CompliancePrior& prior, const PairNoise& noise,
                                      const Eigen::Matrix3Xd& forces) {
  const Eigen::Index count = samples.forces.cols();
  Series series{local, prior.mean};
  Eigen::MatrixXd rows(3 * count + 6, 6);
  Eigen::VectorXd target(3 * count + 6), squares(count);
  rows.bottomRows<6>() = Eigen::Matrix<double, 6, 6>::Identity() / prior.deviation;
  target.tail<6>() = to_vector(prior.mean) / prior.deviation;
  for (int round = 0; round < kReweightings; ++round) {
    for (Eigen::Index i = 0; i < count; ++i) {
      const Eigen::Vector3d f = samples.forces.col(i), d = samples.displacements.col(i);
      const Eigen::Matrix3d whiten = whitening(series.compliance(f), noise);
      rows.middleRows<3>(3 * i) = whiten * equations(f);
      target.segment<3>(3 * i) = whiten * (d - force(local, f));
      squares[i] = (whiten * (d - series.displacement(f))).squaredNorm();
    }
    const double median = palpate::median(squares);
    // Robust weights as in `WhitenedProblem`.
    const double scale = kOutlier * std::max(1.0, median / kMedianChi2);
    for (Eigen::Index i = 0; i < count; ++i) {
      const double weight = 1 / std::sqrt(1 + squares[i] / scale);
      rows.middleRows<3>(3 * i) *= weight;
      target.segment<3>(3 * i) *= weight;
    }
    series.global = to_matrix(rows.householderQr().solve(target));
  }
  return monotone(monotone(series.global, prior, local, samples.forces), prior, local, forces);
}

double chi2(const Series& series, const ForceSamples& samples, const PairNoise& noise) {
  constexpr double kParameters = 6;
  const Eigen::Index count = samples.forces.cols();
  Eigen::VectorXd squares(count);
  for (Eigen::Index i = 0; i < count; ++i) {
    const Eigen::Vector3d f = samples.forces.col(i);
    squares[i] = (whitening(series.compliance(f), noise) *
                  (samples.displacements.col(i) - series.displacement(f)))
                     .squaredNorm();
  }
  return reduced_chi2(squares, kParameters).value;
}

ForceSamples columns(const ForceSamples& samples, const std::vector<Eigen::Index>& which) {
  ForceSamples chosen = samples;
  chosen.displacements = samples.displacements(Eigen::all, which);
  chosen.forces = samples.forces(Eigen::all, which);
  chosen.kinds.clear();
  if (!samples.kinds.empty()) {
    for (const Eigen::Index i : which) {
      chosen.kinds.push_back(samples.kinds[static_cast<std::size_t>(i)]);
    }
  }
  return chosen;
}

Eigen::Matrix3Xd spread_columns(const Eigen::Matrix3Xd& all, Eigen::Index count) {
  if (all.cols() <= count) return all;
  Eigen::Matrix3Xd chosen(3, count);
  Eigen::VectorXd distance = all.colwise().squaredNorm();
  for (Eigen::Index n = 0; n < count; ++n) {
    Eigen::Index furthest = 0;
    distance.maxCoeff(&furthest);
    chosen.col(n) = all.col(furthest);
    const Eigen::VectorXd to_new =
        (all.colwise() - chosen.col(n)).colwise().squaredNorm().transpose();
    distance = n == 0 ? to_new : Eigen::VectorXd(distance.cwiseMin(to_new));
  }
  return chosen;
}

}  // namespace palpate::haptics
