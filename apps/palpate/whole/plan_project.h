// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "palpate/haptics/plan_scene.h"
#include "palpate/haptics/scene_requirement.h"
#include "palpate/probing/contact_plan.h"
#include "shared/aliases.h"

namespace palpate::apps {

/// The input from which a project is made.
struct ProjectSource {
  fs::path project, scene;      ///< the file to write, and that with the requirements
  fs::path surface;             ///< of the object
  fs::path specimen;            ///< a simulated object; empty: a real one
  probing::PlanOptions places;  ///< how places were chosen; their numbers are those of the plan
  double spacing = 0;           ///< [mm] smallest distance of the contacts that are planned
};

/// Returns a project file (docs/projects.md) with the settings that a plan chose, each with a
/// comment that gives the reason. Paths are relative to its folder. Empty if nothing is to be done.
[[nodiscard]] std::string project_of(const ProjectSource& source,
                                     const haptics::SceneRequirement& requirement,
                                     const haptics::ObjectPlan& plan);

/// "Decided by the allowed error of 0.1 N.": the reason for the number of contacts.
[[nodiscard]] std::string decided_by(const haptics::ObjectPlan& plan);

}  // namespace palpate::apps
