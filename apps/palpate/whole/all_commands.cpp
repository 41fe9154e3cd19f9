// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "whole/all_commands.h"

#include "seeing/capture.h"

namespace palpate::apps {
namespace {

void add_calibrate(CLI::App& app, const Settings& settings) {
  CLI::App* calibrate = app.add_subcommand(
      "calibrate", "Calibrate rig, response, colours, crosstalk or chromatic aberration");
  calibrate->require_subcommand(1);
  add_calibrate_rig(*calibrate, settings);
  add_calibrate_colors(*calibrate, settings);
  add_calibrate_chromatic(*calibrate, settings);
  add_calibrate_response(*calibrate, settings);
  add_calibrate_crosstalk(*calibrate, settings);
}

}  // namespace

void add_commands(CLI::App& app, const Settings& settings) {
  app.require_subcommand(1);
  add_demo(app, settings);
  add_pattern(app, settings);
  add_calibrate(app, settings);
  add_capture(app, settings);
  add_simulate(app, settings);
  add_decode(app, settings);
  add_mesh(app, settings);
  add_cloud(app, settings);
  add_path(app, settings);
  add_fuse(app, settings);
  add_track(app, settings);
  add_compare(app, settings);
  add_probe(app, settings);
  add_bake(app, settings);
  add_fit(app, settings);
  add_merge(app, settings);
  add_transfer(app, settings);
  add_identify(app, settings);
  add_evaluate(app, settings);
  add_play(app, settings);
  add_export(app, settings);
  add_run(app, settings);
  add_info(app, settings);
  refuse_empty_values(app);
}

}  // namespace palpate::apps
