// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
// Range maps become meshes and sequences of meshes, and are compared with a reference.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <filesystem>
#include <iterator>
#include <limits>
#include <nlohmann/json.hpp>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <sstream>
#include <string>
#include <vector>

#include "run_palpate.h"

namespace palpate::apps {
namespace {

namespace fs = std::filesystem;

/// Depths of a board with bumps of several sizes in the middle of the demo camera's image; noise in
/// mm.
cv::Mat bumps(double noise = 0) {
  cv::Mat_<float> z(480, 640, std::numeric_limits<float>::quiet_NaN());
  const double place[4][4] = {
      {290, 215, 14, 18}, {345, 250, 9, 12}, {300, 265, 7, -14}, {350, 210, 6, 8}};
  cv::RNG random(1);
  for (int v = 190; v < 290; ++v) {
    for (int u = 260; u < 380; ++u) {
      double depth = 830;
      for (const auto& [u0, v0, width, height] : place)
        depth -=
            height * std::exp(-((u - u0) * (u - u0) + (v - v0) * (v - v0)) / 2 / width / width);
      z(v, u) = static_cast<float>(depth + random.gaussian(noise));
    }
  }
  return z;
}

class MeshSequence : public ::testing::Test {
 protected:
  void SetUp() override {
    fs::create_directory(scratch / "range");
    fs::copy(demo("rig.yaml"), scratch / "range/rig.yaml");
    cv::imwrite(scratch / "range/000003.tiff", bumps());
    cv::imwrite(scratch / "range/000007.tiff", bumps() + 40);
  }

  nlohmann::json figures(std::vector<std::string> call) const {
    call.emplace_back("--json");
    const CommandResult result = run_palpate(call);
    EXPECT_EQ(result.status, kDone) << result.err;
    return nlohmann::json::parse(result.out);
  }

