// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/probing/stiffness_process.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "palpate/core/error.h"
#include "palpate/core/quantile.h"
#include "palpate/core/require.h"

namespace palpate::probing {
namespace {

constexpr Eigen::Index kFewestPlaces = 3;  // a mean, an amplitude and a length are learnt
/// The grid of lengths, relative to the median distance of a contact to the nearest one, and of
/// amplitudes: factors of two. A shorter length could not be told from noise, a longer one is a
/// slope.
constexpr double kShortestScale = 0.5, kLongestScale = 16;
constexpr double kLeastAmplitude = 0.01, kMostAmplitude = 2;
/// Keeps the factor positive definite, relative to the squared amplitude.
constexpr double kRidge = 1e-8;

double matern_five_halves(double distance) {
  const double a = std::sqrt(5.0) * distance;
  return (1 + a + a * a / 3) * std::exp(-a);
}

// [mm] median of the distances to the nearest other place
double typical_spacing(const Eigen::Matrix3Xd& places) {
  std::vector<double> nearest;
  for (Eigen::Index i = 0; i < places.cols(); ++i) {
    Eigen::VectorXd distances = (places.colwise() - places.col(i)).colwise().norm();
    distances(i) = std::numeric_limits<double>::infinity();
    nearest.push_back(distances.minCoeff());
    if (!(nearest.back() > 0)) {
      throw InvalidInput("StiffnessProcess: contact " + std::to_string(i) +
                         " is at the place of another one; give each place once");
    }
  }
  return median(nearest);
}

}  // namespace

StiffnessProcess::StiffnessProcess(std::span<const ContactStiffness> contacts) {
  const auto count = static_cast<Eigen::Index>(contacts.size());
  if (count < kFewestPlaces)
    throw InvalidInput("StiffnessProcess: there are " + std::to_string(count) +
                       " contacts; give at least three");
  places_.resize(3, count);
  logarithms_.resize(count);
  noise_.resize(count);
  for (Eigen::Index i = 0; i < count; ++i) {
    const ContactStiffness& contact = contacts[static_cast<std::size_t>(i)];
    if (!contact.position.allFinite())
      throw InvalidInput("StiffnessProcess: the position of contact " + std::to_string(i) +
                         " is not finite");
    require("ContactStiffness::stiffness", contact.stiffness, above(0).finite(), "N/mm");
    require("ContactStiffness::deviation", contact.deviation, above(0).finite(), "N/mm");
    places_.col(i) = contact.position;
    logarithms_(i) = std::log(contact.stiffness);
    noise_(i) = contact.deviation / contact.stiffness;
  }
  const double spacing = typical_spacing(places_);
  double best = std::numeric_limits<double>::infinity(), length = 0, amplitude = 0;
  for (double scale = kShortestScale; scale <= kLongestScale; scale *= 2) {
    for (double size = kMostAmplitude; size >= kLeastAmplitude; size /= 2) {
      const double unlikely = fit(scale * spacing, size);
      if (unlikely >= best) continue;
      best = unlikely;
      length = scale * spacing;
      amplitude = size;
    }
  }
  fit(length, amplitude);
}

// Returns the negative logarithm of the likelihood, with the unknown mean integrated out.
double StiffnessProcess::fit(double length, double amplitude) {
  length_ = length;
  amplitude_ = amplitude;
  const Eigen::Index count = places_.cols();
  const double square = amplitude * amplitude;
  Eigen::MatrixXd matrix(count, count);
  for (Eigen::Index i = 0; i < count; ++i) {
    for (Eigen::Index j = 0; j <= i; ++j) {
      matrix(i, j) = matrix(j, i) =
          square * matern_five_halves((places_.col(i) - places_.col(j)).norm() / length);
    }
    matrix(i, i) += noise_(i) * noise_(i) + kRidge * square;
  }
  factor_.compute(matrix);
  ones_ = factor_.solve(Eigen::VectorXd::Ones(count));
  sum_ = ones_.sum();
  mean_ = ones_.dot(logarithms_) / sum_;
  const Eigen::VectorXd rest = logarithms_.array() - mean_;
  weights_ = factor_.solve(rest);
  const Eigen::MatrixXd lower = factor_.matrixL();
  return lower.diagonal().array().log().sum() + (std::log(sum_) + rest.dot(weights_)) / 2;
}

ContactStiffness StiffnessProcess::predict(const Eigen::Vector3d& place) const {
  const Eigen::VectorXd to_place = amplitude_ * amplitude_ *
                                   ((places_.colwise() - place).colwise().norm() / length_)
                                       .transpose()
                                       .unaryExpr(&matern_five_halves);
  const double lack = 1 - ones_.dot(to_place);
  const double variance =
      amplitude_ * amplitude_ - to_place.dot(factor_.solve(to_place)) + lack * lack / sum_;
  const double stiffness = std::exp(mean_ + to_place.dot(weights_));
  return {place, stiffness, stiffness * std::sqrt(std::max(variance, 0.0))};
}

}  // namespace palpate::probing
