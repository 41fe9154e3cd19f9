// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "palpate/haptics/error_budget.h"
#include "palpate/haptics/reduce_model.h"

namespace palpate::haptics {

/// An object of a scene of which a model exists.
struct ObjectNeeds {
  std::string name;              ///< for messages
  const Model* model = nullptr;  ///< of this object, or of a similar one
  ReduceOptions options;         ///< requirements on its model
  /// [mm] Places for contacts on the model's surface, in an order of which each beginning covers
  /// the surface evenly, such as that of `probing::plan_contacts`. At least three.
  std::vector<Eigen::Vector3d> places;
  double contact_time = 0;                        ///< [s] of the arm for each contact; > 0
  std::optional<double> arm_time = std::nullopt;  ///< [s] for this object; > 0
};

/// The error that a number of contacts gives, and its cost.
struct PlannedContacts {
  int contacts = 0;
  double error = 0;     ///< [N] by `ErrorForecast`
  double arm_time = 0;  ///< [s]
  double size = 0;      ///< [bytes] of the model folder, before it is reduced
};

/// The requirement that decides the number of contacts.
enum class PlanLimit {
  none,         ///< nothing is required: as many contacts as the model has
  force_error,  ///< the allowed error
  arm_time,     ///< the time of the arm for this object
  scene_time,   ///< the time of the arm for all objects
  places        ///< there are no more places
};
/// "none", "force_error", "arm_time", "scene_time", "places".
[[nodiscard]] const char* to_string(PlanLimit limit);

/// The plan for measuring an object.
struct ObjectPlan {
  PlannedContacts present;             ///< as the model is
  PlannedContacts planned;             ///< the fewest contacts that meet the requirements
  PlannedContacts with_more;           ///< with an hour of the arm more than planned
  bool is_reduced = false;             ///< true if less than the whole model is needed
  std::optional<double> asked = {};    ///< [N] the allowed error
  std::optional<double> allowed = {};  ///< [N] the error planned for: less if the model is reduced
  double raised = 1;  ///< how many times larger the planned error is than `allowed`; >= 1
  PlanLimit limit = PlanLimit::none;
  double force = 0;                    ///< [N] RMS of the forces that the errors belong to
  double of_contacts = 0;              ///< [N] the error that no further contact removes
  ErrorBudget budget = {};             ///< the sources of `planned.error`
  std::vector<PlannedContacts> curve;  ///< of other numbers of contacts, ascending

  /// True if the contacts of the model meet the allowed error already.
  [[nodiscard]] bool is_met() const { return allowed && present.error <= *allowed; }
};

/// Finds how many contacts each object of a scene needs. If the arm has not enough time for all
/// objects, the allowed errors of all of them are raised by a common factor, and the numbers of
/// contacts of those without an allowed error are divided by it.
///
/// A model whose size or surface error is limited, or which is needed in a region only, will be
/// reduced. That needs a part of the allowed error: the plan is for 1 / 1.1 of it. An object
/// without an allowed error takes its `arm_time`; without that, the contacts that its model has.
/// The error is taken to fall with the number of contacts.
/// \param arm_time [s] for all objects; > 0.
/// \throws InvalidInput, naming the object, as `ErrorForecast`, if there are fewer than three places
/// or too little time for three contacts, or a time is not > 0.
[[nodiscard]] std::vector<ObjectPlan> plan_scene(std::span<const ObjectNeeds> objects,
                                                 std::optional<double> arm_time = std::nullopt);

}  // namespace palpate::haptics
