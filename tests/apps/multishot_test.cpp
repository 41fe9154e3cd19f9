// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
// Several images of a still scene, and the colour of surfaces, from the pattern to files for other
// programs. The virtual sensor takes the images.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "palpate/geometry/mesh_io.h"
#include "palpate/geometry/range_map.h"
#include "palpate/sensing/frame.h"
#include "palpate/sensing/rig.h"
#include "palpate/sensing/virtual_sensor.h"
#include "run_palpate.h"

namespace palpate::apps {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;

class MultishotCommands : public ::testing::Test {
 protected:
  void SetUp() override {
    rig.camera = {.width = 160, .height = 120, .fx = 275, .fy = 275, .cx = 79.5, .cy = 59.5};
    rig.projector = {.width = 320, .height = 240, .fx = 470, .fy = 470, .cx = 103, .cy = 120};
    rig.T_projector_camera.translation() = Eigen::Vector3d(60, 0, -8);  // side by side
    rig.red = {.alpha = 0.999, .beta = 1.0006, .gamma = 0.0002};
    sensing::write_rig(scratch / "rig.yaml", rig);
    const CommandResult drawn =
        run_palpate({"pattern", "--rig", scratch / "rig.yaml", "--distances", "450", "600",
                     "--multishot", "5", "--grey-steps", "2", "-o", scratch / "pattern", "--json"});
    ASSERT_EQ(drawn.status, kDone) << drawn.err;
    const auto figures = nlohmann::json::parse(drawn.out);
    EXPECT_EQ(figures["axis"], "x");
    images = 5 + figures["code_bits"].get<int>();
  }

  /// Frames of a tilted red-brown card, as a mosaic camera with noise sees them.
  void take(const std::string& folder, double distance, int first = 0) {
    fs::create_directories(scratch / folder);
    sensing::Body card;
    card.mesh.vertices.resize(3, 4);
    card.mesh.vertices << -120, -120, 120, 120, -90, 90, 90, -90, distance, distance + 20,
        distance + 40, distance + 20;
    card.mesh.triangles.resize(3, 2);
    card.mesh.triangles << 0, 0, 1, 2, 2, 3;
    card.reflectance = {0.8, 0.5, 0.3};
    std::vector<cv::Mat> panels;
    for (int i = first; i < images; ++i)
      panels.push_back(sensing::read_frame(scratch / fmt::format("pattern/shot_{:02}.png", i)));
    sensing::VirtualSensor sensor;
    sensor.exposure_distance = 500;
    sensing::Simulation simulation = sensing::simulate(
        rig, {&card, 1}, panels, sensor, sensing::Axis::x, static_cast<std::uint64_t>(first));
    for (int i = first; i < images; ++i) {
      sensing::write_png(scratch / fmt::format("{}/{:02}.png", folder, i),
                         simulation.frames[static_cast<std::size_t>(i - first)]);
    }
    truth = std::move(simulation.truth);
  }

  CommandResult decode(const std::vector<std::string>& frames, std::vector<std::string> more) {
    std::vector<std::string> call = {"decode"};
    for (const std::string& folder : frames) call.push_back(scratch / folder);
    call.insert(call.end(), {"--rig", scratch / "pattern/rig.yaml", "--pattern",
                             scratch / "pattern/pattern.yaml", "-o", scratch / "range"});
    call.insert(call.end(), more.begin(), more.end());
    return run_palpate(call);
  }

