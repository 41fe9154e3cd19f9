// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
//
// How near the settings that `reduce_model` chooses come to the best ones, for docs/reduce.md. Its
// three settings, the contacts that remain, the tolerance of the surface and that of fields with
// fewer bases, are swept on objects on which it was not tuned. Both are judged by the same strokes,
// and may differ as much from the full model.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <limits>
#include <numeric>
#include <string>
#include <vector>

#include "palpate/core/error.h"
#include "palpate/geometry/decimation.h"
#include "palpate/geometry/error_statistics.h"
#include "palpate/haptics/build_model.h"
#include "palpate/haptics/model_io.h"
#include "palpate/haptics/playback.h"
#include "palpate/haptics/reduce_model.h"
#include "palpate/probing/closed_form.h"
#include "reduce/contact_subset.h"
#include "reduce/reduced_uncertainty.h"
#include "reduce/simpler_fields.h"
#include "reduce/strokes.h"
#include "reduce/thinning.h"
#include "strip_acquisition.h"

namespace palpate {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;
using haptics::Model;

// Allowed differences from the full model, relative to the RMS force.
constexpr std::array kAllowed{0.04, 0.08, 0.16};
// The sweep: differences by fewer contacts, and errors of fields, relative to the RMS force;
// numbers of evenly spread contacts; tolerances of the surface relative to its diagonal.
constexpr std::array kOfContacts{0.0,  0.02, 0.025, 0.03, 0.035, 0.04, 0.05, 0.06,
                                 0.07, 0.08, 0.1,   0.12, 0.14,  0.16, 0.2};
constexpr std::array<std::size_t, 12> kSpread{3, 4, 5, 6, 8, 10, 13, 16, 20, 25, 30, 36};
constexpr std::array kOfFields{0.0, 0.01, 0.02, 0.04, 0.07, 0.11};
constexpr std::array kOfSurface{1e-3, 5e-4, 2.5e-4, 1.25e-4};
constexpr int kStrokes = 5000, kRounds = 40;

/// A model with less than the full one.
struct Smaller {
  double difference = 0;  // [N] RMS
  double size = 0;        // [bytes]
  Model model;
};

template <typename Object>
Model measured(const Object& object, double middle, double half_x, double half_y) {
  const support::StripProbing probing{.directions = 4};
  probing::Acquisition acquisition;
  support::ObjectProbe<Object> probe(object, probing);
  bool shifted = false;
  for (double y = -half_y; y <= half_y + 1e-9; y += 2 * half_y / 6, shifted = !shifted)
    for (double x = -half_x + (shifted ? half_x / 6 : 0); x <= half_x + 1e-9; x += half_x / 3)
      probe.probe(acquisition, middle + x, y);
  return haptics::build_model(probing::CheckedAcquisition(std::move(acquisition)),
                              probing::make_specimen(object)->surface())
      .model;
}

// [us] Time of a step along strokes, which is added to the least of earlier rounds.
void time_steps(const Model& model, const std::vector<haptics::Stroke>& strokes, double& least) {
  constexpr int kSteps = 40;
  constexpr std::size_t kPlayed = 200;
  const haptics::Playback playback(model);
  int steps = 0;
  double sum = 0;
  const auto start = std::chrono::steady_clock::now();
  for (std::size_t i = 0; i < std::min(kPlayed, strokes.size()); ++i) {
    haptics::LoopState state;
    const auto go = [&](const Vector3d& from, const Vector3d& to) {
      for (int k = 1; k <= kSteps; ++k, ++steps)
        sum += playback.step(from + double(k) / kSteps * (to - from), state).force.z();
    };
    go(strokes[i].start, strokes[i].pressed);
    go(strokes[i].pressed, strokes[i].dragged);
  }
  const std::chrono::duration<double, std::micro> time = std::chrono::steady_clock::now() - start;
  if (std::isfinite(sum)) least = std::min(least, time.count() / steps);
}

/// The strokes by which `reduce_model` chooses, and those by which it measures.
struct Strokes {
  std::vector<haptics::Stroke> strokes;
  std::vector<haptics::StrokeEnd> ends;

