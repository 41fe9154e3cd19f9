// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "probing/probe_camera.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <array>
#include <nlohmann/json.hpp>
#include <optional>
#include <utility>
#include <vector>

#include "palpate/acquisition/live_rest_camera.h"
#include "palpate/acquisition/virtual_camera.h"
#include "palpate/core/error.h"
#include "palpate/core/field_text.h"
#include "palpate/core/file_fingerprint.h"
#include "palpate/sensing/pattern.h"
#include "palpate/sensing/rig.h"
#include "palpate/sensing/trained_colors.h"
#include "palpate/sensing/virtual_sensor.h"
#include "seeing/simulate_scene.h"
#include "shared/call_checks.h"
#include "shared/field_options.h"
#include "shared/inputs.h"

namespace palpate::apps {
namespace {

constexpr const char* kSimulated = "simulated";
constexpr const char* kRange = "range";
constexpr const char* kTruth = "truth";

/// Options that name files.
constexpr std::array<std::pair<const char*, fs::path CameraCall::*>, 4> kFiles = {
    {{"--rig", &CameraCall::rig},
     {"--pattern", &CameraCall::pattern},
     {"--colors", &CameraCall::colors},
     {"--sensor", &CameraCall::sensor}}};
/// The image of the pattern, which lies beside it.
constexpr const char* kPanel = "pattern.png";

fs::path panel_of(const fs::path& pattern) { return fs::path(pattern).replace_extension(".png"); }

Json with_content(const fs::path& file) {
  if (!is_there(file)) throw FileError(file.string() + ": there is no such file");
  return {{"path", fs::absolute(file).string()}, {"content", file_fingerprint(file)}};
}

fs::path path_of(const Json& camera, const char* option) {
  return camera.contains(option) ? fs::path(camera[option]["path"].get<std::string>()) : fs::path();
}

fs::path beside(const fs::path& store, const char* folder) { return store.parent_path() / folder; }

Json values_of(const FieldList& fields) {
  Json values = Json::object();
  for (const FieldText& field : texts_of(fields)) values[field.name] = field.text;
  return values;
}

void take_values(const Json& values, const FieldList& fields) {
  for (const auto& [name, value] : values.items()) assign(fields, name, value.get<std::string>());
}

Json describe_live(const LiveCameraCall& call) {
  sensing::CameraSettings settings = call.settings;
  return {{"size", call.size},
          {"settings", values_of(fields_of(settings))},
          {"pixel_format", settings.pixel_format},
          {"patience", call.patience}};
}

LiveCameraCall live_of(const Json& camera) {
  const Json& live = camera["live"];
  LiveCameraCall call{.name = camera["camera"].get<std::string>(),
                      .size = live["size"].get<std::vector<int>>(),
                      .settings = {.pixel_format = live["pixel_format"].get<std::string>()},
                      .patience = live["patience"].get<double>()};
  take_values(live["settings"], fields_of(call.settings));
  return call;
}

/// \throws InvalidInput if an option is for the other kind of camera.
void check_kind(const CameraCall& call) {
  const bool is_simulated = call.camera.name == kSimulated;
  const auto refuse = [&](const std::string& option) {
    throw InvalidInput(option + ": has no effect with --camera " + call.camera.name +
                       (is_simulated ? "; it sets a connected camera" : "; it is for 'simulated'"));
  };
  if (!is_simulated) {
    if (!call.sensor.empty()) refuse("--sensor");
    if (call.truth) refuse("--truth");
    return;
  }
  if (!call.camera.size.empty()) refuse("--size");
  if (!call.camera.settings.pixel_format.empty()) refuse("--pixel-format");
  if (call.camera.patience != LiveCameraCall{}.patience) refuse("--patience");
  sensing::CameraSettings given = call.camera.settings, usual;
  if (const std::string set = changed_options(fields_of(given), fields_of(usual)); !set.empty())
    refuse(set.substr(1));
}

std::unique_ptr<acquisition::RestCamera> live_camera(const Json& json, const sensing::Rig& rig,
                                                     const CampaignArm& arm) {
  if (!arm.is_device() && !arm.tells_truth()) {
    throw InvalidInput(
        "--camera: a record of an arm moves nothing that a camera could see; give no --replay");
  }
  if (arm.tells_truth())
    spdlog::warn("The arm is simulated: a connected camera does not see what it does.");
  std::unique_ptr<sensing::LiveCamera> camera = open_live_camera(live_of(json));
  check_sends_frames_of(rig.camera, path_of(json, "--rig"), camera->state());
  return acquisition::make_live_rest_camera(std::move(camera), live_of(json).patience);
}

std::unique_ptr<acquisition::RestCamera> simulated_camera(const Json& json, const sensing::Rig& rig,
                                                          const sensing::Pattern& pattern,
                                                          const acquisition::ToolShape& tool,
                                                          const CampaignArm& arm) {
  if (!arm.specimen() || !arm.tells_truth()) {
    throw InvalidInput(
        "--camera simulated: sees what a simulated arm does to a specimen; give --arm quasi-static "
        "or virtual, without --replay");
  }
  const fs::path pattern_file = path_of(json, "--pattern"), sensor = path_of(json, "--sensor");
  acquisition::VirtualCameraSetup setup{.rig = rig, .pattern = pattern, .tool = tool};
  setup.panel =
      read_panel(panel_of(pattern_file), pattern_file, rig.projector, path_of(json, "--rig"));
  if (!sensor.empty()) setup.sensor = sensing::read_virtual_sensor(sensor);
  setup.sensor.seed = json["seed"].get<unsigned>();
  try {
    return acquisition::make_virtual_camera(arm.specimen(), std::move(setup));
  } catch (const InvalidInput& unseen) {
    throw InvalidInput(std::string("--camera simulated: ") + unseen.what());
  }
}

}  // namespace

std::vector<CLI::Option*> add_camera_files(CLI::App& command, CameraCall& call) {
  return {
      command.add_option("--rig", call.rig, "Camera and projector (rig.yaml)"),
      command.add_option("--pattern", call.pattern,
                         "Projected pattern (pattern.yaml, with its image pattern.png beside it)"),
      command.add_option("--colors", call.colors,
                         "Trained colours (colors.yaml), for a pattern with stripes"),
      command.add_option("--sensor", call.sensor,
                         "Light, optics and electronics of a simulated camera (sensor.yaml, as "
                         "'palpate simulate' writes it); default: a colour camera with 8 bits")};
}

void add_campaign_camera(CLI::App& command, CameraCall& call) {
  CLI::Option* camera = command.add_option(
      "--camera", call.camera.name,
      std::string("Record a range map of the deformed object with each sample, into range/ beside "
                  "the store. simulated: the virtual sensor sees the specimen, and the tip; or a "
                  "connected camera: ") +
          kLiveCameras);
  camera->check(CLI::Validator(
      [](const std::string& name) {
        return name == kSimulated || name.find(':') != std::string::npos
                   ? std::string()
                   : fmt::format(
                         "is \"{}\"; it must be 'simulated', or a connected camera such as "
                         "aravis:NAME or v4l2:NUMBER",
                         name);
      },
      ""));
  std::vector<CLI::Option*> others = add_camera_files(command, call);
  others.push_back(command.add_flag(
      "--truth", call.truth,
      "Also write the true depths that a simulated camera sees, into truth/ beside the store"));
  for (CLI::Option* option : add_camera_settings(command, call.camera)) others.push_back(option);
  for (CLI::Option* option : others) option->needs(camera)->group("With --camera");
  add_fields_of(*camera, command, fields_of(call.seeing));
}

std::string describe_camera(const CameraCall& call, std::uint64_t seed) {
  if (call.camera.name.empty()) return {};
  check_kind(call);
  for (const auto& [option, file] : {kFiles[0], kFiles[1]}) {
    if ((call.*file).empty())
      throw InvalidInput(std::string(option) +
                         ": is missing; a camera needs it to decode what it sees");
  }
  Json camera{{"camera", call.camera.name}, {"seed", seed}, {"truth", call.truth}};
  for (const auto& [option, file] : kFiles)
    if (!(call.*file).empty()) camera[option] = with_content(call.*file);
  if (call.camera.name == kSimulated)
    camera[kPanel] = with_content(panel_of(call.pattern));
  else
    camera["live"] = describe_live(call.camera);
  acquisition::SeeingOptions seeing = call.seeing;
  camera["seeing"] = values_of(fields_of(seeing));
  return camera.dump();
}

std::string moved_camera(const std::string& description, const CameraCall& call,
                         const fs::path& store) {
  if (description.empty()) {
    for (const auto& [option, file] : kFiles) {
      if (!(call.*file).empty())
        throw InvalidInput(std::string(option) + ": the campaign of " + store.string() +
                           " has no camera; leave it out");
    }
    return {};
  }
  Json camera = Json::parse(description);
  const auto take = [&](const char* option, const fs::path& given) {
    if (!camera.contains(option) && given.empty()) return;
    const fs::path now = given.empty() ? path_of(camera, option) : given;
    const Json there = with_content(now);
    if (!camera.contains(option) || there["content"] != camera[option]["content"]) {
      throw InvalidInput(
          now.string() + ": is not the file with which the campaign of " + store.string() +
          " began, so its range maps would not fit those that are recorded. Give that one" +
          (option == kPanel ? std::string(" beside --pattern") : " with " + std::string(option)) +
          ", or begin a new campaign");
    }
    camera[option] = there;
  };
  for (const auto& [option, file] : kFiles) take(option, call.*file);
  if (camera.contains(kPanel))
    take(kPanel, call.pattern.empty() ? fs::path() : panel_of(call.pattern));
  return camera.dump();
}

void check_camera_folders(const std::string& description, const fs::path& store) {
  if (description.empty()) return;
  std::vector<const char*> folders{kRange};
  if (Json::parse(description)["truth"].get<bool>()) folders.push_back(kTruth);
  for (const char* folder : folders) {
    const fs::path place = beside(store, folder);
    std::error_code error;
    if (fs::exists(place, error) && !fs::is_empty(place, error)) {
      throw InvalidInput(place.string() +
                         ": holds files already, and the campaign would write its own into it; "
                         "write the store into a folder of its own");
    }
  }
}

struct CampaignCamera::Impl {
  fs::path folder;  // of the store
  bool truth;
  sensing::Rig rig;
  std::unique_ptr<acquisition::RestCamera> camera;
  std::optional<sensing::Decoder> decoder;
  std::optional<acquisition::SeeingProber> prober;
};

CampaignCamera::CampaignCamera(const std::string& description, const fs::path& store,
                               const probing::ContactPlan& plan, CampaignArm& arm) {
  const Json json = Json::parse(description);
  const fs::path pattern_file = path_of(json, "--pattern"), colors = path_of(json, "--colors");
  const sensing::Rig rig = load_rig(path_of(json, "--rig"));
  const sensing::Pattern pattern = sensing::read_pattern(pattern_file);
  sensing::check_pattern_fits(pattern, rig.projector, pattern_file.string());
  if (pattern.multishot) {
    throw InvalidInput(pattern_file.string() +
                       ": is for several images of a still scene; a campaign takes one of each "
                       "sample. Give the pattern of 'palpate pattern' without --multishot");
  }
  if (colors.empty() && !pattern.stripe_edges.empty()) {
    throw InvalidInput("--colors: is missing; " + pattern_file.string() +
                       " has coloured stripes. Give the trained colours (colors.yaml), as palpate "
                       "calibrate colors writes them.");
  }
  acquisition::SeeingOptions seeing;
  take_values(json["seeing"], fields_of(seeing));
  const std::shared_ptr<const probing::Specimen> specimen = arm.specimen();
  const double radius =
      (specimen ? specimen->tip_radius() : std::nullopt).value_or(plan.options.tip_radius);
  impl_.reset(new Impl{.folder = store.parent_path(),
                       .truth = json["truth"].get<bool>(),
                       .rig = rig,
                       .camera = nullptr,
                       .decoder = {},
                       .prober = {}});
  impl_->decoder.emplace(
      rig, pattern,
      colors.empty() ? sensing::TrainedColors{} : sensing::read_trained_colors(colors));
  impl_->camera =
      json["camera"] == kSimulated
          ? simulated_camera(json, rig, pattern, {.radius = radius, .shaft = seeing.shaft}, arm)
          : live_camera(json, rig, arm);
  impl_->prober.emplace(
      arm, *impl_->camera, *impl_->decoder, radius,
      acquisition::SeeingFolders{
          .base = impl_->folder, .range = kRange, .truth = impl_->truth ? kTruth : ""},
      seeing);
}
CampaignCamera::~CampaignCamera() = default;

void CampaignCamera::begin() const {
  sensing::write_rig(impl_->folder / kRange / "rig.yaml", impl_->rig);
  if (impl_->truth) sensing::write_rig(impl_->folder / kTruth / "rig.yaml", impl_->rig);
}

probing::Prober& CampaignCamera::prober() { return *impl_->prober; }

}  // namespace palpate::apps
