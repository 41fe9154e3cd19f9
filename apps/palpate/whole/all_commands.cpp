// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "whole/all_commands.h"

#include <initializer_list>
#include <vector>

#include "seeing/capture.h"

namespace palpate::apps {
namespace {

void add_calibrate(CLI::App& app, const Settings& settings) {
  CLI::App* calibrate = app.add_subcommand(
      "calibrate",
      "Calibrate rig, response, colours, crosstalk or chromatic aberration, or place an arm");
  calibrate->require_subcommand(1);
  add_calibrate_rig(*calibrate, settings);
  add_calibrate_colors(*calibrate, settings);
  add_calibrate_chromatic(*calibrate, settings);
  add_calibrate_response(*calibrate, settings);
  add_calibrate_crosstalk(*calibrate, settings);
  add_calibrate_arm(*calibrate, settings);
}

using AddCommand = void (*)(CLI::App& app, const Settings& settings);

/// Adds commands that the help lists under one heading.
void add_group(CLI::App& app, const Settings& settings, const char* heading,
               std::initializer_list<AddCommand> commands) {
  const auto all = [&app] { return app.get_subcommands([](CLI::App*) { return true; }); };
  const std::size_t before = all().size();
  for (const AddCommand add : commands) add(app, settings);
  const std::vector<CLI::App*> now = all();
  for (std::size_t i = before; i < now.size(); ++i) now[i]->group(heading);
}

}  // namespace

void add_commands(CLI::App& app, const Settings& settings) {
  app.require_subcommand(1);
  add_group(app, settings, "Everything at once",
            {add_demo, add_plan, add_run, add_trade, add_merge_shards, add_info});
  add_group(app, settings, "From camera frames to range maps",
            {add_pattern, add_calibrate, add_capture, add_simulate, add_decode});
  add_group(app, settings, "Meshes, point clouds and sequences",
            {add_mesh, add_cloud, add_path, add_fuse, add_track, add_motion, add_compare});
  add_group(app, settings, "From measurements to models",
            {add_probe, add_bake, add_fit, add_merge, add_reduce, add_transfer, add_identify,
             add_evaluate});
  add_group(app, settings, "Feeling and showing models", {add_play, add_export});
  refuse_empty_values(app);
}

}  // namespace palpate::apps
