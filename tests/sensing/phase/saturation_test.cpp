// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "phase/saturation.h"

#include <gtest/gtest.h>

#include <cstddef>
#include <limits>
#include <vector>

namespace palpate::sensing {
namespace {

Mask clipped_in(const std::vector<Plane>& channels) {
  Mask clipped = Mask::Ones(1, 1);  // of an earlier frame of another size
  find_clipped(channels, clipped);
  return clipped;
}

TEST(Saturation, FindsTheHighestValueOfEachDepthAndNoOther) {
  Plane values(1, 6);
  values << 1, 254.0F / 255, 65535.0F / 65535, 0.99F, 0, std::numeric_limits<float>::quiet_NaN();
  Mask expected(1, 6);
  expected << 1, 0, 1, 0, 0, 0;
  EXPECT_TRUE((clipped_in({values}) == expected).all());
}

TEST(Saturation, IsThatOfAnyChannel) {
  std::vector<Plane> channels(3, Plane::Constant(5, 7, 0.5F));
  for (int channel = 0; channel < 3; ++channel)
    channels[static_cast<std::size_t>(channel)](channel, 2 * channel) = 1;
  const Mask clipped = clipped_in(channels);
  ASSERT_EQ(clipped.rows(), 5);
  ASSERT_EQ(clipped.cols(), 7);
  EXPECT_EQ(clipped.cast<int>().sum(), 3);
  for (int channel = 0; channel < 3; ++channel) EXPECT_EQ(clipped(channel, 2 * channel), 1);
}

}  // namespace
}  // namespace palpate::sensing
