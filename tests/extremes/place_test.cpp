// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
// At another place, turned, and in another order, results are the same within what coordinates can
// tell there.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <optional>

#include "findings.h"

namespace palpate::extremes {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;

/// A place, an orientation or an order.
struct Case {
  std::string name;
  Isometry3d motion = Isometry3d::Identity();
  /// Coordinates are moved exactly.
  bool is_exact = false;
  std::optional<unsigned> shuffle = {};
};

Case shifted(std::string name, const Vector3d& by, bool is_exact) {
  return {std::move(name), Isometry3d(Eigen::Translation3d(by)), is_exact};
}

Case turned(std::string name, double angle) {
  return {std::move(name),
          Isometry3d(Eigen::AngleAxisd(angle, Vector3d(0.3, -0.7, 0.5).normalized()))};
}

/// [mm] 1 km, 1000 km, and 70,000 km.
const std::vector<Case>& shifts() {
  static const std::vector<Case> all = {
      shifted("2^20 mm", Vector3d(0x1p20, -0x1p20, 0x1p19), true),
      shifted("2^30 mm", Vector3d(0x1p30, 0x1p30, -0x1p30), true),
      shifted("2^36 mm", Vector3d(0x1p36, -0x1p35, 0x1p36), true),
      shifted("UTM", Vector3d(465'000.123e3, 5'632'000.456e3, 120.789e3), false),
      shifted("geocentric", Vector3d(4'100'000.123e3, 620'000.456e3, 4'800'000.789e3), false)};
  return all;
}

const std::vector<Case>& turns() {
  static const std::vector<Case> all = {turned("1e-12", 1e-12),
                                        turned("pi - 1e-9", std::numbers::pi - 1e-9),
                                        turned("pi", std::numbers::pi), turned("2.1", 2.1)};
  return all;
}

const std::vector<Case>& orders() {
  static const std::vector<Case> all = {{.name = "order 1", .shuffle = 1},
                                        {.name = "order 2", .shuffle = 2}};
  return all;
}

class Place : public ::testing::TestWithParam<Operation> {};

TEST_P(Place, ResultsMoveWithTheObject) {
  const Operation& operation = GetParam();
  constexpr unsigned kPlaced = kSheet | kBall | kCloud | kPlaces | kAcquisition | kTrajectory;
  constexpr unsigned kOrdered = kPlaced | kContacts | kSamples | kTrials;
  std::vector<Case> cases;
  if ((operation.uses & kPlaced) != 0) {
    cases = shifts();
    cases.insert(cases.end(), turns().begin(), turns().end());
  }
  const std::size_t moved_cases = cases.size();
  if ((operation.uses & kOrdered) != 0) cases.insert(cases.end(), orders().begin(), orders().end());
  std::optional<Results> standard;
  const std::vector<Outcome> outcomes = run_apart(
      cases.size(),
      [&](std::size_t i) {
        if (!standard) standard = operation.run(standard_input(), no_change());
        const Case& one = cases[i];
        const Input input = one.shuffle ? reordered(standard_input(), *one.shuffle)
                                        : moved(standard_input(), one.motion);
        // How many times the last digit of coordinates counts in results.
        const double digit = 0x1p-52 * (1 + one.motion.translation().norm() / size_of(input));
        const double rounding = std::max(operation.place_sensitivity, 1.0) * digit;
        const Agreement agreement =
            compare_moved(*standard, operation.run(input, no_change()), input, rounding);
        return report_of(agreement, one.is_exact && operation.place_sensitivity == 0);
      },
      {.seconds = 2 * operation.seconds});
  std::vector<Finding> findings;
  for (std::size_t i = 0; i < cases.size(); ++i)
    findings.push_back(finding_of(cases[i].name, outcomes[i]));
  const auto part = [&](std::size_t from, std::size_t to) {
    return std::vector<Finding>(findings.begin() + static_cast<std::ptrdiff_t>(from),
                                findings.begin() + static_cast<std::ptrdiff_t>(to));
  };
  if (moved_cases > 0) {
    judge(operation, "places", part(0, shifts().size()));
    judge(operation, "turns", part(shifts().size(), moved_cases));
  }
  if (cases.size() > moved_cases) judge(operation, "orders", part(moved_cases, cases.size()));
}

INSTANTIATE_TEST_SUITE_P(All, Place, ::testing::ValuesIn(operations()),
                         [](const auto& one) { return test_name(one.param); });

}  // namespace
}  // namespace palpate::extremes
