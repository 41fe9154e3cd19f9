// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/sensing/pattern_image.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <numbers>
#include <vector>

#include "palpate/core/error.h"
#include "palpate/core/require.h"
#include "palpate/sensing/gray_code.h"

namespace palpate::sensing {
namespace {

constexpr int kLargestSize = 65535;
/// Limit of light directions, cos 60 degrees: the parallel projector's panel would grow without
/// bound towards directions perpendicular to the camera's axis.
constexpr double kLeastForward = 0.5;
/// Sizes [px] that exceed a whole number by less than this equal it up to rounding.
constexpr double kSizeTolerance = 1e-6;
constexpr int kGreyTop = 255;

void check_size(int width, int height) {
  require("the projector's width", width, at_least(1).at_most(kLargestSize), "px");
  require("the projector's height", height, at_least(1).at_most(kLargestSize), "px");
}

/// Direction, in the camera's axes with z = 1, of the light from a panel pixel.
Eigen::Vector2d direction_in_camera(const Rig& rig, const Eigen::Vector2d& panel_pixel) {
  const Eigen::Vector3d ray = geometry::undistort(rig.projector, panel_pixel).homogeneous();
  const Eigen::Vector3d turned = rig.T_projector_camera.linear().transpose() * ray;
  if (!(turned.z() >= kLeastForward * ray.norm()))
    return Eigen::Vector2d::Constant(std::numeric_limits<double>::quiet_NaN());
  return turned.hnormalized();
}

geometry::Camera parallel_projector(const Rig& rig) {
  const geometry::Camera& real = rig.projector;
  Eigen::Array2d low = Eigen::Array2d::Constant(std::numeric_limits<double>::infinity());
  Eigen::Array2d high = -low;
  const auto include = [&](double u, double v) {
    const Eigen::Vector2d direction = direction_in_camera(rig, {u - 0.5, v - 0.5});
    if (!direction.allFinite()) {
      throw InvalidInput(
          "rig: projector: the pattern cannot be rectified: its lens cannot be inverted on the "
          "whole panel, or light leaves it by more than 60 degrees from the camera's axis; draw "
          "the pattern straight on the panel");
    }
    low = low.min(direction.array());
    high = high.max(direction.array());
  };
  for (int u = 0; u <= real.width; ++u) include(u, 0), include(u, real.height);
  for (int v = 0; v <= real.height; ++v) include(0, v), include(real.width, v);
  const auto size = [](double length) {
    return static_cast<int>(std::ceil(length - kSizeTolerance));
  };
  return {.width = size(real.fx * (high.x() - low.x())),
          .height = size(real.fy * (high.y() - low.y())),
          .fx = real.fx,
          .fy = real.fy,
          .cx = -0.5 - real.fx * low.x(),
          .cy = -0.5 - real.fy * low.y()};
}

/// Maps a panel pixel to the pixel in which the pattern is defined, for one channel.
class PanelMap {
 public:
  PanelMap(const Rig& real, const Rig& drawn, const DrawOptions& options,
           const ChromaticShift& shift, Axis axis)
      : real_(real), drawn_(drawn.projector), rectify_(options.rectify) {
    const geometry::Camera& panel = real.projector;
    scale_ = options.compensate ? shift.beta : 1;
    const double gamma = options.compensate ? shift.gamma : 0;
    // The channel's normalised coordinate n goes in the same direction as green's beta n + gamma.
    offset_ = (1 - scale_) * Eigen::Vector2d(panel.cx, panel.cy);
    (axis == Axis::x ? offset_.x() : offset_.y()) +=
        gamma * (axis == Axis::x ? panel.fx : panel.fy);
  }
  [[nodiscard]] Eigen::Vector2d operator()(double u, double v) const {
    Eigen::Vector2d as_green = scale_ * Eigen::Vector2d(u, v) + offset_;
    if (!rectify_) return as_green;
    const Eigen::Vector2d direction = direction_in_camera(real_, as_green);
    return {drawn_.fx * direction.x() + drawn_.cx, drawn_.fy * direction.y() + drawn_.cy};
  }
  /// Returns true if the first coordinate depends on u alone and the second on v alone.
  [[nodiscard]] bool is_separable() const { return !rectify_; }

