// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/pictures/draw_mesh.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "picture_test_utils.h"

namespace palpate::pictures {
namespace {

constexpr double kTurn = 25 * std::numbers::pi / 180;  // [rad] of the view, as documented

/// Between the title and what stands in the lower corners.
const Region kMeshScene(0, 90, 1200, 690);

cv::Mat3b mesh_picture(const geometry::TriangleMesh& mesh) {
  return draw_picture([&](const std::filesystem::path& png) { draw_mesh(png, mesh, "A mesh"); });
}

/// Everything in the scene that is not paper.
cv::Mat1b shape_of(const cv::Mat3b& picture) {
  const cv::Mat1b paper = mask_of(picture, {255, 255, 255}, 12, kMeshScene);
  cv::Mat1b shape;
  cv::bitwise_not(paper, shape);
  return shape;
}

/// [px] from the first to the last column that the mask reaches.
int width_of(const cv::Mat1b& mask) {
  int first = mask.cols;
  int last = -1;
  for (int x = 0; x < mask.cols; ++x) {
    if (cv::countNonZero(mask.col(x)) > 0) {
      first = std::min(first, x);
      last = x;
    }
  }
  return last - first + 1;
}

TEST(DrawMesh, GivesAPictureOfTheStatedSizeThatTheMeshFills) {
  const cv::Mat3b picture = mesh_picture(make_square({-50, -50, 700}, 100, 4));
  EXPECT_EQ(picture.size(), cv::Size(1200, 900));
  EXPECT_GT(cv::countNonZero(shape_of(picture)), kMeshScene.area() / 4);
}

TEST(DrawMesh, ShowsXToTheRightAndYDown) {
  // A large square, and a small one that makes the view wide without moving the centre of mass
  // much.
  const geometry::TriangleMesh large = make_square({-120, -90, 700}, 80, 4);
  const geometry::TriangleMesh small = make_square({110, 80, 700}, 10, 1);
  const Eigen::Vector2d upper_left = center_of(shape_of(mesh_picture(join(large, small))));
  EXPECT_LT(upper_left.x(), 0.4 * kMeshScene.width);
  EXPECT_LT(upper_left.y(), 0.45 * kMeshScene.height);
}

TEST(DrawMesh, ShowsASurfaceThatFacesZFromThereWithYUp) {
  geometry::TriangleMesh mesh =
      join(make_square({-120, -90, 700}, 80, 4), make_square({110, 80, 700}, 10, 1));
  mesh.triangles.row(1).swap(mesh.triangles.row(2));
  const Eigen::Vector2d lower_left = center_of(shape_of(mesh_picture(mesh)));
  EXPECT_LT(lower_left.x(), 0.4 * kMeshScene.width);
  EXPECT_GT(lower_left.y(), 0.55 * kMeshScene.height);
}

TEST(DrawMesh, LeavesRoomForBarAndAxes) {
  // As high as the view permits.
  geometry::TriangleMesh tall = make_square({-50, -50, 700}, 100, 4);
  tall.vertices.row(1) *= 20;
  const cv::Mat3b picture = mesh_picture(tall);
  const Region footer(200, 802, 800, 98);  // between bar and axes
  EXPECT_EQ(cv::countNonZero(mask_of(picture, {255, 255, 255}, 12, footer)), footer.area());
  EXPECT_GT(box_of(shape_of(picture)).height, 600);
}

TEST(DrawMesh, FitsAnObjectBeforeAWall) {
  const geometry::TriangleMesh object = make_square({-20, -20, 700}, 40, 8);
  const geometry::TriangleMesh wall = make_square({-200, -150, 900}, 400, 60);
  const auto width = [](const geometry::TriangleMesh& mesh, MeshPart part) {
    return width_of(shape_of(draw_picture(
        [&](const std::filesystem::path& png) { draw_mesh(png, mesh, "Before a wall", part); })));
  };
  const int alone = width(object, MeshPart::whole);
  EXPECT_EQ(width(join(object, wall), MeshPart::object), alone);
  EXPECT_GT(alone, 500);
  // A mesh without a background is shown as a whole.
  EXPECT_EQ(width(object, MeshPart::object), alone);
}

TEST(DrawMesh, ScaleBarHoldsForTheMesh) {
  const cv::Mat3b picture = mesh_picture(make_square({-50, -50, 700}, 100, 4));
  // The bar is the longest run of black in the lower left corner; the bar of a mesh of 100 mm is 20
  // mm.
  int bar = 0;
  for (int y = 850; y < 890; ++y) {
    bar = std::max(bar, cv::countNonZero(mask_of(picture, kBlack, 60, {10, y, 400, 1})));
  }
  const double px_per_mm = width_of(shape_of(picture)) / (100 * std::cos(kTurn));
  EXPECT_NEAR(bar, 20 * px_per_mm, 4) << "px: line width and antialiasing at four ends";
}

TEST(DrawMesh, ShadesByDirection) {
  // A roof: two planes that meet in a level ridge. The light comes from above.
  geometry::TriangleMesh roof;
  roof.vertices.resize(3, 6);
  roof.vertices << -50, -50, -50, 50, 50, 50,  //
      -50, 0, 50, -50, 0, 50,                  //
      740, 700, 740, 740, 700, 740;
  roof.triangles.resize(3, 4);
  roof.triangles << 0, 3, 1, 4,  //
      1, 1, 2, 2,                //
      3, 4, 4, 5;
  const cv::Mat3b picture = mesh_picture(roof);
  const Rgb upper = pixel(picture, 600, 300);
  const Rgb lower = pixel(picture, 600, 700);
  EXPECT_GT(upper[0], lower[0] + 40);
}

TEST(DrawMesh, DoesNotDependOnThePlace) {
  const geometry::TriangleMesh near = make_square({-50, -50, 700}, 100, 4);
  geometry::TriangleMesh far = near;
  far.vertices.colwise() += Eigen::Vector3d(1e6, -2e6, 5e5);
  const cv::Mat1b one = shape_of(mesh_picture(near));
  const cv::Mat1b other = shape_of(mesh_picture(far));
  cv::Mat1b difference;
  cv::absdiff(one, other, difference);
  EXPECT_LT(cv::countNonZero(difference), 3000) << "px: a rim of one pixel";
}

TEST(DrawMesh, LeavesOutVerticesThatNoTriangleUses) {
  const geometry::TriangleMesh square = make_square({-50, -50, 700}, 100, 4);
  geometry::TriangleMesh with_unused = square;
  with_unused.vertices.conservativeResize(3, square.vertices.cols() + 2);
  with_unused.vertices.rightCols(2) << std::nan(""), 9e5, std::nan(""), 9e5, std::nan(""), -9e9;
  cv::Mat1b difference;
  cv::absdiff(shape_of(mesh_picture(square)), shape_of(mesh_picture(with_unused)), difference);
  EXPECT_EQ(cv::countNonZero(difference), 0) << "px";
}

TEST(DrawMesh, RefusesBadMeshes) {
  geometry::TriangleMesh mesh;
  const auto attempt = [&mesh](const std::filesystem::path& png) { draw_mesh(png, mesh, ""); };
  expect_refused(attempt, "mesh: has no triangle");
  mesh = make_square({0, 0, 700}, 1, 1);
  mesh.triangles(2, 1) = 4;
  expect_refused(attempt, "triangle 1 names vertex 4");
  mesh.triangles(2, 1) = -1;
  expect_refused(attempt, "triangle 1 names vertex -1");
  mesh = make_square({0, 0, 700}, 1, 1);
  mesh.vertices(1, 3) = std::nan("");
  expect_refused(attempt, "vertex 3, which is not finite");
}

TEST(DrawMesh, GivesTheSameBytesAgain) {
  expect_same_again([](const std::filesystem::path& png) {
    draw_mesh(png, make_square({-50, -50, 700}, 100, 40), "Again");
  });
}

TEST(DrawMesh, SaysWhenItCannotWrite) {
  expect_unwritable([](const std::filesystem::path& png) {
    draw_mesh(png, make_square({0, 0, 700}, 1, 1), "");
  });
}

}  // namespace
}  // namespace palpate::pictures
