// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "whole/trade_sweep.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <nlohmann/json.hpp>
#include <utility>

#include "palpate/core/error.h"
#include "palpate/geometry/mesh_io.h"
#include "whole/run_calls.h"

namespace palpate::apps {
namespace {

using Words = std::vector<std::string>;

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
// Errors of reduced models, relative to the one that the full model states, or to the force if it
// states none.
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

/// Runs the commands of a sweep, in a folder for their results.
class Sweep {
 public:
  Sweep(const TradeData& data, fs::path folder, const std::function<void(const Trade&)>& told)
      : data_(data), folder_(std::move(folder)), told_(told) {}

  [[nodiscard]] fs::path result(const std::string& name) const { return folder_ / name; }

  // Runs a command, and adds its point.
  // \return its figures; nullopt if it failed, which becomes a failure of the trade.
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
      // The data are the same each time: their faults are reported once.
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
      told_(trade);
      return figures;
    } catch (const Error& failed) {
      trade.failures.push_back(name + ": " + failed.what());
      return std::nullopt;
    }
  }

  // [N] of a model against known forces.
  [[nodiscard]] double against_queries(const fs::path& model) const {
    return run_call({"evaluate", model.string(), "--queries", data_.queries.string()})
        .at("queries")
        .at("rms")
        .get<double>();
  }

 private:
  [[nodiscard]] std::optional<double> step(const fs::path& model) const {
    if (data_.trajectory.empty()) return std::nullopt;
    return run_call({"play", model.string(), "--trajectory", data_.trajectory.string()})
        .at("us_per_step")
        .at("median")
        .get<double>();
  }

  const TradeData& data_;
  fs::path folder_;
  const std::function<void(const Trade&)>& told_;
};

// Reduced models of a model, whose own error is given [N].
void add_reductions(Sweep& sweep, Trade& trade, const TradeData& data, const fs::path& model,
                    double own) {
  const fs::path result = sweep.result("reduced");
  const auto error = [&](const Json& figures) {
    return data.queries.empty() ? std::hypot(own, figures.at("difference").at("rms").get<double>())
                                : sweep.against_queries(result);
  };
  const auto add = [&](const std::string& option, double value) {
    Words settings{option, fmt::format("{:.3g}", value)};
    if (data.strokes) settings.insert(settings.end(), {"--strokes", std::to_string(*data.strokes)});
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

Trade trade_of_acquisition(Sweep& sweep, const TradeData& data) {
  Trade trade{
      .error = data.queries.empty()
                   ? "RMS error at contacts that are left out; for reduced models, the "
                     "root of the sum of squares of the full model's error and the difference"
                   : "RMS error against known forces",
      .unit = "N",
      .points = {},
      .failures = {}};
  Words fit{"fit", data.file.string()};
  if (!data.surface.empty()) fit.push_back(data.surface.string());
  for (const Words& settings : kFits) {
    const fs::path model = sweep.result(settings.empty() ? "model" : "other");
    sweep.add(trade, fit, settings, model, [&](const Json&) {
      if (!data.queries.empty()) return sweep.against_queries(model);
      return run_call({"evaluate", model.string(), "--leave-one-out", data.file.string()})
          .at("leave_one_out")
          .at("rms")
          .get<double>();
    });
    if (trade.points.empty()) throw InvalidInput(trade.failures.front());
  }
  add_reductions(sweep, trade, data, sweep.result("model"), trade.points.front().error);
  return trade;
}

Trade trade_of_model(Sweep& sweep, const TradeData& data) {
  Trade trade{.error = data.queries.empty() ? "RMS difference from the full model"
                                            : "RMS error against known forces",
              .unit = "N",
              .points = {},
              .failures = {}};
  add_reductions(sweep, trade, data, data.file, 0);
  return trade;
}

Trade trade_of_mesh(Sweep& sweep, const TradeData& data) {
  Trade trade{.error = "Upper bound of the distance between the surfaces",
              .unit = "mm",
              .points = {},
              .failures = {}};
  const double size = geometry::bounding_diagonal(geometry::read_mesh(data.file, {}));
  for (const double tolerance : kTolerances) {
    sweep.add(
        trade, {"mesh", data.file.string()},
        {"--tolerance", fmt::format("{:.3g}", tolerance * size)}, sweep.result("mesh.ply"),
        [](const Json& figures) { return figures.at("decimation").at("distance").get<double>(); });
  }
  return trade;
}

}  // namespace

Trade try_settings(const TradeData& data, const fs::path& work,
                   const std::function<void(const Trade& trade)>& told) {
  Sweep sweep(data, work, told);
  Trade trade = data.kind == TradeData::Kind::model         ? trade_of_model(sweep, data)
                : data.kind == TradeData::Kind::acquisition ? trade_of_acquisition(sweep, data)
                                                            : trade_of_mesh(sweep, data);
  if (trade.points.empty()) throw InvalidInput(trade.failures.front());
  return trade;
}

}  // namespace palpate::apps
