// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
// Range maps and meshes of one object become one surface.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <filesystem>
#include <limits>
#include <nlohmann/json.hpp>
#include <random>
#include <sstream>
#include <string>
#include <vector>

#include "palpate/geometry/mesh_io.h"
#include "palpate/geometry/range_map.h"
#include "palpate/geometry/surface_query.h"
#include "palpate/sensing/camera_file.h"
#include "run_palpate.h"

namespace palpate::apps {
namespace {

namespace fs = std::filesystem;
using ::testing::AllOf;
using ::testing::HasSubstr;

constexpr double kBallRadius = 40;  // [mm]
const Eigen::Vector3d kBallCentre(0, 0, 830);

/// A ball as the camera sees it along the ray of each pixel; noise of standard deviation `sigma`.
geometry::ImageF ball(const geometry::Camera& camera, const Eigen::Vector3d& centre, double sigma,
                      unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal(0, sigma);
  geometry::ImageF z = geometry::ImageF::Constant(camera.height, camera.width,
                                                  std::numeric_limits<float>::quiet_NaN());
  const Eigen::Matrix2Xd rays = geometry::pixel_rays(camera);
  for (int pixel = 0; pixel < rays.cols(); ++pixel) {
    const Eigen::Vector3d ray = rays.col(pixel).homogeneous().normalized();
    const double along = ray.dot(centre);
    const double inside = kBallRadius * kBallRadius - centre.squaredNorm() + along * along;
    if (inside <= 0) continue;
    z(pixel / camera.width, pixel % camera.width) =
        static_cast<float>((along - std::sqrt(inside)) * ray.z() + normal(random));
  }
  return z;
}

class Fuse : public ::testing::Test {
 protected:
  void SetUp() override {
    fs::create_directory(scratch / "range");
    fs::copy(demo("rig.yaml"), scratch / "range/rig.yaml");
    camera = sensing::read_camera(demo("rig.yaml"));
  }

  void write_ball(const std::string& name, const Eigen::Vector3d& centre, double sigma,
                  unsigned seed) const {
    const geometry::ImageF z = ball(camera, centre, sigma, seed);
    geometry::write_depth_tiff(scratch / ("range/" + name + ".tiff"), z);
    const geometry::ImageF deviations = z.isNaN().select(z, static_cast<float>(sigma));
    geometry::write_depth_tiff(scratch / ("range/" + name + "_sigma.tiff"), deviations);
  }

  nlohmann::json figures(std::vector<std::string> call) const {
    call.emplace_back("--json");
    const CommandResult result = run_palpate(call);
    EXPECT_EQ(result.status, kDone) << result.err;
    return nlohmann::json::parse(result.out.empty() ? "{}" : result.out);
  }

  /// RMS distance of the vertices from the ball, of those well inside its outline.
  double rms_error(const std::string& file) const {
    const geometry::TriangleMesh mesh = geometry::read_mesh(file);
    double sum = 0;
    int count = 0;
    for (const auto& v : mesh.vertices.colwise()) {
      const Eigen::Vector3d out = (v - kBallCentre).normalized();
      if (out.dot(-v.normalized()) < 0.6) continue;
      const double error = (v - kBallCentre).norm() - kBallRadius;
      sum += error * error;
      ++count;
    }
    EXPECT_GT(count, 500);
    return std::sqrt(sum / count);
  }

