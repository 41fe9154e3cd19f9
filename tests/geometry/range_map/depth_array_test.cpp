// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/geometry/depth_array.h"

#include <gtest/gtest.h>

#include <bit>
#include <string>

#include "file_testing.h"
#include "palpate/core/error.h"

namespace palpate::geometry {
namespace {

// Byte by byte according to numpy's description of the format; in tests/python numpy reads one.
TEST(DepthArray, HasADescriptionOfWholeLinesAndTheDepthsRowByRow) {
  const ScratchFolder folder;
  ImageF z(2, 3);
  z << 700.25F, 0.1F, -0.0F, 1e-30F, 3, 4;
  write_depth_array(folder / "z.npy", z);
  std::string expected = "\x93NUMPY";
  expected += std::string("\x01\x00\x76\x00", 4);
  expected += "{'descr': '<f4', 'fortran_order': False, 'shape': (2, 3), }";
  expected.resize(127, ' ');
  expected += '\n';
  for (const float depth : {700.25F, 0.1F, -0.0F, 1e-30F, 3.0F, 4.0F}) put(expected, depth);
  EXPECT_EQ(read_text(folder / "z.npy"), expected);
  EXPECT_THROW(write_depth_array(folder / "none.npy", {}), InvalidInput);
}

}  // namespace
}  // namespace palpate::geometry
