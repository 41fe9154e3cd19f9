// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "reduce/strokes.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>

#include "build/contact_edges.h"
#include "palpate/core/error.h"
#include "palpate/core/parallel_for.h"
#include "palpate/core/quantile.h"
#include "palpate/haptics/blended_field.h"
#include "palpate/haptics/playback.h"

namespace palpate::haptics {
namespace {

using Eigen::Vector3d;

// At most some 0.3 m/s where contacts are 14 mm apart.
constexpr int kPressTicks = 25, kDragTicks = 50;
// Of the depth: how far outside a stroke starts.
constexpr double kClearance = 0.1;
// A drag ends where the force is more than this many times that of the deepest press at its place.
constexpr double kDragForce = 1.5;
// The model itself jumps at a stroke if the force changes by this much of that of the deepest press
// when the tool is shifted by this much of the depth in some direction.
constexpr double kJump = 0.15, kShift = 0.01;
// Strokes that are tried for each that is wanted; others leave what can be reached, or the object.
constexpr int kTries = 20;

// Uniform in [0, 1), the same everywhere.
double uniform(std::mt19937_64& random) { return static_cast<double>(random() >> 11) * 0x1p-53; }

struct ReachableArea {
  std::vector<int> triangles;
  std::vector<double> area;  // of the triangles so far
};

ReachableArea reachable_area(const geometry::TriangleMesh& surface,
                             const std::vector<bool>& reachable) {
  ReachableArea result;
  double sum = 0;
  for (int t = 0; t < surface.triangles.cols(); ++t) {
    const Eigen::Vector3i corners = surface.triangles.col(t);
    const bool counts = reachable.empty() || std::ranges::all_of(corners, [&](int v) {
                          return reachable[static_cast<std::size_t>(v)];
                        });
    if (!counts) continue;
    const Vector3d a = surface.vertices.col(corners[0]);
    sum +=
        (surface.vertices.col(corners[1]) - a).cross(surface.vertices.col(corners[2]) - a).norm();
    result.triangles.push_back(t);
    result.area.push_back(sum);
  }
  if (!(sum > 0)) {
    throw InvalidInput("the region contains no whole triangle of the surface; make it larger");
  }
  return result;
}

geometry::SurfacePoint random_place(const ReachableArea& area, std::mt19937_64& random) {
  const auto at = std::ranges::upper_bound(area.area, uniform(random) * area.area.back());
  const auto index =
      std::min(static_cast<std::size_t>(at - area.area.begin()), area.area.size() - 1);
  double u = uniform(random), v = uniform(random);
  if (u + v > 1) {
    u = 1 - u;
    v = 1 - v;
  }
  return {.triangle = area.triangles[index], .barycentric = {1 - u - v, u, v}};
}

// Steps in which the first depth with the largest force is looked for: fields need not be monotone.
constexpr int kDepthSteps = 16;
// Then it is bisected up to this, relative to it.
constexpr double kDepthTolerance = 1e-3;

// The largest depth of a press at a place.
struct DepthLimit {
  double force = std::numeric_limits<double>::infinity();  // [N]
  double depth = 0;                                        // [mm]

