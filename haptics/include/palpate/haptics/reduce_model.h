// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include "palpate/core/fields.h"
#include "palpate/geometry/error_statistics.h"
#include "palpate/haptics/model.h"

namespace palpate::haptics {

/// Requirements on a reduced model. `visit` lists the meaning, unit and range of each field;
/// docs/options.md shows this list.
struct ReduceOptions {
  std::optional<double> max_error = std::nullopt;
  std::optional<double> max_relative_error = std::nullopt;
  std::optional<double> max_surface_error = std::nullopt;
  std::optional<double> picture_size = std::nullopt;
  std::optional<double> max_size = std::nullopt;
  std::optional<double> largest_force = std::nullopt;
  std::optional<double> largest_depth = std::nullopt;
  bool slip = true;
  bool keep_shapes = true;
  int strokes = 10'000;
  int seed = 1;
  /// Of each vertex of the model's surface: whether the tool can reach it. Empty: all.
  std::vector<bool> reachable = {};
  /// Called in the calling thread after each model that was tried. `total` is a usual number of
  /// them; only the last call has done == total. An exception that it throws ends the work.
  std::function<void(int done, int total)> progress = {};
};

void visit(ReduceOptions& options, FieldVisitor& visitor);

/// The result of a reduction, and its difference from the full model.
struct ReducedModel {
  Model model;
  std::vector<long long> out_of_reach;  ///< ids of contacts that have no weight in the region
  std::vector<long long> predicted;     ///< ids of those that the others predict
  int simpler_fields = 0;               ///< fields that have fewer bases now
  /// [mm] bound of the distance between the surfaces, in both directions
  double surface_distance = 0;
  /// [N] RMS difference from the full model with fewer contacts; then also with a coarser surface
  double rms_of_contacts = 0, rms_of_contacts_and_surface = 0;
  geometry::ErrorStatistics difference;  ///< [N] from the full model, at the ends of other strokes
  double force_rms = 0;                  ///< [N] RMS of the forces there
  /// [N] RMS of the errors that the full and the reduced model state there, if they do.
  std::optional<double> stated_before, stated_after;
  double allowed = 0;  ///< [N] RMS difference that was allowed at last
  /// Ratio of the errors that had to be allowed to those requested; 1: as requested.
  double raised = 1;
  double raised_for_size = 1;              ///< the part of it that the size needed
  double size_before = 0, size_after = 0;  ///< [bytes] of the model folders
};

/// Reduces a model to the part that a scene requires. Contacts that no reachable place needs are
/// removed, then those that the others predict; fields are fitted again with fewer bases, which
/// keeps them passive; the surface is decimated with a bound.
///
/// The difference between two models is measured by random strokes of a tool that presses and
/// drags, played by both: the root mean square over the ends of presses and drags. One set of
/// strokes, a fifth of `strokes`, chooses; another one, of `strokes`, measures.
///
/// The allowed error is that of the reduced model against the object. If the model states its own
/// error S there, the reduction may add the root of max_error^2 - S^2. If max_error is below 1.1 S,
/// or no error was given, it is 1.1 S. A model that states none may by default change by 1 % of the
/// force. If the size does not hold then, all allowed errors are raised together until it does.
///
/// Contacts move only onto the decimated surface, and keep the compliances and strengths learnt
/// from all contacts. Their stated errors between contacts are learnt again, from the full model's
/// own error and the difference of the reduced one, at the ends of the strokes. The reduced model
/// belongs to no acquisition.
///
/// \throws InvalidInput if `check_model` rejects the model, an option is outside its range,
/// `reachable` has another size, fewer than three contacts have influence where it is true, no
/// stroke stays there, neither the model nor the options say how far it was measured, or nothing
/// that is tried is as small as required. \throws InvalidInput or SolverError as
/// `geometry::triangulate_contacts` if the contacts in reach have no triangulation.
[[nodiscard]] ReducedModel reduce_model(const Model& model, const ReduceOptions& options = {});

}  // namespace palpate::haptics
