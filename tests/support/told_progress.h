// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>

#include <cstddef>
#include <functional>
#include <stdexcept>
#include <utility>
#include <vector>

namespace palpate {

/// Does the work and checks its reports of progress: at least this number of reports, of one total,
/// never fewer done than before, and all of it at the end alone. Then does it again and again, and
/// checks that it ends with the exception that the first, the middle and the last report throws.
template <typename Work>
void check_progress(Work&& work, std::size_t least_reports) {
  std::vector<std::pair<int, int>> seen;
  work([&](int done, int total) { seen.emplace_back(done, total); });
  ASSERT_GE(seen.size(), least_reports);
  const int all = seen.back().second;
  EXPECT_EQ(seen.back().first, all);
  for (std::size_t i = 0; i + 1 < seen.size(); ++i) {
    EXPECT_EQ(seen[i].second, all);
    EXPECT_LT(seen[i].first, all);
    EXPECT_LE(seen[i].first, seen[i + 1].first);
  }
  EXPECT_GE(seen.front().first, 0);
  for (const std::size_t last : {std::size_t{0}, seen.size() / 2, seen.size() - 1}) {
    std::size_t reports = 0;
    const std::function<void(int, int)> stop = [&](int, int) {
      if (reports++ == last) throw std::domain_error("stop");
    };
    EXPECT_THROW(work(stop), std::domain_error);
    EXPECT_EQ(reports, last + 1);
  }
}

}  // namespace palpate
