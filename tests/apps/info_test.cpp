// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
// Sizes in the output of `palpate info`, for any unit of a file.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <nlohmann/json.hpp>
#include <numbers>
#include <opencv2/core.hpp>
#include <string>

#include "palpate/geometry/range_map.h"
#include "palpate/sensing/frame.h"
#include "run_palpate.h"

namespace palpate::apps {
namespace {

namespace fs = std::filesystem;
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

class Info : public ::testing::Test {
 protected:
  /// A tetrahedron with three edges of length `size` along the axes.
  std::string described(double size, bool outwards = true) {
    const std::string s = std::to_string(size);
    std::string text = "v 0 0 0\nv " + s + " 0 0\nv 0 " + s + " 0\nv 0 0 " + s + "\n";
    for (const char* face : {"1 3 2", "1 2 4", "1 4 3", "2 3 4"}) {
      std::string corners = face;
      if (!outwards) std::swap(corners[2], corners[4]);
      text += "f " + corners + "\n";
    }
    write_text(scratch / "solid.obj", text);
    const CommandResult result = run_palpate({"info", scratch / "solid.obj"});
    EXPECT_EQ(result.status, kDone) << result.err;
    return result.out;
  }

  ScratchFolder scratch;
};

TEST_F(Info, TellsTheSizeOfSmallSurfacesToo) {
  EXPECT_THAT(described(60), AllOf(HasSubstr("X 0.0 to 60.0, Y 0.0 to 60.0, Z 0.0 to 60.0 mm"),
                                   HasSubstr("volume 36000.0 mm^3")));
  // The sizes of a file in metres that is read as mm. 0.012^3 / 6 = 2.88e-07.
  EXPECT_THAT(described(0.012), AllOf(HasSubstr("X 0.0000 to 0.0120, Y 0.0000 to 0.0120"),
                                      HasSubstr("volume 2.88e-07 mm^3")));
}

TEST_F(Info, TellsThatASolidIsInsideOut) {
  EXPECT_THAT(described(6), AllOf(HasSubstr("volume 36 mm^3"), Not(HasSubstr("inwards"))));
  EXPECT_THAT(described(6, false), HasSubstr("volume -36 mm^3, as the triangles face inwards"));
}

TEST_F(Info, TellsTheCurvatureOfATube) {
  // Radius 10 mm, 48 triangles around: the larger principal curvature is 1 / 10 mm.
  constexpr int kAround = 48, kRings = 12;
  std::string text;
  for (int ring = 0; ring < kRings; ++ring) {
    for (int i = 0; i < kAround; ++i) {
      const double angle = 2 * std::numbers::pi * i / kAround;
      text += "v " + std::to_string(10 * std::cos(angle)) + " " +
              std::to_string(10 * std::sin(angle)) + " " + std::to_string(1.3 * ring) + "\n";
    }
  }
  for (int ring = 0; ring + 1 < kRings; ++ring) {
    for (int i = 0; i < kAround; ++i) {
      const int a = ring * kAround + i + 1, b = ring * kAround + (i + 1) % kAround + 1;
      text += "f " + std::to_string(a) + " " + std::to_string(b) + " " +
              std::to_string(b + kAround) + " " + std::to_string(a + kAround) + "\n";
    }
  }
  write_text(scratch / "tube.obj", text);
  const CommandResult result = run_palpate({"info", scratch / "tube.obj", "--json"});
  ASSERT_EQ(result.status, kDone) << result.err;
  const nlohmann::json curvature = nlohmann::json::parse(result.out).at("curvature");
  EXPECT_NEAR(curvature.at("median").get<double>(), 0.1, 0.002);
  EXPECT_NEAR(curvature.at("p95").get<double>(), 0.1, 0.005);
}

TEST_F(Info, TellsThatTrianglesAreNotJoined) {
  write_text(scratch / "soup.obj",
             "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3\nf 4 5 6\n");
  EXPECT_THAT(run_palpate({"info", scratch / "soup.obj"}).out,
              HasSubstr("4 vertices are where another one is, too"));
  EXPECT_THAT(described(6), Not(HasSubstr("another one")));
}

TEST_F(Info, TellsWhatAFolderHolds) {
  fs::create_directory(scratch / "depth");
  for (const char* name : {"depth/1.png", "depth/2.png"})
    sensing::write_png(scratch / name, cv::Mat_<std::uint16_t>(4, 6, std::uint16_t{700}));
  const auto said = [&](const char* folder) { return run_palpate({"info", scratch / folder}).out; };
  EXPECT_THAT(said("depth"), AllOf(HasSubstr("folder of 2 depth images (16-bit PNG); "),
                                   HasSubstr("need --scale, "), HasSubstr("--intrinsics")));
  sensing::write_png(scratch / "depth/color.png", cv::Mat_<cv::Vec3b>(4, 6, cv::Vec3b(1, 2, 3)));
  EXPECT_THAT(said("depth"), HasSubstr("folder of 2 depth images (16-bit PNG) and 1 image; "));
  fs::create_directory(scratch / "range");
  geometry::write_depth_tiff(scratch / "range/0.tiff", geometry::ImageF::Constant(4, 6, 700));
  EXPECT_THAT(said("range"), AllOf(HasSubstr("1 range map (0 with deviations, 0 with reasons)\n"),
                                   Not(HasSubstr("image"))));
}

TEST_F(Info, TellsThatARangeMapHasNoDepth) {
  geometry::ImageF depths = geometry::ImageF::Constant(4, 6, -700);
  depths(0, 0) = std::numeric_limits<float>::quiet_NaN();
  geometry::write_depth_tiff(scratch / "behind.tiff", depths);
  EXPECT_THAT(
      run_palpate({"info", scratch / "behind.tiff"}).out,
      AllOf(HasSubstr("no pixel has a depth, which is finite and above 0"), Not(HasSubstr("nan"))));
}

}  // namespace
}  // namespace palpate::apps
