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
#include "output_path.h"
#include "palpate/haptics/bake_model.h"
#include "palpate/probing/acquisition_store.h"
#include "palpate/probing/arm_setup.h"
#include "palpate/probing/campaign_options_text.h"
#include "palpate/probing/campaign_trial.h"
#include "palpate/probing/known_forces.h"
#include "palpate/probing/quasi_static_arm.h"
#include "palpate/probing/specimen_file.h"
#include "palpate/probing/specimen_trials.h"
#include "palpate/probing/virtual_arm.h"
#include "specimen_binding.h"

namespace palpate::python {
namespace {

namespace fs = std::filesystem;
using devices::DeviceState;
using probing::ContactPlan;
using probing::KnownForces;
using probing::PlanOptions;
using probing::VirtualArm;

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
        return new_specimen(probing::read_specimen_text(path), path.string());
      },
      arg("path"), "Reads a simulated object (JSON; docs/probing.md). Raises FileError.");
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

void add_plan(py::module_& module) {
  py::class_<ContactPlan>(module, "ContactPlan", "Where to probe a surface, and how hard.")
      .def_property_readonly(
          "contacts",
          [](const ContactPlan& plan) {
            return gather_rows(plan.contacts,
                               [](const probing::Contact& contact) { return contact.position; });
          },
          "[mm] (C, 3) in the order of probing (a copy).")
      .def_property_readonly(
          "normals",
          [](const ContactPlan& plan) {
            return gather_rows(plan.contacts,
                               [](const probing::Contact& contact) { return contact.normal; });
          },
          "(C, 3) outward unit normals (a copy).")
      .def_readonly("normal_forces", &ContactPlan::normal_forces,
                    "[N] normal force of each level, ascending.")
      .def_readonly("cover", &ContactPlan::cover,
                    "[mm] largest distance of a place that may be probed from a contact.")
      .def(
          "write",
          [](const ContactPlan& plan, const fs::path& path) {
            probing::write_plan(output_path(path), plan);
          },
          arg("path"), "Writes plan.json, for `palpate probe run`. Raises OutputError.");
  def_with_options<PlanOptions>(
      module, "plan_contacts(surface: TriangleMesh, *, sensor: ArrayLike | None = None",
      "ContactPlan",
      R"(Plans contacts on a surface, as `palpate probe plan` does.

sensor: [mm] (3,) its position, None: the origin; contacts are where it sees the surface well.
Raises InvalidInput if no place may be probed. Ctrl-C is not heard.)",
      [](const geometry::TriangleMesh& surface, const py::object& sensor,
         const py::kwargs& keywords) {
        auto options = options_from<PlanOptions>(keywords);
        if (!sensor.is_none()) options.sensor = vector3(sensor, "sensor");
        const Unlocked unlocked;
        return probing::plan_contacts(surface, options);
      },
      arg("surface"), kw_only(), arg("sensor") = py::none());
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

/// An arm of a campaign; `prober` uses what stands above it.
struct SimulatedArm {
  std::unique_ptr<VirtualArm> arm;
  std::unique_ptr<probing::Prober> prober;
};

SimulatedArm quasi_static_arm(const Specimen& specimen, std::uint64_t seed) {
  return {nullptr, probing::make_quasi_static_arm(specimen.object, {.seed = seed})};
}

/// An arm with its control loop, mounted over the specimen as `palpate probe run` mounts it.
SimulatedArm virtual_arm(const Specimen& specimen, std::uint64_t seed) {
  probing::ArmSetup setup = probing::parse_arm_setup("{}", "probe()");
  setup.prober.T_world_base =
      probing::mount_over(specimen.object->surface(), setup.prober.geometry);
  probing::VirtualArmOptions options;
  options.geometry = setup.prober.geometry;
  options.T_world_base = setup.prober.T_world_base;
  options.seed = seed;
  SimulatedArm made;
  made.arm = std::make_unique<VirtualArm>(specimen.object.get(), options);
  auto prober = std::make_unique<probing::ArmProber>(*made.arm, setup.prober);
  prober->calibrate();
  made.prober = std::move(prober);
  return made;
}

probing::CheckedAcquisition probe(const ContactPlan& plan, const Specimen& specimen,
                                  const fs::path& path, const std::string& kind,
                                  const probing::CampaignOptions& options,
                                  const py::object& progress) {
  using Make = SimulatedArm (*)(const Specimen&, std::uint64_t);
  const auto make =
      choose<Make>("arm", kind, {{"quasi-static", &quasi_static_arm}, {"virtual", &virtual_arm}});
  if (probing::surface_fingerprint(specimen.object->surface()) != plan.surface) {
    throw InvalidInput(
        "plan: is of another surface than that of the specimen; make it with "
        "plan_contacts(specimen.surface)");
  }
  static_cast<void>(output_path(path));
  const std::string description = py::str(py::module_::import("json").attr("dumps")(
      py::dict(arg("arm") = kind, arg("specimen") = specimen.text, arg("seed") = options.seed,
               arg("setup") = "{}")));
  LongWork work(progress);
  return work.run([&, report = work.report()] {
    probing::Campaign campaign(plan, options);
    const SimulatedArm arm = make(specimen, options.seed);
    auto store =
        probing::CampaignStore::create(path, {.plan = probing::to_text(plan),
                                              .strategy = probing::to_text(options),
                                              .arm = description,
                                              .software = "palpate " PALPATE_VERSION " (Python)",
                                              .probe_radius = specimen.object->tip_radius()});
    do {
      const probing::CampaignProgress at = campaign.progress();
      report(at.trials, at.trials + static_cast<int>(at.trials_left));
    } while (probing::perform_trial(campaign, *arm.prober, store, options.program));
    store.finish();
    return probing::read_acquisition(path);
  });
}

