// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/sensing/pattern_design.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <sstream>
#include <string>
#include <string_view>
#include <vector>

#include "palpate/core/error.h"
#include "palpate/core/idle_fields.h"
#include "palpate/core/require.h"
#include "palpate/sensing/pattern_colors.h"
#include "palpate/sensing/stripe_sequence.h"
#include "setup/carrier.h"
#include "setup/triangulation.h"

namespace palpate::sensing {
namespace {

constexpr double kNyquistPeriod = 2;
/// Narrower stripes [projector px] vanish in the blur of both lenses.
constexpr int kLeastStripeWidth = 4;
/// Period without a rig [projector px], suitable for a camera with 1.4 times as many pixels as the
/// projector.
constexpr double kPeriodWithoutRig = 10;
/// Depths in equal ratios at which the period in the camera is evaluated.
constexpr int kDepths = 5;
/// [rad] Standard deviation of the phase of a pixel in a good image. If all depths beyond the
/// working distance change the phase by less, no depth can be distinguished from infinity.
constexpr double kLeastPhase = 0.01;
/// Numbers that exceed a whole number by less than this equal it up to rounding.
constexpr double kWholeTolerance = 1e-9;

constexpr std::array<std::string_view, 3> kAxes{"x", "y", "auto"};
/// The sinusoid reaches white, and its troughs are just bright enough to show the hue of stripes.
constexpr double kMean = 0.575, kAmplitude = 0.425;

void check_options(const PatternOptions& options) {
  static_cast<void>(in_range(options));
  if (options.period) refuse_idle(options, "period", {"min_camera_period", "min_projector_period"});
  if (options.range) {
    require("PatternOptions::range.near", options.range->near, above(0).finite(), "mm");
    require("PatternOptions::range.far", options.range->far, at_least(options.range->near).finite(),
            "mm");
  }
}

/// One of kPlacesPerSide x kPlacesPerSide positions that cover the camera image [px].
Eigen::Vector2d place_in_image(const Rig& rig, int place) {
  const int column = place % kPlacesPerSide;
  const int row = place / kPlacesPerSide;
  return {(column + 0.5) / kPlacesPerSide * rig.camera.width - 0.5,
          (row + 0.5) / kPlacesPerSide * rig.camera.height - 0.5};
}

/// The projector pixel that lights a place of the camera image, and its derivatives by the place
/// and by the depth. NaN or off the panel where there is none.
struct LocalMap {
  Eigen::Vector2d pixel;
  Eigen::Matrix2d per_pixel;  ///< d pixel / d camera pixel, on a surface facing the camera
  Eigen::Vector2d per_depth;  ///< [px/mm]
};

LocalMap local_map(const Rig& rig, const Triangulation& triangulation, const Eigen::Vector2d& place,
                   double z) {
  const auto projected = [&](double du, double dv) {
    const Eigen::Vector2d ray = geometry::undistort(rig.camera, place + Eigen::Vector2d(du, dv));
    return triangulation.project(triangulation.direction(ray), z);
  };
  LocalMap map;
  map.pixel = projected(0, 0);
  map.per_pixel.col(0) = projected(0.5, 0) - projected(-0.5, 0);
  map.per_pixel.col(1) = projected(0, 0.5) - projected(0, -0.5);
  const Eigen::Vector3d direction = triangulation.direction(geometry::undistort(rig.camera, place));
  map.per_depth = {triangulation.slope(direction, Axis::x, z),
                   triangulation.slope(direction, Axis::y, z)};
  return map;
}

/// Figures of a rig over the working range.
struct RigFigures {
  /// Longest d pixel / d camera pixel of either coordinate over image and range.
  std::array<double, 2> steepest{};
  /// RMS |d pixel / d z| of either coordinate, and mean d pixel / d camera pixel.
  std::array<double, 2> per_depth{};
  std::array<double, 2> per_pixel{};
  double middle_z = 0;
};

RigFigures look_at(const Rig& rig, const WorkingRange& range) {
  const Triangulation triangulation(rig);
  RigFigures view;
  view.middle_z = std::sqrt(range.near * range.far);
  int count = 0;
  for (int step = 0; step < kDepths; ++step) {
    const double z = range.near * std::pow(range.far / range.near, step / (kDepths - 1.0));
    for (int place = 0; place < kPlacesPerSide * kPlacesPerSide; ++place) {
      const LocalMap map = local_map(rig, triangulation, place_in_image(rig, place), z);
      if (!triangulation.on_panel(map.pixel) || !map.per_pixel.allFinite()) continue;
      ++count;
      for (std::size_t axis = 0; axis < 2; ++axis) {
        const auto row = static_cast<Eigen::Index>(axis);
        const double length = map.per_pixel.row(row).norm();
        view.steepest[axis] = std::max(view.steepest[axis], length);
        view.per_pixel[axis] += length;
        view.per_depth[axis] += map.per_depth[row] * map.per_depth[row];
      }
    }
  }
  if (count == 0) {
    throw InvalidInput("rig: the projector lights nothing of what the camera sees from " +
                       std::to_string(range.near) + " to " + std::to_string(range.far) +
                       " mm; check the working distances, R and t");
  }
  for (std::size_t axis = 0; axis < 2; ++axis) {
    view.per_pixel[axis] /= count;
    view.per_depth[axis] = std::sqrt(view.per_depth[axis] / count);
  }
  return view;
}

/// Depth around which the views overlap: the geometric mean over depths from one to
/// kFarthestBaselines baselines, weighted by the lit share of the image.
WorkingRange overlap_range(const Rig& rig) {
  const Triangulation triangulation(rig);
  const double baseline = rig.T_projector_camera.translation().norm();
  double log_z = 0;
  int count = 0;
  for (int step = 0; step < kTriedDepths; ++step) {
    const double z = baseline * std::pow(kFarthestBaselines, step / (kTriedDepths - 1.0));
    for (int place = 0; place < kPlacesPerSide * kPlacesPerSide; ++place) {
      const Eigen::Vector2d ray = geometry::undistort(rig.camera, place_in_image(rig, place));
      if (!triangulation.on_panel(triangulation.project(triangulation.direction(ray), z))) continue;
      log_z += std::log(z);
      ++count;
    }
  }
  const double z = count == 0 ? baseline : std::exp(log_z / count);
  return {z, z};
}

void add_stripes(const PatternOptions& options, int length, PatternDesign& design) {
  Pattern& pattern = design.pattern;
  std::vector<TrainedColor> seen;
  if (options.trained) {
    SpreadColors spread = spread_colors(*options.trained, options.number_of_colors);
    pattern.colors = std::move(spread.colors);
    seen = std::move(spread.expected);
    design.largest_overlap = largest_overlap(seen);
  } else {
    pattern.colors = evenly_spaced_colors(options.number_of_colors);
    const auto count = static_cast<double>(pattern.colors.size());
    for (const PatternColor& color : pattern.colors) {
      const double mean = 2 * std::numbers::pi * static_cast<double>(seen.size()) / count;
      seen.push_back({.name = color.name, .mean = mean, .variance = 1});
    }
  }
  pattern.stripes = stripe_sequence(hue_separation(seen), options.stripes);
  const auto count = static_cast<int>(pattern.stripes.size());
  if (length < count * kLeastStripeWidth) {
    throw InvalidInput(std::vector<MessagePart>{
        {"PatternOptions::stripes", true},
        {fmt::format(": {} stripes on {} projector pixels are narrower than {} px; take fewer "
                     "stripes, or a smaller ",
                     count, length, kLeastStripeWidth)},
        {"PatternOptions::number_of_colors", true}});
  }
  for (int i = 1; i < count; ++i) {
    pattern.stripe_edges.push_back(std::round(static_cast<double>(length) * i / count) - 0.5);
  }
}

PatternDesign start_design(const PatternOptions& options, Axis axis, int width, int height) {
  PatternDesign design;
  design.pattern.axis = axis;
  design.pattern.mean = options.mean.value_or(kMean);
  design.pattern.amplitude = options.amplitude.value_or(kAmplitude);
  design.pattern.projector_size = Eigen::Vector2i(width, height);
  add_stripes(options, axis == Axis::y ? width : height, design);
  return design;
}

/// Checks that the panel holds at least one period and that all numbers are in range.
void check_design(const Pattern& pattern) {
  const int length =
      pattern.axis == Axis::y ? pattern.projector_size->y() : pattern.projector_size->x();
  if (!(pattern.period <= length)) {
    throw InvalidInput(std::vector<MessagePart>{
        {"PatternOptions::period", true},
        {fmt::format(": {:g} px does not fit on the {} px of the projector along {}; take a "
                     "shorter one, or smaller ",
                     pattern.period, length, pattern.axis == Axis::y ? 'y' : 'x')},
        {"PatternOptions::min_camera_period", true},
        {" and "},
        {"PatternOptions::min_projector_period", true}});
  }
  check_pattern(pattern, "PatternOptions");
}

}  // namespace

void visit(PatternOptions& options, FieldVisitor& visitor) {
  const Interval periods = at_least(kNyquistPeriod).finite();
  visitor.begin("PatternOptions");
  visitor.whole({"number_of_colors", "Number of stripe colours"}, options.number_of_colors,
                at_least(2).at_most(24));
  visitor.whole({"stripes",
                 "Number of stripes. Without it: the maximum, with each ordered pair of colours "
                 "as neighbours once"},
                options.stripes, at_least(2));
  visitor.choice({"axis",
                  "Axis along which the sinusoid varies: x, y, or auto, the axis along which the "
                  "depth shifts the pattern more"},
                 options.axis, kAxes);
  visitor.real({"period",
                "Period of the sinusoid. Without it: the shortest that min_camera_period and "
                "min_projector_period allow",
                "projector px"},
               options.period, periods);
  visitor.real(
      {"min_camera_period",
       "With a rig: shortest period in the image of the camera, on surfaces that face it", "px"},
      options.min_camera_period, periods);
  visitor.real({"min_projector_period", "Shortest period in the projector", "px"},
               options.min_projector_period, periods);
  visitor.real({"mean",
                "Mean brightness of the sinusoid. Without it: 0.575, at which the troughs just "
                "show the hue of the stripes; 0.5 for several images",
                "of white"},
               options.mean, above(0).below(1));
  visitor.real({"amplitude",
                "Amplitude of the sinusoid. Without it: 0.425, which reaches white; 0.5 for "
                "several images",
                "of white"},
               options.amplitude, above(0).at_most(0.5));
}

PatternDesign design_pattern(const Rig& rig, const PatternOptions& options) {
  check_rig(rig, "rig");
  check_options(options);
  const RigFigures view = look_at(rig, options.range ? *options.range : overlap_range(rig));
  const Axis axis =
      options.axis.value_or(view.per_depth[0] > view.per_depth[1] ? Axis::x : Axis::y);
  PatternDesign design = start_design(options, axis, rig.projector.width, rig.projector.height);
  const std::size_t along = axis == Axis::x ? 0 : 1;
  const std::size_t across = 1 - along;
  if (!(view.per_depth[along] > 0)) {
    const bool is_x = axis == Axis::x;
    throw InvalidInput(std::vector<MessagePart>{
        {"PatternOptions::axis", true},
        {fmt::format(": with this rig a sinusoid along {} does not change with the depth; take {}",
                     is_x ? 'x' : 'y', is_x ? 'y' : 'x')}});
  }
  const double least =
      std::max(options.min_projector_period, options.min_camera_period * view.steepest[along]);
  const double period = options.period.value_or(std::ceil(least - kWholeTolerance));
  design.pattern.period = period;
  design.camera_period = period / view.steepest[along];
  design.phase_per_relative_depth =
      2 * std::numbers::pi / period * view.per_depth[along] * view.middle_z;
  // Half a period, converted to a depth, to a shift across the stripes, and to camera pixels.
  design.edge_tolerance =
      period / 2 / view.per_depth[along] * view.per_depth[across] / view.per_pixel[across];
  check_design(design.pattern);
  if (!(design.phase_per_relative_depth >= kLeastPhase)) {
    std::ostringstream message;
    message << "PatternOptions: range: from a distance of " << view.middle_z
            << " mm on, the phase changes by " << design.phase_per_relative_depth
            << " rad alone, less than its noise; the distances are too far for the rig's baseline "
               "of "
            << rig.T_projector_camera.translation().norm() << " mm";
    throw InvalidInput(message.str());
  }
  return design;
}

PatternDesign design_pattern(int projector_width, int projector_height,
                             const PatternOptions& options) {
  check_options(options);
  require("design_pattern(): projector_width", projector_width, at_least(1), "px");
  require("design_pattern(): projector_height", projector_height, at_least(1), "px");
  PatternDesign design =
      start_design(options, options.axis.value_or(Axis::y), projector_width, projector_height);
  design.pattern.period = options.period.value_or(
      std::max(kPeriodWithoutRig, std::ceil(options.min_projector_period - kWholeTolerance)));
  check_design(design.pattern);
  return design;
}

Pattern multishot_pattern(const Pattern& single, int steps, const ImageSize& panel) {
  check_pattern(single, "multishot_pattern(): single");
  require("multishot_pattern(): steps", steps, at_least(3).at_most(64));
  const int length = single.axis == Axis::x ? panel.width : panel.height;
  require("multishot_pattern(): panel", length, at_least(1), "px");
  Pattern pattern = single;
  pattern.colors.clear();
  pattern.stripes.clear();
  pattern.stripe_edges.clear();
  pattern.projector_size = Eigen::Vector2i(panel.width, panel.height);
  Multishot& shots = pattern.multishot.emplace();
  for (int k = 0; k < steps; ++k) shots.shifts.push_back(2 * std::numbers::pi * k / steps);
  shots.code_cell = pattern.period / 2;
  const double cells = std::ceil((length - 0.5 - shots.code_start) / shots.code_cell);
  shots.code_bits = std::max(1, static_cast<int>(std::ceil(std::log2(cells))));
  check_pattern(pattern, "multishot_pattern()");
  return pattern;
}

}  // namespace palpate::sensing