 private:
  const Rig& real_;
  geometry::Camera drawn_;
  bool rectify_;
  double scale_ = 1;
  Eigen::Vector2d offset_ = Eigen::Vector2d::Zero();
};

/// One channel of the stripes' colours as a function of the pixel across them.
class StripeChannel {
 public:
  StripeChannel(const Pattern& pattern, int channel) : pattern_(pattern), channel_(channel) {}

  /// Mean from `a` to `b`, which are at most a few pixels apart, in either order.
  [[nodiscard]] double mean(double a, double b) const {
    if (pattern_.stripes.empty()) return 1;
    const double low = std::min(a, b);
    const double high = std::max(a, b);
    const std::vector<double>& edges = pattern_.stripe_edges;
    auto stripe =
        static_cast<std::size_t>(std::upper_bound(edges.begin(), edges.end(), low) - edges.begin());
    if (stripe == edges.size() || edges[stripe] >= high) return value(stripe);
    double sum = 0;
    double from = low;
    for (; stripe < edges.size() && edges[stripe] < high; ++stripe) {
      sum += value(stripe) * (edges[stripe] - from);
      from = edges[stripe];
    }
    return (sum + value(stripe) * (high - from)) / (high - low);
  }

 private:
  [[nodiscard]] double value(std::size_t stripe) const {
    return pattern_.colors[static_cast<std::size_t>(pattern_.stripes[stripe])].rgb[channel_];
  }
  const Pattern& pattern_;
  int channel_;
};

template <typename T>
T level(double value) {
  // NaN marks places where nothing is shown; they become black.
  return static_cast<T>(
      std::lround(std::numeric_limits<T>::max() * std::fmin(std::fmax(value, 0), 1)));
}

/// Draws one channel (0 red, 1 green, 2 blue) through a map from panel to pattern pixels.
/// \param light brightness as a function of the pixel along the axis
template <typename T, typename Map, typename Light>
void draw_channel(const Pattern& pattern, const Light& light, int channel, const Map& map,
                  cv::Mat& image) {
  const StripeChannel stripes(pattern, channel);
  const Eigen::Index along = pattern.axis == Axis::x ? 0 : 1;
  const Eigen::Index across = 1 - along;
  const Eigen::Vector2d half_pixel = 0.5 * Eigen::Vector2d::Unit(across);
  const auto light_at = [&](int u, int v) { return light(map(u, v)[along]); };
  const auto color_at = [&](int u, int v) {
    return stripes.mean(map(u - half_pixel.x(), v - half_pixel.y())[across],
                        map(u + half_pixel.x(), v + half_pixel.y())[across]);
  };
  const auto set = [&](int u, int v, double value) {
    image.ptr<T>(v)[3 * u + 2 - channel] = level<T>(value);
  };
  if (!map.is_separable()) {
    for (int v = 0; v < image.rows; ++v) {
      for (int u = 0; u < image.cols; ++u) set(u, v, color_at(u, v) * light_at(u, v));
    }
    return;
  }
  const std::array<int, 2> size = {image.cols, image.rows};
  std::vector<double> lights, colors;
  for (int i = 0; i < size[static_cast<std::size_t>(along)]; ++i) lights.push_back(light_at(i, i));
  for (int i = 0; i < size[static_cast<std::size_t>(across)]; ++i) colors.push_back(color_at(i, i));
  const std::vector<double>& of_columns = along == 0 ? lights : colors;
  const std::vector<double>& of_rows = along == 0 ? colors : lights;
  for (int v = 0; v < image.rows; ++v) {
    for (int u = 0; u < image.cols; ++u) {
      set(u, v, of_columns[static_cast<std::size_t>(u)] * of_rows[static_cast<std::size_t>(v)]);
    }
  }
}

template <typename Map, typename Light>
cv::Mat draw(const Pattern& pattern, const Light& light, int width, int height, int bits,
             const std::array<Map, 3>& maps) {
  cv::Mat image(height, width, bits == 8 ? CV_8UC3 : CV_16UC3);
  for (int channel = 0; channel < 3; ++channel) {
    const Map& map = maps[static_cast<std::size_t>(channel)];
    if (bits == 8) {
      draw_channel<std::uint8_t>(pattern, light, channel, map, image);
    } else {
      draw_channel<std::uint16_t>(pattern, light, channel, map, image);
    }
  }
  return image;
}

/// The pattern's brightness as a function of the pixel along its axis.
class Sinusoid {
 public:
  Sinusoid(const Pattern& pattern, double shift)
      : pattern_(pattern), phase_(pattern.phase + shift) {}
  [[nodiscard]] double operator()(double pixel) const {
    return pattern_.mean +
           pattern_.amplitude * std::cos(2 * std::numbers::pi * pixel / pattern_.period + phase_);
  }

