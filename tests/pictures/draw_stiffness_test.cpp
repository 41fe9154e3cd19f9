// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/pictures/draw_stiffness.h"

#include <gtest/gtest.h>

#include <cmath>

#include "picture_test_utils.h"

namespace palpate::pictures {
namespace {

/// Left of the scale, above the scale bar and the axes.
const Region kStiffnessScene(0, 90, 1000, 690);

/// A square whose left half is soft and right half stiff, with a contact and a line between them.
struct Halves {
  geometry::TriangleMesh surface = make_square({-50, -50, 700}, 100, 20);
  StiffnessPicture picture;

  Halves() {
    picture.stiffness =
        (surface.vertices.row(0).array() > 0)
            .select(0.3, Eigen::RowVectorXd::Constant(surface.vertices.cols(), 0.1));
    picture.contacts = Eigen::Vector3d(-25, 0, 700);
    picture.contour.resize(3, 2);
    picture.contour << 0, 0, -50, 50, 700, 700;
    picture.title = "Stiffness";
  }
};

cv::Mat3b stiffness_picture(const Halves& scene) {
  return draw_picture(
      [&](const std::filesystem::path& png) { draw_stiffness(png, scene.surface, scene.picture); });
}

TEST(DrawStiffness, ColoursSoftDarkAndStiffLight) {
  const cv::Mat3b picture = stiffness_picture({});
  EXPECT_EQ(picture.size(), cv::Size(1200, 900));
  EXPECT_LE(color_distance(pixel(picture, 350, 650), color_at(ColorMap::sequential, 0)), 40);
  EXPECT_LE(color_distance(pixel(picture, 700, 650), color_at(ColorMap::sequential, 1)), 40);
}

TEST(DrawStiffness, LeavesUnknownPlacesGrey) {
  Halves scene;
  scene.picture.stiffness.head(scene.picture.stiffness.size() / 2).setConstant(std::nan(""));
  EXPECT_GT(cv::countNonZero(mask_of(stiffness_picture(scene), kUnknownColor, 30, kStiffnessScene)),
            kStiffnessScene.area() / 10);
}

TEST(DrawStiffness, DrawsTheContourAndTheContacts) {
  Halves scene;
  const cv::Mat1b line = mask_of(stiffness_picture(scene), kVermilion, 40, kStiffnessScene);
  EXPECT_GT(box_of(line).height, 300);
  EXPECT_LT(box_of(line).width, 150);
  scene.picture.contour.resize(3, 0);
  EXPECT_EQ(cv::countNonZero(mask_of(stiffness_picture(scene), kVermilion, 40, kStiffnessScene)),
            0);
}

TEST(DrawStiffness, RefusesWhatCannotBeShown) {
  Halves scene;
  const auto attempt = [&](const std::filesystem::path& png) {
    draw_stiffness(png, scene.surface, scene.picture);
  };
  scene.picture.contour.resize(3, 1);
  scene.picture.contour.setZero();
  expect_refused(attempt, "contour");
  scene.picture.contour.resize(3, 0);
  scene.picture.contacts.setConstant(std::nan(""));
  expect_refused(attempt, "contacts");
  scene.picture.contacts.setZero();
  scene.picture.stiffness.setConstant(std::nan(""));
  expect_refused(attempt, "stiffness: holds no finite value");
  scene.picture.stiffness.resize(2);
  expect_refused(attempt, "stiffness");
}

TEST(DrawStiffness, GivesTheSameBytesAgain) {
  expect_same_again([](const std::filesystem::path& png) {
    const Halves scene;
    draw_stiffness(png, scene.surface, scene.picture);
  });
}

TEST(DrawStiffness, SaysWhenItCannotWrite) {
  expect_unwritable([](const std::filesystem::path& png) {
    const Halves scene;
    draw_stiffness(png, scene.surface, scene.picture);
  });
}

}  // namespace
}  // namespace palpate::pictures
