// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "model/stored_form.h"

#include <gtest/gtest.h>

#include <array>
#include <cstddef>
#include <new>
#include <random>

namespace palpate::haptics {
namespace {

// Readers and writers have ridges at other places, and must find the same bits.
TEST(StoredForm, OfARidgeIsReadEquallyWhereverItLiesInMemory) {
  constexpr std::size_t kNumbers = sizeof(StoredRidge) / sizeof(double);
  alignas(16) std::array<double, 2 * kNumbers + 1> memory{};
  std::mt19937 random(5);
  std::normal_distribution<double> normal;
  for (int i = 0; i < 1000; ++i) {
    const StoredRidge ridge{
        normal(random), normal(random), {normal(random), normal(random), normal(random)}};
    const auto* even = new (memory.data()) StoredRidge(ridge);
    const Multiquadric first = to_ridge(*even);
    const auto* odd = new (memory.data() + 1) StoredRidge(ridge);
    EXPECT_EQ(to_ridge(*odd), first);
  }
}

TEST(StoredForm, TakesSlopesWhoseSquaresOverflow) {
  EXPECT_DOUBLE_EQ(length_of({3e200, 0, -4e200}), 5e200);
  EXPECT_DOUBLE_EQ(length_of({3e-200, 0, -4e-200}), 5e-200);
}

}  // namespace
}  // namespace palpate::haptics
