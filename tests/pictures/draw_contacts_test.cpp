// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/pictures/draw_contacts.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "picture_test_utils.h"

namespace palpate::pictures {
namespace {

/// A square whose left half belongs to contact 0 and right half to contact 1.
struct Scene {
  geometry::TriangleMesh surface = make_square({-50, -50, 700}, 100, 20);
  Eigen::VectorXi labels;
  geometry::TriangleMesh contacts;
  std::vector<long long> ids = {0, 1, 2};

  Scene() {
    labels = (surface.vertices.row(0).array() > 0).cast<int>().transpose();
    contacts.vertices.resize(3, 3);
    contacts.vertices << -30, 30, 0,  //
        -20, -20, 40,                 //
        700, 700, 700;
    contacts.triangles.resize(3, 1);
    contacts.triangles << 0, 1, 2;
  }
};

cv::Mat3b contacts_picture(const Scene& scene) {
  return draw_picture([&](const std::filesystem::path& png) {
    draw_contacts(png, scene.surface, scene.labels, scene.contacts, scene.ids, "Contacts");
  });
}

/// The picture of the scene as it is, drawn once for all tests.
const cv::Mat3b& plain_picture() {
  static const cv::Mat3b picture = contacts_picture({});
  return picture;
}

/// Two places of the surface without edges, contacts or numbers, in the left and in the right half.
Rgb left_color(const cv::Mat3b& picture) { return pixel(picture, 350, 700); }
Rgb right_color(const cv::Mat3b& picture) { return pixel(picture, 850, 700); }

int black_pixels(const cv::Mat3b& picture) {
  return cv::countNonZero(mask_of(picture, {25, 25, 25}, 40, {0, 100, 1200, 690}));
}

TEST(DrawContacts, GivesNeighbouringCellsDifferentColours) {
  EXPECT_EQ(plain_picture().size(), cv::Size(1200, 900));
  EXPECT_GT(color_distance(left_color(plain_picture()), right_color(plain_picture())), 60);
}

TEST(DrawContacts, ColoursFollowTheLabels) {
  const Rgb right = right_color(plain_picture());
  Scene scene;
  scene.labels = 1 - scene.labels.array();
  EXPECT_LE(color_distance(left_color(contacts_picture(scene)), right), 12) << "but for the light";
}

TEST(DrawContacts, ShowsVerticesWithoutCellInGrey) {
  Scene scene;
  scene.labels = (scene.labels.array() == 0).select(-1, scene.labels);
  const Rgb none = left_color(contacts_picture(scene));
  EXPECT_LE(std::abs(none[0] - none[1]), 3);
  EXPECT_LE(std::abs(none[1] - none[2]), 3);
  EXPECT_LT(none[0], 240) << "not the colour of the paper";
}

TEST(DrawContacts, DrawsEdgesAboveASurfaceThatBulges) {
  const int on_flat = black_pixels(plain_picture());
  Scene scene;
  for (auto vertex : scene.surface.vertices.colwise()) {
    vertex.z() -= 5 * std::cos(vertex.x() / 50) * std::cos(vertex.y() / 50);
  }
  EXPECT_GT(black_pixels(contacts_picture(scene)), 0.95 * on_flat);
  scene.contacts.triangles.resize(3, 0);
  EXPECT_LT(black_pixels(contacts_picture(scene)), 0.8 * on_flat) << "the edges are missing";
}

TEST(DrawContacts, MarksEachContactWhereItIs) {
  Scene scene;
  scene.contacts.triangles.resize(3, 0);
  scene.contacts.vertices.col(0) << -30, -20, 700;
  scene.contacts.vertices.col(1) << -30, -20.5, 700;
  scene.contacts.vertices.col(2) << -29.5, -20, 700;
  const cv::Mat1b marks = mask_of(contacts_picture(scene), {25, 25, 25}, 40, {0, 100, 1200, 690});
  const Eigen::Vector2d center = center_of(marks);
  EXPECT_LT(center.x(), 0.42 * marks.cols);
  EXPECT_LT(center.y(), 0.45 * marks.rows);
}

TEST(DrawContacts, HidesWhatIsBehind) {
  const Rgb left = left_color(plain_picture());
  Scene scene;
  const geometry::TriangleMesh behind = make_square({-50, -50, 760}, 100, 2);
  scene.labels.conservativeResize(scene.labels.size() + behind.vertices.cols());
  scene.labels.tail(behind.vertices.cols()).setConstant(2);
  // With its triangles last, so that being drawn later does not decide.
  scene.surface = join(scene.surface, behind);
  const cv::Mat3b picture = contacts_picture(scene);
  const cv::Mat1b front = mask_of(picture, left, 14, {0, 100, 1200, 690});
  EXPECT_GT(cv::countNonZero(front), 80000);
}

TEST(DrawContacts, NumbersContactsByTheirIds) {
  Scene scene;
  const cv::Mat3b before = contacts_picture(scene);
  scene.ids[1] = 47;
  const cv::Mat3b after = contacts_picture(scene);
  int left = before.cols, right = 0, top = before.rows, bottom = 0;
  for (int y = 0; y < before.rows; ++y) {
    for (int x = 0; x < before.cols; ++x) {
      if (before(y, x) == after(y, x)) continue;
      left = std::min(left, x), right = std::max(right, x);
      top = std::min(top, y), bottom = std::max(bottom, y);
    }
  }
  // Nothing but this number has changed.
  ASSERT_LT(left, right);
  EXPECT_LT(right - left, 30);
  EXPECT_LT(bottom - top, 20);
}

TEST(DrawContacts, RefusesInputThatDoesNotFit) {
  Scene scene;
  const auto attempt = [&scene](const std::filesystem::path& png) {
    draw_contacts(png, scene.surface, scene.labels, scene.contacts, scene.ids, "");
  };
  scene.labels(7) = 3;
  expect_refused(attempt, "labels: vertex 7 has 3");
  scene.labels(7) = -2;
  expect_refused(attempt, "labels: vertex 7 has -2");
  scene.labels.conservativeResize(scene.labels.size() - 1);
  expect_refused(attempt, "labels: has 440 entries where 441 are needed");
  scene = {};
  scene.contacts.triangles(0, 0) = 3;
  expect_refused(attempt, "contact mesh: triangle 0 names vertex 3");
  scene.contacts = {};
  expect_refused(attempt, "contact mesh: has no contact");
  scene = {};
  scene.contacts.vertices(0, 2) = std::nan("");
  expect_refused(attempt, "contact mesh: a contact is not finite");
  scene = {};
  scene.surface.triangles.resize(3, 0);
  expect_refused(attempt, "surface: has no triangle");
}

TEST(DrawContacts, GivesTheSameBytesAgain) {
  expect_same_again([](const std::filesystem::path& png) {
    const Scene scene;
    draw_contacts(png, scene.surface, scene.labels, scene.contacts, scene.ids, "Again");
  });
}

TEST(DrawContacts, SaysWhenItCannotWrite) {
  expect_unwritable([](const std::filesystem::path& png) {
    const Scene scene;
    draw_contacts(png, scene.surface, scene.labels, scene.contacts, scene.ids, "");
  });
}

}  // namespace
}  // namespace palpate::pictures