  ScratchFolder scratch;
};

TEST_F(MeshSequence, EachMeshIsWhatItsRangeMapAloneGives) {
  const auto all = figures(
      {"mesh", scratch / "range", "-o", scratch / "meshes", "--format", "ply", "--tolerance", "1"});
  EXPECT_EQ(all["range_maps"], 2);
  EXPECT_EQ(all["meshes"], 2);
  EXPECT_EQ(all["per_mesh"][0]["file"], scratch / "meshes/000003.ply");
  EXPECT_LE(all["per_mesh"][0]["decimation"]["distance"], 1);
  figures(
      {"mesh", scratch / "range/000007.tiff", "-o", scratch / "single.ply", "--tolerance", "1"});
  EXPECT_EQ(read_text(scratch / "meshes/000007.ply"), read_text(scratch / "single.ply"));
  // The distance that was promised is the one that is measured, from the map itself.
  const auto distance = figures(
      {"compare", scratch / "meshes/000007.ply", scratch / "range/000007.tiff"})["hausdorff"];
  EXPECT_LE(distance["lower"], 1);
}

TEST_F(MeshSequence, AMapThatIsBrokenDoesNotStopTheOthersAndOtherFilesAreNoMaps) {
  write_text(scratch / "range/000001.tiff", "broken");
  write_text(scratch / "range/000003_reasons.tiff", "codes");
  write_text(scratch / "range/000003_sigma.tiff", "deviations");
  const CommandResult result =
      run_palpate({"mesh", scratch / "range", "-o", scratch / "meshes", "--format", "obj"});
  EXPECT_EQ(result.status, kWorkFailed);
  EXPECT_NE(result.err.find("000001.tiff: is not a TIFF file"), std::string::npos) << result.err;
  EXPECT_NE(result.err.find("1 of 3 range maps"), std::string::npos) << result.err;
  EXPECT_TRUE(fs::exists(scratch / "meshes/000003.obj"));
  EXPECT_TRUE(fs::exists(scratch / "meshes/000007.obj"));
}

TEST_F(MeshSequence, MeshesOfAnotherSequenceAreNotMixedIn) {
  fs::create_directory(scratch / "meshes");
  write_text(scratch / "meshes/000008.ply", "another's");
  const CommandResult result = run_palpate({"mesh", scratch / "range", "-o", scratch / "meshes"});
  EXPECT_EQ(result.status, kWrongCall);
  EXPECT_NE(result.err.find("000008.ply: is a mesh of no range map"), std::string::npos);
  EXPECT_FALSE(fs::exists(scratch / "meshes/000003.ply"));
}

TEST_F(MeshSequence, LeftOversOfAKilledRunAreNoData) {
  fs::create_directory(scratch / "meshes");
  for (const char* file : {"range/.palpate-tmp-a-1-0-f.tiff", "meshes/.palpate-tmp-a-1-0-f.ply",
                           "range/._000003.tiff"})
    write_text(scratch / file, "half");
  const auto made = figures({"mesh", scratch / "range", "-o", scratch / "meshes"});
  EXPECT_EQ(made["range_maps"], 2);
}

TEST_F(MeshSequence, MeshesOfAnEarlierRunAreReplacedAsAWhole) {
  figures({"mesh", scratch / "range", "-o", scratch / "meshes", "--tolerance", "1"});
  const std::string small = read_text(scratch / "meshes/000003.ply");
  const std::string large = read_text(scratch / "meshes/000007.ply");
  cv::Mat part(480, 640, CV_32F, cv::Scalar(std::numeric_limits<float>::quiet_NaN()));
  const cv::Rect inner(300, 220, 10, 10);
  bumps()(inner).copyTo(part(inner));
  cv::imwrite(scratch / "range/000003.tiff", part);
  // Only the first mesh finds room.
  constexpr unsigned long kRoom = 100000;
  const CommandResult full =
      run_palpate({"mesh", scratch / "range", "-o", scratch / "meshes", "--threads", "1"},
                  {.max_file_size = kRoom});
  EXPECT_EQ(full.status, kWorkFailed);
  EXPECT_NE(full.err.find("000007.ply: cannot be written"), std::string::npos) << full.err;
  EXPECT_EQ(read_text(scratch / "meshes/000003.ply"), small);
  EXPECT_EQ(read_text(scratch / "meshes/000007.ply"), large);
  // A mesh that has no successor goes with the others, and nothing else is left.
  write_text(scratch / "range/000007.tiff", "broken");
  EXPECT_EQ(run_palpate({"mesh", scratch / "range", "-o", scratch / "meshes"}).status, kWorkFailed);
  EXPECT_NE(read_text(scratch / "meshes/000003.ply"), small);
  EXPECT_EQ(std::distance(fs::directory_iterator(scratch / "meshes"), fs::directory_iterator()), 1);
}

TEST_F(MeshSequence, DepthsAreSmoothedWithinTheirDeviations) {
  fs::copy(scratch / "range/000003.tiff", scratch / "truth.tiff");
  fs::copy(demo("rig.yaml"), scratch / "rig.yaml");
  cv::imwrite(scratch / "range/000003.tiff", bumps(0.5));
  const cv::Mat sigma(480, 640, CV_32F, cv::Scalar(0.5));
  const auto map = scratch / "range/000003.tiff";
  const CommandResult missing =
      run_palpate({"mesh", map, "--smooth-depths", "-o", scratch / "a.ply"});
  EXPECT_EQ(missing.status, kWrongCall);
  EXPECT_NE(missing.err.find("000003_sigma.tiff: missing"), std::string::npos);
  cv::imwrite(scratch / "range/000003_sigma.tiff", sigma);
  figures({"mesh", map, "-o", scratch / "rough.ply"});
  figures({"mesh", map, "--smooth-depths", "-o", scratch / "smooth.ply"});
  const auto median = [&](const std::string& mesh) {
    return figures({"compare", scratch / mesh, scratch / "truth.tiff"})["median"].get<double>();
  };
  EXPECT_LT(median("smooth.ply"), 0.6 * median("rough.ply"));
}

TEST_F(MeshSequence, ARangeMapIsComparedWithAReferenceThatLiesElsewhereInOneCommand) {
  // The reference: two fifths of the true surface, turned by 8 degrees about an axis through it and
  // moved by 20 mm. What is left after alignment is the noise of the measured map.
  cv::Mat part(480, 640, CV_32F, cv::Scalar(std::numeric_limits<float>::quiet_NaN()));
  const cv::Rect inner(285, 205, 70, 70);
  bumps()(inner).copyTo(part(inner));
  cv::imwrite(scratch / "range/000003.tiff", part);
  figures({"mesh", scratch / "range/000003.tiff", "-o", scratch / "true.obj"});
  cv::imwrite(scratch / "range/000003.tiff", bumps(0.2));
  const double c = std::cos(0.14), s = std::sin(0.14);
  std::string moved;
  std::istringstream lines(read_text(scratch / "true.obj"));
  for (std::string line; std::getline(lines, line);) {
    double x = 0, y = 0, z = 0;
    if (std::sscanf(line.c_str(), "v %lf %lf %lf", &x, &y, &z) == 3) {
      const double dz = z - 830;
      line = "v " + std::to_string(c * x + s * dz + 12) + " " + std::to_string(y - 16) + " " +
             std::to_string(-s * x + c * dz + 830);
    }
    moved += line + "\n";
  }
  write_text(scratch / "reference.obj", moved);
  const auto found = figures({"compare", scratch / "range/000003.tiff", scratch / "reference.obj",
                              "--align", "--search-translation", "25", "--within", "5", "--section",
                              scratch / "section.png"});
  EXPECT_NEAR(found["aligned"]["rotation"], 0.14, 2e-3);
  const auto& both = found["in_both"];
  EXPECT_NEAR(both["share"], 0.41, 0.02);  // 70 of 120 by 70 of 100 pixels
  EXPECT_NEAR(both["rms"], 0.2, 0.03);  // slopes make distances shorter than differences in depth
  EXPECT_NEAR(both["distance"], 829, 2);
  EXPECT_NEAR(both["rms_percent"].get<double>(),
              100 * both["rms"].get<double>() / both["distance"].get<double>(), 1e-9);
  EXPECT_EQ(cv::imread(scratch / "section.png").size(), cv::Size(1200, 700));
}

}  // namespace
}  // namespace palpate::apps
