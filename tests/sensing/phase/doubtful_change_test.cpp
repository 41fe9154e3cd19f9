// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "phase/doubtful_change.h"

#include <gtest/gtest.h>

namespace palpate::sensing {
namespace {

constexpr DoubtfulChange kTried{.most = 0.1, .least = 0.01, .typicals = 10};

/// Changes of one size, of either sign; four in nine are steps, and some pixels are unknown.
Plane changes_beside_steps(float size) {
  Plane changes = Plane::Constant(90, 70, size);
  changes.topRows(40) = 0.5F;
  changes.leftCols(20) *= -1;
  changes.rightCols(9) = kUnknown;
  return changes;
}

TEST(DoubtfulChange, IsAMultipleOfTheTypicalOneBetweenItsLimits) {
  EXPECT_FLOAT_EQ(doubtful_change(changes_beside_steps(0.004F), kTried), 0.04F);
  EXPECT_FLOAT_EQ(doubtful_change(changes_beside_steps(0.0001F), kTried), 0.01F);
  EXPECT_FLOAT_EQ(doubtful_change(changes_beside_steps(0), kTried), 0.01F);
  EXPECT_FLOAT_EQ(doubtful_change(changes_beside_steps(0.03F), kTried), 0.1F);
}

TEST(DoubtfulChange, IsLargestWhereNothingIsKnown) {
  EXPECT_FLOAT_EQ(doubtful_change(Plane::Constant(5, 5, kUnknown), kTried), 0.1F);
  EXPECT_FLOAT_EQ(doubtful_change(Plane(0, 0), kTried), 0.1F);
}

TEST(DoubtfulChange, CountsInSquares) {
  Plane changes(1, 3), doubt = Plane::Constant(1, 3, 0.25F);
  changes << 0.1F, -0.3F, kUnknown;
  add_doubt(changes, 0.2F, 0.5F, doubt);
  EXPECT_FLOAT_EQ(doubt(0, 0), 0.5F);
  EXPECT_FLOAT_EQ(doubt(0, 1), 2.5F);
  EXPECT_FLOAT_EQ(doubt(0, 2), 0.75F);
}

}  // namespace
}  // namespace palpate::sensing
