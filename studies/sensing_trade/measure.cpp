// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "measure.h"

#include <algorithm>
#include <cmath>
#include <ctime>
#include <limits>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "palpate/core/quantile.h"
#include "palpate/geometry/range_map_score.h"
#include "surface_detail.h"

namespace palpate::bench {
namespace {

/// Neighbours whose depths differ by more than this share of them stand apart: at the bundled rig's
/// focal length a surface of this slope is seen under 85 degrees.
constexpr double kStep = 0.01;

double thread_ms() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return 1e3 * static_cast<double>(now.tv_sec) + 1e-6 * static_cast<double>(now.tv_nsec);
}

bool apart(float a, float b) {
  if (std::isnan(a) || std::isnan(b)) return std::isnan(a) != std::isnan(b);
  return static_cast<double>(std::abs(a - b)) > kStep * static_cast<double>(std::min(a, b));
}

/// 255 at pixels within kAtStep of a depth step.
cv::Mat near_steps(const geometry::ImageF& z) {
  cv::Mat steps = cv::Mat::zeros(static_cast<int>(z.rows()), static_cast<int>(z.cols()), CV_8U);
  for (int v = 0; v < steps.rows; ++v) {
    for (int u = 0; u < steps.cols; ++u) {
      for (const auto& [v2, u2] : {std::pair(v + 1, u), std::pair(v, u + 1)}) {
        if (v2 >= steps.rows || u2 >= steps.cols || !apart(z(v, u), z(v2, u2))) continue;
        steps.at<unsigned char>(v, u) = steps.at<unsigned char>(v2, u2) = 255;
      }
    }
  }
  const int side = 2 * kAtStep - 1;  // the pixels beside a step are marked already
  cv::dilate(steps, steps, cv::Mat::ones(side, side, CV_8U));
  return steps;
}

struct Counts {
  long measurable = 0, covered = 0, measured = 0, wrong = 0;
  long measurable_away = 0, covered_away = 0, measured_away = 0, wrong_away = 0;
  std::vector<double> errors;  ///< relative to the distance
  std::vector<double> scores;  ///< relative to the predicted deviation
  SurfaceDetail detail;
};

void add_view(const Scene& scene, const View& view, const sensing::DecodeResult& result,
              Counts& counts) {
  const geometry::ImageF& measured = result.range.z;
  const geometry::RangeMapScore score = geometry::score_range_map(measured, view.z, view.counted);
  counts.measurable += score.measurable;
  counts.covered += score.covered;
  counts.measured += score.measured;
  counts.wrong += score.wrong;
  counts.detail.add(scene, view, score.difference);
  const cv::Mat steps = near_steps(view.z);
  for (int v = 0; v < steps.rows; ++v) {
    for (int u = 0; u < steps.cols; ++u) {
      const bool has_depth = std::isfinite(measured(v, u));
      if (std::isfinite(score.difference(v, u))) {
        counts.errors.push_back(static_cast<double>(score.difference(v, u)) /
                                static_cast<double>(view.z(v, u)));
        counts.scores.push_back(static_cast<double>(score.difference(v, u) / result.sigma(v, u)));
      }
      if (steps.at<unsigned char>(v, u) != 0) continue;
      const bool measurable = view.counted(v, u) && std::isfinite(view.z(v, u));
      counts.measurable_away += measurable;
      counts.covered_away += measurable && has_depth;
      counts.measured_away += has_depth;
      counts.wrong_away += score.wrong_pixels(v, u);
    }
  }
}

double percent(long part, long whole) {
  return whole > 0 ? 100 * static_cast<double>(part) / static_cast<double>(whole)
                   : std::numeric_limits<double>::quiet_NaN();
}

}  // namespace

Figures measure(const Scene& scene, const sensing::DecodeOptions& options, int repeats) {
  const sensing::Decoder decoder(scene.rig, scene.pattern, scene.colors, options);
  Counts counts;
  std::vector<double> times;
  sensing::DecodeResult result;
  for (const View& view : scene.views) {
    decoder.decode(view.frame, result);  // buffers and caches get warm
    add_view(scene, view, result, counts);
    double least = std::numeric_limits<double>::infinity();
    for (int i = 0; i < repeats; ++i) {
      const double start = thread_ms();
      decoder.decode(view.frame, result);
      least = std::min(least, thread_ms() - start);
    }
    times.push_back(least);
  }
  const geometry::ErrorStatistics error = geometry::error_statistics(std::move(counts.errors));
  return {.median = 100 * error.median,
          .rms = 100 * error.rms,
          .coverage = percent(counts.covered, counts.measurable),
          .coverage_away = percent(counts.covered_away, counts.measurable_away),
          .wrong = percent(counts.wrong, counts.measured),
          .wrong_away = percent(counts.wrong_away, counts.measured_away),
          .score = geometry::error_statistics(std::move(counts.scores)).rms,
          .ripple = counts.detail.ripple(),
          .normals = counts.detail.normals(),
          .ms = median(times)};
}

}  // namespace palpate::bench
