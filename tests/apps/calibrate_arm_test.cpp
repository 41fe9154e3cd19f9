// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
// `palpate calibrate arm`, as a user calls it.
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <random>
#include <string>
#include <vector>

#include "palpate/geometry/mesh_io.h"
#include "palpate/geometry/range_map.h"
#include "palpate/geometry/surface_query.h"
#include "palpate/probing/arm_setup.h"
#include "run_palpate.h"

namespace palpate::apps {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;

constexpr double kTip = 2;        // [mm]
constexpr double kBall = 15;      // [mm]
constexpr double kDepths = 0.05;  // [mm] noise

Isometry3d place_of_arm() {
  return Eigen::Translation3d(20, -190, 380) *
         Eigen::AngleAxisd(1.4, Vector3d(1, 0.2, -0.1).normalized());
}

/// A pose with an error of 8 degrees, and of 15 mm at the object.
Isometry3d near_place_of_arm() {
  return Eigen::Translation3d(10, -9, 506) *
         Eigen::AngleAxisd(0.14, Vector3d(1, -2, 1).normalized()) *
         Eigen::Translation3d(0, 0, -500) * place_of_arm();
}

std::string csv_row(const Vector3d& position) {
  return std::to_string(position.x()) + "," + std::to_string(position.y()) + "," +
         std::to_string(position.z()) + "\n";
}

/// Touches of the bundled hand; one of them is 2 mm too early.
std::string touches_of_hand(const geometry::TriangleMesh& hand) {
  const geometry::SurfaceQuery query(hand);
  const Eigen::Matrix3Xd normals = vertex_normals(hand);
  std::mt19937 random(3);
  std::normal_distribution<double> noise(0, 0.03);
  std::string text = "x,y,z\n";
  for (int i = 0; i < 60; ++i) {
    const Eigen::Index vertex = 97 * i + 11;
    const Vector3d normal = normals.col(vertex);
    double low = 0, high = 4 * kTip;
    for (int halving = 0; halving < 40; ++halving) {
      const double middle = (low + high) / 2;
      const double distance =
          query.closest_point(hand.vertices.col(vertex) + middle * normal).distance;
      (distance < kTip ? low : high) = middle;
    }
    const double early = i == 20 ? 2 : noise(random);
    text +=
        csv_row(place_of_arm().inverse() * (hand.vertices.col(vertex) + (low + early) * normal));
  }
  return text;
}

Isometry3d pose_in(const nlohmann::json& rows) {
  Isometry3d pose = Isometry3d::Identity();
  for (int row = 0; row < 3; ++row)
    for (int column = 0; column < 4; ++column)
      pose.matrix()(row, column) =
          rows[static_cast<std::size_t>(row)][static_cast<std::size_t>(column)].get<double>();
  return pose;
}

/// Distance between the positions of a place of the object under two poses [mm].
double apart(const Isometry3d& found, const Vector3d& place) {
  return (found * place_of_arm().inverse() * place - place).norm();
}

TEST(CalibrateArm, ByTouchesWritesThePoseAndKeepsTheRestOfASetup) {
  const ScratchFolder scratch;
  const std::string mesh = (demo_data().parent_path() / "meshes/hand.ply").string();
  const geometry::TriangleMesh hand = geometry::read_mesh(mesh);
  write_text(scratch / "touches.csv", touches_of_hand(hand));
  write_text(scratch / "arm.json", R"({"structure": 3.25, "driver": {"port": "usb0"}})");
  write_text(scratch / "rough.yaml", probing::with_pose("{}", "", near_place_of_arm()));
  const CommandResult result = run_palpate(
      {"calibrate", "arm", "--touches", scratch / "touches.csv", "--surface", mesh, "--tip-radius",
       "2", "--start", scratch / "rough.yaml", "-o", scratch / "arm.json", "--json"});
  ASSERT_EQ(result.status, 0) << result.err;
  const nlohmann::json figures = nlohmann::json::parse(result.out);
  const Vector3d middle = hand.vertices.rowwise().mean();
  EXPECT_LT(apart(pose_in(figures["pose"]), middle), 0.1);
  for (std::size_t axis = 0; axis < 3; ++axis)
    EXPECT_LT(figures["R_deviation_deg"][axis].get<double>(), 0.1);
  EXPECT_FALSE(figures["residuals"][20]["used"].get<bool>());
  EXPECT_NE(result.err.find("touch 21"), std::string::npos) << result.err;
  const probing::ArmSetup setup =
      probing::parse_arm_setup(read_text(scratch / "arm.json"), "arm.json");
  EXPECT_TRUE(setup.knows_pose);
  EXPECT_LT(apart(setup.prober.T_world_base, middle), 0.1);
  EXPECT_EQ(setup.prober.structure, 3.25);
  EXPECT_EQ(setup.driver.at("port"), "usb0");
}

/// Writes the range map of a small camera of a ball before a wall.
void write_range_map(const std::string& path, const Vector3d& centre, unsigned seed) {
  geometry::ImageF z(120, 160);
  std::mt19937 random(seed);
  std::normal_distribution<double> noise(0, kDepths);
  for (int row = 0; row < 120; ++row) {
    for (int column = 0; column < 160; ++column) {
      const Vector3d ray = Vector3d((column - 80) / 600.0, (row - 60) / 600.0, 1).normalized();
      const double along = ray.dot(centre);
      const double inside = along * along - centre.squaredNorm() + kBall * kBall;
      const double way = inside > 0 ? along - std::sqrt(inside) : 850 / ray.z();
      z(row, column) = static_cast<float>(way * ray.z() + noise(random));
    }
  }
  geometry::write_depth_tiff(path, z);
}

constexpr const char* kCamera = R"(%YAML:1.0
---
camera_size: [ 160, 120 ]
camera_matrix: !!opencv-matrix
   rows: 3
   cols: 3
   dt: d
   data: [ 600.0, 0.0, 80.0, 0.0, 600.0, 60.0, 0.0, 0.0, 1.0 ]
camera_distortion: !!opencv-matrix
   rows: 1
   cols: 5
   dt: d
   data: [ 0.0, 0.0, 0.0, 0.0, 0.0 ]
)";

