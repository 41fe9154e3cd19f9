// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "shared/scene_needs.h"

#include <fmt/format.h>

#include "palpate/core/error.h"

namespace palpate::apps {

CLI::Option* add_scene_options(CLI::App& command, SceneChoice& choice, const std::string& usual,
                               const std::string& what) {
  CLI::Option* scene = command.add_option("--scene", choice.scene, what);
  command
      .add_option("--object", choice.object,
                  "Name of the object of the scene (default: " + usual + ")")
      ->needs(scene);
  return scene;
}

std::vector<bool> reachable_vertices_of(const fs::path& scene,
                                        const haptics::SceneRequirement& requirement,
                                        const geometry::TriangleMesh& surface) {
  if (!requirement.region) return {};
  try {
    return haptics::reachable_vertices(surface, *requirement.region);
  } catch (const InvalidInput& wrong) {
    throw InvalidInput(
        fmt::format("{}: object '{}': {}", scene.string(), requirement.object, wrong.what()));
  }
}

}  // namespace palpate::apps
