// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/geometry/range_map_score.h"

#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "palpate/error.h"
#include "palpate/require.h"

namespace palpate::geometry {
namespace {

void check_same_size(const char* function, Eigen::Index rows, Eigen::Index cols,
                     const ImageF& reference) {
  if (rows == reference.rows() && cols == reference.cols()) return;
  throw InvalidInput(std::string(function) + ": the maps have different sizes, " +
                     std::to_string(cols) + " x " + std::to_string(rows) + " and " +
                     std::to_string(reference.cols()) + " x " + std::to_string(reference.rows()) +
                     " pixels. Compare maps of one camera.");
}

}  // namespace

ImageF depth_difference(const ImageF& measured, const ImageF& reference) {
  check_same_size("depth_difference()", measured.rows(), measured.cols(), reference);
  return measured - reference;
}

RangeMapScore score_range_map(
    const ImageF& measured, const ImageF& truth,
    const Eigen::Ref<const Eigen::Array<bool, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>>&
        measurable,
    double max_error) {
  check_same_size("score_range_map()", measured.rows(), measured.cols(), truth);
  check_same_size("score_range_map()", measurable.rows(), measurable.cols(), truth);
  require("score_range_map(): max_error", max_error, above(0), "mm");
  std::vector<double> errors, distances;
  long known = 0, wrong = 0, found = 0, wanted = 0;
  for (Eigen::Index i = 0; i < truth.size(); ++i) {
    const bool has_depth = std::isfinite(measured.data()[i]);
    const bool has_truth = std::isfinite(truth.data()[i]);
    const double error =
        static_cast<double>(measured.data()[i]) - static_cast<double>(truth.data()[i]);
    if (has_depth) {
      ++known;
      if (!has_truth || std::abs(error) > max_error) ++wrong;
      if (has_truth) {
        errors.push_back(error);
        distances.push_back(static_cast<double>(truth.data()[i]));
      }
    }
    if (measurable(i / truth.cols(), i % truth.cols())) {
      ++wanted;
      if (has_depth) ++found;
    }
  }
  return {.error = error_statistics(std::move(errors)),
          .distance = error_statistics(std::move(distances)).median,
          .reconstructed = static_cast<double>(found) / static_cast<double>(wanted),
          .wrong = static_cast<double>(wrong) / static_cast<double>(known)};
}

}  // namespace palpate::geometry
