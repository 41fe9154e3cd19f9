// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "commands/calibrate.h"

namespace palpate::apps {

void add_calibrate(CLI::App& app, const Settings& settings) {
  CLI::App* calibrate =
      app.add_subcommand("calibrate", "Calibrate rig, response, colours or chromatic aberration");
  calibrate->require_subcommand(1);
  add_calibrate_rig(*calibrate, settings);
  add_calibrate_colors(*calibrate, settings);
  add_calibrate_chromatic(*calibrate, settings);
  add_calibrate_response(*calibrate, settings);
}

}  // namespace palpate::apps
