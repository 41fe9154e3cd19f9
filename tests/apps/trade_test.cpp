// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "repository.h"
#include "run_palpate.h"

namespace palpate::apps {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using ::testing::AllOf;
using ::testing::HasSubstr;

json trade_figures(std::vector<std::string> call) {
  call.insert(call.begin(), "trade");
  call.emplace_back("--json");
  const CommandResult result = run_palpate(call);
  EXPECT_EQ(result.status, kDone) << result.err;
  return json::parse(result.out);
}

// The settings of each point reproduce it.
TEST(Trade, OfAMeshFindsTheTrianglesForEachDistance) {
  const ScratchFolder scratch;
  const std::string mesh = repository("meshes/hand.ply");
  const json trade = trade_figures({mesh, "-o", scratch / "trade"});
  EXPECT_EQ(trade["unit"], "mm");
  ASSERT_EQ(trade["points"].size(), 8U);
  double error = 0, bytes = 1e12;
  for (const json& point : trade["points"]) {
    EXPECT_GT(point["error"], error);
    EXPECT_LT(point["bytes"], bytes);
    EXPECT_TRUE(point["best_by_size"]);
    error = point["error"];
    bytes = point["bytes"];
  }
  const std::string settings = trade["points"][4]["settings"];
  const json again = json::parse(
      run_palpate({"mesh", mesh, "--tolerance", settings.substr(settings.rfind(' ') + 1), "-o",
                   scratch / "again.ply", "--json"})
          .out);
  EXPECT_EQ(again["decimation"]["distance"], trade["points"][4]["error"]);
  EXPECT_EQ(fs::file_size(scratch / "again.ply"), trade["points"][4]["bytes"]);
  const std::string csv = read_text(scratch / "trade/trade.csv");
  EXPECT_EQ(std::ranges::count(csv, '\n'), 9);
  EXPECT_THAT(read_text(scratch / "trade/trade.html"),
              AllOf(HasSubstr(settings), HasSubstr("error-size.svg")));
  EXPECT_FALSE(fs::exists(scratch / "trade/work"));
}

// Settings that change nothing are not shown twice; each point is the result of its command.
TEST(Trade, OfMeasurementsComparesFitsAndReducedModels) {
  const ScratchFolder scratch;
  // The first six contacts.
  const auto first = [&](const std::string& name, std::size_t column) {
    std::istringstream all(read_text(demo("sheet/" + name)));
    std::string line, kept;
    std::getline(all, line);
    for (kept = line + "\n"; std::getline(all, line);) {
      std::istringstream cells(line);
      std::string cell;
      for (std::size_t i = 0; i <= column; ++i) std::getline(cells, cell, ',');
      if (std::stoi(cell) < 6) kept += line + "\n";
    }
    write_text(scratch / name, kept);
  };
  first("contacts.csv", 0);
  first("samples.csv", 1);
  ASSERT_EQ(run_palpate({"probe", "import", scratch / "contacts.csv", scratch / "samples.csv", "-o",
                         scratch / "few.db"})
                .status,
            kDone);
  ASSERT_EQ(run_palpate({"mesh", demo("sheet/surface.ply"), "--remesh", "10", "-o",
                         scratch / "surface.ply"})
                .status,
            kDone);
  const json trade =
      trade_figures({scratch / "few.db", "--surface", scratch / "surface.ply", "--trajectory",
                     demo("trajectory.csv"), "--strokes", "500", "-o", scratch / "trade"});
  EXPECT_TRUE(trade["failures"].empty()) << trade["failures"];
  std::set<std::pair<double, double>> points;
  std::size_t reduced = 0;
  for (const json& point : trade["points"]) {
    const auto error = point["error"].get<double>(), bytes = point["bytes"].get<double>();
    EXPECT_TRUE(points.emplace(error, bytes).second) << point;
    EXPECT_GT(point["us_per_step"], 0);
    if (point["settings"].get<std::string>().starts_with("reduce")) ++reduced;
  }
  EXPECT_GT(reduced, 0U);
  EXPECT_EQ(trade["points"][0]["settings"], "fit");
  ASSERT_EQ(
      run_palpate({"fit", scratch / "few.db", scratch / "surface.ply", "-o", scratch / "model"})
          .status,
      kDone);
  const json errors = json::parse(
      run_palpate({"evaluate", scratch / "model", "--leave-one-out", scratch / "few.db", "--json"})
          .out);
  EXPECT_EQ(errors["leave_one_out"]["rms"], trade["points"][0]["error"]);
}

TEST(Trade, RefusesWhatDoesNotBelongTogether) {
  const ScratchFolder scratch;
  const std::string mesh = repository("meshes/hand.ply");
  const auto refused = [&](std::vector<std::string> call) {
    call.insert(call.begin(), "trade");
    call.insert(call.end(), {"-o", scratch / "trade"});
    const CommandResult result = run_palpate(call);
    EXPECT_EQ(result.status, kWrongCall);
    EXPECT_FALSE(fs::exists(scratch / "trade"));
    return result.err;
  };
  EXPECT_THAT(refused({mesh, "--surface", mesh}), HasSubstr("--surface: is allowed only for"));
  EXPECT_THAT(refused({mesh, "--queries", demo("sheet/queries.csv")}),
              HasSubstr("--queries, --trajectory: are allowed only for"));
  EXPECT_THAT(refused({scratch / "nothing.ply"}), HasSubstr("nothing.ply"));
  write_text(scratch / "broken.db", "no database");
  EXPECT_THAT(refused({scratch / "broken.db"}), HasSubstr("broken.db"));
}

}  // namespace
}  // namespace palpate::apps
