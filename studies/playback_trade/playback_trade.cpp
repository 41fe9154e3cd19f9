// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
// Accuracy of the ends of slips, effects of limits of energy and of other rules of motion, tools
// that fall through a surface, and errors of forces for several tools and for tools of another
// size: prints the tables of docs/trade-playback.md. playback_bench has the times.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <exception>
#include <iostream>
#include <string>
#include <vector>

#include "tables.h"

int main(int count, char** arguments) try {
  CLI::App app("Measures what playback's options trade; prints Markdown");
  const std::vector<std::string> names = {"residual", "missed",     "tolerance",
                                          "rules",    "energy",     "falls",
                                          "creases",  "near-tools", "tool-radius"};
  std::vector<std::string> wanted = names;
  app.add_option("TABLES", wanted, "Only these")->check(CLI::IsMember(names));
  int jumps = 400;
  app.add_option("--jumps", jumps, "For each figure of residual, missed and energy")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  double seconds = 100;
  app.add_option("--seconds", seconds, "[s] of each path of falls")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  CLI11_PARSE(app, count, arguments);
  const auto has = [&](const char* name) {
    return std::find(wanted.begin(), wanted.end(), name) != wanted.end();
  };
  constexpr int kTicks = 4000, kLoops = 150;
  if (has("residual")) palpate::bench::print_residuals(jumps);
  if (has("missed")) palpate::bench::print_missed_slips(jumps);
  if (has("tolerance")) palpate::bench::print_tolerances();
  if (has("rules")) palpate::bench::print_rules(kTicks);
  if (has("energy")) palpate::bench::print_energy(kLoops, jumps);
  if (has("falls")) palpate::bench::print_falls(seconds);
  if (has("creases")) palpate::bench::print_creases(kLoops, jumps, seconds);
  if (has("near-tools")) palpate::bench::print_near_tools();
  if (has("tool-radius")) palpate::bench::print_tool_radii();
  return 0;
} catch (const std::exception& error) {
  std::cerr << error.what() << '\n';
  return 1;
}
