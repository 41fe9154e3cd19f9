// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "textures.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <opencv2/core.hpp>
#include <random>

namespace palpate::bench {
namespace {

/// Random numbers in [0, 1) that are the same everywhere, unlike std::uniform_real_distribution.
class Unit {
 public:
  explicit Unit(unsigned seed) : random_(seed) {}
  double operator()() { return static_cast<double>(random_()) / 4294967296.0; }

 private:
  std::mt19937 random_;
};

cv::Scalar random_color(const Inks& inks, Unit& unit) {
  const double grey = unit();
  cv::Scalar color;
  for (int c = 0; c < 3; ++c) {
    color[c] =
        255 * (inks.darkest + (1 - inks.darkest) * ((1 - inks.tint) * grey + inks.tint * unit()));
  }
  return color;
}

}  // namespace

cv::Mat print(const Inks& inks) {
  constexpr int kPrintWidth = 1600, kPrintHeight = 1200, kRectangles = 900;
  Unit unit(5);
  cv::Mat image(kPrintHeight, kPrintWidth, CV_8UC3, cv::Scalar::all(200));
  for (int i = 0; i < kRectangles; ++i) {
    const int height = 8 + static_cast<int>(120 * unit());
    const int width = 8 + static_cast<int>(120 * unit());
    const int top = static_cast<int>(kPrintHeight * unit()) - 40;
    const int left = static_cast<int>(kPrintWidth * unit()) - 40;
    const cv::Rect box(left, top, width, height);
    image(box & cv::Rect(0, 0, kPrintWidth, kPrintHeight)).setTo(random_color(inks, unit));
  }
  return image;
}

cv::Mat tiles(const Eigen::Vector2d& size, double period, const Inks& inks) {
  constexpr double kPixelsPerMm = 4, kStrip = 90;  // mm
  constexpr double kPeriods[] = {0.5, 1, 1.5, 2, 3};
  const auto pixel = [](double mm) { return static_cast<int>(std::lround(mm * kPixelsPerMm)); };
  Unit unit(9);
  cv::Mat image(pixel(size.y()), pixel(size.x()), CV_8UC3);
  const cv::Rect whole(cv::Point(), image.size());
  for (int strip = 0; strip * kStrip < size.x(); ++strip) {
    const double side = kPeriods[static_cast<std::size_t>(strip) % std::size(kPeriods)] * period;
    for (double top = 0; top < size.y(); top += side) {
      for (double left = 0; left < kStrip; left += side) {
        const cv::Point first(pixel(strip * kStrip + left), pixel(top));
        const cv::Point last(pixel(strip * kStrip + std::min(left + side, kStrip)),
                             pixel(top + side));
        image(cv::Rect(first, last) & whole).setTo(random_color(inks, unit));
      }
    }
  }
  return image;
}

}  // namespace palpate::bench
