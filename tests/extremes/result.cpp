// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "result.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "palpate/core/error.h"

namespace palpate::extremes {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

bool same(double left, double right) {
  return left == right || (std::isnan(left) && std::isnan(right));
}

/// Adds how a result agrees with what it must be.
/// \param scale to which differences are relative.
void add(Agreement& all, const Result& must_be, const Eigen::MatrixXd& expected,
         const Result& found, double scale, double allowed) {
  if (must_be.name != found.name) throw std::logic_error(found.name + " is not " + must_be.name);
  double difference = 0;
  bool exact = true;
  if (expected.rows() != found.values.rows() || expected.cols() != found.values.cols()) {
    difference = kInfinity;
    exact = false;
  } else {
    for (Eigen::Index i = 0; i < expected.size(); ++i) {
      const double left = expected.reshaped()[i], right = found.values.reshaped()[i];
      if (same(left, right)) continue;
      exact = false;
      const double apart = std::abs(left - right) / (scale > 0 ? scale : 1);
      difference = std::isfinite(apart) ? std::max(difference, apart) : kInfinity;
    }
  }
  all.exact = all.exact && exact;
  const double over = difference == 0 ? 0 : difference / allowed;
  if (over > all.over_allowed || (over > 0 && all.worst.empty())) {
    all.over_allowed = over;
    all.worst = must_be.name;
  }
  all.difference = std::max(all.difference, difference);
}

double largest(const Eigen::MatrixXd& values) {
  double most = 0;
  for (const double value : values.reshaped())
    if (std::isfinite(value)) most = std::max(most, std::abs(value));
  return most;
}

void require_same_count(const Results& left, const Results& right) {
  if (left.size() != right.size()) throw std::logic_error("another number of results");
}

}  // namespace

double size_of(const Input& input) { return geometry::bounding_diagonal(input.sheet); }

Agreement compare_scaled(const Results& standard, const Results& scaled, const Input& input) {
  require_same_count(standard, scaled);
  Agreement all;
  for (std::size_t i = 0; i < standard.size(); ++i) {
    const Result& was = standard[i];
    const Eigen::MatrixXd expected = was.values * std::pow(input.length, was.kind.length) *
                                     std::pow(input.force, was.kind.force);
    add(all, was, expected, scaled[i], largest(expected), was.tolerance);
  }
  return all;
}

Agreement compare_moved(const Results& standard, const Results& moved, const Input& input,
                        double rounding) {
  require_same_count(standard, moved);
  Agreement all;
  for (std::size_t i = 0; i < standard.size(); ++i) {
    const Result& was = standard[i];
    Eigen::MatrixXd expected = was.values;
    if (was.motion == Motion::place)
      expected = input.place * Eigen::Matrix3Xd(was.values);
    else if (was.motion == Motion::vector)
      expected = input.place.linear() * was.values;
    if (was.elements != nullptr && !(input.order.*was.elements).empty()) {
      const std::vector<int>& to = input.order.*was.elements;
      const Eigen::MatrixXd in_standard_order = expected;
      for (Eigen::Index k = 0; k < expected.cols(); ++k)
        expected.col(to[static_cast<std::size_t>(k)]) = in_standard_order.col(k);
    }
    const double scale = was.motion == Motion::place ? size_of(input) : largest(was.values);
    add(all, was, expected, moved[i], scale, was.tolerance + rounding);
  }
  return all;
}

std::string not_finite(const Results& results) {
  for (const Result& result : results) {
    if (result.may_be_unknown || result.values.allFinite()) continue;
    for (Eigen::Index i = 0; i < result.values.size(); ++i) {
      const double value = result.values.reshaped()[i];
      if (!std::isfinite(value)) return fmt::format("{} {} is {}", result.name, i, value);
    }
  }
  return {};
}

}  // namespace palpate::extremes
