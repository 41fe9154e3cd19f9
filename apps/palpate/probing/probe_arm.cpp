// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "probing/probe_arm.h"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <optional>
#include <utility>
#include <vector>

#include "palpate/core/error.h"
#include "palpate/devices/device_record.h"
#include "palpate/devices/plugin_device.h"
#include "palpate/documents/document.h"
#include "palpate/geometry/surface_query.h"
#include "palpate/probing/arm_setup.h"
#include "palpate/probing/quasi_static_arm.h"
#include "palpate/probing/specimen_file.h"
#include "palpate/probing/virtual_arm.h"
#include "shared/command_line.h"
#include "shared/interrupts.h"

namespace palpate::apps {
namespace {

constexpr const char* kQuasiStatic = "quasi-static";
constexpr const char* kVirtual = "virtual";
constexpr const char* kDevice = "device";
constexpr const char* kReplay = "replay";
constexpr const char* kNoSetup = "{}";

template <typename Vector>
void take_vector(const Json& json, Vector& vector) {
  const auto numbers = json.get<std::vector<double>>();
  if (static_cast<Eigen::Index>(numbers.size()) != vector.size())
    throw InvalidInput("a list has " + std::to_string(numbers.size()) + " numbers");
  std::copy(numbers.begin(), numbers.end(), vector.begin());
}

Json gravity_json(const probing::GravityModel& gravity) {
  return {{"potential", numbers_in(gravity.potential)},
          {"friction", numbers_in(gravity.friction)},
          {"residual", gravity.residual}};
}

probing::GravityModel gravity_of(const Json& json) {
  probing::GravityModel gravity;
  take_vector(json.at("potential"), gravity.potential);
  take_vector(json.at("friction"), gravity.friction);
  gravity.residual = json.at("residual").get<double>();
  return gravity;
}

Json simulation_json(const probing::VirtualArmMemory& memory) {
  return {{"ticks", memory.ticks},
          {"sample", memory.sample},
          {"sample_begin", memory.sample_begin},
          {"joints", numbers_in(memory.joints)},
          {"speed", numbers_in(memory.speed)},
          {"bristle", numbers_in(memory.bristle)},
          {"heat", numbers_in(memory.heat)},
          {"resting", numbers_in(memory.resting)}};
}

probing::VirtualArmMemory simulation_of(const Json& json) {
  probing::VirtualArmMemory memory;
  json.at("ticks").get_to(memory.ticks);
  json.at("sample").get_to(memory.sample);
  json.at("sample_begin").get_to(memory.sample_begin);
  take_vector(json.at("joints"), memory.joints);
  take_vector(json.at("speed"), memory.speed);
  take_vector(json.at("bristle"), memory.bristle);
  take_vector(json.at("heat"), memory.heat);
  take_vector(json.at("resting"), memory.resting);
  return memory;
}

class QuasiStaticCampaignArm final : public CampaignArm {
 public:
  QuasiStaticCampaignArm(std::shared_ptr<const probing::Specimen> specimen,
                         const probing::QuasiStaticArmOptions& options)
      : specimen_(specimen),
        arm_(probing::make_quasi_static_arm(std::move(specimen), options)),
        tip_(options.start) {}
  probing::ProbeReport perform(const probing::ProbeAction& action) override {
    if (action.kind == probing::ProbeActionKind::lift) tip_ = action.target;
    return arm_->perform(action);
  }
  // The tip, which determines the duration of the next travel.
  std::string memory() const override { return Json{{"tip", numbers_in(tip_)}}.dump(); }
  std::shared_ptr<const probing::Specimen> specimen() const override { return specimen_; }
  bool tells_truth() const override { return true; }

 private:
  std::shared_ptr<const probing::Specimen> specimen_;
  std::unique_ptr<probing::Prober> arm_;
  Eigen::Vector3d tip_;
};

/// Passes the memory of an arm to the function `take`.
template <typename Take>
void recall(const std::string& memory, const std::string& source, Take take) {
  if (memory.empty()) return;
  try {
    take(Json::parse(memory));
  } catch (const std::exception& wrong) {
    throw FileError(source + ": what the arm remembers cannot be read: " + wrong.what());
  }
}

/// A 1 kHz arm with all that belongs to it, in the order in which it is destroyed last to first.
class MovingCampaignArm final : public CampaignArm {
 public:
  MovingCampaignArm(std::shared_ptr<const probing::Specimen> specimen,
                    std::unique_ptr<devices::Device> arm, const probing::ArmSetup& setup,
                    const std::string& description, const ArmWatch& watch)
      : specimen_(std::move(specimen)),
        arm_(std::move(arm)),
        simulated_(dynamic_cast<probing::VirtualArm*>(arm_.get())),
        is_replay_(dynamic_cast<devices::ReplayDevice*>(arm_.get()) != nullptr),
        options_(setup.prober),
        links_(setup.links),
        stop_(watch.stop_file.empty() ? std::nullopt : std::optional(watch.stop_file)),
        at_interrupt_([this] { stop_.press(); }) {
    devices::Device* used = arm_.get();
    if (!watch.record.empty()) {
      recorder_.emplace(*arm_, watch.record, description);
      used = &*recorder_;
    }
    prober_.emplace(*used, options_, &stop_);
  }

