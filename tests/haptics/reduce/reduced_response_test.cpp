// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "reduce/reduced_response.h"

#include <gtest/gtest.h>

#include <array>

#include "following_surface.h"
#include "palpate/haptics/deformed_shape.h"

namespace palpate::haptics {
namespace {

// Halves have 11 bits; moves of 8 mm are rounded to 4e-3 mm.
constexpr double kHalf = 0.02;  // [mm] over a few terms

TEST(ReducedResponse, MovesTheVerticesOfACoarserSurfaceAlike) {
  FollowingSheet sheet;
  sheet.model.response = sheet.fit();
  Model coarse = sheet.model;
  coarse.surface = flat_surface(50, 20);  // every other vertex
  const std::array<std::size_t, 4> all{0, 1, 2, 3};
  coarse.response = reduced_response(sheet.model, coarse.surface, all);
  EXPECT_NO_THROW(
      check_surface_response(*coarse.response, coarse.surface.vertices.cols(), 4, "it"));
  const geometry::SurfaceQuery query(sheet.model.surface);
  for (std::size_t k = 0; k < sheet.shapes.size(); ++k) {
    const Eigen::Index shape = static_cast<Eigen::Index>(k);
    EXPECT_EQ(coarse.response->shape_contacts[shape], sheet.model.response->shape_contacts[shape]);
    EXPECT_EQ(coarse.response->moves.col(shape), sheet.model.response->moves.col(shape));
  }
  for (Eigen::Index v = 0; v < coarse.surface.vertices.cols(); ++v) {
    Eigen::Index same = 0;
    (sheet.model.surface.vertices.colwise() - coarse.surface.vertices.col(v))
        .colwise()
        .squaredNorm()
        .minCoeff(&same);
    const auto moved = [](const SurfaceResponse& of, Eigen::Index vertex) {
      Eigen::Vector3d sum = Eigen::Vector3d::Zero();
      for (Eigen::Index k = 0; k < 3; ++k) {
        sum += static_cast<double>(of.weights(k, vertex)) *
               of.moves.block<3, 1>(3 * of.nodes(k, vertex), 2).cast<double>();
      }
      return sum;
    };
    EXPECT_LT((moved(*coarse.response, v) - moved(*sheet.model.response, same)).norm(), kHalf);
  }
}

TEST(ReducedResponse, LosesTheShapesOfContactsThatLeave) {
  FollowingSheet sheet;
  sheet.model.response = sheet.fit();
  const std::array<std::size_t, 3> kept{0, 1, 3};
  const SurfaceResponse reduced = reduced_response(sheet.model, sheet.model.surface, kept);
  EXPECT_EQ(reduced.dents.cols(), 3);
  EXPECT_EQ(reduced.responses.col(2), sheet.model.response->responses.col(3));
  ASSERT_EQ(reduced.shape_contacts.size(), 9);
  EXPECT_EQ(reduced.shape_contacts[8], 2);
  EXPECT_EQ(reduced.moves.col(8), sheet.model.response->moves.col(11));
}

}  // namespace
}  // namespace palpate::haptics
