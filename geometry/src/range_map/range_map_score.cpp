// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/geometry/range_map_score.h"

#include <cmath>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "palpate/core/error.h"

namespace palpate::geometry {
namespace {

void check_same_size(const char* name, Eigen::Index rows, Eigen::Index cols, const ImageF& truth) {
  if (rows == truth.rows() && cols == truth.cols()) return;
  throw InvalidInput("score_range_map(): the " + std::string(name) + " has " +
                     std::to_string(cols) + " x " + std::to_string(rows) +
                     " pixels and the truth " + std::to_string(truth.cols()) + " x " +
                     std::to_string(truth.rows()) + ". Compare images of one camera.");
}

/// NaN if the whole is nothing.
double share(long part, long whole) {
  return whole > 0 ? static_cast<double>(part) / static_cast<double>(whole)
                   : std::numeric_limits<double>::quiet_NaN();
}

}  // namespace

RangeMapScore score_range_map(const ImageF& measured, const ImageF& truth,
                              const PixelMask& measurable) {
  check_same_size("measured map", measured.rows(), measured.cols(), truth);
  check_same_size("mask", measurable.rows(), measurable.cols(), truth);
  RangeMapScore score;
  score.difference.setConstant(truth.rows(), truth.cols(), std::numeric_limits<float>::quiet_NaN());
  score.wrong_pixels.setConstant(truth.rows(), truth.cols(), false);
  std::vector<double> errors, relative_errors, distances;
  for (Eigen::Index i = 0; i < truth.size(); ++i) {
    const auto true_depth = static_cast<double>(truth.data()[i]);
    const bool has_depth = std::isfinite(measured.data()[i]);
    const bool has_truth = std::isfinite(true_depth);
    if (has_truth) {
      distances.push_back(true_depth);
      const bool counts = measurable.data()[i];
      score.measurable += counts;
      score.covered += counts && has_depth;
    }
    if (!has_depth) continue;
    ++score.measured;
    const double error = static_cast<double>(measured.data()[i]) - true_depth;
    if (!has_truth || std::abs(error) > kWrongDepth * true_depth) {
      ++score.wrong;
      score.wrong_pixels.data()[i] = true;
      continue;
    }
    errors.push_back(error);
    relative_errors.push_back(error / true_depth);
    score.difference.data()[i] = static_cast<float>(error);
  }
  score.coverage = share(score.covered, score.measurable);
  score.wrong_share = share(score.wrong, score.measured);
  score.error = error_statistics(std::move(errors));
  score.relative_error = error_statistics(std::move(relative_errors));
  score.distance = error_statistics(std::move(distances)).median;
  return score;
}

RangeMapScore score_range_map(const ImageF& measured, const ImageF& truth) {
  return score_range_map(measured, truth, PixelMask::Constant(truth.rows(), truth.cols(), true));
}

}  // namespace palpate::geometry