  /// Goes on after the trials that left `memory`, unless gravity was measured again.
  void remember(const Json& memory) {
    if (!remembers()) return;
    devices::Device* used = recorder_ ? static_cast<devices::Device*>(&*recorder_) : arm_.get();
    if (simulated_ != nullptr) simulated_->restore(simulation_of(memory.at("simulation")));
    prober_.emplace(*used, options_, &stop_, gravity_of(memory.at("gravity")));
  }

  void start() override {
    if (!prober_->gravity()) prober_->calibrate();
  }
  void keep_record() override {
    if (recorder_) recorder_->flush();
  }
  bool moves() const override { return true; }
  bool is_device() const override { return simulated_ == nullptr && !is_replay_; }
  std::shared_ptr<const probing::Specimen> specimen() const override { return specimen_; }
  bool tells_truth() const override { return simulated_ != nullptr; }
  const probing::ArmProber* prober() const override { return &*prober_; }
  probing::ProbeReport perform(const probing::ProbeAction& action) override {
    probing::ProbeReport report = prober_->perform(action);
    if (simulated_ != nullptr) {
      const probing::VirtualArmTruth& truth = simulated_->truth();
      report.truth = {.contact = truth.contact,
                      .force = options_.T_world_base.linear() * truth.force,
                      .tip = options_.T_world_base * truth.tip};
    }
    return report;
  }
  std::string memory() const override {
    if (!remembers() || !prober_->gravity()) return {};
    Json memory{{"gravity", gravity_json(*prober_->gravity())}};
    if (simulated_ != nullptr) memory["simulation"] = simulation_json(simulated_->memory());
    return memory.dump();
  }
  probing::PlanReach reach(const probing::ContactPlan& plan,
                           const geometry::TriangleMesh* surface) const override {
    const double lever = std::max(options_.geometry.upper, options_.geometry.lower);
    probing::ReachOptions options;
    options.geometry = options_.geometry;
    options.T_world_base = options_.T_world_base;
    options.highest_torque = arm_->description().highest_force * lever;
    options.links = links_;
    if (specimen_) surface = &specimen_->surface();
    if (surface == nullptr) return probing::reach_of_plan(plan, options);
    const geometry::SurfaceQuery query(*surface);
    return probing::reach_of_plan(plan, options, &query);
  }

 private:
  /// A device may have been moved or warmed up since: it measures gravity again, and so does its
  /// replay. Only a virtual arm, which has a specimen, continues with its earlier measurement.
  bool remembers() const { return simulated_ != nullptr || (is_replay_ && specimen_); }