/// Writes range maps of a ball at some places, and the table of the poses. At one of them the arm
/// reports a wrong position.
void write_poses(const ScratchFolder& scratch, int count) {
  std::filesystem::create_directories(scratch.path() / "range");
  write_text(scratch / "range/rig.yaml", kCamera);
  std::mt19937 random(5);
  std::uniform_real_distribution<double> uniform(-1, 1);
  std::string text = "range_map,x,y,z\n";
  for (int i = 0; i < count; ++i) {
    const Vector3d centre{55 * uniform(random), 35 * uniform(random), 700 + 60 * uniform(random)};
    const std::string name = "range/" + std::to_string(i) + ".tiff";
    write_range_map(scratch / name, centre, static_cast<unsigned>(i));
    const Vector3d tip = place_of_arm().inverse() * centre;
    text += name + "," + csv_row(i == 3 ? Vector3d(tip + Vector3d(0, 1.5, 0)) : tip);
  }
  write_text(scratch / "poses.csv", text);
}

TEST(CalibrateArm, ByABallInRangeMapsNamesThePoseThatIsWrong) {
  const ScratchFolder scratch;
  write_poses(scratch, 9);
  const std::vector<std::string> call = {
      "calibrate",          "arm",    "--ball",       scratch / "poses.csv", "-o",
      scratch / "arm.json", "--json", "--ball-radius"};
  std::vector<std::string> right = call, wrong = call;
  right.emplace_back("15");
  const CommandResult result = run_palpate(right);
  ASSERT_EQ(result.status, 0) << result.err;
  const nlohmann::json figures = nlohmann::json::parse(result.out);
  EXPECT_LT(apart(pose_in(figures["pose"]), {0, 0, 700}), 0.05);
  EXPECT_EQ(figures["used"], 8);
  EXPECT_FALSE(figures["residuals"][3]["used"].get<bool>());
  EXPECT_TRUE(figures["ball_offset_deviation"].is_null());
  EXPECT_NE(result.err.find("its shading can displace it"), std::string::npos) << result.err;
  EXPECT_LT(apart(probing::parse_arm_setup(read_text(scratch / "arm.json"), "").prober.T_world_base,
                  {0, 0, 700}),
            0.05);
  wrong.emplace_back("13");
  const std::string before = read_text(scratch / "arm.json");
  const CommandResult refused = run_palpate(wrong);
  EXPECT_EQ(refused.status, kWorkFailed);
  EXPECT_NE(refused.err.find("has a radius of 15.0"), std::string::npos) << refused.err;
  EXPECT_EQ(read_text(scratch / "arm.json"), before);
}