void add_probe(py::module_& module) {
  def_with_options<probing::CampaignOptions>(
      module,
      "probe(plan: ContactPlan, specimen: Specimen, path: str | PathLike, *, arm: "
      "Literal['quasi-static', 'virtual'] = 'quasi-static', progress: Callable | None = None",
      "Acquisition",
      R"(Probes a simulated object by a plan with a simulated arm, as `palpate probe run` does.

path: of the database to write (acquisition.db); it must not exist. Each trial is stored at once.
arm: 'quasi-static', equilibria with the errors of an arm, or 'virtual', with its 1 kHz loop.
progress: called as progress(done, total) after each trial; Ctrl-C is heard then.
Raises InvalidInput or OutputError.)",
      [](const ContactPlan& plan, const Specimen& specimen, const fs::path& path,
         const std::string& arm, const py::object& progress, const py::kwargs& keywords) {
        const auto options = options_from<probing::CampaignOptions>(keywords);
        return probe(plan, specimen, path, arm, options, progress);
      },
      arg("plan"), arg("specimen"), arg("path"), kw_only(), arg("arm") = "quasi-static",
      arg("progress") = py::none());
}

void add_virtual_arm(py::module_& module) {
  py::class_<devices::DeviceState>(module, "DeviceState",
                                   R"(An arm at one moment, in the frame of its base.

What the arm does not measure is NaN.)")
      .def_readonly("time", &devices::DeviceState::time, "[s] on the arm's clock.")
      .def_property_readonly(
          "tip", [](const devices::DeviceState& state) { return copy_of(state.tip); },
          "[mm] (3,) by the encoders, without flexure.")
      .def_property_readonly(
          "joints", [](const devices::DeviceState& state) { return copy_of(state.joints); },
          "[rad] (3,)")
      .def_property_readonly(
          "delivered_force",
          [](const devices::DeviceState& state) { return copy_of(state.delivered_force); },
          "[N] (3,) of the motors at the tip.")
      .def_property_readonly(
          "reference_force",
          [](const devices::DeviceState& state) { return copy_of(state.reference_force); },
          "[N] (3,) on the object, by a sensor of its own.")
      .def_property_readonly(
          "heat", [](const devices::DeviceState& state) { return copy_of(state.heat); },
          "(3,) of each motor, relative to that at which it must rest.");
  py::class_<VirtualArm>(
      module, "VirtualArm",
      R"(A simulated arm on a specimen: states and forces at 1 kHz, on its own clock.

Equal seeds and commands give equal states, bit by bit.)")
      .def(py::init([](const Specimen* specimen, std::uint64_t seed) {
             probing::VirtualArmOptions options;
             options.seed = seed;
             if (specimen != nullptr) {
               options.T_world_base =
                   probing::mount_over(specimen->object->surface(), options.geometry);
             }
             return std::make_unique<VirtualArm>(
                 specimen == nullptr ? nullptr : specimen->object.get(), options);
           }),
           py::keep_alive<1, 2>(), arg("specimen") = py::none(), kw_only(), arg("seed") = 1,
           "specimen: that it stands over; None: free space. seed: of all that is random.")
      .def("activate", &VirtualArm::activate, "Switches the motors on, with no force.")
      .def(
          "read",
          [](VirtualArm& arm) {
            devices::DeviceState state;
            if (!arm.read(state)) throw SolverError("VirtualArm.read(): " + arm.last_error());
            return state;
          },
          "Simulates 1 ms, then measures. Raises SolverError if the object has no equilibrium.")
      .def(
          "write",
          [](VirtualArm& arm, const py::object& force) {
            devices::DeviceCommand command;
            command.force = vector3(force, "force");
            if (!command.force.allFinite()) throw InvalidInput("force: is not finite");
            if (!arm.write(command)) throw Error("VirtualArm.write(): " + arm.last_error());
          },
          arg("force"),
          "Commands a force [N] (3,) of the motors at the tip, in the frame of the base; it is "
          "dropped after 10 ms unless it is commanded again.")
      .def("stop", &VirtualArm::stop, "Switches the motors off.")
      .def_property_readonly("now", &VirtualArm::now, "[s] the arm's clock.");
}

}  // namespace

Specimen new_specimen(const std::string& text, const std::string& source) {
  const Unlocked unlocked;  // finite elements take seconds
  return {probing::parse_specimen(text, source), text};
}

void add_simulation(py::module_& module) {
  add_specimen(module);
  add_known_forces(module);
  add_plan(module);
  add_bake(module);
  add_probe(module);
  add_virtual_arm(module);
}

}  // namespace palpate::python
