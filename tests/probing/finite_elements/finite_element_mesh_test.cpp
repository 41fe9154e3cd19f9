// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/probing/finite_element_mesh.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <numbers>

#include "palpate/core/error.h"

namespace palpate::probing {
namespace {

using Eigen::Vector3d;
using ::testing::HasSubstr;

FiniteElementMesh small_box() { return box_mesh({0, 1, 3}, {0, 2}, {-1, 0, 1, 4}); }

std::string mesh_refusal(const FiniteElementMesh& mesh) {
  try {
    check_finite_element_mesh(mesh);
  } catch (const InvalidInput& e) {
    return e.what();
  }
  return "";
}

// Twice the flux of the position: three times the volume if faces are closed and turn outwards.
double volume_inside(const FiniteElementMesh& mesh) {
  double sum = 0;
  for (const BoundaryFace& face : boundary_faces(mesh)) {
    const Vector3d a = mesh.nodes.col(face.nodes[0]), b = mesh.nodes.col(face.nodes[1]);
    sum += a.dot(b.cross(Vector3d(mesh.nodes.col(face.nodes[2])))) / 6;
  }
  return sum;
}

TEST(FiniteElementMesh, FillsABox) {
  const FiniteElementMesh mesh = small_box();
  EXPECT_EQ(mesh.elements.cols(), 6 * 2 * 1 * 3);
  EXPECT_EQ(mesh.nodes.cols(), 5 * 3 * 7);
  EXPECT_NEAR(volume(mesh), 3 * 2 * 5, 1e-12);
  EXPECT_NEAR(volume_inside(mesh), 3 * 2 * 5, 1e-12);
  EXPECT_EQ(boundary_faces(mesh).size(), 2u * 2 * (2 * 1 + 2 * 3 + 1 * 3));
  EXPECT_EQ(mesh_refusal(mesh), "");
}

TEST(FiniteElementMesh, FillsABall) {
  const double exact = 4.0 / 3 * std::numbers::pi * 1000;
  const FiniteElementMesh coarse = ball_mesh({1, 2, 30}, 10, 4),
                          fine = ball_mesh({1, 2, 30}, 10, 8);
  EXPECT_EQ(mesh_refusal(coarse), "");
  EXPECT_EQ(mesh_refusal(fine), "");
  // Quadratic faces: the error falls with the fourth power of their size.
  EXPECT_LT(std::abs(volume(coarse) - exact), 0.02 * exact);
  EXPECT_LT(std::abs(volume(fine) - exact), std::abs(volume(coarse) - exact) / 8);
  for (const BoundaryFace& face : boundary_faces(fine))
    for (const int node : face.nodes)
      EXPECT_NEAR((fine.nodes.col(node) - Vector3d(1, 2, 30)).norm(), 10, 1e-12);
}

TEST(FiniteElementMesh, RefusesWhatIsNoMesh) {
  EXPECT_THROW((void)box_mesh({0, 1, 1}, {0, 1}, {0, 1}), InvalidInput);
  EXPECT_THROW((void)box_mesh({0}, {0, 1}, {0, 1}), InvalidInput);
  EXPECT_THROW((void)ball_mesh(Vector3d::Zero(), 10, 3), InvalidInput);
  EXPECT_THROW((void)ball_mesh(Vector3d::Zero(), std::nan(""), 4), InvalidInput);
  FiniteElementMesh mesh = small_box();
  mesh.elements.col(7).head<2>().reverseInPlace();
  EXPECT_THAT(mesh_refusal(mesh), HasSubstr("element 7 is inverted or flat"));
  mesh = small_box();
  mesh.nodes(1, 3) = std::nan("");
  EXPECT_THAT(mesh_refusal(mesh), HasSubstr("node 3 is not finite"));
  mesh = small_box();
  mesh.nodes /= 1000;
  EXPECT_THAT(mesh_refusal(mesh), HasSubstr("it seems to be in metres"));
  mesh = small_box();
  mesh.nodes.conservativeResize(3, mesh.nodes.cols() + 1);
  mesh.nodes.rightCols<1>().setZero();
  EXPECT_THAT(mesh_refusal(mesh), HasSubstr("belongs to no element"));
  EXPECT_THAT(mesh_refusal({}), HasSubstr("has no elements"));
}

}  // namespace
}  // namespace palpate::probing
