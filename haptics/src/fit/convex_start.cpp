// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "fit/convex_start.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>

namespace palpate::haptics {
namespace {

// Candidates: epsilons in octaves around the prior of `refine`, in units of the data's extent, and
// the quantiles of the displacements at which ridges are placed.
constexpr std::array<double, 4> kEpsilons = {0.2, 0.4, 0.8, 1.6};
constexpr std::array<double, 7> kQuantiles = {0, 0.1, 0.25, 0.5, 0.75, 0.9, 1};
// Ridges are also placed beyond the samples on both sides, by this fraction of the samples' width.
constexpr double kBeyond = 0.5;
constexpr std::array<double, 3> kMultiples = {1, -1, 2};
constexpr std::size_t kMaxDirections = 24;
constexpr std::size_t kCenters = 8;
// Samples closer to zero than this, in units of the extent, give no direction.
constexpr double kShortestSample = 0.05;
// Directions with a larger |cosine| count as the same: 6 degrees.
constexpr double kSameDirectionCosine = 0.995;
// Largest number of candidates with a weight, and the least gain in squared whitened error by one
// candidate: that expected from fitting one parameter to noise.
constexpr Eigen::Index kMaxActive = 30;
constexpr double kWorthwhile = 1;
// Limit of the rounds, each of which adds one candidate and may remove others. Lawson and Hanson
// suggest three times the number of columns.
constexpr int kMaxLeastSquaresRounds = 3 * kMaxActive;
// Relative regularisation of the normal equations, because neighbouring candidates are nearly
// parallel.
constexpr double kRegularisation = 1e-9;

// Principal axes of the displacements, the forces and their product. They rotate with the frame.
std::vector<Eigen::Vector3d> principal_directions(const WhitenedProblem& problem) {
  const Eigen::Matrix3Xd &x = problem.displacements(), &f = problem.forces();
  const std::array<Eigen::Matrix3d, 3> moments = {x * x.transpose(), f * f.transpose(),
                                                  x * f.transpose() + f * x.transpose()};
  std::vector<Eigen::Vector3d> result;
  for (const Eigen::Matrix3d& moment : moments) {
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(moment);
    for (int axis = 0; axis < 3; ++axis) result.emplace_back(eigen.eigenvectors().col(axis));
  }
  return result;
}

// Adds directions of samples to the principal ones by farthest-point sampling.
std::vector<Eigen::Vector3d> spread_directions(const WhitenedProblem& problem) {
  std::vector<Eigen::Vector3d> pool;
  const Eigen::Vector3d mean = problem.displacements().rowwise().mean();
  const auto offer = [&](const Eigen::Vector3d& v) {
    if (v.norm() > kShortestSample) pool.push_back(v.normalized());
  };
  for (Eigen::Index i = 0; i < problem.size(); ++i) {
    offer(problem.displacements().col(i));
    offer(problem.displacements().col(i) - mean);
    offer(problem.forces().col(i));
  }
  std::vector<Eigen::Vector3d> result = principal_directions(problem);
  std::vector<double> nearness(pool.size(), 0.0);
  std::size_t seen = 0;
  while (!pool.empty()) {
    for (; seen < result.size(); ++seen) {
      for (std::size_t j = 0; j < pool.size(); ++j) {
        nearness[j] = std::max(nearness[j], std::abs(result[seen].dot(pool[j])));
      }
    }
    const auto furthest = std::min_element(nearness.begin(), nearness.end());
    if (result.size() >= kMaxDirections || *furthest > kSameDirectionCosine) break;
    result.push_back(pool[static_cast<std::size_t>(furthest - nearness.begin())]);
  }
  return result;
}

// Farthest-point sampling of the displacements, starting from zero.
std::vector<Eigen::Vector3d> spread_places(const Eigen::Matrix3Xd& displacements) {
  std::vector<Eigen::Vector3d> result;
  Eigen::VectorXd distance = displacements.colwise().norm();
  while (result.size() < kCenters) {
    Eigen::Index furthest = 0;
    if (!(distance.maxCoeff(&furthest) > kShortestSample)) break;
    result.emplace_back(displacements.col(furthest));
    const Eigen::VectorXd to_new =
        (displacements.colwise() - result.back()).colwise().norm().transpose();
    distance = distance.cwiseMin(to_new);
  }
  return result;
}

std::vector<double> ridge_offsets(Eigen::VectorXd along) {
  std::sort(along.begin(), along.end());
  const Eigen::Index last = along.size() - 1;
  const double low = along[0], high = along[last];
  std::vector<double> result = {0, low - kBeyond * (high - low), high + kBeyond * (high - low)};
  for (const double quantile : kQuantiles) {
    // Interpolate between samples, so that the opposite direction gives the same offsets.
    const double place = quantile * static_cast<double>(last);
    const auto below = static_cast<Eigen::Index>(place);
    const double part = place - static_cast<double>(below);
    result.push_back((1 - part) * along[below] + part * along[std::min(below + 1, last)]);
  }
  return result;
}

// All candidates with weight 1. Ridges of one direction are neighbours, because their whitened
// forces are the same vectors times a scalar h per sample.
class Dictionary {
 public:
  explicit Dictionary(const WhitenedProblem& problem) : problem_(problem) {
    for (const Eigen::Vector3d& direction : spread_directions(problem)) add_ridges(direction);
    profiles_.conservativeResize(Eigen::NoChange, static_cast<Eigen::Index>(bases_.size()));
    add_isotropic(Eigen::Vector3d::Zero());
    for (const Eigen::Vector3d& place : spread_places(problem.displacements())) {
      for (const double multiple : kMultiples) add_isotropic(multiple * place);
    }
    isotropic_.conservativeResize(Eigen::NoChange, isotropic_count());
    lengths_.conservativeResize(size());
    for (Eigen::Index j = 0; j < isotropic_count(); ++j) {
      lengths_[profiles_.cols() + j] = isotropic_.col(j).norm();
    }
  }

