// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/sensing/rig_doubts.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>

#include "palpate/core/quantile.h"
#include "setup/baseline.h"

namespace palpate::sensing {
namespace {

constexpr double kDegree = std::numbers::pi / 180;

/// Rectilinear lenses of the widest angle reach 60 degrees from the axis. At 80 degrees, a pixel
/// sees a 33rd of the angle that one in the middle sees, and a thousandth of its light.
constexpr double kWide = 65 * kDegree;
constexpr double kWidest = 80 * kDegree;
/// Part of a larger image has its principal point outside. A corner of the image of a wide-angle
/// lens is this far from the axis.
constexpr double kFarFromAxis = 30 * kDegree;
/// With 800 pixels across, each would see half a second of arc, which takes an aperture of 200 mm.
constexpr double kNarrow = 0.1 * kDegree;

/// Lengths [mm]: outside the inner bounds unlikely, outside the outer ones impossible. Between
/// `usual` no other unit is likely.
struct Bounds {
  double least, low, high, most;
  std::array<double, 2> usual;
};
/// Two lenses side by side need 10 mm, light paths through a common objective a few. Over more than
/// some metres, structured light is too weak.
constexpr Bounds kBaseline{1, 10, 5e3, 5e4, {30, 1000}};
/// From microscopes to the range of the longest laser scanners.
constexpr Bounds kDepth{1, 10, 1e5, 1e7, {100, 10000}};

/// The units in which `length` would be a usual one; empty if none.
std::string likely_units(double length, const Bounds& bounds) {
  struct Unit {
    const char* name;
    double mm;
  };
  std::string text;
  for (const Unit& unit :
       {Unit{"metres", 1000}, {"inches", 25.4}, {"cm", 10}, {"micrometres", 1e-3}}) {
    const double in_mm = length * unit.mm;
    if (in_mm < bounds.usual[0] || in_mm > bounds.usual[1]) continue;
    text += fmt::format("{}{:.4g} mm if the number is in {}", text.empty() ? "" : ", ", in_mm,
                        unit.name);
  }
  return text;
}

/// \param what the length in words, with its value.
void judge_length(const char* subject, const std::string& what, double length, const Bounds& bounds,
                  std::vector<Doubt>& doubts) {
  if (!(length < bounds.low || length > bounds.high)) return;
  const bool impossible = length < bounds.least || length > bounds.most;
  const std::string units = likely_units(length, bounds);
  doubts.push_back(
      {subject,
       fmt::format("{}, which is {}; lengths are in mm{}", what,
                   impossible ? "impossible" : "unlikely", units.empty() ? "" : " (" + units + ")"),
       impossible});
}

/// \param is_centered true if the principal point must be near the image.
void judge_lens(const char* subject, const geometry::Camera& lens, bool is_centered,
                std::vector<Doubt>& doubts) {
  const Eigen::Vector2d center(lens.cx, lens.cy);
  const Eigen::Vector2d focal(lens.fx, lens.fy);
  const auto angle_at = [&](double column, double row) {
    return std::atan((Eigen::Vector2d(column, row) - center).cwiseQuotient(focal).norm());
  };
  const double right = lens.width - 1;
  const double bottom = lens.height - 1;
  const double widest =
      std::max({angle_at(0, 0), angle_at(right, 0), angle_at(0, bottom), angle_at(right, bottom)});
  const double middle = angle_at(right / 2, bottom / 2);
  const bool is_outside = lens.cx < 0 || lens.cx > right || lens.cy < 0 || lens.cy > bottom;
  const auto doubt = [&](const std::string& what, bool impossible) {
    doubts.push_back(
        {subject,
         fmt::format("{}: fx {:.6g}, fy {:.6g}, cx {:.6g}, cy {:.6g} px of an image of {} x {} px "
                     "are {}: {}. Give all in pixels (a focal length in mm divided by the width "
                     "of a pixel), in this order, of images of this size",
                     subject, lens.fx, lens.fy, lens.cx, lens.cy, lens.width, lens.height,
                     impossible ? "impossible" : "unlikely", what),
         impossible});
  };
  if (widest > kWide) {
    doubt(fmt::format("a corner of the image would be {:.0f} degrees from the optical axis",
                      widest / kDegree),
          widest > kWidest);
  } else if (is_centered && is_outside && middle > kFarFromAxis) {
    doubt(fmt::format("the middle of the image would be {:.0f} degrees from the optical axis",
                      middle / kDegree),
          false);
  }
  const double across =
      2 * std::atan(Eigen::Vector2d(right, bottom).cwiseQuotient(2 * focal).norm());
  if (across > 0 && across < kNarrow)
    doubt(fmt::format("the whole image would be {:.2g} degrees wide", across / kDegree), false);
}

/// Other units of a depth image with which its depths would be usual ones: a scale is often given
/// in metres, or is the number of units in a metre.
std::string likely_scales(double depth, double mm_per_unit) {
  std::string text = fmt::format(". One unit of the image counts as {:g} mm", mm_per_unit);
  const double units = depth / mm_per_unit;
  for (const double likely : {1000 * mm_per_unit, 1000 / mm_per_unit, mm_per_unit / 1000}) {
    const double mm = units * likely;
    if (mm < kDepth.usual[0] || mm > kDepth.usual[1]) continue;
    return text +
           fmt::format("; with {:g} mm, half of the depths would be below {:.4g} mm", likely, mm);
  }
  return text;
}

}  // namespace

std::vector<Doubt> camera_doubts(const geometry::Camera& camera) {
  std::vector<Doubt> doubts;
  judge_lens("camera", camera, true, doubts);
  return doubts;
}

std::vector<Doubt> rig_doubts(const Rig& rig) {
  std::vector<Doubt> doubts = camera_doubts(rig.camera);
  judge_lens("projector", rig.projector, false, doubts);
  const double baseline = rig.T_projector_camera.translation().norm();
  judge_length("t", fmt::format("t: the projector is {:.3g} mm from the camera", baseline),
               baseline, kBaseline, doubts);
  return doubts;
}

std::vector<Doubt> sinusoid_doubts(const Rig& rig, const Pattern& pattern) {
  if (shows_steps(rig, pattern.axis)) return {};
  const Eigen::Array2d parts = parts_of_baseline(rig);
  const int along = pattern.axis == Axis::x ? 0 : 1;
  return {
      {.subject = "axis",
       .message = fmt::format(
           "axis: only {:.0f} % of the baseline between camera and projector lies along the "
           "sinusoid, which therefore hardly shows steps: there are depths only if the anchored "
           "regions hold most of what shows the sinusoid, as a single smooth surface does. For "
           "several surfaces, project stripes or a pattern with --axis {} ({:.0f} %), or give "
           "an anchor on each",
           100 * parts[along], along == 0 ? "y" : "x", 100 * parts[1 - along])}};
}

std::vector<Doubt> depth_doubts(double depth) {
  std::vector<Doubt> doubts;
  judge_length("depths", fmt::format("depths: half of them are below {:.3g} mm", depth), depth,
               kDepth, doubts);
  return doubts;
}

std::vector<Doubt> range_map_doubts(const geometry::RangeMap& map,
                                    std::optional<double> mm_per_unit) {
  constexpr Eigen::Index kLooks = 10'000;  // pixels that give the median
  std::vector<Doubt> doubts = camera_doubts(map.camera);
  std::vector<double> depths;
  const Eigen::Index step = map.z.size() / kLooks + 1;
  for (Eigen::Index i = 0; i < map.z.size(); i += step) {
    if (!std::isnan(map.z.data()[i])) depths.push_back(static_cast<double>(map.z.data()[i]));
  }
  if (depths.empty()) return doubts;
  const double depth = median(depths);
  std::vector<Doubt> more = depth_doubts(depth);
  for (Doubt& doubt : more) {
    if (mm_per_unit) doubt.message += likely_scales(depth, *mm_per_unit);
    doubts.push_back(std::move(doubt));
  }
  return doubts;
}

std::string impossible_parts(const std::vector<Doubt>& doubts) {
  std::string text;
  for (const Doubt& doubt : doubts) {
    if (doubt.impossible) text += (text.empty() ? "" : ". Also, ") + doubt.message;
  }
  return text;
}

}  // namespace palpate::sensing
