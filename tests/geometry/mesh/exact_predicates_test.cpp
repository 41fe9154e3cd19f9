// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "mesh/exact_predicates.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <utility>

namespace palpate::geometry {
namespace {

using Eigen::Vector3d;
using Whole = Eigen::Matrix<long long, 3, 1>;
// Exact: products of three differences are below 2^127.
__extension__ using Wide = __int128;

int sign(Wide x) { return x > 0 ? 1 : x < 0 ? -1 : 0; }

int exact(const Whole& a, const Whole& b, const Whole& c, const Whole& d) {
  const Whole p = a - d, q = b - d, r = c - d;
  const auto minor = [](const Whole& u, const Whole& v) {
    return Wide(u[0]) * v[1] - Wide(v[0]) * u[1];
  };
  return sign(p[2] * minor(q, r) + q[2] * minor(r, p) + r[2] * minor(p, q));
}

/// Four points of which the last is in the plane of the others, or off it by a few units.
struct NearlyPlane {
  Whole a, b, c, d;
};

NearlyPlane nearly_plane(std::mt19937_64& random, long long size, long long offset) {
  const auto any = [&](long long most) {
    return std::uniform_int_distribution<long long>(-most, most)(random);
  };
  const auto point = [&] { return Whole(offset + any(size), any(size), any(size) - offset); };
  NearlyPlane result{.a = point(), .b = point(), .c = point(), .d = {}};
  result.d = result.a + any(5) * (result.b - result.a) + any(5) * (result.c - result.a) +
             Whole(any(1), any(1), any(1)) * any(1);
  return result;
}

TEST(ExactPredicates, GiveTheSignOfWholeNumbersAlsoInThePlane) {
  std::mt19937_64 random(1);
  int in_plane = 0;
  for (const auto& [size, offset] : {std::pair(100LL, 0LL), std::pair(1LL << 33, 0LL),
                                     std::pair(1LL << 20, 1LL << 38), std::pair(50LL, 1LL << 38)}) {
    for (int i = 0; i < 4000; ++i) {
      const auto [a, b, c, d] = nearly_plane(random, size, offset);
      const double unit = i % 2 == 0 ? 0x1p-70 : 0x1p30;
      const auto real = [unit](const Whole& w) { return Vector3d(unit * w.cast<double>()); };
      const int expected = exact(a, b, c, d);
      ASSERT_EQ(orientation(real(a), real(b), real(c), real(d)), expected);
      ASSERT_EQ(orientation(real(b), real(a), real(c), real(d)), -expected);
      in_plane += expected == 0;
    }
  }
  EXPECT_GT(in_plane, 4000);
}

TEST(ExactPredicates, GiveTheSideOfALineAlsoOnIt) {
  std::mt19937_64 random(2);
  int on_line = 0;
  for (int i = 0; i < 8000; ++i) {
    const auto [a, b, c, d] = nearly_plane(random, 1LL << 33, 1LL << 38);
    const long long share = static_cast<long long>(random() % 5);
    const Whole e = a + share * (b - a) + Whole(i % 3 - 1, 0, 0);
    const Whole p = a - e, q = b - e;
    const int expected = sign(Wide(p[0]) * q[1] - Wide(p[1]) * q[0]);
    const auto flat = [](const Whole& w) { return Eigen::Vector2d(w.head<2>().cast<double>()); };
    ASSERT_EQ(orientation(flat(a), flat(b), flat(e)), expected);
    ASSERT_EQ(orientation(flat(b), flat(a), flat(e)), -expected);
    on_line += expected == 0;
  }
  EXPECT_GT(on_line, 2000);
}

// 0.1 and its multiples are no binary fractions: the points are off the line by their rounding.
TEST(ExactPredicates, SeeTheRoundingOfDecimals) {
  const Eigen::Vector2d a(0.1, 0.1), b(0.3, 0.3), c(0.2, 0.2);
  EXPECT_EQ(orientation(a, b, c), 0);
  EXPECT_EQ(orientation(a, b, Eigen::Vector2d(0.2, std::nextafter(0.2, 1))), 1);
  EXPECT_EQ(orientation(a, b, Eigen::Vector2d(0.2, std::nextafter(0.2, 0))), -1);
  const Vector3d p(0.1, 0.7, 0.1), q(0.3, -0.2, 0.3), r(-1.7, 12, -1.7);
  EXPECT_EQ(orientation(p, q, r, {5, 3, 5}), 0);
  EXPECT_EQ(orientation(p, q, r, {5, 3, std::nextafter(5, 6)}),
            -orientation(p, q, r, {5, 3, std::nextafter(5, 4)}));
  EXPECT_NE(orientation(p, q, r, {5, 3, std::nextafter(5, 6)}), 0);
}

}  // namespace
}  // namespace palpate::geometry