 private:
  const Pattern& pattern_;
  double phase_;
};

/// One bit of the code that tells periods apart.
class CodeBit {
 public:
  CodeBit(const Pattern& pattern, int bit)
      : dark_(pattern.mean - pattern.amplitude),
        bright_(pattern.mean + pattern.amplitude),
        cell_(pattern.multishot->code_cell),
        start_(pattern.multishot->code_start),
        bit_(bit) {}
  [[nodiscard]] double operator()(double pixel) const {
    const double cell = std::floor((pixel - start_) / cell_);
    // Before the first cell, beyond the panel and where nothing is shown (NaN) it is dark.
    if (!(cell >= 0 && cell <= std::numeric_limits<int>::max())) return dark_;
    return ((gray_code_of(static_cast<unsigned>(cell)) >> bit_) & 1U) != 0 ? bright_ : dark_;
  }

 private:
  double dark_, bright_, cell_, start_;
  int bit_;
};

/// Panels whose pixels are those of the pattern.
struct StraightMap {
  [[nodiscard]] Eigen::Vector2d operator()(double u, double v) const { return {u, v}; }
  [[nodiscard]] bool is_separable() const { return true; }
};
constexpr std::array<StraightMap, 3> kStraight = {};

template <typename Light>
cv::Mat draw_on(const Rig& rig, const DrawOptions& options, const Pattern& pattern,
                const Light& light) {
  const Rig drawn = rig_of_drawing(rig, options);
  const auto map = [&](const ChromaticShift& shift) {
    return PanelMap(rig, drawn, options, shift, pattern.axis);
  };
  const std::array<PanelMap, 3> maps = {map(rig.red), map(ChromaticShift{}), map(rig.blue)};
  return draw(pattern, light, rig.projector.width, rig.projector.height, options.bits, maps);
}

void require_multishot(const Pattern& pattern) {
  check_pattern(pattern, "pattern");
  if (!pattern.multishot) throw InvalidInput("pattern: has no `multishot`: it is for one image");
}

/// Draws the images one after the other.
template <typename Draw>
std::vector<cv::Mat> each_shot(const Pattern& pattern, const Draw& draw_light) {
  std::vector<cv::Mat> images;
  for (const double shift : pattern.multishot->shifts)
    images.push_back(draw_light(Sinusoid(pattern, shift)));
  for (int bit = pattern.multishot->code_bits - 1; bit >= 0; --bit)
    images.push_back(draw_light(CodeBit(pattern, bit)));
  return images;
}

}  // namespace

Rig rig_of_drawing(const Rig& rig, const DrawOptions& options) {
  check_rig(rig, "rig");
  Rig drawn = rig;
  if (options.rectify) {
    drawn.projector = parallel_projector(rig);
    drawn.T_projector_camera.linear().setIdentity();
    drawn.T_projector_camera.translation() =
        rig.T_projector_camera.linear().transpose() * rig.T_projector_camera.translation();
    drawn.covariance.reset();  // it is of the real projector's parameters
  }
  if (options.compensate) {
    for (ChromaticShift* shift : {&drawn.red, &drawn.blue}) {
      shift->beta = 1;
      shift->gamma = 0;
    }
  }
  return drawn;
}

void visit(DrawOptions& options, FieldVisitor& visitor) {
  visitor.begin("DrawOptions");
  visitor.flag({"rectify",
                "Warp the pattern so that it leaves the projector as if from one without lens "
                "distortion, parallel to the camera; rig.yaml then describes that projector"},
               options.rectify);
  visitor.flag(
      {"compensation",
       "Scale and shift the red and blue panels by the rig's chromatic values, so that all "
       "colours coincide on the object; rig.yaml then has no shift"},
      options.compensate);
  visitor.whole({"bits", "Bits per channel of the images: 8 or 16"}, options.bits,
                at_least(8).at_most(16));
}

cv::Mat draw_pattern(const Pattern& pattern, const Rig& rig, const DrawOptions& options) {
  check_pattern(pattern, "pattern");
  require_one_of("DrawOptions::bits", options.bits, {8, 16});
  return draw_on(rig, options, pattern, Sinusoid(pattern, 0));
}

cv::Mat draw_pattern(const Pattern& pattern, int width, int height, int bits) {
  check_pattern(pattern, "pattern");
  require_one_of("DrawOptions::bits", bits, {8, 16});
  check_size(width, height);
  return draw(pattern, Sinusoid(pattern, 0), width, height, bits, kStraight);
}

std::vector<cv::Mat> draw_multishot(const Pattern& pattern, const Rig& rig,
                                    const DrawOptions& options) {
  require_multishot(pattern);
  require_one_of("DrawOptions::bits", options.bits, {8, 16});
  return each_shot(pattern,
                   [&](const auto& light) { return draw_on(rig, options, pattern, light); });
}

std::vector<cv::Mat> draw_multishot(const Pattern& pattern, int width, int height, int bits) {
  require_multishot(pattern);
  require_one_of("DrawOptions::bits", bits, {8, 16});
  check_size(width, height);
  return each_shot(pattern, [&](const auto& light) {
    return draw(pattern, light, width, height, bits, kStraight);
  });
}

cv::Mat draw_uniform(const Eigen::Vector3d& rgb, int width, int height, int bits) {
  check_size(width, height);
  require_one_of("DrawOptions::bits", bits, {8, 16});
  for (const double value : rgb) require("draw_uniform(): rgb", value, at_least(0).at_most(1));
  const double top = bits == 8 ? 255 : 65535;
  const Eigen::Vector3d levels = (top * rgb).array().round();
  return {height, width, bits == 8 ? CV_8UC3 : CV_16UC3,
          cv::Scalar(levels[2], levels[1], levels[0])};
}

Pattern single_color(const Pattern& pattern, int color) {
  require("single_color(): color", color,
          at_least(0).below(static_cast<double>(pattern.colors.size())));
  Pattern single = without_stripes(pattern);
  single.colors = {pattern.colors[static_cast<std::size_t>(color)]};
  single.stripes = {0};
  return single;
}

Pattern without_stripes(const Pattern& pattern) {
  Pattern white = pattern;
  white.colors.clear();
  white.stripes.clear();
  white.stripe_edges.clear();
  return white;
}

std::vector<int> grey_levels(int steps) {
  require("grey_levels(): steps", steps, at_least(2).at_most(kGreyTop + 1));
  std::vector<int> levels;
  levels.reserve(static_cast<std::size_t>(steps));
  for (int i = 0; i < steps; ++i) {
    levels.push_back(
        static_cast<int>(std::lround(static_cast<double>(kGreyTop) * i / (steps - 1))));
  }
  return levels;
}

}  // namespace palpate::sensing
