// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "whole/run_steps.h"

#include <fmt/format.h>

#include "shared/words.h"

namespace palpate::apps {
namespace {

std::string figure_of_mesh(const Json& figures) {
  if (!figures.contains("triangles")) return fmt::format("{} meshes", figures.at("meshes").dump());
  return fmt::format("{} triangles", figures.at("triangles").dump());
}

std::string figure_of_evaluation(const Json& figures) {
  std::string words;
  for (const auto& [key, what] : {std::pair("queries", "queries"), {"leave_one_out", "left out"}}) {
    if (figures.contains(key))
      words += fmt::format("{}RMS {} ({})", words.empty() ? "" : ", ",
                           newtons(figures.at(key).at("rms").get<double>()), what);
  }
  return words;
}

std::string figure_of_play(const Json& figures) {
  if (!figures.contains("largest_force")) return {};  // of a device, or of a scene
  return "largest force " + newtons(figures.at("largest_force").get<double>(), 3);
}

const std::vector<ProjectStep>& table() {
  static const std::vector<ProjectStep> steps = {
      {.name = "colors",
       .command = {"calibrate", "colors"},
       .inputs = {"folder", "response"},
       .outputs = {"output", "picture"},
       .result = "colors.yaml",
       .main_figure =
           [](const Json& f) { return fmt::format("{} colours", f.at("colors").size()); }},
      {.name = "decode",
       .command = {"decode"},
       .inputs = {"frames", "rig", "pattern", "colors", "response"},
       .outputs = {"output"},
       .result = "range",
       .feeds = {{"colors", {{"colors", "output"}}, {"multishot", "anchor"}}},
       .items = "frames",
       .main_figure =
           [](const Json& f) {
             return fmt::format("{} of {} frames", f.at("decoded").dump(), f.at("frames").dump());
           }},
      {.name = "mesh",
       .command = {"mesh"},
       .inputs = {"range", "rig", "mask", "color-images", "still"},
       .outputs = {"output", "picture"},
       .result = "surface.ply",
       .feeds = {{"range", {{"decode", "output", "000000.tiff"}}, {}}},
       .items = "range",
       .main_figure = figure_of_mesh},
      {.name = "cloud",
       .command = {"cloud"},
       .inputs = {"points", "rig", "from-mesh", "from-cloud"},
       .outputs = {"output"},
       .result = "cloud.ply",
       .feeds = {{"points", {{"decode", "output", "000000.tiff"}}, {}}},
       .ordered = true,
       .main_figure = [](const Json& f) { return fmt::format("{} points", f.at("known").dump()); }},
      {.name = "fuse",
       .command = {"fuse"},
       .inputs = {"scan", "pose", "rig", "mask"},
       .outputs = {"output", "picture"},
       .result = "fused.ply",
       .feeds = {{"scan", {{"decode", "output"}}, {}}},
       .main_figure =
           [](const Json& f) {
             return fmt::format("{} triangles of {}", f.at("triangles").dump(),
                                counted(f.at("scans").get<std::size_t>(), "scan"));
           }},
      {.name = "plan",
       .command = {"probe", "plan"},
       .inputs = {"surface", "specimen", "scene"},
       .outputs = {"output", "picture"},
       .result = "plan.json",
       .feeds = {{"surface", {{"fuse", "output"}, {"mesh", "output"}}, {"specimen"}}},
       .main_figure =
           [](const Json& f) { return fmt::format("{} contacts", f.at("contacts").dump()); }},
      {.name = "probe",
       .command = {"probe", "run"},
       .inputs = {"plan", "specimen", "surface", "arm-config", "replay", "rig", "pattern", "colors",
                  "sensor"},
       .outputs = {"output", "record"},
       .result = "acquisition.db",
       .feeds = {{"plan", {{"plan", "output"}}, {}}},
       .beside = {{"range", "camera"}, {"truth", "truth"}},
       .measures = true,
       .main_figure =
           [](const Json& f) { return fmt::format("{} trials", f.at("trials").dump()); }},
      {.name = "import",
       .command = {"probe", "import"},
       .inputs = {"data", "mapping"},
       .outputs = {"output", "surface-out"},
       .result = "acquisition.db",
       .main_figure =
           [](const Json& f) {
             return fmt::format("{} contacts, {} samples", f.at("contacts").dump(),
                                f.at("samples").dump());
           }},
      {.name = "track",
       .command = {"track"},
       .inputs = {"range_folder", "reference", "color-images", "rig", "mask", "acquisition"},
       .outputs = {"output"},
       .result = "tracked",
       .feeds = {{"range_folder", {{"probe", "range"}, {"decode", "output"}}, {}},
                 {"reference", {{"fuse", "output"}, {"mesh", "output"}}, {}}},
       .main_figure =
           [](const Json& f) {
             return fmt::format("{} of {} frames, RMS {:.3f} mm", f.at("meshes").dump(),
                                f.at("range_maps").dump(), f.at("median_rms").get<double>());
           }},
      {.name = "motion",
       .command = {"motion"},
       .inputs = {"meshes", "reference"},
       .outputs = {"output"},
       .result = "motion",
       .feeds = {{"meshes", {{"track", "output"}}, {}}},
       .main_figure =
           [](const Json& f) { return fmt::format("{} meshes", f.at("meshes").dump()); }},
      {.name = "fit",
       .command = {"fit"},
       .inputs = {"acquisition", "surface", "shapes"},
       .outputs = {"output", "pictures"},
       .result = "model",
       .feeds = {{"acquisition", {{"probe", "output"}, {"import", "output"}}, {}},
                 {"surface",
                  {{"fuse", "output"}, {"mesh", "output"}, {"import", "surface-out"}},
                  {}}},
       .main_figure =
           [](const Json& f) {
             return fmt::format("{} contacts, RMS {}", f.at("contacts").dump(),
                                newtons(f.at("rms").at("median").get<double>()));
           }},
      {.name = "reduce",
       .command = {"reduce"},
       .inputs = {"model", "scene"},
       .outputs = {"output"},
       .result = "reduced",
       .feeds = {{"model", {{"fit", "output"}}, {}}},
       .main_figure =
           [](const Json& f) {
             return fmt::format("{:.0f} kB instead of {:.0f} kB", f.at("bytes").get<double>() / 1e3,
                                f.at("bytes_before").get<double>() / 1e3);
           }},
      {.name = "evaluate",
       .command = {"evaluate"},
       .inputs = {"model", "queries", "leave-one-out"},
       .outputs = {"picture"},
       .result_entry = "",
       .feeds = {{"model", {{"fit", "output"}}, {}},
                 {"leave-one-out", {{"fit", "acquisition"}}, {"queries"}}},
       .main_figure = figure_of_evaluation},
      {.name = "play",
       .command = {"play"},
       .inputs = {"model", "trajectory", "replay", "pose", "exchange"},
       .outputs = {"record", "picture", "session"},
       .result_entry = "record",
       .result = "trace.csv",
       .feeds = {{"model", {{"reduce", "output"}, {"fit", "output"}}, {}}},
       .main_figure = figure_of_play},
      {.name = "export",
       .command = {"export"},
       .inputs = {"input", "rig"},
       .outputs = {"output"},
       .formats = {"ply", "obj", "vtk", "glb", "png", "npy", "json", "cbor", "html"},
       .feeds = {{"input",
                  {{"reduce", "output"},
                   {"fit", "output"},
                   {"motion", "output"},
                   {"track", "output"},
                   {"fuse", "output"},
                   {"mesh", "output"},
                   {"decode", "output"}},
                  {}}},
       .main_figure = [](const Json& f) { return f.at("file").get<std::string>(); }},
  };
  return steps;
}

/// Entries that no section has: `palpate run` resumes by itself and does all items, and help is on
/// the command line.
bool is_given_by_run(const std::string& entry) {
  return entry == "resume" || entry == "shard" || entry == "help";
}

std::string small(std::string text) { return CLI::detail::to_lower(std::move(text)); }

/// All options and arguments of a command, with those of its groups.
std::vector<const CLI::Option*> options_of(const CLI::App& command) {
  const auto all = [](const auto*) { return true; };
  std::vector<const CLI::Option*> options = command.get_options(all);
  for (const CLI::App* group : command.get_subcommands(all)) {
    if (!group->get_name().empty()) continue;  // not a group of options
    const std::vector<const CLI::Option*> inner = options_of(*group);
    options.insert(options.end(), inner.begin(), inner.end());
  }
  return options;
}

}  // namespace

std::span<const ProjectStep> project_steps() { return table(); }

CLI::App* command_of(const std::vector<std::string>& words, CLI::App& program) {
  CLI::App* command = &program;
  for (const std::string& word : words) command = command->get_subcommand(word);
  return command;
}

std::vector<std::string> entry_names(const CLI::App& command) {
  std::vector<std::string> names;
  for (const CLI::Option* option : options_of(command)) {
    const std::string name = small(option->get_single_name());
    if (!is_given_by_run(name)) names.push_back(name);
  }
  return names;
}

const CLI::Option* option_of(const CLI::App& command, const std::string& entry) {
  if (is_given_by_run(entry)) return nullptr;
  for (const CLI::Option* option : options_of(command))
    if (small(option->get_single_name()) == entry) return option;
  return nullptr;
}

}  // namespace palpate::apps
