// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/geometry/packed_image.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "not_finite.h"
#include "palpate/core/error.h"

namespace palpate::geometry {
namespace {

constexpr double kStep = 0.002;
/// Rounding of quotient and product of numbers near 1000.
constexpr double kRounding = 1e-12;

/// A bumpy wall near 700 mm with noise, holes, a step, and unknown borders.
ImageD wall(Eigen::Index rows, Eigen::Index cols) {
  std::mt19937 engine(7);
  std::normal_distribution<double> noise(0, 0.05);
  std::uniform_real_distribution<double> any(0, 1);
  ImageD z(rows, cols);
  for (Eigen::Index v = 0; v < rows; ++v) {
    for (Eigen::Index u = 0; u < cols; ++u) {
      const double x = static_cast<double>(u), y = static_cast<double>(v);
      z(v, u) = 700.3 + 0.21 * x + 4 * std::sin(0.13 * x) * std::cos(0.07 * y) + noise(engine) +
                (u > cols / 2 ? 351.7 : 0);
      if (any(engine) < 0.1 || u < 2 || v + 1 == rows) z(v, u) = kNaN;
    }
  }
  return z;
}

TEST(PackedImage, KeepsEachValueWithinHalfAStepAndEachUnknownOne) {
  const ImageD z = wall(61, 83);
  const CodeImage back = unpack(pack(codes_of(z, kStep)), z.rows(), z.cols());
  long known = 0;
  for (Eigen::Index i = 0; i < z.size(); ++i) {
    const std::int32_t code = back.data()[i];
    ASSERT_EQ(code == kUnknownCode, std::isnan(z.data()[i])) << i;
    if (code == kUnknownCode) continue;
    ++known;
    ASSERT_NEAR(code * kStep, z.data()[i], kStep / 2 + kRounding) << i;
  }
  EXPECT_GT(known, z.size() / 2);
}

TEST(PackedImage, LosesNoCodeAtTheEndsOfTheRange) {
  CodeImage codes(3, 4);
  const std::int32_t most = kCodeLimit - 1;
  codes << most, -most, most, 0, -most, most, kUnknownCode, -most, kUnknownCode, most, -most, -1;
  EXPECT_TRUE((unpack(pack(codes), 3, 4) == codes).all());
}

TEST(PackedImage, OfARampNeedsOnlyItsCorner) {
  CodeImage codes(20, 30);
  for (Eigen::Index v = 0; v < codes.rows(); ++v)
    for (Eigen::Index u = 0; u < codes.cols(); ++u)
      codes(v, u) = static_cast<std::int32_t>(5000 + 7 * u - 3 * v);
  const std::vector<std::byte> bytes = pack(codes);
  // 1 stands for no difference; beside the corner, the first row and column differ by 7 and -3.
  const auto plain = std::count(bytes.begin(), bytes.begin() + codes.size(), std::byte{1});
  EXPECT_EQ(plain, 19 * 29);
}

TEST(PackedImage, TakesInfinityAsUnknown) {
  ImageD values(1, 3);
  values << kInf, -kInf, 1.0;
  const CodeImage codes = codes_of(values, 0.5);
  EXPECT_EQ(codes(0, 0), kUnknownCode);
  EXPECT_EQ(codes(0, 1), kUnknownCode);
  EXPECT_EQ(codes(0, 2), 2);
}

TEST(PackedImage, HasRoundSteps) {
  EXPECT_EQ(round_step(0.0049), 0.002);
  EXPECT_EQ(round_step(0.005), 0.005);
  EXPECT_EQ(round_step(0.001), 0.001);
  EXPECT_EQ(round_step(9.9), 5);
  EXPECT_EQ(round_step(1000), 1000);
  for (const double bad : {0.0, -1.0, kNaN, kInf})
    EXPECT_THROW((void)round_step(bad), InvalidInput);
}

TEST(PackedImage, RefusesWhatItCannotStore) {
  EXPECT_THROW((void)codes_of(ImageD::Constant(2, 2, 5000.0), 0.001), InvalidInput);
  for (const double bad : {0.0, -0.1, kNaN, kInf})
    EXPECT_THROW((void)codes_of(ImageD::Zero(2, 2), bad), InvalidInput);
  EXPECT_THROW((void)pack(CodeImage::Constant(1, 1, kCodeLimit)), InvalidInput);
}

TEST(PackedImage, SaysThatBytesAreDamaged) {
  std::vector<std::byte> bytes = pack(CodeImage::Constant(4, 5, 1000));
  EXPECT_THROW((void)unpack(bytes, 5, 5), InvalidInput);
  EXPECT_THROW((void)unpack(bytes, -4, -5), InvalidInput);
  bytes[2 * 20] = std::byte{255};  // the high byte of the first code
  EXPECT_THROW((void)unpack(bytes, 4, 5), InvalidInput);
}

TEST(PackedImage, OfNoPixelsIsEmpty) {
  EXPECT_TRUE(pack(CodeImage(0, 7)).empty());
  EXPECT_EQ(unpack({}, 0, 7).size(), 0);
}

}  // namespace
}  // namespace palpate::geometry
