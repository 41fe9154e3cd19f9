// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include "arrays.h"
#include "bindings.h"
#include "fields.h"
#include "long_work.h"
#include "palpate/documents/document.h"
#include "palpate/haptics/bake_model.h"
#include "palpate/probing/known_forces.h"
#include "palpate/probing/specimen_file.h"
#include "palpate/probing/specimen_trials.h"
#include "specimen_binding.h"

namespace palpate::python {
namespace {

namespace fs = std::filesystem;
using probing::KnownForces;
using probing::PlanOptions;

/// JSON of the members. \throws InvalidInput naming the one that JSON cannot hold.
std::string text_of(const py::dict& members) {
  const py::object dumps = py::module_::import("json").attr("dumps");
  for (const auto& [name, value] : members) {
    try {
      dumps(value, arg("allow_nan") = false);
    } catch (const py::error_already_set& error) {
      if (!error.matches(PyExc_ValueError) && !error.matches(PyExc_TypeError)) throw;
      throw InvalidInput("Specimen(): " + std::string(py::str(name)) + " is " +
                         std::string(py::repr(value)) + "; it must be of finite numbers or text");
    }
  }
  return py::str(dumps(members));
}

/// One vector of each known force.
auto rows_of_known(Eigen::Vector3d probing::KnownForce::*member) {
  return [member](const KnownForces& known) {
    return gather_rows(known.forces, [member](const auto& one) { return one.*member; });
  };
}

void add_specimen(py::module_& module) {
  py::class_<Specimen>(module, "Specimen", R"(A simulated deformable object whose truth is known.

Threads may ask the same specimen at the same time.)")
      .def(
          py::init([](const py::dict& members) {
            try {
              return new_specimen(text_of(members), "Specimen()");
            } catch (const FileError& error) {  // there is no file
              throw InvalidInput(error.what());
            }
          }),
          arg("members"),
          R"(Of what its file would say, such as {"type": "sheet", "block": 1.5}; docs/probing.md lists all.

Raises InvalidInput naming the member that is wrong.)")
      .def_property_readonly(
          "surface", [](const Specimen& specimen) { return specimen.object->surface(); },
          "The undeformed surface [mm], a copy.")
      .def_property_readonly(
          "tip_radius", [](const Specimen& specimen) { return specimen.object->tip_radius(); },
          "[mm] of the ball that touches it; None if the tip is none, or a point.")
      .def(
          "displacement",
          [](const Specimen& specimen, const py::object& contact, const py::object& force) {
            const Eigen::Vector3d at = vector3(contact, "contact");
            const Eigen::Vector3d applied = vector3(force, "force");
            Eigen::Vector3d displacement;
            {
              const Unlocked unlocked;
              displacement = specimen.object->displacement(at, applied);
            }
            return copy_of(displacement);
          },
          arg("contact"), arg("force"),
          R"([mm] (3,) how far the tool moves from `contact` [mm] under `force` [N], without slipping.

Raises SolverError if there is no equilibrium, InvalidInput unless both are finite.)")
      .def(
          "friction_cone",
          [](const Specimen& specimen, const py::object& contact) {
            const probing::FrictionCone cone =
                specimen.object->friction_cone(vector3(contact, "contact"));
            return py::make_tuple(copy_of(cone.axis), cone.coefficient);
          },
          arg("contact"), "(axis into the object (3,), coefficient) at a contact [mm].");
  module.def(
      "read_specimen",
      [](const fs::path& path) {
        return new_specimen(documents::read_json_text(path), path.string());
      },
      arg("path"), "Reads a simulated object (JSON or YAML; docs/probing.md). Raises FileError.");
}

void add_known_forces(py::module_& module) {
  py::class_<KnownForces>(module, "KnownForces", "The result of known_forces(), for evaluate().")
      .def_property_readonly("contacts", rows_of_known(&probing::KnownForce::contact),
                             "[mm] (N, 3) places on the undeformed surface.")
      .def_property_readonly("displacements", rows_of_known(&probing::KnownForce::displacement),
                             "[mm] (N, 3) of the tip.")
      .def_property_readonly("forces", rows_of_known(&probing::KnownForce::force),
                             "[N] (N, 3) on the object.")
      .def_property_readonly(
          "unanswered",
          [](const KnownForces& known) {
            return gather_rows(known.unanswered, [](const auto& one) { return one.force; });
          },
          "[N] (M, 3) forces of the queries without an equilibrium, which are left out.");
  def_with_options<probing::KnownForceOptions>(
      module, "known_forces(specimen: Specimen, *, progress: Callable | None = None", "KnownForces",
      R"(Forces on a simulated object and the displacements they cause, as `palpate probe truth` has them.

progress: called as progress(done, total) after each force; Ctrl-C is heard then.
Raises InvalidInput.)",
      [](const Specimen& specimen, const py::object& progress, const py::kwargs& keywords) {
        auto options = options_from<probing::KnownForceOptions>(keywords);
        LongWork work(progress);
        options.progress = work.report();
        return work.run([&] { return probing::known_forces(*specimen.object, options); });
      },
      arg("specimen"), kw_only(), arg("progress") = py::none());
}

haptics::BuildResult bake(const Specimen& specimen, const PlanOptions& plan,
                          const py::object& progress) {
  LongWork work(progress);
  haptics::BuildOptions options = haptics::exact_samples(plan.max_force);
  options.progress = [&work](haptics::BuildStage, int, int) { work.go_on(); };
  return work.run([&] {
    const probing::SpecimenTrials trials = probing::try_specimen(
        *specimen.object, haptics::plan_bake(*specimen.object, plan), {.progress = work.report()});
    haptics::BuildResult built =
        haptics::build_model(trials.acquisition, specimen.object->surface(), options);
    built.model.made["program"] = "palpate " PALPATE_VERSION " (Python)";
    return built;
  });
}

void add_bake(py::module_& module) {
  const PlanOptions usual;
  module.def(
      "bake",
      [](const Specimen& specimen, double spacing, const std::optional<int>& contacts,
         int directions, double max_force, const py::object& progress) {
        PlanOptions plan;
        plan.spacing = spacing;
        plan.contacts = contacts;
        plan.directions = directions;
        plan.max_force = max_force;
        return bake(specimen, plan, progress);
      },
      arg("specimen"), kw_only(), arg("spacing") = usual.spacing, arg("contacts") = py::none(),
      arg("directions") = usual.directions, arg("max_force") = usual.max_force,
      arg("progress") = py::none(),
      R"(Makes a model of a simulated object without an arm and without noise, as `palpate bake` does.

spacing, contacts, directions, max_force: as in plan_contacts().
progress: called as progress(done, total) after each equilibrium, from any thread, one at a time.
Ctrl-C is heard then. Raises InvalidInput or SolverError.)");
}

}  // namespace

Specimen new_specimen(const std::string& text, const std::string& source) {
  const Unlocked unlocked;  // finite elements take seconds
  return {probing::parse_specimen(text, source), text};
}

void add_simulation(py::module_& module) {
  add_specimen(module);
  add_known_forces(module);
  add_bake(module);
}

}  // namespace palpate::python
