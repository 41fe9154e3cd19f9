// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "simulation/camera_electronics.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <opencv2/imgproc.hpp>

#include "palpate/core/parallel_for.h"

namespace palpate::sensing {
namespace {

/// Below this many electrons their number is drawn from a Poisson distribution; above, where its
/// skewness is below 0.13, from a normal distribution.
constexpr double kFewElectrons = 64;

/// The finaliser of SplitMix64 (Steele, Lea and Flood 2014): random bits out of a counter.
std::uint64_t mix(std::uint64_t bits) {
  bits += 0x9e3779b97f4a7c15;
  bits = (bits ^ (bits >> 30)) * 0xbf58476d1ce4e5b9;
  bits = (bits ^ (bits >> 27)) * 0x94d049bb133111eb;
  return bits ^ (bits >> 31);
}

/// In (0, 1).
double uniform(std::uint64_t bits) { return (static_cast<double>(bits >> 12) + 0.5) * 0x1p-52; }

/// The number k with P(<= k - 1) < u <= P(<= k).
double poisson(double mean, double u) {
  double probability = std::exp(-mean), cumulated = probability;
  double k = 0;
  while (u > cumulated && probability > 0) {
    ++k;
    probability *= mean / k;
    cumulated += probability;
  }
  return k;
}

/// Electrons of one measurement; `site` differs for each measurement.
double electrons(double mean, double read_noise, std::uint64_t key, std::uint64_t site) {
  const std::uint64_t start = key + 4 * site;
  // Box and Muller: two independent normal numbers.
  const double radius = std::sqrt(-2 * std::log(uniform(mix(start))));
  const double angle = 2 * std::numbers::pi * uniform(mix(start + 1));
  const double shot = mean < kFewElectrons ? poisson(mean, uniform(mix(start + 2)))
                                           : mean + std::sqrt(mean) * radius * std::cos(angle);
  return shot + read_noise * radius * std::sin(angle);
}

/// Values that the pixels measure, in full scales; `channel_of` selects the channel of `light`.
cv::Mat measure(const cv::Mat& light, double exposure, const VirtualSensor& sensor,
                std::uint64_t frame_number) {
  const bool mosaic = sensor.readout != Readout::color;
  const int channels = mosaic ? 1 : 3;
  const std::uint64_t key = mix(mix(sensor.seed) ^ frame_number);
  cv::Mat measured(light.size(), CV_32FC(channels));
  parallel_for(light.rows, [&](int row) {
    const float* from = light.ptr<float>(row);
    float* to = measured.ptr<float>(row);
    for (int i = 0; i < channels * light.cols; ++i) {
      // RGGB: red where row and column are even, blue where both are odd.
      const int at = mosaic ? 3 * i + (2 - row % 2 - i % 2) : i;
      double value = exposure * static_cast<double>(from[at]);
      if (sensor.full_well > 0) {
        const auto site = static_cast<std::uint64_t>(row) * 3U * static_cast<unsigned>(light.cols) +
                          static_cast<unsigned>(at);
        value =
            electrons(value * sensor.full_well, sensor.read_noise, key, site) / sensor.full_well;
      }
      to[i] = static_cast<float>(std::clamp(value, 0.0, 1.0));
    }
  });
  return measured;
}

/// Demosaics with a border of mirrored pixels, which keep the order of the mosaic, because OpenCV
/// copies the outermost rows and columns from their neighbours.
cv::Mat demosaic_mirrored(const cv::Mat& measured) {
  constexpr int kMargin = 2;
  cv::Mat raw, wide, color;
  measured.convertTo(raw, CV_16U, 65535);
  cv::copyMakeBorder(raw, wide, kMargin, kMargin, kMargin, kMargin, cv::BORDER_REFLECT_101);
  cv::cvtColor(wide, color, cv::COLOR_BayerRGGB2BGR);
  cv::Mat values;
  color(cv::Rect(kMargin, kMargin, raw.cols, raw.rows)).convertTo(values, CV_32F, 1 / 65535.0);
  return values;
}

}  // namespace

double choose_exposure(const cv::Mat& light, const PixelMask& lit, const VirtualSensor& sensor) {
  if (sensor.exposure_distance) {
    const double metres = *sensor.exposure_distance / 1000;
    return sensor.exposure_level * metres * metres;
  }
  std::vector<float> brightest;
  for (int row = 0; row < light.rows; ++row) {
    for (int column = 0; column < light.cols; ++column) {
      if (!lit(row, column)) continue;
      const auto& pixel = light.at<cv::Vec3f>(row, column);
      brightest.push_back(std::max({pixel[0], pixel[1], pixel[2]}));
    }
  }
  if (brightest.empty()) return 1;
  const auto last = static_cast<double>(brightest.size() - 1);
  const auto at =
      brightest.begin() + static_cast<std::ptrdiff_t>(sensor.exposure_percentile * last);
  std::nth_element(brightest.begin(), at, brightest.end());
  return *at > 0 ? sensor.exposure_level / static_cast<double>(*at) : 1;
}

cv::Mat read_out(const cv::Mat& light, double exposure, const VirtualSensor& sensor,
                 std::uint64_t frame_number) {
  cv::Mat values = measure(light, exposure, sensor, frame_number);
  if (sensor.readout == Readout::demosaiced) values = demosaic_mirrored(values);
  if (sensor.camera_gamma != 1) {
    for (int row = 0; row < values.rows; ++row) {
      float* value = values.ptr<float>(row);
      for (int i = 0; i < values.cols * values.channels(); ++i) {
        value[i] =
            static_cast<float>(std::pow(static_cast<double>(value[i]), 1 / sensor.camera_gamma));
      }
    }
  }
  cv::Mat frame;
  values.convertTo(frame, sensor.bits == 8 ? CV_8U : CV_16U, sensor.bits == 8 ? 255 : 65535);
  return frame;
}

}  // namespace palpate::sensing
