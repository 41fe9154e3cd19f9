// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/pictures/draw_displacements.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "picture_test_utils.h"

namespace palpate::pictures {
namespace {

/// Two contacts in the middle of the halves of a square, one of which gives way twice as far.
struct TwoContacts {
  geometry::TriangleMesh surface = make_square({-50, -50, 500}, 100, 8);
  Eigen::Matrix3Xd contacts{{-25, 25}, {0, 0}, {500, 500}};
  Eigen::VectorXd displacements = Eigen::Vector2d(4, 8);
};

cv::Mat3b displacements_picture(const TwoContacts& scene) {
  return draw_picture([&](const std::filesystem::path& png) {
    draw_displacements(png, scene.surface, scene.contacts, scene.displacements, "Displacements");
  });
}

/// The bluish pixels of the left or the right half of the picture.
cv::Mat1b circle(const cv::Mat3b& picture, bool right) {
  cv::Mat1b bluish(600, 560);
  const int left = right ? 610 : 30;
  for (int y = 0; y < bluish.rows; ++y) {
    for (int x = 0; x < bluish.cols; ++x) {
      const Rgb color = pixel(picture, left + x, 120 + y);
      bluish(y, x) = color[2] > color[0] + 60 ? 255 : 0;
    }
  }
  return bluish;
}

/// px
int circle_height(const cv::Mat3b& picture, bool right) {
  return box_of(circle(picture, right)).height;
}

TEST(DrawDisplacements, DiametersAreProportionalToTheDisplacements) {
  const cv::Mat3b picture = displacements_picture({});
  EXPECT_EQ(picture.size(), cv::Size(1200, 900));
  const int small = circle_height(picture, false), large = circle_height(picture, true);
  ASSERT_GT(small, 20);
  EXPECT_NEAR(large, 2 * small, 4);
}

TEST(DrawDisplacements, ASlopeHidesNoPartOfACircle) {
  TwoContacts scene;
  scene.surface.vertices.row(2) -= 1.5 * scene.surface.vertices.row(1);
  scene.displacements << 8, 6;
  const cv::Mat1b shown = circle(displacements_picture(scene), true);
  const cv::Rect box = box_of(shown);
  EXPECT_NEAR(box.width, box.height, 2);
  EXPECT_NEAR(cv::countNonZero(shown) / (box.width * 1.0 * box.height), std::numbers::pi / 4, 0.02);
}

TEST(DrawDisplacements, ContactsWithoutADisplacementHaveNoCircle) {
  TwoContacts scene;
  for (const double none : {std::nan(""), 0.0, -1.0}) {
    scene.displacements(0) = none;
    EXPECT_EQ(circle_height(displacements_picture(scene), false), 0);
  }
}

TEST(DrawDisplacements, DrawsASingleContact) {
  TwoContacts scene;
  scene.contacts = Eigen::Vector3d(25, 0, 500);
  scene.displacements = Eigen::VectorXd::Constant(1, 3.0);
  EXPECT_GT(circle_height(displacements_picture(scene), true), 20);
}

TEST(DrawDisplacements, RefusesInputThatDoesNotFit) {
  TwoContacts scene;
  const auto attempt = [&scene](const std::filesystem::path& png) {
    draw_displacements(png, scene.surface, scene.contacts, scene.displacements, "");
  };
  scene.displacements.setConstant(-1);
  expect_refused(attempt, "displacements: none is finite and above zero");
  scene.displacements.resize(3);
  expect_refused(attempt, "displacements: has 3 entries where 2 are needed");
  scene.contacts(1, 1) = std::nan("");
  expect_refused(attempt, "contacts: a contact is not finite");
  scene.contacts.resize(3, 0);
  expect_refused(attempt, "contacts: is empty");
}

TEST(DrawDisplacements, SaysWhenItCannotWrite) {
  expect_unwritable([](const std::filesystem::path& png) {
    const TwoContacts scene;
    draw_displacements(png, scene.surface, scene.contacts, scene.displacements, "");
  });
}

}  // namespace
}  // namespace palpate::pictures
