// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "gaussian_blur.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <vector>

namespace palpate::sensing {
namespace {

/// The bell is cut off at this many standard deviations, where it has 4e-6 of its height.
constexpr double kReach = 5;

std::vector<float> bell(double sigma) {
  const int radius = static_cast<int>(std::ceil(kReach * sigma));
  std::vector<double> weights(static_cast<std::size_t>(2 * radius) + 1);
  for (int i = -radius; i <= radius; ++i) {
    weights[static_cast<std::size_t>(i + radius)] = std::exp(-i * i / (2 * sigma * sigma));
  }
  const double sum = std::accumulate(weights.begin(), weights.end(), 0.0);
  std::vector<float> normalized(weights.size());
  std::transform(weights.begin(), weights.end(), normalized.begin(),
                 [sum](double w) { return static_cast<float>(w / sum); });
  return normalized;
}

/// The rows of `image` blurred along its columns: out(r) = sum of weights(i) in(r + i - radius).
cv::Mat blur_columns(const cv::Mat& image, const std::vector<float>& weights, Border border) {
  const int radius = static_cast<int>(weights.size() / 2);
  const int length = image.cols * image.channels();
  cv::Mat out(image.size(), image.type(), cv::Scalar::all(0));
  tbb::parallel_for(0, image.rows, [&](int row) {
    float* to = out.ptr<float>(row);
    for (int i = -radius; i <= radius; ++i) {
      if (border == Border::black && (row + i < 0 || row + i >= image.rows)) continue;
      const float* from = image.ptr<float>(std::clamp(row + i, 0, image.rows - 1));
      const float weight = weights[static_cast<std::size_t>(i + radius)];
      for (int k = 0; k < length; ++k) to[k] += weight * from[k];
    }
  });
  return out;
}

}  // namespace

cv::Mat gaussian_blur(const cv::Mat& image, double sigma, Border border) {
  if (!(sigma > 0)) return image.clone();
  const std::vector<float> weights = bell(sigma);
  const cv::Mat turned = blur_columns(image, weights, border).t();
  return blur_columns(turned, weights, border).t();
}

}  // namespace palpate::sensing
