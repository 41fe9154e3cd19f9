// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "shared/words.h"

#include <gtest/gtest.h>

#include <cstddef>

namespace palpate::apps {
namespace {

TEST(Words, CountInSingularAndPlural) {
  EXPECT_EQ(counted(1, "contact"), "1 contact");
  EXPECT_EQ(counted(0, "contact"), "0 contacts");
  EXPECT_EQ(counted(21, "mesh", "meshes"), "21 meshes");
  EXPECT_EQ(counted(std::size_t{1}, "mesh", "meshes"), "1 mesh");
}

}  // namespace
}  // namespace palpate::apps
