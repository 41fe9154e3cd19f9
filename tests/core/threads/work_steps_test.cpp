// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/core/work_steps.h"

#include <gtest/gtest.h>

#include <stdexcept>
#include <utility>
#include <vector>

namespace palpate {
namespace {

TEST(WorkSteps, TellsWhatIsDoneAndAllOfItOnlyAtTheEnd) {
  std::vector<std::pair<int, int>> seen;
  const WorkSteps::Progress progress = [&](int done, int total) { seen.emplace_back(done, total); };
  WorkSteps steps(progress, 5);
  steps.tell();
  steps.tell(0);
  steps.tell(7);  // more than the total
  steps.end();
  EXPECT_EQ(seen, (std::vector<std::pair<int, int>>{{1, 5}, {1, 5}, {4, 5}, {5, 5}}));
}

TEST(WorkSteps, EndsTheWorkIfTheCallbackThrowsAndNeedsNone) {
  const WorkSteps::Progress stop = [](int, int) { throw std::domain_error("stop"); };
  EXPECT_THROW(WorkSteps(stop, 2).tell(), std::domain_error);
  const WorkSteps::Progress none;
  WorkSteps steps(none, 2);
  EXPECT_NO_THROW(steps.tell());
  EXPECT_NO_THROW(steps.end());
}

}  // namespace
}  // namespace palpate
