// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "models/play_options.h"

#include <string>

#include "palpate/core/error.h"
#include "palpate/core/field_text.h"
#include "palpate/haptics/playback.h"
#include "shared/field_options.h"

namespace palpate::apps {
namespace {

// Ways of playing, as bits.
constexpr unsigned kAlong = static_cast<unsigned>(PlayWay::trajectory);
constexpr unsigned kWithSimulated = static_cast<unsigned>(PlayWay::simulated);
constexpr unsigned kWithDriver = static_cast<unsigned>(PlayWay::driver);
constexpr unsigned kReplaying = static_cast<unsigned>(PlayWay::replay);
constexpr unsigned kStabilityOfHand = static_cast<unsigned>(PlayWay::stability_of_hand);
constexpr unsigned kStabilityOfDriver = static_cast<unsigned>(PlayWay::stability_of_driver);
constexpr unsigned kScene = static_cast<unsigned>(PlayWay::scene);
constexpr unsigned kSceneDriver = static_cast<unsigned>(PlayWay::scene_driver);
constexpr unsigned kSceneDevice = static_cast<unsigned>(PlayWay::scene_simulated) | kSceneDriver;
constexpr unsigned kSceneReplay = static_cast<unsigned>(PlayWay::scene_replay);
constexpr unsigned kModelDevice = kWithSimulated | kWithDriver;
constexpr unsigned kAnyDevice = kModelDevice | kSceneDevice;
constexpr unsigned kAnyDriver = kWithDriver | kSceneDriver;
constexpr unsigned kAnyStability = kStabilityOfHand | kStabilityOfDriver;

struct PlayOption {
  const char* name;
  unsigned ways;  // in which it does something
  const char* needs;
};

// Every option of the command except those of playback and those that all commands have.
constexpr PlayOption kPlayOptions[] = {
    {"--trajectory", kAlong | kWithSimulated, "a model folder, alone or with a simulated --device"},
    {"--record", kAlong | kAnyDevice | kScene, "--trajectory, --device or a scene file"},
    {"--picture", kAlong, "--trajectory without --device"},
    {"--tool-radius", kAlong, "--trajectory without --device"},
    {"--probe-radius", kAlong, "--trajectory without --device"},
    {"--device", kAnyDevice | kAnyStability, "no --replay"},
    {"--tool", kSceneDevice, "a scene file and --device"},
    {"--set", kAnyDevice | kAnyStability, "--device or --stability"},
    {"--device-number", kAnyDriver | kStabilityOfDriver, "the driver of a device as --device"},
    {"--in-process", kAnyDriver | kStabilityOfDriver, "the driver of a device as --device"},
    {"--realtime", kAnyDevice, "--device"},
    {"--duration", kAnyDevice, "--device"},
    {"--session", kAnyDevice, "--device"},
    {"--replay", kReplaying | kSceneReplay, "no --device"},
    {"--pose", kAnyDevice, "--device"},
    {"--scale", kAnyDevice | kAnyStability, "--device or --stability"},
    {"--clutch-button", kAnyDriver, "the driver of a device as --device"},
    {"--coupling", kAnyDevice | kAnyStability, "--device or --stability"},
    {"--max-force", kAnyDevice | kAnyStability, "--device or --stability"},
    {"--slew", kAnyDevice, "--device"},
    {"--ramp", kAnyDevice, "--device"},
    {"--heating-time", kAnyDevice, "--device"},
    {"--exchange", kModelDevice | kReplaying, "--device or --replay, with a model folder"},
    {"--exchange-at", kModelDevice, "--device, with a model folder"},
    {"--stability", kAnyStability, "a model folder, and no --replay"},
};

const char* words_of_way(PlayWay way) {
  switch (way) {
    case PlayWay::trajectory:
      return "without --device";
    case PlayWay::simulated:
      return "with a simulated device";
    case PlayWay::driver:
      return "with the driver of a device";
    case PlayWay::replay:
      return "with --replay";
    case PlayWay::stability_of_hand:
      return "with --stability of the simulated hand";
    case PlayWay::stability_of_driver:
      return "with --stability";
    case PlayWay::scene:
      return "with a scene file, which says where its tools go";
    case PlayWay::scene_simulated:
    case PlayWay::scene_driver:
      return "with a device in a scene";
    case PlayWay::scene_replay:
      return "with --replay of a scene";
  }
  return "";
}

}  // namespace

void refuse_idle_options(const CLI::App& play, PlayWay way) {
  const auto refuse_idle = [&](const std::string& name, unsigned ways, const char* needs) {
    const bool works = (ways & static_cast<unsigned>(way)) != 0;
    if (works || play.get_option(name)->count() == 0) return;
    throw InvalidInput(name + ": does nothing " + words_of_way(way) + "; it needs " + needs);
  };
  for (const PlayOption& option : kPlayOptions) refuse_idle(option.name, option.ways, option.needs);
  haptics::PlaybackOptions playback;
  for (const FieldText& field : texts_of(fields_of(playback))) {
    refuse_idle(option_name(field.name), kAlong | kModelDevice,
                "a model folder with --trajectory or --device; a scene file has \"playback\" for "
                "each object");
  }
}

}  // namespace palpate::apps
