// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
// Range maps become meshes and sequences of meshes, and are compared with a reference.
#include <gtest/gtest.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <iterator>
#include <limits>
#include <nlohmann/json.hpp>
#include <opencv2/core.hpp>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "palpate/geometry/range_map.h"
#include "palpate/sensing/frame.h"
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

void write_depths(const std::string& path, const cv::Mat& z) {
  geometry::write_depth_tiff(path,
                             Eigen::Map<const geometry::ImageF>(z.ptr<float>(), z.rows, z.cols));
}

class MeshSequence : public ::testing::Test {
 protected:
  void SetUp() override {
    fs::create_directory(scratch / "range");
    fs::copy(demo("rig.yaml"), scratch / "range/rig.yaml");
    write_depths(scratch / "range/000003.tiff", bumps());
    write_depths(scratch / "range/000007.tiff", bumps() + 40);
  }

  nlohmann::json figures(std::vector<std::string> call) const {
    call.emplace_back("--json");
    const CommandResult result = run_palpate(call);
    EXPECT_EQ(result.status, kDone) << result.err;
    return nlohmann::json::parse(result.out);
  }

  ScratchFolder scratch;
};

TEST_F(MeshSequence, CtrlCDoesNotWaitForMeshesThatTakeLong) {
  for (const char* file : {"range/000007.tiff", "range/000011.tiff"})
    write_depths(scratch / file, cv::Mat_<float>(480, 640, 830.F));
  const CommandResult stopped =
      run_palpate({"mesh", scratch / "range", "-o", scratch / "meshes", "--tolerance", "1"},
                  {.interrupt_when_there_is = scratch / "meshes/000003.ply"});
  EXPECT_EQ(stopped.status, kInterrupted);
  EXPECT_NE(stopped.err.find("stopping; press Ctrl-C again to end at once\n"), std::string::npos)
      << stopped.err;
  EXPECT_NE(stopped.err.find("interrupted; 1 of 3 frames are finished\n"), std::string::npos)
      << stopped.err;
}

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
  // The stated distance is the one that is measured from the map itself.
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
  write_depths(scratch / "range/000003.tiff", part);
  // Only the first mesh finds room.
  constexpr unsigned long kRoom = 100000;
  const CommandResult full =
      run_palpate({"mesh", scratch / "range", "-o", scratch / "meshes", "--threads", "1"},
                  {.max_file_size = kRoom});
  EXPECT_EQ(full.status, kWorkFailed);
  EXPECT_NE(full.err.find("000007.ply: cannot be written"), std::string::npos) << full.err;
  EXPECT_EQ(read_text(scratch / "meshes/000003.ply"), small);
  EXPECT_EQ(read_text(scratch / "meshes/000007.ply"), large);
  // A mesh without a successor is removed with the others, and no other file is left.
  write_text(scratch / "range/000007.tiff", "broken");
  EXPECT_EQ(run_palpate({"mesh", scratch / "range", "-o", scratch / "meshes"}).status, kWorkFailed);
  EXPECT_NE(read_text(scratch / "meshes/000003.ply"), small);
  EXPECT_EQ(std::distance(fs::directory_iterator(scratch / "meshes"), fs::directory_iterator()), 1);
}

TEST_F(MeshSequence, DepthsAreSmoothedWithinTheirDeviations) {
  fs::copy(scratch / "range/000003.tiff", scratch / "truth.tiff");
  fs::copy(demo("rig.yaml"), scratch / "rig.yaml");
  write_depths(scratch / "range/000003.tiff", bumps(0.5));
  const cv::Mat sigma(480, 640, CV_32F, cv::Scalar(0.5));
  const auto map = scratch / "range/000003.tiff";
  const CommandResult missing =
      run_palpate({"mesh", map, "--smooth-depths", "-o", scratch / "a.ply"});
  EXPECT_EQ(missing.status, kWrongCall);
  EXPECT_NE(missing.err.find("000003_sigma.tiff: missing"), std::string::npos);
  write_depths(scratch / "range/000003_sigma.tiff", sigma);
  figures({"mesh", map, "-o", scratch / "rough.ply"});
  figures({"mesh", map, "--smooth-depths", "-o", scratch / "smooth.ply"});
  const auto median = [&](const std::string& mesh) {
    return figures({"compare", scratch / mesh, scratch / "truth.tiff"})["median"].get<double>();
  };
  EXPECT_LT(median("smooth.ply"), 0.6 * median("rough.ply"));
}