TEST(CalibrateArm, RefusesWhatDoesNotDetermineThePoseAndWritesNothing) {
  const ScratchFolder scratch;
  geometry::TriangleMesh plate;
  plate.vertices.resize(3, 4);
  plate.vertices << 0, 100, 100, 0, 0, 0, 80, 80, 500, 500, 500, 500;
  plate.triangles.resize(3, 2);
  plate.triangles << 0, 0, 3, 2, 2, 1;
  geometry::write_mesh(scratch / "plate.ply", plate);
  std::string touches = "x,y,z\n";
  for (int i = 0; i < 30; ++i) touches += csv_row({10.0 + 4 * (i % 20), 5.0 + 2.5 * i, 498});
  write_text(scratch / "touches.csv", touches);
  const CommandResult result =
      run_palpate({"calibrate", "arm", "--touches", scratch / "touches.csv", "--surface",
                   scratch / "plate.ply", "--tip-radius", "2", "-o", scratch / "arm.json"});
  EXPECT_EQ(result.status, kWorkFailed);
  EXPECT_NE(result.err.find("the surface does not fix"), std::string::npos) << result.err;
  EXPECT_NE(result.err.find("a shift along"), std::string::npos) << result.err;
  EXPECT_FALSE(std::filesystem::exists(scratch.path() / "arm.json"));
}

TEST(CalibrateArm, RefusesWrongCalls) {
  const ScratchFolder scratch;
  write_text(scratch / "t.csv", "x,y\n1,2\n");
  write_text(scratch / "arm.json", "[1]");
  const auto refused = [&](std::vector<std::string> arguments, const std::string& place,
                           const std::string& output = "arm.json") {
    arguments.insert(arguments.begin(), {"calibrate", "arm", "-o", scratch / output});
    const CommandResult result = run_palpate(arguments);
    EXPECT_EQ(result.status, kWrongCall) << result.out << result.err;
    EXPECT_NE(result.err.find(place), std::string::npos) << result.err;
  };
  const std::string hand = (demo_data().parent_path() / "meshes/hand.ply").string();
  refused({}, "--touches");
  refused({"--touches", scratch / "t.csv"}, "--surface");
  refused({"--touches", scratch / "t.csv", "--surface", hand}, "--tip-radius");
  const std::vector<std::string> touches = {"--touches", scratch / "t.csv", "--surface",
                                            hand,        "--tip-radius",    "2"};
  refused(touches, "'z'", "new.json");
  refused(touches, "arm.json");  // before anything is read or computed
  refused({"--ball", scratch / "t.csv", "--ball-radius", "9"}, "arm.json");
  refused({"--ball", scratch / "t.csv", "--ball-radius", "9"}, "must end in .json", "arm.yaml");
  refused({"--ball", scratch / "t.csv"}, "--ball-radius");
  refused({"--ball", scratch / "t.csv", "--ball-radius", "0"}, "--ball-radius");
  refused({"--start", hand, "--ball", scratch / "t.csv"}, "--touches");
  EXPECT_EQ(read_text(scratch / "arm.json"), "[1]");
}

}  // namespace
}  // namespace palpate::apps
