// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <Eigen/Geometry>
#include <array>
#include <memory>
#include <nlohmann/json.hpp>
#include <numbers>
#include <random>
#include <string_view>

#include "commands/probe.h"
#include "commands/probe_truth.h"
#include "palpate/error.h"
#include "palpate/geometry/geodesic_distance.h"
#include "palpate/geometry/mesh_io.h"
#include "palpate/geometry/mesh_topology.h"
#include "palpate/haptics/evaluate.h"
#include "palpate/output_file.h"
#include "palpate/probing/csv.h"
#include "palpate/probing/specimen_file.h"
#include "shared/call_checks.h"
#include "shared/inputs.h"

namespace palpate::apps {
namespace {

namespace fs = std::filesystem;
using Eigen::Vector3d;
using Json = nlohmann::ordered_json;

struct TruthCall {
  fs::path specimen, output;
  TruthOptions options;
};

/// The vertices at least `margin` away from the border.
std::vector<bool> inner_vertices(const geometry::TriangleMesh& mesh, double margin) {
  const std::vector<geometry::SurfacePoint> places = geometry::vertex_points(mesh);
  std::vector<geometry::SurfacePoint> border;
  for (const std::vector<int>& loop : geometry::boundary_loops(mesh)) {
    for (const int v : loop) border.push_back(places[static_cast<std::size_t>(v)]);
  }
  std::vector<bool> inner(places.size(), true);
  if (border.empty() || margin == 0) return inner;
  const Eigen::VectorXd distance = geometry::geodesic_distance(mesh, border).distance;
  for (std::size_t v = 0; v < inner.size(); ++v)
    inner[v] = distance[static_cast<Eigen::Index>(v)] >= margin;
  return inner;
}

/// Forces at even places of the surface, as far from the boundary of friction as they happen to be.
std::vector<haptics::Query> known_forces(const probing::Specimen& specimen,
                                         const TruthOptions& options) {
  constexpr double kLeastForce = 0.1;  // [N]
  const geometry::TriangleMesh& mesh = specimen.surface();
  const std::vector<bool> inner = inner_vertices(mesh, options.margin);
  std::vector<int> triangles;
  for (int t = 0; t < mesh.triangles.cols(); ++t) {
    const auto is_inner = [&](int corner) { return inner[static_cast<std::size_t>(corner)]; };
    if (is_inner(mesh.triangles(0, t)) && is_inner(mesh.triangles(1, t)) &&
        is_inner(mesh.triangles(2, t)))
      triangles.push_back(t);
  }
  if (triangles.empty()) {
    throw InvalidInput(fmt::format(
        "palpate probe truth: no place is {} mm from the border; give a smaller --margin",
        options.margin));
  }
  std::mt19937 random(options.seed);
  std::uniform_int_distribution<std::size_t> any(0, triangles.size() - 1);
  std::uniform_real_distribution<double> uniform(0, 1);
  std::vector<haptics::Query> truths;
  while (static_cast<int>(truths.size()) < options.queries) {
    double u = uniform(random), v = uniform(random);
    if (u + v > 1) u = 1 - u, v = 1 - v;
    const Vector3d contact = geometry::position(mesh, {triangles[any(random)], {1 - u - v, u, v}});
    const probing::FrictionCone cone = specimen.friction_cone(contact);
    const double angle = 2 * std::numbers::pi * uniform(random);
    const Vector3d x = cone.axis.unitOrthogonal(), y = cone.axis.cross(x);
    const double ratio = 0.9 * cone.coefficient * std::sqrt(uniform(random));
    const double size = kLeastForce + (options.max_force - kLeastForce) * uniform(random);
    const Vector3d force =
        size * (cone.axis + ratio * (std::cos(angle) * x + std::sin(angle) * y)).normalized();
    truths.push_back({contact, specimen.displacement(contact, force), force});
  }
  return truths;
}

void write_queries(const fs::path& path, const std::vector<haptics::Query>& truths) {
  constexpr std::array<std::string_view, 9> kColumns = {"cx", "cy", "cz", "dx", "dy",
                                                        "dz", "fx", "fy", "fz"};
  write_file(path, [&](std::ostream& out) {
    probing::write_csv_header(out, kColumns);
    for (const haptics::Query& truth : truths) {
      std::string line;
      for (const Vector3d& vector : {truth.contact, truth.displacement, truth.force}) {
        for (const double number : vector)
          line += (line.empty() ? "" : ",") + probing::to_text(number);
      }
      out << line << '\n';
    }
  });
}

void tell_truth(const Settings& settings, const TruthCall& call) {
  check_outputs({call.specimen}, {call.output / kTruthSurface, call.output / kTruthQueries});
  const auto specimen =
      probing::parse_specimen(probing::read_specimen_text(call.specimen), call.specimen.string());
  write_truth(call.output, *specimen, call.options);
  const auto vertices = specimen->surface().vertices.cols();
  print(settings,
        {{"vertices", vertices},
         {"known_forces", call.options.queries},
         {"output", call.output.string()}},
        fmt::format("Surface with {} vertices and {} known forces, written to {}", vertices,
                    call.options.queries, call.output.string()));
}

}  // namespace

void write_truth(const fs::path& folder, const probing::Specimen& specimen,
                 const TruthOptions& options) {
  const std::vector<haptics::Query> queries = known_forces(specimen, options);
  geometry::write_mesh(folder / kTruthSurface, specimen.surface());
  write_queries(folder / kTruthQueries, queries);
}

void add_probe_truth(CLI::App& probe, const Settings& settings) {
  auto call = std::make_shared<TruthCall>();
  CLI::App* command =
      probe.add_subcommand("truth", "Write the surface and known forces of a simulated object");
  command->add_option("SPECIMEN", call->specimen, "Simulated object (JSON; docs/probing.md)")
      ->required();
  command->add_option("-o,--output", call->output, "Folder for surface.ply and queries.csv")
      ->required();
  command->add_option("--queries", call->options.queries, "Number of known forces")
      ->check(within(above(0)))
      ->capture_default_str();
  command
      ->add_option("--margin", call->options.margin,
                   "Least distance of their places from the border [mm]")
      ->check(within(at_least(0).finite()))
      ->capture_default_str();
  command->add_option("--max-force", call->options.max_force, "Largest of the forces [N]")
      ->check(within(above(0.1).finite()))
      ->capture_default_str();
  command->add_option("--seed", call->options.seed, "Of the random places and forces")
      ->capture_default_str();
  command->footer(
      "Example:\n  palpate probe truth sheet.json -o truth/\n"
      "  palpate evaluate model/ --queries truth/queries.csv");
  command->callback([call, &settings] { tell_truth(settings, *call); });
}

}  // namespace palpate::apps