TEST_F(MeshSequence, ARangeMapIsComparedWithAReferenceThatLiesElsewhereInOneCommand) {
  // The reference: two fifths of the true surface, turned by 8 degrees about an axis through it and
  // moved by 20 mm. Only the noise of the measured map remains after alignment.
  cv::Mat part(480, 640, CV_32F, cv::Scalar(std::numeric_limits<float>::quiet_NaN()));
  const cv::Rect inner(285, 205, 70, 70);
  bumps()(inner).copyTo(part(inner));
  write_depths(scratch / "range/000003.tiff", part);
  figures({"mesh", scratch / "range/000003.tiff", "-o", scratch / "true.obj"});
  write_depths(scratch / "range/000003.tiff", bumps(0.2));
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
  EXPECT_EQ(sensing::read_frame(scratch / "section.png").size(), cv::Size(1200, 700));
}

/// A folder of depth images of the bumps in units of an eighth of a millimetre, without a depth at
/// the same pixels.
class DepthImages : public MeshSequence {
 protected:
  void SetUp() override {
    MeshSequence::SetUp();
    write_depths(scratch / "range/000007.tiff", bumps() + 4);
    fs::create_directory(scratch / "depth");
    for (const int number : {9, 10}) {
      cv::Mat_<float> z = bumps();
      z += 4 * (number - 9);
      cv::Mat_<std::uint16_t> units(z.size(), 0);
      for (int v = 0; v < z.rows; ++v) {
        for (int u = 0; u < z.cols; ++u) {
          if (!std::isnan(z(v, u)))
            units(v, u) = static_cast<std::uint16_t>(std::lround(8 * z(v, u)));
        }
      }
      sensing::write_png(scratch / "depth/" + std::to_string(number) + ".png", units);
    }
  }

  std::vector<std::string> mesh(std::vector<std::string> more) const {
    more.insert(more.begin(), {"mesh", scratch / "depth", "-o", scratch / "meshes"});
    return more;
  }

  void expect_refused(const std::vector<std::string>& call,
                      const std::vector<std::string>& words) const {
    const CommandResult result = run_palpate(call);
    EXPECT_EQ(result.status, kWrongCall) << result.err;
    for (const std::string& word : words)
      EXPECT_NE(result.err.find(word), std::string::npos) << word << " is not in: " << result.err;
    EXPECT_FALSE(fs::exists(scratch / "meshes"));
  }

  const std::vector<std::string> by_numbers = {"--scale", "0.125", "--intrinsics",
                                               "1100,1100,319.5,239.5"};
};

TEST_F(DepthImages, AFolderOfThemIsASequenceAndLiesOnTheRangeMapsOfTheSameScene) {
  const auto all = figures(mesh(by_numbers));
  EXPECT_EQ(all["meshes"], 2);
  EXPECT_EQ(all["per_mesh"][0]["range_map"], "9.png");  // 9 comes before 10
  EXPECT_EQ(all["per_mesh"][0]["pixels"], 100 * 120);
  for (const auto& [image, map] : {std::pair("9", "000003"), std::pair("10", "000007")}) {
    const auto distance = figures({"compare", scratch / "meshes/" + image + ".ply",
                                   scratch / "range/" + map + ".tiff"})["hausdorff"];
    EXPECT_LE(distance["lower"], 0.07);  // half a unit, and rounding on the slanted rays
  }
}