  Strokes(const Model& model, const haptics::StrokeSettings& settings)
      : strokes(random_strokes(model, settings)), ends(play_strokes(model, strokes)) {}
  [[nodiscard]] double difference(const Model& reduced) const {
    return geometry::error_statistics(force_differences(ends, play_strokes(reduced, strokes))).rms;
  }
  [[nodiscard]] double force() const {
    double sum = 0;
    for (const haptics::StrokeEnd& end : ends) sum += end.force.squaredNorm();
    return std::sqrt(sum / static_cast<double>(ends.size()));
  }
};

Smaller judged(const Model& model, const Strokes& measuring) {
  return {measuring.difference(model), haptics::folder_size(model), model};
}

// The contacts that lie farthest from those before them.
std::vector<std::size_t> spread_contacts(const Model& model, std::size_t count) {
  std::vector<std::size_t> kept{0};
  std::vector<double> distances(model.contacts.size(), std::numeric_limits<double>::infinity());
  while (kept.size() < std::min(count, model.contacts.size())) {
    for (std::size_t i = 0; i < distances.size(); ++i) {
      distances[i] = std::min(
          distances[i], (model.contacts[i].position - model.contacts[kept.back()].position).norm());
    }
    kept.push_back(static_cast<std::size_t>(
        std::distance(distances.begin(), std::ranges::max_element(distances))));
  }
  std::ranges::sort(kept);
  return kept;
}

// Contacts that may remain: as `reduce_model` would choose them for many errors, and evenly spread.
std::vector<std::vector<std::size_t>> choices_of_contacts(const Model& model,
                                                          const Strokes& choosing, double force) {
  std::vector<std::size_t> all(model.contacts.size());
  std::iota(all.begin(), all.end(), 0);
  haptics::ContactThinning thinning(model, all, choosing.strokes, choosing.ends);
  std::vector<std::vector<std::size_t>> choices;
  for (const double error : kOfContacts)
    choices.push_back(thinning.within(error * force, [] {}).kept);
  for (const std::size_t count : kSpread) choices.push_back(spread_contacts(model, count));
  std::ranges::sort(choices);
  choices.erase(std::unique(choices.begin(), choices.end()), choices.end());
  return choices;
}

std::vector<Smaller> swept(const Model& model, const Strokes& choosing, const Strokes& measuring,
                           const haptics::StrokeSettings& settings) {
  const std::vector<double> depths = press_depths(model, settings);
  std::vector<geometry::Decimation> surfaces;
  for (const double share : kOfSurface) {
    surfaces.push_back(geometry::decimate(
        model.surface, {.tolerance = share * geometry::bounding_diagonal(model.surface)}));
  }
  std::vector<Smaller> result;
  for (const auto& kept : choices_of_contacts(model, choosing, measuring.force())) {
    Model fewer;
    try {
      fewer = with_contacts(model, kept);
    } catch (const Error&) {
      continue;  // these have no triangulation
    }
    std::vector<double> of_kept;
    for (const std::size_t i : kept) of_kept.push_back(depths[i]);
    for (const geometry::Decimation& surface : surfaces) {
      const Model coarse = on_surface(fewer, surface.mesh);
      for (const double of_fields : kOfFields) {
        Model simple = coarse;
        if (of_fields > 0 && simplify_fields(simple, of_fields * measuring.force(), of_kept) == 0)
          continue;
        result.push_back(judged(simple, measuring));
      }
    }
  }
  return result;
}

void compare(const std::string& name, const Model& model) {
  haptics::ReduceOptions options{.strokes = kStrokes};
  haptics::StrokeSettings settings = stroke_settings(model, options), few = settings;
  few.count = static_cast<int>(haptics::kChoosing * kStrokes);
  few.seed += 1U << 31;
  const Strokes measuring(model, settings), choosing(model, few);
  const double own = stated_error(model, measuring.ends).value_or(0), force = measuring.force();
  const std::vector<Smaller> sweep = swept(model, choosing, measuring, settings);
  for (const double share : kAllowed) {
    const double allowed = share * force;
    options.max_error = std::hypot(allowed, own);
    const haptics::ReducedModel reduced = haptics::reduce_model(model, options);
    const Smaller chosen = judged(reduced.model, measuring);
    Smaller best{.size = std::numeric_limits<double>::infinity()};
    for (const Smaller& each : sweep)
      if (each.difference <= reduced.allowed && each.size < best.size) best = each;
    // In turns, because other programs may slow this one.
    double step = std::numeric_limits<double>::infinity(), best_step = step;
    for (int round = 0; round < kRounds; ++round) {
      time_steps(chosen.model, measuring.strokes, step);
      time_steps(best.model, measuring.strokes, best_step);
    }
    const auto of = [](const Smaller& model, double time) {
      return fmt::format("{:.3f} | {} | {} | {:.1f} | {:.2f}", model.difference,
                         model.model.contacts.size(), model.model.surface.vertices.cols(),
                         model.size / 1e3, time);
    };
    fmt::print("| {} | {:.3f} | {} | {} | {:.2f} | {:.2f} |\n", name, reduced.allowed,
               of(chosen, step), of(best, best_step), chosen.size / best.size, step / best_step);
    std::fflush(stdout);
  }
}

}  // namespace
}  // namespace palpate

int main() {
  using namespace palpate;
  fmt::print(
      "| object | allowed [N] | reduce: difference [N] | contacts | vertices | kB | step [us] "
      "| best of the sweep: difference [N] | contacts | vertices | kB | step [us] "
      "| kB, reduce / best | step, reduce / best |\n"
      "|---|---|---|---|---|---|---|---|---|---|---|---|---|---|\n");
  compare("slack sheet with soft block",
          measured(probing::Sheet{.tension = 0.6, .lateral = 0.06, .taper = 0.5, .block = 0.7}, 0,
                   42, 60));
  compare("tight sheet",
          measured(probing::Sheet{.tension = 1.4, .lateral = 0.1, .taper = 0.2, .block = 0.4}, 0,
                   42, 60));
  compare("elastic body", measured(probing::ElasticBody{}, 0, 42, 42));
  compare("very uneven beam", measured(probing::Beam{.local_variation = 0.3}, 100, 90, 18));
}
