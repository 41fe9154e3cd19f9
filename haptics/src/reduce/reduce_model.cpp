// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/haptics/reduce_model.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>
#include <set>
#include <utility>

#include "palpate/core/error.h"
#include "palpate/geometry/decimation.h"
#include "palpate/haptics/model_io.h"
#include "reduce/asked_error.h"
#include "reduce/contact_subset.h"
#include "reduce/reduced_response.h"
#include "reduce/reduced_uncertainty.h"
#include "reduce/simpler_fields.h"
#include "reduce/strokes.h"
#include "reduce/thinning.h"

namespace palpate::haptics {
namespace {

// Their seeds begin that far from those of the others: beyond the largest number of strokes.
constexpr std::uint64_t kOtherStrokes = 1U << 31;
// Shares of the allowed mean square that fewer contacts may use, and then a coarser surface. Which
// of them makes the smallest model depends on the object: all are tried.
struct SharesOfError {
  double contacts, surface;
};
constexpr std::array<SharesOfError, 3> kSharesOfError{{{0.6, 0.2}, {0.6, 0.4}, {0.95, 0.05}}};
// Of a model that states no error, relative to the force, if nothing is asked for.
constexpr double kShareOfForce = 0.01;
// Of the surface, relative to its diagonal: a pixel of a picture of 1000 pixels.
constexpr double kSurfaceShown = 1e-3;
// Tolerances of decimation that are tried, each half of the one before.
constexpr int kTolerances = 8;
// Allowed errors are doubled until the size holds, at most up to this factor; then the least factor
// is searched, up to 2^(1/8).
constexpr double kMostRaised = 256;
constexpr int kScaleHalvings = 3;
// Number of errors of simpler fields that are tried, each half of the one before.
constexpr int kFieldErrors = 6;
// Number of reductions of the allowed error if strokes that did not choose find a larger one.
constexpr int kCorrections = 10;
// At least this much less each time.
constexpr double kCorrection = 0.9;
// Errors that differ by less are the same, relative to them.
constexpr double kRounding = 1e-9;
// Models that are tried, for the progress; it waits below the end if there are more.
constexpr int kUsualModels = 60;

double rms_force(std::span<const StrokeEnd> ends) {
  double sum = 0;
  for (const StrokeEnd& end : ends) sum += end.force.squaredNorm();
  return std::sqrt(sum / static_cast<double>(ends.size()));
}

/// A set of strokes, as the full model plays them.
struct PlayedStrokes {
  std::vector<Stroke> strokes;
  std::vector<StrokeEnd> ends;

  [[nodiscard]] geometry::ErrorStatistics difference(const Model& reduced) const {
    return geometry::error_statistics(force_differences(ends, play_strokes(reduced, strokes)));
  }
};

PlayedStrokes played(const Model& model, const StrokeSettings& settings) {
  PlayedStrokes result{.strokes = random_strokes(model, settings), .ends = {}};
  result.ends = play_strokes(model, result.strokes);
  return result;
}

// Marks the contacts that have weight at a vertex that can be reached.
std::vector<bool> needed_contacts(const Model& model, const std::vector<bool>& reachable) {
  std::vector<bool> needed(model.contacts.size(), reachable.empty());
  if (reachable.empty()) return needed;
  const geometry::SurfaceWeights weights = vertex_weights(model);
  for (Eigen::Index v = 0; v < weights.contacts.cols(); ++v) {
    for (Eigen::Index k = 0; k < 3; ++k) {
      if (reachable[static_cast<std::size_t>(v)] && weights.weights(k, v) > 0)
        needed[static_cast<std::size_t>(weights.contacts(k, v))] = true;
    }
  }
  if (const auto count = std::ranges::count(needed, true); count < 3) {
    throw InvalidInput(fmt::format(
        "{} contacts have influence in the region; a model needs at least three. Make the region "
        "larger",
        count));
  }
  return needed;
}

std::vector<std::size_t> indices_where(const std::vector<bool>& values, bool wanted) {
  std::vector<std::size_t> result;
  for (std::size_t i = 0; i < values.size(); ++i)
    if (values[i] == wanted) result.push_back(i);
  return result;
}

/// The differences that a reduction may cause.
struct Allowed {
  double force = 0;    // [N] RMS difference from the full model
  double surface = 0;  // [mm]
};

/// The data that all attempts to reduce a model share.
struct Source {
  const Model& model;
  const ReduceOptions& options;
  std::vector<std::size_t> in_reach, beyond;  // contacts
  const PlayedStrokes& choosing;
  ContactThinning thinning;
  std::vector<double> depths;     // [mm] of presses at the contacts
  std::vector<double> too_small;  // [N] error within which the contacts have no simpler fields
  std::function<void()> tried;
  std::map<double, geometry::Decimation> surfaces;  // by tolerance