TEST_F(DepthImages, TheCameraMayBeARigOrAFileOfACameraAlone) {
  figures(mesh(by_numbers));
  const std::string expected = read_text(scratch / "meshes/9.ply");
  const auto expect_same = [&](const std::vector<std::string>& camera) {
    fs::remove_all(scratch / "meshes");
    std::vector<std::string> call = mesh({"--scale", "0.125"});
    call.insert(call.end(), camera.begin(), camera.end());
    figures(call);
    EXPECT_EQ(read_text(scratch / "meshes/9.ply"), expected);
  };
  expect_same({"--rig", demo("rig.yaml")});
  write_text(scratch / "camera.yaml",
             "%YAML:1.0\n---\ncamera_size: [ 640, 480 ]\ncamera_matrix: !!opencv-matrix\n"
             "   rows: 3\n   cols: 3\n   dt: d\n"
             "   data: [ 1100., 0., 319.5, 0., 1100., 239.5, 0., 0., 1. ]\n"
             "camera_distortion: []\n");
  expect_same({"--rig", scratch / "camera.yaml"});
  EXPECT_EQ(figures({"info", scratch / "camera.yaml"})["kind"], "camera");
  EXPECT_EQ(figures({"info", scratch / "meshes"})["meshes"], 2);
  fs::copy(scratch / "camera.yaml", scratch / "depth/rig.yaml");
  expect_same({});
}

TEST_F(DepthImages, SeveralFilesAreASequenceToo) {
  std::vector<std::string> call = {"mesh", scratch / "depth/10.png", scratch / "depth/9.png", "-o",
                                   scratch / "meshes"};
  call.insert(call.end(), by_numbers.begin(), by_numbers.end());
  const auto all = figures(call);
  EXPECT_EQ(all["per_mesh"][0]["range_map"], "10.png");  // the order of the call
  EXPECT_EQ(all["meshes"], 2);
  const auto maps = figures({"mesh", scratch / "range/000003.tiff", scratch / "range/000007.tiff",
                             "-o", scratch / "from_maps"});
  EXPECT_EQ(maps["meshes"], 2);
  fs::remove_all(scratch / "meshes");
  fs::create_directory(scratch / "other");
  fs::copy(scratch / "depth/9.png", scratch / "other/9.png");
  call[1] = scratch / "other/9.png";
  expect_refused(call, {"depth/9.png: another range map is also called 9"});
  call[1] = demo("sheet/surface.ply");
  expect_refused(call, {"surface.ply: is no range map"});
}

TEST_F(DepthImages, OneThatIsBrokenDoesNotStopTheOthers) {
  const std::string whole = read_text(scratch / "depth/9.png");
  write_text(scratch / "depth/1.png", whole.substr(0, whole.size() / 2));
  write_text(scratch / "depth/2.png", "broken");
  const CommandResult result = run_palpate(mesh(by_numbers));
  EXPECT_EQ(result.status, kWorkFailed);
  EXPECT_NE(result.err.find("1.png: "), std::string::npos) << result.err;
  EXPECT_NE(result.err.find("2.png: "), std::string::npos) << result.err;
  EXPECT_NE(result.err.find("2 of 4 depth images"), std::string::npos) << result.err;
  EXPECT_TRUE(fs::exists(scratch / "meshes/9.ply"));
  EXPECT_TRUE(fs::exists(scratch / "meshes/10.ply"));
}

TEST_F(DepthImages, ImagesThatAreNoneAreRefusedByNameBeforeAnythingIsWritten) {
  sensing::write_png(scratch / "depth/grey.png", cv::Mat(480, 640, CV_8UC1, cv::Scalar(7)));
  expect_refused(mesh(by_numbers), {"grey.png: is a grey image of 8 bit", "16-bit"});
  sensing::write_png(scratch / "depth/grey.png", cv::Mat(480, 640, CV_16UC3, cv::Scalar(7, 8, 9)));
  expect_refused(mesh(by_numbers),
                 {"grey.png: is a colour image of 16 bit", "16-bit single-channel"});
}

