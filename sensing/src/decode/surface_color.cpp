// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/sensing/surface_color.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>
#include <utility>
#include <vector>

#include "image/gaussian_blur.h"
#include "image/hue.h"
#include "image/image_plane.h"
#include "palpate/core/error.h"
#include "palpate/core/quantile.h"
#include "setup/carrier.h"
#include "setup/triangulation.h"

namespace palpate::sensing {
namespace {

using Gray = cv::Mat_<float>;

/// Deviation of the window in which the sinusoid is fitted, in periods.
constexpr double kFringeWindow = 1.0;
/// If the sinusoid's troughs are darker than this share of its mean, noise would dominate.
constexpr float kDarkestTrough = 0.25F;
/// Deviations [stripes] over which a channel is interpolated, from detail to far places.
constexpr std::array<double, 3> kFills{0.7, 3, 12};
/// A channel counts as interpolated at a scale if this share of the window is lit with it.
constexpr float kLeastLit = 0.05F;
/// Deviation of the blur of the camera's lens and the projector's, across an edge [camera px].
constexpr double kEdgeBlur = 1.2;
/// A pixel of a stripe that lacks a channel shows the leakage of the others into it.
constexpr float kUnlitShare = 0.02F;
constexpr float kLitShare = 0.5F;

/// The light of the projector at each camera pixel.
struct LightPlaces {
  Gray known;                 ///< 1 where there is a depth, else 0
  Gray cosine, sine;          ///< of the sinusoid's angle; 0 where unknown
  std::vector<Gray> stripes;  ///< share of each channel (BGR) in the stripe's colour
  double period = 0;          ///< [camera px]
  double stripe = 0;          ///< [camera px] width of a stripe
};

LightPlaces light_places(const geometry::RangeMap& range, const Rig& rig, const Pattern& pattern,
                         int channels) {
  const Triangulation triangulation(rig);
  const Eigen::Matrix2Xd rays = geometry::pixel_rays(rig.camera);
  const cv::Size size(rig.camera.width, rig.camera.height);
  const auto zero = [&] { return Gray(Gray::zeros(size)); };
  LightPlaces places{zero(), zero(), zero(), {}, 0, 0};
  for (int channel = 0; channel < channels; ++channel) places.stripes.push_back(zero());
  const int axis = pattern.axis == Axis::x ? 0 : 1;
  const std::vector<double>& edges = pattern.stripe_edges;
  for (int v = 0; v < size.height; ++v) {
    for (int u = 0; u < size.width; ++u) {
      const auto z = static_cast<double>(range.z(v, u));
      if (!(z > 0)) continue;
      const Eigen::Vector2d pixel = triangulation.project(
          triangulation.direction(rays.col(static_cast<Eigen::Index>(v) * size.width + u)), z);
      if (!triangulation.on_panel(pixel)) continue;
      const double angle = kFullTurn * pixel[axis] / pattern.period + pattern.phase;
      places.known(v, u) = 1;
      places.cosine(v, u) = static_cast<float>(std::cos(angle));
      places.sine(v, u) = static_cast<float>(std::sin(angle));
      const auto stripe = static_cast<std::size_t>(
          std::upper_bound(edges.begin(), edges.end(), pixel[1 - axis]) - edges.begin());
      for (int channel = 0; channel < channels; ++channel) {
        const double share = pattern.stripes.empty()
                                 ? 1
                                 : pattern.colors[static_cast<std::size_t>(pattern.stripes[stripe])]
                                       .rgb[2 - channel];
        places.stripes[static_cast<std::size_t>(channel)](v, u) = static_cast<float>(share);
      }
    }
  }
  const Carrier carrier = expected_carrier(rig, pattern);
  places.period = carrier.period();
  places.stripe = stripe_width(carrier, pattern);
  return places;
}

Gray product(const Gray& a, const Gray& b) {
  Gray out;
  cv::multiply(a, b, out);
  return out;
}

/// Wide windows are computed in an image of fewer pixels.
Gray blurred(const Gray& image, double sigma) {
  constexpr double kFineWindow = 4;  // px
  const int step = std::max(1, static_cast<int>(sigma / kFineWindow));
  if (step == 1) return gaussian_blur(image, sigma, Border::black);
  cv::Mat small;
  const cv::Size size((image.cols + step - 1) / step, (image.rows + step - 1) / step);
  cv::resize(image, small, size, 0, 0, cv::INTER_AREA);
  small = gaussian_blur(small, sigma / step, Border::black);
  cv::Mat out;
  cv::resize(small, out, image.size(), 0, 0, cv::INTER_LINEAR);
  return out;
}

/// The channel without fringes. Windows with too little known surface keep the value.
Gray without_fringes(const Gray& value, const LightPlaces& places) {
  const double sigma = kFringeWindow * places.period;
  const Gray& c = places.cosine;
  const Gray& s = places.sine;
  const Gray seen = product(value, places.known);
  const Gray n = blurred(places.known, sigma), nc = blurred(c, sigma), ns = blurred(s, sigma);
  const Gray ncc = blurred(product(c, c), sigma), ncs = blurred(product(c, s), sigma);
  const Gray nss = blurred(product(s, s), sigma);
  const Gray v1 = blurred(seen, sigma), vc = blurred(product(seen, c), sigma);
  const Gray vs = blurred(product(seen, s), sigma);
  Gray out = seen.clone();
  /// Below this share of the determinant of whole periods (1/4) the window is not sufficient.
  constexpr float kLeastDeterminant = 0.01F;
  for (int row = 0; row < out.rows; ++row) {
    for (int column = 0; column < out.cols; ++column) {
      if (!(places.known(row, column) > 0)) continue;
      Eigen::Matrix3f normal;
      normal << n(row, column), nc(row, column), ns(row, column), nc(row, column), ncc(row, column),
          ncs(row, column), ns(row, column), ncs(row, column), nss(row, column);
      const float weight = n(row, column);
      if (!(normal.determinant() > kLeastDeterminant / 4 * weight * weight * weight)) continue;
      const Eigen::Vector3f fit =
          normal.inverse() * Eigen::Vector3f(v1(row, column), vc(row, column), vs(row, column));
      if (!(fit[0] > 0)) continue;
      const float factor = 1 + (fit[1] * c(row, column) + fit[2] * s(row, column)) / fit[0];
      out(row, column) /= std::max(factor, kDarkestTrough);
    }
  }
  return out;
}

/// Interpolates a channel where the stripes lack it: sums of value * share / share^2 over windows,
/// the smallest in which enough is lit.
Gray interpolated(const Gray& value, const Gray& share, const LightPlaces& places) {
  const Gray lit = product(value, share);
  const Gray weight = product(share, share);
  Gray out(Gray::zeros(value.size()));
  for (auto scale = kFills.rbegin(); scale != kFills.rend(); ++scale) {
    const double sigma = *scale * places.stripe;
    const Gray above = blurred(lit, sigma);
    const Gray below = blurred(weight, sigma);
    const Gray all = blurred(places.known, sigma);
    for (int row = 0; row < out.rows; ++row) {
      for (int column = 0; column < out.cols; ++column) {
        if (below(row, column) > kLeastLit * all(row, column))
          out(row, column) = above(row, column) / below(row, column);
      }
    }
  }
  return out;
}

/// Light in stripes that lack a channel, as a share of that in stripes with it: ambient light and
/// the overlap of the filters.
float leakage(const Gray& value, const Gray& share, const Gray& fill) {
  std::vector<float> ratios;
  for (int row = 0; row < value.rows; ++row) {
    for (int column = 0; column < value.cols; ++column) {
      if (value(row, column) > 0 && share(row, column) < kUnlitShare && fill(row, column) > 0)
        ratios.push_back(value(row, column) / fill(row, column));
    }
  }
  if (ratios.empty()) return 0;
  return std::min(median(ratios), kLitShare);
}

/// Least squares of values = light * brightness * color over the channels, by alternation: color
/// varies slowly, brightness from pixel to pixel.
void remove_stripes(std::vector<Gray>& channels, const LightPlaces& places) {
  constexpr int kRounds = 3;
  const Gray near = blurred(places.known, kEdgeBlur);
  std::vector<Gray> light, colors(channels.size());
  Gray brightness = places.known.clone();
  for (int round = 0; round < kRounds; ++round) {
    for (std::size_t i = 0; i < channels.size(); ++i) {
      if (round == 0) {
        Gray share;
        cv::divide(blurred(places.stripes[i], kEdgeBlur), cv::max(near, 1e-6F), share);
        share = product(share, places.known);
        const float leak = leakage(channels[i], share, interpolated(channels[i], share, places));
        share = leak + (1 - leak) * share;
        light.push_back(product(share, places.known));
      }
      colors[i] = interpolated(channels[i], product(light[i], brightness), places);
    }
    for (int row = 0; row < near.rows; ++row) {
      for (int column = 0; column < near.cols; ++column) {
        float above = 0, below = 0;
        for (std::size_t i = 0; i < channels.size(); ++i) {
          const float expected = light[i](row, column) * colors[i](row, column);
          above += expected * channels[i](row, column);
          below += expected * expected;
        }
        brightness(row, column) = below > 0 ? above / below : 0;
      }
    }
  }
  for (std::size_t i = 0; i < channels.size(); ++i) channels[i] = product(brightness, colors[i]);
}

}  // namespace

cv::Mat surface_color(const cv::Mat& frame, const geometry::RangeMap& range, const Rig& rig,
                      const Pattern& pattern) {
  check_rig(rig, "rig");
  check_pattern(pattern, "pattern");
  if (!is_frame(frame) || frame.cols != rig.camera.width || frame.rows != rig.camera.height ||
      range.z.cols() != frame.cols || range.z.rows() != frame.rows) {
    throw InvalidInput(
        "surface_color(): frame and range map must have the size of the rig's camera, and the "
        "frame 8 or 16 bit with 1 or 3 channels");
  }
  const LightPlaces places = light_places(range, rig, pattern, frame.channels());
  cv::Mat linear;
  frame.convertTo(linear, CV_32F, 1 / full_scale(frame));
  std::vector<cv::Mat> split;
  cv::split(linear, split);
  std::vector<Gray> channels;
  for (const cv::Mat& channel : split) channels.push_back(without_fringes(channel, places));
  if (!pattern.stripes.empty() && channels.size() == 3) remove_stripes(channels, places);
  std::vector<cv::Mat> done;
  for (const Gray& channel : channels) {
    const Gray shown = product(channel, places.known);
    done.emplace_back(cv::max(cv::min(shown, 1.0), 0.0));
  }
  cv::Mat color;
  cv::merge(done, color);
  return color;
}

cv::Mat srgb_of(const cv::Mat& linear) {
  cv::Mat coded(linear.size(), CV_MAKETYPE(CV_8U, linear.channels()));
  for (int row = 0; row < linear.rows; ++row) {
    const auto* in = linear.ptr<float>(row);
    std::transform(in, in + linear.cols * linear.channels(), coded.ptr(row), [](float value) {
      const float light = value > 0 ? std::min(value, 1.0F) : 0;  // NaN is black
      const float code =
          light <= 0.0031308F ? 12.92F * light : 1.055F * std::pow(light, 1 / 2.4F) - 0.055F;
      return static_cast<std::uint8_t>(std::lround(255 * code));
    });
  }
  return coded;
}

}  // namespace palpate::sensing
