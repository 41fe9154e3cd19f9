// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "measure.h"

#include <algorithm>
#include <cmath>
#include <ctime>
#include <limits>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "palpate/geometry/error_statistics.h"

namespace palpate::bench {
namespace {

/// Neighbours whose depths differ by more than this share of them stand apart: at the bundled rig's
/// focal length a surface that slopes so much is seen under 85 degrees.
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

/// Where the projector lights the points of a ray.
class LightOfRay {
 public:
  LightOfRay(const sensing::Rig& rig, sensing::Axis axis, const Eigen::Vector2d& ray)
      : rig_(rig), axis_(axis == sensing::Axis::x ? 0 : 1), ray_(ray.homogeneous()) {}

  /// Projector pixel along the sinusoid.
  [[nodiscard]] double operator()(double z) const {
    const Eigen::Vector3d place = rig_.T_projector_camera * (ray_ * z);
    const Eigen::Vector2d direction = geometry::distort(rig_.projector, place.hnormalized());
    return direction[axis_];
  }

 private:
  const sensing::Rig& rig_;
  int axis_;
  Eigen::Vector3d ray_;
};

struct Counts {
  long counted = 0, counted_away = 0, complete = 0, complete_away = 0;
  long measured = 0, measured_away = 0, off = 0, off_away = 0;
  std::vector<double> errors;  ///< relative to the distance
};

void add_view(const Scene& scene, const View& view, const geometry::ImageF& measured,
              const Eigen::Matrix2Xd& rays, Counts& counts) {
  const cv::Mat steps = near_steps(view.z);
  for (int v = 0; v < steps.rows; ++v) {
    for (int u = 0; u < steps.cols; ++u) {
      const double z = static_cast<double>(measured(v, u));
      const double truth = static_cast<double>(view.z(v, u));
      const bool away = steps.at<unsigned char>(v, u) == 0;
      const bool has_depth = std::isfinite(z);
      counts.counted += view.counted(v, u);
      counts.counted_away += view.counted(v, u) && away;
      if (!has_depth) continue;
      bool off = true;
      if (std::isfinite(truth)) {
        const LightOfRay light(scene.rig, scene.pattern.axis, rays.col(v * steps.cols + u));
        off = std::abs(light(z) - light(truth)) > scene.pattern.period / 2;
      }
      ++counts.measured;
      counts.measured_away += away;
      counts.off += off;
      counts.off_away += off && away;
      counts.complete += view.counted(v, u);
      counts.complete_away += view.counted(v, u) && away;
      if (!off && view.counted(v, u)) counts.errors.push_back((z - truth) / truth);
    }
  }
}

double percent(long part, long whole) {
  return whole > 0 ? 100 * static_cast<double>(part) / static_cast<double>(whole)
                   : std::numeric_limits<double>::quiet_NaN();
}

double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<long>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

}  // namespace

Figures measure(const Scene& scene, const sensing::DecodeOptions& options, int repeats) {
  const sensing::Decoder decoder(scene.rig, scene.pattern, scene.colors, options);
  const Eigen::Matrix2Xd rays = geometry::pixel_rays(scene.rig.camera);
  Counts counts;
  std::vector<double> times;
  sensing::DecodeResult result;
  for (const View& view : scene.views) {
    decoder.decode(view.frame, result);  // buffers and caches get warm
    add_view(scene, view, result.range.z, rays, counts);
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
          .complete = percent(counts.complete, counts.counted),
          .complete_away = percent(counts.complete_away, counts.counted_away),
          .off = percent(counts.off, counts.measured),
          .off_away = percent(counts.off_away, counts.measured_away),
          .ms = median(std::move(times))};
}

}  // namespace palpate::bench
