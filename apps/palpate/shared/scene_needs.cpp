// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "shared/scene_needs.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <cmath>

#include "palpate/core/error.h"
#include "palpate/haptics/tool_radius.h"

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

void warn_of_tool_radius(const haptics::SceneRequirement& requirement,
                         const haptics::Model& model) {
  const std::optional<double>&tool = requirement.tool_radius, &probe = model.probe_radius;
  if (!tool || tool == probe) return;
  if (!probe) {
    spdlog::warn(
        "{}: how wrong the forces on a tool of {:g} mm are is not known: {} does not say with "
        "which ball it was measured",
        requirement.object, *tool, requirement.model.string());
    return;
  }
  const double missing = haptics::missing_force(*probe, *tool);
  spdlog::warn(
      "{}: the model was measured with a ball of {:g} mm; on a solid, a tool of {:g} mm feels "
      "{:.0f} % {} force (Hertz), on a thin membrane about the same. No error here includes that",
      requirement.object, *probe, *tool, 100 * std::abs(missing), missing > 0 ? "more" : "less");
}

}  // namespace palpate::apps
