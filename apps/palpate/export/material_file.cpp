// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "export/material_file.h"

#include <fmt/format.h>

#include <optional>
#include <ostream>

#include "palpate/core/error.h"
#include "palpate/core/output_file.h"
#include "palpate/documents/document.h"
#include "palpate/probing/material_text.h"
#include "palpate/probing/simulator_files.h"
#include "palpate/probing/specimen_file.h"
#include "shared/output_checks.h"

namespace palpate::apps {

std::vector<std::string> simulators() { return {"calculix", "mujoco", "sofa"}; }

std::string simulator_ending(const std::string& simulator) {
  if (simulator == "calculix") return ".inp";
  return simulator == "mujoco" ? ".xml" : ".scn";
}

std::string write_material(const fs::path& input, const std::string& simulator,
                           const fs::path& output) {
  const std::string text = documents::read_json_text(input);
  const probing::FiniteElementObject object = probing::parse_finite_elements(text, input.string());
  fs::path mesh = output;
  mesh += ".msh";
  check_outputs({input, object.mesh_file}, {output, mesh});
  if (simulator == "calculix") {
    const std::vector<probing::KnownPress> presses = probing::parse_presses(text, input.string());
    std::optional<probing::KnownPress> press;
    if (!presses.empty()) press = presses.front();
    write_file(output, [&](std::ostream& out) { write_calculix(out, object, press); });
    if (!press)
      return "no press to compare with; palpate identify -o writes specimen files with some";
    return fmt::format("its last step is the press of contact {} with a measured force of {:.4g} N",
                       press->contact, press->force.norm());
  }
  const std::string mesh_name = mesh.filename().string();
  if (mesh_name.find_first_of("<&\"") != std::string::npos) {
    throw InvalidInput(output.string() +
                       ": the name of this file stands in XML; choose one without <, & and quotes");
  }
  constexpr double kMetre = 1e-3;  // of a millimetre
  const bool mujoco = simulator == "mujoco";
  write_file(output, [&](std::ostream& out) {
    if (mujoco) {
      write_mujoco(out, object, mesh_name);
    } else {
      write_sofa(out, object, mesh_name);
    }
  });
  write_file(mesh, [&](std::ostream& out) {
    write_linear_gmsh(out, object.body.mesh, mujoco ? kMetre : 1);
  });
  return "it loads " + mesh.string();
}

}  // namespace palpate::apps
