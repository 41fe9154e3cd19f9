// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "image/gaussian_blur.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <vector>

#include "palpate/core/parallel_for.h"

namespace palpate::sensing {
namespace {

/// The Gaussian is truncated at this many standard deviations, where it has 4e-6 of its height.
constexpr double kBellReach = 5;

std::vector<float> bell(double sigma) {
  const double radius = std::ceil(kBellReach * sigma);
  std::vector<double> weights(static_cast<std::size_t>(2 * radius) + 1);
  for (std::size_t k = 0; k < weights.size(); ++k) {
    const double at = static_cast<double>(k) - radius;
    weights[k] = std::exp(-at * at / (2 * sigma * sigma));
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
  parallel_for(image.rows, [&](int row) {
    float* to = out.ptr<float>(row);
    for (std::size_t w = 0; w < weights.size(); ++w) {
      const int i = static_cast<int>(w) - radius;
      if (border == Border::black && (row + i < 0 || row + i >= image.rows)) continue;
      const float* from = image.ptr<float>(std::clamp(row + i, 0, image.rows - 1));
      const float weight = weights[w];
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
