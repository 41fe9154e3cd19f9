// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <cmath>
#include <memory>
#include <nlohmann/json.hpp>
#include <vector>

#include "palpate/core/error.h"
#include "palpate/documents/document.h"
#include "palpate/geometry/geodesic_distance.h"
#include "palpate/geometry/mesh_io.h"
#include "palpate/geometry/surface_query.h"
#include "palpate/pictures/draw_contacts.h"
#include "palpate/probing/contact_plan.h"
#include "palpate/probing/specimen_file.h"
#include "probing/probe.h"
#include "shared/field_options.h"
#include "shared/output_checks.h"
#include "shared/scene_needs.h"

namespace palpate::apps {
namespace {

struct PlanCall {
  fs::path surface, specimen, output, picture;
  geometry::ReadOptions read;
  probing::PlanOptions options;
  SceneChoice scene;
};

/// Each contact with the part of the surface that is nearest to it.
void draw_plan(const fs::path& png, const geometry::TriangleMesh& mesh,
               const probing::ContactPlan& plan) {
  const geometry::SurfaceQuery query(mesh);
  std::vector<geometry::SurfacePoint> sources;
  std::vector<long long> ids;
  geometry::TriangleMesh contacts;
  contacts.vertices.resize(3, static_cast<Eigen::Index>(plan.contacts.size()));
  for (std::size_t i = 0; i < plan.contacts.size(); ++i) {
    sources.push_back(query.closest_point(plan.contacts[i].position).at);
    contacts.vertices.col(static_cast<Eigen::Index>(i)) = plan.contacts[i].position;
    ids.push_back(plan.contacts[i].id);
  }
  pictures::draw_contacts(png, mesh, geometry::geodesic_distance(mesh, sources).label, contacts,
                          ids, "Plan of contacts");
}

void report_plan(const Settings& settings, const PlanCall& call, const probing::ContactPlan& plan) {
  Json excluded = Json::object();
  std::string reasons;
  for (std::size_t i = 1; i < plan.excluded.size(); ++i) {
    const char* reason = probing::to_string(static_cast<probing::Eligibility>(i));
    excluded[reason] = plan.excluded[i];
    if (plan.excluded[i] > 0)
      reasons += fmt::format("{}{} {}", reasons.empty() ? "" : ", ", plan.excluded[i], reason);
  }
  const auto cover = std::isfinite(plan.cover) ? std::optional(plan.cover) : std::nullopt;
  print(
      settings,
      {{"contacts", plan.contacts.size()},
       {"force_levels", plan.normal_forces.size()},
       {"cover", number_or_null(cover)},
       {"eligible", plan.excluded.front()},
       {"excluded", excluded},
       {"output", call.output.string()}},
      fmt::format("{} contacts; {}\n{} vertices may be probed; not: {}\nwritten to {}",
                  plan.contacts.size(),
                  cover ? fmt::format("each eligible point is at most {:.1f} mm from one", *cover)
                        : std::string("some parts of the surface have none"),
                  plan.excluded.front(), reasons.empty() ? "none" : reasons, call.output.string()));
}

void plan(const Settings& settings, PlanCall call) {
  if (call.surface.empty() == call.specimen.empty()) {
    throw InvalidInput(
        "palpate probe plan: give either SURFACE or --specimen, whose surface is to be probed");
  }
  check_pictures({call.picture});
  check_outputs({call.surface, call.specimen, call.scene.scene}, {call.output, call.picture});
  const geometry::TriangleMesh mesh =
      call.specimen.empty() ? geometry::read_mesh(call.surface, call.read)
                            : probing::parse_specimen(documents::read_json_text(call.specimen),
                                                      call.specimen.string())
                                  ->surface();
  std::vector<bool> needed;
  if (const auto& [scene, object] = call.scene; !scene.empty())
    needed = reachable_vertices_of(scene, haptics::read_scene_requirement(scene, {}, object), mesh);
  const probing::ContactPlan made = probing::plan_contacts(mesh, call.options, needed);
  probing::write_plan(call.output, made);
  if (!call.picture.empty()) draw_plan(call.picture, mesh, made);
  report_plan(settings, call, made);
}

}  // namespace

void add_sensor_option(CLI::App& command, Eigen::Vector3d& sensor) {
  command
      .add_option_function<std::vector<double>>(
          "--sensor",
          [&sensor](const std::vector<double>& place) { sensor = Eigen::Vector3d(place.data()); },
          "Position of the sensor: x y z [mm] (default: 0 0 0)")
      ->type_name("FLOAT")
      ->expected(3);
}

void add_probe_plan(CLI::App& probe, const Settings& settings) {
  auto call = std::make_shared<PlanCall>();
  CLI::App* command = probe.add_subcommand("plan", "Plan where and how hard to probe a surface");
  command->add_option("SURFACE", call->surface, "Mesh of the undeformed object");
  command->add_option("--specimen", call->specimen,
                      "Instead of SURFACE: a simulated object (JSON or YAML; docs/probing.md)");
  add_required(*command, "-o,--output", call->output, "Plan to write (plan.json)");
  add_unit_option(*command, call->read);
  add_fields(*command, fields_of(call->options));
  add_sensor_option(*command, call->options.sensor);
  add_scene_options(*command, call->scene, "the only one with 'require'",
                    "Scene file (YAML or JSON): contacts are only where its 'require' says that a "
                    "tool can be");
  command->add_option("--picture", call->picture, "Also draw the contacts and their parts (PNG)");
  command->footer("Example:\n  palpate probe plan surface.ply --spacing 14 -o plan.json");
  command->callback([call, &settings] { plan(settings, *call); });
}

}  // namespace palpate::apps