  [[nodiscard]] Eigen::Index size() const { return static_cast<Eigen::Index>(bases_.size()); }
  [[nodiscard]] const Multiquadric& base(Eigen::Index j) const {
    return bases_[static_cast<std::size_t>(j)];
  }
  /// Whitened forces of a candidate, 3 N.
  [[nodiscard]] Eigen::VectorXd column(Eigen::Index j) const {
    if (j >= profiles_.cols()) return isotropic_.col(j - profiles_.cols());
    Eigen::VectorXd result(3 * problem_.size());
    for (Eigen::Index i = 0; i < problem_.size(); ++i) {
      result.segment<3>(3 * i) = profiles_(i, j) * (problem_.whitening(i) * base(j).ridge);
    }
    return result;
  }
  /// The candidate with the largest normalised product with some whitened errors; -1 if none is
  /// positive.
  [[nodiscard]] Eigen::Index best(const Eigen::VectorXd& errors) const {
    Eigen::VectorXd gains(size());
    Eigen::Matrix3Xd pulls(3, problem_.size());
    for (Eigen::Index i = 0; i < problem_.size(); ++i) {
      pulls.col(i) = problem_.whitening(i).transpose() * errors.segment<3>(3 * i);
    }
    for (Eigen::Index j = 0; j < profiles_.cols(); j += per_direction_) {
      gains.segment(j, per_direction_) =
          profiles_.middleCols(j, per_direction_).transpose() * (pulls.transpose() * base(j).ridge);
    }
    gains.tail(isotropic_count()) = isotropic_.transpose() * errors;
    gains = (lengths_.array() > 0).select(gains.cwiseQuotient(lengths_), 0);
    Eigen::Index result = 0;
    return gains.maxCoeff(&result) > 0 ? result : -1;
  }

 private:
  [[nodiscard]] Eigen::Index isotropic_count() const { return size() - profiles_.cols(); }

  void add_ridges(const Eigen::Vector3d& direction) {
    const Eigen::VectorXd along = problem_.displacements().transpose() * direction;
    Eigen::VectorXd squares(problem_.size());
    for (Eigen::Index i = 0; i < problem_.size(); ++i) {
      squares[i] = (problem_.whitening(i) * direction).squaredNorm();
    }
    const std::vector<double> offsets = ridge_offsets(along);
    per_direction_ = static_cast<Eigen::Index>(offsets.size() * kEpsilons.size());
    reserve(profiles_, problem_.size(), size() + per_direction_);
    lengths_.conservativeResize(size() + per_direction_);
    for (const double offset : offsets) {
      for (const double epsilon : kEpsilons) {
        const Eigen::ArrayXd d = along.array() - offset;
        const double at_zero = offset / std::sqrt(offset * offset + epsilon * epsilon);
        auto profile = profiles_.col(size());
        profile = d / (d.square() + epsilon * epsilon).sqrt() + at_zero;
        lengths_[size()] = std::sqrt(profile.cwiseAbs2().dot(squares));
        bases_.push_back({1, epsilon, offset * direction, direction});
      }
    }
  }

  void add_isotropic(const Eigen::Vector3d& center) {
    for (const double epsilon : kEpsilons) {
      const ForceField one{{{1, epsilon, center}}};
      reserve(isotropic_, 3 * problem_.size(), isotropic_count() + 1);
      for (Eigen::Index i = 0; i < problem_.size(); ++i) {
        isotropic_.col(isotropic_count()).segment<3>(3 * i) =
            problem_.whitening(i) * force(one, problem_.displacements().col(i));
      }
      bases_.push_back({1, epsilon, center});
    }
  }

  // Doubles the number of columns when they do not suffice.
  static void reserve(Eigen::MatrixXd& matrix, Eigen::Index rows, Eigen::Index columns) {
    if (matrix.cols() < columns) {
      matrix.conservativeResize(rows, std::max(columns, 2 * matrix.cols()));
    }
  }

