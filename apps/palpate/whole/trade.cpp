// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <cmath>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "palpate/core/error.h"
#include "palpate/core/output_file.h"
#include "palpate/geometry/mesh_io.h"
#include "palpate/haptics/evaluate.h"
#include "palpate/haptics/model_io.h"
#include "palpate/haptics/trajectory_file.h"
#include "probing/report_page.h"
#include "shared/call_checks.h"
#include "shared/command_line.h"
#include "shared/field_options.h"
#include "shared/inputs.h"
#include "shared/output_checks.h"
#include "whole/trade_plot.h"
#include "whole/trade_sweep.h"

namespace palpate::apps {
namespace {

struct TradeCall {
  TradeData data;
  fs::path output;
};

std::string row(const Trade& trade, const TradePoint& point) {
  return fmt::format("{:10.3g} {} {:9.4g} kB {:8.2g} s  {}", point.error, trade.unit,
                     point.bytes / 1e3, point.seconds, point.settings);
}

std::vector<TradeDot> dots_of(const Trade& trade, double TradePoint::*cost, double unit = 1) {
  std::vector<TradeDot> dots;
  for (const TradePoint& point : trade.points)
    dots.push_back({point.settings, point.*cost / unit, point.error});
  return dots;
}

void mark_best(Trade& trade) {
  for (const std::size_t i : pareto_front(dots_of(trade, &TradePoint::bytes)))
    trade.points[i].best_by_size = true;
  for (const std::size_t i : pareto_front(dots_of(trade, &TradePoint::seconds)))
    trade.points[i].best_by_time = true;
}

std::string step_in_words(const TradePoint& point) {
  return point.step ? fmt::format("{:.3g}", *point.step) : "";
}

std::string csv_of(const Trade& trade) {
  std::string csv = fmt::format(
      "settings,error_{},bytes,seconds,us_per_step,best_by_size,best_by_time\n", trade.unit);
  for (const TradePoint& point : trade.points) {
    csv += fmt::format("{},{:.6g},{:.0f},{:.3g},{},{},{}\n", point.settings, point.error,
                       point.bytes, point.seconds, step_in_words(point), point.best_by_size ? 1 : 0,
                       point.best_by_time ? 1 : 0);
  }
  return csv;
}

std::string page_of(const Trade& trade, const TradeCall& call) {
  ReportPage page("Accuracy, size and time: " + call.data.file.filename().string());
  page.add_paragraph(
      trade.error +
      ". A point is red if its error is more than 1 % smaller than that of every red "
      "point of a smaller cost.");
  page.add_picture("error-size.svg", "Error and size. Numbers as in the table.");
  page.add_picture("error-time.svg", "Error and time of the command.");
  std::vector<std::vector<std::string>> rows;
  for (std::size_t i = 0; i < trade.points.size(); ++i) {
    const TradePoint& point = trade.points[i];
    const char* best = point.best_by_size && point.best_by_time ? "size, time"
                       : point.best_by_size                     ? "size"
                       : point.best_by_time                     ? "time"
                                                                : "";
    rows.push_back({fmt::format("{} {}", i + 1, point.settings), fmt::format("{:.3g}", point.error),
                    fmt::format("{:.4g}", point.bytes / 1e3), fmt::format("{:.3g}", point.seconds),
                    step_in_words(point), best});
  }
  page.add_table({"settings", fmt::format("error [{}]", trade.unit), "size [kB]", "time [s]",
                  "step [us]", "best by"},
                 rows);
  for (const std::string& failure : trade.failures) page.add_paragraph("Failed: " + failure);
  return page.html();
}

Json figures_of(const Trade& trade, const TradeCall& call) {
  Json points = Json::array();
  for (const TradePoint& point : trade.points) {
    points.push_back({{"settings", point.settings},
                      {"error", point.error},
                      {"bytes", std::llround(point.bytes)},
                      {"seconds", point.seconds},
                      {"us_per_step", number_or_null(point.step)},
                      {"best_by_size", point.best_by_size},
                      {"best_by_time", point.best_by_time}});
  }
  return {{"error_is", trade.error},
          {"unit", trade.unit},
          {"points", points},
          {"failures", trade.failures},
          {"output", call.output.string()}};
}

std::string trade_in_words(const Trade& trade, const TradeCall& call) {
  std::string words = fmt::format("{}. The best by size:\n", trade.error);
  for (const std::size_t i : pareto_front(dots_of(trade, &TradePoint::bytes)))
    words += row(trade, trade.points[i]) + "\n";
  return words + "Written to " + call.output.string() + ": see trade.html";
}

void trade(const Settings& settings, TradeCall call) {
  const std::vector<fs::path> entries{"trade.csv", "trade.html", "error-size.svg",
                                      "error-time.svg"};
  check_output_folder({call.data.file, call.data.surface, call.data.queries, call.data.trajectory},
                      call.output);
  check_replaceable(call.output, entries);
  using enum TradeData::Kind;
  TradeData& data = call.data;
  if (is_folder(data.file))
    data.kind = model;
  else if (data.file.extension() == ".db")
    data.kind = acquisition;
  if (data.kind != acquisition && !data.surface.empty())
    throw InvalidInput("--surface: is allowed only for an acquisition");
  if (data.kind == mesh && !(data.queries.empty() && data.trajectory.empty()))
    throw InvalidInput("--queries, --trajectory: are allowed only for an acquisition or a model");
  // Detects wrong files before any work is done.
  if (!data.queries.empty()) static_cast<void>(haptics::read_queries(data.queries));
  if (!data.trajectory.empty()) static_cast<void>(haptics::read_trajectory_file(data.trajectory));
  if (data.kind == model) static_cast<void>(haptics::read_model(data.file));
  if (!data.surface.empty()) static_cast<void>(geometry::read_mesh(data.surface, {}));
  Trade found;
  write_folder(call.output, entries, [&](const fs::path& folder) {
    const fs::path work = folder / "work";
    fs::create_directory(work);
    found = try_settings(data, work, [&](const Trade& trade) {
      if (!settings.json && !settings.quiet)
        std::cout << row(trade, trade.points.back()) << std::endl;
    });
    fs::remove_all(work);
    mark_best(found);
    const auto write = [&](const char* name, const std::string& text) {
      write_file(folder / name, [&](std::ostream& out) { out << text; });
    };
    const std::string error = fmt::format("error [{}]", found.unit);
    write("trade.csv", csv_of(found));
    write("trade.html", page_of(found, call));
    write("error-size.svg", trade_svg(dots_of(found, &TradePoint::bytes, 1e3), "size [kB]", error));
    write("error-time.svg", trade_svg(dots_of(found, &TradePoint::seconds), "time [s]", error));
  });
  for (const std::string& failure : found.failures) spdlog::warn("{}", failure);
  print(settings, figures_of(found, call), trade_in_words(found, call));
}

}  // namespace

void add_trade(CLI::App& app, const Settings& settings) {
  auto call = std::make_shared<TradeCall>();
  CLI::App* command = app.add_subcommand(
      "trade", "Measure what accuracy costs on your own data, with many settings");
  add_required(*command, "DATA", call->data.file,
               "Measurements (acquisition.db), a model folder, or a mesh: settings of 'palpate "
               "fit', 'reduce' or 'mesh' are tried on it");
  add_required(*command, "-o,--output", call->output,
               "Folder to write: trade.html with plots, trade.csv");
  command->add_option("--surface", call->data.surface,
                      "Undeformed surface of the measurements (mesh); see 'palpate fit'");
  command->add_option(
      "--queries", call->data.queries,
      "Known forces (CSV) with which errors are measured (default: contacts that are "
      "left out; of a model, the full model)");
  command->add_option(
      "--trajectory", call->data.trajectory,
      "Path of a tool (CSV): the time of a step of the haptic loop is also measured");
  add_number(*command, "--strokes", call->data.strokes, at_least(100).at_most(1'000'000),
             "Number of random presses that measure reduced models; see 'palpate reduce'")
      ->group(kExpertOptions);
  command->footer(
      "Each line of the output ends with the settings that were used.\n"
      "Examples:\n  palpate trade acquisition.db --surface surface.ply -o trade/\n"
      "  palpate trade model/ --queries queries.csv -o trade/\n"
      "  palpate trade surface.ply -o trade/");
  command->callback([call, &settings] { trade(settings, *call); });
}

}  // namespace palpate::apps
