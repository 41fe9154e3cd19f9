// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "playback/surface_side.h"

#include <gtest/gtest.h>

#include <random>
#include <vector>

#include "crease_model.h"

namespace palpate::haptics {
namespace {

// Below a sharp groove a place may be behind one flank and in front of the other.
TEST(SurfaceSide, AgreesWithTheSectionOfSharpGrooves) {
  const std::vector<double> openings = {20, 30, 45, 60, 90};  // [degrees]
  const CreaseProfile profile(openings);
  const Model model = crease_model({.openings = openings, .width = 40});
  const geometry::SurfaceQuery query(model.surface);
  const SurfaceSide side(model.surface, query);
  std::mt19937 random(3);
  std::uniform_real_distribution<double> uniform(-1, 1);
  for (std::size_t groove = 0; groove < openings.size(); ++groove) {
    for (int i = 0; i < 200; ++i) {
      const Eigen::Vector3d place{profile.bottom(groove) + 4 * uniform(random),
                                  15 * uniform(random),
                                  -CreaseProfile::kDepth + 4 * uniform(random)};
      TouchPoint nearest;
      EXPECT_NEAR(-side.signed_distance(place, nearest), profile.depth(place), 1e-6)
          << openings[groove] << ' ' << place.transpose();
    }
  }
}

}  // namespace
}  // namespace palpate::haptics
