// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "operations.h"

#include <gtest/gtest.h>

#include <set>

#include "findings.h"

namespace palpate::extremes {
namespace {

/// The message of a build without CGAL's GPL packages.
constexpr const char* kWithoutCgal = "CGAL";

// Else all that the themes find would be refusals.
TEST(Operations, WorkOnTheStandardInput) {
  for (const Operation& operation : operations()) {
    const std::vector<Outcome> outcomes = run_apart(
        2,
        [&](std::size_t i) {
          const Input& input = i == 0 ? standard_input() : small_input();
          const Results results = operation.run(input, no_change());
          return results.empty() ? report_of_wrong("no results") : report_of_finite(results);
        },
        {.seconds = 2 * operation.seconds});
    for (const Outcome& outcome : outcomes) {
      const Finding finding = finding_of(operation.name, outcome);
      if (outcome.text.find(kWithoutCgal) != std::string::npos) continue;
      EXPECT_EQ(finding.verdict, Verdict::finite) << operation.name << ": " << outcome.text;
    }
  }
}

TEST(Operations, HaveNamesOfTheirOwn) {
  std::set<std::string> names;
  for (const Operation& operation : operations())
    EXPECT_TRUE(names.insert(test_name(operation)).second) << operation.name;
}

TEST(Operations, ThatAreKnownToDeviateAreListed) {
  std::set<std::string_view> names;
  for (const Operation& operation : operations()) names.insert(operation.name);
  for (const KnownDeviation& known : known_deviations())
    EXPECT_TRUE(names.contains(known.operation) || known.only_large) << known.operation;
}

}  // namespace
}  // namespace palpate::extremes
