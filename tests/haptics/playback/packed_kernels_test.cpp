// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "playback/packed_kernels.h"

#include <gtest/gtest.h>

#include <array>
#include <cstring>
#include <random>
#include <vector>

// The same source once more, for the oldest processor only: in a namespace of its own.
namespace palpate::haptics::packed_plain {
using namespace palpate::haptics::packed;
}
#define packed packed_plain
#define PALPATE_FOR_EACH_PROCESSOR
#include "playback/packed_kernels.cpp"
#undef packed

namespace palpate::haptics {
namespace {

bool has_avx2() {
#if defined(__x86_64__)
  return __builtin_cpu_supports("avx2") != 0;
#else
  return false;
#endif
}

Lanes some_lanes(std::mt19937& random, double low, double high) {
  std::uniform_real_distribution<double> uniform(low, high);
  return {{uniform(random), uniform(random), uniform(random), uniform(random)}};
}

/// A place of up to twelve contacts with normals that differ by some degrees.
PlaceField some_place(std::mt19937& random, int count) {
  PlaceField place;
  place.count = count;
  for (std::size_t p = 0; p < PlaceField::kPacks; ++p) {
    for (Lanes& lanes : place.constants[p]) lanes = some_lanes(random, -0.3, 0.3);
    auto& c = place.constants[p];
    for (const std::size_t diagonal : {0, 4, 8}) {
      c[packed::kPressing + diagonal] = some_lanes(random, 0.9, 1);
    }
    c[packed::kCone + 2] = some_lanes(random, 0.9, 1);
    // Positive: the compliances across and along z, and what follows from them.
    for (const int k : {packed::kValues + 2, packed::kValues + 3, packed::kValues + 5,
                        packed::kRoot, packed::kInverseRoot, packed::kInverseDepth}) {
      c[static_cast<std::size_t>(k)] = some_lanes(random, 1, 2);
    }
    for (Lanes& lanes : place.to_local[p]) lanes = some_lanes(random, -1, 1);
    place.scale[p] = some_lanes(random, 0, 1);
  }
  for (std::size_t i = 0; i < place.contacts.size(); ++i)
    place.contacts[i] = static_cast<int>(i % 3);
  return place;
}

// The library takes the version with AVX2 here; the one that is compiled above has none.
TEST(PackedKernels, GiveTheSameBitsWithAndWithoutAvx2) {
  if (!has_avx2()) GTEST_SKIP() << "the processor has no AVX2: there is one version to run";
  std::mt19937 random(4);
  std::vector<PackedField::IsotropicBases> isotropic(6);
  std::vector<PackedField::RidgeBases> ridges(3);
  for (auto& base : isotropic) {
    base = {some_lanes(random, -1, 2),
            some_lanes(random, 1, 50),
            {some_lanes(random, -9, 9), some_lanes(random, -9, 9), some_lanes(random, -9, 9)}};
  }
  for (auto& base : ridges) {
    base = {some_lanes(random, -1, 2),
            some_lanes(random, 1, 50),
            some_lanes(random, -9, 9),
            {some_lanes(random, -1, 1), some_lanes(random, -1, 1), some_lanes(random, -1, 1)}};
  }
  const std::vector<PackedField::BaseRange> ranges = {{0, 2, 0, 1}, {2, 5, 1, 1}, {5, 6, 1, 3}};
  std::uniform_real_distribution<double> uniform(-9, 9);
  int blended = 0;
  for (int i = 0; i < 2000; ++i) {
    const std::array<double, 3> x = {uniform(random), uniform(random), uniform(random)};
    Lanes wide, plain;
    packed::evaluate_bases({isotropic.data(), ridges.data(), ranges.data()}, i % 3, x.data(), wide);
    packed_plain::evaluate_bases({isotropic.data(), ridges.data(), ranges.data()}, i % 3, x.data(),
                                 plain);
    EXPECT_EQ(wide.of, plain.of) << i;

    PlaceField place = some_place(random, 1 + i % 12);
    packed::evaluate(place, {isotropic.data(), ridges.data(), ranges.data()}, x.data(), wide);
    packed_plain::evaluate(place, {isotropic.data(), ridges.data(), ranges.data()}, x.data(),
                           plain);
    EXPECT_EQ(wide.of, plain.of) << i;

    std::array<Lanes, PlaceField::kPacks> weights{};
    for (int k = 0; k < place.count; ++k)
      weights[static_cast<std::size_t>(k / 4)].of[static_cast<std::size_t>(k % 4)] =
          1.0 / place.count;
    PlaceField again = place;
    const bool good = packed::blend_places(x.data(), 3, weights.data(), place);
    EXPECT_EQ(good, packed_plain::blend_places(x.data(), 3, weights.data(), again)) << i;
    if (!good) continue;
    ++blended;
    EXPECT_EQ(std::memcmp(&place.to_local, &again.to_local, sizeof(place.to_local)), 0) << i;
    EXPECT_EQ(std::memcmp(&place.scale, &again.scale, sizeof(place.scale)), 0) << i;
    EXPECT_EQ(place.friction, again.friction);
    EXPECT_EQ(place.cone_axis, again.cone_axis);
    EXPECT_EQ(place.friction_axis, again.friction_axis);
  }
  EXPECT_GT(blended, 500);
}

}  // namespace
}  // namespace palpate::haptics
