// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <functional>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <utility>
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
#include "whole/run_calls.h"
#include "whole/trade_plot.h"

namespace palpate::apps {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;
using Words = std::vector<std::string>;

struct TradeCall {
  fs::path data, surface, queries, trajectory, output;
  std::optional<int> strokes;
};

/// What one setting gives and costs.
struct TradePoint {
  std::string settings;  ///< the command without its files
  double error = 0;
  double bytes = 0;
  double seconds = 0;               ///< of the command
  std::optional<double> step = {};  ///< [us] of the haptic loop
  bool best_by_size = false, best_by_time = false;
};

/// The points of a sweep, and what their errors are.
struct Trade {
  std::string error, unit;
  std::vector<TradePoint> points;
  std::vector<std::string> failures;
};

std::string row(const Trade& trade, const TradePoint& point) {
  return fmt::format("{:10.3g} {} {:9.4g} kB {:8.2g} s  {}", point.error, trade.unit,
                     point.bytes / 1e3, point.seconds, point.settings);
}

// Settings of `fit`.
const std::vector<Words> kFits{{},
                               {"--max-bases", "1"},
                               {"--max-bases", "2"},
                               {"--max-bases", "3"},
                               {"--max-bases", "4"},
                               {"--max-bases", "6"},
                               {"--max-bases", "8"},
                               {"--passive", "certified"},
                               {"--passive", "local"},
                               {"--blend", "forces"},
                               {"--blend", "compliances"}};
// Errors of reduced models, relative to the one that the full model states, or without it to the
// force.
constexpr std::array<double, 5> kErrors{1.15, 1.5, 2, 3, 5}, kShares{0.02, 0.05, 0.1, 0.2, 0.4};
// Tolerances of meshes, relative to their size.
constexpr std::array<double, 8> kTolerances{1e-4, 2e-4, 5e-4, 1e-3, 2e-3, 5e-3, 1e-2, 2e-2};

double size_of(const fs::path& path) {
  if (!fs::is_directory(path)) return static_cast<double>(fs::file_size(path));
  double size = 0;
  for (const fs::directory_entry& file : fs::recursive_directory_iterator(path))
    if (file.is_regular_file()) size += static_cast<double>(file.file_size());
  return size;
}

// While it exists, commands show neither warnings nor progress.
class Quieted {
 public:
  Quieted() { spdlog::set_level(std::max(level_, spdlog::level::err)); }
  ~Quieted() { spdlog::set_level(level_); }
  Quieted(const Quieted&) = delete;
  Quieted& operator=(const Quieted&) = delete;

 private:
  spdlog::level::level_enum level_ = spdlog::get_level();
};

/// Does the calls of a sweep, in a folder for their results.
class Sweep {
 public:
  Sweep(const Settings& settings, const TradeCall& call, fs::path folder)
      : call_(call), folder_(std::move(folder)), tells_(!settings.json && !settings.quiet) {}

  [[nodiscard]] fs::path result(const std::string& name) const { return folder_ / name; }

  // Does a command, and adds its point.
  // \return its figures; nothing if it failed, which becomes a failure of the trade.
  std::optional<Json> add(Trade& trade, const Words& command, const Words& settings,
                          const fs::path& result,
                          const std::function<double(const Json& figures)>& error) {
    const std::string name = fmt::format("{}{}{}", command.front(), settings.empty() ? "" : " ",
                                         fmt::join(settings, " "));
    Words words = command;
    words.insert(words.end(), settings.begin(), settings.end());
    words.insert(words.end(), {"-o", result.string()});
    spdlog::info("palpate {}", fmt::join(words, " "));
    try {
      // The data are the same each time: what is wrong with them is said once.
      std::optional<Quieted> quieted;
      if (!settings.empty()) quieted.emplace();
      const auto start = std::chrono::steady_clock::now();
      const Json figures = run_call(words);
      const std::chrono::duration<double> taken = std::chrono::steady_clock::now() - start;
      const TradePoint point{name, error(figures), size_of(result), taken.count(), step(result)};
      const bool is_new = std::ranges::none_of(trade.points, [&](const TradePoint& other) {
        return other.error == point.error && other.bytes == point.bytes;
      });
      if (!is_new) return figures;
      trade.points.push_back(point);
      if (tells_) std::cout << row(trade, trade.points.back()) << std::endl;
      return figures;
    } catch (const Error& failed) {
      trade.failures.push_back(name + ": " + failed.what());
      return std::nullopt;
    }
  }

