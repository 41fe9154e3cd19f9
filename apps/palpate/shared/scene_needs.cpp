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
        "{}: the error for a tool with a radius of {:g} mm is not known, because {} does not state "
        "the radius of its probe",
        requirement.object, *tool, requirement.model.string());
    return;
  }
  const double missing = haptics::missing_force(*probe, *tool);
  spdlog::warn(
      "{}: the model was measured with a ball with a radius of {:g} mm. With a radius of {:g} mm, "
      "the force is {:.0f} % {} on a thick solid (Hertz), and about the same on a thin membrane. "
      "The stated errors do not include this",
      requirement.object, *probe, *tool, 100 * std::abs(missing), missing > 0 ? "higher" : "lower");
}

}  // namespace palpate::apps
