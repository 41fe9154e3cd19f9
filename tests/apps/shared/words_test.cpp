// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "shared/words.h"

#include <gtest/gtest.h>
#include <spdlog/spdlog.h>

#include <cstddef>
#include <string>
#include <vector>

namespace palpate::apps {
namespace {

TEST(Words, CountInSingularAndPlural) {
  EXPECT_EQ(counted(1, "contact"), "1 contact");
  EXPECT_EQ(counted(0, "contact"), "0 contacts");
  EXPECT_EQ(counted(21, "mesh", "meshes"), "21 meshes");
  EXPECT_EQ(counted(std::size_t{1}, "mesh", "meshes"), "1 mesh");
}

TEST(Words, ShowThreeDigitsOfAForceAtLeast) {
  EXPECT_EQ(newtons(0.034449), "0.0344 N");
  EXPECT_EQ(newtons(12.345678), "12.3457 N");
  EXPECT_EQ(newtons(0.0034449), "0.00344 N");
  EXPECT_EQ(newtons(-3.4449e-5), "-3.44e-05 N");
  EXPECT_EQ(newtons(0), "0 N");
  EXPECT_EQ(newtons(1.51249, 3), "1.512 N");
  EXPECT_EQ(newtons(0.0592, 3), "0.0592 N");
}

TEST(Words, PrintTheWorstLinesUnlessAllAreAskedFor) {
  const std::vector<std::string> lines = {"a\n", "b\n", "c\n", "d\n", "e\n"};
  const std::vector<double> errors = {2, 5, 1, 5, 3};
  const auto before = spdlog::get_level();
  spdlog::set_level(spdlog::level::warn);
  EXPECT_EQ(worst_lines(lines, errors), "The 3 worst of 5 (-v prints all):\nb\nd\ne\n");
  EXPECT_EQ(worst_lines({"a\n", "b\n"}, {1, 2}), "a\nb\n");
  spdlog::set_level(spdlog::level::info);
  EXPECT_EQ(worst_lines(lines, errors), "a\nb\nc\nd\ne\n");
  spdlog::set_level(before);
}

}  // namespace
}  // namespace palpate::apps