  const geometry::Decimation& surface(double tolerance) {
    const auto known = surfaces.find(tolerance);
    if (known != surfaces.end()) return known->second;
    return surfaces[tolerance] = geometry::decimate(model.surface, {.tolerance = tolerance});
  }
};

// Puts the model on the coarsest surface with which it feels alike.
// \param share of the allowed mean square that it may use.
void coarsen(Source& source, const Allowed& allowed, double share, ReducedModel& result) {
  const double most = std::hypot(result.rms_of_contacts, std::sqrt(share) * allowed.force);
  double tolerance = allowed.surface;
  for (int i = 0; i < kTolerances && tolerance > 0; ++i, tolerance /= 2) {
    const geometry::Decimation& coarse = source.surface(tolerance);
    Model model = on_surface(result.model, coarse.mesh);
    const double error = source.choosing.difference(model).rms;
    source.tried();
    if (error > most) continue;
    result.model = std::move(model);
    result.rms_of_contacts_and_surface = error;
    result.surface_distance = coarse.distance;
    return;
  }
}

// Gives contacts simpler fields, with what the other steps left of the allowed error.
void simplify(Source& source, std::span<const std::size_t> kept, const Allowed& allowed,
              ReducedModel& result) {
  std::vector<double> depths, too_small;
  for (const std::size_t i : kept) {
    depths.push_back(source.depths[i]);
    too_small.push_back(source.too_small[i]);
  }
  double error = std::sqrt(
      std::max(0.0, std::pow(allowed.force, 2) - std::pow(result.rms_of_contacts_and_surface, 2)));
  const Model before = result.model;
  for (int i = 0; i < kFieldErrors; ++i, error /= 2) {
    result.model = before;
    result.simpler_fields = simplify_fields(result.model, error, depths, too_small);
    for (std::size_t k = 0; k < kept.size(); ++k) source.too_small[kept[k]] = too_small[k];
    const double now = source.choosing.difference(result.model).rms;
    source.tried();
    if (now <= allowed.force) return;
  }
  result.model = before;
  result.simpler_fields = 0;
}

// Ids of the contacts that are in the first list and not in the second one; both ascend.
std::vector<long long> ids_without(const Model& model, std::span<const std::size_t> all,
                                   std::span<const std::size_t> without) {
  std::vector<std::size_t> rest;
  std::ranges::set_difference(all, without, std::back_inserter(rest));
  std::vector<long long> ids;
  for (const std::size_t i : rest) ids.push_back(model.contacts[i].id);
  return ids;
}

// What remains of contacts and surface, with simpler fields.
void complete(Source& source, std::span<const std::size_t> kept, const Allowed& allowed,
              ReducedModel& result) {
  if (allowed.force > 0) simplify(source, kept, allowed, result);
  result.out_of_reach = ids_without(source.model, source.beyond, kept);
  result.predicted = ids_without(source.model, source.in_reach, kept);
  if (source.model.response && source.options.keep_shapes)
    result.model.response = reduced_response(source.model, result.model.surface, kept);
  result.size_after = folder_size(result.model);
}

// Models that differ by the allowed error, the smallest first.
std::vector<ReducedModel> reduced_within(Source& source, const Allowed& allowed) {
  std::vector<ReducedModel> models;
  std::set<std::pair<std::vector<std::size_t>, double>> known;  // contacts and surfaces
  for (const SharesOfError& shares : kSharesOfError) {
    const ThinnedContacts thinned =
        source.thinning.within(std::sqrt(shares.contacts) * allowed.force, source.tried);
    ReducedModel result;
    result.model = thinned.model;
    result.rms_of_contacts = thinned.error;
    result.rms_of_contacts_and_surface = thinned.error;
    if (allowed.force > 0) coarsen(source, allowed, shares.surface, result);
    if (!known.emplace(thinned.kept, result.surface_distance).second) continue;
    complete(source, thinned.kept, allowed, result);
    models.push_back(std::move(result));
  }
  std::ranges::stable_sort(models, {}, &ReducedModel::size_after);
  return models;
}

// [mm] The least of what is asked for.
double allowed_surface_error(const Source& source) {
  const double diagonal = geometry::bounding_diagonal(source.model.surface);
  const ReduceOptions& options = source.options;
  if (!options.max_surface_error && !options.picture_size) return kSurfaceShown * diagonal;
  double allowed = options.max_surface_error.value_or(std::numeric_limits<double>::infinity());
  if (options.picture_size) allowed = std::min(allowed, diagonal / *options.picture_size);
  return allowed;
}

// \param own [N] error that the full model states, \param least [N] that the reduced one may have.
Allowed allowed_errors(const Source& source, double own, double least,
                       const std::optional<double>& asked) {
  const double whole = std::max(asked.value_or(least), own > 0 ? least : 0);
  return {.force = std::sqrt(whole * whole - own * own), .surface = allowed_surface_error(source)};
}

// Completes the model with what it says of itself.
void describe(const Source& source, const PlayedStrokes& measuring, ReducedModel& result) {
  state_reduced_errors(source.model, measuring.ends, result.model);
  result.stated_after = stated_error(result.model, measuring.ends);
  result.model.made["reduced"] = fmt::format("from {} contacts; forces differ by {:.3g} N (RMS)",
                                             source.model.contacts.size(), result.difference.rms);
  result.size_after = folder_size(result.model);
}

// The smallest of these models that strokes which did not choose find within the allowed error.
// Empty if none is within `most_bytes`.
std::optional<ReducedModel> measured_within(Source& source, const PlayedStrokes& measuring,
                                            const Allowed& allowed, double most_bytes) {
  Allowed corrected = allowed;
  for (int i = 0;; ++i) {
    std::vector<ReducedModel> models = reduced_within(source, corrected);
    if (models.front().size_after > most_bytes) return std::nullopt;
    double least = std::numeric_limits<double>::infinity();
    for (ReducedModel& result : models) {
      result.difference = measuring.difference(result.model);
      least = std::min(least, result.difference.rms);
      if (result.difference.rms > allowed.force && i <= kCorrections) continue;
      describe(source, measuring, result);
      if (result.size_after > most_bytes) return std::nullopt;
      return std::move(result);
    }
    // At last with all contacts in reach and their neighbours, on the surface as it is.
    corrected.force *= i < kCorrections ? std::min(kCorrection, allowed.force / least) : 0;
  }
}

Allowed raised_by(double factor, const Allowed& allowed) {
  return {.force = factor * allowed.force, .surface = factor * allowed.surface};
}

InvalidInput too_large(double size, double smallest) {
  return InvalidInput(std::vector<MessagePart>{
      {"ReduceOptions::max_size", true},
      {fmt::format(" is {:.0f}; this model cannot be made smaller than {:.0f} bytes", size,
                   smallest)}});
}

// With allowed errors that are raised as little as its size needs.
// \param factor by which they are.
ReducedModel small_enough(Source& source, const PlayedStrokes& measuring, const Allowed& allowed,
                          double& factor) {
  const double size = source.options.max_size.value_or(std::numeric_limits<double>::infinity());
  if (source.options.max_size) {
    const double least = reduced_within(source, raised_by(kMostRaised, allowed)).front().size_after;
    if (least > size) throw too_large(size, least);
  }
  const auto raised_to = [&](double by) {
    return measured_within(source, measuring, raised_by(by, allowed), size);
  };
  std::optional<ReducedModel> result = raised_to(factor);
  if (result) return *std::move(result);
  double too_small = factor;
  while (!result) {
    // The models that were measured are larger than the one that was within `size`.
    if (factor >= kMostRaised) throw too_large(size, size);
    too_small = factor;
    factor *= 2;
    result = raised_to(factor);
  }
  for (int i = 0; i < kScaleHalvings; ++i) {
    const double middle = std::sqrt(too_small * factor);
    if (std::optional<ReducedModel> other = raised_to(middle)) {
      result = std::move(other);
      factor = middle;
    } else {
      too_small = middle;
    }
  }
  return *std::move(result);
}

}  // namespace

ReducedModel reduce_model(const Model& model, const ReduceOptions& given) {
  const ReduceOptions options = in_range(given);
  check_model(model);
  const StrokeSettings settings = stroke_settings(model, options);
  StrokeSettings choosing_settings = settings;
  choosing_settings.count = static_cast<int>(kChoosing * options.strokes);
  choosing_settings.seed += kOtherStrokes;
  const std::vector<bool> needed = needed_contacts(model, options.reachable);
  const std::vector<std::size_t> in_reach = indices_where(needed, true);
  const PlayedStrokes choosing = played(model, choosing_settings);
  int done = 0;
  Source source{.model = model,
                .options = options,
                .in_reach = in_reach,
                .beyond = indices_where(needed, false),
                .choosing = choosing,
                .thinning = {model, in_reach, choosing.strokes, choosing.ends},
                .depths = press_depths(model, settings),
                .too_small = std::vector<double>(model.contacts.size(), -1),
                .tried =
                    [&] {
                      done = std::min(done + 1, kUsualModels - 1);
                      if (options.progress) options.progress(done, kUsualModels);
                    },
                .surfaces = {}};
  const PlayedStrokes measuring = played(model, settings);
  const std::optional<double> stated = stated_error(model, measuring.ends);
  const double own = stated.value_or(0), force = rms_force(choosing.ends);
  const double least = own > 0 ? kReductionRoom * own : kShareOfForce * force;
  const std::optional<double> asked = asked_error(options, force);
  const Allowed allowed = allowed_errors(source, own, least, asked);
  double factor = 1;
  ReducedModel result = small_enough(source, measuring, allowed, factor);
  result.allowed = factor * allowed.force;
  result.raised_for_size = factor;
  const double whole = std::hypot(std::max(result.allowed, result.difference.rms), own);
  const double raised = whole / asked.value_or(least);
  result.raised = raised > 1 + kRounding ? raised : 1;
  result.force_rms = rms_force(measuring.ends);
  result.stated_before = stated;
  result.size_before = folder_size(model);
  if (options.progress) options.progress(kUsualModels, kUsualModels);
  return result;
}

}  // namespace palpate::haptics
