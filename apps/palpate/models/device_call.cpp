// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "models/device_call.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <iterator>
#include <string_view>

#include "palpate/core/error.h"

namespace palpate::apps {
namespace {

// Devices that have a setting, as bits.
constexpr unsigned kOfPath = 1;  // recorded and scripted
constexpr unsigned kOfHand = 2;
constexpr unsigned kOfArm = 4;

struct HandSetting {
  std::string_view key, unit;
  unsigned devices;
  void (*set)(haptics::HandOptions&, double);
};

constexpr int kMostDelay = 1000;  // [ticks]; far beyond what `HandOptions` takes

constexpr HandSetting kHandSettings[] = {
    {"mass", "[kg]", kOfHand | kOfArm, [](haptics::HandOptions& h, double x) { h.mass = x; }},
    {"damping", "[N s/mm]", kOfHand | kOfArm,
     [](haptics::HandOptions& h, double x) { h.damping = x; }},
    {"friction", "[N]", kOfHand, [](haptics::HandOptions& h, double x) { h.friction = x; }},
    {"stiffness", "[N/mm]", kOfHand | kOfArm,
     [](haptics::HandOptions& h, double x) { h.stiffness = x; }},
    {"encoder_step", "[mm]", kOfHand,
     [](haptics::HandOptions& h, double x) { h.encoder_step = x; }},
    {"delay", "[ticks]", kOfHand,
     [](haptics::HandOptions& h, double x) {
       h.delay = static_cast<int>(std::clamp<double>(x, -1, kMostDelay));
     }},
    {"rate", "[Hz]", kOfPath | kOfHand,
     [](haptics::HandOptions& h, double x) { h.period = 1 / x; }},
};

unsigned simulated_kind(const std::string& device) {
  if (device == kHeldArm) return kOfArm;
  return device == kHand ? kOfHand : kOfPath;
}

std::string settings_in_words(unsigned kind) {
  std::string words;
  for (const HandSetting& setting : kHandSettings) {
    if ((setting.devices & kind) == 0) continue;
    if (!words.empty()) words += ", ";
    words.append(setting.key).append(" ").append(setting.unit);
  }
  return words;
}

double number_of(const std::string& key, const std::string& text) {
  double value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size() || !std::isfinite(value)) {
    throw InvalidInput("--set " + key + "=" + text + ": must be a finite number");
  }
  return value;
}

}  // namespace

bool is_driver(const std::string& device) {
  return device != kRecorded && device != kScripted && device != kHand && device != kHeldArm;
}

void check_driver(const std::string& device) {
  if (fs::is_regular_file(device)) return;
  throw FileError("--device " + device +
                  ": there is no such file; it must be recorded, scripted, hand, arm, or the "
                  "driver of a device, a shared library");
}

std::map<std::string, std::string> device_settings(const DeviceCall& call) {
  std::map<std::string, std::string> settings;
  for (const std::string& word : call.settings) {
    const std::size_t equals = word.find('=');
    if (equals == std::string::npos || equals == 0) {
      throw InvalidInput("--set " + word + ": must be KEY=VALUE, such as damping=0.002");
    }
    settings[word.substr(0, equals)] = word.substr(equals + 1);
  }
  return settings;
}

haptics::HandOptions hand_options(const DeviceCall& call) {
  haptics::HandOptions hand;
  hand.real_time = call.real_time;
  const unsigned kind = simulated_kind(call.device);
  for (const auto& [key, text] : device_settings(call)) {
    const auto* const setting =
        std::ranges::find_if(kHandSettings, [&key = key, kind](const HandSetting& one) {
          return one.key == key && (one.devices & kind) != 0;
        });
    if (setting == std::end(kHandSettings)) {
      throw InvalidInput("--set " + key + ": --device " + call.device + " has " +
                         settings_in_words(kind));
    }
    setting->set(hand, number_of(key, text));
  }
  return hand;
}

haptics::CouplingOptions coupling_of(const std::string& word) {
  haptics::CouplingOptions coupling;
  if (word == "auto") return coupling;
  if (word == "off") {
    coupling.on = false;
    return coupling;
  }
  double value = 0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (error != std::errc() || end != word.data() + word.size() || !(value > 0)) {
    throw InvalidInput("--coupling: is " + word +
                       "; it must be auto, off, or a stiffness > 0 N/mm");
  }
  coupling.stiffness = value;
  return coupling;
}

}  // namespace palpate::apps