TEST_F(DepthImages, RangeMapsAndDepthImagesAreNotMixedButPicturesMayLieBesideRangeMaps) {
  fs::copy(scratch / "range/000003.tiff", scratch / "depth/000003.tiff");
  expect_refused(mesh(by_numbers), {"9.png: is a depth image", "000003.tiff is a range map"});
  sensing::write_png(scratch / "range/000003.png", cv::Mat(480, 640, CV_8UC3, cv::Scalar(7, 8, 9)));
  EXPECT_EQ(figures({"mesh", scratch / "range", "-o", scratch / "of_maps"})["meshes"], 2);
}

TEST_F(DepthImages, UnitAndCameraAreAskedForOnceAndNotForEachImage) {
  expect_refused(mesh({}), {"9.png: a depth image needs --scale"});
  expect_refused(mesh({"--scale", "0.125"}), {"9.png: a depth image needs its camera"});
  std::vector<std::string> both = mesh(by_numbers);
  both.insert(both.end(), {"--rig", demo("rig.yaml")});
  expect_refused(both, {"pass one of them"});
  write_text(scratch / "broken.yaml", "camera_size: 640\n");
  for (const std::vector<std::string>& options : std::vector<std::vector<std::string>>{
           {}, {"--scale", "0.125", "--rig", scratch / "broken.yaml"}}) {
    const CommandResult result = run_palpate(mesh(options));
    EXPECT_EQ(result.status, kWrongCall);
    EXPECT_EQ(result.err.find('\n'), result.err.size() - 1) << result.err;
  }
}

TEST_F(DepthImages, InfoSaysWhatADepthImageHolds) {
  const auto image = figures({"info", scratch / "depth/9.png"});
  EXPECT_EQ(image["bits"], 16);
  EXPECT_EQ(image["pixels"], 100 * 120);
  double farthest = 0;
  for (const float z : cv::Mat_<float>(bumps())) {
    if (!std::isnan(z)) farthest = std::max<double>(farthest, z);
  }
  EXPECT_EQ(image["max_units"], std::lround(8 * farthest));
}

TEST_F(DepthImages, ASurfaceIsTrackedThroughThem) {
  std::vector<std::string> call = {"track", scratch / "depth", "-o", scratch / "meshes"};
  call.insert(call.end(), by_numbers.begin(), by_numbers.end());
  const auto tracked = figures(call);
  EXPECT_EQ(tracked["meshes"], 2);
  EXPECT_LT(tracked["largest_rms"], 0.1);
  const auto farthest = [&](const std::string& name) {
    return figures({"info", scratch / "meshes/" + name})["max"];
  };
  EXPECT_NEAR(farthest("10.ply")[2].get<double>(), farthest("9.ply")[2].get<double>() + 4, 0.5);
}

/// Noise, steps and borders of a real depth camera leave a few places where no triangle may go; all
/// others must not be given up because of them.
TEST_F(MeshSequence, AMeshOfADepthCameraShrinksSteadilyAsTheToleranceGrows) {
  // The middle of the hand: the whole image takes several times as long.
  const cv::Rect part(220, 160, 200, 160);
  const cv::Mat image = sensing::read_frame(demo("depth_camera/hand.png"));
  sensing::write_png(scratch / "part.png", image(part));
  const std::string intrinsics = "476.007,476.007," + std::to_string(313.683 - part.x) + "," +
                                 std::to_string(242.755 - part.y);
  std::vector<double> triangles;
  for (const char* const tolerance : {"0.1", "0.15", "0.225"}) {
    const auto made =
        figures({"mesh", scratch / "part.png", "--scale", "0.125", "--intrinsics", intrinsics,
                 "--smooth", "10", "--tolerance", tolerance, "-o", scratch / "hand.ply"});
    triangles.push_back(made["triangles"]);
  }
  EXPECT_LT(triangles[1], 1.1 * std::sqrt(triangles[0] * triangles[2]));
}

}  // namespace
}  // namespace palpate::apps