  ScratchFolder scratch;
  sensing::Rig rig;
  int images = 0;
  sensing::SceneTruth truth;
};

TEST_F(MultishotCommands, InfoTellsHowManyImagesAPatternHas) {
  const CommandResult described = run_palpate({"info", scratch / "pattern/pattern.yaml", "--json"});
  ASSERT_EQ(described.status, kDone) << described.err;
  const auto figures = nlohmann::json::parse(described.out);
  EXPECT_EQ(figures["shifts"], 5);
  EXPECT_EQ(figures["shifts"].get<int>() + figures["code_bits"].get<int>(), images);
}

TEST_F(MultishotCommands, MeasureAStillSceneWithARigSideBySide) {
  take("frames", 500);
  const CommandResult done = decode({"frames"}, {"--multishot", "--sigma", "--reasons", "--json",
                                                 "--surface-color", "--meshes", "pcd"});
  ASSERT_EQ(done.status, kDone) << done.err;
  EXPECT_EQ(done.err.find("warning"), std::string::npos) << done.err;
  const auto figures = nlohmann::json::parse(done.out);
  EXPECT_EQ(figures["frames"], 1);
  EXPECT_LT(figures["per_frame"][0]["disagreement"], 0.01);

  const geometry::ImageF z = geometry::read_depth_tiff(scratch / "range/000000.tiff");
  const geometry::ImageF sigma = geometry::read_depth_tiff(scratch / "range/000000_sigma.tiff");
  double scores = 0;
  long known = 0, nowhere = 0;
  for (Eigen::Index i = 0; i < z.size(); ++i) {
    if (!(z.data()[i] > 0)) continue;
    // The blur of the lens shows the card a little beyond its edge.
    if (!(truth.range.z.data()[i] > 0)) {
      ++nowhere;
      continue;
    }
    ++known;
    const auto deviation = static_cast<double>(sigma.data()[i]);
    const double error = static_cast<double>(z.data()[i] - truth.range.z.data()[i]);
    EXPECT_LT(std::abs(error), 6 * deviation);
    scores += std::pow(error / deviation, 2);
  }
  EXPECT_GT(static_cast<double>(known), 0.98 * static_cast<double>(truth.lit.count()));
  EXPECT_LT(static_cast<double>(nowhere), 0.005 * static_cast<double>(known));
  const double score = std::sqrt(scores / static_cast<double>(known));
  EXPECT_GT(score, 0.7);
  EXPECT_LT(score, 1.3);

  // Users of depth cameras expect a point per pixel, with its colour.
  const geometry::PointCloud cloud = geometry::read_point_cloud(scratch / "range/000000.pcd");
  EXPECT_EQ(cloud.width, 160);
  EXPECT_EQ(cloud.height, 120);
  const auto red = geometry::scalars(cloud.attributes, "red");
  const auto blue = geometry::scalars(cloud.attributes, "blue");
  ASSERT_TRUE(red && blue);
  const Eigen::Index middle = 60 * 160 + 80;
  EXPECT_NEAR(cloud.points(2, middle), static_cast<double>(z(60, 80)), 1e-3);
  EXPECT_GT((*red)[middle], (*blue)[middle] + 20);

  const CommandResult meshed = run_palpate({"mesh", scratch / "range/000000.tiff", "--color",
                                            "--tolerance", "0.5", "-o", scratch / "m.ply"});
  ASSERT_EQ(meshed.status, kDone) << meshed.err;
  const geometry::MeshFile mesh = geometry::read_mesh_file(scratch / "m.ply");
  const auto of_vertices = geometry::scalars(mesh.vertex_attributes, "red");
  ASSERT_TRUE(of_vertices);
  EXPECT_EQ(of_vertices->size(), mesh.mesh.vertices.cols());
  EXPECT_NEAR(of_vertices->maxCoeff(), red->maxCoeff(), 10);
}

TEST_F(MultishotCommands, TakeTheOptionsOfSingleFramesThatMeanTheSame) {
  take("frames", 500);
  // The card reflects at most 0.8 of the light, so that no pixel reaches 0.9 of full scale.
  for (const auto& [least, is_seen] : {std::pair("0.01", true), {"0.9", false}}) {
    const CommandResult done = decode({"frames"}, {"--multishot", "--min-signal", least});
    ASSERT_EQ(done.status, kDone) << done.err;
    const geometry::ImageF z = geometry::read_depth_tiff(scratch / "range/000000.tiff");
    EXPECT_EQ((z > 0).any(), is_seen) << least;
  }
  const CommandResult refused = decode({"frames"}, {"--multishot", "--window-periods", "3"});
  EXPECT_EQ(refused.status, kWrongCall);
  EXPECT_THAT(refused.err, HasSubstr("excludes --window-periods"));
}

TEST_F(MultishotCommands, SayWhatIsWrongWithTheImages) {
  take("frames", 500);
  CommandResult result = decode({"frames"}, {});
  EXPECT_EQ(result.status, kWrongCall);
  EXPECT_THAT(result.err, HasSubstr("--multishot: is missing"));
  result = decode({"frames"}, {"--multishot", "--exposures", "2"});
  EXPECT_EQ(result.status, kWrongCall);
  EXPECT_THAT(result.err, HasSubstr("a multiple of that is expected"));
  EXPECT_FALSE(fs::exists(scratch / "range"));

  take("frames", 504, 2);  // the card moves after two images
  result = decode({"frames"}, {"--multishot"});
  EXPECT_EQ(result.status, kDone) << result.err;
  EXPECT_THAT(result.err, HasSubstr("do not show one still scene"));

  write_text(scratch / "frames/03.png", "broken");
  result = decode({"frames"}, {"--multishot"});
  EXPECT_EQ(result.status, kWrongCall);
  const std::size_t said = result.err.find("03.png: ");
  ASSERT_NE(said, std::string::npos) << result.err;
  EXPECT_EQ(result.err.find("03.png: ", said + 1), std::string::npos) << result.err;
  take("other", 500);
  result = decode({"frames", "other"}, {"--multishot"});
  EXPECT_EQ(result.status, kWorkFailed);
  EXPECT_THAT(result.err, HasSubstr("03.png"));
  EXPECT_THAT(result.out, HasSubstr("1 of 2 scenes decoded"));
  EXPECT_TRUE(fs::exists(scratch / "range/000001.tiff"));
  EXPECT_FALSE(fs::exists(scratch / "range/000000.tiff"));
}

TEST_F(MultishotCommands, WarnIfTheSinusoidsAreInReverseOrder) {
  take("frames", 500);
  for (int i = 0; i < 2; ++i) {
    const fs::path one = scratch / fmt::format("frames/{:02}.png", i);
    const fs::path other = scratch / fmt::format("frames/{:02}.png", 4 - i);
    fs::rename(one, scratch / "moved.png");
    fs::rename(other, one);
    fs::rename(scratch / "moved.png", other);
  }
  const CommandResult done = decode({"frames"}, {"--multishot"});
  EXPECT_EQ(done.status, kDone) << done.err;
  EXPECT_THAT(done.err, HasSubstr("the code contradicts the sinusoid at"));
}

TEST(SurfaceColorCommands, WriteWhatFramesShowWithoutTheStripes) {
  const ScratchFolder scratch;
  write_text(scratch / "colors.yaml", trained_colors());
  const CommandResult done =
      run_palpate({"decode", demo("frames/flag_a.png"), "--rig", demo("rig.yaml"), "--pattern",
                   demo("pattern.yaml"), "--colors", scratch / "colors.yaml", "--surface-color",
                   "--half-resolution", "--meshes", "ply", "-o", scratch / "range"});
  ASSERT_EQ(done.status, kDone) << done.err;
  const cv::Mat color = sensing::read_frame(scratch / "range/000000_color.png");
  EXPECT_EQ(color.cols, 320);
  EXPECT_EQ(color.type(), CV_8UC3);
  const geometry::MeshFile mesh = geometry::read_mesh_file(scratch / "range/000000.ply");
  EXPECT_TRUE(geometry::scalars(mesh.vertex_attributes, "green"));
  const CommandResult refused =
      run_palpate({"mesh", scratch / "range/000000.tiff", "--color", "-o", scratch / "m.stl"});
  EXPECT_EQ(refused.status, kWrongCall);
  EXPECT_THAT(refused.err, HasSubstr("STL has no colours"));
}

}  // namespace
}  // namespace palpate::apps
