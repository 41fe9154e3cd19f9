// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "palpate/haptics/model.h"
#include "palpate/haptics/reduce_model.h"

namespace palpate::haptics {

/// Strokes that choose, for each of `ReduceOptions::strokes`, which measure.
inline constexpr double kChoosing = 0.2;

/// A stroke of a tool: it comes from outside, presses into the object and drags along it.
struct Stroke {
  Eigen::Vector3d start = Eigen::Vector3d::Zero();    ///< [mm] outside
  Eigen::Vector3d pressed = Eigen::Vector3d::Zero();  ///< [mm] inside
  Eigen::Vector3d dragged = Eigen::Vector3d::Zero();  ///< [mm] without drags: `pressed`
};

/// The feel of the tool at the end of a press or of a drag.
struct StrokeEnd {
  Eigen::Vector3d tool = Eigen::Vector3d::Zero();     ///< [mm]
  Eigen::Vector3d contact = Eigen::Vector3d::Zero();  ///< [mm] on the undeformed surface
  Eigen::Vector3d force = Eigen::Vector3d::Zero();    ///< [N] on the object
  bool touches = false;
};

/// The strokes that are tried.
struct StrokeSettings {
  int count = 0;
  std::uint64_t seed = 0;
  std::vector<bool> reachable = {};  ///< of each vertex of the surface; empty: all
  std::optional<double> largest_force = std::nullopt;  ///< [N] along the direction of pressing
  std::optional<double> largest_depth = std::nullopt;  ///< [mm]
  bool drags = true;
};

/// \throws InvalidInput if `reachable` has not one value for each vertex of the model's surface.
[[nodiscard]] StrokeSettings stroke_settings(const Model& model, const ReduceOptions& options);

/// Random strokes over the places that can be reached, all areas alike. Depths are even up to the
/// largest one or to that of the largest force, whichever is less; without either, as far as the
/// model was measured. Drags go in any direction, by up to the usual distance of two contacts, as
/// long as the force is not much more than that of the deepest press. Strokes whose contact ends
/// where it cannot be reached are left out, and those beside which the model itself jumps: there a
/// tool that holds or slips, or leaves the border, by chance.
/// \throws InvalidInput if no place can be reached, or if no limit is known.
[[nodiscard]] std::vector<Stroke> random_strokes(const Model& model,
                                                 const StrokeSettings& settings);

/// [mm] Largest depth of the strokes at each contact.
[[nodiscard]] std::vector<double> press_depths(const Model& model, const StrokeSettings& settings);

/// Plays strokes, in parallel. Each has one end, or two if it is dragged.
[[nodiscard]] std::vector<StrokeEnd> play_strokes(const Model& model,
                                                  std::span<const Stroke> strokes);

/// [N] Lengths of the differences of forces.
[[nodiscard]] std::vector<double> force_differences(std::span<const StrokeEnd> a,
                                                    std::span<const StrokeEnd> b);

}  // namespace palpate::haptics
