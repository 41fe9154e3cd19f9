// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "picture_test_utils.h"

#include <gtest/gtest.h>
#include <stdlib.h>

#include <algorithm>
#include <cmath>
#include <opencv2/core.hpp>

#include "palpate/core/error.h"
#include "palpate/sensing/frame.h"

#ifdef __SANITIZE_ADDRESS__
#include <sanitizer/lsan_interface.h>
#endif

namespace palpate::pictures {
namespace {

/// No test may depend on the desktop that it runs on, or show up there.
class NoDesktop : public ::testing::Environment {
 public:
  void SetUp() override {
    unsetenv("DISPLAY");
#ifdef __SANITIZE_ADDRESS__
    // Mesa loads its driver for each connection and forgets some 200 bytes when it unloads it; what
    // is unloaded has no name any more by which it could be suppressed.
    __lsan_disable();
#endif
  }
};

const ::testing::Environment* const kNoDesktop = ::testing::AddGlobalTestEnvironment(new NoDesktop);

}  // namespace

cv::Mat3b draw_picture(const std::function<void(const std::filesystem::path&)>& draw) {
  const ScratchFolder folder;
  const std::filesystem::path png = folder / "picture.png";
  ::testing::internal::CaptureStderr();
  try {
    draw(png);
  } catch (const Error& error) {
    ADD_FAILURE() << error.what();
  }
  EXPECT_EQ(::testing::internal::GetCapturedStderr(), "") << "a library does not print";
  const cv::Mat3b bgr = sensing::read_frame(png);
  EXPECT_FALSE(bgr.empty());
  cv::Mat3b rgb(bgr.size());
  std::transform(bgr.begin(), bgr.end(), rgb.begin(),
                 [](const cv::Vec3b& color) { return cv::Vec3b(color[2], color[1], color[0]); });
  return rgb;
}

void expect_same_again(const std::function<void(const std::filesystem::path&)>& draw) {
  const ScratchFolder folder;
  draw(folder / "one.png");
  draw(folder / "other.png");
  EXPECT_GT(read_text(folder / "one.png").size(), 1000U);
  EXPECT_TRUE(read_text(folder / "one.png") == read_text(folder / "other.png"));
}

void expect_refused(const std::function<void(const std::filesystem::path&)>& draw,
                    const std::string& words) {
  const ScratchFolder folder;
  try {
    draw(folder / "refused.png");
    ADD_FAILURE() << "nothing thrown where '" << words << "' was expected";
  } catch (const InvalidInput& error) {
    EXPECT_NE(std::string(error.what()).find(words), std::string::npos) << error.what();
  }
  EXPECT_TRUE(folder.entries() == 0);
}

void expect_unwritable(const std::function<void(const std::filesystem::path&)>& draw) {
  const ScratchFolder folder;
  write_text(folder / "file", "not a folder");
  EXPECT_THROW(draw(folder / "file" / "picture.png"), OutputError);
  EXPECT_EQ(read_text(folder / "file"), "not a folder");
}

Rgb pixel(const cv::Mat3b& picture, int x, int y) {
  const cv::Vec3b& color = picture(y, x);
  return {color[0], color[1], color[2]};
}

int color_distance(const Rgb& one, const Rgb& other) {
  int distance = 0;
  for (std::size_t channel = 0; channel < one.size(); ++channel) {
    distance = std::max(distance, std::abs(one[channel] - other[channel]));
  }
  return distance;
}

cv::Mat1b mask_of(const cv::Mat3b& picture, const Rgb& color, int tolerance, const Region& region) {
  cv::Mat1b mask(region.size());
  for (int y = 0; y < region.height; ++y) {
    for (int x = 0; x < region.width; ++x) {
      const Rgb here = pixel(picture, region.x + x, region.y + y);
      mask(y, x) = color_distance(here, color) < tolerance ? 255 : 0;
    }
  }
  return mask;
}

Eigen::Vector2d center_of(const cv::Mat1b& mask) {
  Eigen::Vector2d sum = Eigen::Vector2d::Zero();
  for (int y = 0; y < mask.rows; ++y) {
    for (int x = 0; x < mask.cols; ++x) {
      sum += mask(y, x) != 0 ? Eigen::Vector2d(x, y) : Eigen::Vector2d::Zero();
    }
  }
  return sum / cv::countNonZero(mask);
}

Region box_of(const cv::Mat1b& mask) {
  std::vector<cv::Point> places;
  cv::findNonZero(mask, places);
  if (places.empty()) return {};
  cv::Point low = places.front();
  cv::Point high = places.front();
  for (const cv::Point& place : places) {
    low = {std::min(low.x, place.x), std::min(low.y, place.y)};
    high = {std::max(high.x, place.x), std::max(high.y, place.y)};
  }
  return {low, high + cv::Point(1, 1)};
}

geometry::TriangleMesh make_square(const Eigen::Vector3d& corner, double size, int cells) {
  geometry::TriangleMesh mesh;
  mesh.vertices.resize(3, (cells + 1) * (cells + 1));
  mesh.triangles.resize(3, 2 * cells * cells);
  Eigen::Index next = 0;
  for (int row = 0; row <= cells; ++row) {
    for (int col = 0; col <= cells; ++col) {
      const int vertex = row * (cells + 1) + col;
      mesh.vertices.col(vertex) = corner + size / cells * Eigen::Vector3d(col, row, 0);
      if (row < cells && col < cells) {
        mesh.triangles.col(next++) << vertex, vertex + cells + 1, vertex + 1;
        mesh.triangles.col(next++) << vertex + 1, vertex + cells + 1, vertex + cells + 2;
      }
    }
  }
  return mesh;
}

geometry::TriangleMesh join(const geometry::TriangleMesh& one,
                            const geometry::TriangleMesh& other) {
  geometry::TriangleMesh both;
  both.vertices.resize(3, one.vertices.cols() + other.vertices.cols());
  both.vertices << one.vertices, other.vertices;
  both.triangles.resize(3, one.triangles.cols() + other.triangles.cols());
  both.triangles << one.triangles, other.triangles.array() + static_cast<int>(one.vertices.cols());
  return both;
}

}  // namespace palpate::pictures
