// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "surfaces/cloud_steps.h"

namespace palpate::apps {

/// The attributes that say of what shape or cluster a point is.
inline constexpr const char* kShapeAttribute = "shape";
inline constexpr const char* kClusterAttribute = "cluster";

/// Notes what a step did.
/// \param name of its option
/// \param known_before points that were known before it
void note_step(WorkedCloud& worked, const std::string& name, Eigen::Index known_before,
               const Json& figures, const std::string& words);

/// Keeps some points, as a step of this name. An organised cloud stays so.
/// \param words what the kept points have in common
/// \throws InvalidInput if there are none.
void keep_only(WorkedCloud& worked, const std::string& name, const std::vector<int>& kept,
               const std::string& words);

}  // namespace palpate::apps
