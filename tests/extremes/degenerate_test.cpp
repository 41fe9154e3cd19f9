// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
// Results of degenerate input are finite, or the input is refused in words: no operation crashes,
// goes on without end, or takes all memory.
#include <gtest/gtest.h>

#include "degenerate.h"
#include "findings.h"

namespace palpate::extremes {
namespace {

constexpr std::string_view kTheme = "degenerate";

class DegenerateInput : public ::testing::TestWithParam<Operation> {};

TEST_P(DegenerateInput, HasFiniteResultsOrIsRefused) {
  const Operation& operation = GetParam();
  std::vector<const Degenerate*> cases;
  for (const Degenerate& one : degenerate_inputs())
    // Under a sanitizer nothing limits the memory of what has no end.
    if ((one.parts & operation.uses) != 0 &&
        !(is_sanitized() && is_known(operation.name, kTheme, one.name)))
      cases.push_back(&one);
  if (cases.empty()) return;
  const std::vector<Outcome> outcomes =
      run_apart(cases.size(),
                [&](std::size_t i) {
                  Input input = small_input();
                  cases[i]->spoil(input);
                  return report_of_finite(operation.run(input, no_change()));
                },
                {.seconds = operation.seconds});
  std::vector<Finding> findings;
  for (std::size_t i = 0; i < cases.size(); ++i)
    findings.push_back(finding_of(cases[i]->name, outcomes[i]));
  judge(operation, kTheme, findings);
}

INSTANTIATE_TEST_SUITE_P(All, DegenerateInput, ::testing::ValuesIn(operations()),
                         [](const auto& one) { return test_name(one.param); });

}  // namespace
}  // namespace palpate::extremes
