// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <memory>
#include <nlohmann/json.hpp>
#include <vector>

#include "export/export_page.h"
#include "palpate/core/error.h"
#include "shared/command_line.h"
#include "shared/program.h"
#include "whole/demo.h"

namespace palpate::apps {
namespace {

/// Folder of the bundled data: beside the installed program, or in the source tree.
fs::path find_data(const fs::path& given) {
  if (!given.empty()) return given;
  return bundled(PALPATE_INSTALLED_DEMO, PALPATE_SOURCE_DEMO);
}

std::string seeing_table(const Json& frames) {
  std::string table =
      "SEEING: a projector shows stripes, and each camera frame becomes a range map and then a "
      "mesh.\n"
      "  frame          distance   median error         coverage   wrong    triangles   time\n";
  for (const Json& f : frames) {
    table += fmt::format(
        "  {:<13}{:>7.0f} mm   {:.3f} mm = {:.4f} %   {:>6.1f} %   {:.2f} %   {:>9}   {:.0f} ms\n",
        f["frame"].get<std::string>(), f["distance"].get<double>(), f["median"].get<double>(),
        100 * f["relative_median"].get<double>(), 100 * f["coverage"].get<double>(),
        100 * f["wrong_share"].get<double>(), f["triangles"].get<long>(), f["ms"].get<double>());
  }
  return table +
         "  (coverage: share of the lit pixels that have a depth; wrong: share of the measured "
         "pixels that are more than\n"
         "  1 % of the distance off, or where nothing is; error: of the others, relative to the "
         "true depth)\n";
}

std::string feeling_table(const Json& sheets) {
  std::string table =
      "FEELING: an arm presses and drags at contacts on a stretched sheet; force fields and "
      "friction are fitted and played back.\n"
      "  object        contacts   samples   fit       RMS of fit   RMS against truth   leave one "
      "out   friction error   step / slip\n";
  for (const Json& s : sheets) {
    table += fmt::format(
        "  {:<12}{:>10}{:>10}{:>6.1f} s{:>11.3f} N{:>18.3f} N{:>14.3f} N{:>17.3f}{:>8.1f} / {:.1f} "
        "us\n",
        s["name"].get<std::string>(), s["contacts"].get<long>(), s["samples"].get<long>(),
        s["fit_seconds"].get<double>(), s["fit_rms"].get<double>(), s["queries_rms"].get<double>(),
        s["leave_one_out_rms"].get<double>(), s["friction_error"].get<double>(),
        s["us_per_step"].get<double>(), s["us_per_slip"].get<double>());
  }
  return table +
         "  (sheet_block: a block lies under the sheet. RMS of fit: median over the contacts, "
         "forces up to 3.3 N; against\n"
         "  truth: noise-free forces between the contacts; leave one out: each contact predicted "
         "from its neighbours;\n"
         "  friction error: median of |coefficient - truth|; step: median time of one step of the "
         "1 kHz loop)\n";
}

std::string probing_table(const Json& p) {
  return fmt::format(
      "PROBING: a simulated arm measures a simulated sheet by itself; it is stopped half way, and "
      "goes on.\n"
      "  object        contacts   trials   slipped   arm      RMS against truth   leave one out   "
      "friction error\n"
      "  {:<12}{:>10}{:>9}{:>10}{:>6.1f} h{:>18.3f} N{:>14.3f} N{:>17.3f}\n"
      "  (stopped after {} trials; the page probing/report/index.html shows the campaign)\n",
      p["name"].get<std::string>(), p["contacts"].get<int>(), p["trials"].get<int>(),
      p["slipped"].get<int>(), p["hours"].get<double>(), p["queries_rms"].get<double>(),
      p["leave_one_out_rms"].get<double>(), p["friction_error"].get<double>(),
      p["trials_before"].get<int>());
}

/// A result to look at, and what it shows.
struct Shown {
  std::string file;
  const char* text;
};

std::vector<Shown> what_to_open(const fs::path& output) {
  return {{(output / "sheet/model.html").string(), "press on the sheet, in any browser"},
          {(output / "pictures/overview.png").string(),
           "a camera frame, its mesh, and a model with its forces"},
          {(output / "probing/report/index.html").string(),
           "what the arm did, and how good the model is"}};
}

std::string opening_text(const std::vector<Shown>& shown, const fs::path& output) {
  std::size_t width = 0;
  for (const Shown& one : shown) width = std::max(width, one.file.size());
  std::string text = "NOW OPEN:\n";
  for (const Shown& one : shown) text += fmt::format("  {:<{}}   {}\n", one.file, width, one.text);
  return text + fmt::format("All results are in {}.\n", output.string());
}

void demo(const Settings& settings, const fs::path& given_data, const fs::path& output) {
  const fs::path data = find_data(given_data);
  const auto start = std::chrono::steady_clock::now();
  const Json seeing = demo_seeing(data, output);
  const Json feeling = demo_feeling(data, output);
  const Json probing = demo_probing(data, output);
  demo_overview(data, output);
  const std::vector<Shown> shown = what_to_open(output);
  PageCall page;
  page.input = output / "sheet/model";
  page.title = "sheet";
  export_page(page, PageContent::model, shown.front().file);
  const std::chrono::duration<double> elapsed = std::chrono::steady_clock::now() - start;
  const bool same = std::all_of(feeling.begin(), feeling.end(),
                                [](const Json& s) { return s["same_and_finite"].get<bool>(); });
  Json files = Json::array();
  for (const Shown& one : shown) files.push_back(one.file);
  print(settings,
        {{"seeing", seeing},
         {"feeling", feeling},
         {"probing", probing},
         {"seconds", elapsed.count()},
         {"output", output.string()},
         {"open", files}},
        seeing_table(seeing) + "\n" + feeling_table(feeling) + "\n" + probing_table(probing) +
            "\n" + opening_text(shown, output) +
            fmt::format("\nThe whole demo took {:.1f} s. Every played force is finite and the same "
                        "in a second run: {}.",
                        elapsed.count(), same ? "yes" : "NO"));
  if (!same)
    throw SolverError("palpate demo: a played force is not finite, or differs in a second run.");
}

}  // namespace

void add_demo(CLI::App& app, const Settings& settings) {
  struct Call {
    fs::path data, output = "demo-output";
  };
  auto call = std::make_shared<Call>();
  CLI::App* command = app.add_subcommand(
      "demo", "Run the whole pipeline on the bundled data, with pictures and a summary");
  command->add_option("-o,--output", call->output, "Folder for all results")->capture_default_str();
  command->add_option("--data", call->data,
                      "Folder of the bundled data (default: where it was installed)");
  command->footer("Example:\n  palpate demo -o demo-output");
  command->callback([call, &settings] { demo(settings, call->data, call->output); });
}

}  // namespace palpate::apps