  const WhitenedProblem& problem_;
  std::vector<Multiquadric> bases_;
  Eigen::MatrixXd profiles_;   // N x ridges
  Eigen::MatrixXd isotropic_;  // 3 N x isotropic
  Eigen::VectorXd lengths_;    // of all columns
  Eigen::Index per_direction_ = 1;
};

// Non-negative least squares over chosen columns of a dictionary, which are added one by one.
class ActiveSet {
 public:
  explicit ActiveSet(Eigen::VectorXd target)
      : target_(std::move(target)),
        columns_(target_.size(), kMaxActive),
        gram_(kMaxActive, kMaxActive),
        products_(kMaxActive) {}

  [[nodiscard]] Eigen::Index size() const { return static_cast<Eigen::Index>(chosen_.size()); }
  [[nodiscard]] const std::vector<Eigen::Index>& chosen() const { return chosen_; }
  [[nodiscard]] const Eigen::VectorXd& weights() const { return weights_; }
  [[nodiscard]] Eigen::VectorXd errors() const {
    return target_ - columns_.leftCols(size()) * weights_;
  }

  void add(Eigen::Index candidate, const Eigen::VectorXd& column) {
    const Eigen::Index at = size();
    columns_.col(at) = column;
    gram_.col(at).head(at + 1) = columns_.leftCols(at + 1).transpose() * column;
    gram_.row(at).head(at + 1) = gram_.col(at).head(at + 1);
    products_[at] = column.dot(target_);
    chosen_.push_back(candidate);
    weights_.conservativeResize(at + 1);
    weights_[at] = 0;
    solve();
  }

  /// Removes the column that the others replace best and adjusts their weights. Weights that would
  /// become negative are set to zero.
  void remove_least() {
    const Eigen::MatrixXd inverse =
        normal_matrix().llt().solve(Eigen::MatrixXd::Identity(size(), size()));
    Eigen::Index least = 0;
    weights_.cwiseAbs2().cwiseQuotient(inverse.diagonal()).minCoeff(&least);
    weights_ -= inverse.col(least) * (weights_[least] / inverse(least, least));
    weights_ = weights_.cwiseMax(0);
    remove(least);
  }

 private:
  [[nodiscard]] Eigen::MatrixXd normal_matrix() const {
    Eigen::MatrixXd result = gram_.topLeftCorner(size(), size());
    result.diagonal() *= 1 + kRegularisation;
    return result;
  }

  // Moves from the weights towards the least-squares solution until a weight reaches zero and
  // removes that column, until the solution is positive.
  void solve() {
    while (size() > 0) {
      const Eigen::VectorXd solution = normal_matrix().llt().solve(products_.head(size()));
      if (solution.minCoeff() > 0) {
        weights_ = solution;
        return;
      }
      double part = 1;
      Eigen::Index first = -1;
      for (Eigen::Index k = 0; k < size(); ++k) {
        if (solution[k] > 0) continue;
        const double span = weights_[k] - solution[k];
        const double until = span > 0 ? weights_[k] / span : 0;
        if (first < 0 || until < part) {
          part = until;
          first = k;
        }
      }
      // This happens only if some entries are NaN.
      if (first < 0) return;
      weights_ += part * (solution - weights_);
      remove(first);
    }
  }

  void remove(Eigen::Index at) {
    for (Eigen::Index k = at; k + 1 < size(); ++k) {
      columns_.col(k) = columns_.col(k + 1);
      products_[k] = products_[k + 1];
      weights_[k] = weights_[k + 1];
      gram_.col(k).head(size()) = gram_.col(k + 1).head(size()).eval();
    }
    for (Eigen::Index k = at; k + 1 < size(); ++k) {
      gram_.row(k).head(size()) = gram_.row(k + 1).head(size()).eval();
    }
    chosen_.erase(chosen_.begin() + at);
    weights_.conservativeResize(size());
  }

  Eigen::VectorXd target_;
  Eigen::MatrixXd columns_, gram_;
  Eigen::VectorXd products_, weights_;
  std::vector<Eigen::Index> chosen_;
};

}  // namespace

ForceField convex_start(const WhitenedProblem& problem, int max_bases) {
  const Dictionary dictionary(problem);
  // The residuals without a field are minus the target.
  const Eigen::VectorXd target = -problem.residuals({});
  ActiveSet active(target);
  double squares = target.squaredNorm();
  for (int round = 0; round < kMaxLeastSquaresRounds && active.size() < kMaxActive; ++round) {
    const Eigen::VectorXd errors = active.size() > 0 ? active.errors() : target;
    const Eigen::Index best = dictionary.best(errors);
    const std::vector<Eigen::Index>& chosen = active.chosen();
    if (best < 0 || std::find(chosen.begin(), chosen.end(), best) != chosen.end()) break;
    active.add(best, dictionary.column(best));
    const double next = active.errors().squaredNorm();
    if (!(squares - next > kWorthwhile)) break;
    squares = next;
  }
  while (active.size() > std::max(1, max_bases)) active.remove_least();
  ForceField field;
  for (Eigen::Index k = 0; k < active.size(); ++k) {
    if (!(active.weights()[k] > 0)) continue;
    field.bases.push_back(dictionary.base(active.chosen()[static_cast<std::size_t>(k)]));
    field.bases.back().weight = active.weights()[k];
  }
  return field;
}

}  // namespace palpate::haptics
