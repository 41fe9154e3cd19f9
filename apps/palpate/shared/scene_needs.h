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

/// A scene file that says what is needed, and which of its objects is meant.
struct SceneChoice {
  fs::path scene = {};
  std::optional<std::string> object = {};
};

/// Adds the options `--scene` and `--object`. \return the first.
/// \param usual which object is meant without a name. \param what of `--scene`.
CLI::Option* add_scene_options(CLI::App& command, SceneChoice& choice, const std::string& usual,
                               const std::string& what);

/// The vertices of a surface that a tool can reach; empty if that is not limited.
/// \throws InvalidInput naming the scene and the object if that is no part of the surface.
[[nodiscard]] std::vector<bool> reachable_vertices_of(const fs::path& scene,
                                                      const haptics::SceneRequirement& requirement,
                                                      const geometry::TriangleMesh& surface);

}  // namespace palpate::apps