  std::shared_ptr<const probing::Specimen> specimen_;
  std::unique_ptr<devices::Device> arm_;
  probing::VirtualArm* simulated_;  // `arm_` if it is one
  bool is_replay_;
  probing::ArmProberOptions options_;
  probing::LinkClearance links_;
  std::optional<devices::RecordingDevice> recorder_;
  devices::EmergencyStop stop_;
  AtInterrupt at_interrupt_;
  std::optional<probing::ArmProber> prober_;
};

/// A description with the members that its kind of arm needs.
Json checked_description(const std::string& text, const std::string& source) {
  const Json json = Json::parse(text, nullptr, false);
  const auto has = [&](const char* name) { return json.contains(name) && json[name].is_string(); };
  bool whole = json.is_object() && has("arm");
  if (whole) {
    const auto kind = json["arm"].get<std::string>();
    const bool seeded = json.contains("seed") && json["seed"].is_number_unsigned();
    whole = (kind == kQuasiStatic && has("specimen") && seeded) ||
            (kind == kVirtual && has("specimen") && has("setup") && seeded) ||
            (kind == kDevice && has("driver") && has("setup")) ||
            (kind == kReplay && has("record"));
  }
  if (!whole)
    throw FileError(source +
                    ": does not say which arm probes; expected the store of 'palpate probe run'");
  return json;
}

std::shared_ptr<const probing::Specimen> specimen_of(const Json& json, const std::string& source,
                                                     const probing::ContactPlan& plan) {
  std::shared_ptr<const probing::Specimen> specimen =
      probing::parse_specimen(json.at("specimen").get<std::string>(), source);
  if (probing::surface_fingerprint(specimen->surface()) != plan.surface) {
    throw InvalidInput(source +
                       ": the plan is of another surface than that of the specimen. Plan with "
                       "--specimen, or with the surface.ply of 'palpate probe truth'");
  }
  return specimen;
}

/// The setup of an arm; its pose follows from its specimen unless it is given.
probing::ArmSetup setup_of(const Json& json, const std::string& source,
                           const probing::Specimen* specimen) {
  probing::ArmSetup setup = probing::parse_arm_setup(json.at("setup").get<std::string>(), source);
  if (setup.knows_pose) return setup;
  if (specimen == nullptr) {
    throw InvalidInput(source +
                       ": has no 'pose' of the arm's base, so that the plan cannot be followed; "
                       "give it in --arm-config (docs/probing.md)");
  }
  setup.prober.T_world_base = probing::mount_over(specimen->surface(), setup.prober.geometry);
  return setup;
}

std::unique_ptr<MovingCampaignArm> make_moving_arm(const Json& json, const std::string& source,
                                                   const probing::ContactPlan& plan,
                                                   const ArmWatch& watch) {
  const auto kind = json["arm"].get<std::string>();
  if (kind == kReplay) {
    auto record = std::make_unique<devices::ReplayDevice>(json["record"].get<std::string>());
    const Json session = checked_description(record->session(), source);
    std::shared_ptr<const probing::Specimen> specimen;
    if (session["arm"] == kVirtual) specimen = specimen_of(session, source, plan);
    const probing::ArmSetup setup = setup_of(session, source, specimen.get());
    return std::make_unique<MovingCampaignArm>(specimen, std::move(record), setup, json.dump(),
                                               watch);
  }
  if (kind == kDevice) {
    const probing::ArmSetup setup = setup_of(json, source, nullptr);
    return std::make_unique<MovingCampaignArm>(
        nullptr,
        std::make_unique<devices::PluginDevice>(json["driver"].get<std::string>(), setup.driver),
        setup, json.dump(), watch);
  }
  const std::shared_ptr<const probing::Specimen> specimen = specimen_of(json, source, plan);
  const probing::ArmSetup setup = setup_of(json, source, specimen.get());
  probing::VirtualArmOptions options;
  options.geometry = setup.prober.geometry;
  options.T_world_base = setup.prober.T_world_base;
  options.seed = json["seed"].get<std::uint64_t>();
  return std::make_unique<MovingCampaignArm>(
      specimen, std::make_unique<probing::VirtualArm>(specimen.get(), options), setup, json.dump(),
      watch);
}

}  // namespace

probing::PlanReach CampaignArm::reach(const probing::ContactPlan& plan,
                                      const geometry::TriangleMesh* /*surface*/) const {
  probing::PlanReach all;
  all.contacts.resize(plan.contacts.size(), probing::Reach::reachable);
  all.counts[0] = static_cast<int>(plan.contacts.size());
  return all;
}

std::string describe_arm(const ArmCall& call) {
  const bool is_simulated = call.arm == kQuasiStatic || call.arm == kVirtual;
  const std::string setup = call.setup.empty() ? kNoSetup : documents::read_json_text(call.setup);
  if (!call.setup.empty())  // so that messages name the file
    static_cast<void>(probing::parse_arm_setup(setup, call.setup.string()));
  if (!call.replay.empty()) {
    if (!call.specimen.empty() || !call.setup.empty() || call.arm != kQuasiStatic) {
      throw InvalidInput(
          "--replay: the record says which arm it was; leave out --arm, --specimen and "
          "--arm-config");
    }
    return Json{{"arm", kReplay}, {"record", fs::absolute(call.replay).string()}}.dump();
  }
  if (is_simulated) {
    if (call.specimen.empty())
      throw InvalidInput("--arm " + call.arm + ": is a simulated arm; give --specimen");
    if (call.arm == kQuasiStatic && !call.setup.empty())
      throw InvalidInput("--arm-config: the quasi-static arm has no setup; give --arm virtual");
    Json json{{"arm", call.arm},
              {"specimen", documents::read_json_text(call.specimen)},
              {"seed", call.seed}};
    if (call.arm == kVirtual) json["setup"] = setup;
    return json.dump();
  }
  if (!call.specimen.empty())
    throw InvalidInput("--specimen: is for simulated arms; --arm is " + call.arm);
  if (!fs::is_regular_file(call.arm)) {
    throw FileError("--arm " + call.arm +
                    ": there is no such file; it must be quasi-static, virtual, or the driver of "
                    "a device, a shared library");
  }
  return Json{{"arm", kDevice}, {"driver", fs::absolute(call.arm).string()}, {"setup", setup}}
      .dump();
}

std::unique_ptr<CampaignArm> make_campaign_arm(const std::string& description,
                                               const std::string& source,
                                               const probing::ContactPlan& plan,
                                               const std::string& memory, const ArmWatch& watch) {
  const Json json = checked_description(description, source);
  if (json["arm"] == kQuasiStatic) {
    if (!watch.record.empty() || !watch.stop_file.empty()) {
      throw InvalidInput(
          "--record and --stop-file are for arms that move; the arm is quasi-static");
    }
    probing::QuasiStaticArmOptions options;
    options.seed = json["seed"].get<std::uint64_t>();
    recall(memory, source, [&](const Json& known) { take_vector(known.at("tip"), options.start); });
    return std::make_unique<QuasiStaticCampaignArm>(specimen_of(json, source, plan), options);
  }
  std::unique_ptr<MovingCampaignArm> arm = make_moving_arm(json, source, plan, watch);
  recall(memory, source, [&](const Json& known) { arm->remember(known); });
  return arm;
}

}  // namespace palpate::apps
