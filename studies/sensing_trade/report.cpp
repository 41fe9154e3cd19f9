// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "report.h"

#include <fmt/format.h>
#include <fmt/ostream.h>

#include <algorithm>

namespace palpate::bench {
namespace {

std::vector<std::string> settings_of(const Experiment& experiment) {
  std::vector<std::string> settings;
  for (const Row& row : experiment.rows) {
    if (std::find(settings.begin(), settings.end(), row.setting) == settings.end()) {
      settings.push_back(row.setting);
    }
  }
  return settings;
}

std::vector<std::string> scenes_of(const Experiment& experiment) {
  std::vector<std::string> scenes;
  for (const Row& row : experiment.rows) {
    if (std::find(scenes.begin(), scenes.end(), row.scene) == scenes.end()) {
      scenes.push_back(row.scene);
    }
  }
  return scenes;
}

const Figures& figures_of(const Experiment& experiment, const std::string& setting,
                          const std::string& scene) {
  return std::find_if(experiment.rows.begin(), experiment.rows.end(),
                      [&](const Row& row) { return row.setting == setting && row.scene == scene; })
      ->figures;
}

double median_ms(const Experiment& experiment, const std::string& setting) {
  std::vector<double> times;
  for (const Row& row : experiment.rows) {
    if (row.setting == setting) times.push_back(row.figures.ms);
  }
  std::sort(times.begin(), times.end());
  return times[times.size() / 2];
}

}  // namespace

void write_comparison(std::ostream& out, const Experiment& experiment) {
  const std::vector<std::string> settings = settings_of(experiment);
  fmt::print(out, "\n| {} |", experiment.name);
  for (const std::string& setting : settings) fmt::print(out, " {} |", setting);
  fmt::print(out, "\n|---|");
  for (std::size_t i = 0; i < settings.size(); ++i) fmt::print(out, "---|");
  for (const std::string& scene : scenes_of(experiment)) {
    fmt::print(out, "\n| {} |", scene);
    for (const std::string& setting : settings) {
      const Figures& f = figures_of(experiment, setting, scene);
      fmt::print(out, " {:.4f} / {:.3f} / {:.1f} / {:.2f} |", f.median, f.rms, f.coverage, f.wrong);
    }
  }
  fmt::print(out, "\n| ms a frame |");
  for (const std::string& setting : settings) {
    fmt::print(out, " {:.1f} |", median_ms(experiment, setting));
  }
  fmt::print(out, "\n");
}

void write_scenes(std::ostream& out, const Experiment& experiment) {
  fmt::print(
      out,
      "\n| {} | median [%] | RMS [%] | coverage [%] | coverage away from steps [%] | wrong [%] "
      "| wrong away from steps [%] | error / sigma | ripple [%] | normals [deg] | ms "
      "|\n|---|---|---|---|---|---|---|---|---|---|---|\n",
      experiment.name);
  for (const Row& row : experiment.rows) {
    const Figures& f = row.figures;
    fmt::print(
        out,
        "| {} | {:.4f} | {:.3f} | {:.1f} | {:.1f} | {:.2f} | {:.2f} | {:.2f} | {:.4f} | {:.2f} "
        "| {:.1f} |\n",
        row.scene, f.median, f.rms, f.coverage, f.coverage_away, f.wrong, f.wrong_away, f.score,
        f.ripple, f.normals, f.ms);
  }
}

void write_csv(std::ostream& out, const std::vector<Experiment>& experiments) {
  fmt::print(out,
             "experiment,setting,scene,median_percent,rms_percent,coverage_percent,"
             "coverage_away_percent,wrong_percent,wrong_away_percent,error_per_sigma,"
             "ripple_percent,normals_degrees,ms\n");
  for (const Experiment& experiment : experiments) {
    for (const Row& row : experiment.rows) {
      const Figures& f = row.figures;
      fmt::print(out,
                 "{},{},{},{:.5f},{:.5f},{:.3f},{:.3f},{:.4f},{:.4f},{:.3f},{:.5f},{:.4f},{:.2f}\n",
                 experiment.name, row.setting, row.scene, f.median, f.rms, f.coverage,
                 f.coverage_away, f.wrong, f.wrong_away, f.score, f.ripple, f.normals, f.ms);
    }
  }
}

}  // namespace palpate::bench
