// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <array>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "palpate/core/error.h"
#include "palpate/core/output_file.h"
#include "palpate/documents/document.h"
#include "palpate/geometry/mesh_io.h"
#include "palpate/probing/csv.h"
#include "palpate/probing/specimen_file.h"
#include "probing/probe.h"
#include "shared/field_options.h"
#include "shared/output_checks.h"
#include "shared/progress.h"

namespace palpate::apps {
namespace {

using Eigen::Vector3d;

struct TruthCall {
  fs::path specimen, output;
  probing::KnownForceOptions options;
};

void write_queries(const fs::path& path, const std::vector<probing::KnownForce>& truths) {
  constexpr std::array<std::string_view, 9> kColumns = {"cx", "cy", "cz", "dx", "dy",
                                                        "dz", "fx", "fy", "fz"};
  write_file(path, [&](std::ostream& out) {
    probing::write_csv_header(out, kColumns);
    for (const probing::KnownForce& truth : truths) {
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
      probing::parse_specimen(documents::read_json_text(call.specimen), call.specimen.string());
  probing::KnownForceOptions options = call.options;
  options.progress = shown_as("computing forces");
  with_names({{"known_forces()", call.specimen.string()}},
             [&] { write_truth(call.output, *specimen, options); });
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
                 const probing::KnownForceOptions& options) {
  const probing::KnownForces known = known_forces(specimen, options);
  if (!known.unanswered.empty()) throw SolverError(known.unanswered.front().reason);
  geometry::write_mesh(folder / kTruthSurface, specimen.surface());
  write_queries(folder / kTruthQueries, known.forces);
}

void add_probe_truth(CLI::App& probe, const Settings& settings) {
  auto call = std::make_shared<TruthCall>();
  CLI::App* command =
      probe.add_subcommand("truth", "Write the surface and known forces of a simulated object");
  add_required(*command, "SPECIMEN", call->specimen,
               "Simulated object (JSON or YAML; docs/probing.md)");
  add_required(*command, "-o,--output", call->output, "Folder for surface.ply and queries.csv");
  add_fields(*command, fields_of(call->options));
  command->footer(
      "Example:\n  palpate probe truth sheet.json -o truth/\n"
      "  palpate evaluate model/ --queries truth/queries.csv");
  command->callback([call, &settings] { tell_truth(settings, *call); });
}

}  // namespace palpate::apps