  ScratchFolder scratch;
  geometry::Camera camera;
};

TEST_F(Fuse, FramesOfAStillBallHaveLessNoiseTogetherAndSayHowMuch) {
  for (unsigned i = 0; i < 9; ++i) write_ball(std::to_string(i), kBallCentre, 0.3, i + 1);
  const auto one = figures({"fuse", scratch / "range/0.tiff", "-o", scratch / "one.ply"});
  const auto all = figures({"fuse", scratch / "range", "-o", scratch / "all.ply"});
  EXPECT_EQ(all["scans"], 9);
  EXPECT_EQ(all["components"], 1);
  EXPECT_TRUE(all["conflicts"].empty());
  EXPECT_NEAR(rms_error(scratch / "one.ply") / rms_error(scratch / "all.ply"), 3, 0.6);
  EXPECT_NEAR(one["median_sigma"].get<double>(), 0.3, 1e-6);
  EXPECT_NEAR(all["median_sigma"].get<double>(), 0.1, 1e-6);
  const geometry::MeshFile file = geometry::read_mesh_file(scratch / "all.ply");
  EXPECT_NE(geometry::find_attribute(file.vertex_attributes, "sigma"), nullptr);
}

TEST_F(Fuse, PosesBringScansTogether) {
  // The camera moved by 5 mm between the frames.
  const Eigen::Vector3d shift(5, 0, 0);
  write_ball("a", kBallCentre, 0.05, 1);
  write_ball("b", kBallCentre - shift, 0.05, 2);
  fs::create_directory(scratch / "poses");
  write_text(scratch / "poses/a.txt", "1 0 0 0\n0 1 0 0\n0 0 1 0\n0 0 0 1\n");
  write_text(scratch / "poses/b.txt", "1 0 0 5\n0 1 0 0\n0 0 1 0\n0 0 0 1\n");
  (void)figures({"fuse", scratch / "range", "--pose", scratch / "poses", "-o", scratch / "x.ply"});
  EXPECT_LT(rms_error(scratch / "x.ply"), 0.05);
  // Without them the mean of two balls is no ball.
  const std::vector<std::string> call = {"fuse", scratch / "range", "-o", scratch / "y.ply"};
  const CommandResult refused = run_palpate(call);
  EXPECT_EQ(refused.status, kWorkFailed);
  EXPECT_THAT(refused.err, AllOf(HasSubstr("range/a.tiff"), HasSubstr("range/b.tiff"),
                                 HasSubstr("disagree where they overlap"), HasSubstr("--force")));
  EXPECT_FALSE(fs::exists(scratch / "y.ply"));
  std::vector<std::string> forced = call;
  forced.emplace_back("--force");
  const auto pairs = figures(forced)["conflicts"];
  ASSERT_GE(pairs.size(), 1U);
  EXPECT_GT(pairs[0]["hidden"].get<double>(), 0.1);
  EXPECT_GT(rms_error(scratch / "y.ply"), 0.5);
}

TEST_F(Fuse, MeshesAreRegisteredToEachOther) {
  const std::string hand = (fs::path(demo_data()).parent_path() / "meshes/hand.ply").string();
  const geometry::TriangleMesh mesh = geometry::read_mesh(hand);
  geometry::TriangleMesh moved = mesh;
  const Eigen::Vector3d centre = mesh.vertices.rowwise().mean();
  moved.vertices = (Eigen::Translation3d(centre + Eigen::Vector3d(3, -2, 4)) *
                    Eigen::AngleAxisd(0.1, Eigen::Vector3d(1, 2, 3).normalized()) *
                    Eigen::Translation3d(-centre)) *
                   mesh.vertices;
  geometry::write_mesh(scratch / "a.ply", mesh);
  geometry::write_mesh(scratch / "b.ply", moved);
  const auto fused = figures(
      {"fuse", scratch / "a.ply", scratch / "b.ply", "--register", "-o", scratch / "c.ply"});
  EXPECT_EQ(fused["registered"].size(), 1U);
  const geometry::TriangleMesh together = geometry::read_mesh(scratch / "c.ply");
  const auto distances =
      geometry::closest_points(geometry::SurfaceQuery(mesh), together.vertices).distances;
  EXPECT_LT(distances.maxCoeff(), fused["spacing"].get<double>());
}

TEST_F(Fuse, RefusesWhatCannotBeFused) {
  write_ball("a", kBallCentre, 0.1, 1);
  write_ball("b", kBallCentre, 0.1, 2);
  const auto refused = [&](std::vector<std::string> call, int status, const std::string& words) {
    call.insert(call.begin(), "fuse");
    call.insert(call.end(), {"-o", scratch / "out.ply"});
    const CommandResult result = run_palpate(call);
    EXPECT_EQ(result.status, status) << result.out;
    EXPECT_THAT(result.err, HasSubstr(words));
    EXPECT_FALSE(fs::exists(scratch / "out.ply"));
  };
  refused({scratch / "none"}, kWrongCall, "none");
  write_text(scratch / "a.txt", "1 0 0 0\n0 1 0 0\n0 0 1 0\n0 0 0 1\n");
  refused({scratch / "range", "--pose", scratch / "a.txt"}, kWrongCall, "1 poses for 2 scans");
  refused({scratch / "range", "--spacing", "0.00001"}, kWrongCall, "spacing");
  refused({scratch / "range", "--max-memory", "0.0001"}, kWrongCall, "--max-memory");
  refused({scratch / "range", "--reach", "1"}, kWrongCall, "--reach");
  geometry::write_depth_tiff(scratch / "range/b_sigma.tiff",
                             geometry::ImageF::Zero(camera.height, camera.width));
  refused({scratch / "range"}, kWrongCall, "no deviation > 0");
  refused({scratch / "range/a.tiff", demo("rig.yaml")}, kWrongCall, "rig.yaml");
}

}  // namespace
}  // namespace palpate::apps
