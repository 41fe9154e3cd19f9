// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/geometry/left_out_triangulations.h"

#include <gtest/gtest.h>

#include <array>
#include <set>
#include <vector>

#include "contacts/contact_testing.h"
#include "mesh_corpus.h"
#include "palpate/core/error.h"
#include "refusal.h"
#include "test_surfaces.h"

namespace palpate::geometry {
namespace {

using test::check_manifold;
using test::jittered_grid;
using test::kWeightRounding;
using test::nearest_places;
using test::random_contacts;

template <typename T>
std::vector<T> without(std::vector<T> all, size_t index) {
  all.erase(all.begin() + static_cast<std::ptrdiff_t>(index));
  return all;
}

std::set<std::array<int, 3>> corners_of(const TriangleMesh& mesh) {
  std::set<std::array<int, 3>> corners;
  for (const Eigen::Vector3i t : mesh.triangles.colwise()) corners.insert(test::sorted_corners(t));
  return corners;
}

// In a plane, triangulations do not depend on the order in which vertices are removed.
TEST(LeftOutTriangulations, InAPlaneAreThoseOfTheOthersAlone) {
  const TriangleMesh sheet = test::flat_sheet(46, 36, 1.62);
  const std::vector<Eigen::Vector3d> points = jittered_grid(8, 6, 7.3, 0.4);
  const std::vector<SurfacePoint> contacts = nearest_places(sheet, points);
  const LeftOutTriangulations triangulations(sheet, contacts);
  for (size_t i = 0; i < contacts.size(); ++i) {
    SCOPED_TRACE(i);
    const ContactTriangulation expected = triangulate_contacts(sheet, without(contacts, i));
    const ContactTriangulation found = triangulations.without(i);
    EXPECT_EQ(found.mesh.vertices, expected.mesh.vertices);
    EXPECT_EQ(corners_of(found.mesh), corners_of(expected.mesh));
    EXPECT_EQ(found.isolated, expected.isolated);
    ASSERT_EQ(found.weights.contacts.cols(), sheet.vertices.cols());
    for (Eigen::Index v = 0; v < sheet.vertices.cols(); ++v) {
      Eigen::VectorXd difference = Eigen::VectorXd::Zero(expected.mesh.vertices.cols());
      for (int k = 0; k < 3; ++k) {
        if (found.weights.contacts(k, v) >= 0)
          difference[found.weights.contacts(k, v)] += found.weights.weights(k, v);
        if (expected.weights.contacts(k, v) >= 0)
          difference[expected.weights.contacts(k, v)] -= expected.weights.weights(k, v);
      }
      ASSERT_LT(difference.cwiseAbs().maxCoeff(), kWeightRounding) << "vertex " << v;
    }
  }
}

TEST(LeftOutTriangulations, OfAClosedSurfaceAreClosedAndHaveAllOtherContacts) {
  const TriangleMesh sphere = test::icosphere(4, 30);
  const std::vector<SurfacePoint> contacts = random_contacts(sphere, 40, 3);
  const LeftOutTriangulations triangulations(sphere, contacts);
  for (size_t i = 0; i < contacts.size(); ++i) {
    SCOPED_TRACE(i);
    const ContactTriangulation found = triangulations.without(i);
    const std::vector<SurfacePoint> others = without(contacts, i);
    ASSERT_EQ(found.mesh.vertices.cols(), 39);
    for (size_t k = 0; k < others.size(); ++k)
      EXPECT_EQ(found.mesh.vertices.col(static_cast<Eigen::Index>(k)), position(sphere, others[k]));
    EXPECT_TRUE(found.isolated.empty());
    EXPECT_EQ(check_manifold(found.mesh).euler(), 2);
    EXPECT_LT((found.weights.weights.colwise().sum().array() - 1).abs().maxCoeff(),
              kWeightRounding);
    EXPECT_LT(found.weights.contacts.maxCoeff(), 39);
  }
}

TEST(LeftOutTriangulations, LeaveOutAPartWithoutOtherContacts) {
  TriangleMesh sheets = test::flat_sheet(20, 20, 1);
  const Eigen::Index vertices = sheets.vertices.cols(), triangles = sheets.triangles.cols();
  sheets.vertices.conservativeResize(3, 2 * vertices);
  sheets.vertices.rightCols(vertices) =
      sheets.vertices.leftCols(vertices).colwise() + Eigen::Vector3d(100, 0, 0);
  sheets.triangles.conservativeResize(3, 2 * triangles);
  sheets.triangles.rightCols(triangles) =
      sheets.triangles.leftCols(triangles).array() + static_cast<int>(vertices);
  const std::vector<SurfacePoint> contacts =
      nearest_places(sheets, {{4.2, 5.1, 0}, {109.3, 8.7, 0}, {15.4, 6.3, 0}, {8.6, 14.9, 0}});
  const ContactTriangulation found = LeftOutTriangulations(sheets, contacts).without(1);
  EXPECT_EQ(corners_of(found.mesh), (std::set<std::array<int, 3>>{{0, 1, 2}}));
  EXPECT_GE(found.weights.contacts.leftCols(vertices).row(0).minCoeff(), 0);
  EXPECT_EQ(found.weights.contacts.rightCols(vertices).maxCoeff(), -1);
}

TEST(LeftOutTriangulations, ByTheVoronoiDualAreThoseOfTheOthersAlone) {
  const TriangleMesh sphere = test::icosphere(3, 30);
  const std::vector<SurfacePoint> contacts = random_contacts(sphere, 20, 3);
  const ContactTriangulationOptions dual = {.method = ContactTriangulationMethod::voronoi_dual};
  const ContactTriangulation found = LeftOutTriangulations(sphere, contacts, dual).without(7);
  const ContactTriangulation expected = triangulate_contacts(sphere, without(contacts, 7), dual);
  EXPECT_EQ(found.mesh.triangles, expected.mesh.triangles);
  EXPECT_EQ(found.weights.weights, expected.weights.weights);
}

TEST(LeftOutTriangulations, RefuseTooFewContactsAndOneThatIsNotThere) {
  const TriangleMesh sheet = test::flat_sheet(20, 20, 1);
  std::vector<SurfacePoint> contacts =
      nearest_places(sheet, {{4.2, 5.1, 0}, {15.4, 6.3, 0}, {8.6, 14.9, 0}, {14.6, 14.2, 0}});
  EXPECT_NE(
      refusal([&] { return LeftOutTriangulations(sheet, contacts).without(4); }).find("contact 4"),
      std::string::npos);
  contacts.pop_back();
  EXPECT_NE(refusal([&] {
              return LeftOutTriangulations(sheet, contacts).without(0);
            }).find("got 3 contacts"),
            std::string::npos);
}

}  // namespace
}  // namespace palpate::geometry
