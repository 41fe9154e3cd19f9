// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include <cstdint>
#include <memory>
#include <string>
#include <utility>

#include "arrays.h"
#include "bindings.h"
#include "fields.h"
#include "long_work.h"
#include "output_path.h"
#include "palpate/probing/acquisition_store.h"
#include "palpate/probing/arm_setup.h"
#include "palpate/probing/campaign_options_text.h"
#include "palpate/probing/campaign_trial.h"
#include "palpate/probing/contact_plan.h"
#include "palpate/probing/quasi_static_arm.h"
#include "palpate/probing/virtual_arm.h"
#include "specimen_binding.h"

namespace palpate::python {
namespace {

namespace fs = std::filesystem;
using devices::DeviceCommand;
using devices::DeviceState;
using probing::ContactPlan;
using probing::PlanOptions;
using probing::VirtualArm;

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
  py::class_<DeviceState>(module, "DeviceState",
                          R"(An arm at one moment, in the frame of its base.

What the arm does not measure is NaN.)")
      .def_readonly("time", &DeviceState::time, "[s] on the arm's clock.")
      .def_property_readonly(
          "tip", [](const DeviceState& state) { return copy_of(state.tip); },
          "[mm] (3,) by the encoders, without flexure.")
      .def_property_readonly(
          "joints", [](const DeviceState& state) { return copy_of(state.joints); }, "[rad] (3,)")
      .def_property_readonly(
          "delivered_force",
          [](const DeviceState& state) { return copy_of(state.delivered_force); },
          "[N] (3,) of the motors at the tip.")
      .def_property_readonly(
          "reference_force",
          [](const DeviceState& state) { return copy_of(state.reference_force); },
          "[N] (3,) on the object, by a sensor of its own.")
      .def_property_readonly(
          "heat", [](const DeviceState& state) { return copy_of(state.heat); },
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
            DeviceState state;
            if (!arm.read(state)) throw SolverError("VirtualArm.read(): " + arm.last_error());
            return state;
          },
          "Simulates 1 ms, then measures. Raises SolverError if the object has no equilibrium.")
      .def(
          "write",
          [](VirtualArm& arm, const py::object& force) {
            DeviceCommand command;
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

void add_campaigns(py::module_& module) {
  add_plan(module);
  add_probe(module);
  add_virtual_arm(module);
}

}  // namespace palpate::python
