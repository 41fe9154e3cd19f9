// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>
#include <vector>

#include "palpate/probing/adaptive_trials.h"
#include "palpate/probing/force_surrogate.h"

namespace palpate::probing {

inline constexpr int kBaseLevels = 5;
/// Limit of the trials at a contact, in multiples of its base. More hardly help and slow down the
/// choice.
inline constexpr double kMostOfBase = 3;
/// Probability of slip of a trial that is not meant to search the friction cone.
inline constexpr double kHolding = 0.05;

/// The input of an adaptive campaign.
struct AdaptiveSetting {
  ContactPlan plan;
  CampaignOptions options;
  std::vector<double> levels;  ///< [N] `base_forces` of the plan

  /// Number of the trials of a contact's base, without repeated ones.
  [[nodiscard]] int base_size() const;
  /// [N] The largest tangential force that the arm may add to a normal force.
  [[nodiscard]] double most_tangential(double normal) const;
  /// [N] Smaller tangential forces are not tried.
  [[nodiscard]] double least_tangential() const;
};

/// State of a contact that was begun.
struct AdaptiveSite {
  Contact contact = {};
  std::optional<ConePosterior> posterior = {};
  ConeEstimate cone = {};
  std::vector<ForcePair> drags = {};
  std::array<ForcePair, kBaseLevels> pressed = {};  ///< mean of each level
  std::array<int, kBaseLevels> presses = {};
  int trials = 0;
  int failures = 0;  ///< in succession
  bool given_up = false, base_done = false;
  std::optional<ForceSurrogate> surrogate = {};
  std::vector<Eigen::Vector3d> queries = {};  ///< [N] forces at which the model should be right
  double variance = 0;                        ///< [N^2] expected squared error at the queries
  double unexplained = 0;  ///< [N^2] by which asking for an energy makes pairs err that are left
                           ///< out, beyond what is expected; may be < 0
  double left_out = -1;    ///< [N^2] squared error of its prediction by neighbours; < 0: none
  double around = -1;  ///< [N^2] if it is not enclosed: of places between it and its neighbours,
                       ///< as expected from its prediction by them; < 0: none
  double gain = 0;     ///< [N^2] of the best further trial
  std::optional<TrialOrder> best = {};  ///< without its number

  /// Unit vectors: into the object, and along the surface at an angle [rad].
  [[nodiscard]] Eigen::Vector3d pressing() const;
  [[nodiscard]] Eigen::Vector3d tangent(double angle) const;
  /// Returns true if its base is done and gave data with which to predict other contacts.
  [[nodiscard]] bool is_known() const;
};

/// A trial at a contact, without its number. \param tangential [N]
[[nodiscard]] TrialOrder order_at(const AdaptiveSite& site, const AdaptiveSetting& setting,
                                  int level, int direction, const Eigen::Vector3d& tangential);

/// Learns the surrogate of a contact from its trials; nothing if it has none.
void learn(AdaptiveSite& site, const AdaptiveSetting& setting);

/// Chooses the queries: evenly spaced in size, and spread evenly over the section of the cone.
void place_queries(AdaptiveSite& site, const AdaptiveSetting& setting);

/// Updates the expected error of a contact, and its best further trial.
void assess(AdaptiveSite& site, const AdaptiveSetting& setting);

}  // namespace palpate::probing