  // [N] of a model against known forces.
  [[nodiscard]] double against_queries(const fs::path& model) const {
    return run_call({"evaluate", model.string(), "--queries", call_.queries.string()})
        .at("queries")
        .at("rms")
        .get<double>();
  }

 private:
  [[nodiscard]] std::optional<double> step(const fs::path& model) const {
    if (call_.trajectory.empty()) return std::nullopt;
    return run_call({"play", model.string(), "--trajectory", call_.trajectory.string()})
        .at("us_per_step")
        .at("median")
        .get<double>();
  }

  const TradeCall& call_;
  fs::path folder_;
  bool tells_;
};

// Reduced models of a model, whose own error is given [N].
void add_reductions(Sweep& sweep, Trade& trade, const TradeCall& call, const fs::path& model,
                    double own) {
  const fs::path result = sweep.result("reduced");
  const auto error = [&](const Json& figures) {
    return call.queries.empty() ? std::hypot(own, figures.at("difference").at("rms").get<double>())
                                : sweep.against_queries(result);
  };
  const auto add = [&](const std::string& option, double value) {
    Words settings{option, fmt::format("{:.3g}", value)};
    if (call.strokes) settings.insert(settings.end(), {"--strokes", std::to_string(*call.strokes)});
    return sweep.add(trade, {"reduce", model.string()}, settings, result, error);
  };
  std::optional<double> stated;
  if (const auto first = add("--max-relative-error", kShares.back());
      first && !first->at("stated_before").is_null())
    stated = first->at("stated_before").get<double>();
  for (std::size_t i = 0; i < kErrors.size(); ++i) {
    if (stated)
      add("--max-error", kErrors[i] * *stated);
    else if (i + 1 < kShares.size())
      add("--max-relative-error", kShares[i]);
  }
}

Trade trade_of_acquisition(Sweep& sweep, const TradeCall& call) {
  Trade trade{.error = call.queries.empty()
                           ? "RMS error at contacts that are left out; for reduced models, "
                             "root of the squares of that of the full model and of the difference"
                           : "RMS error against known forces",
              .unit = "N",
              .points = {},
              .failures = {}};
  Words fit{"fit", call.data.string()};
  if (!call.surface.empty()) fit.push_back(call.surface.string());
  for (const Words& settings : kFits) {
    const fs::path model = sweep.result(settings.empty() ? "model" : "other");
    sweep.add(trade, fit, settings, model, [&](const Json&) {
      if (!call.queries.empty()) return sweep.against_queries(model);
      return run_call({"evaluate", model.string(), "--leave-one-out", call.data.string()})
          .at("leave_one_out")
          .at("rms")
          .get<double>();
    });
    if (trade.points.empty()) throw InvalidInput(trade.failures.front());
  }
  add_reductions(sweep, trade, call, sweep.result("model"), trade.points.front().error);
  return trade;
}

Trade trade_of_model(Sweep& sweep, const TradeCall& call) {
  Trade trade{.error = call.queries.empty() ? "RMS difference from the full model"
                                            : "RMS error against known forces",
              .unit = "N",
              .points = {},
              .failures = {}};
  add_reductions(sweep, trade, call, call.data, 0);
  return trade;
}

Trade trade_of_mesh(Sweep& sweep, const TradeCall& call) {
  Trade trade{.error = "Upper bound of the distance between the surfaces",
              .unit = "mm",
              .points = {},
              .failures = {}};
  const double size = geometry::bounding_diagonal(geometry::read_mesh(call.data, {}));
  for (const double tolerance : kTolerances) {
    sweep.add(
        trade, {"mesh", call.data.string()},
        {"--tolerance", fmt::format("{:.3g}", tolerance * size)}, sweep.result("mesh.ply"),
        [](const Json& figures) { return figures.at("decimation").at("distance").get<double>(); });
  }
  return trade;
}

std::vector<TradeDot> dots_of(const Trade& trade, double TradePoint::*cost) {
  std::vector<TradeDot> dots;
  for (const TradePoint& point : trade.points)
    dots.push_back({point.settings, point.*cost, point.error});
  return dots;
}

std::vector<TradeDot> in_kilobytes(std::vector<TradeDot> dots) {
  for (TradeDot& dot : dots) dot.cost /= 1e3;
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
  ReportPage page("Accuracy, size and time: " + call.data.filename().string());
  page.add_paragraph(trade.error +
                     ". Red points are the best ones: no other has an error that is more than 1 % "
                     "smaller at the same or a smaller cost.");
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

std::string in_words(const Trade& trade, const TradeCall& call) {
  std::string words = fmt::format("{}. The best by size:\n", trade.error);
  for (const std::size_t i : pareto_front(dots_of(trade, &TradePoint::bytes)))
    words += row(trade, trade.points[i]) + "\n";
  return words + "Written to " + call.output.string() + ": see trade.html";
}

void trade(const Settings& settings, const TradeCall& call) {
  const std::vector<fs::path> entries{"trade.csv", "trade.html", "error-size.svg",
                                      "error-time.svg"};
  check_output_folder({call.data, call.surface, call.queries, call.trajectory}, call.output);
  check_replaceable(call.output, entries);
  const bool is_model = is_folder(call.data), is_acquisition = call.data.extension() == ".db";
  if (!is_acquisition && !call.surface.empty())
    throw InvalidInput("--surface: is only for an acquisition");
  if (!is_acquisition && !is_model && !(call.queries.empty() && call.trajectory.empty()))
    throw InvalidInput("--queries, --trajectory: are only for an acquisition or a model");
  // Wrong files are found before anything is done.
  if (!call.queries.empty()) static_cast<void>(haptics::read_queries(call.queries));
  if (!call.trajectory.empty()) static_cast<void>(haptics::read_trajectory_file(call.trajectory));
  if (is_model) static_cast<void>(haptics::read_model(call.data));
  if (!call.surface.empty()) static_cast<void>(geometry::read_mesh(call.surface, {}));
  Trade found;
  write_folder(call.output, entries, [&](const fs::path& folder) {
    const fs::path work = folder / "work";
    fs::create_directory(work);
    Sweep sweep(settings, call, work);
    found = is_model         ? trade_of_model(sweep, call)
            : is_acquisition ? trade_of_acquisition(sweep, call)
                             : trade_of_mesh(sweep, call);
    fs::remove_all(work);
    mark_best(found);
    if (found.points.empty()) throw InvalidInput(found.failures.front());
    const auto write = [&](const char* name, const std::string& text) {
      write_file(folder / name, [&](std::ostream& out) { out << text; });
    };
    const std::string error = fmt::format("error [{}]", found.unit);
    write("trade.csv", csv_of(found));
    write("trade.html", page_of(found, call));
    write("error-size.svg",
          trade_svg(in_kilobytes(dots_of(found, &TradePoint::bytes)), "size [kB]", error));
    write("error-time.svg", trade_svg(dots_of(found, &TradePoint::seconds), "time [s]", error));
  });
  for (const std::string& failure : found.failures) spdlog::warn("{}", failure);
  print(settings, figures_of(found, call), in_words(found, call));
}

}  // namespace

void add_trade(CLI::App& app, const Settings& settings) {
  auto call = std::make_shared<TradeCall>();
  CLI::App* command = app.add_subcommand(
      "trade", "Measure what accuracy costs on your own data, with many settings");
  command
      ->add_option("DATA", call->data,
                   "Measurements (acquisition.db), a model folder, or a mesh: settings of 'palpate "
                   "fit', 'reduce' or 'mesh' are tried on it")
      ->required();
  command
      ->add_option("-o,--output", call->output, "Folder to write: trade.html with plots, trade.csv")
      ->required();
  command->add_option("--surface", call->surface,
                      "Undeformed surface of the measurements (mesh); see 'palpate fit'");
  command->add_option(
      "--queries", call->queries,
      "Known forces (CSV) with which errors are measured (default: contacts that are "
      "left out; of a model, the full model)");
  command->add_option(
      "--trajectory", call->trajectory,
      "Path of a tool (CSV): the time of a step of the haptic loop is measured, too");
  command
      ->add_option("--strokes", call->strokes,
                   "Number of random presses that measure reduced models; see 'palpate reduce'")
      ->check(within(at_least(100).at_most(1'000'000)))
      ->group(kExpertOptions);
  command->footer(
      "Each line ends with the options that give it.\n"
      "Examples:\n  palpate trade acquisition.db --surface surface.ply -o trade/\n"
      "  palpate trade model/ --queries queries.csv -o trade/\n"
      "  palpate trade surface.ply -o trade/");
  command->callback([call, &settings] { trade(settings, *call); });
}

}  // namespace palpate::apps
