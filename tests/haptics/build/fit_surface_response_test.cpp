// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/haptics/fit_surface_response.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <limits>

#include "following_surface.h"
#include "not_finite.h"
#include "palpate/haptics/blended_field.h"
#include "palpate/haptics/deformed_shape.h"
#include "refusal.h"

namespace palpate::haptics {
namespace {

using ::testing::HasSubstr;

Eigen::Matrix3Xd shown(const Model& model, const SurfaceResponse& response,
                       const Eigen::Vector3d& place, const Eigen::Vector3d& displacement) {
  const BlendedField field(model);
  const geometry::SurfacePoint at = field.surface().closest_point(place).at;
  return measured_shape(model.surface, response, field.weights(at), at, displacement);
}

double rms(const Eigen::Matrix3Xd& a, const Eigen::Matrix3Xd& b) {
  return std::sqrt((a - b).colwise().squaredNorm().mean());
}

TEST(FitSurfaceResponse, ShowsPlacesBetweenContactsBetterThanTheNearestShapeAndADrawnDent) {
  const FollowingSheet sheet;
  const SurfaceResponse response = sheet.fit();
  double ours = 0, nearest = 0, drawn = 0;
  for (const Eigen::Vector3d& place : {Eigen::Vector3d(-12, 5, 700), Eigen::Vector3d(20, -25, 700),
                                       Eigen::Vector3d(0, 0, 700), Eigen::Vector3d(28, 30, 700)}) {
    const Eigen::Vector3d displacement(1, -1, 4);
    const Eigen::Matrix3Xd truth = true_shape(sheet.model.surface, place, displacement);
    const auto near = std::ranges::min_element(sheet.shapes, {}, [&](const RecordedShape& shape) {
      return (sheet.model.contacts[shape.contact].position + shape.displacement - place -
              displacement)
          .norm();
    });
    ours += rms(shown(sheet.model, response, place, displacement), truth);
    nearest += rms(near->vertices, truth);
    const BlendedField field(sheet.model);
    drawn +=
        rms(drawn_shape(sheet.model.surface, field.surface().closest_point(place).at, displacement),
            truth);
  }
  EXPECT_LT(ours, 0.3 * nearest);
  EXPECT_LT(ours, 0.5 * drawn);
}

TEST(FitSurfaceResponse, StatesTheErrorsOfItsShapes) {
  const FollowingSheet sheet;
  const SurfaceResponse response = sheet.fit();
  double squares = 0, largest = 0;
  for (const RecordedShape& shape : sheet.shapes) {
    const Eigen::Matrix3Xd error =
        shown(sheet.model, response, sheet.model.contacts[shape.contact].position,
              shape.displacement) -
        shape.vertices;
    squares += error.colwise().squaredNorm().mean();
    largest = std::max(largest, error.colwise().norm().maxCoeff());
  }
  EXPECT_NEAR(response.rms, std::sqrt(squares / static_cast<double>(sheet.shapes.size())), 1e-12);
  EXPECT_NEAR(response.largest, largest, 1e-12);
  EXPECT_EQ(response.shape_contacts.size(), 12);
  EXPECT_LT(response.rms, 0.15);  // of displacements of 5 to 8 mm
  // More nodes follow the shapes more closely.
  EXPECT_LT(response.rms, sheet.fit({.nodes = 20}).rms);
}

TEST(FitSurfaceResponse, KeepsTheShapesAndStatesHowWell) {
  const FollowingSheet sheet;
  const SurfaceResponse response = sheet.fit();
  const BlendedField field(sheet.model);
  double squares = 0, largest = 0;
  for (std::size_t k = 0; k < sheet.shapes.size(); ++k) {
    const Eigen::Vector3d& place = sheet.model.contacts[sheet.shapes[k].contact].position;
    const Eigen::Matrix3Xd error =
        recorded_shape(sheet.model.surface, response, field.surface().closest_point(place).at,
                       static_cast<Eigen::Index>(k)) -
        sheet.shapes[k].vertices;
    squares += error.colwise().squaredNorm().mean();
    largest = std::max(largest, error.colwise().norm().maxCoeff());
  }
  EXPECT_NEAR(response.kept_rms, std::sqrt(squares / static_cast<double>(sheet.shapes.size())),
              1e-12);
  EXPECT_NEAR(response.kept_largest, largest, 1e-12);
  EXPECT_LT(response.kept_rms, 0.15);  // of displacements of 5 to 8 mm
}

TEST(FitSurfaceResponse, DoesNotDependOnTheOrderOfShapes) {
  FollowingSheet sheet;
  const SurfaceResponse forwards = sheet.fit();
  std::reverse(sheet.shapes.begin(), sheet.shapes.end());
  const SurfaceResponse backwards = sheet.fit();
  EXPECT_NEAR(forwards.rms, backwards.rms, 1e-6);
  EXPECT_LT((forwards.responses.cast<double>() - backwards.responses.cast<double>())
                .cwiseAbs()
                .maxCoeff(),
            2e-3);
}

// If a contact was only pressed, it follows sideways as far as it follows inwards.
TEST(FitSurfaceResponse, TakesDirectionsThatWereNotDisplacedLikeTheOthers) {
  FollowingSheet sheet;
  std::erase_if(sheet.shapes,
                [](const RecordedShape& shape) { return shape.displacement.x() != 0; });
  const SurfaceResponse response = sheet.fit();
  const Eigen::Vector3d place = sheet.model.contacts[0].position;
  EXPECT_LT(rms(shown(sheet.model, response, place, {3, 0, 0}),
                true_shape(sheet.model.surface, place, {3, 0, 0})),
            0.05);
}

TEST(FitSurfaceResponse, RefusesShapesOfAnotherSurface) {
  FollowingSheet sheet;
  sheet.shapes[4].vertices.conservativeResize(3, 10);
  EXPECT_THAT(refusal([&] { return sheet.fit(); }), HasSubstr("shape 4 has 10 vertices"));
  sheet = {};
  sheet.shapes[2].contact = 9;
  EXPECT_THAT(refusal([&] { return sheet.fit(); }), HasSubstr("shape 2 is of contact 9"));
  sheet = {};
  sheet.shapes[3].vertices(1, 7) = kNaN;
  EXPECT_THAT(refusal([&] { return sheet.fit(); }), HasSubstr("shape 3"));
  for (RecordedShape& shape : (sheet = {}).shapes) shape.displacement.setZero();
  EXPECT_THAT(refusal([&] { return sheet.fit(); }), HasSubstr("is displaced"));
  sheet.shapes.clear();
  EXPECT_THAT(refusal([&] { return sheet.fit(); }), HasSubstr("no recorded shape"));
  EXPECT_THAT(refusal([&] { return FollowingSheet().fit({.nodes = 70000}); }), HasSubstr("nodes"));
}

}  // namespace
}  // namespace palpate::haptics
