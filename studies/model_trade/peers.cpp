// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "peers.h"

#include <Eigen/Cholesky>
#include <Eigen/QR>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <vector>

#include "palpate/haptics/force_field.h"

namespace palpate::bench {
namespace {

Eigen::Matrix3Xd with_zero(const Eigen::Matrix3Xd& columns) {
  Eigen::Matrix3Xd result(3, columns.cols() + 1);
  result << columns, Eigen::Vector3d::Zero();
  return result;
}

// Squared distances between all pairs of columns.
Eigen::MatrixXd squared_distances(const Eigen::Matrix3Xd& points) {
  Eigen::MatrixXd result(points.cols(), points.cols());
  for (Eigen::Index i = 0; i < points.cols(); ++i) {
    result.col(i) = (points.colwise() - points.col(i)).colwise().squaredNorm();
  }
  return result;
}

// The force at a place by a linear fit to the nearest samples, weighted by their distance.
Eigen::Vector3d local_linear_fit(const Eigen::Matrix3Xd& places, const Eigen::Matrix3Xd& forces,
                                 const Eigen::Vector3d& at) {
  constexpr Eigen::Index kNeighbours = 8;  // twice the unknowns of a component
  std::vector<Eigen::Index> order(static_cast<std::size_t>(places.cols()));
  std::iota(order.begin(), order.end(), Eigen::Index{0});
  const Eigen::VectorXd distances = (places.colwise() - at).colwise().norm();
  const Eigen::Index count = std::min(kNeighbours, places.cols());
  std::partial_sort(order.begin(), order.begin() + count, order.end(),
                    [&](auto l, auto r) { return distances[l] < distances[r]; });
  const double reach = distances[order[static_cast<std::size_t>(count) - 1]];
  Eigen::MatrixXd matrix(count, 4), target(count, 3);
  for (Eigen::Index n = 0; n < count; ++n) {
    const Eigen::Index i = order[static_cast<std::size_t>(n)];
    const double weight = std::exp(-distances[i] / reach);
    matrix.row(n) << weight, weight * (places.col(i) - at).transpose();
    target.row(n) = weight * forces.col(i).transpose();
  }
  // Neighbours may lie in a plane: the least change that explains them.
  return matrix.completeOrthogonalDecomposition().solve(target).row(0);
}

double mean_nearest_distance(const Eigen::Matrix3Xd& points) {
  Eigen::MatrixXd distances = squared_distances(points);
  distances.diagonal().setConstant(std::numeric_limits<double>::infinity());
  return distances.colwise().minCoeff().cwiseSqrt().mean();
}

struct Likelihood {
  double value = -std::numeric_limits<double>::infinity();
  double length = 1;
  Eigen::VectorXd weights;
};

// One component: the likelihood with the best amplitude, which has a closed form.
Likelihood likelihood(const Eigen::MatrixXd& squared, const Eigen::VectorXd& values, double length,
                      double noise) {
  Eigen::MatrixXd kernel = (-squared / (2 * length * length)).array().exp();
  kernel.diagonal().array() += noise;
  const Eigen::LLT<Eigen::MatrixXd> factor(kernel);
  if (factor.info() != Eigen::Success) return {};
  Likelihood result{0, length, factor.solve(values)};
  const double count = static_cast<double>(values.size());
  const double amplitude =
      std::max(values.dot(result.weights) / count, std::numeric_limits<double>::min());
  const double log_determinant =
      2 * factor.matrixL().toDenseMatrix().diagonal().array().log().sum();
  result.value = -0.5 * (count * std::log(amplitude) + log_determinant);
  return result;
}

// Isotropic multiquadrics of weight 1.
std::vector<haptics::Multiquadric> isotropic_candidates(const Eigen::Matrix3Xd& places) {
  constexpr int kNodes = 11;
  constexpr std::array<double, 6> kRoundings = {0.03, 0.1, 0.25, 0.5, 1, 3};  // of the extent
  const Eigen::Vector3d low = places.rowwise().minCoeff(), high = places.rowwise().maxCoeff();
  const double extent = (high - low).maxCoeff();
  // A flat box is widened: centres beside it make stiffness across it.
  const Eigen::Vector3d half = 1.5 * (high - low).cwiseMax(extent / 3);
  const Eigen::Vector3d first = (low + high) / 2 - half;
  std::vector<haptics::Multiquadric> candidates;
  for (int node = 0; node < kNodes * kNodes * kNodes; ++node) {
    const Eigen::Vector3d step(node % kNodes, node / kNodes % kNodes, node / (kNodes * kNodes));
    for (const double rounding : kRoundings) {
      candidates.push_back(
          {1, rounding * extent, first + 2 * half.cwiseProduct(step) / (kNodes - 1)});
    }
  }
  return candidates;
}

// The weights >= 0 of the columns with the least squared error; most are zero.
Eigen::VectorXd non_negative_least_squares(const Eigen::MatrixXd& matrix,
                                           const Eigen::VectorXd& target) {
  constexpr int kMostRounds = 400;
  constexpr double kOptimal = 1e-6;  // cosine of a column to the errors that gains nothing
  Eigen::VectorXd weights = Eigen::VectorXd::Zero(matrix.cols());
  std::vector<Eigen::Index> active;
  for (int round = 0; round < kMostRounds; ++round) {
    const Eigen::VectorXd errors = target - matrix * weights;
    Eigen::Index best = 0;
    const double gain = (matrix.transpose() * errors).maxCoeff(&best);
    if (!(gain > kOptimal * errors.norm())) break;  // columns have unit length
    if (std::find(active.begin(), active.end(), best) != active.end()) break;
    active.push_back(best);
    while (!active.empty()) {
      const Eigen::VectorXd solution =
          matrix(Eigen::all, active).colPivHouseholderQr().solve(target);
      double part = 1;
      for (std::size_t k = 0; k < active.size(); ++k) {
        const double now = weights[active[k]], then = solution[static_cast<Eigen::Index>(k)];
        if (then <= 0) part = std::min(part, now > 0 ? now / (now - then) : 0.0);
      }
      for (std::size_t k = 0; k < active.size(); ++k) {
        double& weight = weights[active[k]];
        weight = std::max(0.0, weight + part * (solution[static_cast<Eigen::Index>(k)] - weight));
      }
      if (part == 1) break;
      std::erase_if(active, [&](Eigen::Index j) {
        if (weights[j] > kOptimal * weights.maxCoeff()) return false;
        weights[j] = 0;
        return true;
      });
    }
  }
  return weights;
}

}  // namespace

Predictor grid_lookup(const Eigen::Matrix3Xd& displacements, const Eigen::Matrix3Xd& forces,
                      int nodes) {
  const Eigen::Matrix3Xd places = with_zero(displacements), values = with_zero(forces);
  const Eigen::Vector3d low = places.rowwise().minCoeff(), high = places.rowwise().maxCoeff();
  const Eigen::Vector3d cell = ((high - low) / (nodes - 1)).cwiseMax(1e-9);  // [mm] a flat box
  std::vector<Eigen::Vector3d> table;
  for (int z = 0; z < nodes; ++z) {
    for (int y = 0; y < nodes; ++y) {
      for (int x = 0; x < nodes; ++x) {
        const Eigen::Vector3d at = low + cell.cwiseProduct(Eigen::Vector3d(x, y, z));
        table.push_back(local_linear_fit(places, values, at));
      }
    }
  }
  const auto force = [=](const Eigen::Vector3d& displacement) -> Eigen::Vector3d {
    const Eigen::Vector3d at =
        (displacement - low).cwiseQuotient(cell).cwiseMax(0).cwiseMin(nodes - 1);
    const Eigen::Vector3i first = at.cast<int>().cwiseMin(nodes - 2);
    const Eigen::Vector3d part = at - first.cast<double>();
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (int corner = 0; corner < 8; ++corner) {
      const Eigen::Vector3i step(corner & 1, corner >> 1 & 1, corner >> 2 & 1);
      double weight = 1;
      for (int axis = 0; axis < 3; ++axis) weight *= step[axis] ? part[axis] : 1 - part[axis];
      const Eigen::Vector3i node = first + step;
      sum += weight *
             table[static_cast<std::size_t>(node.x() + nodes * (node.y() + nodes * node.z()))];
    }
    return sum;
  };
  return {force, 3 * table.size() + 6};
}

Predictor exact_rbf(const Eigen::Matrix3Xd& displacements, const Eigen::Matrix3Xd& forces) {
  const Eigen::Matrix3Xd places = with_zero(displacements);
  const Eigen::Index count = places.cols();
  const double rounding = mean_nearest_distance(places);
  Eigen::MatrixXd matrix = Eigen::MatrixXd::Zero(count + 4, count + 4);
  matrix.topLeftCorner(count, count) =
      (squared_distances(places).array() + rounding * rounding).sqrt();
  matrix.topRightCorner(count, 1).setOnes();
  matrix.topRightCorner(count, 3) = places.transpose();
  matrix.block(0, count, count, 1).setOnes();
  matrix.bottomLeftCorner(4, count) = matrix.topRightCorner(count, 4).transpose();
  Eigen::MatrixXd target = Eigen::MatrixXd::Zero(count + 4, 3);
  target.topRows(count) = with_zero(forces).transpose();
  const Eigen::MatrixXd weights = matrix.colPivHouseholderQr().solve(target);
  const auto force = [=](const Eigen::Vector3d& displacement) -> Eigen::Vector3d {
    Eigen::VectorXd basis(count + 4);
    basis.head(count) =
        ((places.colwise() - displacement).colwise().squaredNorm().array() + rounding * rounding)
            .sqrt();
    basis.tail<4>() << 1, displacement;
    return weights.transpose() * basis;
  };
  return {force, static_cast<std::size_t>(places.size() + weights.size()) + 1};
}

Predictor gaussian_process(const Eigen::Matrix3Xd& displacements, const Eigen::Matrix3Xd& forces) {
  const Eigen::Matrix3Xd places = with_zero(displacements), values = with_zero(forces);
  const Eigen::MatrixXd squared = squared_distances(places);
  const double extent = std::sqrt(squared.maxCoeff());
  std::array<Likelihood, 3> components;
  for (std::size_t c = 0; c < components.size(); ++c) {
    // From a 30th of the extent to three times it; noise from 1e-8 to 1e-2 of the signal's power.
    for (double length = extent / 30; length < 3 * extent; length *= 1.5) {
      for (double noise = 1e-8; noise < 2e-2; noise *= 10) {
        Likelihood found = likelihood(squared, values.row(static_cast<Eigen::Index>(c)).transpose(),
                                      length, noise);
        if (found.value > components[c].value) components[c] = std::move(found);
      }
    }
  }
  const auto force = [=](const Eigen::Vector3d& displacement) -> Eigen::Vector3d {
    const Eigen::VectorXd distances =
        (places.colwise() - displacement).colwise().squaredNorm().transpose();
    Eigen::Vector3d result;
    for (std::size_t c = 0; c < components.size(); ++c) {
      const double length = components[c].length;
      result[static_cast<Eigen::Index>(c)] =
          (-distances / (2 * length * length)).array().exp().matrix().dot(components[c].weights);
    }
    return result;
  };
  return {force, static_cast<std::size_t>(2 * places.size()) + 3};
}

Predictor isotropic_only(const Eigen::Matrix3Xd& displacements, const Eigen::Matrix3Xd& forces) {
  haptics::ForceField candidates{isotropic_candidates(with_zero(displacements))};
  const auto count = static_cast<Eigen::Index>(candidates.bases.size());
  Eigen::MatrixXd matrix(forces.size(), count);
  for (Eigen::Index j = 0; j < count; ++j) {
    haptics::Multiquadric& base = candidates.bases[static_cast<std::size_t>(j)];
    for (Eigen::Index i = 0; i < forces.cols(); ++i) {
      matrix.block<3, 1>(3 * i, j) = haptics::force({{base}}, displacements.col(i));
    }
    base.weight = 1 / matrix.col(j).norm();
    matrix.col(j) *= base.weight;
  }
  const Eigen::VectorXd weights = non_negative_least_squares(matrix, forces.reshaped());
  haptics::ForceField field;
  for (Eigen::Index j = 0; j < count; ++j) {
    if (!(weights[j] > 0)) continue;
    field.bases.push_back(candidates.bases[static_cast<std::size_t>(j)]);
    field.bases.back().weight *= weights[j];
  }
  constexpr std::size_t kNumbers = 5;
  return {
      [field](const Eigen::Vector3d& displacement) { return haptics::force(field, displacement); },
      kNumbers * field.bases.size()};
}

}  // namespace palpate::bench
