// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <CLI/CLI.hpp>
#include <optional>
#include <string>
#include <vector>

#include "palpate/geometry/triangle_mesh.h"
#include "palpate/haptics/scene_requirement.h"
#include "shared/aliases.h"

namespace palpate::apps {

/// A scene file with requirements, and the object of it to which they apply.
struct SceneChoice {
  fs::path scene = {};
  std::optional<std::string> object = {};
};

/// Adds the options `--scene` and `--object`. \return the first.
/// \param usual the default object, for the help. \param what the help text of `--scene`.
CLI::Option* add_scene_options(CLI::App& command, SceneChoice& choice, const std::string& usual,
                               const std::string& what);

/// Returns the vertices of a surface that a tool can reach; empty if there is no limit.
/// \throws InvalidInput naming the scene and the object if it can reach no part of the surface.
[[nodiscard]] std::vector<bool> reachable_vertices_of(const fs::path& scene,
                                                      const haptics::SceneRequirement& requirement,
                                                      const geometry::TriangleMesh& surface);

/// Warns that the tool of the scene is not the ball with which the model was measured.
void warn_of_tool_radius(const haptics::SceneRequirement& requirement, const haptics::Model& model);

}  // namespace palpate::apps
