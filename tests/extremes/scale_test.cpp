// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
// In another unit of length or force, results are the same numbers in that unit. Powers of two are
// exact, so results are, too, unless an operation says that it rounds.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <optional>

#include "findings.h"

namespace palpate::extremes {
namespace {

struct Unit {
  int length = 0, force = 0;  ///< powers of two
};

/// A unit of 2^30 is 1000 km to one of the standard input, one of 2^-30 a nanometre.
constexpr int kFar = 30;
/// A factor of about 100, as between objects of 1 mm and 100 mm.
constexpr int kNear = 7;
/// Beyond what anybody measures; an operation may refuse it.
constexpr int kAbsurd = 100;

std::string name_of(const Unit& unit) {
  return fmt::format("length 2^{}, force 2^{}", unit.length, unit.force);
}

class Scale : public ::testing::TestWithParam<Operation> {};

TEST_P(Scale, ResultsAreTheSameInAnotherUnit) {
  const Operation& operation = GetParam();
  const bool has_lengths = (operation.uses & ~static_cast<unsigned>(kTrials | kOptions)) != 0;
  const bool has_forces = (operation.uses & (kSamples | kTrials | kAcquisition | kForces)) != 0;
  std::vector<Unit> lengths, forces, absurd;
  if (has_lengths) {
    lengths = {{-kFar, 0}, {-kNear, 0}, {kFar, 0}};
    absurd = {{-kAbsurd, 0}, {kAbsurd, 0}};
  }
  if (has_forces) {
    forces = {{0, -kFar}, {0, -kNear}, {0, kFar}, {kFar, -kFar}};
    absurd.insert(absurd.end(), {{0, -kAbsurd}, {0, kAbsurd}});
  }
  std::vector<Unit> units = lengths;
  units.insert(units.end(), forces.begin(), forces.end());
  units.insert(units.end(), absurd.begin(), absurd.end());
  std::optional<Results> standard;
  const std::vector<Outcome> outcomes = run_apart(
      units.size(),
      [&](std::size_t i) {
        if (!standard) standard = operation.run(standard_input(), no_change());
        const Input input =
            scaled(standard_input(), std::ldexp(1, units[i].length), std::ldexp(1, units[i].force));
        Agreement agreement = compare_scaled(*standard, operation.run(input, no_change()), input);
        agreement.over_allowed = agreement.difference / operation.scale_tolerance;
        return report_of(agreement, operation.scale_tolerance == 0);
      },
      {.seconds = 2 * operation.seconds});
  std::size_t next = 0;
  const auto judge_next = [&](std::string_view theme, const std::vector<Unit>& of) {
    std::vector<Finding> findings;
    for (const Unit& unit : of) findings.push_back(finding_of(name_of(unit), outcomes[next++]));
    judge(operation, theme, findings);
  };
  judge_next("lengths 2^30", lengths);
  judge_next("forces 2^30", forces);
  judge_next("2^100", absurd);
}

INSTANTIATE_TEST_SUITE_P(All, Scale, ::testing::ValuesIn(operations()),
                         [](const auto& one) { return test_name(one.param); });

}  // namespace
}  // namespace palpate::extremes
