// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "phase/edge_blur.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <vector>

#include "image/hot_loop.h"

namespace palpate::sensing {
namespace {

/// Variance of the phase [rad^2] by the length of the run of lit pixels between a pixel and the
/// edge, itself included; none without a run, nor for the longest, which does not reach the edge.
std::vector<float> variances(const DemodulationFilter& filter) {
  // The part of a Gaussian of 1 px that is farther than half a pixel on one side.
  const double lost = std::erfc(0.5 / std::numbers::sqrt2) / 2;
  // A full contrast, blurred by 1 px.
  const double mean_per_amplitude = std::exp(filter.carrier * filter.carrier / 2);
  std::vector<float> result{0.0F};
  double remaining = 0.5 * (1 - static_cast<double>(filter.weight[0]));  // beyond the pixel
  for (int distance = 0; distance <= filter.radius; ++distance) {
    const auto weight = static_cast<double>(filter.weight[static_cast<std::size_t>(distance)]);
    remaining += weight;
    const double share = lost * weight / remaining;
    result.push_back(
        static_cast<float>((2 * mean_per_amplitude * mean_per_amplitude + 0.5) * share * share));
  }
  result.push_back(0.0F);
  return result;
}

/// Columns far from any edge are skipped in groups of this many.
constexpr long kSkippedColumns = 16;

PALPATE_HOT_LOOP void lengthen_runs(const std::uint8_t* lit, std::uint16_t longest, long columns,
                                    std::uint16_t* __restrict run) {
  for (long i = 0; i < columns; ++i) {
    const auto longer = static_cast<std::uint16_t>(run[i] < longest ? run[i] + 1 : longest);
    run[i] = lit[i] != 0 ? longer : std::uint16_t{0};
  }
}

PALPATE_HOT_LOOP bool any_at_edge(const std::uint16_t* run, std::uint16_t longest, long count) {
  int any = 0;
  for (long i = 0; i < count; ++i) any |= (run[i] != 0) & (run[i] != longest);
  return any != 0;
}

void add_variances(const std::uint16_t* run, const std::vector<float>& variance, long columns,
                   float* sigma) {
  const auto longest = static_cast<std::uint16_t>(variance.size() - 1);
  for (long start = 0; start < columns; start += kSkippedColumns) {
    const long end = std::min(start + kSkippedColumns, columns);
    if (!any_at_edge(run + start, longest, end - start)) continue;
    for (long i = start; i < end; ++i) sigma[i] = std::sqrt(sigma[i] * sigma[i] + variance[run[i]]);
  }
}

}  // namespace

void add_edge_blur(const Mask& lit, const DemodulationFilter& filter, Plane& sigma) {
  const std::vector<float> variance = variances(filter);
  const auto longest = static_cast<std::uint16_t>(variance.size() - 1);
  const long columns = lit.cols();
  for (const bool downwards : {true, false}) {
    std::vector<std::uint16_t> run(static_cast<std::size_t>(columns), 0);
    for (long i = 0; i < lit.rows(); ++i) {
      const long row = downwards ? i : lit.rows() - 1 - i;
      lengthen_runs(&lit(row, 0), longest, columns, run.data());
      add_variances(run.data(), variance, columns, &sigma(row, 0));
    }
  }
}

}  // namespace palpate::sensing
