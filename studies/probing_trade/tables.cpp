// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "tables.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <functional>
#include <limits>
#include <optional>

namespace palpate::bench {
namespace {

using Figure = std::function<double(const Run&)>;

double mean_of(const std::vector<Run>& runs, const Figure& figure) {
  double sum = 0;
  for (const Run& run : runs) sum += figure(run);
  return sum / static_cast<double>(runs.size());
}

double deviation_of(const std::vector<Run>& runs, const Figure& figure) {
  const double mean = mean_of(runs, figure);
  double sum = 0;
  for (const Run& run : runs) sum += std::pow(figure(run) - mean, 2);
  return std::sqrt(sum / (static_cast<double>(runs.size()) - 1));
}

double error_of(const Run& run) { return run.against_truth.error; }

std::string written(double value, int digits) {
  return std::isfinite(value) ? fmt::format("{:.{}f}", value, digits) : "";
}

// The mean error of one strategy over that of another.
std::optional<double> ratio(const Runs& runs, const std::string& of, const std::string& to) {
  const auto above = runs.find(of), below = runs.find(to);
  if (above == runs.end() || below == runs.end()) return std::nullopt;
  return mean_of(above->second, error_of) / mean_of(below->second, error_of);
}

}  // namespace

void print_header() {
  fmt::print(
      "| object | strategy | seeds | samples | slipped | hours | error [N] | left out: inside, "
      "border [N] | friction: median, p95 | stated [N] | kB of acquisition, model |\n"
      "|---|---|---|---|---|---|---|---|---|---|---|\n");
}

void print_rows(const ComparedObject& object) {
  for (const std::string& strategy : strategy_names()) {
    const auto found = object.runs.find(strategy);
    if (found == object.runs.end()) continue;
    const std::vector<Run>& runs = found->second;
    const auto pair = [&](const Figure& one, const Figure& other) {
      const std::string first = written(mean_of(runs, one), 3);
      return first.empty() ? "" : first + ", " + written(mean_of(runs, other), 3);
    };
    const double deviation =
        runs.size() > 1 ? deviation_of(runs, error_of) : std::numeric_limits<double>::quiet_NaN();
    const double kilobytes = mean_of(runs, [](const Run& run) {
      return static_cast<double>(run.against_truth.acquisition_bytes) / 1000;
    });
    const double model = mean_of(runs, [](const Run& run) {
      return static_cast<double>(run.against_truth.model_bytes) / 1000;
    });
    fmt::print("| {} | {} | {} | {:.0f} | {:.0f} | {:.1f} | {}{} | {} | {} | {} | {} |\n",
               object.name, strategy, runs.size(),
               mean_of(runs, [](const Run& run) { return run.samples; }),
               mean_of(runs, [](const Run& run) { return run.slipped; }),
               mean_of(runs, [](const Run& run) { return run.hours; }),
               written(mean_of(runs, error_of), 4),
               std::isfinite(deviation) ? fmt::format(" +- {:.4f}", deviation) : "",
               pair([](const Run& run) { return run.against_truth.left_out_inside; },
                    [](const Run& run) { return run.against_truth.left_out_border; }),
               pair([](const Run& run) { return run.against_truth.friction_median; },
                    [](const Run& run) { return run.against_truth.friction_p95; }),
               written(mean_of(runs, [](const Run& run) { return run.stated; }), 4),
               kilobytes > 0 ? fmt::format("{:.0f}, {:.0f}", kilobytes, model) : "");
  }
  std::fflush(stdout);
}

void print_targets(const std::vector<ComparedObject>& objects) {
  struct Compared {
    std::string of, to;
    double logarithms = 0;
    int count = 0;
  };
  std::vector<Compared> compared = {
      {"adaptive", "thesis"}, {"adaptive static", "static"}, {"adaptive searching", "searching"},
      {"plain", "static"},    {"thesis", "baked"},           {"adaptive", "baked"}};
  fmt::print("\n| object |");
  for (const Compared& one : compared) fmt::print(" {} / {} |", one.of, one.to);
  fmt::print(" stated / actual of adaptive: least, most |\n|---|");
  for (std::size_t i = 0; i <= compared.size(); ++i) fmt::print("---|");
  fmt::print("\n");
  for (const ComparedObject& object : objects) {
    fmt::print("| {} |", object.name);
    for (Compared& one : compared) {
      const std::optional<double> found = ratio(object.runs, one.of, one.to);
      fmt::print(" {} |", found ? fmt::format("{:.2f}", *found) : "");
      if (!found) continue;
      one.logarithms += std::log(*found);
      ++one.count;
    }
    constexpr double kNone = std::numeric_limits<double>::infinity();
    double least = kNone, most = -kNone;
    for (const auto& [strategy, runs] : object.runs) {
      for (const Run& run : runs) {
        const double stated = run.stated / error_of(run);
        if (!std::isfinite(stated)) continue;
        least = std::min(least, stated);
        most = std::max(most, stated);
      }
    }
    fmt::print(" {} |\n", least <= most ? fmt::format("{:.2f}, {:.2f}", least, most) : "");
  }
  fmt::print("| geometric mean |");
  for (const Compared& one : compared)
    fmt::print(" {} |",
               one.count > 0 ? fmt::format("{:.2f}", std::exp(one.logarithms / one.count)) : "");
  fmt::print(" |\n");
}

}  // namespace palpate::bench
