// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
// Costs of the strategies of probing, and the quality of their models: prints the tables of
// docs/trade-probing.md.
#include <tbb/global_control.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <exception>
#include <iostream>
#include <string>
#include <vector>

#include "comparison.h"
#include "objects.h"
#include "palpate/core/error.h"
#include "tables.h"

namespace palpate::bench {
namespace {

struct Call {
  bool tuning = false;
  unsigned seeds = 5;
  std::vector<std::string> names;
  ComparisonOptions comparison;
};

void run(const Call& call) {
  std::vector<TradeObject> objects =
      call.tuning ? tuning_objects(call.seeds) : unseen_objects(call.seeds);
  const auto left_aside = [&](const TradeObject& object) {
    return !call.names.empty() &&
           std::find(call.names.begin(), call.names.end(), object.name) == call.names.end();
  };
  objects.erase(std::remove_if(objects.begin(), objects.end(), left_aside), objects.end());
  if (objects.empty()) throw InvalidInput("probing_trade: there is no such object");
  std::vector<ComparedObject> compared;
  print_header();
  for (const TradeObject& object : objects) {
    compared.push_back({object.name, compare(prepare(object), call.comparison)});
    print_rows(compared.back());
  }
  print_targets(compared);
}

}  // namespace
}  // namespace palpate::bench

int main(int count, char** arguments) try {
  constexpr std::size_t kThreads = 2;
  const tbb::global_control threads(tbb::global_control::max_allowed_parallelism, kThreads);
  CLI::App app("Measures what strategies of probing cost and how good their models are");
  palpate::bench::Call call;
  app.add_flag("--tuning", call.tuning,
               "The objects that the constants of adaptive were chosen with, not the others");
  app.add_option("--seeds", call.seeds, "Number of seeds; objects of finite elements have one")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  app.add_option("--specimen", call.names, "Only these objects");
  app.add_option("--strategy", call.comparison.strategies, "Only these strategies")
      ->check(CLI::IsMember(palpate::bench::strategy_names()));
  app.add_flag("--left-out", call.comparison.left_out, "Also predict each contact from the others");
  CLI11_PARSE(app, count, arguments);
  palpate::bench::run(call);
  return 0;
} catch (const std::exception& error) {
  std::cerr << error.what() << '\n';
  return 1;
}