  [[nodiscard]] double at(const BlendedField& field, const Blend& place) const {
    const Vector3d direction = place.field_frame.col(2);
    const auto pushes = [&](double d) { return field.force(place, d * direction).dot(direction); };
    double low = 0, high = depth / kDepthSteps;
    while (pushes(high) <= force) {
      if (high >= depth) return depth;
      low = high;
      high = std::min(depth, high + depth / kDepthSteps);
    }
    while (high - low > kDepthTolerance * high) {
      const double middle = (low + high) / 2;
      (pushes(middle) <= force ? low : high) = middle;
    }
    return low;
  }
};

// [mm] Playback keeps no deeper contact of a tool that starts inside.
double start_depth(const Model& model) { return *playback_options_for(model, {}).start_depth; }

// [mm] The largest depth at which a contact yields to the reference force; those that never do were
// not measured further.
double depth_reached(const Model& model) {
  double largest = 0;
  for (const ContactModel& contact : model.contacts)
    if (contact.compliance) largest = std::max(largest, contact.compliance->values(2));
  return largest > 0 ? largest : start_depth(model);
}

DepthLimit depth_limit(const Model& model, const StrokeSettings& settings) {
  DepthLimit limit{.depth = start_depth(model)};
  const Interpolation& measured = model.interpolation;
  if (settings.largest_depth) limit.depth = *settings.largest_depth;
  if (settings.largest_force) limit.force = *settings.largest_force;
  if (settings.largest_depth || settings.largest_force) return limit;
  if (measured.reference_force > 0)
    limit = {.force = measured.reference_force, .depth = depth_reached(model)};
  else if (measured.reference_depth > 0)
    limit.depth = measured.reference_depth;
  else
    throw InvalidInput(
        "the model does not say how far it was measured; set the largest force or "
        "the largest depth");
  return limit;
}

// [mm] Median length of the edges between contacts; without edges, as if contacts were spread
// evenly.
double usual_distance(const Model& model) {
  std::vector<double> lengths = contact_edge_lengths(model);
  if (!lengths.empty()) return median(lengths);
  return geometry::bounding_diagonal(model.surface) /
         std::sqrt(static_cast<double>(model.contacts.size()));
}

// The tool moves along a straight line while the force is below a limit. Returns the last
// position, with what the tool feels there.
StrokeEnd moved(const Playback& playback, const Vector3d& from, const Vector3d& to, int ticks,
                double largest_force, LoopState& state) {
  StrokeEnd end;
  for (int i = 1; i <= ticks; ++i) {
    const Vector3d tool = from + (static_cast<double>(i) / ticks) * (to - from);
    const Command command = playback.step(tool, state);
    if (command.force.norm() > largest_force) break;
    end = {.tool = tool,
           .contact = command.contact,
           .force = -command.force,
           .touches = command.state != ContactState::free};
  }
  return end;
}

std::vector<StrokeEnd> ends_of(const Playback& playback, const Stroke& stroke,
                               double largest_force = std::numeric_limits<double>::infinity()) {
  LoopState state;
  const bool starts_inside = playback.step(stroke.start, state).state != ContactState::free;
  std::vector<StrokeEnd> ends{
      moved(playback, stroke.start, stroke.pressed, kPressTicks, largest_force, state)};
  if (starts_inside) ends.back().touches = false;
  if (stroke.dragged != stroke.pressed)
    ends.push_back(
        moved(playback, ends.front().tool, stroke.dragged, kDragTicks, largest_force, state));
  return ends;
}

Stroke shifted(Stroke stroke, const Vector3d& by) {
  for (Vector3d* position : {&stroke.start, &stroke.pressed, &stroke.dragged}) *position += by;
  return stroke;
}

// Returns true if a model that differs a little may feel quite different.
bool jumps(const Playback& playback, const Stroke& stroke, const std::vector<StrokeEnd>& ends,
           double largest_force, std::mt19937_64& random) {
  const double by = kShift * (stroke.pressed - stroke.start).norm();
  const double height = 2 * uniform(random) - 1, angle = 2 * std::numbers::pi * uniform(random);
  const double across = std::sqrt(1 - height * height);
  const Vector3d direction(across * std::cos(angle), across * std::sin(angle), height);
  const std::vector<double> changes =
      force_differences(ends, ends_of(playback, shifted(stroke, by * direction)));
  return std::ranges::max(changes) > kJump / kDragForce * largest_force;
}

}  // namespace

StrokeSettings stroke_settings(const Model& model, const ReduceOptions& options) {
  const auto vertices = static_cast<std::size_t>(model.surface.vertices.cols());
  if (!options.reachable.empty() && options.reachable.size() != vertices) {
    throw InvalidInput(
        fmt::format("reachable has {} values; the surface of the model has {} vertices",
                    options.reachable.size(), vertices));
  }
  return {.count = options.strokes,
          .seed = static_cast<std::uint64_t>(options.seed) << 32,
          .reachable = options.reachable,
          .largest_force = options.largest_force,
          .largest_depth = options.largest_depth,
          .drags = options.slip};
}

std::vector<Stroke> random_strokes(const Model& model, const StrokeSettings& settings) {
  const ReachableArea area = reachable_area(model.surface, settings.reachable);
  const DepthLimit limit = depth_limit(model, settings);
  const double longest = usual_distance(model), at_once = force_at_once(model.rate);
  const BlendedField field(model);
  const Playback playback(model);
  const auto is_reachable = [&](const Vector3d& place) {
    if (settings.reachable.empty()) return true;
    const int triangle = field.surface().closest_point(place).at.triangle;
    return std::ranges::all_of(model.surface.triangles.col(triangle), [&](int v) {
      return settings.reachable[static_cast<std::size_t>(v)];
    });
  };
  std::vector<std::optional<Stroke>> tried(static_cast<std::size_t>(settings.count));
  parallel_for(tried.size(), [&](std::size_t i) {
    std::mt19937_64 random(settings.seed + i);
    for (int t = 0; t < kTries && !tried[i]; ++t) {
      const geometry::SurfacePoint at = random_place(area, random);
      const Blend blend = field.blend(at);
      const Vector3d place = geometry::position(model.surface, at);
      const Eigen::Matrix3d& frame = blend.field_frame;
      const double deepest = limit.at(field, blend);
      const double largest_force =
          at_once * kDragForce * field.force(blend, deepest * frame.col(2)).norm();
      const double depth = (1 - uniform(random)) * deepest;
      const double angle = 2 * std::numbers::pi * uniform(random);
      const double length = settings.drags ? longest * uniform(random) : 0;
      Stroke stroke{.start = place - kClearance * depth * frame.col(2),
                    .pressed = place + depth * frame.col(2),
                    .dragged = {}};
      stroke.dragged = stroke.pressed +
                       length * (std::cos(angle) * frame.col(0) + std::sin(angle) * frame.col(1));
      const std::vector<StrokeEnd> ends = ends_of(playback, stroke, largest_force);
      stroke.pressed = ends.front().tool;
      stroke.dragged = ends.back().tool;
      if (std::ranges::all_of(
              ends,
              [&](const StrokeEnd& end) { return end.touches && is_reachable(end.contact); }) &&
          !jumps(playback, stroke, ends, largest_force, random))
        tried[i] = stroke;
    }
  });
  std::vector<Stroke> strokes;
  for (const std::optional<Stroke>& stroke : tried)
    if (stroke) strokes.push_back(*stroke);
  if (strokes.empty()) {
    throw InvalidInput(
        "no press and drag stays within the region; make it larger than the "
        "distance of two contacts, or say that nothing slips");
  }
  return strokes;
}

std::vector<double> press_depths(const Model& model, const StrokeSettings& settings) {
  const DepthLimit limit = depth_limit(model, settings);
  const BlendedField field(model);
  std::vector<double> depths(model.contacts.size());
  parallel_for(depths.size(), [&](std::size_t i) {
    depths[i] = limit.at(field, field.blend(model.contacts[i].position));
  });
  return depths;
}

std::vector<StrokeEnd> play_strokes(const Model& model, std::span<const Stroke> strokes) {
  const Playback playback(model);
  std::vector<std::vector<StrokeEnd>> of_stroke(strokes.size());
  parallel_for(strokes.size(),
               [&](std::size_t i) { of_stroke[i] = ends_of(playback, strokes[i]); });
  std::vector<StrokeEnd> ends;
  for (const std::vector<StrokeEnd>& each : of_stroke)
    ends.insert(ends.end(), each.begin(), each.end());
  return ends;
}

std::vector<double> force_differences(std::span<const StrokeEnd> a, std::span<const StrokeEnd> b) {
  std::vector<double> differences;
  for (std::size_t i = 0; i < a.size(); ++i)
    differences.push_back((a[i].force - b[i].force).norm());
  return differences;
}

}  // namespace palpate::haptics
