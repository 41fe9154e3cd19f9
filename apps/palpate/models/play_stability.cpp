// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "models/device_call.h"
#include "models/play_device.h"
#include "palpate/core/error.h"
#include "palpate/haptics/device_stability.h"
#include "shared/played_model.h"

namespace palpate::apps {

void play_stability(const Settings& settings, const DeviceCall& call) {
  const haptics::Model model = playable_model(call.model);
  const haptics::ModelStiffness stiffness = haptics::model_stiffness(model, call.safety.max_force);
  haptics::HandOptions hand;
  double scale = call.scale.value_or(1);
  bool declared = true;  // the resolution
  if (is_driver(call.device)) {
    const OpenedDevice device = open_driver(call);
    const devices::DeviceDescription& description = device.arm->description();
    hand.rate = 1 / description.period;
    hand.damping = description.damping;
    hand.friction = description.friction;
    declared = description.resolution > 0;
    if (declared) hand.encoder_step = description.resolution;
    constexpr double kRounding = 1e-9;  // [ticks] of a delay of whole ticks
    hand.delay = static_cast<int>(std::ceil(description.delay / description.period - kRounding));
    scale = call.scale.value_or(description.workspace_scale);
  } else if (call.device == kHand) {
    hand = hand_options(call);
  } else {
    throw InvalidInput(
        "--stability: is that of the simulated hand, or of the driver of a device; --device is " +
        call.device);
  }
  const haptics::CouplingOptions& coupling = call.coupling;
  const double delay = hand.delay * hand.period();
  const double passive = haptics::passive_stiffness(hand.damping, hand.period(), delay);
  const double spring = haptics::coupling_stiffness(coupling, hand.damping, hand.period(), delay);
  const auto felt = [&](double object) { return object * spring / (object + spring); };
  const double calm_without = haptics::largest_calm_stiffness(hand, {.on = false});
  const double calm_with =
      coupling.on ? haptics::largest_calm_stiffness(hand, coupling) : calm_without;
  const double median = stiffness.median * scale, largest = stiffness.largest * scale;
  const double felt_largest = coupling.on ? felt(largest) : largest;
  const double quiet = haptics::quiet_stiffness(hand.friction, hand.encoder_step);
  const double quiet_friction = haptics::quiet_friction(felt_largest, hand.encoder_step);

  Json needs = Json::array();
  std::string table;
  for (const double rate : {500.0, 1000.0, 2000.0, 4000.0}) {
    const double period = 1 / rate;
    const double for_median = haptics::passive_damping(median, period, hand.delay * period);
    const double for_largest = haptics::passive_damping(largest, period, hand.delay * period);
    needs.push_back(
        {{"rate", rate}, {"damping_of_median", for_median}, {"damping_of_largest", for_largest}});
    table += fmt::format("\n  {:6.0f} Hz   {:10.4g}   {:10.4g}", rate, for_median, for_largest);
  }
  const std::string chatter =
      hand.encoder_step > 0
          ? fmt::format(
                "Positions in steps of {:.3g} mm{}, dry friction {:.3g} N: a hand at rest does "
                "not chatter on up to {:.3g} N/mm; what is felt needs {:.3g} N",
                hand.encoder_step, declared ? "" : " (assumed: the driver does not tell)",
                hand.friction, quiet, quiet_friction)
          : std::string("Positions are exact: no steps of an encoder make a hand chatter");
  const auto calm_words = [](double value) {
    return value >= 1e3 ? std::string("any stiffness up to 1000 N/mm")
                        : fmt::format("up to {:.3g} N/mm", value);
  };
  print(settings,
        {{"median_stiffness", median},
         {"largest_stiffness", largest},
         {"stiffest_contact", stiffness.stiffest},
         {"damping", hand.damping},
         {"delay", delay},
         {"rate", hand.rate},
         {"passive_stiffness", passive},
         {"coupling_stiffness", number_or_null(coupling.on ? std::optional(spring) : std::nullopt)},
         {"felt_stiffness", felt_largest},
         {"friction", hand.friction},
         {"resolution", hand.encoder_step},
         {"quiet_stiffness", number_or_null(quiet)},
         {"quiet_friction", quiet_friction},
         {"calm_without_coupling", calm_without},
         {"calm_with_coupling", calm_with},
         {"needed_damping", needs}},
        fmt::format(
            "At the device the model has {:.3g} N/mm in the median, at most {:.3g} N/mm (contact "
            "{})\n"
            "The device: damping {:.3g} N s/mm, {:.0f} Hz, delay {:.3g} ms; passive up to {:.3g} "
            "N/mm\n"
            "Pressed by a simulated hand of {:.3g} kg it is calm on {} without a virtual coupling, "
            "on {} with one\n"
            "{}\n"
            "{}\n"
            "Damping [N s/mm] that a device needs without a coupling, with a delay of {} ticks:\n"
            "       rate       median      largest{}",
            median, largest, stiffness.stiffest, hand.damping, hand.rate, 1e3 * delay, passive,
            hand.mass, calm_words(calm_without), calm_words(calm_with),
            coupling.on ? fmt::format("The coupling has {:.3g} N/mm: the user feels {:.3g} N/mm in "
                                      "the median, at most {:.3g} N/mm",
                                      spring, felt(median), felt_largest)
                        : std::string("The coupling is off"),
            chatter, hand.delay, table));
}

}  // namespace palpate::apps
