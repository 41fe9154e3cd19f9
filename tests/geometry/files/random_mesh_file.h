// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>

#include <bit>
#include <cstdint>
#include <cstring>
#include <limits>
#include <random>
#include <string>
#include <type_traits>

#include "palpate/geometry/mesh_io.h"
#include "test_surfaces.h"

namespace palpate::geometry {

/// A number of any bits: both zeros, denormal, huge, infinite and undefined ones among them. NaN
/// has no payload, as text cannot carry one.
template <typename Number>
Number random_number(std::mt19937_64& random) {
  if constexpr (std::is_floating_point_v<Number>) {
    using Limits = std::numeric_limits<Number>;
    switch (random() % 8) {
      case 0:
        return -Number{0};
      case 1:
        return Limits::denorm_min();
      case 2:
        return -Limits::max();
      case 3:
        return random() % 2 == 0 ? -Limits::infinity() : Limits::infinity();
      case 4:
        return Limits::quiet_NaN();
      default:
        break;
    }
    using Bits = std::conditional_t<sizeof(Number) == 4, std::uint32_t, std::uint64_t>;
    const auto number = std::bit_cast<Number>(static_cast<Bits>(random()));
    return number == number ? number : Number{1};
  } else {
    return static_cast<Number>(random());
  }
}

template <typename Number>
Attribute random_attribute(const std::string& name, Eigen::Index elements, bool lists,
                           std::mt19937_64& random) {
  Attribute attribute{name, {}, {}};
  std::vector<Number> numbers;
  for (Eigen::Index i = 0; i < elements; ++i) {
    const int size = lists ? static_cast<int>(random() % 4) : 1;
    for (int k = 0; k < size; ++k) numbers.push_back(random_number<Number>(random));
    if (lists) attribute.list_sizes.push_back(size);
  }
  attribute.values = std::move(numbers);
  return attribute;
}

/// One attribute of each type that PLY knows.
inline Attributes random_attributes(Eigen::Index elements, bool lists, std::mt19937_64& random) {
  const auto make = [&]<typename Number>(const char* name, Number) {
    return random_attribute<Number>(name, elements, lists, random);
  };
  return {make("a_char", std::int8_t{}),   make("a_uchar", std::uint8_t{}),
          make("a_short", std::int16_t{}), make("a_ushort", std::uint16_t{}),
          make("an_int", std::int32_t{}),  make("a_uint", std::uint32_t{}),
          make("a_float", float{}),        make("a_double", double{})};
}

/// Finite coordinates with any bits.
inline Eigen::Matrix3Xd random_points(Eigen::Index count, std::mt19937_64& random) {
  return Eigen::Matrix3Xd::NullaryExpr(3, count, [&] {
    const auto number = random_number<double>(random);
    return std::isfinite(number) ? number : -0.1;
  });
}

inline MeshFile random_mesh_file(unsigned seed) {
  std::mt19937_64 random(seed);
  MeshFile file;
  file.mesh = test::icosphere(1, 100.1);
  file.mesh.vertices = random_points(file.mesh.vertices.cols(), random);
  file.vertex_attributes = random_attributes(file.mesh.vertices.cols(), seed % 2 == 1, random);
  file.triangle_attributes = random_attributes(file.mesh.triangles.cols(), seed % 3 == 1, random);
  file.comments = {"made by a test", "", "  two blanks, \"quotes\" and the word unit"};
  return file;
}

template <typename Number>
bool same_bits(const std::vector<Number>& a, const std::vector<Number>& b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(Number)) == 0;
}

inline bool same_bits(const Eigen::Matrix3Xd& a, const Eigen::Matrix3Xd& b) {
  return a.cols() == b.cols() &&
         std::memcmp(a.data(), b.data(), static_cast<std::size_t>(a.size()) * sizeof(double)) == 0;
}

inline void expect_same(const Attributes& read, const Attributes& written) {
  ASSERT_EQ(read.size(), written.size());
  for (std::size_t i = 0; i < read.size(); ++i) {
    EXPECT_EQ(read[i].name, written[i].name);
    EXPECT_EQ(read[i].list_sizes, written[i].list_sizes) << read[i].name;
    ASSERT_EQ(read[i].values.index(), written[i].values.index()) << read[i].name;
    EXPECT_TRUE(std::visit(
        [&](const auto& numbers) {
          return same_bits(numbers, std::get<std::decay_t<decltype(numbers)>>(written[i].values));
        },
        read[i].values))
        << read[i].name;
  }
}

inline void expect_same(const MeshFile& read, const MeshFile& written) {
  EXPECT_TRUE(same_bits(read.mesh.vertices, written.mesh.vertices));
  EXPECT_EQ(read.mesh.triangles, written.mesh.triangles);
  EXPECT_EQ(read.comments, written.comments);
  expect_same(read.vertex_attributes, written.vertex_attributes);
  expect_same(read.triangle_attributes, written.triangle_attributes);
}

}  // namespace palpate::geometry
